//! Taylor steps for a register of pendulums at a time: the check of the other methods, and the
//! method for double-double. Crossings of the top are proved on the step's polynomials, not
//! sampled; the test shares no code with that of pairs (`pair.rs`), which it checks.

use std::cmp::Ordering;
use std::marker::PhantomData;

use super::lane_loop::{LanePass, PassSearch, PassStepper};
use super::lane_scheduler::LaneScheduler;
use super::lanes::{Lanes, MAX_LANES};
use super::number::Number;
use super::stepper::{LaneDynamics, LaneState, LaneStep, LaneStepper};
use crate::NUMBERS;
use flipmap_numbers::polynomial::{bernstein, course, evaluate, halves};
use flipmap_numbers::{Dd, Real, Scalar};
use flipmap_pendulum::Pendulum;
use flipmap_pendulum::control::{Control, MAX_STEP};
use flipmap_pendulum::crossing::{FAR, StepState};
use flipmap_pendulum::embedded::plus;
use flipmap_pendulum::series::MotionSeries;

/// Steps along expansions of `M` coefficients. One lane's numbers are of type `T`.
pub(super) struct TaylorSteps<T, const M: usize>(PhantomData<T>);

/// Numbers of one lane, made from the two parts they are stored in.
pub(super) trait FromParts: Scalar {
    fn from_parts(high: f64, low: f64) -> Self;
}

impl FromParts for f64 {
    fn from_parts(high: f64, _: f64) -> Self {
        high
    }
}

impl FromParts for Dd {
    fn from_parts(hi: f64, lo: f64) -> Self {
        Dd { hi, lo }
    }
}

/// The polynomials of a suspect step and its length, lane by lane.
#[derive(Default)]
pub(super) struct KeptSeries<const M: usize> {
    phase: Vec<Rows<M>>,
    length: [f64; MAX_LANES],
}

impl<N: Number, T: FromParts, const M: usize> LaneStepper<N> for TaylorSteps<T, M> {
    type Control = Control;
    type Motion = MotionSeries<N, M>;

    #[inline(always)]
    fn motion(dynamics: &LaneDynamics<N>, state: &LaneState<N>) -> MotionSeries<N, M> {
        MotionSeries::expand(&dynamics.pendulum, &state.phase)
    }

    #[inline(always)]
    fn step(
        dynamics: &LaneDynamics<N>,
        control: &Control,
        state: &LaneState<N>,
        series: &MotionSeries<N, M>,
    ) -> LaneStep<N> {
        let log2_tolerance = control.start * 0.5;
        let length = step_length(series, &dynamics.inverse_scale, log2_tolerance);
        LaneStep {
            next: plus(&state.phase, &series.change(N::exactly(length))),
            length,
            // Every step is taken.
            excess: length.lit(-1.0),
        }
    }

    #[inline(always)]
    fn next_length(_: &Control, state: &LaneState<N>, _: &LaneStep<N>) -> N::Leading {
        state.step
    }
}

impl<N: Number, T: FromParts, const M: usize> PassStepper<N> for TaylorSteps<T, M> {
    type Kept = KeptSeries<M>;
    type Search<'a> = SeriesSearch<'a, T, M>;

    #[inline(always)]
    fn clearance(
        _: &LaneDynamics<N>,
        watches: [bool; 2],
        _: &LaneState<N>,
        step: &LaneStep<N>,
        series: &MotionSeries<N, M>,
    ) -> N::Leading {
        let mut least = step.length.lit(FAR);
        for bob in (0..2).filter(|bob| watches[*bob]) {
            least = clearance_of(bob, least, series, step);
        }
        least
    }

    #[inline(always)]
    fn keep(kept: &mut KeptSeries<M>, series: &MotionSeries<N, M>, step: &LaneStep<N>) {
        kept.phase.clear();
        kept.phase.extend(series.phase.iter().map(rows));
        step.length.store(&mut kept.length);
    }

