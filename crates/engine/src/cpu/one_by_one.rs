//! The loop for pendulums that are followed to the end of the budget one at a time, in scalar
//! steps, with the quantities that they carry along.

use std::sync::atomic::Ordering;

use super::lane_scheduler::{Chunk, ChunkResult};
use crate::pace::Pace;
use crate::start::phase_of;
use crate::{FinalState, IntegratorState, NUMBERS, Precision};
use flipmap_numbers::{Dd, Real, Scalar};
use flipmap_pendulum::control::MAX_STEP;
use flipmap_pendulum::embedded::{EmbeddedPair, plus};
use flipmap_pendulum::phase::{Phase, rk4};
use flipmap_pendulum::{Outcome, Pendulum, Status};

/// Number of steps between two checks for cancellation.
const PATIENCE: u32 = 4096;

/// The progress of a pendulum through its budget.
#[derive(Clone, Copy, Debug)]
pub(super) struct WalkProgress {
    /// Reduced time.
    pub time: f64,
    /// Length of the next step.
    pub length: f64,
    /// Number of steps tried.
    pub steps: u32,
}

/// A pendulum that is followed to the end of the budget.
pub(super) trait Walker {
    /// Returns the progress so far.
    fn progress(&mut self) -> &mut WalkProgress;
    /// Computes a step of `length` without taking it; returns its squared error and the state after
    /// it.
    fn trial(&self, pace: &Pace, length: f64) -> (f64, Self::After);
    /// A state after a step.
    type After;
    /// Takes a step that [`Walker::trial`] computed.
    fn take(&mut self, after: Self::After, pace: &Pace, length: f64);
    /// Returns the state from which a later job continues.
    fn paused(&mut self) -> IntegratorState;
    /// Returns true if all its numbers are finite.
    fn is_finite(&self) -> bool;
}

/// Runs a chunk's starts; `end` turns the last state of each into its end.
pub(super) fn run<W: Walker>(
    chunk: &Chunk,
    begin: impl Fn(&IntegratorState) -> W,
    end: impl Fn(&IntegratorState) -> FinalState,
) -> Option<ChunkResult> {
    let (_, unit_secs) = chunk.question.reduced();
    let until = chunk.question.budget_secs / unit_secs;
    let mut result = ChunkResult::default();
    for start in chunk.starts {
        let mut walker = begin(start);
        walk(&mut walker, chunk, until, &mut result)?;
        let WalkProgress { time, steps, .. } = *walker.progress();
        let steps = u64::from(steps - start.steps);
        result.effort.steps += steps;
        result.effort.lane_steps += steps;
        let rhs = chunk.config.method.rhs_per_step(chunk.config.precision);
        result.effort.rhs_evaluations += rhs * steps;
        let whole = time >= until && walker.is_finite();
        let status = if whole { Status::Unflipped } else { Status::Failed };
        result.outcomes.push(Outcome::without_time(status));
        result.ends.push(end(&walker.paused()));
    }
    Some(result)
}

/// Takes whole steps while they end within the budget; a later job with a larger budget continues
/// from there. Then takes shorter steps to the end of the budget. Returns `None` if the job was
/// cancelled.
fn walk<W: Walker>(
    walker: &mut W,
    chunk: &Chunk,
    until: f64,
    result: &mut ChunkResult,
) -> Option<()> {
    let most_steps = chunk.pace.most_steps_to_end();
    for is_cut in [false, true] {
        loop {
            let WalkProgress { time, length, steps } = *walker.progress();
            let left = until - time;
            let has_room = if is_cut { left > 0.0 } else { length <= left };
            if !has_room || steps >= most_steps {
                break;
            }
            if steps.is_multiple_of(PATIENCE) && chunk.cancelled.load(Ordering::Relaxed) {
                return None;
            }
            step(walker, &chunk.pace, until);
        }
        if !is_cut && chunk.keep.states {
            result.states.push(walker.paused());
        }
    }
    Some(())
}

/// Tries a step, at most to `until`, and takes it if its error is allowed.
fn step<W: Walker>(walker: &mut W, pace: &Pace, until: f64) {
    let WalkProgress { time, length, .. } = *walker.progress();
    let left = until - time;
    let by = length.min(left);
    let (error_squared, after) = walker.trial(pace, by);
    let mut is_allowed = true;
    if let Pace::Adaptive(adaptive) = pace {
        let control = &adaptive.control;
        let excess = error_squared.max(1e-300).log2() - control.limit(time);
        is_allowed = excess < 0.0;
        walker.progress().length = (by * control.factor(excess)).min(MAX_STEP);
    }
    if is_allowed {
        walker.take(after, pace, by);
        walker.progress().time = if length > left { until } else { time + by };
    }
    walker.progress().steps += 1;
}

/// The chunk's pendulum in reduced units.
pub(super) fn dynamics<R: Scalar>(chunk: &Chunk) -> Pendulum<R> {
    if chunk.config.precision == Precision::Dd {
        return chunk.question.reduced_in::<Dd>().0.map(|Dd { hi, lo }| from_parts(hi, lo));
    }
    chunk.question.reduced().0.map(R::from_f64)
}

/// The unit vectors and momenta of a state.
pub(super) fn phase_in<R: Scalar>(numbers: &[f64; NUMBERS], precision: Precision) -> Phase<R> {
    if precision == Precision::Dd {
        return std::array::from_fn(|i| from_parts(numbers[i], numbers[6 + i]));
    }
    phase_of(numbers).map(R::from_f64)
}

fn from_parts<R: Scalar>(high: f64, low: f64) -> R {
    R::from_f64(high) + R::from_f64(low)
}

/// The state after a step of the pace's method, and its squared error, which is 0 for fixed steps.
pub(super) fn after<T: Real, P: EmbeddedPair>(
    pendulum: &Pendulum<T>,
    inverse_scale: [T; 2],
    phase: &Phase<T>,
    pace: &Pace,
    length: T,
) -> (Phase<T>, T) {
    if let Pace::Fixed(_) = pace {
        return (rk4(pendulum, phase, length), length.lit(0.0));
    }
    let trial = P::trial(pendulum, inverse_scale, phase, length);
    (plus(phase, &trial.change), trial.error_squared)
}
