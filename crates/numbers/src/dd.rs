//! Double-double numbers: unevaluated sums of two `f64`, about 32 decimal digits.
//!
//! The algorithms are those of Joldes, Muller and Popescu, *Tight and rigorous error bounds for
//! basic building blocks of double-word arithmetic* (ACM TOMS 44, 2017); the exact product is
//! Dekker's (1971), which needs no fused multiply-add.

use std::cmp::Ordering;
use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};

use dashu_float::round::mode::HalfEven;
use dashu_float::{DBig, FBig};

use crate::decimal;
use crate::fixed::Exact;
use crate::real::{Angle, Real, Scalar};

/// The sum `hi + lo`, with |lo| at most half a unit in the last place of `hi`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dd {
    /// The nearest `f64`.
    pub hi: f64,
    /// The remainder that `hi` leaves.
    pub lo: f64,
}

impl Dd {
    /// π to 106 bits.
    pub const PI: Dd = Dd { hi: std::f64::consts::PI, lo: 1.224_646_799_147_353_2e-16 };
    /// 2π to 106 bits.
    pub const TAU: Dd = Dd { hi: std::f64::consts::TAU, lo: 2.449_293_598_294_706_4e-16 };

    /// The number that equals `hi` exactly.
    pub const fn new(hi: f64) -> Self {
        Dd { hi, lo: 0.0 }
    }

    /// Renormalises `hi + lo`; requires |hi| ≥ |lo| or hi = 0.
    fn fast_sum(hi: f64, lo: f64) -> Self {
        let sum = hi + lo;
        Dd { hi: sum, lo: lo - (sum - hi) }
    }

    /// The exact product of two `f64`.
    pub(crate) fn product(a: f64, b: f64) -> Self {
        let hi = a * b;
        let ((ah, al), (bh, bl)) = (split(a), split(b));
        Dd { hi, lo: ((ah * bh - hi) + ah * bl + al * bh) + al * bl }
    }

    /// The nearest integer (ties as in `f64::round_ties_even` on the leading part).
    pub(crate) fn round(self) -> Self {
        let hi = self.hi.round_ties_even();
        if hi == self.hi { Dd::fast_sum(hi, self.lo.round_ties_even()) } else { Dd::new(hi) }
    }

    /// Returns the angle without whole turns, in (−π, π].
    pub fn wrapped(self) -> Self {
        let turns = (self / Dd::TAU).round();
        let angle = self - turns * Dd::TAU;
        if angle > Dd::PI {
            angle - Dd::TAU
        } else if angle <= -Dd::PI {
            angle + Dd::TAU
        } else {
            angle
        }
    }

    /// The number nearest to a decimal of any length.
    pub(crate) fn from_decimal(value: &DBig) -> Self {
        let nearest = |x: &DBig| x.to_f64().value();
        let hi = nearest(value);
        if !hi.is_finite() || hi == 0.0 {
            return Dd::new(hi);
        }
        let rest = value.clone().with_precision(DIGITS).value() - exact_decimal(hi);
        Dd::fast_sum(hi, nearest(&rest))
    }
}

/// Number of decimal digits, enough for the exact value of any f64.
const DIGITS: usize = 800;

/// Returns the exact decimal value of a finite f64. Whole numbers suffice, as m/2ᵏ = m·5ᵏ/10ᵏ; the
/// library's change of base uses logarithms and takes a thousand times as long.
fn exact_decimal(x: f64) -> DBig {
    let binary = FBig::<HalfEven, 2>::try_from(x).expect("a finite f64 has a binary value");
    let (significand, exponent) = binary.into_repr().into_parts();
    let power = exponent.unsigned_abs();
    let exact = if exponent >= 0 {
        DBig::from_parts(significand << power, 0)
    } else {
        let five = DBig::from(5u8).into_repr().into_parts().0;
        DBig::from_parts(significand * five.pow(power), exponent)
    };
    exact.with_precision(DIGITS).value()
}

/// Returns the sum and its rounding error, for any magnitudes (Knuth).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// Veltkamp's split of an f64 into two halves of 26 bits.
fn split(a: f64) -> (f64, f64) {
    const SPLITTER: f64 = 134_217_729.0; // 2^27 + 1
    let t = SPLITTER * a;
    let hi = t - (t - a);
    (hi, a - hi)
}

