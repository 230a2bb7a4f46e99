//! Taylor steps of a register's worth of pendulums: the check of the other methods, and the way
//! to double-double. Passes of the top are proved on the step's polynomials, not sampled.

use super::adaptive::{finish_those_over, idle};
use super::flock::{Answer, Chunk, Flock, PATIENCE};
use super::lanes::{Lanes, MOST_LANES};
use super::number::{Number, load_phase, store_phase};
use crate::engine::method::Adaptive;
use crate::engine::start::{TIME, TIME_LOW};
use crate::physics::control::LONGEST;
use crate::physics::embedded::plus;
use crate::physics::gold::passage_of_top;
use crate::physics::phase::Phase;
use crate::physics::series::Series;
use crate::physics::{Dd, Real, Scalar};

/// Runs a chunk in lanes of `N`, with expansions of `M` coefficients; one lane's numbers are
/// of type `T`, made from the two parts they are stored in.
#[inline(always)]
pub fn run<N: Number, T: Scalar, const M: usize>(
    set: <N::Leading as Lanes>::Set,
    chunk: &Chunk,
    adaptive: Adaptive,
    from_parts: fn(f64, f64) -> T,
) -> Option<Answer> {
    let (reduced, _) = chunk.question.reduced_in::<Dd>();
    let lanes = |value: f64| [value; MOST_LANES];
    let pendulum = reduced.map(|Dd { hi, lo }| N::load(set, &lanes(hi), &lanes(lo)));
    let inverse_scale = reduced.to_f64().momentum_scale().map(|scale| 1.0 / scale);
    let mut flock = Flock::new(chunk, <N::Leading as Lanes>::COUNT, idle());
    finish_those_over(&mut flock, &adaptive);
    while flock.is_busy() {
        if flock.is_cancelled() {
            return None;
        }
        let mut herd = Herd::<N>::load(set, &flock);
        let mut taken = 0;
        loop {
            let series = Series::<N, M>::expand(&pendulum, &herd.phase);
            let length = step_length(&series, inverse_scale, adaptive.control.start * 0.5);
            let next = plus(&herd.phase, &series.change(N::exactly(length)));
            let suspicion = suspicion(chunk, &series, &next, length);
            taken += 1;
            if suspicion.smallest() < 0.0 {
                let flips = flips_in_step(&mut flock, &series, length, suspicion, from_parts);
                if flips.iter().any(Option::is_some) {
                    herd.finish_step(&mut flock, next, length, taken, flips, &adaptive);
                    break;
                }
            }
            herd.advance(next, length);
            if taken == PATIENCE || herd.time.largest() >= adaptive.budget {
                herd.store(&mut flock.rows);
                flock.count_steps(taken);
                break;
            }
        }
        finish_those_over(&mut flock, &adaptive);
    }
    Some(flock.answer)
}

