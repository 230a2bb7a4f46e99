//! Where inside an adaptive step a bob passes the top, without angles.
//!
//! The bob is at the top where `y` changes its sign while `x` is negative. Steps are long, so
//! interpolation is only the first guess: every value that decides anything comes from a step of
//! the method itself, shortened to end there.

use super::phase::Phase;
use super::real::Scalar;

/// The state somewhere inside a step.
#[derive(Clone, Copy, Debug)]
pub struct Moment<T> {
    /// Unit vectors and momenta, reduced units.
    pub phase: Phase<T>,
    /// ω1 and ω2.
    pub speed: [T; 2],
}

impl<T: Scalar> Moment<T> {
    fn x(&self, bob: usize) -> T {
        self.phase[2 * bob]
    }
    fn y(&self, bob: usize) -> T {
        self.phase[2 * bob + 1]
    }
    /// dy/dt.
    fn rise(&self, bob: usize) -> T {
        self.speed[bob] * self.x(bob)
    }
}

/// A bob that turns round farther than this many times its travel from the top did not reach it.
pub const REACH: f64 = 1.5;

/// Whether `bob` can have been at the top in a step of length `step` (twins in the engines).
pub fn may_pass<T: Scalar>(before: &Moment<T>, after: &Moment<T>, bob: usize, step: T) -> bool {
    let zero = T::zero();
    if before.x(bob) >= zero && after.x(bob) >= zero {
        return false;
    }
    crosses(before, after, bob) || may_graze(before, after, bob, step)
}

pub(super) fn crosses<T: Scalar>(before: &Moment<T>, after: &Moment<T>, bob: usize) -> bool {
    let (y0, y1, zero) = (before.y(bob), after.y(bob), T::zero());
    (y0 > zero && y1 <= zero) || (y0 < zero && y1 >= zero)
}

fn may_graze<T: Scalar>(before: &Moment<T>, after: &Moment<T>, bob: usize, step: T) -> bool {
    let (y0, y1) = (before.y(bob).abs(), after.y(bob).abs());
    let (w0, w1) = (before.speed[bob], after.speed[bob]);
    let nearest = if y0 < y1 { y0 } else { y1 };
    let travel = T::from_f64(REACH) * step * w0.abs().max(w1.abs());
    w0 * w1 < T::zero() && nearest <= travel
}

/// The fraction in (0, 1] of a step of length `step` at which `bob` first passes the top; `at`
/// gives the moment after a fraction of the step.
pub fn within<T: Scalar>(
    at: impl Fn(T) -> Moment<T>,
    bob: usize,
    before: &Moment<T>,
    after: &Moment<T>,
    step: T,
) -> Option<T> {
    if !may_pass(before, after, bob, step) {
        return None;
    }
    let one = T::from_f64(1.0);
    let end = if crosses(before, after, bob) {
        (one, *after)
    } else {
        let turn = turning_point(&at, bob, before, after);
        if !crosses(before, &turn.1, bob) {
            return None;
        }
        turn
    };
    let (fraction, moment) = crossing(&at, bob, before, end, step);
    (moment.x(bob) < T::zero()).then_some(fraction)
}

/// Where `y` is zero between the beginning of the step and `end`: Newton's steps from the cubic
/// through both ends, kept inside a shrinking bracket.
pub(super) fn crossing<T: Scalar>(
    at: &impl Fn(T) -> Moment<T>,
    bob: usize,
    before: &Moment<T>,
    end: (T, Moment<T>),
    step: T,
) -> (T, Moment<T>) {
    let half = T::from_f64(0.5);
    let (mut low, mut high) = ((T::zero(), *before), end);
    let mut fraction = inverse_cubic(bob, &low, &high, step);
    for _ in 0..MOST_STEPS {
        if !(fraction > low.0 && fraction < high.0) {
            fraction = (low.0 + high.0) * half;
        }
        let moment = at(fraction);
        let newton = fraction - moment.y(bob) / (moment.rise(bob) * step);
        let moved = (newton - fraction).abs().to_f64();
        // Newton's error is about the square of its step, over which this one is not checked.
        if moved < T::EPSILON.sqrt() && newton >= low.0 && newton <= high.0 {
            return (newton, moment);
        }
        if crosses(before, &moment, bob) {
            high = (fraction, moment);
        } else {
            low = (fraction, moment);
        }
        fraction = newton;
    }
    high
}

