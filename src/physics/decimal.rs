//! Decimal strings of any length and the binary numbers nearest to them.

use std::str::FromStr;

use dashu_float::DBig;
use dashu_int::{IBig, ops::DivRem};

/// Longer strings are not numbers that anybody means.
pub const MOST_CHARACTERS: usize = 1000;
/// Nor have they larger exponents.
const MOST_EXPONENT: isize = 2000;

/// A decimal number, if it is one; exponents are allowed, digit separators are not.
pub fn parse(text: &str) -> Option<DBig> {
    let text = text.trim();
    if text.len() > MOST_CHARACTERS || text.contains('_') {
        return None;
    }
    let value = DBig::from_str(text).ok()?;
    (value.repr().exponent().abs() <= MOST_EXPONENT).then_some(value)
}

/// The nearest whole number to a decimal times 2^`bits`.
pub fn read(text: &str, bits: usize) -> Option<IBig> {
    let (significand, exponent) = parse(text)?.into_repr().into_parts();
    let power = IBig::from(10).pow(exponent.unsigned_abs());
    let scaled = significand << bits;
    Some(if exponent >= 0 { scaled * power } else { nearest(scaled, power) })
}

/// `value` / 2^`bits` with so many digits after the point, without trailing zeros.
pub fn written(value: IBig, bits: usize, digits: usize) -> String {
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

/// The whole number nearest to a quotient by a positive number.
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
        for bad in ["", "1_0", "0x10", "pi", "1e99999", "--1", &"1".repeat(1001)] {
            assert_eq!(parse(bad), None, "{bad}");
        }
        assert_eq!(read("1.5e0", 1), Some(IBig::from(3)));
        assert_eq!(read("-0.25", 1), Some(IBig::from(-1)));
        assert_eq!(read("2e3", 0), Some(IBig::from(2000)));
    }

    #[test]
    fn numbers_are_written_to_the_digits_asked_for() {
        assert_eq!(written(IBig::from(-5), 2, 10), "-1.25");
        assert_eq!(written(IBig::from(1), 10, 2), "0");
        assert_eq!(written(IBig::from(-1), 10, 2), "0");
        assert_eq!(written(IBig::from(700), 0, 3), "700");
    }
}
