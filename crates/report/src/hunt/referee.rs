//! The referee of a hunt: a solver that shares nothing with the engines but the right-hand side and
//! the definition of a quantity whose extreme is asked for. It keeps a loop of its own by decision: a
//! mistake in the engines' loop must not be able to repeat itself here.
//!
//! Steps are extrapolations of Gragg's midpoint rule (Bulirsch and Stoer 1966; Hairer, Nørsett and
//! Wanner, *Solving Ordinary Differential Equations I*, 2nd ed., II.9), of an order and a length
//! that the digits of the number type call for. A step is accepted only if no watched bob can have
//! been at the top in it, or if one crossed the top exactly once; otherwise it is halved. The bound
//! on a bob's path comes from its acceleration at both ends, with a safety factor.

use flipmap_numbers::Scalar;
use flipmap_pendulum::extremum::{Extremum, Measure};
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::{Accumulators, Pendulum};

/// A solver for the motion of one pendulum.
pub(super) struct Referee<'a, T> {
    /// The pendulum in reduced units.
    pub pendulum: Pendulum<T>,
    /// The quantity whose extreme is told, if any.
    pub extremum: Option<Extremum>,
    /// The bobs whose passes of the top are told.
    pub bobs: &'static [usize],
    /// Number of passes after which the pendulum is done.
    pub passes: u32,
    /// The budget in reduced units.
    pub budget: T,
    /// Number of columns of the extrapolation.
    pub columns: usize,
    /// Error allowed in a step, in unit vectors and scaled momenta.
    pub tolerance: f64,
    /// Function that returns true when the solution has taken too long.
    pub give_up: &'a (dyn Fn() -> bool + Sync),
}

/// The end of a motion: at its last pass, or at the end of the budget.
#[derive(Clone, Debug)]
pub(super) struct MotionEnd<T> {
    /// True if it ended at its last pass.
    pub flipped: bool,
    /// Reduced time.
    pub time: T,
    pub phase: Phase<T>,
    /// Passes of each bob, anticlockwise and clockwise.
    pub passes: [u32; 4],
    /// The extreme that is told, and its reduced time.
    pub extremum: [f64; 2],
}

/// The verdict on whether a bob crossed the top in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum TopVerdict {
    Clear,
    /// The bob passes.
    Passes(usize),
    Unclear,
}

/// Longest step, in reduced units.
const LONGEST: f64 = 0.25;
/// Step below which a failing error test means that the number type has too few digits.
const MIN_TESTED_STEP: f64 = 1e-6;
/// Step below which nothing can be decided any more.
const SHORTEST: f64 = 1e-60;
/// First step of a bob that begins exactly at the top, after which it is on the side to which it moves.
const OFF_THE_TOP: f64 = 1e-6;
const MAX_STEPS: usize = 2_000_000;
/// Factor by which a bob's acceleration within a step may exceed that at its ends.
const ROOM: f64 = 4.0;
/// Halvings in the search for an extreme within a step.
const HALVINGS: usize = 40;

