//! Growth in scalar Taylor steps: a pendulum with its tangents, in f64 or double-double.

use super::lane_scheduler::{Chunk, ChunkResult};
use super::one_by_one::{self, WalkProgress, Walker, dynamics, phase_in};
use crate::pace::Pace;
use crate::start::{STEP, TIME, end_with_growth};
use crate::{Carried, FinalState, IntegratorState, NUMBERS, Precision};
use flipmap_numbers::Scalar;
use flipmap_numbers::dual::Dual;
use flipmap_pendulum::Pendulum;
use flipmap_pendulum::embedded::EmbeddedPair;
use flipmap_pendulum::tangents::{LARGE, Tangents};
use std::marker::PhantomData;

/// One pendulum with its tangents, in the number type `R`, in steps of `P`.
struct Growing<'a, R, P> {
    pendulum: &'a Pendulum<Dual<4, R>>,
    inverse_scale: [Dual<4, R>; 2],
    state: Tangents<R>,
    /// Natural logarithm of the factor by which the slopes were scaled down.
    log_scale: f64,
    progress: WalkProgress,
    pair: PhantomData<P>,
}

/// Runs a chunk in steps of `P`.
pub(super) fn run<R: Scalar, P: EmbeddedPair>(chunk: &Chunk) -> Option<ChunkResult> {
    let plain = dynamics::<R>(chunk);
    let scale = plain.momentum_scale().map(|scale| Dual::new(R::from_f64(1.0) / scale));
    let (pendulum, (reduced, _)) = (plain.map(Dual::new), chunk.question.reduced());
    let begin = |start: &IntegratorState| {
        Growing::<R, P>::of(&pendulum, scale, start, chunk.config.precision)
    };
    let end = |left: &IntegratorState| -> FinalState { end_with_growth(&reduced, left) };
    one_by_one::run(chunk, begin, end)
}

impl<'a, R: Scalar, P: EmbeddedPair> Growing<'a, R, P> {
    /// Creates a pendulum with its tangents, at its start or where an earlier job left it.
    fn of(
        pendulum: &'a Pendulum<Dual<4, R>>,
        inverse_scale: [Dual<4, R>; 2],
        state: &IntegratorState,
        precision: Precision,
    ) -> Self {
        let phase = phase_in::<R>(&state.numbers, precision);
        let slopes = state.slopes();
        let (time, length) = (state.numbers[TIME], state.numbers[STEP]);
        Growing {
            pendulum,
            inverse_scale,
            state: std::array::from_fn(|i| Dual {
                value: phase[i],
                slope: slopes[i].map(R::from_f64),
            }),
            log_scale: state.log_scale(),
            progress: WalkProgress { time, length, steps: state.steps },
            pair: PhantomData,
        }
    }
}

impl<R: Scalar, P: EmbeddedPair> Walker for Growing<'_, R, P> {
    type After = Tangents<R>;

    fn progress(&mut self) -> &mut WalkProgress {
        &mut self.progress
    }

    fn trial(&self, pace: &Pace, length: f64) -> (f64, Tangents<R>) {
        let length = Dual::new(R::from_f64(length));
        let (next, error_squared) = one_by_one::after::<Dual<4, R>, P>(
            self.pendulum,
            self.inverse_scale,
            &self.state,
            pace,
            length,
        );
        (error_squared.value.to_f64(), next)
    }

    fn take(&mut self, next: Tangents<R>, _: &Pace, _: f64) {
        self.state = next;
        let sizes = self.state.iter().flat_map(|number| number.slope);
        let largest = sizes.fold(0.0, |most: f64, slope| most.max(slope.to_f64().abs()));
        if largest > LARGE {
            for number in &mut self.state {
                number.slope = number.slope.map(|slope| slope * R::from_f64(1.0 / LARGE));
            }
            self.log_scale += LARGE.ln();
        }
    }

    fn paused(&mut self) -> IntegratorState {
        let mut numbers = [0.0; NUMBERS];
        for (number, state) in numbers.iter_mut().zip(&self.state) {
            *number = state.value.to_f64();
        }
        (numbers[TIME], numbers[STEP]) = (self.progress.time, self.progress.length);
        let slopes = self.state.map(|number| number.slope.map(R::to_f64));
        let carried = Some(Box::new(Carried::Tangents { slopes, log_scale: self.log_scale }));
        IntegratorState { steps: self.progress.steps, numbers, carried }
    }

    fn is_finite(&self) -> bool {
        let number = |number: &Dual<4, R>| {
            Scalar::is_finite(number.value) && number.slope.iter().all(|x| Scalar::is_finite(*x))
        };
        self.state.iter().all(number)
    }
}
