//! Decimal strings of any length and the binary numbers nearest to them.

use std::fmt;
use std::str::FromStr;

use dashu_float::DBig;
use dashu_int::{IBig, ops::DivRem};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use crate::fixed::Exact;
use crate::real::Scalar;

/// A number as the user wrote it. Every number type takes its own nearest value from it: the f64
/// nearest to 0.6 is not 0.6, and a pendulum built with it differs in every digit after the
/// sixteenth.
///
/// An f64 stands for the shortest decimal that reads back as the same f64.
#[derive(Clone, Copy, PartialEq)]
pub struct Decimal {
    /// The nearest f64. If the number is not finite or is beyond 2⁶³, `exact` is zero.
    value: f64,
    /// The value to within 1e-134.
    exact: Exact,
}

impl Decimal {
    /// The nearest f64.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// The value in 512 bits, 448 of them after the point.
    pub fn exact(&self) -> Exact {
        self.exact
    }

    /// Returns true if the number is the shortest decimal of its nearest f64.
    fn is_short(&self) -> bool {
        *self == Decimal::from(self.value)
    }
}

impl From<f64> for Decimal {
    fn from(value: f64) -> Self {
        let exact = Exact::parse(&format!("{value:e}")).unwrap_or_default();
        Decimal { value, exact }
    }
}

impl FromStr for Decimal {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        let value: f64 = text.trim().parse().map_err(|_| ())?;
        Ok(Decimal { value, exact: Exact::parse(text).unwrap_or_default() })
    }
}

impl PartialEq<f64> for Decimal {
    fn eq(&self, other: &f64) -> bool {
        *self == Decimal::from(*other)
    }
}

/// Number of digits after the point to which every exact value is right.
const DIGITS: usize = 134;

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_short() || !self.value.is_finite() {
            return self.value.fmt(f);
        }
        f.write_str(&self.exact.decimal(DIGITS))
    }
}

impl fmt::Debug for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_short() || !self.value.is_finite() {
            return write!(f, "{:?}", self.value);
        }
        fmt::Display::fmt(self, f)
    }
}

/// Writes a number into files, or a string where a float would lose digits.
impl Serialize for Decimal {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.is_short() || !self.value.is_finite() {
            return self.value.serialize(serializer);
        }
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Decimal {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl de::Visitor<'_> for Either {
            type Value = Decimal;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a number, or a string of its digits")
            }
            fn visit_f64<E>(self, value: f64) -> Result<Decimal, E> {
                Ok(Decimal::from(value))
            }
            fn visit_i64<E>(self, value: i64) -> Result<Decimal, E> {
                Ok(Decimal::from(value as f64))
            }
            fn visit_u64<E>(self, value: u64) -> Result<Decimal, E> {
                Ok(Decimal::from(value as f64))
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<Decimal, E> {
                let wrong = |()| E::invalid_value(de::Unexpected::Str(text), &self);
                text.parse().map_err(wrong)
            }
        }
        deserializer.deserialize_any(Either)
    }
}

/// Maximum length of a number in characters; longer text is not read as a number.
pub(super) const MAX_CHARACTERS: usize = 1000;
/// Maximum magnitude of a decimal exponent; text with a larger one is not read as a number.
const MAX_EXPONENT: usize = 2000;

/// Parses a decimal number; `None` if the text is not one. Exponents are allowed, digit separators
/// are not.
pub(super) fn parse(text: &str) -> Option<DBig> {
    let text = text.trim();
    if text.len() > MAX_CHARACTERS || text.contains('_') {
        return None;
    }
    // Checked before the digits are parsed: the longest exponents overflow.
    let exponent = text.split_once(['e', 'E']).map(|(_, exponent)| exponent.parse::<i64>());
    if exponent.is_some_and(|e| !e.is_ok_and(|e| e.unsigned_abs() <= MAX_EXPONENT as u64)) {
        return None;
    }
    let value = DBig::from_str(text).ok()?;
    (value.repr().exponent().unsigned_abs() <= MAX_EXPONENT).then_some(value)
}