    fn search<'a>(
        kept: &KeptSeries<M>,
        pendulum: &'a Pendulum<f64>,
        scheduler: &mut LaneScheduler,
        lane: usize,
        _: &[f64; NUMBERS],
    ) -> SeriesSearch<'a, T, M> {
        let one = |i: usize| -> [T; M] {
            std::array::from_fn(|k| {
                let [high, low] = &kept.phase[i][k];
                T::from_parts(high[lane], low[lane])
            })
        };
        let mut search = SeriesSearch {
            pendulum,
            phase: [0, 1, 2, 3, 4, 5].map(one),
            passes: Vec::new(),
            told: 0,
        };
        search.find(scheduler, lane, T::from_f64(kept.length[lane]));
        search
    }
}

/// Returns the longest step in which no term of the last two orders exceeds the tolerance (given by
/// its log₂): Jorba and Zou's rule, with momenta in units of their scale.
#[inline(always)]
fn step_length<N: Number, const M: usize>(
    series: &MotionSeries<N, M>,
    inverse_scale: &[N; 2],
    log2_tolerance: f64,
) -> N::Leading {
    let lit = |value| series.phase[0][0].leading().lit(value);
    let mut log2_length = lit(MAX_STEP.log2());
    for order in [M - 2, M - 1] {
        let mut largest = lit(0.0);
        for i in 0..6 {
            let size = series.phase[i][order].leading().abs();
            let size = if i < 4 { size } else { size * inverse_scale[i - 4].leading() };
            largest = largest.max(size);
        }
        let allowed = (lit(log2_tolerance) - largest.rough_log2()) * lit(1.0 / order as f64);
        log2_length = log2_length.min(allowed);
    }
    log2_length.max(lit(-90.0)).rough_exp2()
}

/// Returns the least of `least` and a lower bound on the distance from the top that a bob keeps in a
/// step; not positive in lanes where the bob may cross the top, that is, where its `y` can vanish,
/// its `x` can be negative, and it ends on the other side or can turn round.
#[inline(always)]
fn clearance_of<N: Number, const M: usize>(
    bob: usize,
    least: N::Leading,
    series: &MotionSeries<N, M>,
    LaneStep { next, length, .. }: &LaneStep<N>,
) -> N::Leading {
    let (x, y) = (&series.phase[2 * bob], &series.phase[2 * bob + 1]);
    let (y0, y1) = (y[0].leading(), next[2 * bob + 1].leading());
    let lowest = x[0].leading() - reach(x, *length);
    let nearest = y0.abs() - reach(y, *length);
    let crosses = y0 * y1 - length.lit(1e-37);
    let speed = &series.speed[bob];
    let turns = speed[0].leading().abs() - reach(speed, *length);
    let ends = y0.abs().min(y1.abs());
    let one_way = Lanes::select(length.lit(-1.0), crosses.min(turns), ends);
    least.min(Lanes::select(nearest.max(one_way), lowest, least))
}

/// Upper bound on how far a series moves within `length`.
#[inline(always)]
fn reach<N: Number, const M: usize>(series: &[N; M], length: N::Leading) -> N::Leading {
    let mut sum = series[M - 1].leading().abs();
    for k in (1..M - 1).rev() {
        sum = sum.mul_add(length, series[k].leading().abs());
    }
    sum * length
}

/// The passes of the top in one pendulum's step, found on its polynomials.
pub(super) struct SeriesSearch<'a, T, const M: usize> {
    pendulum: &'a Pendulum<f64>,
    phase: [[T; M]; 6],
    /// The time since the step began, the bob, and true for anticlockwise.
    passes: Vec<(T, usize, bool)>,
    /// Number of passes that were told.
    told: usize,
}

impl<T: Scalar, const M: usize> SeriesSearch<'_, T, M> {
    /// Finds all passes in a step.
    fn find(&mut self, scheduler: &mut LaneScheduler, lane: usize, length: T) {
        let question = scheduler.chunk.question;
        for &bob in question.rule.watched() {
            let (x, y) = (&self.phase[2 * bob], &self.phase[2 * bob + 1]);
            let (found, nearest) = passages_of_top(x, y, length, question.passes);
            scheduler.clearance[lane] = scheduler.clearance[lane].min(nearest);
            let of_bob = |(time, anticlockwise)| (time, bob, anticlockwise);
            self.passes.extend(found.into_iter().map(of_bob));
        }
        self.passes.sort_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(Ordering::Equal));
    }
}

