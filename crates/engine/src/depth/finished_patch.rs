//! Patches that have been followed to their end: the outcomes of starts that their polynomials
//! determine, and the states from which the other starts are integrated.

use std::sync::OnceLock;

use super::part::{SplitNode, SplitPart};
use super::stats::DepthStats;
use crate::{EventSpec, FinalState, Moving};
use flipmap_numbers::jet::Jet;
use flipmap_pendulum::flow_patch::{
    CurveCoordinates, CurvePoint, Dynamics, FlowPatch, PatchCurve, PatchEnd,
};
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::tangents::TangentMap;
use flipmap_pendulum::{Accumulators, Outcome, Status};
use flipmap_scene::ExactPlane;
use flipmap_scene::lattice::Cell;

/// The key of a part of an anchor; parts with the same key have the same patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct PartKey {
    /// The cell that is followed along the trajectory of its own middle.
    pub anchor: Cell,
    /// Level of the leaves for which the anchor is cut.
    pub leaf_level: u32,
    /// True if the anchor is followed with smaller errors, as a check.
    pub strict: bool,
    /// The cuts that lead to the part: 1, then two bits for every cut.
    pub path: u64,
}

/// A patch that has been followed to its end.
#[derive(Debug)]
pub(super) struct FinishedPatch {
    pub key: PartKey,
    /// The patch in its last state.
    pub patch: FlowPatch,
    /// The reason why it ended.
    pub ending: PatchEnd,
    /// Depth of its starts in the forbidden region, if the region's edge crosses it.
    pub edge: Option<Jet>,
    /// Half its side across the bands in the units of the plane's axes.
    pub half_side: f64,
    /// Binary logarithm of its area in leaves.
    pub area: i32,
    /// Reduced time up to which it was to be followed.
    pub budget: f64,
    /// The curve on which its states lie, if they lie on one.
    pub curve: OnceLock<Option<PatchCurve>>,
    /// The coordinates of all starts along that curve, if they are polynomials.
    pub coordinates: OnceLock<Option<CurveCoordinates>>,
}

/// Largest residual of a patch that is treated as a line, as a share of half its length along the
/// curve.
const MAX_RESIDUAL: f64 = 1e-4;

impl FinishedPatch {
    /// Creates the patch of a part that was followed towards a budget, with the reason why it
    /// ended.
    pub(super) fn new(
        (plane, part): (&ExactPlane, &SplitPart),
        node: SplitNode,
        ending: PatchEnd,
        budget: f64,
    ) -> Self {
        let SplitNode { patch, edge } = node;
        let (key, half_side, area) = (part.key, part.half_side(plane), part.above.iter().sum());
        let (curve, coordinates) = Default::default();
        FinishedPatch { key, patch, ending, edge, half_side, area, budget, curve, coordinates }
    }

    /// The patch with the forbidden region's edge.
    pub(super) fn node(&self) -> SplitNode {
        SplitNode { patch: self.patch.clone(), edge: self.edge }
    }

    /// Returns true if only the states of most of its starts are known.
    pub(super) fn is_open(&self) -> bool {
        matches!(self.ending, PatchEnd::Spread | PatchEnd::Unclear)
    }

    /// Returns true if the patch ends in the same way when it is followed to another budget. Steps
    /// do not depend on the budget, so it matters only to a patch that reaches it.
    pub(super) fn serves(&self, budget: f64) -> bool {
        let is_before = budget > self.budget || self.patch.time.0 < budget;
        budget == self.budget || (is_before && !matches!(self.ending, PatchEnd::Over))
    }

    /// Mean rate in decades per second at which neighbours part; 0 if negative or unreliable.
    fn decades_a_second(&self, dynamics: &Dynamics, secs: f64) -> f64 {
        let decades = (self.patch.spread(dynamics) / self.half_side).log10();
        // A path not much longer than the opening gives no reliable rate.
        if self.patch.is_well_under_way() { decades.max(0.0) / secs } else { 0.0 }
    }

    /// Returns the statistics of its starts, `open` of which have no known outcome.
    pub(super) fn stats(&self, dynamics: &Dynamics, unit_secs: f64, open: usize) -> DepthStats {
        let secs = self.patch.time.0 * unit_secs;
        DepthStats {
            integrated: open as u64,
            begins_secs: if open > 0 { [secs; 2] } else { DepthStats::NOTHING.begins_secs },
            decades_a_second: self.decades_a_second(dynamics, secs),
            ..DepthStats::NOTHING
        }
    }

    /// Returns the pendulum whose state is `phase` when the patch ends.
    pub(super) fn moving(&self, dynamics: &Dynamics, phase: Phase<f64>, clearance: f64) -> Moving {
        let (high, low) = self.patch.time;
        let (spread, tail) = (self.patch.spread(dynamics), self.patch.tail(dynamics));
        let grown = spread / self.half_side;
        let map_error = self.at_release([tail, spread]);
        let turns = self.patch.turns_at(&phase);
        let (time, step) = ([high, low], self.patch.step);
        Moving { time, phase, step, clearance, grown, map_error, turns, nudges: None }
    }

