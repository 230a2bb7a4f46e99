//! Steps that choose their length: embedded Runge–Kutta pairs on unit vectors and momenta, every
//! lane with a time and a step of its own.

use super::flock::{Answer, Chunk, Flock, PATIENCE};
use super::lanes::{Lanes, MOST_LANES};
use super::number::{Number, load_phase, store_phase};
use crate::engine::method::Adaptive;
use crate::engine::start::{self, STEP, TIME, TIME_LOW};
use crate::engine::{NUMBERS, Question};
use crate::physics::control::{GROW, LONGEST, SHRINK};
use crate::physics::embedded::{Trial, dop853, dopri5, plus};
use crate::physics::passage::{self, Moment, REACH};
use crate::physics::phase::Phase;
use crate::physics::{Outcome, Pendulum, Real, Status};

/// An embedded pair, for every number type.
pub trait Pair {
    /// A step that may be taken.
    fn trial<T: Real>(
        pendulum: &Pendulum<T>,
        inverse_scale: [T; 2],
        phase: &Phase<T>,
        step: T,
    ) -> Trial<T>;
}

macro_rules! pair {
    ($name:ident $function:ident) => {
        #[doc = concat!("[`", stringify!($function), "`].")]
        pub struct $name;

        impl Pair for $name {
            #[inline(always)]
            fn trial<T: Real>(
                pendulum: &Pendulum<T>,
                inverse_scale: [T; 2],
                phase: &Phase<T>,
                step: T,
            ) -> Trial<T> {
                $function(pendulum, inverse_scale, phase, step)
            }
        }
    };
}

pair!(Fifth dopri5);
pair!(Eighth dop853);

/// Runs a chunk in lanes of `N`.
#[inline(always)]
pub fn run<N: Number, P: Pair>(
    set: <N::Leading as Lanes>::Set,
    chunk: &Chunk,
    adaptive: Adaptive,
) -> Option<Answer> {
    let (reduced, _) = chunk.question.reduced();
    let scale = reduced.momentum_scale();
    let one = <N::Leading as Lanes>::splat(set, 1.0);
    let number = N::exactly(one);
    let pendulum = reduced.map(|value| number.lit(value));
    let inverse_scale = [number.lit(1.0 / scale[0]), number.lit(1.0 / scale[1])];
    let mut field =
        Field { flock: Flock::new(chunk, <N::Leading as Lanes>::COUNT, idle()), reduced, adaptive };
    finish_those_over(&mut field.flock, &adaptive);
    while field.flock.is_busy() {
        if field.flock.is_cancelled() {
            return None;
        }
        let mut herd = Herd::<N>::load(set, &field.flock);
        let mut taken = 0;
        loop {
            let trial = P::trial(&pendulum, inverse_scale, &herd.phase, N::exactly(herd.step));
            let next = N::changed(&herd.phase, &trial.change);
            let excess = herd.excess(&adaptive, trial.error_squared.leading());
            let suspicion =
                suspicion(chunk.question, &pendulum, &herd, &next).max(excess).smallest();
            taken += 1;
            if suspicion < 0.0 {
                let before = herd;
                herd.advance(&adaptive, &next, excess);
                field.decide::<N, P>([&before, &herd], taken);
                break;
            }
            herd.advance(&adaptive, &next, excess);
            if taken == PATIENCE || herd.time.largest() >= adaptive.budget {
                herd.store(&mut field.flock, taken);
                break;
            }
        }
        finish_those_over(&mut field.flock, &adaptive);
    }
    Some(field.flock.answer)
}

/// A pendulum at rest, so long before its release that its budget never ends.
pub fn idle() -> [f64; NUMBERS] {
    let mut numbers = [0.0; NUMBERS];
    (numbers[0], numbers[2], numbers[TIME]) = (1.0, 1.0, -1e30);
    numbers
}

/// The lanes in registers.
#[derive(Clone, Copy)]
struct Herd<N: Number> {
    phase: Phase<N>,
    time: N::Leading,
    time_low: N::Leading,
    step: N::Leading,
}

impl<N: Number> Herd<N> {
    #[inline(always)]
    fn load(set: <N::Leading as Lanes>::Set, flock: &Flock) -> Self {
        let rows = &flock.rows;
        let lanes = |row: usize| <N::Leading as Lanes>::load(set, &rows[row]);
        Herd {
            phase: load_phase(set, rows),
            time: lanes(TIME),
            time_low: lanes(TIME_LOW),
            step: lanes(STEP),
        }
    }

    #[inline(always)]
    fn store(&self, flock: &mut Flock, taken: u32) {
        self.store_rows(&mut flock.rows);
        flock.count_steps(taken);
    }

    #[inline(always)]
    fn store_rows(&self, rows: &mut [[f64; MOST_LANES]; NUMBERS]) {
        store_phase(&self.phase, rows);
        self.time.store(&mut rows[TIME]);
        self.time_low.store(&mut rows[TIME_LOW]);
        self.step.store(&mut rows[STEP]);
    }

    /// How far each lane's error is above what is allowed there, in log₂ of squares: negative
    /// where the step can be taken.
    #[inline(always)]
    fn excess(&self, adaptive: &Adaptive, error_squared: N::Leading) -> N::Leading {
        let control = &adaptive.control;
        let lit = |value| self.time.lit(value);
        let limit = self.time.mul_add(lit(control.rise), lit(control.start));
        error_squared.rough_log2() - limit.min(lit(control.ceiling))
    }

