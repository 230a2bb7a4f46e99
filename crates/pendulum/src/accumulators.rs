//! Quantities gathered along a motion that its end alone does not give.

use serde::{Deserialize, Serialize};

/// Quantities gathered along a pendulum's motion; each is filled in only if the question needs it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Accumulators {
    /// Whole turns of each bob since the release, anticlockwise ones positive; only counted where
    /// no bob is watched.
    pub turns: [i32; 2],
    /// Number of passes of the top by each bob anticlockwise and clockwise, the first bob first.
    pub passes: [u32; 4],
    /// The extreme of a quantity along the motion (see [`super::extremum`]), and the reduced time at
    /// which it occurred; the value is infinite if there is none.
    pub extremum: [f64; 2],
    /// Natural logarithm of the factor by which the fastest-growing nudge has grown (see
    /// [`super::tangents`]).
    pub log_growth: f64,
}

impl Accumulators {
    /// The quantities of a pendulum that has not moved.
    pub const NONE: Accumulators = Accumulators {
        turns: [0; 2],
        passes: [0; 4],
        extremum: [f64::INFINITY, 0.0],
        log_growth: 0.0,
    };

    /// Returns true if the extremes and the growth of another run are the same, to the
    /// accuracy that answers need. Turns and passes are not compared: they agree if the states do.
    pub fn agrees_with(&self, other: &Accumulators) -> bool {
        let near = |i: usize, allowed: f64| {
            let (mine, its) = (self.extremum[i], other.extremum[i]);
            // Equal infinities are equal.
            mine == its || (mine - its).abs() <= allowed
        };
        let apart = (self.log_growth - other.log_growth).abs();
        near(0, EXTREMUM) && near(1, EXTREMUM) && apart <= GROWTH * self.log_growth.abs()
    }
}

/// Greatest difference at which two extremes, or their reduced times, still agree.
const EXTREMUM: f64 = 1e-3;
/// Greatest relative difference at which two logarithms of growth still agree.
const GROWTH: f64 = 0.01;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_agree_within_what_answers_may_be_wrong_by() {
        let one = Accumulators { extremum: [0.2, 3.0], log_growth: 4.0, ..Accumulators::NONE };
        assert!(one.agrees_with(&one) && Accumulators::NONE.agrees_with(&Accumulators::NONE));
        assert!(one.agrees_with(&Accumulators { extremum: [0.2005, 3.0004], ..one }));
        assert!(!one.agrees_with(&Accumulators { extremum: [0.21, 3.0], ..one }));
        assert!(!one.agrees_with(&Accumulators { extremum: [f64::INFINITY, 0.0], ..one }));
        assert!(one.agrees_with(&Accumulators { log_growth: 4.03, ..one }));
        assert!(!one.agrees_with(&Accumulators { log_growth: 4.1, ..one }));
    }
}
