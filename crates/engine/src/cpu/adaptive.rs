//! Steps of embedded Runge–Kutta pairs on unit vectors and momenta, and the search for passes of the
//! top in one: by shorter steps from the same beginning, or on the quartic that the pair provides.

use std::marker::PhantomData;

use super::lane_loop::{LanePass, PassSearch, PassStepper};
use super::lane_scheduler::LaneScheduler;
use super::lanes::Lanes;
use super::number::Number;
use super::pair::{PairStep, clearance};
use super::step_control;
use super::stepper::{LaneDynamics, LaneState, LaneStep, LaneStepper};
use crate::NUMBERS;
use crate::start::{self, STEP};
use flipmap_numbers::Real;
use flipmap_pendulum::Pendulum;
use flipmap_pendulum::control::{Control, MAX_STEP};
use flipmap_pendulum::crossing::{FAR, StepState, beyond_top};
use flipmap_pendulum::embedded::{EmbeddedPair, Trial};
use flipmap_pendulum::phase::Phase;

/// Steps of the pair `P` whose length follows their error.
pub(super) struct PairSteps<P>(PhantomData<P>);

impl<N: Number, P: EmbeddedPair> LaneStepper<N> for PairSteps<P> {
    type Control = Control;
    type Motion = Trial<N>;

    #[inline(always)]
    fn motion(dynamics: &LaneDynamics<N>, state: &LaneState<N>) -> Trial<N> {
        let LaneDynamics { pendulum, inverse_scale } = dynamics;
        P::trial(pendulum, *inverse_scale, &state.phase, N::exactly(state.step))
    }

    #[inline(always)]
    fn step(
        _: &LaneDynamics<N>,
        control: &Control,
        state: &LaneState<N>,
        trial: &Trial<N>,
    ) -> LaneStep<N> {
        let error_squared = trial.error_squared.leading();
        let excess = step_control::excess(control, state.time, error_squared);
        LaneStep { next: N::changed(&state.phase, &trial.change), length: state.step, excess }
    }

    #[inline(always)]
    fn next_length(control: &Control, state: &LaneState<N>, step: &LaneStep<N>) -> N::Leading {
        let factor = step_control::factor(control, step.excess);
        (state.step * factor).min(step.excess.lit(MAX_STEP))
    }
}

impl<N: Number, P: EmbeddedPair> PassStepper<N> for PairSteps<P> {
    /// The step is computed again from the state before it.
    type Kept = ();
    type Search<'a> = PairSearch<'a, P>;

    #[inline(always)]
    fn clearance(
        dynamics: &LaneDynamics<N>,
        watches: [bool; 2],
        state: &LaneState<N>,
        step: &LaneStep<N>,
        trial: &Trial<N>,
    ) -> N::Leading {
        let phases = [&state.phase, &step.next];
        // Written out, as `map` would not be compiled for the instruction set.
        let speeds = [dynamics.pendulum.speeds(phases[0]), dynamics.pendulum.speeds(phases[1])];
        let mut least = step.length.lit(FAR);
        // Written out: the loop would keep the phases in memory.
        if watches[0] {
            least = least.min(clearance_of::<N, P>(0, phases, &speeds, step.length, &trial.bow));
        }
        if watches[1] {
            least = least.min(clearance_of::<N, P>(1, phases, &speeds, step.length, &trial.bow));
        }
        least
    }

    #[inline(always)]
    fn keep((): &mut (), _: &Trial<N>, _: &LaneStep<N>) {}

    fn search<'a>(
        (): &(),
        pendulum: &'a Pendulum<f64>,
        scheduler: &mut LaneScheduler,
        lane: usize,
        numbers: &[f64; NUMBERS],
    ) -> PairSearch<'a, P> {
        let moment = |numbers: &[f64; NUMBERS]| {
            let phase = start::phase_of(numbers);
            StepState { phase, speed: pendulum.speeds(&phase) }
        };
        let step = PairStep {
            pendulum,
            inverse_scale: pendulum.momentum_scale().map(|scale| 1.0 / scale),
            before: moment(numbers),
            after: moment(&scheduler.numbers(lane)),
            length: numbers[STEP],
        };
        PairSearch { step, begun: 0.0, whole: numbers[STEP], fraction: 0.0, pair: PhantomData }
    }
}

/// Distance from the top that a bob keeps between two phases with these speeds.
#[inline(always)]
fn clearance_of<N: Number, P: EmbeddedPair>(
    bob: usize,
    phases: [&Phase<N>; 2],
    speeds: &[[N; 2]; 2],
    length: N::Leading,
    bow: &[N; 2],
) -> N::Leading {
    let part = |phase: &Phase<N>| [phase[2 * bob].leading(), phase[2 * bob + 1].leading()];
    let ([x0, y0], [x1, y1]) = (part(phases[0]), part(phases[1]));
    let rise = [speeds[0][bob].leading() * x0, speeds[1][bob].leading() * x1];
    let rise = rise.map(|rise| rise * length);
    let clearance = clearance::<_, P>([y0, y1], rise, bow[bob].leading());
    // Below its pivot a bob is far from the top.
    Lanes::select(clearance, x0.min(x1), length.lit(FAR))
}

/// The search in one pendulum's step of a pair.
pub(super) struct PairSearch<'a, P> {
    /// The rest of the step, after the passes found so far.
    step: PairStep<'a>,
    /// Reduced time between the beginning of the step and that of its rest.
    begun: f64,
    /// Length of the whole step.
    whole: f64,
    /// Fraction of the rest at which the last pass was found.
    fraction: f64,
    pair: PhantomData<P>,
}

impl<P: EmbeddedPair> PairSearch<'_, P> {
    /// Returns the bob that first passes the top, and the fraction of the rest at which it passes.
    fn first(&self, scheduler: &mut LaneScheduler, lane: usize) -> Option<(usize, f64)> {
        let config = scheduler.chunk.config;
        scheduler.answer.effort.rhs_evaluations += config.method.rhs_per_step(config.precision);
        let mut first: Option<(usize, f64)> = None;
        for &bob in scheduler.chunk.question.rule.watched() {
            let passed = self.step.look::<P>(bob);
            scheduler.clearance[lane] = scheduler.clearance[lane].min(passed.clearance);
            let earlier = |fraction: &f64| first.is_none_or(|(_, before)| *fraction < before);
            if let Some(fraction) = passed.fraction.filter(earlier) {
                first = Some((bob, fraction));
            }
        }
        first
    }
}

impl<P: EmbeddedPair> PassSearch for PairSearch<'_, P> {
    fn next(&mut self, scheduler: &mut LaneScheduler, lane: usize) -> Option<LanePass> {
        let (bob, fraction) = self.first(scheduler, lane)?;
        self.fraction = fraction;
        let from = self.step.before.phase[2 * bob + 1];
        let anticlockwise = if from == 0.0 { self.top().speed[bob] > 0.0 } else { from > 0.0 };
        Some(LanePass { into_step: self.begun + self.step.length * fraction, bob, anticlockwise })
    }

    fn top(&self) -> StepState<f64> {
        self.step.shortened::<P>(self.fraction)
    }

    fn go_on(&mut self, pass: &LanePass, top: &StepState<f64>) {
        self.begun = pass.into_step;
        self.step.before = beyond_top(top, pass.bob, pass.anticlockwise);
        self.step.length = self.whole - self.begun;
    }
}
