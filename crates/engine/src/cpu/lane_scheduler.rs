//! The lane scheduler: keeps every lane of a SIMD register busy although pendulums finish at very
//! different times.
//!
//! A register steps all of its pendulums at once, and some flip after a second while others use up
//! the budget. If each register waited for its slowest pendulum, most lanes would idle. So a lane
//! whose pendulum is done takes the next start of the chunk at once, as rays are replaced in the
//! persistent threads of Aila and Laine (*Understanding the efficiency of ray traversal on GPUs*,
//! 2009).
//!
//! ```text
//!  lane 0   start 0 ──────────── flip│start 4 ────────────────────────────
//!  lane 1   start 1 ──────────────────────────────────── over│start 5 ────
//!  lane 2   start 2 ── flip│start 3 ──────────────────────────────────────
//!  stretch  ├──────────────┼─────────┼───────────────────────┼────────────
//! ```
//!
//! The integrators run in *stretches*: load the rows into registers, step in a tight loop until a
//! watched bob may be at the top, a budget ends or [`PATIENCE`] is reached, and store them again.
//! Between stretches the scheduler works lane by lane: it finishes pendulums and refills lanes.
//!
//! * Each lane has its own time, step and counts, so an answer does not depend on the lanes beside
//!   it; results are stored by start, so the order in which pendulums finish does not matter.
//! * A lane without work runs a harmless pendulum, so the loop needs no mask.
//! * Lanes idle only at the tail of a chunk, when no start is left.
//!   [`Effort::steps`] over [`Effort::lane_steps`] is the share of lanes in use.
//! * Cancellation is noticed between stretches.

use std::sync::atomic::{AtomicBool, Ordering};

use super::lanes::MAX_LANES;
use crate::pace::Pace;
use crate::start::{TIME, TIME_LOW, phase_of};
use crate::{
    Carried, Effort, EventSpec, FinalState, IntegratorConfig, IntegratorState, Keep, NUMBERS,
};
use flipmap_pendulum::crossing::FAR;
use flipmap_pendulum::{Accumulators, Outcome, Rule, Status};
use flipmap_scene::question::Needs;

/// A chunk of a job, with all that its lanes need.
pub(super) struct Chunk<'a> {
    /// The question to answer for each start.
    pub question: &'a EventSpec,
    /// The method and the precision.
    pub config: IntegratorConfig,
    /// The steps over the budget.
    pub pace: Pace,
    /// States in which the pendulums begin, in reduced units.
    pub starts: &'a [IntegratorState],
    /// The states to return, which decide what is computed in addition to the outcomes.
    pub keep: Keep,
    /// Flag that is set when the answer is no longer needed.
    pub cancelled: &'a AtomicBool,
}

impl Chunk<'_> {
    /// Returns true if ends are computed: for the job's caller, or for the counts in its states.
    fn keeps_ends(&self) -> bool {
        self.keep.ends != Needs::Outcome || (self.keep.states && self.question.counts())
    }
}

/// The result of a chunk: the outcome of each start, its last state and its end if they are kept,
/// and the work done.
#[derive(Default)]
pub(super) struct ChunkResult {
    /// Outcomes, in the order of the starts.
    pub outcomes: Vec<Outcome>,
    /// Last states, in the order of the starts; for flipped pendulums, at the beginning of the step
    /// in which they flipped.
    pub states: Vec<IntegratorState>,
    /// Ends, in the order of the starts.
    pub ends: Vec<FinalState>,
    /// Work done for the chunk.
    pub effort: Effort,
}

/// Number of steps between two checks for cancellation.
pub(super) const PATIENCE: u32 = 512;

/// The lanes of a chunk between stretches of steps.
pub(super) struct LaneScheduler<'a> {
    /// The chunk that is computed.
    pub chunk: &'a Chunk<'a>,
    /// Each number of the state, lane by lane.
    pub rows: [[f64; MAX_LANES]; NUMBERS],
    /// Number of steps that each lane's pendulum has taken.
    pub taken: [u32; MAX_LANES],
    /// Distance from the top that the watched bobs of each lane's pendulum have kept so far, as a
    /// sine.
    pub clearance: [f64; MAX_LANES],
    /// Whole turns of each bob of each lane's pendulum, where no bob is watched.
    pub turns: [[f64; MAX_LANES]; 2],
    /// Passes of each lane's pendulum so far (see [`Accumulators::passes`]).
    pub passes: [[u32; 4]; MAX_LANES],
    /// The results of the pendulums that are done.
    pub answer: ChunkResult,
    lanes: usize,
    /// Index of the start that each lane runs.
    start: [usize; MAX_LANES],
    idle: [f64; NUMBERS],
    next_start: usize,
    busy: usize,
}

/// Returns the numbers of one lane from the rows of all lanes.
#[inline]
pub(super) fn lane_of<const N: usize>(rows: &[[f64; MAX_LANES]; N], lane: usize) -> [f64; N] {
    std::array::from_fn(|i| rows[i][lane])
}

/// Marks a lane without work in `start`.
const IDLE: usize = usize::MAX;

