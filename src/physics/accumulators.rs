//! Quantities gathered along a motion, which its end alone does not tell.

/// Quantities gathered along a pendulum's motion, where they were asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accumulators {
    /// Whole turns of each bob since the release, anticlockwise ones positive; only counted where
    /// no bob is watched.
    pub turns: [i32; 2],
    /// Number of passes of the top by each bob anticlockwise and clockwise, the first bob first.
    pub passes: [u32; 4],
    /// Least distance from the start after having left it, as unit vectors and scaled momenta, and
    /// its reduced time; infinite if there is none.
    pub nearest: [f64; 2],
    /// Natural logarithm of the growth of the largest of all nudges (see [`super::tangents`]).
    pub log_growth: f64,
}

impl Accumulators {
    /// Those of a pendulum that has not moved.
    pub const NONE: Accumulators = Accumulators {
        turns: [0; 2],
        passes: [0; 4],
        nearest: [f64::INFINITY, 0.0],
        log_growth: 0.0,
    };
}