impl<T: Scalar, const M: usize> PassSearch for SeriesSearch<'_, T, M> {
    fn next(&mut self, _: &mut LaneScheduler, _: usize) -> Option<LanePass> {
        let &(time, bob, anticlockwise) = self.passes.get(self.told)?;
        self.told += 1;
        Some(LanePass { into_step: time.to_f64(), bob, anticlockwise })
    }

    fn top(&self) -> StepState<f64> {
        let (time, ..) = self.passes[self.told - 1];
        let phase = self.phase.each_ref().map(|terms| evaluate(terms, time).to_f64());
        StepState { phase, speed: self.pendulum.speeds(&phase) }
    }

    fn go_on(&mut self, _: &LanePass, _: &StepState<f64>) {}
}
/// Returns the first `most` moments in (0, length] at which a point on the unit circle, with the
/// polynomials `x` and `y`, crosses the top, (−1, 0). Each moment comes with true if the point
/// crosses anticlockwise. Also returns the least distance from the top that the point reaches
/// before then without crossing. Near the top `y` keeps its leading digits, however small it is.
fn passages_of_top<T: Scalar, const M: usize>(
    x: &[T; M],
    y: &[T; M],
    length: T,
    most: u32,
) -> (Vec<(T, bool)>, f64) {
    let mut power = T::from_f64(1.0);
    let scaled = y.map(|c| {
        let term = c * power;
        power = power * length;
        term
    });
    let (mut control, mut from) = (bernstein(&scaled), T::zero());
    let mut passages = Vec::new();
    let Some(first) = control.iter().find(|&&c| c != T::zero()) else { return (passages, FAR) };
    let mut side = if *first > T::zero() { T::from_f64(1.0) } else { -T::from_f64(1.0) };
    let mut nearest = FAR;
    loop {
        let found = course(&control, side);
        if evaluate(x, from * length) < T::zero() {
            nearest = nearest.min(found.clearance.to_f64());
        }
        let Some(change) = found.change else { return (passages, nearest) };
        let share = from + (T::from_f64(1.0) - from) * change;
        if evaluate(x, share * length) < T::zero() {
            passages.push((share * length, side > T::zero()));
        }
        // Every crossing, at the top or at the bottom, changes the side.
        if share >= T::from_f64(1.0) || passages.len() >= most as usize {
            return (passages, nearest);
        }
        (control, from, side) = (halves(&control, change)[1], share, -side);
        control[0] = T::zero();
    }
}

/// The two parts of every coefficient, lane by lane.
type Rows<const M: usize> = [[[f64; MAX_LANES]; 2]; M];

#[inline(always)]
fn rows<N: Number, const M: usize>(series: &[N; M]) -> Rows<M> {
    let mut rows = [[[0.0; MAX_LANES]; 2]; M];
    for (parts, value) in rows.iter_mut().zip(series) {
        let [high, low] = parts;
        value.store(high, low);
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pass_is_seen_however_near_the_top_it_begins() {
        for size in [1e-3, 1e-15, 1e-30] {
            let (passes, _) = passages_of_top(&[-1.0, 0.0], &[-0.9 * size, size], 1.0, 1);
            assert!((passes[0].0 - 0.9f64).abs() < 1e-12 && !passes[0].1, "{size} {passes:?}");
        }
    }

    #[test]
    fn a_miss_says_how_near_it_was() {
        let y = |height: f64| [height - 0.25, 1.0, -1.0, 0.0];
        let (passes, nearest) = passages_of_top(&[-1.0, 0.0, 0.0, 0.0], &y(-1e-9), 1.0, 1);
        assert!(passes.is_empty() && (0.1e-9..1.0001e-9).contains(&nearest), "{nearest:e}");
        let (passes, _) = passages_of_top(&[-1.0, 0.0, 0.0, 0.0], &y(1e-9), 1.0, 9);
        let by = 1e-9f64.sqrt();
        assert!((passes[0].0 - (0.5 - by)).abs() < 1e-11 && !passes[0].1, "over it");
        assert!((passes[1].0 - (0.5 + by)).abs() < 1e-11 && passes[1].1, "and back");
        let (passes, nearest) = passages_of_top(&[1.0, 0.0, 0.0, 0.0], &y(1e-9), 1.0, 1);
        assert_eq!((passes, nearest), (Vec::new(), FAR), "the bottom is no top");
    }
}
