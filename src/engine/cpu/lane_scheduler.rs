//! The lanes' bookkeeping: which pendulum is in which lane, and the next one for a lane whose
//! pendulum is done, so that no lane idles while there is work.

use std::sync::atomic::{AtomicBool, Ordering};

use super::lanes::MOST_LANES;
use crate::engine::method::Pace;
use crate::engine::start::{TIME, TIME_LOW, phase_of};
use crate::engine::{Effort, End, IntegratorConfig, IntegratorState, NUMBERS, Question};
use crate::physics::crossing::FAR;
use crate::physics::{Outcome, Status};

/// What one chunk of a job needs.
pub struct Chunk<'a> {
    /// What is asked.
    pub question: &'a Question,
    /// How it is computed.
    pub config: IntegratorConfig,
    /// Its steps over the budget.
    pub pace: Pace,
    /// Where each pendulum begins, in reduced units.
    pub starts: &'a [IntegratorState],
    /// Set when nobody wants the answer any more.
    pub cancelled: &'a AtomicBool,
}

/// What became of a chunk: per start its outcome and last state, and the work done.
#[derive(Default)]
pub struct ChunkResult {
    /// In the order of the starts.
    pub outcomes: Vec<Outcome>,
    /// Likewise; of flipped ones the state at the beginning of the step in which they did.
    pub states: Vec<IntegratorState>,
    /// Likewise, where each ended.
    pub ends: Vec<End>,
    /// What it took.
    pub effort: Effort,
}

/// Steps between two looks at whether the work is still wanted.
pub const PATIENCE: u32 = 512;

/// The lanes between stretches of steps.
pub struct LaneScheduler<'a> {
    /// What is done.
    pub chunk: &'a Chunk<'a>,
    /// Each number of the state, lane by lane.
    pub rows: [[f64; MOST_LANES]; NUMBERS],
    /// Steps each lane's pendulum has taken.
    pub taken: [u32; MOST_LANES],
    /// How far from the top the watched bobs of each lane's pendulum have stayed.
    pub clearance: [f64; MOST_LANES],
    /// What became of those that are done.
    pub answer: ChunkResult,
    lanes: usize,
    /// Which start each lane runs.
    start: [usize; MOST_LANES],
    idle: [f64; NUMBERS],
    next_start: usize,
    busy: usize,
}

const IDLE: usize = usize::MAX;

impl<'a> LaneScheduler<'a> {
    /// A scheduler of `lanes` lanes with the chunk's first starts; `idle` is the state of a pendulum
    /// that harms nobody in a lane without work.
    pub fn new(chunk: &'a Chunk<'a>, lanes: usize, idle: [f64; NUMBERS]) -> Self {
        let answer = ChunkResult {
            outcomes: vec![Outcome::without_time(Status::Unflipped); chunk.starts.len()],
            states: chunk.starts.to_vec(),
            ends: vec![End::NOWHERE; chunk.starts.len()],
            effort: Effort::default(),
        };
        let mut scheduler = LaneScheduler {
            chunk,
            rows: [[0.0; MOST_LANES]; NUMBERS],
            taken: [0; MOST_LANES],
            clearance: [FAR; MOST_LANES],
            answer,
            lanes,
            start: [IDLE; MOST_LANES],
            idle,
            next_start: 0,
            busy: 0,
        };
        (0..lanes).for_each(|lane| scheduler.put(lane, idle));
        scheduler.refill();
        scheduler
    }

    /// Whether any pendulum is not done.
    pub fn is_busy(&self) -> bool {
        self.busy > 0
    }

    /// Whether nobody wants the answer.
    pub fn is_cancelled(&self) -> bool {
        self.chunk.cancelled.load(Ordering::Relaxed)
    }

    /// Gives every idle lane the next start, if there is one.
    pub fn refill(&mut self) {
        for lane in 0..self.lanes {
            if self.start[lane] == IDLE && self.next_start < self.chunk.starts.len() {
                let start = self.chunk.starts[self.next_start];
                self.put(lane, start.numbers);
                (self.start[lane], self.taken[lane]) = (self.next_start, start.steps);
                self.clearance[lane] = FAR;
                self.next_start += 1;
                self.busy += 1;
            }
        }
    }

    /// Puts a state into a lane.
    pub fn put(&mut self, lane: usize, numbers: [f64; NUMBERS]) {
        for (row, value) in self.rows.iter_mut().zip(numbers) {
            row[lane] = value;
        }
    }

    /// The state in a lane.
    pub fn numbers(&self, lane: usize) -> [f64; NUMBERS] {
        self.rows.map(|row| row[lane])
    }

    /// The lanes that run a pendulum.
    pub fn running(&self) -> impl Iterator<Item = usize> + use<> {
        let start = self.start;
        (0..self.lanes).filter(move |&lane| start[lane] != IDLE)
    }

    /// Counts `steps` steps of every lane with a pendulum.
    pub fn count_steps(&mut self, steps: u32) {
        let rhs = self.chunk.config.method.rhs_per_step(self.chunk.config.precision);
        for lane in self.running() {
            self.taken[lane] += steps;
            self.answer.effort.steps += u64::from(steps);
            self.answer.effort.rhs_evaluations += rhs * u64::from(steps);
        }
        self.answer.effort.lane_steps += u64::from(steps) * self.lanes as u64;
    }

    /// Where the pendulum in a lane is, if its numbers are unit vectors and momenta.
    pub fn end_of_phase(&self, lane: usize) -> End {
        let numbers = self.numbers(lane);
        End {
            time: numbers[TIME] + numbers[TIME_LOW],
            phase: phase_of(&numbers),
            clearance: self.clearance[lane],
            ..End::NOWHERE
        }
    }

    /// Keeps a lane's outcome, state and end, and leaves the lane idle.
    pub fn finish(&mut self, lane: usize, outcome: Outcome, end: End) {
        let start = std::mem::replace(&mut self.start[lane], IDLE);
        self.answer.outcomes[start] = outcome;
        self.answer.ends[start] = end;
        self.answer.states[start] =
            IntegratorState { steps: self.taken[lane], numbers: self.numbers(lane) };
        self.put(lane, self.idle);
        self.busy -= 1;
    }
}
