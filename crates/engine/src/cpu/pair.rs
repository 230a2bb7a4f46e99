//! The embedded pairs on lanes, each with a test for crossings of the top. DOPRI5 has its own test
//! and the other pairs share one, so that methods with different tests can check each other.

use std::marker::PhantomData;
use std::sync::LazyLock;

use super::lanes::Lanes;
use crate::method::COLUMNS;
use flipmap_numbers::polynomial::course;
use flipmap_numbers::{Dd, Real};
use flipmap_pendulum::Pendulum;
use flipmap_pendulum::crossing::{FAR, SLACK, StepCrossing, StepState, within};
use flipmap_pendulum::embedded::{
    DOP853_ORDER, DOPRI5_ORDER, Trial, dop853, dopri5, plus, quartic,
};
use flipmap_pendulum::extrapolation::{self, Weights};
use flipmap_pendulum::phase::Phase;

/// An embedded pair, generic over the number type: two methods that share their stages, so that
/// the difference of their results estimates the error.
pub trait EmbeddedPair {
    /// The power of the step with which the estimated error falls.
    const ORDER: u32;

    /// Computes a step that may be taken or not. `inverse_scale` is 1 over the scale of each
    /// momentum.
    fn trial<T: Real>(
        pendulum: &Pendulum<T>,
        inverse_scale: [T; 2],
        phase: &Phase<T>,
        step: T,
    ) -> Trial<T>;
}

/// A pair with a test for crossings of the top; by default on the cubic through both ends of a
/// step.
pub(super) trait TopTest {
    /// The pair that takes the steps.
    type Pair: EmbeddedPair;

    /// Returns the distance from the top that a bob keeps over a step; not positive if the bob may
    /// cross the top. Uses the cubic through the bob's sines at both ends, whose rates of change
    /// times the step are given. Counterpart of `crossing::approach`.
    #[inline(always)]
    fn clearance<L: Lanes>([y0, y1]: [L; 2], [rise0, rise1]: [L; 2], _bow: L) -> L {
        let third = y0.lit(1.0 / 3.0);
        let (first, second) = (rise0.mul_add(third, y0), (-rise1).mul_add(third, y1));
        let chord = (y1 - y0) * third;
        let bend = (first - y0 - chord).abs().max((y1 - second - chord).abs());
        let inward = |y: L| Lanes::select(-y, y0, y);
        let least = inward(first).min(inward(second)).min(inward(y1));
        least - bend * y0.lit(SLACK)
    }

    /// Finds out whether and when a bob passes the top in a step of one pendulum, by shorter and
    /// shorter steps.
    fn look(step: &LaneStep, bob: usize) -> StepCrossing<f64> {
        let at = |fraction| step.shortened::<Self::Pair>(fraction);
        within(at, bob, &step.before, &step.after, step.length)
    }
}

/// One pendulum's step, in f64.
pub(super) struct LaneStep<'a> {
    pub pendulum: &'a Pendulum<f64>,
    pub inverse_scale: [f64; 2],
    pub before: StepState<f64>,
    pub after: StepState<f64>,
    pub length: f64,
}

impl LaneStep<'_> {
    /// The state after a shorter step from the same beginning.
    pub(super) fn shortened<P: EmbeddedPair>(&self, fraction: f64) -> StepState<f64> {
        let begin = &self.before.phase;
        let trial = P::trial(self.pendulum, self.inverse_scale, begin, self.length * fraction);
        let phase = plus(begin, &trial.change);
        StepState { phase, speed: self.pendulum.speeds(&phase) }
    }
}

/// Any pair, with crossings found on the cubic through both ends of a step.
pub(super) struct OnCubic<P>(PhantomData<P>);

impl<P: EmbeddedPair> TopTest for OnCubic<P> {
    type Pair = P;
}

/// The pair of Dormand and Prince of orders 5 and 4.
pub struct Dopri5;

impl EmbeddedPair for Dopri5 {
    const ORDER: u32 = DOPRI5_ORDER;

    #[inline(always)]
    fn trial<T: Real>(
        pendulum: &Pendulum<T>,
        inverse_scale: [T; 2],
        phase: &Phase<T>,
        step: T,
    ) -> Trial<T> {
        dopri5(pendulum, inverse_scale, phase, step)
    }
}

/// DOPRI5, with crossings found on the quartic that it provides over its step.
pub(super) struct OnQuartic;