    /// Converts an error `tail` of the polynomials, where neighbours lie `spread` apart, to an
    /// error of the release in rad.
    fn at_release(&self, [tail, spread]: [f64; 2]) -> f64 {
        if tail > 0.0 { tail * self.half_side / spread } else { 0.0 }
    }

    /// The curve on which the states of all starts lie, if they lie on one. Starts that are
    /// forbidden or flipped in a graze are treated as if they had not ended.
    pub(super) fn curve(&self, dynamics: &Dynamics) -> Option<&PatchCurve> {
        let find = || self.is_open().then(|| self.patch.curve(dynamics, MAX_RESIDUAL)).flatten();
        self.curve.get_or_init(find).as_ref()
    }

    /// Returns the points on the patch's curve of the starts at `places`, with `None` for a start
    /// that cannot be told apart from its neighbours along the flow.
    pub(super) fn points(
        &self,
        dynamics: &Dynamics,
        curve: &PatchCurve,
        places: &[[f64; 2]],
    ) -> Vec<Option<CurvePoint>> {
        let find = || self.patch.coordinates(dynamics, curve);
        match self.coordinates.get_or_init(find) {
            Some(coordinates) => coordinates.points(places).into_iter().map(Some).collect(),
            None => {
                let phase = |at: &[f64; 2]| self.patch.phase.map(|jet| jet.at(*at));
                places.iter().map(|at| curve.point(dynamics, &phase(at))).collect()
            }
        }
    }

    /// Returns the state of the start at a point when the patch ends.
    pub(super) fn state(&self, dynamics: &Dynamics, at: [f64; 2]) -> Moving {
        let phase = self.patch.phase.map(|jet| jet.at(at));
        let nudges = self.patch.nudges_at(dynamics, at).map(Box::new);
        Moving { nudges, ..self.moving(dynamics, phase, self.patch.clearance(at)) }
    }

    /// The outcome of the start at a point of the patch, in [−1, 1]², and its end, if the
    /// polynomials determine them; `unit_secs` is the reduced unit of time in s.
    pub(super) fn known(
        &self,
        dynamics: &Dynamics,
        question: &EventSpec,
        unit_secs: f64,
        at: [f64; 2],
    ) -> Option<(Outcome, FinalState)> {
        if self.edge.is_some_and(|edge| edge.at(at) > 0.0) {
            return Some(FORBIDDEN);
        }
        let grazed = self.patch.grazes.iter().filter_map(|graze| graze.flip(dynamics, at));
        let passed = match &self.ending {
            PatchEnd::Passed(pass) => Some(pass.flip(at)),
            _ => None,
        };
        let first = |a: (f64, _), b: (f64, _)| if b.0 < a.0 { b } else { a };
        match grazed.chain(passed).reduce(first) {
            Some((time, phase)) => {
                let (clearance, grown) = (self.patch.clearance(at), f64::INFINITY);
                let map_error = self.map_error(dynamics);
                let end =
                    FinalState { time, phase, clearance, grown, map_error, ..FinalState::NOWHERE };
                Some((question.flipped_at(time * unit_secs), end))
            }
            None => (!self.is_open()).then(|| self.unflipped(dynamics, at)),
        }
    }

    /// Truncation error of the answers that the polynomials give, expressed as an error of the
    /// release in rad.
    fn map_error(&self, dynamics: &Dynamics) -> f64 {
        let at_end = self.at_release([self.patch.tail(dynamics), self.patch.spread(dynamics)]);
        match &self.ending {
            PatchEnd::Passed(pass) => self.at_release(pass.tail_and_spread(dynamics)).max(at_end),
            _ => at_end,
        }
    }

    /// The outcome of a start that has not flipped when the budget ends, and its end.
    fn unflipped(&self, dynamics: &Dynamics, at: [f64; 2]) -> (Outcome, FinalState) {
        let (high, low) = self.patch.time;
        let phase = self.patch.phase.map(|jet| jet.at(at));
        let turns = self.patch.turns_at(&phase);
        // The last step may have gone beyond the budget; the state itself is brought back later.
        let back =
            |map: TangentMap| map.followed_by(&dynamics.pendulum, &phase, self.budget - high - low);
        let nudges = self.patch.nudges_at(dynamics, at);
        let log_growth = nudges.map_or(0.0, |map| back(map).log_growth());
        let end = FinalState {
            time: high + low,
            phase,
            clearance: self.patch.clearance(at),
            grown: f64::INFINITY,
            map_error: self.map_error(dynamics),
            gathered: Accumulators { turns, log_growth, ..Accumulators::NONE },
        };
        (Outcome::without_time(Status::Unflipped), end)
    }
}

/// The outcome and the end of starts that conservation of energy keeps from flipping.
pub(super) const FORBIDDEN: (Outcome, FinalState) =
    (Outcome { status: Status::Forbidden, time: 0.0 }, FinalState::NOWHERE);
