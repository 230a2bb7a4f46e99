//! Polynomials over one step, lowest power first, and their first rise through zero.

use crate::real::{Real, Scalar};

/// Evaluates Σ cₖ xᵏ by Horner's rule.
#[inline]
pub fn evaluate<T: Scalar>(coefficients: &[T], x: T) -> T {
    coefficients.iter().rev().fold(T::zero(), |sum, &c| sum.mul_add(x, c))
}

/// The quintic on [0, 1] with the value, first and second derivative `at0` at 0 and `at1` at 1.
#[inline]
pub fn quintic_hermite<T: Real>(at0: [T; 3], at1: [T; 3]) -> [T; 6] {
    let lit = |value| at0[0].lit(value);
    let ([f0, d0, s0], [f1, d1, s1]) = (at0, at1);
    let half = s0 * lit(0.5);
    // The remainders at x = 1 that the three highest powers must supply.
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

/// Returns the first x in (0, 1] at which a polynomial that begins below zero reaches zero, however
/// briefly; 0 if it begins at zero and rises.
#[inline]
pub fn first_rise<T: Scalar, const N: usize>(coefficients: &[T; N]) -> Option<T> {
    let mut coefficients = *coefficients;
    if coefficients[0] >= T::zero() {
        if coefficients[1] > T::zero() {
            return Some(T::zero());
        }
        // A value above zero is a start at zero with a rounding error.
        coefficients[0] = T::zero();
    }
    course(&bernstein(&coefficients), -T::from_f64(1.0)).change
}

/// Returns the control points over [0, 1] of the polynomial with these coefficients. The polynomial
/// begins at the first, ends at the last, and lies between the least and the greatest (Bernstein
/// 1912).
pub fn bernstein<T: Scalar, const N: usize>(coefficients: &[T; N]) -> [T; N] {
    std::array::from_fn(|k| {
        let mut share = T::from_f64(1.0);
        (0..=k).fold(T::zero(), |sum, j| {
            if j > 0 {
                // C(k, j) / C(N − 1, j).
                share = share * T::from_f64((k + 1 - j) as f64) / T::from_f64((N - j) as f64);
            }
            sum + coefficients[j] * share
        })
    })
}

/// The course over [0, 1] of a polynomial that begins on one side of zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course<T> {
    /// The first x in (0, 1] at which the polynomial is no longer on that side.
    pub change: Option<T>,
    /// Lower bound on its distance from zero until it finally falls to zero.
    pub clearance: T,
}

/// Determines the course of the polynomial with these control points, which begins at zero or on
/// `side` of it (1 or −1). Parts are halved until their control points decide: if all are on that
/// side, zero is not reached; if they fall steadily, it is crossed at most once.
pub fn course<T: Scalar, const N: usize>(control: &[T; N], side: T) -> Course<T> {
    let clearance = control.iter().fold(T::zero(), |most, &c| most.max(c.abs()));
    let mut search = RootSearch { side, parts: MAX_PARTS, clearance };
    let change = search.change(control, [T::zero(), T::from_f64(1.0)]);
    Course { change, clearance: search.clearance }
}

/// Maximum number of parts into which a polynomial is cut: a pass takes about sixty, but noise
/// around zero could take any number.
const MAX_PARTS: u32 = 400;

struct RootSearch<T> {
    side: T,
    parts: u32,
    clearance: T,
}

impl<T: Scalar> RootSearch<T> {
    fn change<const N: usize>(&mut self, control: &[T; N], [from, to]: [T; 2]) -> Option<T> {
        self.parts = self.parts.saturating_sub(1);
        let least = control[1..].iter().map(|&point| self.side * point).reduce(least)?;
        if least > T::zero() {
            self.clearance = self::least(self.clearance, least);
            return None;
        }
        let end = self.side * control[N - 1];
        if control.windows(2).all(|pair| self.side * (pair[1] - pair[0]) < T::zero()) {
            return (end <= T::zero()).then(|| from + (to - from) * only_zero(control, self.side));
        }
        let middle = (from + to) * T::from_f64(0.5);
        // A shorter pass cannot be distinguished from none.
        if self.parts == 0 || (to - from).to_f64() < T::EPSILON.sqrt() {
            self.clearance = self::least(self.clearance, end.abs());
            return (end < T::zero()).then_some(to);
        }
        let [first, second] = halves(control, T::from_f64(0.5));
        self.change(&first, [from, middle]).or_else(|| self.change(&second, [middle, to]))
    }
}

