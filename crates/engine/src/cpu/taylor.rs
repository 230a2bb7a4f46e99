//! Taylor steps for a register of pendulums at a time: the check of the other methods, and the
//! method for double-double. Crossings of the top are proved on the step's polynomials, not
//! sampled.

use std::marker::PhantomData;

use super::adaptive::{finish_those_over, idle};
use super::lane_scheduler::{Chunk, ChunkResult, LaneScheduler, PATIENCE};
use super::lanes::{Lanes, MAX_LANES};
use super::number::{Number, load_phase, store_phase};
use super::slowed::finish_slowed;
use super::stretch::{Stretch, vectorized};
use super::turns;
use crate::FinalState;
use crate::pace::Adaptive;
use crate::start::{TIME, TIME_LOW};
use flipmap_numbers::polynomial::{bernstein, course, evaluate, halves};
use flipmap_numbers::{Dd, Real, Scalar};
use flipmap_pendulum::control::MAX_STEP;
use flipmap_pendulum::crossing::{FAR, StepState, height_beyond};
use flipmap_pendulum::embedded::plus;
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::series::MotionSeries;
use flipmap_pendulum::{Pendulum, Status};

/// Runs a chunk in lanes of `N`, with expansions of `M` coefficients; one lane's numbers are
/// of type `T`, made from the two parts they are stored in.
#[inline(never)]
pub(super) fn run<N: Number, T: Scalar, const M: usize>(
    set: <N::Leading as Lanes>::Set,
    chunk: &Chunk,
    adaptive: Adaptive,
    from_parts: fn(f64, f64) -> T,
) -> Option<ChunkResult> {
    vectorized::<N::Leading, _>(
        set,
        TaylorRun::<N, T, M> { chunk, adaptive, from_parts, lanes: PhantomData },
    )
}

struct TaylorRun<'a, N, T, const M: usize> {
    chunk: &'a Chunk<'a>,
    adaptive: Adaptive,
    from_parts: fn(f64, f64) -> T,
    lanes: PhantomData<N>,
}

impl<N: Number, T: Scalar, const M: usize> Stretch<N::Leading> for TaylorRun<'_, N, T, M> {
    type Output = Option<ChunkResult>;

    #[inline(always)]
    fn run(self, set: <N::Leading as Lanes>::Set) -> Option<ChunkResult> {
        let TaylorRun { chunk, adaptive, from_parts, .. } = self;
        let (reduced, _) = chunk.question.reduced_in::<Dd>();
        let lanes = |value: f64| [value; MAX_LANES];
        let pendulum = reduced.map(|Dd { hi, lo }| N::load(set, &lanes(hi), &lanes(lo)));
        let near = reduced.to_f64();
        let inverse_scale = near.momentum_scale().map(|scale| 1.0 / scale);
        let mut scheduler = LaneScheduler::new(chunk, <N::Leading as Lanes>::COUNT, idle());
        let counts_turns = scheduler.counts_turns();
        finish_those_over(&mut scheduler, &adaptive);
        while scheduler.is_busy() {
            if scheduler.is_cancelled() {
                return None;
            }
            let mut state = TaylorLaneState::<N>::load(set, &scheduler);
            let mut taken = 0;
            loop {
                let series = MotionSeries::<N, M>::expand(&pendulum, &state.phase);
                let length = step_length(&series, inverse_scale, adaptive.control.start * 0.5);
                let next = plus(&state.phase, &series.change(N::exactly(length)));
                let clearance = clearance(chunk, &series, &next, length);
                taken += 1;
                if clearance.any_at_most(length.lit(0.0)) {
                    let step = (&series, &state, length);
                    let how = (&near, &adaptive);
                    let flips = flips_in_step(&mut scheduler, step, clearance, how, from_parts);
                    if flips.iter().any(Option::is_some) {
                        state.finish_step(&mut scheduler, next, length, taken, flips, &adaptive);
                        break;
                    }
                } else {
                    keep_least(&mut scheduler, clearance);
                }
                if counts_turns {
                    turns::count(&mut state.turns, [&state.phase, &next], -length);
                }
                state.advance(next, length);
                if taken == PATIENCE || state.time.lit(adaptive.budget).any_at_most(state.time) {
                    state.store(&mut scheduler);
                    scheduler.count_steps(taken);
                    break;
                }
            }
            finish_slowed(&mut scheduler, &near);
            finish_those_over(&mut scheduler, &adaptive);
        }
        Some(scheduler.answer)
    }
}

