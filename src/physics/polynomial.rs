//! Polynomials over one step, lowest power first, and their first rise through zero.

use super::real::{Real, Scalar};

/// Σ cₖ xᵏ by Horner's rule.
#[inline]
pub fn evaluate<T: Scalar>(coefficients: &[T], x: T) -> T {
    coefficients.iter().rev().fold(T::zero(), |sum, &c| sum.mul_add(x, c))
}

/// The quintic on [0, 1] with value, first and second derivative `at0` and `at1` at its ends.
#[inline]
pub fn quintic_hermite<T: Real>(at0: [T; 3], at1: [T; 3]) -> [T; 6] {
    let lit = |value| at0[0].lit(value);
    let ([f0, d0, s0], [f1, d1, s1]) = (at0, at1);
    let half = s0 * lit(0.5);
    // What is left for the three upper powers to make up at x = 1.
    let value = f1 - (f0 + d0 + half);
    let slope = d1 - (d0 + s0);
    let bend = s1 - s0;
    [
        f0,
        d0,
        half,
        lit(10.0) * value - lit(4.0) * slope + lit(0.5) * bend,
        lit(-15.0) * value + lit(7.0) * slope - bend,
        lit(6.0) * value - lit(3.0) * slope + lit(0.5) * bend,
    ]
}

/// The derivative's coefficients, in place of the value's; the last becomes zero.
fn derivative<T: Scalar, const N: usize>(coefficients: &[T; N]) -> [T; N] {
    std::array::from_fn(|k| match coefficients.get(k + 1) {
        Some(&c) => c * T::from_f64((k + 1) as f64),
        None => T::zero(),
    })
}

/// The first x in (0, 1] at which the polynomial, negative at 0, rises to zero: before its end
/// if it ends above zero, before its highest turning point if that is above zero.
#[inline]
pub fn first_rise<T: Scalar, const N: usize>(coefficients: &[T; N]) -> Option<T> {
    let one = T::from_f64(1.0);
    let slope = derivative(coefficients);
    let (start, end) = (coefficients[0], evaluate(coefficients, one));
    if end >= T::zero() {
        return (evaluate(&slope, one) > T::zero() || start < T::zero())
            .then(|| rise_before(coefficients, &slope, one));
    }
    if slope[0] <= T::zero() || evaluate(&slope, one) >= T::zero() {
        return None;
    }
    let peak = rise_before(&slope.map(|c| -c), &derivative(&slope).map(|c| -c), one);
    (evaluate(coefficients, peak) >= T::zero()).then(|| rise_before(coefficients, &slope, peak))
}

/// The root in [0, upper] of a polynomial that is negative at 0 and not at `upper`.
fn rise_before<T: Scalar, const N: usize>(f: &[T; N], slope: &[T; N], upper: T) -> T {
    root_between(f, slope, T::zero(), upper)
}

/// The root between `low`, where `f` is negative, and `high`, where it is not: Newton's steps
/// kept inside a shrinking bracket, until they no longer move.
pub fn root_between<T: Scalar>(f: &[T], slope: &[T], mut low: T, mut high: T) -> T {
    let half = T::from_f64(0.5);
    let mut x = (low + high) * half;
    for _ in 0..ROOT_STEPS {
        let value = evaluate(f, x);
        if value < T::zero() {
            low = x;
        } else {
            high = x;
        }
        let newton = x - value / evaluate(slope, x);
        let inside = newton >= low && newton <= high;
        let next = if inside { newton } else { (low + high) * half };
        if (next - x).abs().to_f64() <= T::EPSILON * x.abs().to_f64() {
            return next;
        }
        x = next;
    }
    x
}

/// Enough for 106 bits by bisection alone, should Newton never help.
const ROOT_STEPS: usize = 120;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quintic_meets_both_ends() {
        let (at0, at1) = ([1.0, -2.0, 0.5], [0.25, 3.0, -1.5]);
        let quintic = quintic_hermite(at0, at1);
        let mut f = quintic;
        for order in 0..3 {
            assert!((evaluate(&f, 0.0) - at0[order]).abs() < 1e-12);
            assert!((evaluate(&f, 1.0) - at1[order]).abs() < 1e-12);
            f = derivative(&f);
        }
    }

    #[test]
    fn a_plain_crossing_is_found() {
        let root: f64 = first_rise(&[-0.3, 1.0, 0.0]).unwrap();
        assert!((root - 0.3).abs() < 1e-15);
    }

    #[test]
    fn a_pass_that_falls_back_inside_the_step_is_found() {
        // 1e-4 − (x − ½)², above zero only between 0.49 and 0.51.
        let root: f64 = first_rise(&[1e-4 - 0.25, 1.0, -1.0]).unwrap();
        assert!((root - 0.49).abs() < 1e-12);
        assert_eq!(first_rise(&[-1e-4 - 0.25, 1.0, -1.0]), None);
    }

    #[test]
    fn falling_away_from_the_top_is_no_rise() {
        assert_eq!(first_rise(&[0.0, -1.0, 0.0]), None);
        assert_eq!(first_rise(&[0.0, 0.0, -1.0]), None);
        assert_eq!(first_rise(&[0.0, 0.0, 0.0]), None);
    }
}