impl TopTest for OnQuartic {
    type Pair = Dopri5;

    #[inline(always)]
    fn clearance<L: Lanes>(y: [L; 2], rise: [L; 2], bow: L) -> L {
        let [y0, y1, y2, y3, y4] = quartic(y, rise, bow);
        let inward = |y: L| Lanes::select(-y, y0, y);
        inward(y1).min(inward(y2)).min(inward(y3)).min(inward(y4))
    }

    fn look(step: &LaneStep, bob: usize) -> StepCrossing<f64> {
        let LaneStep { before, after, length, .. } = step;
        let trial = dopri5(step.pendulum, step.inverse_scale, &before.phase, *length);
        let (x, y) = (2 * bob, 2 * bob + 1);
        let rise = |moment: &StepState<f64>| moment.speed[bob] * moment.phase[x] * length;
        let ends = [before.phase[y], after.phase[y]];
        let control = quartic(ends, [rise(before), rise(after)], trial.bow[bob]);
        let side = control.iter().find(|&&y| y != 0.0).map_or(1.0, |y| y.signum());
        let at = |fraction: f64| before.phase[x] + (after.phase[x] - before.phase[x]) * fraction;
        let fraction = course(&control, side).change.filter(|&fraction| at(fraction) < 0.0);
        StepCrossing { fraction, clearance: FAR }
    }
}

/// The extrapolated midpoint rules.
pub(super) struct Midpoints;

static WEIGHTS: LazyLock<Weights<Dd, COLUMNS>> = LazyLock::new(Weights::new);

impl EmbeddedPair for Midpoints {
    const ORDER: u32 = extrapolation::order(COLUMNS);

    #[inline(always)]
    fn trial<T: Real>(
        pendulum: &Pendulum<T>,
        inverse_scale: [T; 2],
        phase: &Phase<T>,
        step: T,
    ) -> Trial<T> {
        let both = |Dd { hi, lo }: Dd| step.lit(hi) + step.lit(lo);
        let weights = Weights { all: WEIGHTS.all.map(both), error: WEIGHTS.error.map(both) };
        let [change, error] = extrapolation::trial(pendulum, &weights, phase, step);
        Trial::new(change, &error, inverse_scale)
    }
}

/// The pair of Dormand and Prince of order 8, with error estimates of orders 5 and 3.
pub struct Dop853;

impl EmbeddedPair for Dop853 {
    const ORDER: u32 = DOP853_ORDER;

    #[inline(always)]
    fn trial<T: Real>(
        pendulum: &Pendulum<T>,
        inverse_scale: [T; 2],
        phase: &Phase<T>,
        step: T,
    ) -> Trial<T> {
        dop853(pendulum, inverse_scale, phase, step)
    }
}

#[cfg(test)]
mod tests {
    use super::super::lanes::F64Lanes;
    use super::*;
    use flipmap_pendulum::crossing::approach;

    /// The test for a pass of the top is written once for single numbers and once for lanes, which
    /// have no branches; both must agree.
    #[test]
    fn lanes_judge_a_step_as_single_numbers_do() {
        let mut random = fastrand::Rng::with_seed(7);
        let mut judged = [0, 0];
        for _ in 0..10_000 {
            let mut moment = || {
                let angle = std::f64::consts::PI + 1.2 * (random.f64() - 0.5);
                let speed = [0.0, 8.0 * (random.f64() - 0.5)];
                StepState { phase: [1.0, 0.0, angle.cos(), angle.sin(), 0.0, 0.0], speed }
            };
            let (before, after) = (moment(), moment());
            let length = 0.3;
            let rise = |at: &StepState<f64>| at.speed[1] * at.phase[2] * length;
            let lit = |value| F64Lanes::splat(pulp::Scalar, value);
            let ys = [before, after].map(|at| lit(at.phase[3]));
            let rises = [rise(&before), rise(&after)].map(lit);
            let mut by_lanes = [0.0];
            OnCubic::<Dop853>::clearance(ys, rises, lit(0.0)).store(&mut by_lanes);
            let [by_lanes] = by_lanes;
            let alone = approach(&before, &after, 1, length).clearance;
            assert!(
                (by_lanes - alone).abs() < 1e-14,
                "{by_lanes} and {alone}: {before:?} {after:?}"
            );
            judged[usize::from(alone > 0.0)] += 1;
        }
        assert!(judged.iter().all(|count| *count > 500), "steps of both kinds: {judged:?}");
    }
}
