//! Anchors: cells followed along the trajectory of their own middle, in as many digits as their
//! depth needs.

use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};

use super::domain_splitting::{DomainSplitting, SplitRequest};
use super::finished_patch::FinishedPatch;
use super::part::{Branch, BranchState, PlacedStart, SplitNode, SplitPart};
use flipmap_numbers::jet::Jet;
use flipmap_numbers::{Exact, Scalar};
use flipmap_pendulum::flow_patch::{FlowPatch, PatchEnd};
use flipmap_pendulum::reference::{Reference, bits_for, digits_for, reference};
use flipmap_pendulum::{Pendulum, State};
use flipmap_scene::lattice::{Cell, side_rad};

/// Number of levels from one level with anchors to the next.
const EVERY: u32 = 6;
/// Least number of levels from an anchor down to a leaf, so that a view seldom needs more than two
/// anchors. The rounding error of f64 below the anchor doubles with every level.
const MIN_LEVELS_BELOW: u32 = 6;
/// Largest number of levels from an anchor down to a leaf.
pub(super) const MAX_LEVELS_BELOW: u32 = MIN_LEVELS_BELOW + EVERY - 1;
/// Largest number of anchors that are kept.
const MAX_ANCHORS: usize = 64;
/// Reduced time between two checks for cancellation.
const SLICE: f64 = 1.0;

/// A cell followed along the trajectory of its own middle.
pub(super) struct Anchor {
    node: SplitNode,
    reference: Option<Box<dyn Reference>>,
    /// The end of its path, unless that was only the end of a budget.
    end: Option<PatchEnd>,
}

/// Returns the level of the anchors for leaves of level `leaf`.
pub(super) fn anchor_level(leaf: u32) -> u32 {
    leaf.saturating_sub(MIN_LEVELS_BELOW) / EVERY * EVERY
}

/// Returns the number of decimal digits in which the anchors for leaves of level `leaf` are
/// followed.
pub(super) fn digits(leaf: u32) -> u32 {
    digits_for(bits_for(anchor_level(leaf)))
}

impl DomainSplitting {
    /// Follows an anchor to its end and returns the whole of it as a branch, or its starts if all
    /// of it is forbidden; `None` if cancelled.
    pub(super) fn anchored_branch(
        &self,
        cell: Cell,
        starts: Vec<PlacedStart>,
        wanted: SplitRequest,
    ) -> Option<Result<Branch, Vec<PlacedStart>>> {
        let anchor = self.anchor(cell);
        let mut anchor = anchor.lock().unwrap_or_else(|broken| broken.into_inner());
        let end = self.advance(&mut anchor, wanted);
        wanted.told.clear();
        let Some(end) = end? else { return Some(Err(starts)) };
        let part = SplitPart::whole(cell, wanted.level, self.strict);
        let way = BranchState::Ended(Arc::new(FinishedPatch::new(
            (&self.plane, &part),
            anchor.node.clone(),
            end,
            wanted.budget,
        )));
        Some(Ok(Branch { part, starts, way }))
    }

    fn anchor(&self, cell: Cell) -> Arc<Mutex<Anchor>> {
        let mut anchors = self.anchors.lock().unwrap_or_else(|broken| broken.into_inner());
        if anchors.len() >= MAX_ANCHORS && !anchors.contains_key(&cell) {
            anchors.clear();
        }
        anchors.entry(cell).or_insert_with(|| Arc::new(Mutex::new(self.anchored(cell)))).clone()
    }

    /// Creates an anchor at its start, with as many digits for its middle as its level needs.
    fn anchored(&self, cell: Cell) -> Anchor {
        let node = self.released(cell);
        let holds = node.patch.holds(&self.dynamics, self.tolerance(MAX_LEVELS_BELOW as i32));
        let middle = holds.then(|| self.reduced(cell, [0.0; 2])).flatten();
        let reference =
            middle.map(|(pendulum, start)| reference(&pendulum, &start, bits_for(cell.level)));
        let end = (!holds).then_some(PatchEnd::Spread);
        Anchor { node, reference, end }
    }

