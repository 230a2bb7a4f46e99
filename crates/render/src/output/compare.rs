//! Compares two results of the same size pixel by pixel: arrays of answers, or pictures.
//!
//! Both are read row by row, so they may be larger than memory.

use std::fs::File;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};

pub use super::comparison::Comparison;
use super::ending::ends_in;
use super::picture_rows::PictureRows;
use super::result_arrays::{ArrayError, ResultArrays};
use super::whole_png::check_whole_png;
use flipmap_engine::plain_file::open_plain;
use flipmap_scene::question::{Channel, ChannelScale, QuestionName};

/// A result that is read row by row, from the top.
pub struct ResultRows {
    path: PathBuf,
    size: [u32; 2],
    kind: ResultKind,
}

enum ResultKind {
    Times(ResultArrays),
    Colours(Box<PictureRows<BufReader<File>>>),
}

/// Number of levels of sixteen bits in one of eight.
const DEEP_LEVELS: f64 = 257.0;

/// A row of a result.
enum ResultRow {
    Times(Vec<f64>),
    /// Four channels of sixteen bits for each pixel.
    Colours(Vec<u16>),
}

/// The difference between two pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Difference {
    /// Size of the difference: for arrays as the [`Yardstick`] measures it, for pictures in levels
    /// out of 255 in the channel that differs most.
    By(f64),
    /// A class change: a time in one and none in the other, or none in both for different reasons.
    Class,
}

/// Reasons why two files cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// A file that cannot be read.
    #[error("cannot read {path}")]
    File {
        /// Path of the file.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// A difference picture that cannot be written.
    #[error("cannot write the difference picture")]
    Picture(#[source] io::Error),
    /// A file that is not a result.
    #[error(
        "{path} {why}; compare takes PNGs, and .npy and .npz files of raw samples as render writes \
         them"
    )]
    Kind {
        /// Path of the file.
        path: PathBuf,
        /// The fault, as a phrase.
        why: String,
    },
    /// An array compared with a picture.
    #[error("{times} has times and {colours} has colours: compare like with like")]
    Unlike {
        /// Path of the array.
        times: PathBuf,
        /// Path of the picture.
        colours: PathBuf,
    },
    /// Results with different numbers of channels: answers to different questions.
    #[error(
        "{a} has {} channels and {b} {}: only answers to one question can be compared",
        channels[0],
        channels[1]
    )]
    Channels {
        /// Path of one result.
        a: PathBuf,
        /// Path of the other result.
        b: PathBuf,
        /// Numbers of channels.
        channels: [usize; 2],
    },
    /// Arrays that do not answer the named question.
    #[error(
        "{path} has {found} channels, and the question {} {}: name the question that both \
         answer",
        ask.kind().name,
        ask.kind().channels.len()
    )]
    Ask {
        /// Path of the result.
        path: PathBuf,
        /// The named question.
        ask: QuestionName,
        /// Number of its channels.
        found: usize,
    },
    /// Results of different sizes.
    #[error(
        "{a} is {} and {b} {} pixels: only results of one size can be compared",
        by(a_size),
        by(b_size)
    )]
    Size {
        /// Path of one result.
        a: PathBuf,
        /// Size of that result in pixels.
        a_size: [u32; 2],
        /// Path of the other result.
        b: PathBuf,
        /// Size of that result in pixels.
        b_size: [u32; 2],
    },
}

fn by([width, height]: &[u32; 2]) -> String {
    format!("{width} × {height}")
}