/// Reads a decimal as the integer nearest to its product with 2^`bits`.
pub(super) fn read(text: &str, bits: usize) -> Option<IBig> {
    let (significand, exponent) = parse(text)?.into_repr().into_parts();
    let power = IBig::from(10).pow(exponent.unsigned_abs());
    let scaled = significand << bits;
    Some(if exponent >= 0 { scaled * power } else { nearest(scaled, power) })
}

/// Formats `value` / 2^`bits` with `digits` digits after the point, without trailing zeros.
pub(super) fn written(value: IBig, bits: usize, digits: usize) -> String {
    let negative = value < IBig::ZERO;
    let scaled = nearest(value * IBig::from(10).pow(digits), IBig::from(1) << bits);
    let scaled = if negative { -scaled } else { scaled };
    let text = format!("{:0>width$}", scaled.to_string(), width = digits + 1);
    let (whole, fraction) = text.split_at(text.len() - digits);
    let fraction = fraction.trim_end_matches('0');
    let sign = if negative && scaled != IBig::ZERO { "-" } else { "" };
    let point = if fraction.is_empty() { "" } else { "." };
    format!("{sign}{whole}{point}{fraction}")
}

/// Returns the integer nearest to `dividend` / `divisor`; the divisor must be positive.
fn nearest(dividend: IBig, divisor: IBig) -> IBig {
    let (quotient, rest) = (&dividend).div_rem(&divisor);
    let twice = rest * IBig::from(2);
    if twice >= divisor {
        quotient + IBig::from(1)
    } else if -twice >= divisor {
        quotient - IBig::from(1)
    } else {
        quotient
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_numbers_are_read() {
        for bad in [
            "",
            "1_0",
            "0x10",
            "pi",
            "1e99999",
            "1e-9223372036854775808",
            "1e9223372036854775808",
            "--1",
            &"1".repeat(1001),
        ] {
            assert_eq!(parse(bad), None, "{bad}");
        }
        assert_eq!(read("1.5e0", 1), Some(IBig::from(3)));
        assert_eq!(read("-0.25", 1), Some(IBig::from(-1)));
        assert_eq!(read("2e3", 0), Some(IBig::from(2000)));
    }

    #[test]
    fn a_number_is_what_its_digits_say_and_not_the_nearest_float() {
        let six_tenths = Decimal::from(0.6);
        assert_eq!("0.6".parse(), Ok(six_tenths));
        assert_eq!(six_tenths.exact(), Exact::parse("0.6").unwrap());
        assert_ne!(six_tenths.exact(), Exact::from_f64(0.6));
        assert!(six_tenths == 0.6 && six_tenths.to_string() == "0.6");
        let long: Decimal = "1.00000000000000000000000000001".parse().unwrap();
        assert!(long.value() == 1.0 && long != 1.0);
        assert_eq!(long.to_string(), "1.00000000000000000000000000001");
        assert_eq!("1_0".parse::<Decimal>(), Err(()));
    }

    #[test]
    fn files_keep_every_digit() {
        #[derive(Debug, PartialEq, Serialize, Deserialize)]
        struct File {
            numbers: [Decimal; 4],
        }
        let text = "numbers = [1, 0.1, 1e-9, \"0.1000000000000000000000000000003\"]";
        let file: File = toml::from_str(text).unwrap();
        let written = toml::to_string(&file).unwrap();
        let long = "\"0.1000000000000000000000000000003\"";
        assert_eq!(written.trim(), format!("numbers = [1.0, 0.1, 0.000000001, {long}]"));
        assert_eq!(toml::from_str::<File>(&written).unwrap(), file);
        let last = |text: &str| {
            let file = toml::from_str::<File>(&format!("numbers = [1, 2, 3, {text}]"));
            file.map(|file| file.numbers[3].value())
        };
        assert!(last("\"x\"").is_err() && last("nan").unwrap().is_nan());
    }

    #[test]
    fn numbers_are_written_to_the_digits_asked_for() {
        assert_eq!(written(IBig::from(-5), 2, 10), "-1.25");
        assert_eq!(written(IBig::from(1), 10, 2), "0");
        assert_eq!(written(IBig::from(-1), 10, 2), "0");
        assert_eq!(written(IBig::from(700), 0, 3), "700");
    }
}
