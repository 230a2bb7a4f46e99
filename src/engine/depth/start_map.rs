//! What becomes of a cell of starts: outcomes that are known from its polynomials, and the moment
//! at which the integration of the others begins.

use std::sync::Arc;

use crate::engine::{End, Moving, Question};
use crate::physics::flow_patch::{Dynamics, FlowPatch, PatchEnd as WayEnd};
use crate::physics::jet::Jet;
use crate::physics::{Outcome, Status};

/// A patch that has come to its end.
#[derive(Clone, Debug)]
pub struct FinishedPatch {
    /// The patch, where it ended.
    pub patch: FlowPatch,
    /// How.
    pub ending: WayEnd,
    /// How deep in the forbidden region its starts are, if the region's edge crosses it.
    pub edge: Option<Jet>,
    /// Half the side of its cell, rad.
    pub half_rad: f64,
}

/// A leaf's part of an ended patch.
#[derive(Clone, Debug)]
pub enum StartMap {
    /// Energy conservation forbids all of it to flip.
    Forbidden,
    /// The part of `ended` around `middle` that is 2 `half` wide there.
    Part {
        /// Of what.
        ended: Arc<FinishedPatch>,
        /// In the sheet's coordinates.
        middle: [f64; 2],
        /// Likewise.
        half: f64,
    },
}

/// A start, as far as it is known without its own integration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MappedStart {
    /// All of it, and where it ends.
    Known(Outcome, End),
    /// Up to this moment.
    Moving(Moving),
}

impl StartMap {
    /// What becomes of the start at a point of the leaf, in [−1, 1]², in reduced units of
    /// `unit_secs`.
    pub fn start(
        &self,
        dynamics: &Dynamics,
        question: &Question,
        unit_secs: f64,
        at: [f64; 2],
    ) -> MappedStart {
        match self {
            StartMap::Forbidden => FORBIDDEN,
            StartMap::Part { ended, middle, half } => {
                let at = [0, 1].map(|i| middle[i] + half * at[i]);
                ended.start(dynamics, question, unit_secs, at)
            }
        }
    }
}

impl FinishedPatch {
    /// How fast neighbours moved apart on the way, decades a second; 0 where they did not.
    pub fn decades_a_second(&self, dynamics: &Dynamics, secs: f64) -> f64 {
        let decades = (self.patch.spread(dynamics) / self.half_rad).log10();
        // A way no longer than the first moments says nothing.
        if self.patch.time.0 > 10.0 * dynamics.opening { decades.max(0.0) / secs } else { 0.0 }
    }

    fn start(
        &self,
        dynamics: &Dynamics,
        question: &Question,
        unit_secs: f64,
        at: [f64; 2],
    ) -> MappedStart {
        if self.edge.is_some_and(|edge| edge.at(at) > 0.0) {
            return FORBIDDEN;
        }
        let grazed = self.patch.grazes.iter().filter_map(|graze| graze.flip(dynamics, at));
        let passed = match &self.ending {
            WayEnd::Passed(pass) => Some(pass.flip(at)),
            _ => None,
        };
        let first = |a: (f64, _), b: (f64, _)| if b.0 < a.0 { b } else { a };
        let clearance = self.patch.clearance(at);
        let (high, low) = self.patch.time;
        let phase = self.patch.phase.map(|jet| jet.at(at));
        match (grazed.chain(passed).reduce(first), &self.ending) {
            (Some((time, phase)), _) => {
                let end = End { time, phase, clearance, grown: f64::INFINITY };
                MappedStart::Known(question.flipped_at(time * unit_secs), end)
            }
            (None, WayEnd::Spread | WayEnd::Unclear) => {
                let step = self.patch.step;
                let grown = self.patch.spread(dynamics) / self.half_rad;
                MappedStart::Moving(Moving { time: [high, low], phase, step, clearance, grown })
            }
            (None, _) => {
                let end = End { time: high + low, phase, clearance, grown: f64::INFINITY };
                MappedStart::Known(Outcome::without_time(Status::Unflipped), end)
            }
        }
    }
}

/// Of starts that energy forbids to flip.
const FORBIDDEN: MappedStart =
    MappedStart::Known(Outcome { status: Status::Forbidden, time: 0.0 }, End::NOWHERE);