impl ResultRows {
    /// Opens a result and reads its size.
    pub fn open(path: &Path) -> Result<Self, CompareError> {
        let unreadable = |source| CompareError::File { path: path.to_path_buf(), source };
        let foreign = |why: String| CompareError::Kind { path: path.to_path_buf(), why };
        let arrays = |arrays: Result<ResultArrays, ArrayError>| match arrays {
            Ok(arrays) => Ok((arrays.size(), ResultKind::Times(arrays))),
            Err(ArrayError::Unreadable(source)) => Err(unreadable(source)),
            Err(other) => Err(foreign(other.to_string())),
        };
        let (size, kind) = if ends_in(path, "png") {
            let file = BufReader::new(open_plain(path).map_err(unreadable)?);
            let whole = open_plain(path).and_then(|file| check_whole_png(BufReader::new(file)));
            let rows = PictureRows::open(file).map_err(foreign)?;
            whole.map_err(unreadable)?;
            (rows.size(), ResultKind::Colours(Box::new(rows)))
        } else if ends_in(path, "npz") {
            arrays(ResultArrays::of_npz(path))?
        } else {
            arrays(ResultArrays::of_npy(path))?
        };
        Ok(ResultRows { path: path.to_path_buf(), size, kind })
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Refuses an array that does not have as many channels as a question.
    pub fn require(&self, ask: QuestionName) -> Result<(), CompareError> {
        let found = self.channels();
        if self.has_times() && found != ask.kind().channels.len() {
            return Err(CompareError::Ask { path: self.path.clone(), ask, found });
        }
        Ok(())
    }

    /// Returns true for an array, false for a picture.
    pub fn has_times(&self) -> bool {
        matches!(self.kind, ResultKind::Times(..))
    }

    /// Returns the number of values of each pixel.
    fn channels(&self) -> usize {
        match &self.kind {
            ResultKind::Times(arrays) => arrays.channels(),
            ResultKind::Colours(_) => 4,
        }
    }

    fn next(&mut self) -> Result<ResultRow, CompareError> {
        let row = match &mut self.kind {
            ResultKind::Times(arrays) => arrays.next().map(ResultRow::Times),
            ResultKind::Colours(rows) => rows.next().map(ResultRow::Colours),
        };
        row.map_err(|source| {
            let source = match source.kind() {
                io::ErrorKind::UnexpectedEof => io::Error::other("it ends before its last row"),
                _ => source,
            };
            CompareError::File { path: self.path.clone(), source }
        })
    }
}

/// The measure by which the values of two pixels are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Yardstick {
    /// The largest difference between any two values.
    Plain,
    /// The difference of one channel, in its unit.
    Channel(&'static Channel),
    /// The largest difference of several channels, each in multiples of the largest error of a
    /// right value.
    Channels(&'static [Channel]),
}

impl Yardstick {
    /// Returns the yardstick for a question.
    pub fn of(ask: QuestionName) -> Self {
        match ask.kind().channels {
            [channel] => Yardstick::Channel(channel),
            channels => Yardstick::Channels(channels),
        }
    }

    /// Returns the unit of the differences; empty if there is none.
    pub fn unit(&self) -> &'static str {
        match self {
            Yardstick::Plain => "",
            Yardstick::Channel(channel) => channel.unit,
            Yardstick::Channels(_) => "times what counts as right",
        }
    }

    /// Returns the largest difference that is ignored by default.
    pub fn tolerance(&self) -> f64 {
        match self {
            Yardstick::Plain => 1e-3,
            Yardstick::Channel(channel) => channel.right,
            Yardstick::Channels(_) => 1.0,
        }
    }

    /// Returns the difference between two pixels' values.
    fn between(&self, a: &[f64], b: &[f64]) -> Difference {
        match self {
            Yardstick::Plain => Difference::of_values(a, b),
            Yardstick::Channel(channel) => apart(channel, a[0], b[0]),
            Yardstick::Channels(channels) => {
                let each = channels.iter().zip(a.iter().zip(b));
                let each = each.map(|(channel, (a, b))| match apart(channel, *a, *b) {
                    Difference::By(0.0) => Difference::By(0.0),
                    // A count is right or wrong.
                    Difference::By(_) if channel.right == 0.0 => Difference::Class,
                    Difference::By(by) => Difference::By(by / channel.right),
                    Difference::Class => Difference::Class,
                });
                each.reduce(Difference::or_larger).unwrap_or(Difference::By(0.0))
            }
        }
    }
}

/// Returns the difference between two values of a channel; angles are compared on the circle.
fn apart(channel: &Channel, a: f64, b: f64) -> Difference {
    match Difference::of_times(a, b) {
        Difference::By(by) if channel.scale == ChannelScale::Cyclic => {
            let by = by % std::f64::consts::TAU;
            Difference::By(by.min(std::f64::consts::TAU - by))
        }
        by => by,
    }
}

impl Difference {
    /// Returns the difference between two values: finite, +inf for unflipped and failed pixels, NaN
    /// for forbidden ones.
    pub(crate) fn of_times(a: f64, b: f64) -> Self {
        if a.is_finite() && b.is_finite() {
            Difference::By((a - b).abs())
        } else if a == b || (a.is_nan() && b.is_nan()) {
            Difference::By(0.0)
        } else {
            Difference::Class
        }
    }

    /// Returns the largest difference among the values of two pixels.
    fn of_values(a: &[f64], b: &[f64]) -> Self {
        let each = a.iter().zip(b).map(|(a, b)| Difference::of_times(*a, *b));
        each.reduce(Difference::or_larger).unwrap_or(Difference::By(0.0))
    }

    fn or_larger(self, other: Self) -> Self {
        match (self, other) {
            (Difference::By(a), Difference::By(b)) => Difference::By(a.max(b)),
            _ => Difference::Class,
        }
    }

    /// Returns the difference between two colours.
    fn of_colours(a: &[u16], b: &[u16]) -> Self {
        let most = a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0);
        Difference::By(f64::from(most) / DEEP_LEVELS)
    }
}

