//! The loop of pendulums that are followed to their passes of the top: a register of them at a time,
//! every lane with a time and a step of its own. A [`PassStepper`] takes the steps.

use super::lane_scheduler::{Chunk, ChunkResult, LaneScheduler, PATIENCE, lane_of};
use super::lanes::{Lanes, MAX_LANES};
use super::number::Number;
use super::slowed::finish_slowed;
use super::stepper::{LaneDynamics, LaneState, LaneStep, LaneStepper};
use super::stretch::{Stretch, StretchEnd, vectorized};
use super::turns;
use crate::pace::Adaptive;
use crate::start::{TIME, TIME_LOW};
use crate::{FinalState, NUMBERS};
use flipmap_numbers::{Dd, Real};
use flipmap_pendulum::control::Control;
use flipmap_pendulum::crossing::{FAR, StepState, height_beyond};
use flipmap_pendulum::{Outcome, Pendulum, Status};

/// A method whose steps can be searched for passes of the top.
pub(super) trait PassStepper<N: Number>: LaneStepper<N, Control = Control> {
    /// What is kept of the motion in a suspect step.
    type Kept: Default;

    /// Returns the distance from the top, as a sine, that the watched bobs keep in a step; not
    /// positive in lanes where one may have crossed it.
    fn clearance(
        dynamics: &LaneDynamics<N>,
        watches: [bool; 2],
        state: &LaneState<N>,
        step: &LaneStep<N>,
        motion: &Self::Motion,
    ) -> N::Leading;
    /// Keeps the motion in a suspect step.
    fn keep(kept: &mut Self::Kept, motion: &Self::Motion, step: &LaneStep<N>);

    /// The search for passes of the top in one lane's suspect step.
    type Search<'a>: PassSearch;
    /// Begins the search in the step that a lane took from `numbers`.
    fn search<'a>(
        kept: &Self::Kept,
        pendulum: &'a Pendulum<f64>,
        scheduler: &mut LaneScheduler,
        lane: usize,
        numbers: &[f64; NUMBERS],
    ) -> Self::Search<'a>;
}

/// The passes of the top in a step of one pendulum, in order of time.
pub(super) trait PassSearch {
    /// Finds the next pass. Lowers the lane's clearance to the least distance from the top at which
    /// a bob turned round before it.
    fn next(&mut self, scheduler: &mut LaneScheduler, lane: usize) -> Option<LanePass>;
    /// Returns the state at the last pass that was found.
    fn top(&self) -> StepState<f64>;
    /// Goes on from the other side of the top after that pass.
    fn go_on(&mut self, pass: &LanePass, top: &StepState<f64>);
}

/// A pass of the top.
#[derive(Clone, Copy, Debug)]
pub(super) struct LanePass {
    /// Reduced time since the step began.
    pub into_step: f64,
    pub bob: usize,
    pub anticlockwise: bool,
}

/// Runs a chunk in lanes of `N`, in steps of `M`.
#[inline(never)]
pub(super) fn run<N: Number, M: PassStepper<N>>(
    set: <N::Leading as Lanes>::Set,
    chunk: &Chunk,
    adaptive: Adaptive,
) -> Option<ChunkResult> {
    let (exact, _) = chunk.question.reduced_in::<Dd>();
    let reduced = exact.to_f64();
    let mut scheduler = LaneScheduler::new(chunk, <N::Leading as Lanes>::COUNT, idle());
    let mut suspect = SuspectStep::<M::Kept>::default();
    finish_those_over(&mut scheduler, &adaptive);
    while scheduler.is_busy() {
        if scheduler.is_cancelled() {
            return None;
        }
        let (scheduler, suspect) = (&mut scheduler, &mut suspect);
        let stretch =
            PassStretch::<N, M> { exact: &exact, adaptive: &adaptive, scheduler, suspect };
        let StretchEnd { taken, is_suspect } = vectorized::<N::Leading, _>(set, stretch);
        scheduler.count_steps(taken);
        if is_suspect {
            decide::<N, M>(scheduler, suspect, &reduced, &adaptive);
        }
        finish_slowed(scheduler, &reduced);
        finish_those_over(scheduler, &adaptive);
    }
    Some(scheduler.answer)
}

/// A step in which a bob of some lane may have been at the top.
struct SuspectStep<K> {
    /// The lanes' numbers before the step.
    before: [[f64; MAX_LANES]; NUMBERS],
    /// Distance from the top that each lane's watched bobs keep in the step, as a sine; not
    /// positive where one may have crossed it.
    clearance: [f64; MAX_LANES],
    /// What the method keeps of the motion in between.
    motion: K,
}

impl<K: Default> Default for SuspectStep<K> {
    fn default() -> Self {
        SuspectStep {
            before: [[0.0; MAX_LANES]; NUMBERS],
            clearance: [FAR; MAX_LANES],
            motion: K::default(),
        }
    }
}

/// A loop that steps all lanes until a watched bob may have been at the top or a budget ends. The
/// suspect step is the last one taken.
struct PassStretch<'a, 'b, N: Number, M: PassStepper<N>> {
    exact: &'a Pendulum<Dd>,
    adaptive: &'a Adaptive,
    scheduler: &'a mut LaneScheduler<'b>,
    suspect: &'a mut SuspectStep<M::Kept>,
}

impl<N: Number, M: PassStepper<N>> Stretch<N::Leading> for PassStretch<'_, '_, N, M> {
    type Output = StretchEnd;