/// Returns the longest step in which no term of the last two orders exceeds the tolerance (given by
/// its log₂): Jorba and Zou's rule, with momenta in units of their scale.
#[inline(always)]
fn step_length<N: Number, const M: usize>(
    series: &MotionSeries<N, M>,
    inverse_scale: [f64; 2],
    log2_tolerance: f64,
) -> N::Leading {
    let lit = |value| series.phase[0][0].leading().lit(value);
    let mut log2_length = lit(MAX_STEP.log2());
    for order in [M - 2, M - 1] {
        let mut largest = lit(0.0);
        for i in 0..6 {
            let size = series.phase[i][order].leading().abs();
            let size = if i < 4 { size } else { size * lit(inverse_scale[i - 4]) };
            largest = largest.max(size);
        }
        let allowed = (lit(log2_tolerance) - largest.rough_log2()) * lit(1.0 / order as f64);
        log2_length = log2_length.min(allowed);
    }
    log2_length.max(lit(-90.0)).rough_exp2()
}

/// Lower bound on the distance from the top that the watched bobs keep in a step; not positive in
/// lanes where a bob may cross the top, that is, where its `y` can vanish, its `x` can be negative,
/// and it ends on the other side or can turn round.
#[inline(always)]
fn clearance<N: Number, const M: usize>(
    chunk: &Chunk,
    series: &MotionSeries<N, M>,
    next: &Phase<N>,
    length: N::Leading,
) -> N::Leading {
    let mut least = length.lit(FAR);
    for &bob in chunk.question.rule.watched() {
        let (x, y) = (&series.phase[2 * bob], &series.phase[2 * bob + 1]);
        let (y0, y1) = (y[0].leading(), next[2 * bob + 1].leading());
        let lowest = x[0].leading() - reach(x, length);
        let nearest = y0.abs() - reach(y, length);
        let crosses = y0 * y1 - length.lit(1e-37);
        let speed = &series.speed[bob];
        let turns = speed[0].leading().abs() - reach(speed, length);
        let ends = y0.abs().min(y1.abs());
        let one_way = Lanes::select(length.lit(-1.0), crosses.min(turns), ends);
        least = least.min(Lanes::select(nearest.max(one_way), lowest, least));
    }
    least
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

/// The last pass of each lane that makes it in a step: the reduced time since the step began, and
/// the state at that time.
type Flips = [Option<(f64, Phase<f64>)>; MAX_LANES];

/// Looks for passes of the top in the lanes whose clearance is not positive, and counts them.
#[inline(always)]
fn flips_in_step<N: Number, T: Scalar, const M: usize>(
    scheduler: &mut LaneScheduler,
    (series, state, length): (&MotionSeries<N, M>, &TaylorLaneState<N>, N::Leading),
    clearance: N::Leading,
    (pendulum, adaptive): (&Pendulum<f64>, &Adaptive),
    from_parts: fn(f64, f64) -> T,
) -> Flips {
    let (mut bounds, mut lengths) = ([0.0; MAX_LANES], [0.0; MAX_LANES]);
    clearance.store(&mut bounds);
    length.store(&mut lengths);
    let mut times = [0.0; MAX_LANES];
    state.time.store(&mut times);
    let all = [0, 1, 2, 3, 4, 5].map(|i| rows(&series.phase[i]));
    let mut flips = [None; MAX_LANES];
    for lane in scheduler.running() {
        if bounds[lane] > 0.0 {
            scheduler.clearance[lane] = scheduler.clearance[lane].min(bounds[lane]);
            continue;
        }
        let length = T::from_f64(lengths[lane]);
        let one = |i: usize| -> [T; M] {
            std::array::from_fn(|k| from_parts(all[i][k][0][lane], all[i][k][1][lane]))
        };
        let mut passes: Vec<(T, usize, bool)> = Vec::new();
        for &bob in scheduler.chunk.question.rule.watched() {
            let (x, y) = (one(2 * bob), one(2 * bob + 1));
            let (found, nearest) = passages_of_top(&x, &y, length, scheduler.chunk.question.passes);
            scheduler.clearance[lane] = scheduler.clearance[lane].min(nearest);
            passes
                .extend(found.into_iter().map(|(time, anticlockwise)| (time, bob, anticlockwise)));
        }
        passes.sort_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(std::cmp::Ordering::Equal));
        for (time, bob, anticlockwise) in passes {
            let into_step = time.to_f64();
            let phase = [0, 1, 2, 3, 4, 5].map(|i| evaluate(&one(i), time).to_f64());
            let outcome = adaptive.outcome_of_pass(times[lane] + into_step);
            let over = outcome.status == Status::Unflipped;
            if over || scheduler.pass(lane, bob, anticlockwise) {
                flips[lane] = Some((into_step, phase));
                break;
            }
            let top = StepState { phase, speed: pendulum.speeds(&phase) };
            let cleared = height_beyond(pendulum, &top, bob);
            scheduler.clearance[lane] = scheduler.clearance[lane].min(cleared);
        }
    }
    flips
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

/// Lowers the lanes' clearances to those of a step.
#[inline(always)]
fn keep_least<L: Lanes>(scheduler: &mut LaneScheduler, clearance: L) {
    let mut bounds = [FAR; MAX_LANES];
    clearance.store(&mut bounds);
    for (kept, bound) in scheduler.clearance.iter_mut().zip(bounds) {
        *kept = kept.min(bound);
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

/// The state of all lanes in registers.
#[derive(Clone, Copy)]
struct TaylorLaneState<N: Number> {
    phase: Phase<N>,
    time: N::Leading,
    time_low: N::Leading,
    /// Whole turns of each bob.
    turns: [N::Leading; 2],
}

impl<N: Number> TaylorLaneState<N> {
    #[inline(always)]
    fn load(set: <N::Leading as Lanes>::Set, scheduler: &LaneScheduler) -> Self {
        let rows = &scheduler.rows;
        TaylorLaneState {
            phase: load_phase(set, rows),
            time: Lanes::load(set, &rows[TIME]),
            time_low: Lanes::load(set, &rows[TIME_LOW]),
            turns: [0, 1].map(|bob| Lanes::load(set, &scheduler.turns[bob])),
        }
    }

    #[inline(always)]
    fn store(&self, scheduler: &mut LaneScheduler) {
        let rows = &mut scheduler.rows;
        store_phase(&self.phase, rows);
        self.time.store(&mut rows[TIME]);
        self.time_low.store(&mut rows[TIME_LOW]);
        for (turns, row) in self.turns.iter().zip(&mut scheduler.turns) {
            turns.store(row);
        }
    }

    #[inline(always)]
    fn advance(&mut self, next: Phase<N>, length: N::Leading) {
        self.phase = next;
        (self.time, self.time_low) = self.time.fast_two_sum(self.time_low + length);
    }

    /// Ends a stretch with a step in which some pendulums flip; those stay in the state before it,
    /// from which they would be continued.
    #[inline(always)]
    fn finish_step(
        &mut self,
        scheduler: &mut LaneScheduler,
        next: Phase<N>,
        length: N::Leading,
        taken: u32,
        flips: Flips,
        adaptive: &Adaptive,
    ) {
        self.store(scheduler);
        let before = scheduler.rows;
        self.advance(next, length);
        self.store(scheduler);
        scheduler.count_steps(taken);
        for lane in scheduler.running() {
            if let Some((into_step, phase)) = flips[lane] {
                let numbers = before.map(|row| row[lane]);
                scheduler.put(lane, numbers);
                let time = numbers[TIME] + (numbers[TIME_LOW] + into_step);
                scheduler.finish(lane, adaptive.outcome_of_pass(time), |lanes| FinalState {
                    time,
                    phase,
                    ..lanes.end_of_phase(lane)
                });
            }
        }
    }
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
