//! The test for crossings of the top in a step of an embedded pair. A pair that provides the motion
//! inside its steps is tested on that, and the others on the cubic through both ends, so that methods
//! with different tests can check each other. For that reason the tests of pairs, expansions
//! (`taylor.rs`) and flow patches have no code in common, and must not get any.

use std::sync::LazyLock;

use super::lanes::Lanes;
use crate::method::COLUMNS;
use flipmap_numbers::polynomial::course;
use flipmap_numbers::{Dd, Real};
use flipmap_pendulum::Pendulum;
use flipmap_pendulum::crossing::{FAR, SLACK, StepCrossing, StepState, within};
use flipmap_pendulum::embedded::{EmbeddedPair, Trial, plus, quartic};
use flipmap_pendulum::extrapolation::{self, Weights};
use flipmap_pendulum::phase::Phase;

/// Returns the distance from the top that a bob keeps over a step of `P`; not positive if the bob may
/// cross the top. `y` are the bob's sines at both ends, and `rise` their rates of change times the
/// step.
#[inline(always)]
pub(super) fn clearance<L: Lanes, P: EmbeddedPair>(y: [L; 2], rise: [L; 2], bow: L) -> L {
    if P::HAS_BOW { on_quartic(y, rise, bow) } else { on_cubic(y, rise) }
}

/// The distance by the cubic through both ends (counterpart: `crossing::approach`).
#[inline(always)]
fn on_cubic<L: Lanes>([y0, y1]: [L; 2], [rise0, rise1]: [L; 2]) -> L {
    let third = y0.lit(1.0 / 3.0);
    let (first, second) = (rise0.mul_add(third, y0), (-rise1).mul_add(third, y1));
    let chord = (y1 - y0) * third;
    let bend = (first - y0 - chord).abs().max((y1 - second - chord).abs());
    let inward = |y: L| Lanes::select(-y, y0, y);
    let least = inward(first).min(inward(second)).min(inward(y1));
    least - bend * y0.lit(SLACK)
}

/// The distance by the quartic that the pair provides over its step.
#[inline(always)]
fn on_quartic<L: Lanes>(y: [L; 2], rise: [L; 2], bow: L) -> L {
    let [y0, y1, y2, y3, y4] = quartic(y, rise, bow);
    let inward = |y: L| Lanes::select(-y, y0, y);
    inward(y1).min(inward(y2)).min(inward(y3)).min(inward(y4))
}

/// One pendulum's step, in f64.
pub(super) struct PairStep<'a> {
    pub pendulum: &'a Pendulum<f64>,
    pub inverse_scale: [f64; 2],
    pub before: StepState<f64>,
    pub after: StepState<f64>,
    pub length: f64,
}

impl PairStep<'_> {
    /// The state after a shorter step from the same beginning.
    pub(super) fn shortened<P: EmbeddedPair>(&self, fraction: f64) -> StepState<f64> {
        let begin = &self.before.phase;
        let trial = P::trial(self.pendulum, self.inverse_scale, begin, self.length * fraction);
        let phase = plus(begin, &trial.change);
        StepState { phase, speed: self.pendulum.speeds(&phase) }
    }

    /// Finds out whether and when a bob passes the top: on the quartic that the pair provides, or by
    /// shorter and shorter steps.
    pub(super) fn look<P: EmbeddedPair>(&self, bob: usize) -> StepCrossing<f64> {
        if P::HAS_BOW {
            return self.look_on_quartic::<P>(bob);
        }
        let at = |fraction| self.shortened::<P>(fraction);
        within(at, bob, &self.before, &self.after, self.length)
    }

    fn look_on_quartic<P: EmbeddedPair>(&self, bob: usize) -> StepCrossing<f64> {
        let PairStep { before, after, length, .. } = self;
        let trial = P::trial(self.pendulum, self.inverse_scale, &before.phase, *length);
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
            on_cubic(ys, rises).store(&mut by_lanes);
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
