//! Growth: pendulums with the tangents of their motion, a register at a time. All of them last as
//! long as the budget, so no lane is refilled.

use super::lane_scheduler::{Chunk, ChunkResult, PATIENCE};
use super::lanes::{Lanes, MOST_LANES};
use super::pair::EmbeddedPair;
use super::step_control;
use crate::engine::method::{Adaptive, Pace, Steps};
use crate::engine::start::phase_at;
use crate::engine::{End, IntegratorState, NUMBERS};
use crate::physics::control::{FIRST, LONGEST};
use crate::physics::dual::Dual;
use crate::physics::embedded::plus;
use crate::physics::phase::Phase;
use crate::physics::tangents::{Tangents, log_growth, released};
use crate::physics::{Accumulators, Outcome, Pendulum, Real, Status};

/// Largest slope before all are made smaller by [`SMALLER`], so that none overflows in f32 within a
/// stretch of steps.
const LARGE: f64 = 1e12;
const SMALLER: f64 = 1e-12;

/// Pendulums in the lanes of a register with their tangents.
struct TangentLanes<L> {
    pendulum: Pendulum<Dual<4, L>>,
    inverse_scale: [Dual<4, L>; 2],
    state: Tangents<L>,
    time: L,
    time_low: L,
    step: L,
    /// Reduced time at which they end.
    end: L,
}

/// Runs a chunk in lanes of `L`, with adaptive steps of `P`.
#[inline(always)]
pub(super) fn run<L: Lanes, P: EmbeddedPair>(set: L::Set, chunk: &Chunk) -> Option<ChunkResult> {
    let (reduced, unit_secs) = chunk.question.reduced();
    let end = chunk.question.budget_secs / unit_secs;
    let mut result = ChunkResult::default();
    for starts in chunk.starts.chunks(L::COUNT) {
        let mut lanes = TangentLanes::<L>::of(set, &reduced, starts, chunk, end);
        let mut logs = [0.0; MOST_LANES];
        let mut steps = 0;
        while lanes.is_busy() {
            if chunk.cancelled.load(std::sync::atomic::Ordering::Relaxed) {
                return None;
            }
            for _ in 0..PATIENCE / 16 {
                match chunk.pace {
                    Pace::Adaptive(adaptive) => lanes.step_adaptively::<P>(&adaptive),
                    Pace::Fixed(fixed) => lanes.step_fixed(&fixed),
                }
            }
            steps += PATIENCE / 16;
            lanes.keep_small(set, &mut logs);
            if steps >= most_steps(&chunk.pace) {
                break;
            }
        }
        let rhs = chunk.config.method.rhs_per_step(chunk.config.precision);
        result.effort.steps += u64::from(steps) * starts.len() as u64;
        result.effort.lane_steps += u64::from(steps) * L::COUNT as u64;
        result.effort.rhs_evaluations += rhs * u64::from(steps) * starts.len() as u64;
        lanes.finish(&reduced, &logs, starts.len(), &mut result);
    }
    Some(result)
}

fn most_steps(pace: &Pace) -> u32 {
    match pace {
        Pace::Adaptive(adaptive) => adaptive.most_steps,
        // The last step is short, and some of the last stretch are empty.
        Pace::Fixed(steps) => steps.count + PATIENCE,
    }
}

impl<L: Lanes> TangentLanes<L> {
    #[inline(always)]
    fn of(
        set: L::Set,
        reduced: &Pendulum<f64>,
        starts: &[IntegratorState],
        chunk: &Chunk,
        end: f64,
    ) -> Self {
        // Lanes without a start repeat the last one.
        let phases: [Phase<f64>; MOST_LANES] = std::array::from_fn(|lane| {
            phase_at(reduced, &chunk.pace, &starts[lane.min(starts.len() - 1)].numbers)
        });
        let row = |i: usize| <L as Lanes>::load(set, &phases.map(|phase| phase[i]));
        let phase = [row(0), row(1), row(2), row(3), row(4), row(5)];
        let splat = |value: f64| L::splat(set, value);
        let pendulum = reduced.map(splat);
        let scale = reduced.momentum_scale().map(|scale| Dual::new(splat(1.0 / scale)));
        TangentLanes {
            state: released(&pendulum, &phase),
            pendulum: pendulum.map(Dual::new),
            inverse_scale: scale,
            time: splat(0.0),
            time_low: splat(0.0),
            step: splat(FIRST),
            end: splat(end),
        }
    }

    #[inline(always)]
    fn is_busy(&self) -> bool {
        self.left().largest() > 0.0
    }

    /// Time that is left, not positive where a pendulum is done.
    #[inline(always)]
    fn left(&self) -> L {
        (self.end - self.time) - self.time_low
    }

