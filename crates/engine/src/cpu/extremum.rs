//! Extremes along a motion: the nearest return to the start, and others of
//! [`flipmap_pendulum::extremum`].

use super::lane_scheduler::{Chunk, ChunkResult};
use super::one_by_one::{self, WalkProgress, Walker, dynamics, phase_in};
use crate::pace::Pace;
use crate::start::{STEP, TIME, end_with_extremum};
use crate::{Carried, IntegratorState, NUMBERS, Precision};
use flipmap_numbers::Scalar;
use flipmap_pendulum::Pendulum;
use flipmap_pendulum::embedded::EmbeddedPair;
use flipmap_pendulum::extremum::{Extremum, Measure};
use flipmap_pendulum::phase::Phase;
use std::marker::PhantomData;

/// Halvings in the search for an extreme, enough to find its time to a billionth of a step.
const HALVINGS: u32 = 30;

/// One pendulum whose extreme is looked for, in the number type `R`, in steps of `P`.
struct Seeking<R, P> {
    measure: Measure<R>,
    phase: Phase<R>,
    /// The rate of the measure there.
    rate: f64,
    progress: WalkProgress,
    /// True once an extreme counts.
    counts: bool,
    /// The extreme so far, and the reduced time at which it occurred.
    best: [f64; 2],
    pair: PhantomData<P>,
}

/// Runs a chunk in fixed steps, or in adaptive steps of `P`.
pub(super) fn run<R: Scalar, P: EmbeddedPair>(
    chunk: &Chunk,
    extremum: Extremum,
) -> Option<ChunkResult> {
    let pendulum = dynamics::<R>(chunk);
    let begin = |start: &IntegratorState| {
        Seeking::<R, P>::of(extremum, &pendulum, start, chunk.config.precision)
    };
    one_by_one::run(chunk, begin, end_with_extremum)
}

impl<R: Scalar, P: EmbeddedPair> Seeking<R, P> {
    /// Creates a pendulum at its start, or where an earlier job left it.
    fn of(
        extremum: Extremum,
        pendulum: &Pendulum<R>,
        state: &IntegratorState,
        precision: Precision,
    ) -> Self {
        let phase = phase_in(&state.numbers, precision);
        let Some(&Carried::Extremum { start, counts, best }) = state.carried.as_deref() else {
            unreachable!("every start of the job carries its search")
        };
        // A state in double-double is never continued, so `phase` is its start with all digits.
        let is_start = precision == Precision::Dd;
        let start = if is_start { phase } else { start.map(R::from_f64) };
        let measure = Measure::new(extremum, *pendulum, start);
        let (time, length) = (state.numbers[TIME], state.numbers[STEP]);
        Seeking {
            rate: measure.rate(&phase).to_f64(),
            measure,
            phase,
            progress: WalkProgress { time, length, steps: state.steps },
            counts,
            best,
            pair: PhantomData,
        }
    }

    /// The state after a step, and its squared error.
    fn after(&self, pace: &Pace, length: f64) -> (Phase<R>, R) {
        let Measure { pendulum, inverse_scale, .. } = &self.measure;
        let length = R::from_f64(length);
        one_by_one::after::<R, P>(pendulum, *inverse_scale, &self.phase, pace, length)
    }

    /// Looks for an extreme in the step to `next`.
    fn look(&mut self, next: &Phase<R>, pace: &Pace, length: f64) {
        let rate = |phase: &Phase<R>| self.measure.rate(phase).to_f64();
        let (before, after) = (self.rate, rate(next));
        self.rate = after;
        self.counts |= before > 0.0 && after < 0.0;
        if !(self.counts && before < 0.0 && after >= 0.0) {
            return;
        }
        let (mut low, mut high) = (0.0, length);
        let at = |by: f64| self.after(pace, by).0;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if rate(&at(middle)) < 0.0 { low = middle } else { high = middle }
        }
        let value = self.measure.value(&at(high)).to_f64();
        if self.measure.extremum.is_beyond(value, self.best[0]) {
            self.best = [value, self.progress.time + high];
        }
    }
}

impl<R: Scalar, P: EmbeddedPair> Walker for Seeking<R, P> {
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
        let Seeking { counts, best, .. } = *self;
        let start = self.measure.start.map(R::to_f64);
        let mut numbers = [0.0; NUMBERS];
        numbers[..6].copy_from_slice(&self.phase.map(R::to_f64));
        (numbers[TIME], numbers[STEP]) = (self.progress.time, self.progress.length);
        let carried = Some(Box::new(Carried::Extremum { start, counts, best }));
        IntegratorState { steps: self.progress.steps, numbers, carried }
    }

    fn is_finite(&self) -> bool {
        self.phase.iter().all(|number| Scalar::is_finite(*number))
    }
}
