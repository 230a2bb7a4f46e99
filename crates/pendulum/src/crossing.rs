//! Crossings: the moments inside an adaptive step at which a bob passes the top, without angles.
//!
//! A bob is at the top where `y` changes sign while `x` is negative. Steps are long, so
//! interpolation only says where to look: every value that decides anything comes from a step of
//! the method itself, shortened to end there. DOPRI5 has another test, on the polynomial that it
//! provides over its step (see [`super::embedded::quartic`]), so each can check the other.

use crate::pendulum::Pendulum;
use crate::phase::Phase;
use flipmap_numbers::real::Scalar;

/// The state at a moment inside a step.
#[derive(Clone, Copy, Debug)]
pub struct StepState<T> {
    /// Unit vectors and momenta in reduced units.
    pub phase: Phase<T>,
    /// Angular velocities ω1 and ω2 in reduced units.
    pub speed: [T; 2],
}

impl<T: Scalar> StepState<T> {
    fn x(&self, bob: usize) -> T {
        self.phase[2 * bob]
    }
    fn y(&self, bob: usize) -> T {
        self.phase[2 * bob + 1]
    }
    /// The rate of change dy/dt.
    fn rise(&self, bob: usize) -> T {
        self.speed[bob] * self.x(bob)
    }
}

/// The position of a bob's path relative to the top over an interval, judged by the cubic that
/// matches `y` and its rate of change at both ends. The cubic lies within its control points, and
/// the clearance is reduced by [`SLACK`] for what the cubic does not capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach<T> {
    /// Lower bound on the bob's distance from the top (as a sine); zero or less if the bob may
    /// reach the top.
    pub clearance: T,
    /// True if the bob passes the top exactly once.
    pub crosses: bool,
}

/// Slack taken off the clearance, as a share of the distance of the cubic's middle control points
/// from its chord (the engines use the same).
pub const SLACK: f64 = 0.2;
/// Clearance of a bob that is below its pivot.
pub const FAR: f64 = 2.0;

/// Index of the bob that is at the top, in a state in which one passes it: the one whose sine
/// vanishes.
pub fn bob_at_top(phase: &Phase<f64>) -> usize {
    let [x1, y1, x2, y2, ..] = *phase;
    usize::from(x1 > 0.0 || (x2 < 0.0 && y2.abs() < y1.abs()))
}

/// Height beyond the top, as a sine, that `bob` would reach after passing it in the state `top` if
/// its acceleration there turned it round.
pub fn height_beyond(pendulum: &Pendulum<f64>, top: &StepState<f64>, bob: usize) -> f64 {
    let [x1, y1, x2, y2, ..] = top.phase;
    let pull = pendulum.acceleration_towards([(y1, x1), (y2, x2)], top.speed);
    top.speed[bob].powi(2) / (2.0 * pull[bob].abs()).max(1e-300)
}

/// Returns the state `top`, in which `bob` passes the top, with the bob moved just beyond it.
pub fn beyond_top(top: &StepState<f64>, bob: usize, anticlockwise: bool) -> StepState<f64> {
    let mut beyond = *top;
    beyond.phase[2 * bob + 1] = if anticlockwise { -BARELY } else { BARELY };
    beyond
}

/// Sine of the angle beyond the top to which [`beyond_top`] moves a bob: far below any rounding
/// error, but with a sign.
const BARELY: f64 = 1e-30;

/// Judges the path of `bob` between two moments `length` apart.
pub fn approach<T: Scalar>(
    before: &StepState<T>,
    after: &StepState<T>,
    bob: usize,
    length: T,
) -> Approach<T> {
    let (zero, third) = (T::zero(), T::from_f64(1.0 / 3.0));
    if before.x(bob) >= zero && after.x(bob) >= zero {
        return Approach { clearance: T::from_f64(FAR), crosses: false };
    }
    let [y0, y1] = [before.y(bob), after.y(bob)];
    let [rise0, rise1] = [before.rise(bob) * length, after.rise(bob) * length];
    let (first, second) = (y0 + rise0 * third, y1 - rise1 * third);
    let chord = (y1 - y0) * third;
    let bend = (first - y0 - chord).abs().max((y1 - second - chord).abs());
    let side = if y0 < zero || (y0 == zero && second < zero) { -1.0 } else { 1.0 };
    let inward = |y: T| y * T::from_f64(side);
    let mut least = inward(second);
    // A start exactly at the top has not passed it.
    for y in [first, y1] {
        if inward(y) < least && !(y0 == zero && y == zero) {
            least = inward(y);
        }
    }
    let falls = inward(rise0) < zero && inward(second - first) < zero && inward(rise1) < zero;
    Approach {
        clearance: least - bend * T::from_f64(SLACK),
        crosses: falls && inward(y1) <= zero && y0 != zero,
    }
}

/// The crossing of a bob within a step, if there is one, and its clearance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepCrossing<T> {
    /// The fraction in (0, 1] of the step at which the bob first passes the top.
    pub fraction: Option<T>,
    /// Least distance from the top (as a sine) before the crossing, or in the whole step if there
    /// is none.
    pub clearance: T,
}

