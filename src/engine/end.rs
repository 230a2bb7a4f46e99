//! The states in which integrations end.

use crate::physics::crossing;
use crate::physics::phase::Phase;

/// The state in which a pendulum's integration ended: at its flip, or at the end of the budget;
/// reduced units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// Time since the release.
    pub time: f64,
    /// Unit vectors along the rods, and momenta.
    pub phase: Phase<f64>,
    /// Lower bound on the distance from the top (as a sine) at which a watched bob turned round
    /// before; [`crossing::FAR`] for methods that cannot tell.
    pub clearance: f64,
    /// Factor by which neighbours had moved apart between the release and the beginning of the
    /// start's own integration: 1 where that began at rest, infinite where none was needed.
    pub grown: f64,
    /// Whole turns of each bob since the release, anticlockwise ones positive; only counted where
    /// no bob is watched.
    pub turns: [i32; 2],
    /// Number of passes of the top by each bob anticlockwise and clockwise, the first bob first.
    pub passes: [u32; 4],
    /// Least distance from the start after having left it, as unit vectors and scaled momenta, and
    /// its time in s; infinite unless [`super::Keep::Return`] asked for it.
    pub nearest: [f64; 2],
    /// Natural logarithm of the growth of the largest of all nudges (see
    /// [`crate::physics::tangents`]); 0 unless [`super::Keep::Growth`] asked for it.
    pub log_growth: f64,
}

impl End {
    /// The end of a pendulum that has not moved.
    pub const NOWHERE: End = End {
        time: 0.0,
        phase: [0.0; 6],
        clearance: crossing::FAR,
        grown: 1.0,
        turns: [0; 2],
        passes: [0; 4],
        nearest: [f64::INFINITY, 0.0],
        log_growth: 0.0,
    };
}
