//! Adaptive steps: embedded Runge–Kutta pairs on unit vectors and momenta, every lane with a time
//! and a step of its own.

use std::marker::PhantomData;

use super::lane_scheduler::{Chunk, ChunkResult, LaneScheduler, PATIENCE, lane_of};
use super::lanes::{Lanes, MAX_LANES};
use super::number::{Number, load_phase, store_phase};
use super::pair::{LaneStep, clearance};
use super::slowed::finish_slowed;
use super::stretch::{Stretch, StretchEnd, vectorized};
use super::{step_control, turns};
use crate::pace::Adaptive;
use crate::start::{self, STEP, TIME, TIME_LOW};
use crate::{FinalState, NUMBERS};
use flipmap_numbers::{Dd, Real};
use flipmap_pendulum::control::MAX_STEP;
use flipmap_pendulum::crossing::{FAR, StepState, beyond_top, height_beyond};
use flipmap_pendulum::embedded::EmbeddedPair;
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::{Outcome, Pendulum, Status};

/// Runs a chunk in lanes of `N`.
#[inline(never)]
pub(super) fn run<N: Number, P: EmbeddedPair>(
    set: <N::Leading as Lanes>::Set,
    chunk: &Chunk,
    adaptive: Adaptive,
) -> Option<ChunkResult> {
    let (exact, _) = chunk.question.reduced_in::<Dd>();
    let reduced = exact.to_f64();
    let mut lanes = AdaptiveLanes {
        scheduler: LaneScheduler::new(chunk, <N::Leading as Lanes>::COUNT, idle()),
        reduced,
        adaptive,
    };
    let mut suspect = SuspectStep::NONE;
    finish_those_over(&mut lanes.scheduler, &adaptive);
    while lanes.scheduler.is_busy() {
        if lanes.scheduler.is_cancelled() {
            return None;
        }
        let stretch = AdaptiveStretch::<N, P> {
            pendulum: &exact,
            inverse_scale: reduced.momentum_scale().map(|scale| 1.0 / scale),
            adaptive: &adaptive,
            scheduler: &mut lanes.scheduler,
            suspect: &mut suspect,
            kernel: PhantomData,
        };
        let StretchEnd { taken, is_suspect } = vectorized::<N::Leading, _>(set, stretch);
        lanes.scheduler.count_steps(taken);
        if is_suspect {
            lanes.decide::<P>(&suspect);
        }
        finish_slowed(&mut lanes.scheduler, &reduced);
        finish_those_over(&mut lanes.scheduler, &adaptive);
    }
    Some(lanes.scheduler.answer)
}

/// A loop that steps all lanes until a watched bob may have been at the top or a budget ends. The
/// suspect step is the last one taken.
struct AdaptiveStretch<'a, 'b, N, P> {
    pendulum: &'a Pendulum<Dd>,
    inverse_scale: [f64; 2],
    adaptive: &'a Adaptive,
    scheduler: &'a mut LaneScheduler<'b>,
    suspect: &'a mut SuspectStep,
    kernel: PhantomData<(N, P)>,
}

/// A step in which a bob of some lane may have been at the top.
struct SuspectStep {
    /// The lanes' numbers before the step.
    before: [[f64; MAX_LANES]; NUMBERS],
    /// Distance from the top that each lane's watched bobs keep in the step, as a sine; not
    /// positive where one may have crossed it.
    clearance: [f64; MAX_LANES],
}

impl SuspectStep {
    const NONE: SuspectStep =
        SuspectStep { before: [[0.0; MAX_LANES]; NUMBERS], clearance: [FAR; MAX_LANES] };
}

impl<N: Number, P: EmbeddedPair> Stretch<N::Leading> for AdaptiveStretch<'_, '_, N, P> {
    type Output = StretchEnd;

    #[inline(always)]
    fn run(self, set: <N::Leading as Lanes>::Set) -> StretchEnd {
        let number = N::exactly(<N::Leading as Lanes>::splat(set, 1.0));
        let lanes = |value: f64| [value; MAX_LANES];
        let pendulum = self.pendulum.map(|Dd { hi, lo }| N::load(set, &lanes(hi), &lanes(lo)));
        let inverse_scale = [number.lit(self.inverse_scale[0]), number.lit(self.inverse_scale[1])];
        let adaptive = *self.adaptive;
        let watches = self.scheduler.chunk.question.rule.watches();
        let counts_turns = self.scheduler.counts_turns();
        let mut state = LaneState::<N>::load(set, self.scheduler);
        let (zero, budget) = (state.time.lit(0.0), state.time.lit(adaptive.budget));
        let mut taken = 0;
        loop {
            let trial = P::trial(&pendulum, inverse_scale, &state.phase, N::exactly(state.step));
            let next = N::changed(&state.phase, &trial.change);
            let error_squared = trial.error_squared.leading();
            let excess = step_control::excess(&adaptive.control, state.time, error_squared);
            let clearance = state.clearance::<P>(watches, &pendulum, &next, &trial.bow);
            taken += 1;
            if clearance.max(excess).any_at_most(zero) {
                self.suspect.before = self.scheduler.rows;
                state.store_rows(&mut self.suspect.before);
                clearance.store(&mut self.suspect.clearance);
                state.advance(&adaptive, &next, excess);
                state.store(self.scheduler);
                return StretchEnd { taken, is_suspect: true };
            }
            if counts_turns {
                turns::count(&mut state.turns, [&state.phase, &next], excess);
            }
            state.advance(&adaptive, &next, excess);
            state.clearance =
                Lanes::select(state.clearance.min(clearance), excess, state.clearance);
            if taken == PATIENCE || budget.any_at_most(state.time) {
                state.store(self.scheduler);
                return StretchEnd { taken, is_suspect: false };
            }
        }
    }
}