/// Enough for 106 bits by bisection alone, should Newton never help.
const MOST_STEPS: usize = 120;

/// The fraction at y = 0 of the cubic for fraction(y) that has the values and slopes of both ends.
fn inverse_cubic<T: Scalar>(bob: usize, low: &(T, Moment<T>), high: &(T, Moment<T>), step: T) -> T {
    let lit = T::from_f64;
    let span = high.1.y(bob) - low.1.y(bob);
    let s = -low.1.y(bob) / span;
    let slope = |end: &(T, Moment<T>)| span / (end.1.rise(bob) * step);
    let rest = lit(1.0) - s;
    let (rest2, s2) = (rest * rest, s * s);
    low.0 * rest2 * (lit(1.0) + lit(2.0) * s)
        + slope(low) * rest2 * s
        + high.0 * s2 * (lit(3.0) - lit(2.0) * s)
        - slope(high) * s2 * rest
}

/// Where the bob turns round: ω = 0 by the Illinois variant of the false position.
pub(super) fn turning_point<T: Scalar>(
    at: &impl Fn(T) -> Moment<T>,
    bob: usize,
    before: &Moment<T>,
    after: &Moment<T>,
) -> (T, Moment<T>) {
    let (half, zero) = (T::from_f64(0.5), T::zero());
    let (mut low, mut high) = (zero, T::from_f64(1.0));
    let (mut at_low, mut at_high) = (before.speed[bob], after.speed[bob]);
    let mut turn = (high, *after);
    for _ in 0..MOST_STEPS {
        let fraction = (low * at_high - high * at_low) / (at_high - at_low);
        let moment = at(fraction);
        let speed = moment.speed[bob];
        let moved = (fraction - turn.0).abs().to_f64();
        turn = (fraction, moment);
        // An extremum is flat: half of the digits in time give all of them in height.
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
    fn swing(height: f64, bend: f64, peak: f64) -> impl Fn(f64) -> Moment<f64> {
        move |t: f64| {
            let theta = std::f64::consts::PI + height - bend * (t - peak) * (t - peak);
            let (y, x) = theta.sin_cos();
            let speed = -2.0 * bend * (t - peak);
            Moment { phase: [1.0, 0.0, x, y, 0.0, 0.0], speed: [0.0, speed] }
        }
    }

    fn found(at: impl Fn(f64) -> Moment<f64>) -> Option<f64> {
        let (before, after) = (at(0.0), at(1.0));
        assert!(!may_pass(&before, &after, 0, 1.0), "the first bob hangs");
        within(&at, 1, &before, &after, 1.0)
    }

    #[test]
    fn a_crossing_is_found_to_the_last_digits() {
        for height in [0.3, 0.05, 1e-4] {
            let peak = 1.0 + 0.5 * (height / 0.9f64).sqrt();
            let root = found(swing(height, 0.9, peak)).unwrap();
            assert!((root - (2.0 - peak)).abs() < 1e-13, "{height} {root}");
        }
    }

    #[test]
    fn a_pass_that_falls_back_inside_the_step_is_found_and_a_near_miss_is_not() {
        for height in [1e-2, 1e-6, 1e-9, 1e-12] {
            let root = found(swing(height, 0.7, 0.43)).expect("just over the top");
            let truth = 0.43 - (height / 0.7f64).sqrt();
            assert!((root - truth).abs() < 1e-15 / height.sqrt() + 1e-13, "{height}");
            assert_eq!(found(swing(-height, 0.7, 0.43)), None, "{height} under the top");
        }
    }

    #[test]
    fn the_bottom_is_no_top() {
        let at = |t: f64| {
            let (y, x) = (1.5 - 3.0 * t).sin_cos();
            Moment { phase: [1.0, 0.0, x, y, 0.0, 0.0], speed: [0.0, -3.0] }
        };
        assert_eq!(found(at), None);
    }

    #[test]
    fn a_start_at_the_top_that_moves_inward_is_no_pass() {
        let at = |t: f64| {
            let (y, x) = if t == 0.0 { (0.0, -1.0) } else { (std::f64::consts::PI - t).sin_cos() };
            Moment { phase: [1.0, 0.0, x, y, 0.0, 0.0], speed: [0.0, -1.0] }
        };
        assert_eq!(found(at), None);
    }
}
