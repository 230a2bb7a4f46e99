//! Fixed-point numbers of any length, for the coordinates of a deep zoom and its reference
//! trajectory.
//!
//! All quantities in the equations are bounded, and a coordinate has to resolve an absolute
//! distance. A fixed binary point therefore loses nothing, and sums need a carry but no alignment.

mod convolution;
mod operators;

use std::fmt;

use dashu_int::IBig;

use crate::Dd;
use crate::decimal;
use crate::real::{Angle, Real, Scalar};

/// A signed number of `N` limbs of 64 bits: the last holds the integer part (two's complement), the
/// others the fraction, lowest first. Its magnitude is below 2⁶³.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Fixed<const N: usize>([u64; N]);

/// A number of 512 bits: enough for the angles of views down to 1e-100 rad wide, with 34 digits to
/// spare.
pub type Exact = Fixed<8>;

/// The limbs of π, highest first.
const PI: [u64; 9] = [
    0x0000_0000_0000_0003,
    0x243f_6a88_85a3_08d3,
    0x1319_8a2e_0370_7344,
    0xa409_3822_299f_31d0,
    0x082e_fa98_ec4e_6c89,
    0x4528_21e6_38d0_1377,
    0xbe54_66cf_34e9_0c6c,
    0xc0ac_29b7_c97c_50dd,
    0x3f84_d5b5_b547_0917,
];

/// Number of limbs, from 2 to 8, that give `bits` bits after the point; one limb is before it.
pub fn limbs_for(bits: u32) -> usize {
    1 + bits.div_ceil(64).clamp(1, 7) as usize
}

impl<const N: usize> Fixed<N> {
    /// The number zero.
    pub const ZERO: Self = Fixed([0; N]);
    /// Number of bits after the point.
    pub const BITS: u32 = 64 * (N as u32 - 1);

    /// The same number with `M` limbs, rounded down if these are fewer.
    pub fn resized<const M: usize>(self) -> Fixed<M> {
        let mut limbs = [0; M];
        for k in 1..=N.min(M) {
            limbs[M - k] = self.0[N - k];
        }
        Fixed(limbs)
    }

    /// The limbs, lowest first.
    pub fn limbs(self) -> [u64; N] {
        self.0
    }

    /// The number with these limbs, lowest first.
    pub fn from_limbs(limbs: [u64; N]) -> Self {
        Fixed(limbs)
    }

    /// Returns true if the number is below zero.
    pub fn is_negative(self) -> bool {
        self.0[N - 1] >> 63 == 1
    }

    fn magnitude(self) -> Self {
        if self.is_negative() { -self } else { self }
    }

    /// Returns the number times 2^`bits`; bits that do not fit are lost.
    pub fn doubled(self, bits: u32) -> Self {
        let (limbs, bits) = ((bits / 64) as usize, bits % 64);
        let limb = |k: isize| if k >= 0 { self.0[k as usize] } else { 0 };
        Fixed(std::array::from_fn(|k| {
            let k = k as isize - limbs as isize;
            let low = if bits == 0 { 0 } else { limb(k - 1) >> (64 - bits) };
            (limb(k) << bits) | low
        }))
    }

    /// Returns the number over 2^`bits`, rounded down.
    pub fn halved(self, bits: u32) -> Self {
        let (limbs, bits) = ((bits / 64) as usize, bits % 64);
        let sign = if self.is_negative() { u64::MAX } else { 0 };
        let limb = |k: usize| if k < N { self.0[k] } else { sign };
        Fixed(std::array::from_fn(|k| {
            let k = k + limbs;
            let high = if bits == 0 { 0 } else { limb(k + 1) << (64 - bits) };
            (limb(k) >> bits) | high
        }))
    }

    /// The number with its lowest `bits` bits cleared, which rounds it down.
    pub fn without_lowest(self, bits: u32) -> Self {
        Fixed(std::array::from_fn(|k| {
            let below = bits.saturating_sub(64 * k as u32).min(64);
            self.0[k] & u64::MAX.checked_shl(below).unwrap_or(0)
        }))
    }

