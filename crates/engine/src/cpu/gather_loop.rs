//! The loop of pendulums that gather something along their way and are followed to the end of the
//! budget, whatever they do: a register of them at a time, every lane with a time and a step of its
//! own. A [`LaneStepper`] takes the steps, and an [`Observer`] sees them.

use std::marker::PhantomData;
use std::sync::atomic::Ordering;

use super::lane_scheduler::{Chunk, ChunkResult, lane_of};
use super::lanes::{Lanes, MAX_LANES, row};
use super::number::Number;
use super::stepper::{LaneDynamics, LaneState, LaneStep, LaneStepper};
use super::stretch::{Stretch, vectorized};
use crate::start::TIME;
use crate::{Carried, FinalState, IntegratorState, NUMBERS};
use flipmap_numbers::{Dd, Real};
use flipmap_pendulum::{Outcome, Pendulum, Status};

/// What the pendulums in lanes of `N` gather along their way.
pub(super) trait Observer<N: Number>: Sized {
    /// What it is told to gather.
    type Wanted: Copy;

    /// Begins with pendulums at their starts, or where an earlier job left them. `starts` has one
    /// state for each lane.
    fn begin(
        set: <N::Leading as Lanes>::Set,
        wanted: Self::Wanted,
        dynamics: &LaneDynamics<N>,
        state: &mut LaneState<N>,
        starts: &[&IntegratorState; MAX_LANES],
    ) -> Self;
    /// Sees a step from `state`, before the lanes that take it do so.
    fn see<M: LaneStepper<N>>(
        &mut self,
        dynamics: &LaneDynamics<N>,
        control: &M::Control,
        state: &LaneState<N>,
        step: &LaneStep<N>,
    );
    /// Called after every few steps, to keep the numbers of the state within bounds.
    fn rest(&mut self, set: <N::Leading as Lanes>::Set, state: &mut LaneState<N>);
    /// Returns what each lane has gathered so far.
    fn carried(&self, state: &LaneState<N>) -> [Carried; MAX_LANES];
    /// Returns the end of a pendulum that was left in a state.
    fn end(reduced: &Pendulum<f64>, left: &IntegratorState) -> FinalState;
}

/// Runs a chunk in lanes of `N`, in steps of `M`.
#[inline(never)]
pub(super) fn run<N: Number, M: LaneStepper<N>, O: Observer<N>>(
    set: <N::Leading as Lanes>::Set,
    chunk: &Chunk,
    control: M::Control,
    wanted: O::Wanted,
) -> Option<ChunkResult> {
    let way = WholeWay::<N, M, O> { chunk, control, wanted, lanes: PhantomData };
    vectorized::<N::Leading, _>(set, way)
}

/// The way of a chunk's pendulums through the budget.
struct WholeWay<'a, N: Number, M: LaneStepper<N>, O: Observer<N>> {
    chunk: &'a Chunk<'a>,
    control: M::Control,
    wanted: O::Wanted,
    lanes: PhantomData<N>,
}

/// Number of steps after which an observer may rest, and cancellation is noticed.
const STRETCH: u32 = 32;

impl<N: Number, M: LaneStepper<N>, O: Observer<N>> Stretch<N::Leading> for WholeWay<'_, N, M, O> {
    type Output = Option<ChunkResult>;

    #[inline(always)]
    fn run(self, set: <N::Leading as Lanes>::Set) -> Option<ChunkResult> {
        let chunk = self.chunk;
        let (reduced, unit_secs) = chunk.question.reduced();
        let dynamics = LaneDynamics::<N>::load(set, &chunk.question.reduced_in::<Dd>().0);
        let end = <N::Leading as Lanes>::splat(set, chunk.question.budget_secs / unit_secs);
        let mut result = ChunkResult::default();
        for starts in chunk.starts.chunks(<N::Leading as Lanes>::COUNT) {
            // Lanes without a start repeat the last one.
            let all = std::array::from_fn(|lane| &starts[lane.min(starts.len() - 1)]);
            let mut state = LaneState::<N>::load(set, &rows(&all));
            let observer = O::begin(set, self.wanted, &dynamics, &mut state, &all);
            let mut lanes = GatheringLanes::<N, M, O> {
                dynamics: &dynamics,
                control: self.control,
                end,
                state,
                observer,
                steps: 0,
            };
            for cuts in [false, true] {
                lanes.go(set, chunk, cuts)?;
                if !cuts && chunk.keep.states {
                    result.states.extend(lanes.states(starts));
                }
            }
            lanes.finish(&reduced, chunk, starts, &mut result);
        }
        Some(result)
    }
}