/// A pendulum at rest, so long before its release that its budget never ends.
pub(super) fn idle() -> [f64; NUMBERS] {
    let mut numbers = [0.0; NUMBERS];
    (numbers[0], numbers[2], numbers[TIME]) = (1.0, 1.0, -1e30);
    numbers
}

/// The state of all lanes in registers.
#[derive(Clone, Copy)]
struct LaneState<N: Number> {
    phase: Phase<N>,
    time: N::Leading,
    time_low: N::Leading,
    step: N::Leading,
    /// Distance from the top that the watched bobs have kept so far, as a sine.
    clearance: N::Leading,
    /// Whole turns of each bob.
    turns: [N::Leading; 2],
}

impl<N: Number> LaneState<N> {
    #[inline(always)]
    fn load(set: <N::Leading as Lanes>::Set, scheduler: &LaneScheduler) -> Self {
        let rows = &scheduler.rows;
        let lanes = |row: usize| <N::Leading as Lanes>::load(set, &rows[row]);
        LaneState {
            phase: load_phase(set, rows),
            time: lanes(TIME),
            time_low: lanes(TIME_LOW),
            step: lanes(STEP),
            clearance: <N::Leading as Lanes>::load(set, &scheduler.clearance),
            turns: [0, 1].map(|bob| <N::Leading as Lanes>::load(set, &scheduler.turns[bob])),
        }
    }

    #[inline(always)]
    fn store(&self, scheduler: &mut LaneScheduler) {
        self.store_rows(&mut scheduler.rows);
        self.clearance.store(&mut scheduler.clearance);
        for (turns, row) in self.turns.iter().zip(&mut scheduler.turns) {
            turns.store(row);
        }
    }

    #[inline(always)]
    fn store_rows(&self, rows: &mut [[f64; MAX_LANES]; NUMBERS]) {
        store_phase(&self.phase, rows);
        self.time.store(&mut rows[TIME]);
        self.time_low.store(&mut rows[TIME_LOW]);
        self.step.store(&mut rows[STEP]);
    }

    /// Distance from the top that the watched bobs keep in the step to `next`; not positive in
    /// lanes where one may have crossed it.
    #[inline(always)]
    fn clearance<P: EmbeddedPair>(
        &self,
        watches: [bool; 2],
        pendulum: &Pendulum<N>,
        next: &Phase<N>,
        bow: &[N; 2],
    ) -> N::Leading {
        let speeds = [pendulum.speeds(&self.phase), pendulum.speeds(next)];
        let mut least = self.time.lit(FAR);
        // Written out: the loop would keep the phases in memory.
        if watches[0] {
            least = least.min(self.clearance_of::<P>(0, &speeds, next, bow));
        }
        if watches[1] {
            least = least.min(self.clearance_of::<P>(1, &speeds, next, bow));
        }
        least
    }

    /// Distance from the top that a bob keeps in the step to `next`; `speeds` are those of both
    /// ends.
    #[inline(always)]
    fn clearance_of<P: EmbeddedPair>(
        &self,
        bob: usize,
        speeds: &[[N; 2]; 2],
        next: &Phase<N>,
        bow: &[N; 2],
    ) -> N::Leading {
        let part = |phase: &Phase<N>| [phase[2 * bob].leading(), phase[2 * bob + 1].leading()];
        let ([x0, y0], [x1, y1]) = (part(&self.phase), part(next));
        let rise = [speeds[0][bob].leading() * x0, speeds[1][bob].leading() * x1];
        let rise = rise.map(|rise| rise * self.step);
        let clearance = clearance::<_, P>([y0, y1], rise, bow[bob].leading());
        // Below its pivot a bob is far from the top.
        Lanes::select(clearance, x0.min(x1), self.time.lit(FAR))
    }

    /// Takes the step where `excess` is negative, and chooses the length of the next one in every
    /// lane.
    #[inline(always)]
    fn advance(&mut self, adaptive: &Adaptive, next: &Phase<N>, excess: N::Leading) {
        for (value, next) in self.phase.iter_mut().zip(next) {
            *value = next.select(excess, *value);
        }
        let (time, low) = self.time.fast_two_sum(self.time_low + self.step);
        self.time = Lanes::select(time, excess, self.time);
        self.time_low = Lanes::select(low, excess, self.time_low);
        let factor = step_control::factor(&adaptive.control, excess);
        self.step = (self.step * factor).min(excess.lit(MAX_STEP));
    }
}

