//! The states in which integrations end.

use flipmap_pendulum::Accumulators;
use flipmap_pendulum::crossing;
use flipmap_pendulum::phase::Phase;

/// The state in which a pendulum's integration ended: at its flip, or at the end of the budget;
/// reduced units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinalState {
    /// Time since the release.
    pub time: f64,
    /// Unit vectors along the rods, and momenta.
    pub phase: Phase<f64>,
    /// Lower bound on the distance from the top (as a sine) at which a watched bob has turned round
    /// before the end; [`crossing::FAR`] for methods that cannot tell.
    pub clearance: f64,
    /// Factor by which neighbours had moved apart between the release and the beginning of the
    /// start's own integration: 1 if the integration began at rest, infinite if none was needed.
    pub grown: f64,
    /// Truncation error of the start map that gave the answer or the state from which the start was
    /// integrated, expressed as an error of the release in rad; 0 without a start map.
    pub map_error: f64,
    /// Quantities gathered since the release.
    pub gathered: Accumulators,
}

impl FinalState {
    /// The end of a pendulum that has not moved.
    pub const NOWHERE: FinalState = FinalState {
        time: 0.0,
        phase: [0.0; 6],
        clearance: crossing::FAR,
        grown: 1.0,
        map_error: 0.0,
        gathered: Accumulators::NONE,
    };
}
