//! Growth: pendulums with the tangents of their motion, a register at a time. All of them run to
//! the end of the budget, so no lane is refilled.

use std::marker::PhantomData;

use super::lane_scheduler::{Chunk, ChunkResult};
use super::lanes::{Lanes, MAX_LANES};
use super::number::Number;
use super::step_control;
use super::stretch::{Stretch, vectorized};
use crate::pace::{Adaptive, Pace};
use crate::start::{STEP, TIME, TIME_LOW, end_with_growth};
use crate::{Carried, IntegratorState, NUMBERS};
use flipmap_numbers::dual::{Dual, Narrow};
use flipmap_numbers::{Dd, Real};
use flipmap_pendulum::control::MAX_STEP;
use flipmap_pendulum::embedded::{EmbeddedPair, plus};
use flipmap_pendulum::phase::rk4;
use flipmap_pendulum::tangents::{LARGE, Tangents};
use flipmap_pendulum::{Outcome, Pendulum, Status};

/// Pendulums and their tangents in the lanes of a register.
struct TangentLanes<N: Number> {
    pendulum: Pendulum<Dual<4, N, N::Leading>>,
    inverse_scale: [Dual<4, N, N::Leading>; 2],
    state: Tangents<N, N::Leading>,
    time: N::Leading,
    time_low: N::Leading,
    step: N::Leading,
    /// Reduced time at which the budget ends.
    end: N::Leading,
    /// False while only whole steps within the budget are taken, so that a job with a larger budget
    /// can continue after them; true once steps are cut to the end of the budget.
    cuts: bool,
}

/// Runs a chunk in lanes of `N`, with adaptive steps of `P`. Slopes have the digits of the leading
/// part.
#[inline(never)]
pub(super) fn run<N: Number + Narrow<N::Leading>, P: EmbeddedPair>(
    set: <N::Leading as Lanes>::Set,
    chunk: &Chunk,
) -> Option<ChunkResult> {
    vectorized::<N::Leading, _>(set, TangentRun::<N, P> { chunk, kernel: PhantomData })
}

struct TangentRun<'a, N, P> {
    chunk: &'a Chunk<'a>,
    kernel: PhantomData<(N, P)>,
}

impl<N: Number + Narrow<N::Leading>, P: EmbeddedPair> Stretch<N::Leading> for TangentRun<'_, N, P> {
    type Output = Option<ChunkResult>;

    #[inline(always)]
    fn run(self, set: <N::Leading as Lanes>::Set) -> Option<ChunkResult> {
        let chunk = self.chunk;
        let count = <N::Leading as Lanes>::COUNT;
        let (reduced, unit_secs) = chunk.question.reduced();
        let exact = chunk.question.reduced_in::<Dd>().0;
        let end = chunk.question.budget_secs / unit_secs;
        let mut result = ChunkResult::default();
        for starts in chunk.starts.chunks(count) {
            let mut lanes = TangentLanes::<N>::of(set, &exact, starts, end);
            let mut logs = [0.0; MAX_LANES];
            for (log, start) in logs.iter_mut().zip(starts) {
                *log = start.log_scale();
            }
            let mut steps = 0;
            for cuts in [false, true] {
                lanes.cuts = cuts;
                while lanes.is_busy() && steps < chunk.pace.most_steps_to_end() {
                    match chunk.pace {
                        Pace::Adaptive(adaptive) => lanes.step_adaptively::<P>(&adaptive),
                        Pace::Fixed(_) => lanes.step_fixed(),
                    }
                    steps += 1;
                    if steps % STRETCH == 0 {
                        if chunk.cancelled.load(std::sync::atomic::Ordering::Relaxed) {
                            return None;
                        }
                        lanes.keep_small(set, &mut logs);
                    }
                }
                if !cuts && chunk.keep.states {
                    result.states.extend(lanes.states(&logs, steps, starts));
                }
            }
            let rhs = chunk.config.method.rhs_per_step(chunk.config.precision);
            result.effort.steps += u64::from(steps) * starts.len() as u64;
            result.effort.lane_steps += u64::from(steps) * count as u64;
            result.effort.rhs_evaluations += rhs * u64::from(steps) * starts.len() as u64;
            lanes.finish(&reduced, &lanes.states(&logs, steps, starts), &mut result);
        }
        Some(result)
    }
}

/// Number of steps after which the size of the slopes is checked.
const STRETCH: u32 = 32;

impl<N: Number + Narrow<N::Leading>> TangentLanes<N> {
    #[inline(always)]
    fn of(
        set: <N::Leading as Lanes>::Set,
        exact: &Pendulum<Dd>,
        starts: &[IntegratorState],
        end: f64,
    ) -> Self {
        // Lanes without a start repeat the last one.
        let start = |lane: usize| &starts[lane.min(starts.len() - 1)];
        let row = |value: &dyn Fn(&IntegratorState) -> f64| -> [f64; MAX_LANES] {
            std::array::from_fn(|lane| value(start(lane)))
        };
        let load =
            |value: &dyn Fn(&IntegratorState) -> f64| <N::Leading as Lanes>::load(set, &row(value));
        let number = |place: usize| load(&|start| start.numbers[place]);
        let state: Tangents<N, N::Leading> = std::array::from_fn(|i| {
            let [high, low] = [i, 6 + i].map(|place| row(&|start| start.numbers[place]));
            let slope = std::array::from_fn(|k| load(&|start| start.slopes()[i][k]));
            Dual { value: N::load(set, &high, &low), slope }
        });
        let same = |value: f64| [value; MAX_LANES];
        let pendulum = exact.map(|Dd { hi, lo }| N::load(set, &same(hi), &same(lo)));
        let scale = exact.to_f64().momentum_scale();
        let scale = scale.map(|scale| N::exactly(<N::Leading as Lanes>::splat(set, 1.0 / scale)));
        TangentLanes {
            state,
            pendulum: pendulum.map(Dual::new),
            inverse_scale: scale.map(Dual::new),
            time: number(TIME),
            time_low: number(TIME_LOW),
            step: number(STEP),
            end: <N::Leading as Lanes>::splat(set, end),
            cuts: false,
        }
    }