    /// Time that is left, at most `step`.
    #[inline(always)]
    fn length(&self, step: L) -> L {
        step.min(self.left()).max(step.lit(0.0))
    }

    /// Tries a step in every lane and takes it where its error is allowed.
    #[inline(always)]
    fn step_adaptively<P: EmbeddedPair>(&mut self, adaptive: &Adaptive) {
        let control = &adaptive.control;
        let length = self.length(self.step);
        let trial = P::trial(&self.pendulum, self.inverse_scale, &self.state, Dual::new(length));
        let excess = step_control::excess(control, self.time, trial.error_squared.value);
        let factor = step_control::factor(control, excess);
        self.take(&plus(&self.state, &trial.change), length, excess);
        self.step = (self.step * factor).min(length.lit(LONGEST));
    }

    /// Takes a step of the classical Runge–Kutta method.
    #[inline(always)]
    fn step_fixed(&mut self, steps: &Steps) {
        let length = self.length(self.time.lit(steps.length));
        let dual = Dual::new(length);
        let half = Dual::new(length * length.lit(0.5));
        let from = |slope: &Tangents<L>, by: Dual<4, L>| -> Tangents<L> {
            std::array::from_fn(|i| self.state[i] + slope[i] * by)
        };
        let k1 = self.pendulum.derivative(&self.state);
        let k2 = self.pendulum.derivative(&from(&k1, half));
        let k3 = self.pendulum.derivative(&from(&k2, half));
        let k4 = self.pendulum.derivative(&from(&k3, dual));
        let (two, sixth) = (dual.lit(2.0), dual * dual.lit(1.0 / 6.0));
        let next = std::array::from_fn(|i| {
            self.state[i] + (k1[i] + two * (k2[i] + k3[i]) + k4[i]) * sixth
        });
        self.take(&next, length, length.lit(-1.0));
    }

    /// Moves to the next state in lanes where `test` is negative.
    #[inline(always)]
    fn take(&mut self, next: &Tangents<L>, length: L, test: L) {
        for (number, next) in self.state.iter_mut().zip(next) {
            number.value = Lanes::select(next.value, test, number.value);
            for (slope, next) in number.slope.iter_mut().zip(next.slope) {
                *slope = Lanes::select(next, test, *slope);
            }
        }
        let (time, low) = self.time.fast_two_sum(self.time_low + length);
        self.time = Lanes::select(time, test, self.time);
        self.time_low = Lanes::select(low, test, self.time_low);
    }

    /// Makes the slopes of a lane smaller where they have grown large, and notes it in `logs`.
    #[inline(always)]
    fn keep_small(&mut self, set: L::Set, logs: &mut [f64; MOST_LANES]) {
        let mut most = self.time.lit(0.0);
        for slope in self.state.iter().flat_map(|number| number.slope) {
            most = most.max(slope.abs());
        }
        let mut largest = [0.0; MOST_LANES];
        Lanes::store(most, &mut largest);
        let factor = largest.map(|largest| if largest > LARGE { SMALLER } else { 1.0 });
        for (log, factor) in logs.iter_mut().zip(factor) {
            *log -= factor.ln();
        }
        let factor = <L as Lanes>::load(set, &factor);
        for number in &mut self.state {
            number.slope = number.slope.map(|slope| slope * factor);
        }
    }

    /// Adds the results of the first `count` lanes.
    #[inline(always)]
    fn finish(
        &self,
        reduced: &Pendulum<f64>,
        logs: &[f64; MOST_LANES],
        count: usize,
        result: &mut ChunkResult,
    ) {
        let row = |lanes: L| {
            let mut row = [0.0; MOST_LANES];
            Lanes::store(lanes, &mut row);
            row
        };
        let rows = self.state.map(|number| (row(number.value), number.slope.map(row)));
        let times = row(self.time);
        let ends = row(self.end);
        for lane in 0..count {
            let state: Tangents<f64> = std::array::from_fn(|i| Dual {
                value: rows[i].0[lane],
                slope: rows[i].1.map(|slope| slope[lane]),
            });
            let log_growth = log_growth(reduced, &state) + logs[lane];
            let whole = log_growth.is_finite() && times[lane] >= ends[lane] * (1.0 - 1e-6);
            let status = if whole { Status::Unflipped } else { Status::Failed };
            let phase = state.map(|number| number.value);
            let gathered = Accumulators { log_growth, ..Accumulators::NONE };
            let end = End { time: times[lane], phase, gathered, ..End::NOWHERE };
            result.outcomes.push(Outcome::without_time(status));
            result.states.push(IntegratorState { steps: 0, numbers: [0.0; NUMBERS] });
            result.ends.push(end);
        }
    }
}
