//! Start maps: the outcomes of a leaf's starts that are known from its polynomials, and the states
//! from which the others are integrated.

use std::sync::Arc;

use crate::engine::{End, Moving, Question};
use crate::physics::flow_patch::{Curve, Dynamics, FlowPatch, PatchEnd};
use crate::physics::jet::Jet;
use crate::physics::phase::Phase;
use crate::physics::{Outcome, Status};

/// A flow patch that has been followed to its end.
#[derive(Clone, Debug)]
pub(super) struct FinishedPatch {
    /// The patch in its last state.
    pub patch: FlowPatch,
    /// The reason why it ended.
    pub ending: PatchEnd,
    /// Depth of its starts in the forbidden region, if the region's edge crosses the cell.
    pub edge: Option<Jet>,
    /// Half the side of its cell in rad.
    pub half_rad: f64,
}

/// The part of a finished patch that belongs to a leaf.
#[derive(Clone, Debug)]
pub(super) enum StartMap {
    /// Conservation of energy keeps all of it from flipping.
    Forbidden,
    /// The part of `ended` around `middle` that is 2 `half` wide there.
    Part {
        /// The patch that the part is taken from.
        ended: Arc<FinishedPatch>,
        /// Middle of the leaf in the patch's coordinates.
        middle: [f64; 2],
        /// Half the side of the leaf in the patch's coordinates.
        half: f64,
    },
}

/// A start as far as its start map determines it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum MappedStart {
    /// The outcome is known, and the end.
    Known(Outcome, End),
    /// The state is known up to this moment; the rest has to be integrated.
    Moving(Moving),
}

impl StartMap {
    /// Maps the start at a point of the leaf, in [−1, 1]²; `unit_secs` is the reduced unit of time
    /// in s.
    pub(super) fn start(
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
    /// Mean rate at which neighbours moved apart, in decades per second; 0 where they did not.
    pub(super) fn decades_a_second(&self, dynamics: &Dynamics, secs: f64) -> f64 {
        let decades = (self.patch.spread(dynamics) / self.half_rad).log10();
        // A path not much longer than the opening tells nothing.
        if self.patch.time.0 > 10.0 * dynamics.opening { decades.max(0.0) / secs } else { 0.0 }
    }

    /// The pendulum that is in a state when the patch ends.
    pub(super) fn moving(&self, dynamics: &Dynamics, phase: Phase<f64>, clearance: f64) -> Moving {
        let (high, low) = self.patch.time;
        let grown = self.patch.spread(dynamics) / self.half_rad;
        Moving { time: [high, low], phase, step: self.patch.step, clearance, grown }
    }

    /// The curve on which the states of all starts lie, if they lie on one up to `most_aside` (see
    /// [`FlowPatch::curve`]) and nothing about them is known from polynomials.
    pub(super) fn curve(&self, dynamics: &Dynamics, most_aside: f64) -> Option<Curve> {
        let open = matches!(self.ending, PatchEnd::Spread | PatchEnd::Unclear);
        let open = open && self.edge.is_none();
        open.then(|| self.patch.curve(dynamics, most_aside)).flatten()
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
            PatchEnd::Passed(pass) => Some(pass.flip(at)),
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
            (None, PatchEnd::Spread | PatchEnd::Unclear) => {
                MappedStart::Moving(self.moving(dynamics, phase, clearance))
            }
            (None, _) => {
                let end = End { time: high + low, phase, clearance, grown: f64::INFINITY };
                MappedStart::Known(Outcome::without_time(Status::Unflipped), end)
            }
        }
    }
}

/// The result for starts that conservation of energy keeps from flipping.
const FORBIDDEN: MappedStart =
    MappedStart::Known(Outcome { status: Status::Forbidden, time: 0.0 }, End::NOWHERE);
