//! Sine and cosine from sums and products only.
//!
//! SIMD lanes and graphics cards use these: the shading language guarantees its own sine and cosine
//! only to 2⁻¹¹, and in f64 drivers return garbage (wgpu issue 6087).

use crate::real::{Angle, Real};

/// A number that can be rounded to an integer.
pub trait Rounding: Real {
    /// Returns the nearest integer, ties to even.
    fn nearest(self) -> Self;
}

/// Polynomials in x² for (sin x / x − 1) / x² and (cos x − 1) / x² on [−π/2, π/2].
#[derive(Clone, Copy, Debug)]
pub struct SinCosSeries<const S: usize, const C: usize> {
    sin: [f64; S],
    cos: [f64; C],
}

/// Series for f32, interpolated at Chebyshev points over [0, 1.01 π²/4] with 50 digits; error 2e-9.
pub const SERIES_F32: SinCosSeries<4, 5> = SinCosSeries {
    sin: [
        -0.16666665935514005,
        0.008333239400925367,
        -0.00019822372396907675,
        2.6335730450293468e-06,
    ],
    cos: [
        -0.49999999962127106,
        0.0416666590659028,
        -0.0013888644537268546,
        2.4774044881252042e-05,
        -2.6285198084480333e-07,
    ],
};

/// Series for f64, obtained in the same way; error 2e-17.
pub const SERIES_F64: SinCosSeries<8, 8> = SinCosSeries {
    sin: [
        -0.16666666666666666,
        0.008333333333333314,
        -0.00019841269841254063,
        2.7557319218918382e-06,
        -2.5052107585970116e-08,
        1.6058975310917623e-10,
        -7.64390671129415e-13,
        2.7306558712256386e-15,
    ],
    cos: [
        -0.5,
        0.04166666666666631,
        -0.0013888888888858983,
        2.480158729198234e-05,
        -2.7557317708542683e-07,
        2.087662707562331e-09,
        -1.1464569428804283e-11,
        4.626181512196047e-14,
    ],
};

/// Two parts of π for f32, the first so short (8 bits) that a small integer times it is exact (Cody
/// and Waite 1980); good for up to 2¹⁰ half turns.
pub const PI_PARTS_F32: [f64; 2] = [3.140625, 9.676535897932384e-4];
/// Two parts of π for f64, with 33 bits in the first.
pub const PI_PARTS_F64: [f64; 2] = [3.141_592_653_468_251_2, 1.215_420_101_301_238e-10];

/// Sine and cosine of `x` (rad): half turns are removed, then both series are summed on
/// [−π/2, π/2], which leaves no quadrant to choose and hence no branch.
///
/// The sine is exactly odd and the cosine exactly even, so that mirrored starts stay mirrored.
/// `pi_parts` and `series` are the constants above for the number type.
#[inline(always)]
pub fn sin_cos_with<T: Rounding, const S: usize, const C: usize>(
    x: T,
    pi_parts: [f64; 2],
    series: &SinCosSeries<S, C>,
) -> (T, T) {
    let half_turns = (x * x.lit(std::f64::consts::FRAC_1_PI)).nearest();
    let r = half_turns.mul_add(x.lit(-pi_parts[0]), x);
    let r = half_turns.mul_add(x.lit(-pi_parts[1]), r);
    // (−1)^half_turns, from the distance of half_turns/2 to the nearest integer: 0 or ±½.
    let half = half_turns * x.lit(0.5);
    let odd = half - half.nearest();
    let sign = (odd * odd).mul_add(x.lit(-8.0), x.lit(1.0));

    let square = r * r;
    let fourth = square * square;
    let sin = in_pairs(square, fourth, &series.sin);
    let cos = in_pairs(square, fourth, &series.cos);
    let signed = sign * r;
    ((sin * square).mul_add(signed, signed), (cos * square).mul_add(sign, sign))
}

/// Sums termₖ xᵏ with `square` = x²: neighbouring terms are joined first, so that half of the work
/// need not wait for the other half (Estrin 1960).
#[inline(always)]
fn in_pairs<T: Real, const N: usize>(x: T, square: T, terms: &[f64; N]) -> T {
    let last = (N - 1) / 2 * 2;
    let mut sum = pair(x, terms, last);
    for k in (0..last).step_by(2).rev() {
        sum = sum.mul_add(square, pair(x, terms, k));
    }
    sum
}