    #[inline(always)]
    fn run(self, set: <N::Leading as Lanes>::Set) -> StretchEnd {
        let dynamics = LaneDynamics::<N>::load(set, self.exact);
        let (control, budget) = (self.adaptive.control, self.adaptive.budget);
        let watches = self.scheduler.chunk.question.rule.watches();
        let counts_turns = self.scheduler.counts_turns();
        let mut state = LaneState::<N>::load(set, &self.scheduler.rows);
        let mut watched = Watched::<N>::load(set, self.scheduler);
        let (zero, budget) = (state.time.lit(0.0), state.time.lit(budget));
        let mut taken = 0;
        loop {
            let motion = M::motion(&dynamics, &state);
            let step = M::step(&dynamics, &control, &state, &motion);
            let clearance = M::clearance(&dynamics, watches, &state, &step, &motion);
            taken += 1;
            if clearance.max(step.excess).any_at_most(zero) {
                self.suspect.before = self.scheduler.rows;
                state.store(&mut self.suspect.before);
                clearance.store(&mut self.suspect.clearance);
                M::keep(&mut self.suspect.motion, &motion, &step);
                state.advance::<M>(&control, &step);
                state.store(&mut self.scheduler.rows);
                watched.store(self.scheduler);
                return StretchEnd { taken, is_suspect: true };
            }
            if counts_turns {
                turns::count(&mut watched.turns, [&state.phase, &step.next], step.excess);
            }
            state.advance::<M>(&control, &step);
            let least = watched.clearance.min(clearance);
            watched.clearance = Lanes::select(least, step.excess, watched.clearance);
            if taken == PATIENCE || budget.any_at_most(state.time) {
                state.store(&mut self.scheduler.rows);
                watched.store(self.scheduler);
                return StretchEnd { taken, is_suspect: false };
            }
        }
    }
}

/// What is watched in all lanes along with their states.
struct Watched<N: Number> {
    /// Distance from the top that the watched bobs have kept so far, as a sine.
    clearance: N::Leading,
    /// Whole turns of each bob.
    turns: [N::Leading; 2],
}

impl<N: Number> Watched<N> {
    #[inline(always)]
    fn load(set: <N::Leading as Lanes>::Set, scheduler: &LaneScheduler) -> Self {
        Watched {
            clearance: <N::Leading as Lanes>::load(set, &scheduler.clearance),
            turns: [0, 1].map(|bob| <N::Leading as Lanes>::load(set, &scheduler.turns[bob])),
        }
    }

    #[inline(always)]
    fn store(&self, scheduler: &mut LaneScheduler) {
        self.clearance.store(&mut scheduler.clearance);
        for (turns, row) in self.turns.iter().zip(&mut scheduler.turns) {
            turns.store(row);
        }
    }
}

/// A pendulum at rest, so long before its release that its budget never ends.
fn idle() -> [f64; NUMBERS] {
    let mut numbers = [0.0; NUMBERS];
    (numbers[0], numbers[2], numbers[TIME]) = (1.0, 1.0, -1e30);
    numbers
}

/// Decides a suspect step: looks for the crossing lane by lane, and finishes the pendulums that made
/// it.
fn decide<N: Number, M: PassStepper<N>>(
    scheduler: &mut LaneScheduler,
    step: &SuspectStep<M::Kept>,
    reduced: &Pendulum<f64>,
    adaptive: &Adaptive,
) {
    for lane in scheduler.running() {
        let numbers = lane_of(&step.before, lane);
        let moved = scheduler.rows[TIME][lane] != numbers[TIME]
            || scheduler.rows[TIME_LOW][lane] != numbers[TIME_LOW];
        let clearance = step.clearance[lane];
        if moved && clearance > 0.0 {
            scheduler.clearance[lane] = scheduler.clearance[lane].min(clearance);
        } else if moved {
            let search = M::search(&step.motion, reduced, scheduler, lane, &numbers);
            look(scheduler, lane, &numbers, search, reduced, adaptive);
        }
    }
}

/// Follows a lane through the passes of the top in the step that it took from `numbers`.
fn look(
    scheduler: &mut LaneScheduler,
    lane: usize,
    numbers: &[f64; NUMBERS],
    mut search: impl PassSearch,
    reduced: &Pendulum<f64>,
    adaptive: &Adaptive,
) {
    while let Some(pass) = search.next(scheduler, lane) {
        let time = numbers[TIME] + (numbers[TIME_LOW] + pass.into_step);
        let outcome = adaptive.outcome_of_pass(time);
        let over = outcome.status == Status::Unflipped;
        if over || scheduler.pass(lane, pass.bob, pass.anticlockwise) {
            // A saved pendulum continues from before the step in which it flips.
            scheduler.put(lane, *numbers);
            scheduler.finish(lane, outcome, |scheduler| FinalState {
                time,
                phase: search.top().phase,
                ..scheduler.end_of_phase(lane)
            });
            return;
        }
        let top = search.top();
        let cleared = height_beyond(reduced, &top, pass.bob);
        scheduler.clearance[lane] = scheduler.clearance[lane].min(cleared);
        search.go_on(&pass, &top);
    }
}

/// Frees and refills the lanes whose budget is used up, until every lane has work or no start is
/// left.
fn finish_those_over(scheduler: &mut LaneScheduler, adaptive: &Adaptive) {
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
