//! Finds the times at which an orbit comes nearest to its start, on its Taylor expansions.

use super::trace_channels::reduced_phase;
use flipmap_numbers::Dd;
use flipmap_pendulum::Pendulum;
use flipmap_pendulum::phase::{Phase, distance};
use flipmap_pendulum::taylor::TaylorStep;

/// Number of parts of a step in which a minimum of the distance is looked for.
const PARTS: u32 = 16;
/// Number of halvings that find a minimum to the last digits of f64.
const HALVINGS: u32 = 50;

/// A search for the returns of an orbit to its start.
pub(super) struct ReturnSearch {
    pendulum: Pendulum<f64>,
    unit_secs: f64,
    start: Phase<f64>,
    /// Times (s) of the minima of the distance after the orbit has left its start, and the
    /// distances.
    minima: Vec<[f64; 2]>,
}

impl ReturnSearch {
    /// Begins a search for returns to `start`. The pendulum is in reduced units; `unit_secs` is its
    /// unit of time in s.
    pub(super) fn new(pendulum: Pendulum<f64>, unit_secs: f64, start: Phase<f64>) -> Self {
        ReturnSearch { pendulum, unit_secs, start, minima: Vec::new() }
    }

    /// Looks for minima in the next step of the orbit.
    pub(super) fn add(&mut self, step: &TaylorStep<Dd>) {
        let length = (step.end() - step.start).hi;
        let at = |part: u32| length * f64::from(part) / f64::from(PARTS);
        for part in 0..PARTS {
            let (mut low, mut high) = (at(part), at(part + 1));
            if !(self.receding(step, low) < 0.0 && self.receding(step, high) >= 0.0) {
                continue;
            }
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if self.receding(step, middle) < 0.0 { low = middle } else { high = middle }
            }
            let apart = distance(&self.phase(step, high), &self.start, self.inverse_scale());
            self.minima.push([step.start.hi + high, apart]);
        }
    }

    /// Returns the distance of the nearest return up to `secs` and its time in s; NaN before the
    /// first.
    pub(super) fn nearest(&self, secs: f64) -> [f64; 2] {
        let so_far = self.minima.iter().filter(|[time, _]| *time <= secs);
        let nearest = so_far.min_by(|a, b| a[1].total_cmp(&b[1]));
        nearest.map_or([f64::NAN; 2], |[time, apart]| [*apart, *time])
    }

    fn phase(&self, step: &TaylorStep<Dd>, tau: f64) -> Phase<f64> {
        reduced_phase(&self.pendulum, self.unit_secs, &step.state(Dd::new(tau)))
    }

    fn inverse_scale(&self) -> [f64; 2] {
        self.pendulum.momentum_scale().map(|scale| 1.0 / scale)
    }

    /// Returns half the rate of change of the squared distance.
    fn receding(&self, step: &TaylorStep<Dd>, tau: f64) -> f64 {
        let phase = self.phase(step, tau);
        let rate = self.pendulum.derivative(&phase);
        let [p1, p2] = self.inverse_scale();
        let units = [1.0, 1.0, 1.0, 1.0, p1, p2];
        (0..6).map(|i| (phase[i] - self.start[i]) * rate[i] * units[i] * units[i]).sum()
    }
}