/// Finds the crossing of `bob` in a step of length `step`; `at` returns the state at a fraction.
///
/// Each part of the step is halved until its [`Approach`] decides it. So neither a pass that falls
/// back at once nor either of two in quick succession is missed.
pub fn within<T: Scalar>(
    at: impl Fn(T) -> StepState<T>,
    bob: usize,
    before: &StepState<T>,
    after: &StepState<T>,
    step: T,
) -> StepCrossing<T> {
    let (zero, one) = (T::zero(), T::from_f64(1.0));
    let (mut low, mut high) = ((zero, *before), (one, *after));
    let mut clearance = T::from_f64(FAR);
    for _ in 0..MAX_PARTS {
        let length = high.0 - low.0;
        let part = approach(&low.1, &high.1, bob, length * step);
        let plain = part.crosses || part.clearance > zero;
        if !plain && length.to_f64() > MIN_PART {
            let middle = low.0 + length * T::from_f64(0.5);
            high = (middle, at(middle));
            continue;
        }
        if part.crosses || (!plain && crosses(&low.1, &high.1, bob)) {
            let (fraction, moment) = crossing(&at, bob, low, high, step);
            if moment.x(bob) < zero {
                return StepCrossing { fraction: Some(fraction), clearance };
            }
        }
        let nearest = if plain { part.clearance } else { high.1.y(bob).abs() };
        if nearest < clearance && !part.crosses {
            clearance = nearest;
        }
        if high.0 >= one {
            break;
        }
        low = high;
        let end = low.0 + length + length;
        high = if end < one { (end, at(end)) } else { (one, *after) };
    }
    StepCrossing { fraction: None, clearance }
}

/// Share of a step below which parts are not halved: a shorter pass is as good as none.
const MIN_PART: f64 = 1e-7;
/// Maximum number of parts into which a step is cut; a graze takes about sixty.
const MAX_PARTS: usize = 400;

pub(super) fn crosses<T: Scalar>(before: &StepState<T>, after: &StepState<T>, bob: usize) -> bool {
    let (y0, y1, zero) = (before.y(bob), after.y(bob), T::zero());
    (y0 > zero && y1 <= zero) || (y0 < zero && y1 >= zero)
}

/// Finds the zero of `y` between two moments, each given with its fraction of a step: Newton's
/// method from the cubic through both, kept inside a shrinking bracket.
pub(super) fn crossing<T: Scalar>(
    at: &impl Fn(T) -> StepState<T>,
    bob: usize,
    begin: (T, StepState<T>),
    end: (T, StepState<T>),
    step: T,
) -> (T, StepState<T>) {
    let half = T::from_f64(0.5);
    let (mut low, mut high) = (begin, end);
    let before = begin.1;
    let mut fraction = inverse_cubic(bob, &low, &high, step);
    for _ in 0..MAX_STEPS {
        if !(fraction > low.0 && fraction < high.0) {
            fraction = (low.0 + high.0) * half;
        }
        let moment = at(fraction);
        let newton = fraction - moment.y(bob) / (moment.rise(bob) * step);
        let moved = (newton - fraction).abs().to_f64();
        // Newton's error is about the square of its last step, so the result is not checked again.
        if moved < T::EPSILON.sqrt() && newton >= low.0 && newton <= high.0 {
            return (newton, moment);
        }
        if crosses(&before, &moment, bob) {
            high = (fraction, moment);
        } else {
            low = (fraction, moment);
        }
        fraction = newton;
    }
    high
}

/// Maximum number of iterations: enough for 106 bits by bisection alone, should Newton never help.
const MAX_STEPS: usize = 120;

/// The fraction at y = 0 on the cubic fraction(y) that matches the values and slopes of both ends.
fn inverse_cubic<T: Scalar>(
    bob: usize,
    low: &(T, StepState<T>),
    high: &(T, StepState<T>),
    step: T,
) -> T {
    let lit = T::from_f64;
    let span = high.1.y(bob) - low.1.y(bob);
    let s = -low.1.y(bob) / span;
    let slope = |end: &(T, StepState<T>)| span / (end.1.rise(bob) * step);
    let rest = lit(1.0) - s;
    let (rest2, s2) = (rest * rest, s * s);
    low.0 * rest2 * (lit(1.0) + lit(2.0) * s)
        + slope(low) * rest2 * s
        + high.0 * s2 * (lit(3.0) - lit(2.0) * s)
        - slope(high) * s2 * rest
}

