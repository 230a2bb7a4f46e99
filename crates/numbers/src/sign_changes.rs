//! The moments at which a polynomial changes sign, however soon after the beginning.

use crate::polynomial::{bernstein, course, halves};
use crate::real::Scalar;

/// Factor between the ends of successive parts of [0, 1] in the search.
const RATIO: f64 = 16.0;

/// Returns the x in (0, 1] at which the polynomial Σ cₖ xᵏ changes sign, in order. A zero at 0
/// counts as no change.
///
/// A root far below 1 is found with as many digits as one near 1. No root lies where the first term
/// outweighs all others (Cauchy's bound on roots); the search begins with a part that ends
/// [`RATIO`] times as far out, and each further part ends [`RATIO`] times as far out as the one
/// before.
pub fn sign_changes<T: Scalar, const N: usize>(coefficients: &[T; N]) -> Vec<T> {
    let zero = T::zero();
    let Some(first) = coefficients.iter().position(|c| *c != zero) else { return Vec::new() };
    // A zero of any order at 0 is divided out.
    let c: [T; N] = std::array::from_fn(|k| *coefficients.get(first + k).unwrap_or(&zero));
    let mut side = T::from_f64(if c[0] > zero { 1.0 } else { -1.0 });
    let (mut from, mut changes) = (zero, Vec::new());
    let mut to = (RATIO * first_balance(&c)).min(1.0);
    loop {
        let end = T::from_f64(to);
        let mut control = part(&c, from, end);
        while changes.len() < N
            && let Some(share) = course(&control, side).change
        {
            from = from + (end - from) * share;
            changes.push(from);
            side = -side;
            control = halves(&control, share)[1];
            control[0] = zero;
        }
        if to >= 1.0 {
            return changes;
        }
        (from, to) = (end, (RATIO * to).min(1.0));
    }
}

/// Returns an x below which the later terms of a polynomial are together smaller than its first
/// term, which must not be zero.
fn first_balance<T: Scalar, const N: usize>(c: &[T; N]) -> f64 {
    let size = |k: usize| c[k].to_f64().abs();
    let balances = |k: usize| (size(0) / (N as f64 * size(k))).powf(1.0 / k as f64);
    (1..N).map(balances).fold(1.0, f64::min)
}

/// The control points of a polynomial over a part of [0, 1].
fn part<T: Scalar, const N: usize>(c: &[T; N], from: T, to: T) -> [T; N] {
    let mut power = T::from_f64(1.0);
    let scaled = c.map(|c| {
        let term = c * power;
        power = power * to;
        term
    });
    let whole = bernstein(&scaled);
    if from > T::zero() { halves(&whole, from / to)[1] } else { whole }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Dd, Exact};

    fn changes(c: [f64; 5]) -> Vec<f64> {
        sign_changes(&c)
    }

    #[test]
    fn roots_are_found_to_all_digits_at_any_distance_from_zero() {
        for exponent in [0, 3, 10, 30, 80] {
            let root = 0.7 * 10f64.powi(-exponent);
            let at = changes([-root, 1.0, 0.0, 0.0, 0.0]);
            assert!(at.len() == 1 && (at[0] / root - 1.0).abs() < 1e-14, "{at:?}");
            let at = changes([root * root, 0.0, -1.0, 0.5, 0.0]);
            let near = 1.0 + 0.25 * root;
            assert!(at.len() == 1 && (at[0] / root / near - 1.0).abs() < 0.3 * root + 1e-14);
        }
        let tiny = Exact::from_f64(1e-40);
        let c = [-(tiny * tiny), Exact::ZERO, Exact::from_f64(1.0)];
        let at = sign_changes(&c);
        assert!(at.len() == 1 && (at[0].to_f64() / 1e-40 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn every_change_is_found_and_a_touch_is_none() {
        // −(x − 1e-8)(x − 1e-3)(x − 0.5)
        let product = |[a, b, c]: [f64; 3]| {
            [a * b * c, -(a * b + b * c + a * c), a + b + c, -1.0, 0.0].map(Dd::new)
        };
        let roots = [1e-8, 1e-3, 0.5];
        let at = sign_changes(&product(roots));
        assert_eq!(at.len(), 3);
        assert!(at.iter().zip(roots).all(|(at, root)| (at.hi / root - 1.0).abs() < 1e-7), "{at:?}");
        assert!(changes([0.25 + 1e-9, -1.0, 1.0, 0.0, 0.0]).is_empty(), "just above");
        assert_eq!(changes([0.25 - 1e-9, -1.0, 1.0, 0.0, 0.0]).len(), 2);
    }

    #[test]
    fn a_zero_at_the_beginning_is_no_change() {
        assert!(changes([0.0, 0.0, -1.0, 0.5, 0.0]).is_empty());
        let at = changes([0.0, 0.0, -1.0, 2.0, 0.0]);
        assert!(at.len() == 1 && (at[0] - 0.5).abs() < 1e-14, "{at:?}");
        assert!(changes([0.0; 5]).is_empty());
    }
}
