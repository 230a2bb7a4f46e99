//! The loop of pendulums that are followed to their passes of the top: a register of them at a time,
//! every lane with a time and a step of its own. A [`LaneStepper`] takes the steps.

use super::lane_scheduler::{Chunk, ChunkResult, LaneScheduler, PATIENCE, lane_of};
use super::lanes::{Lanes, MAX_LANES};
use super::number::{Number, load_phase, store_phase};
use super::slowed::finish_slowed;
use super::stretch::{Stretch, StretchEnd, vectorized};
use super::turns;
use crate::pace::Adaptive;
use crate::start::{STEP, TIME, TIME_LOW};
use crate::{FinalState, NUMBERS};
use flipmap_numbers::{Dd, Real};
use flipmap_pendulum::crossing::{FAR, StepState, height_beyond};
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::{Outcome, Pendulum, Status};

/// A method's steps, in lanes of `N`.
pub(super) trait LaneStepper<N: Number> {
    /// The motion in a step of all lanes, as far as the method knows it.
    type Motion;
    /// What is kept of the motion in a suspect step.
    type Kept: Default;

    /// Computes the motion that begins in a state.
    fn motion(dynamics: &LaneDynamics<N>, state: &LaneState<N>) -> Self::Motion;
    /// Returns the step along a motion.
    fn step(
        dynamics: &LaneDynamics<N>,
        adaptive: &Adaptive,
        state: &LaneState<N>,
        motion: &Self::Motion,
    ) -> LaneStep<N>;
    /// Returns the distance from the top, as a sine, that the watched bobs keep in a step; not
    /// positive in lanes where one may have crossed it.
    fn clearance(
        dynamics: &LaneDynamics<N>,
        watches: [bool; 2],
        state: &LaneState<N>,
        step: &LaneStep<N>,
        motion: &Self::Motion,
    ) -> N::Leading;
    /// Returns the length of the step that is tried next.
    fn next_length(adaptive: &Adaptive, state: &LaneState<N>, step: &LaneStep<N>) -> N::Leading;
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

/// The pendulum in reduced units, in all lanes.
pub(super) struct LaneDynamics<N: Number> {
    pub pendulum: Pendulum<N>,
    pub inverse_scale: [N; 2],
}

/// A step of all lanes.
pub(super) struct LaneStep<N: Number> {
    /// The state after it.
    pub next: Phase<N>,
    pub length: N::Leading,
    /// Negative in lanes where the step is taken.
    pub excess: N::Leading,
}

/// Runs a chunk in lanes of `N`, in steps of `M`.
#[inline(never)]
pub(super) fn run<N: Number, M: LaneStepper<N>>(
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
struct PassStretch<'a, 'b, N: Number, M: LaneStepper<N>> {
    exact: &'a Pendulum<Dd>,
    adaptive: &'a Adaptive,
    scheduler: &'a mut LaneScheduler<'b>,
    suspect: &'a mut SuspectStep<M::Kept>,
}

impl<N: Number, M: LaneStepper<N>> Stretch<N::Leading> for PassStretch<'_, '_, N, M> {
    type Output = StretchEnd;

    #[inline(always)]
    fn run(self, set: <N::Leading as Lanes>::Set) -> StretchEnd {
        let dynamics = LaneDynamics::<N>::load(set, self.exact);
        let adaptive = *self.adaptive;
        let watches = self.scheduler.chunk.question.rule.watches();
        let counts_turns = self.scheduler.counts_turns();
        let mut state = LaneState::<N>::load(set, self.scheduler);
        let (zero, budget) = (state.time.lit(0.0), state.time.lit(adaptive.budget));
        let mut taken = 0;
        loop {
            let motion = M::motion(&dynamics, &state);
            let step = M::step(&dynamics, &adaptive, &state, &motion);
            let clearance = M::clearance(&dynamics, watches, &state, &step, &motion);
            taken += 1;
            if clearance.max(step.excess).any_at_most(zero) {
                self.suspect.before = self.scheduler.rows;
                state.store_rows(&mut self.suspect.before);
                clearance.store(&mut self.suspect.clearance);
                M::keep(&mut self.suspect.motion, &motion, &step);
                state.advance::<M>(&adaptive, &step);
                state.store(self.scheduler);
                return StretchEnd { taken, is_suspect: true };
            }
            if counts_turns {
                turns::count(&mut state.turns, [&state.phase, &step.next], step.excess);
            }
            state.advance::<M>(&adaptive, &step);
            state.clearance =
                Lanes::select(state.clearance.min(clearance), step.excess, state.clearance);
            if taken == PATIENCE || budget.any_at_most(state.time) {
                state.store(self.scheduler);
                return StretchEnd { taken, is_suspect: false };
            }
        }
    }
}

impl<N: Number> LaneDynamics<N> {
    #[inline(always)]
    fn load(set: <N::Leading as Lanes>::Set, exact: &Pendulum<Dd>) -> Self {
        let number = N::exactly(<N::Leading as Lanes>::splat(set, 1.0));
        let lanes = |value: f64| [value; MAX_LANES];
        let scale = exact.to_f64().momentum_scale();
        LaneDynamics {
            pendulum: exact.map(|Dd { hi, lo }| N::load(set, &lanes(hi), &lanes(lo))),
            inverse_scale: [number.lit(1.0 / scale[0]), number.lit(1.0 / scale[1])],
        }
    }
}

/// A pendulum at rest, so long before its release that its budget never ends.
fn idle() -> [f64; NUMBERS] {
    let mut numbers = [0.0; NUMBERS];
    (numbers[0], numbers[2], numbers[TIME]) = (1.0, 1.0, -1e30);
    numbers
}

/// The state of all lanes in registers.
#[derive(Clone, Copy)]
pub(super) struct LaneState<N: Number> {
    pub phase: Phase<N>,
    pub time: N::Leading,
    time_low: N::Leading,
    /// Length of the step that is tried next.
    pub step: N::Leading,
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

    /// Takes a step in the lanes that take it.
    #[inline(always)]
    fn advance<M: LaneStepper<N>>(&mut self, adaptive: &Adaptive, step: &LaneStep<N>) {
        let LaneStep { next, length, excess } = step;
        for (value, next) in self.phase.iter_mut().zip(next) {
            *value = next.select(*excess, *value);
        }
        let (time, low) = self.time.fast_two_sum(self.time_low + *length);
        self.time = Lanes::select(time, *excess, self.time);
        self.time_low = Lanes::select(low, *excess, self.time_low);
        self.step = M::next_length(adaptive, self, step);
    }
}

/// Decides a suspect step: looks for the crossing lane by lane, and finishes the pendulums that made
/// it.
fn decide<N: Number, M: LaneStepper<N>>(
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