impl Add for Dd {
    type Output = Dd;
    fn add(self, other: Dd) -> Dd {
        let (sum, error) = two_sum(self.hi, other.hi);
        let (low_sum, low_error) = two_sum(self.lo, other.lo);
        let first = Dd::fast_sum(sum, error + low_sum);
        Dd::fast_sum(first.hi, low_error + first.lo)
    }
}

impl Neg for Dd {
    type Output = Dd;
    fn neg(self) -> Dd {
        Dd { hi: -self.hi, lo: -self.lo }
    }
}

impl Sub for Dd {
    type Output = Dd;
    fn sub(self, other: Dd) -> Dd {
        self + -other
    }
}

impl Mul for Dd {
    type Output = Dd;
    fn mul(self, other: Dd) -> Dd {
        let product = Dd::product(self.hi, other.hi);
        let cross = self.hi * other.lo + self.lo * other.hi;
        Dd::fast_sum(product.hi, product.lo + cross)
    }
}

impl Div for Dd {
    type Output = Dd;
    fn div(self, other: Dd) -> Dd {
        let first = self.hi / other.hi;
        let rest = self - other * Dd::new(first);
        let second = rest.hi / other.hi;
        let rest = rest - other * Dd::new(second);
        Dd::fast_sum(first, second) + Dd::new(rest.hi / other.hi)
    }
}

impl PartialOrd for Dd {
    fn partial_cmp(&self, other: &Dd) -> Option<Ordering> {
        match self.hi.partial_cmp(&other.hi) {
            Some(Ordering::Equal) => self.lo.partial_cmp(&other.lo),
            order => order,
        }
    }
}

impl Real for Dd {
    fn lit(self, value: f64) -> Self {
        Dd::new(value)
    }

    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }
}

impl Angle for Dd {
    /// Sums Taylor series after removing quarter turns; right to a few units of 1e-32 for |x| <
    /// 1e3.
    fn sin_cos(self) -> (Self, Self) {
        let half_pi = Dd { hi: Dd::PI.hi / 2.0, lo: Dd::PI.lo / 2.0 };
        let quarters = (self / half_pi).round();
        let r = self - quarters * half_pi;
        let (sin, cos) = (series(r, r, 1.0), series(r, Dd::new(1.0), 0.0));
        match (quarters.hi as i64).rem_euclid(4) {
            0 => (sin, cos),
            1 => (cos, -sin),
            2 => (-sin, -cos),
            _ => (-cos, sin),
        }
    }
}

/// Sums ± r^n / n! over every second n from `order` on; `first` is the term at n = `order`.
fn series(r: Dd, first: Dd, order: f64) -> Dd {
    let square = r * r;
    let (mut term, mut sum, mut n) = (first, first, order);
    while term.hi.abs() > 1e-36 {
        term = -(term * square) / Dd::new((n + 1.0) * (n + 2.0));
        sum = sum + term;
        n += 2.0;
    }
    sum
}

impl Scalar for Dd {
    const EPSILON: f64 = 4.93e-32; // 2^-104

    fn from_f64(value: f64) -> Self {
        Dd::new(value)
    }
    fn to_f64(self) -> f64 {
        self.hi
    }
    fn pi() -> Self {
        Dd::PI
    }
    fn sqrt(self) -> Self {
        if self.hi <= 0.0 {
            return Dd::new(self.hi.sqrt());
        }
        // One Newton step from the f64 root doubles its digits.
        let root = self.hi.sqrt();
        Dd::new(root) + Dd::new((self - Dd::product(root, root)).hi / (2.0 * root))
    }
    fn from_theta(value: Exact) -> Self {
        value.to_dd()
    }
    fn parse(text: &str) -> Option<Self> {
        decimal::parse(text).map(|value| Dd::from_decimal(&value))
    }
}

impl Dd {
    /// Formats the number with `digits` digits after the point, without trailing zeros.
    pub fn decimal(self, digits: usize) -> String {
        let text = format!("{self:.digits$}");
        let trimmed = text.trim_end_matches('0').trim_end_matches('.');
        if matches!(trimmed, "" | "-" | "-0") { "0".to_string() } else { trimmed.to_string() }
    }
}

