//! Extremes of a quantity along a motion.
//!
//! An extreme lies in a step in which the quantity stops falling or rising: its rate of change
//! changes sign. It is found by shorter steps from the same beginning, like a pass of the top.
//! Engines know only the square of the quantity and the rate of change of that square.

use crate::Pendulum;
use crate::phase::Phase;
use flipmap_numbers::dual::Dual;
use flipmap_numbers::{Real, Scalar};

/// A quantity whose extreme along the motion is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Extremum {
    /// The least distance from the start, in unit vectors and scaled momenta, after the motion has
    /// left it.
    NearestReturn,
    /// The greatest speed of the second bob, or of the end of the second bar, in m per unit of time.
    GreatestSpeed,
}

impl Extremum {
    /// Returns true if the quantity is at its extreme where it is greatest, false if where it is
    /// least.
    pub const fn is_greatest(self) -> bool {
        match self {
            Extremum::NearestReturn => false,
            Extremum::GreatestSpeed => true,
        }
    }

    /// Returns true if extremes count from the release on, false if they count once the rate of
    /// change has changed its sign the other way.
    pub const fn counts_from_release(self) -> bool {
        match self {
            Extremum::NearestReturn => false,
            Extremum::GreatestSpeed => true,
        }
    }

    /// Returns an extreme and its time in SI units, from reduced ones; `unit_secs` is the unit of time
    /// in s.
    pub fn in_si(self, [value, time]: [f64; 2], unit_secs: f64) -> [f64; 2] {
        match self {
            Extremum::NearestReturn => [value, time * unit_secs],
            Extremum::GreatestSpeed => [value / unit_secs, time * unit_secs],
        }
    }

    /// Returns true if `value` is a more extreme one than `other`.
    pub fn is_beyond(self, value: f64, other: f64) -> bool {
        if self.is_greatest() { value > other } else { value < other }
    }
}

/// A quantity of a pendulum that began at a start.
#[derive(Clone, Copy, Debug)]
pub struct Measure<T> {
    /// The quantity.
    pub extremum: Extremum,
    /// The pendulum.
    pub pendulum: Pendulum<T>,
    /// 1 over the scale of each momentum.
    pub inverse_scale: [T; 2],
    /// The phase at the start.
    pub start: Phase<T>,
}

// Sums are written out, because closures are not compiled for the registers of SIMD lanes.
impl<T: Real> Measure<T> {
    /// Returns the square of the quantity.
    #[inline(always)]
    pub fn square(&self, phase: &Phase<T>) -> T {
        match self.extremum {
            Extremum::NearestReturn => {
                let first = self.apart(phase, 0);
                let mut sum = first * first;
                for i in 1..6 {
                    let apart = self.apart(phase, i);
                    sum = sum + apart * apart;
                }
                sum
            }
            Extremum::GreatestSpeed => {
                let [x1, y1, x2, y2, ..] = *phase;
                let ([l1, l2], [w1, w2]) = (self.pendulum.lengths, self.pendulum.speeds(phase));
                let across = [l1 * w1 * x1 + l2 * w2 * x2, l1 * w1 * y1 + l2 * w2 * y2];
                across[0] * across[0] + across[1] * across[1]
            }
        }
    }

    /// Returns half the rate of change of the square; its sign is turned where the greatest value
    /// is looked for, so that it grows from negative to positive in every extreme.
    #[inline(always)]
    pub fn rate(&self, phase: &Phase<T>) -> T {
        match self.extremum {
            Extremum::NearestReturn => {
                let rate = self.pendulum.derivative(phase);
                let mut sum = self.drift(phase, &rate, 0);
                for i in 1..6 {
                    sum = sum + self.drift(phase, &rate, i);
                }
                sum
            }
            Extremum::GreatestSpeed => -self.slope(phase),
        }
    }

    /// Returns half the rate of change of the square, by automatic differentiation.
    #[inline(always)]
    pub fn slope(&self, phase: &Phase<T>) -> T {
        let rate = self.pendulum.derivative(phase);
        let mut moving = constants(phase);
        for i in 0..6 {
            moving[i].slope = [rate[i]];
        }
        let [first, second] = self.inverse_scale;
        let measure = Measure {
            extremum: self.extremum,
            pendulum: self.pendulum.map(Dual::<1, T>::new),
            inverse_scale: [Dual::new(first), Dual::new(second)],
            start: constants(&self.start),
        };
        let [slope] = measure.square(&moving).slope;
        slope * slope.lit(0.5)
    }

    /// The distance from the start along a number of the phase, in units of its scale.
    #[inline(always)]
    fn apart(&self, phase: &Phase<T>, i: usize) -> T {
        (phase[i] - self.start[i]) * self.unit(i)
    }

    /// Half the rate at which the square of that distance changes.
    #[inline(always)]
    fn drift(&self, phase: &Phase<T>, rate: &Phase<T>, i: usize) -> T {
        (phase[i] - self.start[i]) * rate[i] * (self.unit(i) * self.unit(i))
    }

    /// 1 over the scale of a number of the phase.
    #[inline(always)]
    fn unit(&self, i: usize) -> T {
        if i < 4 { self.inverse_scale[0].lit(1.0) } else { self.inverse_scale[i - 4] }
    }
}

