//! Finds the extremes of a quantity along an orbit, on its Taylor expansions.

use super::trace_channels::reduced_phase;
use flipmap_numbers::Dd;
use flipmap_pendulum::State;
use flipmap_pendulum::extremum::Measure;
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::taylor::TaylorStep;

/// Number of parts of a step in which an extreme is looked for.
const PARTS: usize = 16;
/// Number of halvings that find an extreme to the last digits of f64.
const HALVINGS: u32 = 50;

/// A search for the extremes of a quantity along an orbit.
pub(super) struct ExtremumSearch {
    measure: Measure<f64>,
    unit_secs: f64,
    /// Times (s) of the extremes, and their values.
    found: Vec<[f64; 2]>,
}

impl ExtremumSearch {
    /// Begins a search. The pendulum of the measure is in reduced units; `unit_secs` is its unit of
    /// time in s.
    pub(super) fn new(measure: Measure<f64>, unit_secs: f64) -> Self {
        ExtremumSearch { measure, unit_secs, found: Vec::new() }
    }

    /// Looks for extremes in the next step of the orbit.
    pub(super) fn add(&mut self, step: &TaylorStep<Dd>) {
        let length = (step.end() - step.start).hi;
        let at = |part: usize| length * part as f64 / PARTS as f64;
        let phase = |tau: f64| self.phase(&step.state(Dd::new(tau)));
        let rate = |tau: f64| self.measure.rate(&phase(tau));
        let rates: Vec<f64> = (0..=PARTS).map(|part| rate(at(part))).collect();
        let turns = (0..PARTS).filter(|&part| rates[part] < 0.0 && rates[part + 1] >= 0.0);
        let extreme = |part| {
            let (mut low, mut high) = (at(part), at(part + 1));
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if rate(middle) < 0.0 { low = middle } else { high = middle }
            }
            [step.start.hi + high, self.measure.value(&phase(high))]
        };
        let found: Vec<[f64; 2]> = turns.map(extreme).collect();
        self.found.extend(found);
    }

    /// Returns the extreme up to `secs`, at which the orbit is in a state, and its time in s; NaN
    /// where there is none yet.
    pub(super) fn until(&self, secs: f64, state: &State<Dd>) -> [f64; 2] {
        let kind = self.measure.extremum;
        let mut best = self.measure.begun();
        for &[time, value] in self.found.iter().filter(|[time, _]| *time <= secs) {
            if kind.is_beyond(value, best[0]) {
                best = [value, time];
            }
        }
        let [value, time] = self.measure.ended(best, (&self.phase(state), secs));
        let [in_si, _] = kind.in_si([value, time], self.unit_secs);
        if value.is_finite() { [in_si, time] } else { [f64::NAN; 2] }
    }

    fn phase(&self, state: &State<Dd>) -> Phase<f64> {
        reduced_phase(&self.measure.pendulum, self.unit_secs, state)
    }
}