    /// The pendulum and a start at a point of a cell, in reduced units; `None` where a section has
    /// no real solution.
    pub(super) fn reduced(
        &self,
        cell: Cell,
        at: [f64; 2],
    ) -> Option<(Pendulum<Exact>, State<Exact>)> {
        let (pendulum, unit_secs) = self.build.reduced_in::<Exact>();
        let start = self.plane.start(&cell, at)?;
        Some((pendulum, State { speed: start.speed.map(|speed| speed * unit_secs), ..start }))
    }

    /// Creates the polynomials of a cell at its start.
    pub(super) fn released(&self, cell: Cell) -> SplitNode {
        let (Some((exact, start)), Some(by)) =
            (self.reduced(cell, [0.0; 2]), self.plane.differences(&cell))
        else {
            return SplitNode { patch: FlowPatch::undescribed(&self.dynamics), edge: None };
        };
        let phase = exact.phase(&start);
        let [x1, y1, x2, y2, p1, p2] = phase.map(Exact::to_f64);
        let patch = if self.plane.is_at_rest() {
            self.released_from_rest([(y1, x1), (y2, x2)], cell.level)
        } else {
            let unit_secs = Jet::constant(self.build.unit_secs());
            let [by1, by2, faster1, faster2] = by;
            let by = [by1, by2, faster1 * unit_secs, faster2 * unit_secs];
            FlowPatch::thrown(&self.dynamics, &[x1, y1, x2, y2, p1, p2], by)
        };
        let patch = if self.nudges { patch.with_nudges() } else { patch };
        // Depth beyond the edge of the forbidden region, in reduced units.
        let edge = match self.plane.forbids_section(self.rule) {
            // All starts of a section share their energy.
            Some(forbids) => Jet::constant(if forbids { 1.0 } else { -1.0 }),
            None => {
                let beyond = -exact.energy_of(&phase) - exact.least_depth(self.rule);
                (-patch.energy(&self.dynamics)).with_middle(beyond.to_f64())
            }
        };
        SplitNode { patch, edge: Some(edge) }
    }

    /// A cell of a level released from rest around the angles with these sines and cosines.
    fn released_from_rest(&self, sin_cos: [(f64, f64); 2], level: u32) -> FlowPatch {
        #[cfg(feature = "sabotage")]
        if let Some(sabotage) = self.sabotage {
            return sabotage.released(&self.dynamics, sin_cos, level);
        }
        FlowPatch::release(&self.dynamics, sin_cos, side_rad(level + 1))
    }

    /// Follows an anchor up to the requested budget. Returns its end there, or `Some(None)` where
    /// all of it is forbidden; `None` if cancelled.
    fn advance(&self, anchor: &mut Anchor, wanted: SplitRequest) -> Option<Option<PatchEnd>> {
        if !anchor.node.settle_edge() {
            return Some(None);
        }
        let tolerance = self.tolerance(MAX_LEVELS_BELOW as i32);
        let unit_secs = self.build.unit_secs();
        loop {
            if let Some(end) = &anchor.end {
                return Some(Some(end.clone()));
            }
            if wanted.cancelled.load(Ordering::Relaxed) {
                return None;
            }
            let patch = &mut anchor.node.patch;
            wanted.told.set(patch.time.0 * unit_secs, wanted.budget * unit_secs);
            let until = wanted.budget.min(patch.time.0 + SLICE);
            match patch.follow(&self.dynamics, until, tolerance, anchor.reference.as_mut()) {
                PatchEnd::Over if patch.time.0 >= wanted.budget => {
                    return Some(Some(PatchEnd::Over));
                }
                PatchEnd::Over => {}
                end => anchor.end = Some(end),
            }
        }
    }
}