    /// The product, rounded to nearest. The limbs are multiplied as if unsigned, and the effect of
    /// the signs is subtracted afterwards: no branch depends on the numbers.
    #[inline(never)]
    fn product(self, other: Self) -> Self {
        let (x, y) = (&self.0, &other.0);
        let mut columns = [[0u64; 2]; N];
        let columns = columns.as_flattened_mut();
        for i in 0..N {
            let mut carry = 0u64;
            // The limb just below the last one kept decides the rounding.
            for j in (N - 1).saturating_sub(i + 1)..N {
                let sum = u128::from(x[i]) * u128::from(y[j])
                    + u128::from(columns[i + j])
                    + u128::from(carry);
                columns[i + j] = sum as u64;
                carry = (sum >> 64) as u64;
            }
            columns[i + N] = carry;
        }
        let mut limbs = [0; N];
        limbs.copy_from_slice(&columns[N - 1..2 * N - 1]);
        let round = if N >= 2 { columns[N - 2] >> 63 } else { 0 };
        let above = |number: &[u64; N], sign: bool| {
            let mask = if sign { u64::MAX } else { 0 };
            Fixed(std::array::from_fn(|k| if k == 0 { 0 } else { number[k - 1] & mask }))
        };
        let rounding = Fixed(std::array::from_fn(|k| if k == 0 { round } else { 0 }));
        Fixed(limbs) + rounding - above(y, self.is_negative()) - above(x, other.is_negative())
    }

    /// The least positive number.
    fn least() -> Self {
        Fixed(std::array::from_fn(|k| u64::from(k == 0)))
    }

    /// The number divided by a positive integer.
    fn over(self, divisor: u64) -> Self {
        let mut rest = 0u128;
        let mut limbs = self.magnitude().0;
        for limb in limbs.iter_mut().rev() {
            let part = (rest << 64) | u128::from(*limb);
            *limb = (part / u128::from(divisor)) as u64;
            rest = part % u128::from(divisor);
        }
        if self.is_negative() { -Fixed(limbs) } else { Fixed(limbs) }
    }

    /// The reciprocal of a number in [½, 1), by Newton's iteration; each step doubles the digits.
    fn reciprocal(self) -> Self {
        let two = Self::from_f64(2.0);
        let mut x = Self::from_f64(1.0 / self.to_f64());
        let mut bits = 50;
        while bits < 64 * N {
            x = x.product(two - self.product(x));
            bits *= 2;
        }
        x
    }

    /// Number of bits by which a positive number must be shifted left to lie in [½, 1); a negative
    /// count shifts it right.
    fn shift_to_half(self) -> i64 {
        let top = self.0.iter().rposition(|&limb| limb != 0).unwrap_or(0);
        let bit = 64 * top as i64 + 63 - i64::from(self.0[top].leading_zeros());
        i64::from(Self::BITS) - 1 - bit
    }

    fn shifted(self, bits: i64) -> Self {
        if bits >= 0 { self.doubled(bits as u32) } else { self.halved(bits.unsigned_abs() as u32) }
    }

    /// Returns the angle without whole turns, in (−π, π].
    pub fn wrapped(self) -> Self {
        let tau = Self::pi().doubled(1);
        let turns = (self.to_f64() / std::f64::consts::TAU).round();
        let angle = if turns == 0.0 { self } else { self - tau * Self::from_f64(turns) };
        if angle > Self::pi() {
            angle - tau
        } else if angle <= -Self::pi() {
            angle + tau
        } else {
            angle
        }
    }

    /// The nearest double-double number.
    pub fn to_dd(self) -> Dd {
        let hi = self.to_f64();
        Dd { hi, lo: (self - Self::from_f64(hi)).to_f64() }
    }

    /// The number nearest to a double-double number.
    pub fn from_dd(value: Dd) -> Self {
        Self::from_f64(value.hi) + Self::from_f64(value.lo)
    }

    /// Formats the number with `digits` digits after the point, without trailing zeros.
    pub fn decimal(self, digits: usize) -> String {
        let bytes: Vec<u8> = self.0.iter().flat_map(|limb| limb.to_le_bytes()).collect();
        decimal::written(IBig::from_le_bytes(&bytes), Self::BITS as usize, digits)
    }
}

impl<const N: usize> Real for Fixed<N> {
    fn lit(self, value: f64) -> Self {
        Self::from_f64(value)
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }
}

