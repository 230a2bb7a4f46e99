//! Returns: how near a pendulum comes back to its start once it has left it.
//!
//! The distance is that of unit vectors and scaled momenta. It falls where the state moves towards
//! the start; a minimum lies in a step in which it stops falling, and is found by shorter steps from
//! the same beginning, as passes of the top are.

use std::sync::atomic::Ordering;

use super::lane_scheduler::{Chunk, ChunkResult};
use super::pair::EmbeddedPair;
use crate::engine::method::Pace;
use crate::engine::start::{STEP, TIME, end_with_return, phase_of};
use crate::engine::{Carried, IntegratorState, NUMBERS};
use crate::physics::control::LONGEST;
use crate::physics::embedded::plus;
use crate::physics::phase::{Phase, distance, rk4};
use crate::physics::{Accumulators, Outcome, Pendulum, Scalar, Status};

/// Number of steps between two checks for cancellation.
const PATIENCE: u32 = 4096;
/// Halvings in the search for a minimum: its time to a billionth of a step.
const HALVINGS: u32 = 30;

/// One pendulum on its way back to its start, in the number type `R`.
struct Returning<'a, R> {
    pendulum: &'a Pendulum<R>,
    pace: Pace,
    inverse_scale: [R; 2],
    start: Phase<R>,
    phase: Phase<R>,
    time: f64,
    /// Length of the next step.
    length: f64,
    steps: u32,
    /// True once the distance has fallen for the first time: the pendulum has left its start.
    has_left: bool,
    /// Least distance since then, and its reduced time.
    nearest: [f64; 2],
}

/// Runs a chunk in fixed steps or adaptive ones of `P`.
pub(super) fn run<R: Scalar, P: EmbeddedPair>(chunk: &Chunk) -> Option<ChunkResult> {
    let (pendulum, unit_secs) = chunk.question.reduced();
    let pendulum = pendulum.map(R::from_f64);
    let until = chunk.question.budget_secs / unit_secs;
    let most_steps = chunk.pace.most_steps_to_end();
    let mut result = ChunkResult::default();
    for start in chunk.starts {
        let mut returning = Returning::of(&pendulum, chunk.pace, start);
        // Whole steps while they end within the budget, from where a larger one goes on; then
        // shorter ones to its end.
        for is_cut in [false, true] {
            let room = |now: &Returning<R>| {
                let left = until - now.time;
                if is_cut { left > 0.0 } else { now.length <= left }
            };
            while room(&returning) && returning.steps < most_steps {
                if returning.steps.is_multiple_of(PATIENCE)
                    && chunk.cancelled.load(Ordering::Relaxed)
                {
                    return None;
                }
                returning.step::<P>(until);
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

impl<'a, R: Scalar> Returning<'a, R> {
    /// A pendulum at its start, or where an earlier job left it.
    fn of(pendulum: &'a Pendulum<R>, pace: Pace, state: &IntegratorState) -> Self {
        let phase = phase_of(&state.numbers);
        let (start, has_left, nearest) = match state.carried.as_deref() {
            Some(&Carried::Return { start, has_left, nearest }) => (start, has_left, nearest),
            _ => (phase, false, Accumulators::NONE.nearest),
        };
        Returning {
            pendulum,
            pace,
            inverse_scale: pendulum.momentum_scale().map(|scale| R::from_f64(1.0) / scale),
            start: start.map(R::from_f64),
            phase: phase.map(R::from_f64),
            time: state.numbers[TIME],
            length: state.numbers[STEP],
            steps: state.steps,
            has_left,
            nearest,
        }
    }

    /// The state from which a later job goes on.
    fn paused(&self) -> IntegratorState {
        let Returning { has_left, nearest, .. } = *self;
        let start = self.start.map(R::to_f64);
        let mut numbers = [0.0; NUMBERS];
        numbers[..6].copy_from_slice(&self.phase.map(R::to_f64));
        (numbers[TIME], numbers[STEP]) = (self.time, self.length);
        let carried = Some(Box::new(Carried::Return { start, has_left, nearest }));
        IntegratorState { steps: self.steps, numbers, carried }
    }

    /// Tries a step, at most to `until`, and takes it if its error is allowed.
    fn step<P: EmbeddedPair>(&mut self, until: f64) {
        let left = until - self.time;
        let is_last = self.length > left;
        let length = R::from_f64(self.length.min(left));
        let (next, error_squared) = self.after::<P>(length);
        let by = length.to_f64();
        let mut is_allowed = true;
        if let Pace::Adaptive(adaptive) = &self.pace {
            let control = &adaptive.control;
            let excess = error_squared.to_f64().max(1e-300).log2() - control.limit(self.time);
            is_allowed = excess < 0.0;
            self.length = (by * control.factor(excess)).min(LONGEST);
        }
        if is_allowed {
            self.look::<P>(&next, by);
            self.phase = next;
            self.time = if is_last { until } else { self.time + by };
        }
        self.steps += 1;
    }

    /// The state after a step, and the square of its error, which is 0 for fixed steps.
    fn after<P: EmbeddedPair>(&self, length: R) -> (Phase<R>, R) {
        if let Pace::Fixed(_) = self.pace {
            return (rk4(self.pendulum, &self.phase, length), R::zero());
        }
        let trial = P::trial(self.pendulum, self.inverse_scale, &self.phase, length);
        (plus(&self.phase, &trial.change), trial.error_squared)
    }

    /// Looks for a minimum of the distance in the step to `next`.
    fn look<P: EmbeddedPair>(&mut self, next: &Phase<R>, length: f64) {
        let (before, after) = (self.receding(&self.phase), self.receding(next));
        self.has_left |= before > 0.0 && after < 0.0;
        if !(self.has_left && before < 0.0 && after >= 0.0) {
            return;
        }
        let (mut low, mut high) = (0.0, length);
        let at = |by: f64| self.after::<P>(R::from_f64(by)).0;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.receding(&at(middle)) < 0.0 { low = middle } else { high = middle }
        }
        let distance = distance(&at(high), &self.start, self.inverse_scale).to_f64();
        if distance < self.nearest[0] {
            self.nearest = [distance, self.time + high];
        }
    }

    /// Half the rate of change of the squared distance.
    fn receding(&self, phase: &Phase<R>) -> f64 {
        let rate = self.pendulum.derivative(phase);
        let unit = |i: usize| if i < 4 { R::from_f64(1.0) } else { self.inverse_scale[i - 4] };
        let part = |i: usize| (phase[i] - self.start[i]) * rate[i] * (unit(i) * unit(i));
        (0..6).fold(R::zero(), |sum, i| sum + part(i)).to_f64()
    }

    fn finish(self, until: f64, result: &mut ChunkResult) {
        let whole =
            self.time >= until && self.phase.iter().all(|number| Scalar::is_finite(*number));
        let status = if whole { Status::Unflipped } else { Status::Failed };
        result.outcomes.push(Outcome::without_time(status));
        result.ends.push(end_with_return(&self.paused()));
    }
}
