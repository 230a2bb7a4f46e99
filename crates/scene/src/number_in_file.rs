//! Coordinates in files: texts, so that no digit is lost, or plain numbers where none can be.

use std::fmt;

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer};

use super::exact_length::exactly;

/// Largest number of significant digits that every f64 keeps.
const KEPT_DIGITS: usize = 15;

/// The text of a coordinate.
struct Coordinate(String);

/// Reads a coordinate.
pub(super) fn coordinate<'de, D: Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    Ok(Coordinate::deserialize(from)?.0)
}

/// Reads an array of `N` coordinates, and refuses a longer or shorter one.
pub(super) fn coordinates<'de, D: Deserializer<'de>, const N: usize>(
    from: D,
) -> Result<[String; N], D::Error> {
    Ok(exactly::<D, Coordinate, N>(from)?.map(|coordinate| coordinate.0))
}

impl<'de> Deserialize<'de> for Coordinate {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(AsText)
    }
}

struct AsText;

impl Visitor<'_> for AsText {
    type Value = Coordinate;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Coordinate, E> {
        Ok(Coordinate(text.to_string()))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Coordinate, E> {
        Ok(Coordinate(number.to_string()))
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Coordinate, E> {
        let text = format!("{number:?}");
        let mantissa = text.split(['e', 'E']).next().unwrap_or_default();
        let digits =
            mantissa.trim_start_matches(['-', '0', '.']).bytes().filter(u8::is_ascii_digit);
        if digits.count() > KEPT_DIGITS {
            let why = format!(
                "a number of more than {KEPT_DIGITS} digits must stand in quotes, or the last ones are lost"
            );
            return Err(E::custom(why));
        }
        Ok(Coordinate(text))
    }
}
