//! The samples whose mean is the colour of a pixel.

use std::fmt::{self, Display, Formatter};

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The places of samples in a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Sampling {
    /// One in the middle and, where colours change, one in each corner, which four pixels share:
    ///
    /// ```text
    ///   ·───·───·
    ///   │ · │ · │   a quarter of a corner's sample belongs to each pixel,
    ///   ·───·───·   so that there are at most two samples for every pixel
    ///   │ · │ · │
    ///   ·───·───·
    /// ```
    #[default]
    Corners,
    /// A square of samples with this many rows and columns.
    Square(u32),
}

impl Sampling {
    /// One sample in the middle of each pixel.
    pub const SINGLE: Sampling = Sampling::Square(1);
    /// Name of [`Sampling::Corners`] in files.
    pub const CORNERS: &'static str = "corners";

    /// Returns the number of samples along each axis of a pixel, without those in its corners.
    pub fn along(self) -> u32 {
        match self {
            Sampling::Corners => 1,
            Sampling::Square(along) => along,
        }
    }

    /// Returns the columns and rows of samples in a picture of `size` pixels; for
    /// [`Sampling::Corners`], of the samples in corners.
    pub fn grid_size(self, size: [u32; 2]) -> [u32; 2] {
        match self {
            Sampling::Corners => size.map(|side| side + 1),
            Sampling::Square(along) => size.map(|side| side * along),
        }
    }

    /// Returns the largest number of samples that a picture of `size` pixels can take: with samples
    /// in corners, each pixel can have another in its middle.
    pub fn most_samples(self, size: [u32; 2]) -> u64 {
        let count = |size: [u32; 2]| size.into_iter().map(u64::from).product::<u64>();
        let middles = if self == Sampling::Corners { count(size) } else { 0 };
        count(self.grid_size(size)) + middles
    }
}

impl Display for Sampling {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        match self {
            Sampling::Corners => f.write_str(Self::CORNERS),
            Sampling::Square(along) => along.fmt(f),
        }
    }
}

impl Serialize for Sampling {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Sampling::Corners => to.serialize_str(Self::CORNERS),
            Sampling::Square(along) => to.serialize_u32(*along),
        }
    }
}

impl<'de> Deserialize<'de> for Sampling {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(NumberOrWord)
    }
}

/// A visitor that reads a number or the word for corners.
struct NumberOrWord;

impl Visitor<'_> for NumberOrWord {
    type Value = Sampling;

    fn expecting(&self, f: &mut Formatter) -> fmt::Result {
        write!(f, "\"{}\" or a number from 1 to 8", Sampling::CORNERS)
    }

    fn visit_i64<E: Error>(self, along: i64) -> Result<Sampling, E> {
        // An invalid number becomes 0, which is refused with the rest of the table.
        Ok(Sampling::Square(u32::try_from(along).unwrap_or(0)))
    }

    fn visit_u64<E: Error>(self, along: u64) -> Result<Sampling, E> {
        Ok(Sampling::Square(u32::try_from(along).unwrap_or(0)))
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Sampling, E> {
        if word == Sampling::CORNERS {
            return Ok(Sampling::Corners);
        }
        Err(E::invalid_value(serde::de::Unexpected::Str(word), &self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sample_is_counted() {
        assert_eq!(Sampling::SINGLE.most_samples([64, 48]), 3072);
        assert_eq!(Sampling::Square(3).most_samples([64, 48]), 9 * 3072);
        assert_eq!(Sampling::Corners.most_samples([64, 48]), 65 * 49 + 3072);
    }
    use crate::PictureTable;

    fn read(text: &str) -> Result<Sampling, String> {
        let table = toml::from_str::<PictureTable>(text);
        table.map(|table| table.samples).map_err(|error| error.message().to_string())
    }

    #[test]
    fn a_number_and_a_word_are_read_as_they_are_written() {
        assert_eq!(read(""), Ok(Sampling::Corners));
        for sampling in [Sampling::Corners, Sampling::Square(1), Sampling::Square(8)] {
            let table = PictureTable { samples: sampling, ..PictureTable::default() };
            assert_eq!(read(&toml::to_string(&table).unwrap()), Ok(sampling));
        }
        for wrong in ["samples = \"edges\"", "samples = 2.5"] {
            let why = read(wrong).unwrap_err();
            assert!(why.contains("\"corners\" or a number from 1 to 8"), "{why}");
        }
    }

    #[test]
    fn what_was_once_written_is_refused_only_if_it_cannot_be_used() {
        assert_eq!(read("samples = 1"), Ok(Sampling::SINGLE));
        let check = |text: &str| toml::from_str::<PictureTable>(text).unwrap().check();
        let why = check("samples = -3").unwrap_err().to_string();
        assert!(why.contains("between 1 and 8"), "{why}");
    }
}