fn least<T: Scalar>(a: T, b: T) -> T {
    if b < a { b } else { a }
}

/// The control points of the parts before and after `x` (de Casteljau 1959).
pub fn halves<T: Scalar, const N: usize>(control: &[T; N], x: T) -> [[T; N]; 2] {
    let (mut first, mut second) = (*control, *control);
    for (k, first) in first.iter_mut().enumerate().skip(1) {
        for j in 0..N - k {
            second[j] = second[j] + (second[j + 1] - second[j]) * x;
        }
        *first = second[0];
    }
    [first, second]
}

/// The zero of a polynomial that falls from `side` to beyond zero, by false position with the
/// Illinois rule: the value at an end that is retained twice in a row is halved (Dowell and Jarratt
/// 1971). Halving it each time would make the order 1: 46 iterations for an f64 instead of 6.
fn only_zero<T: Scalar, const N: usize>(control: &[T; N], side: T) -> T {
    let (half, zero) = (T::from_f64(0.5), T::zero());
    let (mut low, mut high) = (zero, T::from_f64(1.0));
    let (mut at_low, mut at_high) = (side * control[0], side * control[N - 1]);
    let mut x = high;
    // True if the last iteration retained the high end, false if the low one.
    let mut retained_high = None;
    for _ in 0..ROOT_STEPS {
        let next = (low * at_high - high * at_low) / (at_high - at_low);
        // Roots near zero keep their relative accuracy.
        let size = if T::FLOATING { next.to_f64() } else { 1.0 };
        let still = (next - x).abs().to_f64() <= T::EPSILON * size;
        x = next;
        if still || !(next > low && next < high) {
            break;
        }
        let value = side * halves(control, x)[0][N - 1];
        let retains_high = value > zero;
        let is_again = retained_high.replace(retains_high) == Some(retains_high);
        let weight = if is_again { half } else { T::from_f64(1.0) };
        if retains_high {
            (low, at_low, at_high) = (x, value, at_high * weight);
        } else {
            (high, at_high, at_low) = (x, value, at_low * weight);
        }
    }
    x.max(low)
}

/// Finds the root between `low`, where `f` is negative, and `high`, where it is not, by Newton's
/// method inside a shrinking bracket.
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

/// Maximum number of iterations: enough for 106 bits by bisection alone, should Newton never help.
const ROOT_STEPS: usize = 120;

#[cfg(test)]
mod tests {
    use super::*;

    fn derivative(f: &[f64; 6]) -> [f64; 6] {
        std::array::from_fn(|k| f.get(k + 1).map_or(0.0, |&c| c * (k + 1) as f64))
    }

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
    fn a_pass_between_two_turns_is_found() {
        // The polynomial rises over zero, falls and rises again: both ends lie below zero, so
        // neither shows the pass.
        for over in [1e-2, 1e-5, 1e-9] {
            let f = |x: f64| over - 8.0 * (x - 0.3).powi(2) * (1.1 - x);
            let fit: [f64; 4] = [over - 0.792, 6.0, -13.6, 8.0];
            assert!((evaluate(&fit, 0.7) - f(0.7)).abs() < 1e-12);
            let root = first_rise(&fit).expect("over the top");
            assert!(f(root).abs() < 1e-9 && root < 0.3, "{over}: {root}");
            let below: [f64; 4] = [-over - 0.792, 6.0, -13.6, 8.0];
            assert_eq!(first_rise(&below), None, "{over}");
        }
    }

    #[test]
    fn a_rise_from_rest_is_found_in_the_first_step() {
        // t² − 1e-12 − 4t⁴: over the top from 1e-6 on, and back before the end.
        let root: f64 = first_rise(&[-1e-12, 0.0, 1.0, 0.0, -4.0]).unwrap();
        assert!((root - 1e-6).abs() < 1e-12, "{root:e}");
        assert_eq!(first_rise(&[-1e-12, 0.0, -1.0, 0.0, 0.9]), None);
    }

    #[test]
    fn falling_away_from_the_top_is_no_rise() {
        assert_eq!(first_rise(&[0.0, -1.0, 0.0]), None);
        assert_eq!(first_rise(&[0.0, 0.0, -1.0]), None);
        assert_eq!(first_rise(&[0.0, 0.0, 0.0]), None);
    }
}