/// Two neighbouring terms of a series: termₖ + termₖ₊₁ x.
#[inline(always)]
fn pair<T: Real, const N: usize>(x: T, terms: &[f64; N], k: usize) -> T {
    if k + 1 < N { x.mul_add(x.lit(terms[k + 1]), x.lit(terms[k])) } else { x.lit(terms[k]) }
}

/// The method that finds the directions of a step's inner stages from the direction at its
/// beginning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turning {
    /// A sine and cosine computed afresh for each stage.
    Fresh,
    /// The initial direction turned through the small angle to the stage, with this many terms
    /// after the first of each series: a third of the work, without range reduction.
    Small(usize),
}

impl Turning {
    /// Returns the cheapest method that turns through at most `most` rad with a relative error
    /// below `epsilon`.
    pub fn within(most: f64, epsilon: f64) -> Self {
        let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
        let left = |terms: usize| most.powi(2 * terms as i32 + 2) / factorial(2 * terms + 2);
        TURNING_TERMS
            .into_iter()
            .find(|&terms| left(terms) < 0.25 * epsilon)
            .map_or(Turning::Fresh, Turning::Small)
    }

    /// Returns `(sine, cosine)` of `angle + change`, where `direction` is the pair of `angle`.
    #[inline(always)]
    pub fn turned<T: Angle>(self, direction: (T, T), angle: T, change: T) -> (T, T) {
        let Turning::Small(terms) = self else {
            return (angle + change).sin_cos();
        };
        let (sin, cos) = small_series(change, terms);
        let (y, x) = direction;
        // cos = 1 + (cos − 1): the small parts are summed first.
        (x.mul_add(sin, y.mul_add(cos, y)), (-y).mul_add(sin, x.mul_add(cos, x)))
    }
}

/// Numbers of terms to choose from: few, because the CPU kernels are compiled for each. More terms
/// than the last would cost as much as a fresh sine and cosine.
pub(crate) const TURNING_TERMS: [usize; 3] = [2, 4, 6];

/// Computes `(sin x, cos x − 1)` of a small `x`, with `terms` terms after the first of the sine.
#[inline(always)]
fn small_series<T: Real>(x: T, terms: usize) -> (T, T) {
    let square = x * x;
    let mut sin = x.lit(TAYLOR[2 * terms + 1]);
    let mut cos = x.lit(TAYLOR[2 * terms]);
    for k in (1..terms).rev() {
        sin = sin.mul_add(square, x.lit(TAYLOR[2 * k + 1]));
        cos = cos.mul_add(square, x.lit(TAYLOR[2 * k]));
    }
    ((sin * square).mul_add(x, x), cos * square)
}

/// Coefficients 1/n! with the signs of the sine (odd n) and the cosine (even n).
const TAYLOR: [f64; 14] = {
    let mut terms = [1.0; 14];
    let (mut n, mut factorial) = (1, 1.0);
    while n < 14 {
        factorial *= n as f64;
        terms[n] = if n % 4 < 2 { 1.0 } else { -1.0 } / factorial;
        n += 1;
    }
    terms
};

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::{Add, Div, Mul, Neg, Sub};

    /// An f64 that takes its sine from this module instead of the C library.
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
    }
    impl Angle for Plain {
        fn sin_cos(self) -> (Self, Self) {
            sin_cos_with(self, PI_PARTS_F64, &SERIES_F64)
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
    fn small_turns_are_as_good_as_fresh_ones() {
        for (most, epsilon) in [(0.13, 6e-8), (0.13, 1.1e-16), (0.6, 6e-8)] {
            let turning = Turning::within(most, epsilon);
            assert!(matches!(turning, Turning::Small(_)), "{most} {epsilon}");
            for i in -100..=100 {
                let (angle, change) = (0.05 * f64::from(i), most * f64::from(i) / 100.0);
                let (sin, cos) = turning.turned(angle.sin_cos(), angle, change);
                let (true_sin, true_cos) = (angle + change).sin_cos();
                let error = (sin - true_sin).abs().max((cos - true_cos).abs());
                assert!(error < epsilon + 4.0 * f64::EPSILON, "{most} {epsilon} {change}: {error}");
            }
        }
        assert_eq!(Turning::within(10.0, 1e-16), Turning::Fresh);
    }

    #[test]
    fn the_parts_of_pi_sum_to_pi() {
        use crate::dd::Dd;
        let sum = |[first, second]: [f64; 2]| Dd::new(first) + Dd::new(second);
        assert!((sum(PI_PARTS_F64) - Dd::PI).hi.abs() < 1e-25);
        assert!((sum(PI_PARTS_F32) - Dd::PI).hi.abs() < 1e-15);
    }
}
