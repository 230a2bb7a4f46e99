//! The separation of two pendulums, and the rate at which it grows.
//!
//! The distance is taken in phase space: √(Δθ1² + Δθ2² + (Δω1² + Δω2²) T²), in rad, with angle
//! differences taken the short way round and T = √(C/Q), the pendulum's natural unit of time
//! (√(l1/g) for points). It therefore does not depend on the unit of time.

use crate::{Pendulum, State};
use flipmap_numbers::Dd;

/// A measure of the distance between two states.
#[derive(Clone, Copy, Debug)]
pub struct Ruler {
    /// The unit of time T of the module's documentation, in s.
    unit_secs: f64,
}

impl Ruler {
    /// The ruler for the states of `pendulum`.
    pub fn new(pendulum: &Pendulum<f64>) -> Self {
        let unit_secs = natural_secs(pendulum);
        Ruler { unit_secs }
    }

    /// The distance between two states in rad.
    pub fn distance(&self, a: &State<Dd>, b: &State<Dd>) -> f64 {
        let angle = [0, 1].map(|i| (a.angle[i] - b.angle[i]).wrapped().hi);
        let speed = [0, 1].map(|i| (a.speed[i] - b.speed[i]).hi * self.unit_secs);
        angle[0].hypot(angle[1]).hypot(speed[0].hypot(speed[1]))
    }
}

/// The natural unit of time of a pendulum, √(C/Q), in s; 1 if nothing moves.
pub fn natural_secs(pendulum: &Pendulum<f64>) -> f64 {
    if pendulum.q > 0.0 { pendulum.reduced().1 } else { 1.0 }
}

/// A reading taken at the end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Time since the release in s.
    pub secs: f64,
    /// Change of the energy relative to P + Q.
    pub energy_error: f64,
    /// Distance of the pendulum from its ghost in rad.
    pub separation_rad: f64,
}

/// Distance in rad beyond which the two pendulums move independently of each other.
pub const SATURATED_RAD: f64 = 0.1;

/// Exponential growth: separation ≈ `at_release_rad` · exp(`rate_per_sec` · t), until it saturates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// Growth rate: the logarithm of the growth factor per second.
    pub rate_per_sec: f64,
    /// One standard error of the rate. Neighbouring readings have similar errors, so they count as
    /// fewer readings.
    pub uncertainty_per_sec: f64,
    /// Value of the fitted line at time 0, in rad.
    pub at_release_rad: f64,
    /// Time up to which the line was fitted, in s.
    pub until_secs: f64,
}

/// Minimum number of readings for a fit.
const MIN_READINGS: usize = 8;

impl Growth {
    /// Fits the least-squares line through the logarithms of the readings, up to the first that is
    /// saturated; `None` if that comes too soon, or if nothing separates.
    pub fn fit(readings: &[Reading]) -> Option<Growth> {
        let count = readings.iter().position(|reading| reading.separation_rad >= SATURATED_RAD);
        let readings = &readings[..count.unwrap_or(readings.len())];
        if readings.len() < MIN_READINGS || readings.iter().any(|r| r.separation_rad <= 0.0) {
            return None;
        }
        let points = || readings.iter().map(|r| (r.secs, r.separation_rad.ln()));
        let count = readings.len() as f64;
        let mean_secs = points().map(|(secs, _)| secs).sum::<f64>() / count;
        let mean_log = points().map(|(_, log)| log).sum::<f64>() / count;
        let along = points().map(|(secs, log)| (secs - mean_secs) * (log - mean_log)).sum::<f64>();
        let spread = points().map(|(secs, _)| (secs - mean_secs).powi(2)).sum::<f64>();
        let rate_per_sec = along / spread;
        let off: Vec<f64> =
            points().map(|(t, log)| log - mean_log - rate_per_sec * (t - mean_secs)).collect();
        Some(Growth {
            rate_per_sec,
            uncertainty_per_sec: (variance(&off) / spread).sqrt(),
            at_release_rad: (mean_log - rate_per_sec * mean_secs).exp(),
            until_secs: readings.last()?.secs,
        })
    }

