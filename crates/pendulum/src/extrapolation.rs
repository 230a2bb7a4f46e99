//! Trial steps by extrapolation of Gragg's midpoint rule, a method of any order. Its coefficients
//! are ratios of whole numbers, so it is as exact in double-double and in fixed point as in f64. It
//! shares nothing with expansions and embedded pairs, so it can check both.
//!
//! The errors of the rule with 2, 4, … 2K midpoints contain only even powers of its step; the
//! combination that cancels the first K − 1 of these is of order 2K (Gragg 1965; Bulirsch and Stoer
//! 1966; Hairer, Nørsett and Wanner, *Solving Ordinary Differential Equations I*, 2nd ed., II.9).

use crate::pendulum::Pendulum;
use crate::phase::Phase;
use flipmap_numbers::real::{Real, Scalar};

/// The weights with which the rules with 2, 4, … 2K midpoints are combined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights<T, const K: usize> {
    /// Weights of all rules in their combination.
    pub all: [T; K],
    /// Differences from the weights without the last rule, which give the error of that
    /// combination.
    pub error: [T; K],
}

impl<T: Scalar, const K: usize> Weights<T, K> {
    /// Lagrange's weights for extrapolation to the step 0, in squares of the steps.
    pub fn new() -> Self {
        let weights = |count: usize| -> [T; K] {
            std::array::from_fn(|j| {
                if j >= count {
                    return T::zero();
                }
                let square = |k: usize| ((k + 1) * (k + 1)) as f64;
                let others = (0..count).filter(|&k| k != j);
                others.fold(T::from_f64(1.0), |product, k| {
                    product * T::from_f64(square(j)) / T::from_f64(square(j) - square(k))
                })
            })
        };
        let (all, fewer) = (weights(K), weights(K - 1));
        Weights { all, error: std::array::from_fn(|j| all[j] - fewer[j]) }
    }
}

impl<T: Scalar, const K: usize> Default for Weights<T, K> {
    fn default() -> Self {
        Self::new()
    }
}

/// The power of the step with which the estimated error falls.
pub const fn order(columns: usize) -> u32 {
    2 * columns as u32 - 1
}

/// Number of right-hand sides in a step.
pub const fn rhs_per_step(columns: usize) -> usize {
    columns * (columns + 1) + 1
}

/// The change over a step, and the error of the combination without the last rule.
#[inline(always)]
pub fn trial<T: Real, const K: usize>(
    pendulum: &Pendulum<T>,
    weights: &Weights<T, K>,
    phase: &Phase<T>,
    step: T,
) -> [Phase<T>; 2] {
    let zero = step.lit(0.0);
    let rate = pendulum.derivative(phase);
    let (mut change, mut error) = ([zero; 6], [zero; 6]);
    for j in 0..K {
        let rule = midpoints(pendulum, phase, &rate, step, 2 * (j + 1));
        for i in 0..6 {
            change[i] = weights.all[j].mul_add(rule[i], change[i]);
            error[i] = weights.error[j].mul_add(rule[i], error[i]);
        }
    }
    [change, error]
}

/// The change by Gragg's rule with `count` midpoints; `rate` is the derivative at the beginning.
#[inline(always)]
fn midpoints<T: Real>(
    pendulum: &Pendulum<T>,
    phase: &Phase<T>,
    rate: &Phase<T>,
    step: T,
    count: usize,
) -> Phase<T> {
    // A division, because the literal 1/count would be accurate to f64 only.
    let length = step / step.lit(count as f64);
    let twice = length + length;
    let mut before = *phase;
    let mut now = *phase;
    for i in 0..6 {
        now[i] = rate[i].mul_add(length, phase[i]);
    }
    for _ in 1..count {
        let rate = pendulum.derivative(&now);
        let mut next = before;
        for i in 0..6 {
            next[i] = rate[i].mul_add(twice, before[i]);
        }
        (before, now) = (now, next);
    }
    let rate = pendulum.derivative(&now);
    let half = step.lit(0.5);
    let mut change = now;
    for i in 0..6 {
        let end = rate[i].mul_add(length, before[i]);
        change[i] = half * (now[i] + end) - phase[i];
    }
    change
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::State;
    use crate::taylor::Orbit;
    use flipmap_numbers::Dd;

    fn error_after<const K: usize>(step: f64) -> f64 {
        let lit = Dd::new;
        let unit = Pendulum::points([lit(1.0), lit(2.0)], [lit(1.0), lit(0.6)], lit(1.0));
        let state = State { angle: [lit(1.0), lit(-2.0)], speed: [lit(0.5), lit(1.5)] };
        let phase = unit.phase(&state);
        let [change, _] = trial(&unit, &Weights::<Dd, K>::new(), &phase, lit(step));
        let truth = unit.phase(&Orbit::new(unit, state).state_at(lit(step)));
        (0..6).map(|i| (phase[i] + change[i] - truth[i]).abs().hi).fold(0.0, f64::max)
    }

    #[test]
    fn it_is_as_exact_as_its_order_promises() {
        // A step's error falls with the power 2K + 1.
        let order = (error_after::<4>(0.02) / error_after::<4>(0.01)).log2();
        assert!((order - 9.0).abs() < 0.5, "{order}");
        assert!(error_after::<9>(0.05) < 1e-26, "{:e}", error_after::<9>(0.05));
    }

    #[test]
    fn weights_sum_to_one_and_their_error_to_nothing() {
        let Weights { all, error } = Weights::<Dd, 9>::new();
        let sum = |weights: [Dd; 9]| weights.into_iter().fold(Dd::new(0.0), |sum, w| sum + w);
        assert!((sum(all) - Dd::new(1.0)).abs().hi < 1e-27 && sum(error).abs().hi < 1e-27);
    }
}