/// Compares two results and passes each row of differences to `row`, from the top.
pub fn compare(
    mut a: ResultRows,
    mut b: ResultRows,
    (yardstick, tolerance): (&Yardstick, f64),
    row: &mut dyn FnMut(&[Difference]) -> io::Result<()>,
) -> Result<Comparison, CompareError> {
    if a.has_times() != b.has_times() {
        let (times, colours) = if a.has_times() { (a, b) } else { (b, a) };
        return Err(CompareError::Unlike { times: times.path, colours: colours.path });
    }
    if a.size != b.size {
        let (a_size, b_size) = (a.size, b.size);
        return Err(CompareError::Size { a: a.path, a_size, b: b.path, b_size });
    }
    let channels = a.channels();
    if channels != b.channels() {
        let channels = [channels, b.channels()];
        return Err(CompareError::Channels { a: a.path, b: b.path, channels });
    }
    let mut comparison = Comparison::default();
    for _ in 0..a.size[1] {
        let differences: Vec<Difference> = match (a.next()?, b.next()?) {
            (ResultRow::Times(a), ResultRow::Times(b)) => {
                let pixels = a.chunks(channels).zip(b.chunks(channels));
                pixels.map(|(a, b)| yardstick.between(a, b)).collect()
            }
            (ResultRow::Colours(a), ResultRow::Colours(b)) => {
                a.chunks(4).zip(b.chunks(4)).map(|(a, b)| Difference::of_colours(a, b)).collect()
            }
            _ => unreachable!("arrays are compared with arrays, and pictures with pictures"),
        };
        differences.iter().for_each(|difference| comparison.add(*difference, tolerance));
        row(&differences).map_err(CompareError::Picture)?;
    }
    Ok(comparison)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_and_times_are_told_apart() {
        let (inf, nan) = (f64::INFINITY, f64::NAN);
        for (a, b, expected) in [
            (1.0, 1.5, Difference::By(0.5)),
            (inf, inf, Difference::By(0.0)),
            (nan, nan, Difference::By(0.0)),
            (1.0, inf, Difference::Class),
            (inf, nan, Difference::Class),
            (nan, 2.0, Difference::Class),
        ] {
            assert_eq!(Difference::of_times(a, b), expected, "{a} and {b}");
        }
    }

    #[test]
    fn colours_of_sixteen_bits_are_compared_to_their_last_level() {
        let by = |a: [u16; 4], b: [u16; 4]| match Difference::of_colours(&a, &b) {
            Difference::By(by) => by,
            Difference::Class => panic!("colours have no classes"),
        };
        assert_eq!(by([0, 0, 0, 65_535], [0, 50, 0, 65_535]), 50.0 / 257.0);
        assert_eq!(by([65_535; 4], [65_535, 65_535, 65_535, 0]), 255.0, "alpha counts");
        assert_eq!(by([7; 4], [7; 4]), 0.0);
    }

    #[test]
    fn each_channel_is_compared_by_its_own_measure() {
        use std::f64::consts::PI;
        let growth = Yardstick::of(QuestionName::Growth);
        assert_eq!((growth.unit(), growth.tolerance()), ("1/s", 1e-2));
        assert_eq!(growth.between(&[0.5], &[0.25]), Difference::By(0.25));
        let state = Yardstick::of(QuestionName::State);
        let a = [PI - 1e-3, 0.0, 1.0, 0.0, 2.0, 0.0];
        let across = [1e-3 - PI, 0.0, 1.0, 0.0, 2.0, 0.0];
        let Difference::By(by) = state.between(&a, &across) else { panic!("no turns differ") };
        assert!((by - 2.0).abs() < 1e-9, "2e-3 rad across ±π are twice what is right: {by}");
        let turned = [PI - 1e-3, 0.0, 1.0, 0.0, 3.0, 0.0];
        assert_eq!(state.between(&a, &turned), Difference::Class);
        assert_eq!(state.between(&a, &a), Difference::By(0.0));
    }

    #[test]
    fn quantiles_are_of_all_that_have_a_difference() {
        let mut comparison = Comparison::default();
        for k in 0..100 {
            let by = if k < 50 { 0.0 } else { f64::from(k) * 1e-3 };
            comparison.add(Difference::By(by), 0.08);
        }
        comparison.add(Difference::Class, 0.08);
        assert_eq!((comparison.pixels, comparison.differing, comparison.classes), (101, 20, 1));
        assert_eq!(comparison.quantile(0.5), 0.0);
        assert!((comparison.quantile(0.9) / 0.089 - 1.0).abs() < 0.025);
        assert_eq!((comparison.quantile(1.0), comparison.largest), (0.099, 0.099));
    }
}
