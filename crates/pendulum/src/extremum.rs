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
}

impl Extremum {
    /// The value and the time of an extreme that has not been found.
    pub const fn none(self) -> [f64; 2] {
        match self {
            Extremum::NearestReturn => [f64::INFINITY, 0.0],
        }
    }

    /// Returns true if the quantity is at its extreme where it is greatest, false if where it is
    /// least.
    pub const fn is_greatest(self) -> bool {
        match self {
            Extremum::NearestReturn => false,
        }
    }

    /// Returns true if extremes count from the release on, false if they count once the rate of
    /// change has changed its sign the other way.
    pub const fn counts_from_release(self) -> bool {
        match self {
            Extremum::NearestReturn => false,
        }
    }

    /// Returns an extreme and its time in SI units, from reduced ones; `unit_secs` is the unit of time
    /// in s.
    pub fn in_si(self, [value, time]: [f64; 2], unit_secs: f64) -> [f64; 2] {
        match self {
            Extremum::NearestReturn => [value, time * unit_secs],
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

impl<T: Real> Measure<T> {
    /// Returns the square of the quantity.
    pub fn square(&self, phase: &Phase<T>) -> T {
        match self.extremum {
            Extremum::NearestReturn => {
                let apart = |i: usize| (phase[i] - self.start[i]) * self.unit(i);
                sum(|i| apart(i) * apart(i))
            }
        }
    }

    /// Returns half the rate of change of the square; its sign is turned where the greatest value
    /// is looked for, so that it grows from negative to positive in every extreme.
    pub fn rate(&self, phase: &Phase<T>) -> T {
        match self.extremum {
            Extremum::NearestReturn => {
                let rate = self.pendulum.derivative(phase);
                let unit = |i: usize| self.unit(i) * self.unit(i);
                sum(|i| (phase[i] - self.start[i]) * rate[i] * unit(i))
            }
        }
    }

    /// Returns half the rate of change of the square, by automatic differentiation.
    pub fn slope(&self, phase: &Phase<T>) -> T {
        let rate = self.pendulum.derivative(phase);
        let moving = |i: usize| Dual { value: phase[i], slope: [rate[i]] };
        let fixed = Dual::<1, T>::new;
        let measure = Measure {
            extremum: self.extremum,
            pendulum: self.pendulum.map(fixed),
            inverse_scale: self.inverse_scale.map(fixed),
            start: self.start.map(fixed),
        };
        let [slope] = measure.square(&std::array::from_fn(moving)).slope;
        slope * slope.lit(0.5)
    }

    /// 1 over the scale of a number of the phase.
    fn unit(&self, i: usize) -> T {
        if i < 4 { self.inverse_scale[0].lit(1.0) } else { self.inverse_scale[i - 4] }
    }
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
}

impl<T: Scalar> Measure<T> {
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
    /// Returns the extreme, and the time at which it occurred, of a motion that has ended in
    /// `phase` at `time`, from the extreme `best` inside it.
    pub fn with_ends(&self, best: [f64; 2], (_phase, _time): (&Phase<f64>, f64)) -> [f64; 2] {
        match self.extremum {
            Extremum::NearestReturn => best,
        }
    }
}

/// The sum over the numbers of a phase.
fn sum<T: Real>(part: impl Fn(usize) -> T) -> T {
    (1..6).fold(part(0), |sum, i| sum + part(i))
}