impl<const N: usize> Angle for Fixed<N> {
    /// Sums Taylor series after removing quarter turns.
    fn sin_cos(self) -> (Self, Self) {
        let half_pi = Self::pi().halved(1);
        let quarters = (self.to_f64() / std::f64::consts::FRAC_PI_2).round();
        let r = self - half_pi * Self::from_f64(quarters);
        let (sin, cos) = (series(r, r, 1), series(r, Self::from_f64(1.0), 0));
        match (quarters as i64).rem_euclid(4) {
            0 => (sin, cos),
            1 => (cos, -sin),
            2 => (-sin, -cos),
            _ => (-cos, sin),
        }
    }
}

/// Sums ± r^n / n! over every second n from `order` on; `first` is the term at n = `order`.
fn series<const N: usize>(r: Fixed<N>, first: Fixed<N>, order: u64) -> Fixed<N> {
    let square = r * r;
    let (mut term, mut sum, mut n) = (first, first, order);
    while term.magnitude() > Fixed::least() {
        term = -(term * square).over((n + 1) * (n + 2));
        sum = sum + term;
        n += 2;
    }
    sum
}

impl<const N: usize> Scalar for Fixed<N> {
    const EPSILON: f64 = {
        let (mut epsilon, mut bit) = (1.0, 0);
        // Eight bits are reserved for rounding errors.
        while bit < Self::BITS - 8 {
            epsilon *= 0.5;
            bit += 1;
        }
        epsilon
    };

    const FLOATING: bool = false;

    fn from_f64(value: f64) -> Self {
        let (whole, exponent) = integer_and_exponent(value);
        let mut limbs = [0; N];
        limbs[0] = whole;
        let shift = i64::from(Self::BITS) + i64::from(exponent);
        let magnitude = Fixed(limbs).shifted(shift);
        if value < 0.0 { -magnitude } else { magnitude }
    }

    fn to_f64(self) -> f64 {
        let magnitude = self.magnitude();
        let Some(top) = magnitude.0.iter().rposition(|&limb| limb != 0) else { return 0.0 };
        let below = if top > 0 { magnitude.0[top - 1] } else { 0 };
        // Limbs below the top two only decide ties.
        let rest = magnitude.0[..top.saturating_sub(1)].iter().any(|&limb| limb != 0);
        let two = (u128::from(magnitude.0[top]) << 64) | u128::from(below) | u128::from(rest);
        let scale = 2f64.powi(64 * (top as i32 - 1) - Self::BITS as i32);
        let value = two as f64 * scale;
        if self.is_negative() { -value } else { value }
    }

    fn pi() -> Self {
        Fixed(std::array::from_fn(|k| PI[N - 1 - k]))
    }

    fn sqrt(self) -> Self {
        if self <= Self::ZERO {
            return Self::ZERO;
        }
        let mut root = Self::from_f64(self.to_f64().sqrt());
        let mut bits = 50;
        while bits < 64 * N {
            root = (root + self / root).halved(1);
            bits *= 2;
        }
        root
    }

    fn from_theta(value: Exact) -> Self {
        value.resized()
    }

    fn parse(text: &str) -> Option<Self> {
        let value = decimal::read(text, Self::BITS as usize)?;
        let bytes = value.to_le_bytes();
        if bytes.len() > 8 * N {
            return None;
        }
        let fill = if value < IBig::ZERO { 0xff } else { 0 };
        let byte = |k: usize| bytes.get(k).copied().unwrap_or(fill);
        Some(Fixed(std::array::from_fn(|limb| {
            u64::from_le_bytes(std::array::from_fn(|k| byte(8 * limb + k)))
        })))
    }

    fn is_finite(self) -> bool {
        true
    }

    fn convolution(x: &[Self], y: &[Self], bits: u32) -> Self {
        convolution::convolution(x, y, limbs_for(bits).min(N))
    }
}

/// The magnitude of a finite f64 as an integer times a power of two.
fn integer_and_exponent(value: f64) -> (u64, i32) {
    let bits = value.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as i32;
    let fraction = bits & ((1 << 52) - 1);
    if exponent == 0 { (fraction, -1074) } else { (fraction | (1 << 52), exponent - 1075) }
}

impl<const N: usize> fmt::Display for Fixed<N> {
    /// Writes all digits, or as many after the point as the precision requests.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let all = (f64::from(Self::BITS) * std::f64::consts::LOG10_2) as usize;
        f.write_str(&self.decimal(f.precision().unwrap_or(all)))
    }
}