impl<'a> LaneScheduler<'a> {
    /// A scheduler of `lanes` lanes with the chunk's first starts; `idle` is the harmless state of
    /// a pendulum in a lane without work.
    pub(super) fn new(chunk: &'a Chunk<'a>, lanes: usize, idle: [f64; NUMBERS]) -> Self {
        let count = chunk.starts.len();
        let answer = ChunkResult {
            outcomes: vec![Outcome::without_time(Status::Unflipped); count],
            states: if chunk.keep.states { chunk.starts.to_vec() } else { Vec::new() },
            ends: if chunk.keeps_ends() { vec![FinalState::NOWHERE; count] } else { Vec::new() },
            effort: Effort::default(),
        };
        let mut scheduler = LaneScheduler {
            chunk,
            rows: [[0.0; MAX_LANES]; NUMBERS],
            taken: [0; MAX_LANES],
            clearance: [FAR; MAX_LANES],
            turns: [[0.0; MAX_LANES]; 2],
            passes: [[0; 4]; MAX_LANES],
            answer,
            lanes,
            start: [IDLE; MAX_LANES],
            idle,
            next_start: 0,
            busy: 0,
        };
        (0..lanes).for_each(|lane| scheduler.put(lane, idle));
        scheduler.refill();
        scheduler
    }

    /// Returns true if any pendulum is not done.
    pub(super) fn is_busy(&self) -> bool {
        self.busy > 0
    }

    /// Returns true if whole turns are counted.
    pub(super) fn counts_turns(&self) -> bool {
        self.chunk.question.rule == Rule::Neither
    }

    /// Counts a pass by a bob of a lane's pendulum, and returns true if that was the last one.
    pub(super) fn pass(&mut self, lane: usize, bob: usize, anticlockwise: bool) -> bool {
        self.passes[lane][2 * bob + usize::from(!anticlockwise)] += 1;
        self.passes[lane].iter().sum::<u32>() >= self.chunk.question.passes
    }

    /// Returns true if the answer is no longer needed.
    pub(super) fn is_cancelled(&self) -> bool {
        self.chunk.cancelled.load(Ordering::Relaxed)
    }

    /// Gives every idle lane the next start, if there is one.
    pub(super) fn refill(&mut self) {
        for lane in 0..self.lanes {
            if self.start[lane] == IDLE && self.next_start < self.chunk.starts.len() {
                let start = &self.chunk.starts[self.next_start];
                let counts = start.counts();
                self.put(lane, start.numbers);
                (self.start[lane], self.taken[lane]) = (self.next_start, start.steps);
                self.clearance[lane] = FAR;
                self.passes[lane] = counts.passes;
                for (turns, count) in self.turns.iter_mut().zip(counts.turns) {
                    turns[lane] = f64::from(count);
                }
                self.next_start += 1;
                self.busy += 1;
            }
        }
    }

    /// Puts a state into a lane.
    pub(super) fn put(&mut self, lane: usize, numbers: [f64; NUMBERS]) {
        for (row, value) in self.rows.iter_mut().zip(numbers) {
            row[lane] = value;
        }
    }

    /// The state in a lane.
    pub(super) fn numbers(&self, lane: usize) -> [f64; NUMBERS] {
        lane_of(&self.rows, lane)
    }

    /// The lanes that run a pendulum.
    pub(super) fn running(&self) -> impl Iterator<Item = usize> + use<> {
        let start = self.start;
        (0..self.lanes).filter(move |&lane| start[lane] != IDLE)
    }

    /// Counts `steps` steps for every lane with a pendulum.
    pub(super) fn count_steps(&mut self, steps: u32) {
        let rhs = self.chunk.config.method.rhs_per_step(self.chunk.config.precision);
        for lane in self.running() {
            self.taken[lane] += steps;
            self.answer.effort.steps += u64::from(steps);
            self.answer.effort.rhs_evaluations += rhs * u64::from(steps);
        }
        self.count_lane_steps(steps);
    }

    /// Counts `steps` lane steps for every lane, busy or idle.
    pub(super) fn count_lane_steps(&mut self, steps: u32) {
        self.answer.effort.lane_steps += u64::from(steps) * self.lanes as u64;
    }

    /// The end of the pendulum in a lane, if its numbers are unit vectors and momenta.
    pub(super) fn end_of_phase(&self, lane: usize) -> FinalState {
        let numbers = self.numbers(lane);
        FinalState {
            time: numbers[TIME] + numbers[TIME_LOW],
            phase: phase_of(&numbers),
            clearance: self.clearance[lane],
            gathered: Accumulators {
                turns: self.turns.map(|turns| turns[lane] as i32),
                passes: self.passes[lane],
                ..Accumulators::NONE
            },
            ..FinalState::NOWHERE
        }
    }

    /// Records a lane's outcome and, if the job keeps them, its state and its end, which `end`
    /// computes; then makes the lane idle.
    pub(super) fn finish(
        &mut self,
        lane: usize,
        outcome: Outcome,
        end: impl FnOnce(&Self) -> FinalState,
    ) {
        let start = std::mem::replace(&mut self.start[lane], IDLE);
        self.answer.outcomes[start] = outcome;
        let end = self.chunk.keeps_ends().then(|| end(self));
        if let Some(end) = end {
            self.answer.ends[start] = end;
        }
        if self.chunk.keep.states {
            let counts = end.filter(|_| self.chunk.question.counts()).map(|end| end.gathered);
            self.answer.states[start] = IntegratorState {
                steps: self.taken[lane],
                numbers: self.numbers(lane),
                carried: counts.map(|counts| Box::new(Carried::Counts(counts))),
            };
        }
        self.put(lane, self.idle);
        self.busy -= 1;
    }
}
