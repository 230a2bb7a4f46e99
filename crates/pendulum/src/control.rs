//! Step size control: the length of the next step, and how large an error may grow.
//!
//! An error made at time t is amplified only by the growth from t to the flip, so early errors cost
//! most. The tolerance therefore rises from the release on, at two thirds of the rate at which
//! errors grow for the most chaotic starts of the home map (0.3 decades per second), and stops
//! where it would begin to show in the regular starts, whose errors do not grow: at the power 2/3
//! of its initial value.
//!
//! Everything is kept in binary logarithms of squares, because these are cheap in lanes and
//! shaders.

/// The parameters of step size control, in reduced time units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// Binary logarithm of the squared tolerance at the release.
    pub start: f64,
    /// Increase of that logarithm per unit of time.
    pub rise: f64,
    /// Upper limit of that logarithm.
    pub ceiling: f64,
    /// Exponent in the factor from a step to the next, 2^(exponent · excess + safety), which is
    /// kept within [`SHRINK`] and [`GROW`].
    pub exponent: f64,
    /// Binary logarithm of the safety factor.
    pub safety: f64,
}

/// Smallest allowed ratio of a step to the one before.
pub const SHRINK: f64 = 0.2;
/// Largest allowed ratio of a step to the one before.
pub const GROW: f64 = 5.0;
/// Maximum length of a step, so that a bob turns by far less than half a turn in one.
pub const MAX_STEP: f64 = 1.0;
/// Length of the first trial step. A bob released from rest may rise over the top and fall back
/// within this step, and no change of sign of its speed shows it. It rises at most FIRST⁴/8 rad
/// beyond the top (near (π/2, π), where its acceleration changes sign); the step is short to keep
/// that negligible.
pub const FIRST: f64 = 2e-3;

/// Rise of the tolerance per unit of time: 0.2 decades per second for the default pendulum.
const DECADES_PER_UNIT: f64 = 0.2 * 0.319_275_428_5;
/// Reduced time before the end of a budget that counts as near it: 18 s for the default pendulum.
const NEAR: f64 = 18.0 / 0.319_275_428_5;
/// Rise of the tolerance near the end of a budget, as a multiple of the usual one. With this and
/// [`NEAR`], 115,200 pixels of six deep views agreed with those of the usual tolerance to within
/// 0.5 ms, and `trench`, `abyss` and `seabed` take 0.61 to 0.68 of the right-hand sides.
const NEAR_END: f64 = 1.5;
/// Safety factor, found by measurement: with 0.9, one step in six is wasted; with this value, one
/// in fifty.
const SAFETY: f64 = 0.75;

impl Control {
    /// The control for a method whose error falls as step^`order`.
    pub fn new(tolerance: f64, order: u32) -> Self {
        let start = 2.0 * tolerance.log2();
        Control {
            start,
            rise: 2.0 * DECADES_PER_UNIT * std::f64::consts::LOG2_10,
            ceiling: start * 2.0 / 3.0,
            exponent: -0.5 / f64::from(order),
            safety: SAFETY.log2(),
        }
    }

    /// The control for pendulums that begin at the time `since`, where the path of a whole cell
    /// ended. Differences between neighbours are smaller than the cell then, so the tolerance is
    /// `finer` times smaller than its ceiling. It rises from there as it does after the release.
    ///
    /// If the `end` of the budget is given and near, the tolerance is that small at the time
    /// [`NEAR`] before `end` instead, and rises as fast as most errors grow.
    pub fn after_a_cell(self, since: f64, end: Option<f64>, finer: f64) -> Self {
        let (since, rise) = match end {
            Some(end) if end - since < NEAR => (end - NEAR, self.rise * NEAR_END),
            _ => (since, self.rise),
        };
        Control { start: self.ceiling - 2.0 * finer.log2() - rise * since, rise, ..self }
    }

    /// The same control with a constant tolerance.
    pub fn steady(self) -> Self {
        Control { rise: 0.0, ceiling: self.start, ..self }
    }

    /// Binary logarithm of the squared tolerance at `time`.
    pub fn limit(&self, time: f64) -> f64 {
        (self.start + self.rise * time).min(self.ceiling)
    }

    /// The factor from the length of a step to that of the next; `excess` is the binary logarithm
    /// of its squared error less the limit.
    pub fn factor(&self, excess: f64) -> f64 {
        (self.exponent * excess + self.safety).clamp(-8.0, 8.0).exp2().clamp(SHRINK, GROW)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tolerance_rises_and_stops() {
        let control = Control::new(1e-12, 8);
        let decades = |time| control.limit(time) / 2.0 / std::f64::consts::LOG2_10;
        assert!((decades(0.0) + 12.0).abs() < 1e-12);
        let five_secs = 5.0 * 9.81f64.sqrt();
        assert!((decades(five_secs) + 11.0).abs() < 1e-6);
        assert!((decades(1e6) + 8.0).abs() < 1e-12);
    }

    #[test]
    fn near_the_end_of_a_budget_the_time_left_decides() {
        let control = Control::new(1e-12, 8);
        let at = |since: f64, end: Option<f64>, time: f64| {
            let limit = control.after_a_cell(since, end, 1e4).limit(time);
            limit / 2.0 / std::f64::consts::LOG2_10
        };
        let secs = 9.81f64.sqrt();
        assert!((at(40.0, None, 40.0) + 12.0).abs() < 1e-9, "1e4 below the ceiling of 1e-8");
        let far = Some(40.0 + 18.1 * secs);
        assert_eq!(at(40.0, far, 50.0), at(40.0, None, 50.0), "the end is far");
        let end = Some(40.0 + 8.0 * secs);
        assert!((at(40.0, end, 40.0) + 12.0 - 3.0).abs() < 1e-3, "10 s after it became near");
        assert_eq!(at(40.0, end, 44.0), at(42.0, end, 44.0), "whenever they set out");
        assert!((at(40.0, end, 60.0) + 8.0).abs() < 1e-9);
    }
}