impl<const N: usize> fmt::Debug for Fixed<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type Long = Fixed<8>;

    fn long(text: &str) -> Long {
        Long::parse(text).unwrap()
    }

    #[test]
    fn the_lowest_bits_are_dropped_downwards() {
        let some = (Fixed::<4>::from_f64(1.0) / Fixed::from_f64(3.0)).doubled(3);
        for x in [some, -some, Fixed::ZERO, Fixed::from_f64(-2.0)] {
            for bits in [0, 1, 63, 64, 65, 127, 128, 191, 192, 200] {
                let expected = x.halved(bits).doubled(bits);
                assert_eq!(x.without_lowest(bits), expected, "{bits}");
            }
        }
    }

    proptest! {
        #[test]
        fn sums_products_and_quotients_are_those_of_f64(a in -1e3..1e3f64, b in -1e3..1e3f64) {
            let (x, y) = (Long::from_f64(a), Long::from_f64(b));
            prop_assert_eq!(x.to_f64(), a);
            prop_assert_eq!((x + y).to_f64(), a + b);
            prop_assert_eq!((x - y).to_f64(), a - b);
            prop_assert_eq!((x * y).to_f64(), a * b);
            prop_assume!(b.abs() > 1e-6);
            prop_assert_eq!((x / y).to_f64(), a / b);
            prop_assert_eq!(x < y, a < b);
            prop_assert_eq!(x.resized::<3>().resized::<8>(), x);
        }

        #[test]
        fn a_quotient_times_its_divisor_is_the_dividend(a in -1e3..1e3f64, b in 1e-6..1e3f64) {
            let (x, y) = (Long::from_f64(a), Long::from_f64(b));
            let rest = (x / y) * y - x;
            prop_assert!(rest.to_f64().abs() < 1e-125, "{}", rest.to_f64());
        }

        #[test]
        fn sines_and_cosines_lie_on_the_circle(a in -30.0..30.0f64) {
            let (sin, cos) = Long::from_f64(a).sin_cos();
            prop_assert!((sin * sin + cos * cos - Long::from_f64(1.0)).to_f64().abs() < 1e-130);
            prop_assert!((sin.to_f64() - a.sin()).abs() < 1e-15);
            prop_assert!((cos.to_f64() - a.cos()).abs() < 1e-15);
        }

        #[test]
        fn decimals_are_read_as_they_are_written(limbs in any::<[u64; 7]>(), whole in -99i64..99) {
            let mut all = [0; 8];
            all[..7].copy_from_slice(&limbs);
            all[7] = whole as u64;
            let x = Long::from_limbs(all);
            prop_assert_eq!(long(&x.decimal(140)), x);
        }
    }

    #[test]
    fn pi_is_what_a_hundred_digits_say() {
        let text = "3.1415926535897932384626433832795028841971693993751058209749445923078164062862\
                    089986280348253421170679821480865132823066470938446095505822317253594";
        assert!((Long::pi() - long(text)).to_f64().abs() < 1e-133);
        assert_eq!(Fixed::<3>::pi().to_dd(), Dd::PI);
        assert!(Long::pi().sin_cos().0.to_f64().abs() < 1e-130);
    }

    #[test]
    fn roots_are_exact_to_the_last_digits() {
        let root = Long::from_f64(2.0).sqrt();
        assert!((root * root - Long::from_f64(2.0)).to_f64().abs() < 1e-130);
    }

    #[test]
    fn angles_are_wrapped_exactly() {
        let (tau, small) = (Long::pi().doubled(1), long("1e-100"));
        assert_eq!((tau + small).wrapped(), small);
        assert_eq!((-tau - tau - small).wrapped(), -small);
        assert_eq!((-Long::pi()).wrapped(), Long::pi());
        assert!((Long::pi() + small).wrapped() < Long::ZERO);
    }

    #[test]
    fn far_digits_are_kept() {
        assert!((long("-1.5e-120").to_f64() / -1.5e-120 - 1.0).abs() < 1e-13);
        assert_eq!(long("0.1") + long("1e-110") - long("0.1"), long("1e-110"));
        assert_eq!(long("-1.25").decimal(30), "-1.25");
        assert_eq!(Long::ZERO.decimal(5), "0");
        assert_eq!(Long::from_dd(Dd::PI).to_dd(), Dd::PI);
    }
}