/// A lane scheduler for adaptive steps. Its rows are those of [`crate::start::PHASE`].
struct AdaptiveLanes<'a> {
    scheduler: LaneScheduler<'a>,
    reduced: Pendulum<f64>,
    adaptive: Adaptive,
}

impl AdaptiveLanes<'_> {
    /// Decides a step in which some lane's bob may have been at the top: looks for the crossing,
    /// and finishes the pendulums that made it.
    fn decide<P: EmbeddedPair>(&mut self, step: &SuspectStep) {
        for lane in self.scheduler.running() {
            let numbers = lane_of(&step.before, lane);
            let moved = self.scheduler.rows[TIME][lane] != numbers[TIME]
                || self.scheduler.rows[TIME_LOW][lane] != numbers[TIME_LOW];
            let clearance = step.clearance[lane];
            if moved && clearance > 0.0 {
                self.scheduler.clearance[lane] = self.scheduler.clearance[lane].min(clearance);
            } else if moved {
                self.look::<P>(lane, &numbers);
            }
        }
    }

    /// Looks for passes of the top, one after another, in the step that a lane took from `numbers`.
    fn look<P: EmbeddedPair>(&mut self, lane: usize, numbers: &[f64; NUMBERS]) {
        let moment = |numbers: &[f64; NUMBERS]| {
            let phase = start::phase_of(numbers);
            StepState { phase, speed: self.reduced.speeds(&phase) }
        };
        let (after, length) = (moment(&self.scheduler.numbers(lane)), numbers[STEP]);
        let mut step = LaneStep {
            pendulum: &self.reduced,
            inverse_scale: self.reduced.momentum_scale().map(|scale| 1.0 / scale),
            before: moment(numbers),
            after,
            length,
        };
        let mut begun = 0.0;
        while let Some((bob, fraction)) = first_pass::<P>(&mut self.scheduler, lane, &step) {
            let time = numbers[TIME] + (numbers[TIME_LOW] + (begun + step.length * fraction));
            let outcome = self.adaptive.outcome_of_pass(time);
            let top = || step.shortened::<P>(fraction);
            let from = step.before.phase[2 * bob + 1];
            let anticlockwise = if from == 0.0 { top().speed[bob] > 0.0 } else { from > 0.0 };
            let over = outcome.status == Status::Unflipped;
            if over || self.scheduler.pass(lane, bob, anticlockwise) {
                // A saved pendulum continues from before the step in which it flips.
                self.scheduler.put(lane, *numbers);
                self.scheduler.finish(lane, outcome, |scheduler| FinalState {
                    time,
                    phase: top().phase,
                    ..scheduler.end_of_phase(lane)
                });
                return;
            }
            let top = top();
            let cleared = height_beyond(&self.reduced, &top, bob);
            self.scheduler.clearance[lane] = self.scheduler.clearance[lane].min(cleared);
            begun += step.length * fraction;
            let before = beyond_top(&top, bob, anticlockwise);
            step = LaneStep { before, length: length - begun, ..step };
        }
    }
}

/// Returns the bob that first passes the top in a step, and the fraction of the step at which it
/// passes.
fn first_pass<P: EmbeddedPair>(
    scheduler: &mut LaneScheduler,
    lane: usize,
    step: &LaneStep,
) -> Option<(usize, f64)> {
    let config = scheduler.chunk.config;
    scheduler.answer.effort.rhs_evaluations += config.method.rhs_per_step(config.precision);
    let mut first: Option<(usize, f64)> = None;
    for &bob in scheduler.chunk.question.rule.watched() {
        let passed = step.look::<P>(bob);
        scheduler.clearance[lane] = scheduler.clearance[lane].min(passed.clearance);
        let earlier = |fraction: &f64| first.is_none_or(|(_, before)| *fraction < before);
        if let Some(fraction) = passed.fraction.filter(earlier) {
            first = Some((bob, fraction));
        }
    }
    first
}

/// Frees and refills the lanes whose budget is used up, until every lane has work or no start is
/// left.
pub(super) fn finish_those_over(scheduler: &mut LaneScheduler, adaptive: &Adaptive) {
    loop {
        scheduler.refill();
        let mut finished = false;
        for lane in scheduler.running() {
            let failed = scheduler.taken[lane] >= adaptive.most_steps;
            if failed || scheduler.rows[TIME][lane] >= adaptive.budget {
                let status = if failed { Status::Failed } else { Status::Unflipped };
                scheduler
                    .finish(lane, Outcome::without_time(status), |lanes| lanes.end_of_phase(lane));
                finished = true;
            }
        }
        if !finished {
            return;
        }
    }
}