/// The numbers of states, lane by lane.
fn rows(states: &[&IntegratorState; MAX_LANES]) -> [[f64; MAX_LANES]; NUMBERS] {
    std::array::from_fn(|place| states.map(|state| state.numbers[place]))
}

/// Pendulums on their way in the lanes of a register.
struct GatheringLanes<'a, N: Number, M: LaneStepper<N>, O> {
    dynamics: &'a LaneDynamics<N>,
    control: M::Control,
    /// Reduced time at which the budget ends.
    end: N::Leading,
    state: LaneState<N>,
    observer: O,
    /// Number of steps tried.
    steps: u32,
}

impl<N: Number, M: LaneStepper<N>, O: Observer<N>> GatheringLanes<'_, N, M, O> {
    /// Goes on to the end of the budget if the last step is cut, otherwise to the end of the last
    /// whole step within the budget, after which a job with a larger budget can continue. Returns
    /// `None` if the job was cancelled.
    #[inline(always)]
    fn go(&mut self, set: <N::Leading as Lanes>::Set, chunk: &Chunk, cuts: bool) -> Option<()> {
        let most_steps = chunk.pace.most_steps_to_end();
        loop {
            let length = self.length(cuts);
            if self.steps >= most_steps || !length.lit(0.0).any_less(length) {
                return Some(());
            }
            self.step(length);
            self.steps += 1;
            if self.steps.is_multiple_of(STRETCH) {
                if chunk.cancelled.load(Ordering::Relaxed) {
                    return None;
                }
                self.observer.rest(set, &mut self.state);
            }
        }
    }

    /// Length of the next step, 0 in lanes that wait or are done.
    #[inline(always)]
    fn length(&self, cuts: bool) -> N::Leading {
        let LaneState { time, time_low, step, .. } = self.state;
        let left = (self.end - time) - time_low;
        if cuts { step.min(left).max(step.lit(0.0)) } else { step.where_negative(step - left) }
    }

    /// Tries a step in every lane, and takes it where its error is allowed.
    #[inline(always)]
    fn step(&mut self, length: N::Leading) {
        let tried = LaneState { step: length, ..self.state };
        let motion = M::motion(self.dynamics, &tried);
        let step = M::step(self.dynamics, &self.control, &tried, &motion);
        self.observer.see::<M>(self.dynamics, &self.control, &self.state, &step);
        let waiting = self.state.step;
        self.state.advance::<M>(&self.control, &step);
        self.state.step = Lanes::select(self.state.step, -length, waiting);
    }

    /// The states of the lanes that have starts.
    fn states(&self, starts: &[IntegratorState]) -> Vec<IntegratorState> {
        let mut rows = [[0.0; MAX_LANES]; NUMBERS];
        self.state.store(&mut rows);
        let state = |(lane, (start, carried)): (usize, (&IntegratorState, Carried))| {
            let (steps, numbers) = (start.steps + self.steps, lane_of(&rows, lane));
            IntegratorState { steps, numbers, carried: Some(Box::new(carried)) }
        };
        let carried = self.observer.carried(&self.state);
        starts.iter().zip(carried).enumerate().map(state).collect()
    }

    /// Adds the results of pendulums in their last states.
    fn finish(
        &self,
        reduced: &Pendulum<f64>,
        chunk: &Chunk,
        starts: &[IntegratorState],
        result: &mut ChunkResult,
    ) {
        let until = row(self.end)[0] * (1.0 - 1e-6);
        for state in self.states(starts) {
            let end = O::end(reduced, &state);
            let sound = end.phase.iter().all(|number| number.is_finite())
                && end.gathered.log_growth.is_finite();
            let whole = sound && state.numbers[TIME] >= until;
            let status = if whole { Status::Unflipped } else { Status::Failed };
            result.outcomes.push(Outcome::without_time(status));
            result.ends.push(end);
        }
        let (steps, count) = (u64::from(self.steps), starts.len() as u64);
        let rhs = chunk.config.method.rhs_per_step(chunk.config.precision);
        result.effort.steps += steps * count;
        result.effort.lane_steps += steps * <N::Leading as Lanes>::COUNT as u64;
        result.effort.rhs_evaluations += rhs * steps * count;
    }
}
