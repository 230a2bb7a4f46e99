//! Nearest returns: how near a pendulum comes to its start after having left it.
//!
//! The distance is measured in unit vectors and scaled momenta. It falls while the state moves
//! towards the start. A minimum lies in a step in which the distance stops falling, and is found by
//! shorter steps from the same beginning, like a pass of the top.

use super::lane_scheduler::{Chunk, ChunkResult};
use super::one_by_one::{self, WalkProgress, Walker, dynamics, phase_in};
use crate::pace::Pace;
use crate::start::{STEP, TIME, end_with_return};
use crate::{Carried, IntegratorState, NUMBERS, Precision};
use flipmap_numbers::Scalar;
use flipmap_pendulum::embedded::EmbeddedPair;
use flipmap_pendulum::phase::{Phase, distance};
use flipmap_pendulum::{Accumulators, Pendulum};
use std::marker::PhantomData;

/// Halvings in the search for a minimum, enough to find its time to a billionth of a step.
const HALVINGS: u32 = 30;

/// One pendulum on its way back to its start, in the number type `R`, in steps of `P`.
struct Returning<'a, R, P> {
    pendulum: &'a Pendulum<R>,
    inverse_scale: [R; 2],
    start: Phase<R>,
    phase: Phase<R>,
    progress: WalkProgress,
    /// True once the distance has fallen for the first time: the pendulum has left its start.
    has_left: bool,
    /// Least distance from the start since then, and the reduced time at which it occurred.
    nearest: [f64; 2],
    pair: PhantomData<P>,
}

/// Runs a chunk in fixed steps, or in adaptive steps of `P`.
pub(super) fn run<R: Scalar, P: EmbeddedPair>(chunk: &Chunk) -> Option<ChunkResult> {
    let pendulum = dynamics::<R>(chunk);
    let begin =
        |start: &IntegratorState| Returning::<R, P>::of(&pendulum, start, chunk.config.precision);
    one_by_one::run(chunk, begin, end_with_return)
}

impl<'a, R: Scalar, P: EmbeddedPair> Returning<'a, R, P> {
    /// Creates a pendulum at its start, or where an earlier job left it.
    fn of(pendulum: &'a Pendulum<R>, state: &IntegratorState, precision: Precision) -> Self {
        let phase = phase_in(&state.numbers, precision);
        let (start, has_left, nearest) = match state.carried.as_deref() {
            // A state in double-double is never continued, so `phase` is its start with all digits.
            Some(Carried::Return { start, has_left, nearest }) if precision != Precision::Dd => {
                (start.map(R::from_f64), *has_left, *nearest)
            }
            _ => (phase, false, Accumulators::NONE.nearest),
        };
        let (time, length) = (state.numbers[TIME], state.numbers[STEP]);
        Returning {
            pendulum,
            inverse_scale: pendulum.momentum_scale().map(|scale| R::from_f64(1.0) / scale),
            start,
            phase,
            progress: WalkProgress { time, length, steps: state.steps },
            has_left,
            nearest,
            pair: PhantomData,
        }
    }

    /// The state after a step, and its squared error.
    fn after(&self, pace: &Pace, length: f64) -> (Phase<R>, R) {
        let length = R::from_f64(length);
        one_by_one::after::<R, P>(self.pendulum, self.inverse_scale, &self.phase, pace, length)
    }

    /// Looks for a minimum of the distance in the step to `next`.
    fn look(&mut self, next: &Phase<R>, pace: &Pace, length: f64) {
        let (before, after) = (self.receding(&self.phase), self.receding(next));
        self.has_left |= before > 0.0 && after < 0.0;
        if !(self.has_left && before < 0.0 && after >= 0.0) {
            return;
        }
        let (mut low, mut high) = (0.0, length);
        let at = |by: f64| self.after(pace, by).0;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.receding(&at(middle)) < 0.0 { low = middle } else { high = middle }
        }
        let distance = distance(&at(high), &self.start, self.inverse_scale).to_f64();
        if distance < self.nearest[0] {
            self.nearest = [distance, self.progress.time + high];
        }
    }

    /// Half the rate of change of the squared distance.
    fn receding(&self, phase: &Phase<R>) -> f64 {
        let rate = self.pendulum.derivative(phase);
        let unit = |i: usize| if i < 4 { R::from_f64(1.0) } else { self.inverse_scale[i - 4] };
        let part = |i: usize| (phase[i] - self.start[i]) * rate[i] * (unit(i) * unit(i));
        (0..6).fold(R::zero(), |sum, i| sum + part(i)).to_f64()
    }
}

impl<R: Scalar, P: EmbeddedPair> Walker for Returning<'_, R, P> {
    type After = Phase<R>;

    fn progress(&mut self) -> &mut WalkProgress {
        &mut self.progress
    }

    fn trial(&self, pace: &Pace, length: f64) -> (f64, Phase<R>) {
        let (next, error_squared) = self.after(pace, length);
        (error_squared.to_f64(), next)
    }

    fn take(&mut self, next: Phase<R>, pace: &Pace, length: f64) {
        self.look(&next, pace, length);
        self.phase = next;
    }

    fn paused(&mut self) -> IntegratorState {
        let Returning { has_left, nearest, .. } = *self;
        let start = self.start.map(R::to_f64);
        let mut numbers = [0.0; NUMBERS];
        numbers[..6].copy_from_slice(&self.phase.map(R::to_f64));
        (numbers[TIME], numbers[STEP]) = (self.progress.time, self.progress.length);
        let carried = Some(Box::new(Carried::Return { start, has_left, nearest }));
        IntegratorState { steps: self.progress.steps, numbers, carried }
    }

    fn is_finite(&self) -> bool {
        self.phase.iter().all(|number| Scalar::is_finite(*number))
    }
}
