//! Returns: how near a pendulum comes back to its start once it has left it.
//!
//! The distance is that of unit vectors and scaled momenta. It falls where the state moves towards
//! the start; a minimum lies in a step in which it stops falling, and is found by shorter steps from
//! the same beginning, as passes of the top are.

use std::sync::atomic::Ordering;

use super::lane_scheduler::{Chunk, ChunkResult};
use super::pair::EmbeddedPair;
use crate::engine::method::{Adaptive, Pace};
use crate::engine::start::{STEP, TIME, end_with_return, phase_of};
use crate::engine::{Carried, IntegratorState, NUMBERS};
use crate::physics::control::LONGEST;
use crate::physics::embedded::plus;
use crate::physics::phase::{Phase, distance};
use crate::physics::{Accumulators, Outcome, Pendulum, Status};

/// Number of steps between two checks for cancellation.
const PATIENCE: u32 = 4096;
/// Halvings in the search for a minimum: its time to a billionth of a step.
const HALVINGS: u32 = 30;

/// One pendulum on its way back to its start.
struct Returning<'a> {
    pendulum: &'a Pendulum<f64>,
    inverse_scale: [f64; 2],
    start: Phase<f64>,
    phase: Phase<f64>,
    time: f64,
    /// Length of the next step.
    length: f64,
    steps: u32,
    /// True once the distance has fallen for the first time: the pendulum has left its start.
    has_left: bool,
    /// Least distance since then, and its reduced time.
    nearest: [f64; 2],
}

/// Runs a chunk with adaptive steps of `P`.
pub(super) fn run<P: EmbeddedPair>(chunk: &Chunk) -> Option<ChunkResult> {
    let Pace::Adaptive(adaptive) = chunk.pace else { return None };
    let (pendulum, unit_secs) = chunk.question.reduced();
    let until = chunk.question.budget_secs / unit_secs;
    let mut result = ChunkResult::default();
    for start in chunk.starts {
        let mut returning = Returning::of(&pendulum, start);
        // Whole steps while they end within the budget, from where a larger one goes on; then
        // shorter ones to its end.
        for is_cut in [false, true] {
            let room = |now: &Returning| {
                let left = until - now.time;
                if is_cut { left > 0.0 } else { now.length <= left }
            };
            while room(&returning) && returning.steps < adaptive.most_steps {
                if returning.steps.is_multiple_of(PATIENCE)
                    && chunk.cancelled.load(Ordering::Relaxed)
                {
                    return None;
                }
                returning.step::<P>(&adaptive, until);
            }
            if !is_cut && chunk.keep.states {
                result.states.push(returning.paused());
            }
        }
        let steps = u64::from(returning.steps - start.steps);
        result.effort.steps += steps;
        result.effort.lane_steps += steps;
        let rhs = chunk.config.method.rhs_per_step(chunk.config.precision);
        result.effort.rhs_evaluations += rhs * steps;
        returning.finish(until, &mut result);
    }
    Some(result)
}

impl<'a> Returning<'a> {
    /// A pendulum at its start, or where an earlier job left it.
    fn of(pendulum: &'a Pendulum<f64>, state: &IntegratorState) -> Self {
        let phase = phase_of(&state.numbers);
        let (start, has_left, nearest) = match state.carried.as_deref() {
            Some(&Carried::Return { start, has_left, nearest }) => (start, has_left, nearest),
            _ => (phase, false, Accumulators::NONE.nearest),
        };
        Returning {
            pendulum,
            inverse_scale: pendulum.momentum_scale().map(|scale| 1.0 / scale),
            start,
            phase,
            time: state.numbers[TIME],
            length: state.numbers[STEP],
            steps: state.steps,
            has_left,
            nearest,
        }
    }

    /// The state from which a later job goes on.
    fn paused(&self) -> IntegratorState {
        let Returning { start, has_left, nearest, .. } = *self;
        let mut numbers = [0.0; NUMBERS];
        numbers[..6].copy_from_slice(&self.phase);
        (numbers[TIME], numbers[STEP]) = (self.time, self.length);
        let carried = Some(Box::new(Carried::Return { start, has_left, nearest }));
        IntegratorState { steps: self.steps, numbers, carried }
    }

    /// Tries a step, at most to `until`, and takes it if its error is allowed.
    fn step<P: EmbeddedPair>(&mut self, adaptive: &Adaptive, until: f64) {
        let control = &adaptive.control;
        let length = self.length.min(until - self.time);
        let trial = P::trial(self.pendulum, self.inverse_scale, &self.phase, length);
        let excess = trial.error_squared.max(1e-300).log2() - control.limit(self.time);
        if excess < 0.0 {
            let next = plus(&self.phase, &trial.change);
            self.look::<P>(&next, length);
            self.phase = next;
            self.time += length;
        }
        self.length = (length * control.factor(excess)).min(LONGEST);
        self.steps += 1;
    }

    /// Looks for a minimum of the distance in the step to `next`.
    fn look<P: EmbeddedPair>(&mut self, next: &Phase<f64>, length: f64) {
        let (before, after) = (self.receding(&self.phase), self.receding(next));
        self.has_left |= before > 0.0 && after < 0.0;
        if !(self.has_left && before < 0.0 && after >= 0.0) {
            return;
        }
        let (mut low, mut high) = (0.0, length);
        let at = |by: f64| {
            plus(&self.phase, &P::trial(self.pendulum, self.inverse_scale, &self.phase, by).change)
        };
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.receding(&at(middle)) < 0.0 { low = middle } else { high = middle }
        }
        let distance = self.distance(&at(high));
        if distance < self.nearest[0] {
            self.nearest = [distance, self.time + high];
        }
    }

    fn unit(&self, i: usize) -> f64 {
        if i < 4 { 1.0 } else { self.inverse_scale[i - 4] }
    }

    /// Distance of a state from the start.
    fn distance(&self, phase: &Phase<f64>) -> f64 {
        distance(phase, &self.start, self.inverse_scale)
    }

    /// Half the rate of change of the squared distance.
    fn receding(&self, phase: &Phase<f64>) -> f64 {
        let rate = self.pendulum.derivative(phase);
        (0..6).map(|i| (phase[i] - self.start[i]) * rate[i] * self.unit(i).powi(2)).sum()
    }

    fn finish(self, until: f64, result: &mut ChunkResult) {
        let whole = self.time >= until && self.phase.iter().all(|number| number.is_finite());
        let status = if whole { Status::Unflipped } else { Status::Failed };
        result.outcomes.push(Outcome::without_time(status));
        result.ends.push(end_with_return(&self.paused()));
    }
}
