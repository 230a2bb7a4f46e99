//! Start maps that are wrong on purpose, for tests of the checks that have to detect them.

use flipmap_pendulum::flow_patch::{Dynamics, FlowPatch};
use flipmap_scene::lattice::side_rad;

/// A mistake in all start maps of an engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sabotage {
    /// Passes of the top are missed during the first half unit of time.
    BlindOpening,
    /// One coefficient of the polynomials is 1 % too large.
    Coefficient,
    /// Starts lie twice as far apart as they should.
    WideLeaf,
}

impl Sabotage {
    /// Creates a cell at rest, at its start, with the mistake. The angles of its middle are given
    /// by their sines and cosines.
    pub(super) fn released(
        self,
        dynamics: &Dynamics,
        sin_cos: [(f64, f64); 2],
        level: u32,
    ) -> FlowPatch {
        let half = side_rad(level + 1);
        match self {
            Sabotage::BlindOpening => FlowPatch::release(dynamics, sin_cos, half).with_opening(0.5),
            Sabotage::Coefficient => {
                let mut patch = FlowPatch::release(dynamics, sin_cos, half);
                patch.phase[1] = patch.phase[1].with_larger_slope(1.01);
                patch
            }
            Sabotage::WideLeaf => FlowPatch::release(dynamics, sin_cos, 2.0 * half),
        }
    }
}