/// Finds where the bob turns round, ω = 0, by the Illinois variant of false position.
pub(super) fn turning_point<T: Scalar>(
    at: &impl Fn(T) -> StepState<T>,
    bob: usize,
    before: &StepState<T>,
    after: &StepState<T>,
) -> (T, StepState<T>) {
    let (half, zero) = (T::from_f64(0.5), T::zero());
    let (mut low, mut high) = (zero, T::from_f64(1.0));
    let (mut at_low, mut at_high) = (before.speed[bob], after.speed[bob]);
    let mut turn = (high, *after);
    for _ in 0..MAX_STEPS {
        let fraction = (low * at_high - high * at_low) / (at_high - at_low);
        let moment = at(fraction);
        let speed = moment.speed[bob];
        let moved = (fraction - turn.0).abs().to_f64();
        turn = (fraction, moment);
        // An extremum is flat: half of the digits in time give all digits in height.
        if speed == zero || moved < T::EPSILON.sqrt() * 1e-2 {
            break;
        }
        if (speed < zero) == (at_low < zero) {
            (low, at_low, at_high) = (fraction, speed, at_high * half);
        } else {
            (high, at_high, at_low) = (fraction, speed, at_low * half);
        }
    }
    turn
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A second bob that swings as θ2 = π + `height` − `bend` (t − `peak`)².
    fn swing(height: f64, bend: f64, peak: f64) -> impl Fn(f64) -> StepState<f64> {
        move |t: f64| {
            let theta = std::f64::consts::PI + height - bend * (t - peak) * (t - peak);
            let (y, x) = theta.sin_cos();
            let speed = -2.0 * bend * (t - peak);
            StepState { phase: [1.0, 0.0, x, y, 0.0, 0.0], speed: [0.0, speed] }
        }
    }

    fn found(at: impl Fn(f64) -> StepState<f64>) -> StepCrossing<f64> {
        let (before, after) = (at(0.0), at(1.0));
        let first = approach(&before, &after, 0, 1.0);
        assert!(first.clearance == FAR && !first.crosses, "the first bob hangs");
        within(&at, 1, &before, &after, 1.0)
    }

    #[test]
    fn a_crossing_is_found_to_the_last_digits() {
        for height in [0.3, 0.05, 1e-4] {
            let peak = 1.0 + 0.5 * (height / 0.9f64).sqrt();
            let root = found(swing(height, 0.9, peak)).fraction.unwrap();
            assert!((root - (2.0 - peak)).abs() < 1e-13, "{height} {root}");
        }
    }

    #[test]
    fn a_pass_that_falls_back_inside_the_step_is_found_and_a_near_miss_is_told() {
        for height in [1e-2, 1e-6, 1e-9, 1e-12] {
            let root = found(swing(height, 0.7, 0.43)).fraction.expect("just over the top");
            let truth = 0.43 - (height / 0.7f64).sqrt();
            assert!((root - truth).abs() < 1e-15 / height.sqrt() + 1e-13, "{height}");
            let StepCrossing { fraction, clearance } = found(swing(-height, 0.7, 0.43));
            assert_eq!(fraction, None, "{height} under the top");
            assert!(clearance <= height.sin() + 4e-16 && clearance > 0.1 * height, "{height}");
        }
    }

    #[test]
    fn a_pass_from_rest_is_found_in_the_first_step() {
        // θ2 = π − 1e-14 + t²/2 − 600 t⁴: beyond the top from 1.4e-7 to 0.03.
        let at = |t: f64| {
            let above = -1e-14 + 0.5 * t * t - 600.0 * t.powi(4);
            let speed = t - 2400.0 * t.powi(3);
            let phase = [1.0, 0.0, -above.cos(), -above.sin(), 0.0, 0.0];
            StepState { phase, speed: [0.0, speed] }
        };
        let root = found(at).fraction.expect("beyond the top");
        assert!((root - 2e-14f64.sqrt()).abs() < 1e-9, "{root:e}");
    }

    #[test]
    fn two_turns_in_a_step_hide_no_pass() {
        // Up to 1e-3 beyond the top, back, and up again, but not as far.
        let at = |t: f64| {
            let above = 1e-3 - 8.0 * (t - 0.3).powi(2) * (1.1 - t);
            let speed = -16.0 * (t - 0.3) * (1.1 - t) + 8.0 * (t - 0.3).powi(2);
            let phase = [1.0, 0.0, -above.cos(), -above.sin(), 0.0, 0.0];
            StepState { phase, speed: [0.0, speed] }
        };
        assert!(at(0.0).speed[1] * at(1.0).speed[1] > 0.0);
        let root = found(at).fraction.expect("beyond the top");
        assert!((0.28..0.3).contains(&root), "{root}");
    }

    #[test]
    fn the_bottom_is_no_top() {
        let at = |t: f64| {
            let (y, x) = (1.5 - 3.0 * t).sin_cos();
            StepState { phase: [1.0, 0.0, x, y, 0.0, 0.0], speed: [0.0, -3.0] }
        };
        assert_eq!(found(at).fraction, None);
    }

    #[test]
    fn a_start_at_the_top_that_moves_inward_is_no_pass() {
        let at = |t: f64| {
            let (y, x) = if t == 0.0 { (0.0, -1.0) } else { (std::f64::consts::PI - t).sin_cos() };
            StepState { phase: [1.0, 0.0, x, y, 0.0, 0.0], speed: [0.0, -1.0] }
        };
        assert_eq!(found(at).fraction, None);
    }
}
