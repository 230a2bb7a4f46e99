//! How long the next step may be, and how large an error may grow.
//!
//! An error made at time t is amplified only by the growth from t to the flip, so early errors
//! cost most. The tolerance therefore rises from the release on, at two thirds of the rate at
//! which the most chaotic starts of the home map grow (0.3 decades a second), and stops where it
//! would reach the regular starts, which do not grow: at the power 2/3 of what it began with.
//!
//! Everything is kept in binary logarithms of squares, because that is what lanes and shaders
//! have at hand.

/// The numbers of a step-size control, in reduced time units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// log₂ of the squared tolerance at the release.
    pub start: f64,
    /// What is added to it in a unit of time.
    pub rise: f64,
    /// Where that ends.
    pub ceiling: f64,
    /// The step's factor is 2^(exponent · excess + safety), clamped to [`SHRINK`] and [`GROW`].
    pub exponent: f64,
    /// See there.
    pub safety: f64,
}

/// Least and greatest factor from one step to the next.
pub const SHRINK: f64 = 0.2;
/// See [`SHRINK`].
pub const GROW: f64 = 5.0;
/// Steps are at most this long, so that a bob turns by far less than half a turn in one.
pub const LONGEST: f64 = 1.0;
/// The first step that is tried. A bob at rest has no speed whose change of sign could show that
/// it rose over the top and fell back within its first step, as it can by at most FIRST⁴/8 rad
/// (near (π/2, π), where its acceleration changes sign); so this is below what f64 can tell.
pub const FIRST: f64 = 2e-3;

/// 0.2 decades a second for the default pendulum.
const DECADES_PER_UNIT: f64 = 0.2 * 0.319_275_428_5;
/// Chosen by measurement: with 0.9 one step in six is computed in vain, with this one in fifty.
const SAFETY: f64 = 0.75;

impl Control {
    /// For a method whose error falls as step^`order`.
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

    /// For pendulums that begin where the way of a whole cell ended: all that could grow has
    /// grown by then, so that the tolerance no longer rises; and what tells neighbours apart is
    /// smaller than the cell, so that it is so many times `finer` than where it would end.
    pub fn after_a_cell(self, finer: f64) -> Self {
        let ceiling = self.ceiling - 2.0 * finer.log2();
        Control { start: ceiling, rise: 0.0, ceiling, ..self }
    }

    /// The same with one tolerance all the time.
    pub fn steady(self) -> Self {
        Control { rise: 0.0, ceiling: self.start, ..self }
    }

    /// log₂ of the squared tolerance at `time`.
    pub fn limit(&self, time: f64) -> f64 {
        (self.start + self.rise * time).min(self.ceiling)
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
}