impl fmt::Display for Dd {
    /// Writes 32 significant digits, or as many after the point as the precision requests.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.hi.is_finite() {
            return write!(f, "{}", self.hi);
        }
        let sum = exact_decimal(self.hi) + exact_decimal(self.lo);
        let sum = sum.with_precision(32).value();
        match f.precision() {
            Some(digits) => write!(f, "{sum:.digits$}"),
            None => write!(f, "{sum}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::str::FromStr;

    #[test]
    fn floats_are_exact_in_decimal() {
        let cases = [
            (0.1, "0.1000000000000000055511151231257827021181583404541015625"),
            (-1152921504606846976.0, "-1152921504606846976"),
            (3e22, "30000000000000000000000"),
            (0.0, "0"),
        ];
        for (x, text) in cases {
            assert_eq!(exact_decimal(x), DBig::from_str(text).unwrap(), "{x}");
        }
        for x in [f64::MAX, f64::MIN_POSITIVE, 5e-324, -0.3, 1.0 / 3.0] {
            let slowly = FBig::<HalfEven, 2>::try_from(x).unwrap();
            let slowly = slowly.with_base_and_precision::<10>(DIGITS).value();
            let slowly: DBig = slowly.with_rounding();
            assert_eq!(exact_decimal(x), slowly, "{x}");
        }
    }

    #[test]
    fn a_view_is_read_and_written_quickly() {
        let begun = std::time::Instant::now();
        for k in 0..200 {
            let number = Dd::parse(&format!("-1.66{k:030}")).unwrap();
            let again = Dd::parse(&number.to_string()).unwrap();
            assert!((again - number).abs().hi < 1e-30);
        }
        assert!(begun.elapsed().as_secs_f64() < 1.0, "{:?}", begun.elapsed());
    }

    #[test]
    fn decimals_are_parsed_to_both_halves() {
        let tenth = Dd::parse("0.1").unwrap();
        assert_eq!(tenth.hi, 0.1);
        assert_eq!(tenth.lo, -5.551_115_123_125_783e-18);
        assert_eq!(Dd::parse("3.14159265358979323846264338327950288"), Some(Dd::PI));
        assert_eq!(Dd::parse("-2.5e-3").unwrap().hi, -0.0025);
        assert_eq!(Dd::parse("0"), Some(Dd::new(0.0)));
        for text in ["1_0", "", "x", "1e", "nan", "inf", "1 2"] {
            assert_eq!(Dd::parse(text), None, "{text:?}");
        }
    }

    #[test]
    fn arithmetic_is_good_to_31_digits() {
        let third = Dd::new(1.0) / Dd::new(3.0);
        assert!((third * Dd::new(3.0) - Dd::new(1.0)).abs().hi < 1e-31);
        let two = Dd::new(2.0).sqrt();
        assert!((two * two - Dd::new(2.0)).abs().hi < 1e-31);
        assert_eq!(two.to_string(), "1.4142135623730950488016887242097");
    }

    #[test]
    fn sine_and_cosine_meet_known_values() {
        let (sin, cos) = (Dd::PI / Dd::new(6.0)).sin_cos();
        assert!((sin - Dd::new(0.5)).abs().hi < 1e-31);
        assert!((cos * cos - Dd::new(0.75)).abs().hi < 1e-31);
        for x in [-40.0, -3.0, -1e-9, 0.0, 0.7, 2.0, 100.0] {
            let (sin, cos) = Dd::new(x).sin_cos();
            assert!((sin * sin + cos * cos - Dd::new(1.0)).abs().hi < 1e-30);
            assert!((sin.hi - x.sin()).abs() < 1e-15 && (cos.hi - x.cos()).abs() < 1e-15);
        }
    }

    #[test]
    fn wrapping_lands_in_the_half_open_turn() {
        assert_eq!(Dd::PI.wrapped(), Dd::PI);
        assert_eq!((-Dd::PI).wrapped(), Dd::PI);
        let moved = Dd::new(0.5) + Dd::TAU;
        assert!((moved.wrapped() - Dd::new(0.5)).abs().hi < 1e-30);
    }
}