    #[inline(always)]
    fn is_busy(&self) -> bool {
        self.step.lit(0.0).any_less(self.length())
    }

    /// Time left until the end of the budget; not positive in lanes that are done.
    #[inline(always)]
    fn left(&self) -> N::Leading {
        (self.end - self.time) - self.time_low
    }

    /// Length of the next step, 0 in lanes that wait or are done.
    #[inline(always)]
    fn length(&self) -> N::Leading {
        let (left, zero) = (self.left(), self.step.lit(0.0));
        if self.cuts {
            self.step.min(left).max(zero)
        } else {
            self.step.where_negative(self.step - left)
        }
    }

    /// Tries a step in every lane and takes it where its error is allowed.
    #[inline(always)]
    fn step_adaptively<P: EmbeddedPair>(&mut self, adaptive: &Adaptive) {
        let control = &adaptive.control;
        let length = self.length();
        let step = Dual::new(N::exactly(length));
        let trial = P::trial(&self.pendulum, self.inverse_scale, &self.state, step);
        let error_squared = trial.error_squared.value.leading();
        let excess = step_control::excess(control, self.time, error_squared);
        let factor = step_control::factor(control, excess);
        self.take(&plus(&self.state, &trial.change), length, excess);
        let next = (self.step * factor).min(length.lit(MAX_STEP));
        self.step = Lanes::select(next, -length, self.step);
    }

    /// Takes a step of the classical Runge–Kutta method.
    #[inline(always)]
    fn step_fixed(&mut self) {
        let length = self.length();
        let next = rk4(&self.pendulum, &self.state, Dual::new(N::exactly(length)));
        self.take(&next, length, length.lit(-1.0));
    }

    /// Moves to the next state in lanes where `test` is negative.
    #[inline(always)]
    fn take(&mut self, next: &Tangents<N, N::Leading>, length: N::Leading, test: N::Leading) {
        for (number, next) in self.state.iter_mut().zip(next) {
            number.value = next.value.select(test, number.value);
            for (slope, next) in number.slope.iter_mut().zip(next.slope) {
                *slope = Lanes::select(next, test, *slope);
            }
        }
        let (time, low) = self.time.fast_two_sum(self.time_low + length);
        self.time = Lanes::select(time, test, self.time);
        self.time_low = Lanes::select(low, test, self.time_low);
    }

    /// Scales down the slopes of a lane where they have grown large, and adds the logarithm of the
    /// factor to `logs`.
    #[inline(always)]
    fn keep_small(&mut self, set: <N::Leading as Lanes>::Set, logs: &mut [f64; MAX_LANES]) {
        let mut most = self.time.lit(0.0);
        for slope in self.state.iter().flat_map(|number| number.slope) {
            most = most.max(slope.abs());
        }
        let mut largest = [0.0; MAX_LANES];
        Lanes::store(most, &mut largest);
        let factor = largest.map(|largest| if largest > LARGE { 1.0 / LARGE } else { 1.0 });
        for (log, factor) in logs.iter_mut().zip(factor) {
            *log -= factor.ln();
        }
        let factor = <N::Leading as Lanes>::load(set, &factor);
        for number in &mut self.state {
            number.slope = number.slope.map(|slope| slope * factor);
        }
    }

    /// The states of the lanes that have starts.
    #[inline(always)]
    fn states(
        &self,
        logs: &[f64; MAX_LANES],
        steps: u32,
        starts: &[IntegratorState],
    ) -> Vec<IntegratorState> {
        let rows = self.state.map(|number| {
            let [mut high, mut low] = [[0.0; MAX_LANES]; 2];
            number.value.store(&mut high, &mut low);
            ([high, low], number.slope.map(row))
        });
        let moments =
            [(TIME, row(self.time)), (TIME_LOW, row(self.time_low)), (STEP, row(self.step))];
        let state = |(lane, start): (usize, &IntegratorState)| {
            let mut numbers = [0.0; NUMBERS];
            for (i, ([high, low], _)) in rows.iter().enumerate() {
                (numbers[i], numbers[6 + i]) = (high[lane], low[lane]);
            }
            for (place, row) in &moments {
                numbers[*place] = row[lane];
            }
            let slopes = std::array::from_fn(|i| rows[i].1.map(|slope| slope[lane]));
            let carried = Some(Box::new(Carried::Tangents { slopes, log_scale: logs[lane] }));
            IntegratorState { steps: start.steps + steps, numbers, carried }
        };
        starts.iter().enumerate().map(state).collect()
    }

    /// Adds the results of pendulums in their last states.
    #[inline(always)]
    fn finish(
        &self,
        reduced: &Pendulum<f64>,
        states: &[IntegratorState],
        result: &mut ChunkResult,
    ) {
        let until = row(self.end)[0] * (1.0 - 1e-6);
        for state in states {
            let end = end_with_growth(reduced, state);
            let whole = end.gathered.log_growth.is_finite() && state.numbers[TIME] >= until;
            let status = if whole { Status::Unflipped } else { Status::Failed };
            result.outcomes.push(Outcome::without_time(status));
            result.ends.push(end);
        }
    }
}

/// The numbers in a register, lane by lane.
#[inline(always)]
fn row<L: Lanes>(lanes: L) -> [f64; MAX_LANES] {
    let mut row = [0.0; MAX_LANES];
    Lanes::store(lanes, &mut row);
    row
}