/// A phase that does not move.
#[inline(always)]
fn constants<T: Real>([x1, y1, x2, y2, p1, p2]: &Phase<T>) -> Phase<Dual<1, T>> {
    [Dual::new(*x1), Dual::new(*y1), Dual::new(*x2), Dual::new(*y2), Dual::new(*p1), Dual::new(*p2)]
}

impl<T: Scalar> Measure<T> {
    /// Creates the measure of a pendulum that began at `start`.
    pub fn new(extremum: Extremum, pendulum: Pendulum<T>, start: Phase<T>) -> Self {
        let inverse_scale = pendulum.momentum_scale().map(|scale| T::from_f64(1.0) / scale);
        Measure { extremum, pendulum, inverse_scale, start }
    }

    /// Returns the quantity.
    pub fn value(&self, phase: &Phase<T>) -> T {
        self.square(phase).sqrt()
    }

    /// The nearest measure in f64.
    pub fn to_f64(&self) -> Measure<f64> {
        Measure {
            extremum: self.extremum,
            pendulum: self.pendulum.to_f64(),
            inverse_scale: self.inverse_scale.map(T::to_f64),
            start: self.start.map(T::to_f64),
        }
    }
}

impl Measure<f64> {
    /// Returns the extreme of a motion that has only begun, and its time; the value is infinite if
    /// there is none yet.
    pub fn begun(&self) -> [f64; 2] {
        match self.extremum {
            Extremum::NearestReturn => [f64::INFINITY, 0.0],
            Extremum::GreatestSpeed => [self.value(&self.start), 0.0],
        }
    }

    /// Returns the extreme of a motion that has ended in `phase` at `time`, and its time, from the
    /// extreme `best` before its end.
    pub fn ended(&self, best: [f64; 2], (phase, time): (&Phase<f64>, f64)) -> [f64; 2] {
        match self.extremum {
            // At its end the motion may still be coming nearer.
            Extremum::NearestReturn => best,
            Extremum::GreatestSpeed => {
                let last = self.value(phase);
                if self.extremum.is_beyond(last, best[0]) { [last, time] } else { best }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::State;
    use crate::taylor::Orbit;

    const ALL: [Extremum; 2] = [Extremum::NearestReturn, Extremum::GreatestSpeed];

    fn pendulum() -> Pendulum<f64> {
        Pendulum::rods([1.0, 2.0], [1.0, 0.6], 9.81)
    }

    #[test]
    fn the_rate_is_that_of_the_square() {
        let start = State { angle: [1.0, 2.5], speed: [0.5, -1.5] };
        let mut orbit = Orbit::new(pendulum(), start);
        for kind in ALL {
            let measure = Measure::new(kind, pendulum(), pendulum().phase(&start));
            let sign = if kind.is_greatest() { -1.0 } else { 1.0 };
            let step = orbit.step();
            let at = |tau: f64| pendulum().phase(&step.state(tau));
            let (tau, by) = (0.4 * (step.end() - step.start), 1e-5);
            let slope =
                (measure.square(&at(tau + by)) - measure.square(&at(tau - by))) / (4.0 * by);
            let rate = measure.rate(&at(tau));
            assert!((sign * rate / slope - 1.0).abs() < 1e-6, "{kind:?}: {rate} {slope}");
            assert!((measure.slope(&at(tau)) / (sign * rate) - 1.0).abs() < 1e-12, "{kind:?}");
            assert_eq!(measure.to_f64().value(&at(tau)), measure.square(&at(tau)).sqrt());
        }
    }

    #[test]
    fn the_speed_of_the_second_bob_is_that_of_its_place() {
        let [l1, l2] = [1.0, 0.6];
        let state = State { angle: [0.7, -2.0], speed: [3.0, -5.0] };
        let way = |angle: [f64; 2]| {
            [l1 * angle[0].sin() + l2 * angle[1].sin(), l1 * angle[0].cos() + l2 * angle[1].cos()]
        };
        let by = 1e-6;
        let moved = |by: f64| way([0, 1].map(|i| state.angle[i] + state.speed[i] * by));
        let (ahead, behind) = (moved(by), moved(-by));
        let speed = (ahead[0] - behind[0]).hypot(ahead[1] - behind[1]) / (2.0 * by);
        let phase = pendulum().phase(&state);
        let measure = Measure::new(Extremum::GreatestSpeed, pendulum(), phase);
        assert!((measure.value(&phase) / speed - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_ends_of_a_motion_count_for_speeds_alone() {
        let at = |speed: f64| pendulum().phase(&State { angle: [0.1, 0.2], speed: [speed, 0.0] });
        let (slow, fast) = (at(0.1), at(4.0));
        let ends = |kind, start, end| {
            let measure = Measure::new(kind, pendulum(), start);
            let begun = measure.begun();
            let best = if begun[0] < 1.0 { [1.0, 2.0] } else { begun };
            measure.ended(best, (&end, 9.0)).map(|number| (number * 1e9).round() / 1e9)
        };
        assert_eq!(ends(Extremum::NearestReturn, fast, fast), [f64::INFINITY, 0.0]);
        assert_eq!(ends(Extremum::GreatestSpeed, slow, slow), [1.0, 2.0]);
        assert_eq!(ends(Extremum::GreatestSpeed, slow, fast), [4.0, 9.0]);
        assert_eq!(ends(Extremum::GreatestSpeed, fast, slow), [4.0, 0.0]);
    }
}