/// The length at which the last two orders promise errors of the tolerance (whose log₂ is
/// given): Jorba and Zou's rule, with momenta in units of their scale.
#[inline(always)]
fn step_length<N: Number, const M: usize>(
    series: &Series<N, M>,
    inverse_scale: [f64; 2],
    log2_tolerance: f64,
) -> N::Leading {
    let lit = |value| series.phase[0][0].leading().lit(value);
    let mut log2_length = lit(LONGEST.log2());
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

/// Negative in lanes where a watched bob may have been at the top: its `y` can vanish, its `x`
/// be negative, and it ends on the other side or can have turned round, all by bounds.
#[inline(always)]
fn suspicion<N: Number, const M: usize>(
    chunk: &Chunk,
    series: &Series<N, M>,
    next: &Phase<N>,
    length: N::Leading,
) -> N::Leading {
    let mut least = length.lit(1.0);
    for &bob in chunk.question.rule.watched() {
        let (x, y) = (&series.phase[2 * bob], &series.phase[2 * bob + 1]);
        let lowest = x[0].leading() - reach(x, length);
        let nearest = y[0].leading().abs() - reach(y, length);
        let crosses = y[0].leading() * next[2 * bob + 1].leading() - length.lit(1e-37);
        let speed = &series.speed[bob];
        let turns = speed[0].leading().abs() - reach(speed, length);
        least = least.min(lowest.max(nearest).max(crosses.min(turns)));
    }
    least
}

/// A bound on how far a series moves within `length`.
#[inline(always)]
fn reach<N: Number, const M: usize>(series: &[N; M], length: N::Leading) -> N::Leading {
    let mut sum = series[M - 1].leading().abs();
    for k in (1..M - 1).rev() {
        sum = sum.mul_add(length, series[k].leading().abs());
    }
    sum * length
}

type Flips = [Option<f64>; MOST_LANES];

/// For each suspicious lane the reduced time into the step at which the rule is first met.
#[inline(always)]
fn flips_in_step<N: Number, T: Scalar, const M: usize>(
    flock: &mut Flock,
    series: &Series<N, M>,
    length: N::Leading,
    suspicion: N::Leading,
    from_parts: fn(f64, f64) -> T,
) -> Flips {
    let (mut suspicions, mut lengths) = ([0.0; MOST_LANES], [0.0; MOST_LANES]);
    suspicion.store(&mut suspicions);
    length.store(&mut lengths);
    let mut flips = [None; MOST_LANES];
    for &bob in flock.chunk.question.rule.watched() {
        let (x, y) = (rows(&series.phase[2 * bob]), rows(&series.phase[2 * bob + 1]));
        for lane in flock.running().filter(|&lane| suspicions[lane] < 0.0) {
            let one = |rows: &Rows<M>| -> [T; M] {
                std::array::from_fn(|k| from_parts(rows[k][0][lane], rows[k][1][lane]))
            };
            let found = passage_of_top(&one(&x), &one(&y), T::from_f64(lengths[lane]));
            let found = found.map(|time| time.to_f64());
            flips[lane] = [flips[lane], found].into_iter().flatten().reduce(f64::min);
        }
    }
    flips
}

/// The two parts of every coefficient, lane by lane.
type Rows<const M: usize> = [[[f64; MOST_LANES]; 2]; M];

#[inline(always)]
fn rows<N: Number, const M: usize>(series: &[N; M]) -> Rows<M> {
    let mut rows = [[[0.0; MOST_LANES]; 2]; M];
    for (parts, value) in rows.iter_mut().zip(series) {
        let [high, low] = parts;
        value.store(high, low);
    }
    rows
}

/// The lanes in registers.
#[derive(Clone, Copy)]
struct Herd<N: Number> {
    phase: Phase<N>,
    time: N::Leading,
    time_low: N::Leading,
}

impl<N: Number> Herd<N> {
    #[inline(always)]
    fn load(set: <N::Leading as Lanes>::Set, flock: &Flock) -> Self {
        let rows = &flock.rows;
        Herd {
            phase: load_phase(set, rows),
            time: Lanes::load(set, &rows[TIME]),
            time_low: Lanes::load(set, &rows[TIME_LOW]),
        }
    }

    #[inline(always)]
    fn store(&self, rows: &mut [[f64; MOST_LANES]]) {
        store_phase(&self.phase, rows);
        self.time.store(&mut rows[TIME]);
        self.time_low.store(&mut rows[TIME_LOW]);
    }

    #[inline(always)]
    fn advance(&mut self, next: Phase<N>, length: N::Leading) {
        self.phase = next;
        (self.time, self.time_low) = self.time.fast_two_sum(self.time_low + length);
    }

    /// Ends a stretch with a step in which some pendulums flip: they stay before it, as they
    /// would be continued from.
    #[inline(always)]
    fn finish_step(
        &mut self,
        flock: &mut Flock,
        next: Phase<N>,
        length: N::Leading,
        taken: u32,
        flips: Flips,
        adaptive: &Adaptive,
    ) {
        self.store(&mut flock.rows);
        let before = flock.rows;
        self.advance(next, length);
        self.store(&mut flock.rows);
        flock.count_steps(taken);
        for lane in flock.running() {
            if let Some(into_step) = flips[lane] {
                let numbers = before.map(|row| row[lane]);
                flock.put(lane, numbers);
                let time = numbers[TIME] + (numbers[TIME_LOW] + into_step);
                flock.finish(lane, adaptive.outcome_of_pass(time));
            }
        }
    }
}