    /// The separation on the fitted line at `secs`, in rad.
    pub fn separation_rad(&self, secs: f64) -> f64 {
        self.at_release_rad * (self.rate_per_sec * secs).exp()
    }
}

/// The variance of the residuals of a fitted line, times the number of readings in a row whose
/// errors are alike (from their first autocorrelation).
fn variance(off: &[f64]) -> f64 {
    let squares: f64 = off.iter().map(|x| x * x).sum();
    if squares == 0.0 {
        return 0.0;
    }
    let pairs: f64 = off.windows(2).map(|pair| pair[0] * pair[1]).sum();
    let alike = (pairs / squares).clamp(0.0, 0.999);
    squares / (off.len() as f64 - 2.0) * (1.0 + alike) / (1.0 - alike)
}

/// The latest reading at or before `secs`.
pub fn reading_at(readings: &[Reading], secs: f64) -> Option<&Reading> {
    let after = readings.partition_point(|reading| reading.secs <= secs);
    readings.get(after.checked_sub(1)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn growing(rate: f64, from: f64) -> Vec<Reading> {
        let at = |i: i32| f64::from(i) * 0.1;
        let separation_rad = |i| from * (rate * at(i)).exp();
        (0..200)
            .map(|i| Reading { secs: at(i), energy_error: 0.0, separation_rad: separation_rad(i) })
            .collect()
    }

    #[test]
    fn a_known_rate_is_found_before_saturation() {
        let mut readings = growing(1.5, 1e-6);
        for reading in readings.iter_mut().filter(|r| r.separation_rad > SATURATED_RAD) {
            reading.separation_rad = 3.0;
        }
        let growth = Growth::fit(&readings).unwrap();
        assert!((growth.rate_per_sec - 1.5).abs() < 1e-9, "{growth:?}");
        assert!((growth.at_release_rad / 1e-6 - 1.0).abs() < 1e-9);
        assert!((growth.until_secs - (1e5f64.ln() / 1.5)).abs() < 0.1);
    }

    #[test]
    fn what_never_separates_or_is_far_apart_at_once_has_no_rate() {
        assert_eq!(Growth::fit(&growing(0.0, 0.0)), None);
        assert_eq!(Growth::fit(&growing(1.0, 0.2)), None);
        assert_eq!(Growth::fit(&[]), None);
    }

    #[test]
    fn the_ruler_takes_the_short_way_round_and_natural_units() {
        let ruler = Ruler::new(&Pendulum::points([1.0; 2], [1.0; 2], 4.0));
        let state = |angle: [f64; 2], speed: [f64; 2]| State {
            angle: angle.map(Dd::new),
            speed: speed.map(Dd::new),
        };
        let left = state([3.1, 0.0], [0.0, 2.0]);
        let right = state([3.1 - std::f64::consts::TAU, 0.0], [0.0, 0.0]);
        assert!((ruler.distance(&left, &right) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn distances_below_the_digits_of_f64_are_seen() {
        let ruler = Ruler::new(&Pendulum::points([1.0; 2], [1.0; 2], 9.81));
        let near = State::rest([Dd::new(2.2), Dd::new(1.4)]);
        let far = State::rest([Dd::new(2.2) + Dd::new(1e-25), Dd::new(1.4)]);
        assert!((ruler.distance(&near, &far) / 1e-25 - 1.0).abs() < 1e-5);
    }

    #[test]
    fn readings_are_found_by_time() {
        let readings = growing(1.0, 1e-6);
        assert_eq!(reading_at(&readings, 0.55).unwrap().secs, 0.5);
        assert_eq!(reading_at(&readings, 1e9), readings.last());
        assert_eq!(reading_at(&readings, -1.0), None);
    }
}