    /// Takes the step where `excess` is negative, and chooses the next one's length everywhere.
    #[inline(always)]
    fn advance(&mut self, adaptive: &Adaptive, next: &Phase<N>, excess: N::Leading) {
        let control = &adaptive.control;
        let lit = |value| excess.lit(value);
        let power = excess.mul_add(lit(control.exponent), lit(control.safety));
        let factor = power.max(lit(-8.0)).min(lit(8.0)).rough_exp2();
        let factor = factor.max(lit(SHRINK)).min(lit(GROW));
        for (value, next) in self.phase.iter_mut().zip(next) {
            *value = next.select(excess, *value);
        }
        let (time, low) = self.time.fast_two_sum(self.time_low + self.step);
        self.time = Lanes::select(time, excess, self.time);
        self.time_low = Lanes::select(low, excess, self.time_low);
        self.step = (self.step * factor).min(lit(LONGEST));
    }
}

/// Negative in lanes where a watched bob can have been at the top (twin: `passage::may_pass`).
#[inline(always)]
fn suspicion<N: Number>(
    question: &Question,
    pendulum: &Pendulum<N>,
    herd: &Herd<N>,
    next: &Phase<N>,
) -> N::Leading {
    let before = pendulum.speeds(&herd.phase);
    let after = pendulum.speeds(next);
    let lit = |value| herd.time.lit(value);
    let mut least = lit(1.0);
    for &bob in question.rule.watched() {
        let lowest = herd.phase[2 * bob].leading().min(next[2 * bob].leading());
        let (y0, y1) = (herd.phase[2 * bob + 1].leading(), next[2 * bob + 1].leading());
        let (w0, w1) = (before[bob].leading(), after[bob].leading());
        // Ends exactly at the top count: 0 is below the smallest product that matters.
        let crosses = y0 * y1 - lit(1e-37);
        let travel = lit(REACH) * herd.step * w0.abs().max(w1.abs());
        let grazes = (w0 * w1).max(y0.abs().min(y1.abs()) - travel);
        least = least.min(lowest.max(crosses.min(grazes)));
    }
    least
}

/// A flock in adaptive steps. Its rows are those of [`crate::engine::start::PHASE`].
struct Field<'a> {
    flock: Flock<'a>,
    reduced: Pendulum<f64>,
    adaptive: Adaptive,
}

impl Field<'_> {
    /// After a step in which some lane's bob may have been at the top: looks for the pass, and
    /// finishes those that made it.
    #[inline(always)]
    fn decide<N: Number, P: Pair>(&mut self, [before, after]: [&Herd<N>; 2], taken: u32) {
        let mut rows = self.flock.rows;
        before.store_rows(&mut rows);
        after.store(&mut self.flock, taken);
        for lane in self.flock.running() {
            let numbers = rows.map(|row| row[lane]);
            let moved = self.flock.rows[TIME][lane] != numbers[TIME]
                || self.flock.rows[TIME_LOW][lane] != numbers[TIME_LOW];
            if let (true, Some(fraction)) = (moved, self.fraction_of_step::<P>(lane, &numbers)) {
                let step = numbers[STEP] * fraction;
                let time = numbers[TIME] + (numbers[TIME_LOW] + step);
                // A paused pendulum continues from before the step it flips in.
                self.flock.put(lane, numbers);
                self.flock.finish(lane, self.adaptive.outcome_of_pass(time));
            }
        }
    }

    /// Where in the step that a lane took from `numbers` the rule is first met.
    fn fraction_of_step<P: Pair>(&mut self, lane: usize, numbers: &[f64; NUMBERS]) -> Option<f64> {
        let (before, after) =
            (start::phase_of(numbers), start::phase_of(&self.flock.numbers(lane)));
        let moment = |phase| Moment { phase, speed: self.reduced.speeds(&phase) };
        let (before, after) = (moment(before), moment(after));
        let step = numbers[STEP];
        let scale = self.reduced.momentum_scale().map(|scale| 1.0 / scale);
        let evaluations = std::cell::Cell::new(0);
        let at = |fraction: f64| {
            evaluations.set(evaluations.get() + 1);
            let trial = P::trial(&self.reduced, scale, &before.phase, step * fraction);
            moment(plus(&before.phase, &trial.change))
        };
        let watched = self.flock.chunk.question.rule.watched().iter();
        let found = watched
            .filter_map(|&bob| passage::within(at, bob, &before, &after, step))
            .reduce(f64::min);
        let rhs = self.flock.chunk.recipe.method.rhs_per_step(self.flock.chunk.recipe.precision);
        self.flock.answer.effort.rhs_evaluations += rhs * evaluations.get();
        found
    }
}

/// Frees the lanes whose budget is used, until every lane has work or none is left.
pub fn finish_those_over(flock: &mut Flock, adaptive: &Adaptive) {
    loop {
        flock.refill();
        let mut finished = false;
        for lane in flock.running() {
            let failed = flock.taken[lane] >= adaptive.most_steps;
            if failed || flock.rows[TIME][lane] >= adaptive.budget {
                let status = if failed { Status::Failed } else { Status::Unflipped };
                flock.finish(lane, Outcome::without_time(status));
                finished = true;
            }
        }
        if !finished {
            return;
        }
    }
}