impl<T: Scalar> Referee<'_, T> {
    /// The end of a motion from a state; `None` if it cannot be decided in these digits.
    pub(super) fn end(&self, start: &Phase<T>) -> Option<MotionEnd<T>> {
        let mut now = self.begun(start);
        let measure = |kind| Measure::new(kind, self.pendulum, *start);
        let measure = self.extremum.map(measure);
        let mut counts = self.extremum.is_some_and(Extremum::counts_from_release);
        let mut step = T::from_f64(1e-2);
        for _ in 0..MAX_STEPS {
            let left = self.budget - now.time;
            if left <= T::zero() {
                return Some(now);
            }
            if (self.give_up)() {
                return None;
            }
            let length = if step < left { step } else { left };
            let (next, error) = self.step(&now.phase, length);
            if error.is_nan() || error > self.tolerance {
                if length.to_f64() < MIN_TESTED_STEP {
                    return None;
                }
                step = length * T::from_f64(0.5);
                continue;
            }
            match self.way(&now.phase, &next, length) {
                TopVerdict::Unclear if length.to_f64() < SHORTEST => return None,
                TopVerdict::Unclear => {
                    step = length * T::from_f64(0.5);
                    continue;
                }
                TopVerdict::Passes(bob) => {
                    let clockwise = now.phase[2 * bob + 1] < T::zero();
                    now.passes[2 * bob + usize::from(clockwise)] += 1;
                    if now.passes.iter().sum::<u32>() >= self.passes {
                        let tau = self.passage(bob, &now.phase, length)?;
                        let phase = self.step(&now.phase, tau).0;
                        return Some(MotionEnd {
                            flipped: true,
                            time: now.time + tau,
                            phase,
                            ..now
                        });
                    }
                }
                TopVerdict::Clear => {}
            }
            if let Some(measure) = &measure {
                self.look_back(measure, &mut now, &next, length, &mut counts);
            }
            (now.phase, now.time) = (next, now.time + length);
            // The error of the last column falls with a high power of the step.
            let power = 1.0 / (2 * self.columns - 1) as f64;
            let factor = 0.7 * (self.tolerance / error.max(1e-300)).powf(power);
            let longer = length * T::from_f64(factor.clamp(0.3, 2.0));
            step = if longer > T::from_f64(LONGEST) { T::from_f64(LONGEST) } else { longer };
        }
        None
    }

    /// The motion at its release, or a moment later if a bob begins exactly at the top.
    fn begun(&self, start: &Phase<T>) -> MotionEnd<T> {
        let off = T::from_f64(OFF_THE_TOP);
        let (phase, time) = match self.bobs.iter().any(|&bob| Self::is_at_top(bob, start)) {
            true => (self.step(start, off).0, off),
            false => (*start, T::zero()),
        };
        let extremum = match self.extremum {
            Some(kind) => Measure::new(kind, self.pendulum, *start).to_f64().begun(),
            None => Accumulators::NONE.extremum,
        };
        MotionEnd { flipped: false, time, phase, passes: [0; 4], extremum }
    }

    /// Returns true if a bob is exactly at the top.
    fn is_at_top(bob: usize, phase: &Phase<T>) -> bool {
        phase[2 * bob] < T::zero() && phase[2 * bob + 1] == T::zero()
    }

    /// Keeps the extreme if the step to `next` has one.
    fn look_back(
        &self,
        measure: &Measure<T>,
        now: &mut MotionEnd<T>,
        next: &Phase<T>,
        step: T,
        counts: &mut bool,
    ) {
        let sign = if measure.extremum.is_greatest() { -1.0 } else { 1.0 };
        let rate = |phase: &Phase<T>| sign * measure.slope(phase).to_f64();
        let (before, after) = (rate(&now.phase), rate(next));
        *counts |= before > 0.0 && after < 0.0;
        if !(*counts && before < 0.0 && after >= 0.0) {
            return;
        }
        let (mut low, mut high) = (T::zero(), step);
        for _ in 0..HALVINGS {
            let middle = (low + high) * T::from_f64(0.5);
            let is_before = rate(&self.step(&now.phase, middle).0) < 0.0;
            *(if is_before { &mut low } else { &mut high }) = middle;
        }
        let value = measure.value(&self.step(&now.phase, high).0).to_f64();
        if measure.extremum.is_beyond(value, now.extremum[0]) {
            now.extremum = [value, (now.time + high).to_f64()];
        }
    }

    /// Makes a step and returns the distance between its last two columns as its error.
    fn step(&self, phase: &Phase<T>, step: T) -> (Phase<T>, f64) {
        let [p1, p2] = self.pendulum.momentum_scale().map(|scale| 1.0 / scale.to_f64());
        let unit = [1.0, 1.0, 1.0, 1.0, p1, p2];
        let mut row: Vec<Phase<T>> = Vec::with_capacity(self.columns);
        let mut error = f64::INFINITY;
        for j in 0..self.columns {
            let mut entry = self.midpoints(phase, step, 2 * (j + 1));
            for (k, row) in row.iter_mut().enumerate() {
                // Extrapolation in h² to zero: (n_j / n_{j−k−1})² − 1 = above / below.
                let (n, m) = ((j + 1) as f64, (j - k) as f64);
                let (above, below) = (T::from_f64(n * n - m * m), T::from_f64(m * m));
                let before = std::mem::replace(row, entry);
                entry = std::array::from_fn(|i| entry[i] + (entry[i] - before[i]) * below / above);
            }
            if j > 0 {
                let off = |i: usize| (entry[i] - row[j - 1][i]).to_f64().abs() * unit[i];
                error = (0..6).map(off).fold(0.0, f64::max);
            }
            row.push(entry);
        }
        (row[self.columns - 1], error)
    }

    /// Gragg's midpoint rule with `count` substeps.
    fn midpoints(&self, phase: &Phase<T>, step: T, count: usize) -> Phase<T> {
        let length = step / T::from_f64(count as f64);
        let twice = length + length;
        let moved = |from: &Phase<T>, rate: &Phase<T>, by: T| -> Phase<T> {
            std::array::from_fn(|i| from[i] + rate[i] * by)
        };
        let mut before = *phase;
        let mut now = moved(phase, &self.pendulum.derivative(phase), length);
        for _ in 1..count {
            let next = moved(&before, &self.pendulum.derivative(&now), twice);
            (before, now) = (now, next);
        }
        let end = moved(&before, &self.pendulum.derivative(&now), length);
        std::array::from_fn(|i| (now[i] + end[i]) * T::from_f64(0.5))
    }

    /// The verdict on all watched bobs in a step.
    fn way(&self, from: &Phase<T>, to: &Phase<T>, step: T) -> TopVerdict {
        let ways = self.bobs.iter().map(|&bob| self.way_of(bob, from, to, step));
        let mut all = TopVerdict::Clear;
        for way in ways {
            // Two crossings in one step are separated by shorter steps.
            all = match (all, way) {
                (TopVerdict::Clear, way) => way,
                (way, TopVerdict::Clear) => way,
                _ => TopVerdict::Unclear,
            };
        }
        all
    }

    fn way_of(&self, bob: usize, from: &Phase<T>, to: &Phase<T>, step: T) -> TopVerdict {
        let ends = [from, to].map(|phase| self.motion(bob, phase));
        let h = step.to_f64();
        let turn = ends.iter().map(|end| end.speed.abs()).fold(0.0, f64::max) * h;
        if turn > 1.0 {
            return TopVerdict::Unclear;
        }
        if ends[0].x > 0.0 && ends[1].x > 0.0 {
            return TopVerdict::Clear;
        }
        let bend = ROOM * ends.iter().map(|end| end.bend.abs()).fold(0.0, f64::max);
        let [y0, y1] = [ends[0].y, ends[1].y];
        if y0 * y1 < 0.0 || y1 == 0.0 {
            // The rate keeps its sign throughout the step.
            let steady = |rate: f64| rate.abs() > bend * h && rate * y0 < 0.0;
            let passes = steady(ends[0].rate) && steady(ends[1].rate);
            let above = ends[0].x < 0.0 && ends[1].x < 0.0;
            return if passes && above { TopVerdict::Passes(bob) } else { TopVerdict::Unclear };
        }
        // A lower bound from each end over half of the step.
        let half = 0.5 * h;
        let least =
            |y: f64, towards: f64| y.abs() - towards.max(0.0) * half - 0.5 * bend * half * half;
        let clear = least(y0, -ends[0].rate * y0.signum()) > 0.0
            && least(y1, ends[1].rate * y1.signum()) > 0.0;
        if clear { TopVerdict::Clear } else { TopVerdict::Unclear }
    }

    fn motion(&self, bob: usize, phase: &Phase<T>) -> BobMotion {
        let [x1, y1, x2, y2, ..] = *phase;
        let speed = self.pendulum.speeds(phase);
        let pull = self.pendulum.acceleration_towards([(y1, x1), (y2, x2)], speed)[bob];
        let (x, y) = (phase[2 * bob], phase[2 * bob + 1]);
        let rate = speed[bob] * x;
        let bend = pull * x - speed[bob] * speed[bob] * y;
        let [x, y, rate, bend, speed] = [x, y, rate, bend, speed[bob]].map(T::to_f64);
        BobMotion { x, y, rate, bend, speed }
    }

    /// Time from the beginning of a step to a bob's crossing of the top.
    fn passage(&self, bob: usize, from: &Phase<T>, step: T) -> Option<T> {
        let (mut low, mut high) = (T::zero(), step);
        let mut at = step * T::from_f64(0.5);
        for _ in 0..400 {
            let (phase, _) = self.step(from, at);
            let begin = from[2 * bob + 1];
            let y = phase[2 * bob + 1];
            if y * begin > T::zero() {
                low = at;
            } else {
                high = at;
            }
            let rate = self.pendulum.speeds(&phase)[bob] * phase[2 * bob];
            let newton = at - y / rate;
            // The error of Newton's method is about the square of its step.
            let near = (newton - at).abs().to_f64() < self.tolerance.sqrt() * step.to_f64();
            if near {
                return Some(newton);
            }
            at = if newton > low && newton < high {
                newton
            } else {
                (low + high) * T::from_f64(0.5)
            };
        }
        None
    }
}

