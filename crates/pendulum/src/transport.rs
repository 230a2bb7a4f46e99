//! Transport of states to another time, by short steps of high order.

use crate::Pendulum;
use crate::embedded::{Dop853, EmbeddedPair, dop853_factor, plus};
use crate::phase::Phase;
use flipmap_numbers::Real;

/// Tolerance of a step, in unit vectors and scaled momenta.
const STEP_TOLERANCE: f64 = 1e-13;
/// First step to try, in units of time.
const FIRST_STEP: f64 = 0.1;
/// Shortest step, in units of time: a motion that needs shorter steps is not that of a pendulum.
const MIN_STEP: f64 = 1e-9;

/// The state that `phase` becomes after the reduced time `by`, which may be negative; NaN if it
/// cannot be followed, for example because the state is not finite. `pendulum` is in reduced units.
pub fn transported(pendulum: &Pendulum<f64>, phase: &Phase<f64>, by: f64) -> Phase<f64> {
    let inverse_scale = pendulum.momentum_scale().map(|scale| 1.0 / scale);
    transported_as(pendulum, inverse_scale, phase, by, |number| number)
}

/// Returns the same as [`transported`] for any number type; `value` converts its numbers to f64, in
/// which the errors of steps are judged.
pub fn transported_as<T: Real>(
    pendulum: &Pendulum<T>,
    inverse_scale: [T; 2],
    phase: &Phase<T>,
    by: f64,
    value: impl Fn(T) -> f64,
) -> Phase<T> {
    let (mut phase, mut left, mut step) = (*phase, by.abs(), FIRST_STEP);
    while left > 0.0 {
        let length = left.min(step);
        let trial =
            Dop853::trial(pendulum, inverse_scale, &phase, phase[0].lit(length.copysign(by)));
        let error = value(trial.error_squared).sqrt();
        if error <= STEP_TOLERANCE {
            phase = plus(&phase, &trial.change);
            left -= length;
        }
        step = length * dop853_factor(error, STEP_TOLERANCE).clamp(0.2, 4.0);
        if error.is_nan() || step < MIN_STEP.min(left) {
            return phase.map(|number| number.lit(f64::NAN));
        }
    }
    phase
}

/// Number of turns (−1, 0 or 1, anticlockwise positive) that each bob completes at the top between
/// two states less than half a turn apart. At the top, unlike at the bottom, `y` becomes negative
/// when the bob turns anticlockwise.
pub fn turns_between(before: &Phase<f64>, after: &Phase<f64>) -> [i32; 2] {
    [0, 1].map(|bob| {
        let part = |phase: &Phase<f64>| [phase[2 * bob], phase[2 * bob + 1]];
        let ([x0, y0], [x1, y1]) = (part(before), part(after));
        let falls = i32::from(y1 < 0.0) - i32::from(y0 < 0.0);
        let sine = x0 * y1 - y0 * x1;
        if f64::from(falls) * sine > 0.0 { falls } else { 0 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::State;

    #[test]
    fn there_and_back_is_where_it_began() {
        let pendulum = Pendulum::points([1.0, 1.0], [1.0, 1.0], 9.81).reduced().0;
        let start = pendulum.phase(&State { angle: [2.0, -1.1], speed: [0.5, 1.5] });
        let there = transported(&pendulum, &start, 2.5);
        let back = transported(&pendulum, &there, -2.5);
        let apart = |a: &Phase<f64>, b: &Phase<f64>| {
            (0..6).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max)
        };
        assert!(apart(&start, &back) < 1e-11 && apart(&start, &there) > 0.1);
    }

    #[test]
    fn long_ways_are_followed_to_their_ends() {
        let pendulum = Pendulum::points([1.0, 1.0], [1.0, 1.0], 9.81).reduced().0;
        // Both rods swing together, so that errors hardly grow in some thousand steps.
        let start = pendulum.phase(&State { angle: [0.2, 0.3], speed: [0.0; 2] });
        let whole = transported(&pendulum, &start, 300.0);
        let parts = (0..30).fold(start, |phase, _| transported(&pendulum, &phase, 10.0));
        let apart = (0..6).map(|i| (whole[i] - parts[i]).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-8, "{apart}");
        assert!(transported(&pendulum, &[f64::NAN; 6], 1.0)[0].is_nan());
    }
}
