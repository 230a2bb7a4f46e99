//! Sine and cosine from sums and products only.
//!
//! SIMD lanes and graphics cards get theirs from here: the shading language promises its own
//! only to 2⁻¹¹, and for f64 drivers return garbage (wgpu issue 6087).

use super::real::Real;

/// A number that can be rounded to an integer.
pub trait Rounding: Real {
    /// The nearest integer, ties to even.
    fn nearest(self) -> Self;
}

/// Terms after the first that f32 needs of each series on [−π/2, π/2].
pub const TERMS_F32: usize = 6;
/// The same for f64.
pub const TERMS_F64: usize = 10;

/// π for f32: 8 and 11 bits, and the rest; exact for up to 2¹³ half turns.
pub const PI_PARTS_F32: &[f64] = &[
    3.140625,
    9.675_025_939_941_406e-4,
    1.509_957_990_978_376_5e-7,
];
/// π for f64: 33 and 33 bits, and the rest (Cody and Waite 1980).
pub const PI_PARTS_F64: &[f64] = &[
    3.141_592_653_468_251_2,
    1.215_420_101_260_793_2e-10,
    4.044_532_497_591_901e-21,
];

/// Sine and cosine of `x` (rad): half turns are taken out, then both Taylor series on
/// [−π/2, π/2], which leaves no quadrant to choose and hence no branch.
///
/// Exactly odd in the sine and even in the cosine, so that mirrored starts stay mirrored.
/// `terms` and `pi_parts` are those of the number type, above.
#[inline(always)]
pub fn sin_cos_with<T: Rounding>(x: T, terms: usize, pi_parts: &[f64]) -> (T, T) {
    let half_turns = (x * x.lit(std::f64::consts::FRAC_1_PI)).nearest();
    let mut r = x;
    for &part in pi_parts {
        r = half_turns.mul_add(x.lit(-part), r);
    }
    // (−1)^half_turns, from how far half of it is from an integer: 0 or ±½.
    let half = half_turns * x.lit(0.5);
    let odd = half - half.nearest();
    let sign = (odd * odd).mul_add(x.lit(-8.0), x.lit(1.0));

    let square = r * r;
    let (mut sin, mut cos) = (x.lit(0.0), x.lit(0.0));
    for k in (1..=terms).rev() {
        let alternate = if k % 2 == 0 { 1.0 } else { -1.0 };
        sin = square * (sin + x.lit(alternate / factorial(2 * k + 1)));
        cos = square * (cos + x.lit(alternate / factorial(2 * k)));
    }
    (sign * sin.mul_add(r, r), sign.mul_add(cos, sign))
}

#[inline(always)]
fn factorial(n: usize) -> f64 {
    (1..=n).fold(1.0, |product, k| product * k as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::{Add, Div, Mul, Neg, Sub};

    /// f64 that takes its sine from here instead of the C library.
    #[derive(Clone, Copy, Debug)]
    struct Plain(f64);
    macro_rules! operator {
        ($trait:ident $name:ident $op:tt) => {
            impl $trait for Plain {
                type Output = Plain;
                fn $name(self, other: Plain) -> Plain {
                    Plain(self.0 $op other.0)
                }
            }
        };
    }
    operator!(Add add +);
    operator!(Sub sub -);
    operator!(Mul mul *);
    operator!(Div div /);
    impl Neg for Plain {
        type Output = Plain;
        fn neg(self) -> Plain {
            Plain(-self.0)
        }
    }
    impl Real for Plain {
        fn lit(self, value: f64) -> Self {
            Plain(value)
        }
        fn mul_add(self, factor: Self, term: Self) -> Self {
            Plain(self.0 * factor.0 + term.0)
        }
        fn sin_cos(self) -> (Self, Self) {
            sin_cos_with(self, TERMS_F64, PI_PARTS_F64)
        }
    }
    impl Rounding for Plain {
        fn nearest(self) -> Self {
            Plain(self.0.round_ties_even())
        }
    }

    #[test]
    fn agrees_with_the_library_to_the_last_bits() {
        for i in -40_000..=40_000 {
            let x = f64::from(i) * 1.7e-3 + 1e-7;
            let (sin, cos) = Plain(x).sin_cos();
            assert!((sin.0 - x.sin()).abs() < 6e-16, "sin {x}");
            assert!((cos.0 - x.cos()).abs() < 6e-16, "cos {x}");
        }
    }

    #[test]
    fn is_exactly_odd_and_even() {
        for i in 0..10_000 {
            let x = f64::from(i) * 1.3e-3;
            let ((s, c), (ms, mc)) = (Plain(x).sin_cos(), Plain(-x).sin_cos());
            assert!(s.0 == -ms.0 && c.0 == mc.0, "{x}");
        }
    }

    #[test]
    fn the_parts_of_pi_sum_to_pi() {
        use crate::physics::dd::Dd;
        let sum = |parts: &[f64]| parts.iter().fold(Dd::new(0.0), |sum, &p| sum + Dd::new(p));
        assert!((sum(PI_PARTS_F64) - Dd::PI).hi.abs() < 1e-29);
        assert!((sum(PI_PARTS_F32) - Dd::PI).hi.abs() < 1e-15);
    }
}