/// A bob at one moment: its unit vector, its sine's first two derivatives, and its speed.
struct BobMotion {
    x: f64,
    y: f64,
    rate: f64,
    bend: f64,
    speed: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_numbers::{Angle, Fixed};
    use flipmap_pendulum::Rule;

    fn flip<T: Scalar + Angle>(angle: [&str; 2], rule: Rule, columns: usize, tolerance: f64) -> T {
        let one = T::from_f64(1.0);
        let pendulum = Pendulum::points([one; 2], [one; 2], one);
        let referee = Referee {
            pendulum,
            extremum: None,
            bobs: rule.watched(),
            passes: 1,
            budget: T::from_f64(60.0),
            columns,
            tolerance,
            give_up: &|| false,
        };
        let [(y1, x1), (y2, x2)] = angle.map(|text| T::parse(text).unwrap().sin_cos());
        let end = referee.end(&[x1, y1, x2, y2, T::zero(), T::zero()]).expect("plain");
        assert!(end.flipped);
        end.time
    }

    #[test]
    fn it_meets_the_exact_targets() {
        let exact = "5.7004778507307246850926008522389852";
        let time: f64 = flip(["2.2", "-1.9"], Rule::Second, 8, 1e-13);
        assert!((time - 5.700_477_850_730_725).abs() < 1e-10, "{time}");
        let time: Fixed<4> = flip(["2.2", "-1.9"], Rule::Second, 14, 1e-36);
        let error = (time - Fixed::parse(exact).unwrap()).to_f64();
        assert!(error.abs() < 1e-31, "{error:e}");
        let first: f64 = flip(["-2", "3"], Rule::Either, 8, 1e-13);
        assert!((first - 1.507_470_599_679_628).abs() < 1e-11, "{first}");
    }
}
