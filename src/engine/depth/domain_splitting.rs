//! The domain splitting from an anchor down to the leaves: a cell is followed as long as its
//! polynomials hold, then cut into quarters.
//!
//! An anchor's middle is followed in as many digits as its depth needs. Everything below it is a
//! difference from it, for which f64 has digits enough: a leaf lies at most [`DEEPEST_BELOW`]
//! levels below its anchor. Everything about a leaf follows from its own place in the lattice, so
//! no answer depends on which others were requested.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use rayon::prelude::*;

use super::following::Following;
use super::split_lanes::SplitLanes;
use super::start_map::{FinishedPatch, StartMap};
use crate::engine::Question;
use crate::physics::flow_patch::{Dynamics, FlowPatch, PatchEnd};
use crate::physics::jet::Jet;
use crate::physics::reference::{Reference, digits_for, reference};
use crate::physics::{Angle, Pendulum, Rule, Scalar, Theta};
use crate::scene::Build;
use crate::scene::lattice::{Cell, side_rad};

/// Number of levels from one level with anchors to the next.
const EVERY: u32 = 6;
/// Least number of levels from an anchor down to a leaf, so that a view seldom needs more than two
/// anchors. The rounding error of f64 below the anchor doubles with every level.
const LEAST_BELOW: u32 = 6;
/// Largest number of levels from an anchor down to a leaf.
pub(super) const DEEPEST_BELOW: u32 = LEAST_BELOW + EVERY - 1;
/// Largest part of a leaf's states that its polynomials may leave out. Further up, what is left out
/// grows with the cells that are cut, so the tolerance is halved with every level above the leaves.
const TOLERANCE: f64 = 1e-12;
/// The same tolerance for strict start maps, which check others and share no cut with them.
const STRICT_TOLERANCE: f64 = 1e-13;
/// Guard bits for the rounding errors of a long integration.
const GUARD_BITS: u32 = 10;
/// Largest number of anchors that are kept.
const MOST_ANCHORS: usize = 64;
/// Reduced time between two checks for cancellation.
const SLICE: f64 = 1.0;

/// The domain splitting, and so the start maps, of one pendulum and rule.
pub(super) struct DomainSplitting {
    pub dynamics: Dynamics,
    build: Build,
    rule: Rule,
    strict: bool,
    anchors: Mutex<HashMap<Cell, Arc<Mutex<Anchor>>>>,
}

/// A cell followed along the trajectory of its own middle.
struct Anchor {
    node: SplitNode,
    reference: Option<Box<dyn Reference>>,
    /// The end of its path, unless that was only the end of a budget.
    end: Option<PatchEnd>,
}

/// A cell that has been followed up to some time.
#[derive(Clone)]
pub(super) struct SplitNode {
    pub patch: FlowPatch,
    pub edge: Option<Jet>,
}

/// A cell on its way with the leaves below it, and what its polynomials may leave out.
pub(super) struct Branch {
    pub node: SplitNode,
    pub cell: Cell,
    pub leaves: Vec<Cell>,
    pub tolerance: f64,
}

/// Largest number of leaves that are followed on one thread.
const LEAVES_IN_LANES: usize = 256;

/// A request for start maps: the leaves' level, the reduced budget, the cancellation flag, and the
/// progress to report to.
#[derive(Clone, Copy)]
pub(super) struct SplitRequest<'a> {
    pub level: u32,
    pub budget: f64,
    pub cancelled: &'a AtomicBool,
    pub told: &'a Following,
}

/// Middles of a cell's quarters, in the order of [`Cell::children`].
const QUARTERS: [[f64; 2]; 4] = [[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]];

/// The level of the anchors of leaves.
fn anchor_level(leaf: u32) -> u32 {
    leaf.saturating_sub(LEAST_BELOW) / EVERY * EVERY
}

/// Precision that a reference at an anchor needs, in bits after the point.
fn bits(anchor: u32) -> u32 {
    anchor + f64::MANTISSA_DIGITS + GUARD_BITS
}

impl DomainSplitting {
    pub(super) fn new(question: &Question, strict: bool) -> Self {
        DomainSplitting {
            dynamics: Dynamics::new(question.reduced().0, question.rule),
            build: question.build,
            rule: question.rule,
            strict,
            anchors: Mutex::default(),
        }
    }

    pub(super) fn is_of(&self, question: &Question, strict: bool) -> bool {
        self.build == question.build && self.rule == question.rule && self.strict == strict
    }

    /// Computes the start maps of leaves of one level, in any order; none if cancelled.
    pub(super) fn start_maps(
        &self,
        leaves: &[Cell],
        wanted: SplitRequest,
    ) -> Option<HashMap<Cell, StartMap>> {
        let above = anchor_level(wanted.level);
        let mut groups: HashMap<Cell, Vec<Cell>> = HashMap::new();
        for leaf in leaves {
            groups.entry(leaf.ancestor(above)).or_default().push(*leaf);
        }
        let mut start_maps = HashMap::new();
        for (cell, leaves) in groups {
            let anchor = self.anchor(cell);
            let mut anchor = anchor.lock().unwrap_or_else(|broken| broken.into_inner());
            let end = self.advance(&mut anchor, wanted);
            wanted.told.clear();
            match end? {
                Some(end) => {
                    let node = anchor.node.clone();
                    drop(anchor);
                    let branch = Branch { node, cell, leaves, tolerance: 0.0 };
                    let parts = self.cut(branch, end, wanted, &mut start_maps);
                    start_maps.extend(self.followed(parts, wanted));
                }
                None => start_maps.extend(leaves.iter().map(|leaf| (*leaf, StartMap::Forbidden))),
            }
        }
        (!wanted.cancelled.load(Ordering::Relaxed)).then_some(start_maps)
    }

    /// Number of decimal digits in which the anchors of leaves of a level are followed.
    pub(super) fn digits(&self, leaf: u32) -> u32 {
        digits_for(bits(anchor_level(leaf)))
    }

    fn anchor(&self, cell: Cell) -> Arc<Mutex<Anchor>> {
        let mut anchors = self.anchors.lock().unwrap_or_else(|broken| broken.into_inner());
        if anchors.len() >= MOST_ANCHORS && !anchors.contains_key(&cell) {
            anchors.clear();
        }
        anchors.entry(cell).or_insert_with(|| Arc::new(Mutex::new(self.anchored(cell)))).clone()
    }

    /// An anchor at rest, with the digits that the differences of its cells from it need.
    fn anchored(&self, cell: Cell) -> Anchor {
        let node = self.released(cell);
        let holds = node.patch.holds(&self.dynamics, self.tolerance(DEEPEST_BELOW));
        let reference =
            holds.then(|| reference(&self.build.reduced_in().0, cell.center(), bits(cell.level)));
        let end = (!holds).then_some(PatchEnd::Spread);
        Anchor { node, reference, end }
    }

    /// A cell at rest.
    fn released(&self, cell: Cell) -> SplitNode {
        let exact = cell.center().map(Angle::sin_cos);
        let sin_cos = exact.map(|(sin, cos)| (sin.to_f64(), cos.to_f64()));
        let patch = FlowPatch::release(sin_cos, side_rad(cell.level + 1));
        let edge = self.edge(&patch, exact.map(|(_, cos)| cos));
        SplitNode { patch, edge: Some(edge) }
    }

    /// Depth of starts at rest in the forbidden region, in reduced units.
    fn edge(&self, patch: &FlowPatch, cos: [Theta; 2]) -> Jet {
        let (exact, _) = self.build.reduced_in::<Theta>();
        let middle = exact.depth(cos) - exact.least_depth(self.rule);
        let [x1, _, x2, ..] = patch.phase;
        let Pendulum { p, q, .. } = self.dynamics.pendulum;
        let depth = x1 * Jet::constant(p) + x2 * Jet::constant(q);
        depth.with_middle(middle.to_f64())
    }

    /// Follows an anchor up to the requested budget. Returns its end there, or `Some(None)` where
    /// all of it is forbidden; `None` if cancelled.
    fn advance(&self, anchor: &mut Anchor, wanted: SplitRequest) -> Option<Option<PatchEnd>> {
        if !anchor.node.settle_edge() {
            return Some(None);
        }
        let tolerance = self.tolerance(DEEPEST_BELOW);
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
            match patch.follow(&self.dynamics, until, tolerance, anchor.reference.as_deref_mut()) {
                PatchEnd::Over if patch.time.0 >= wanted.budget => {
                    return Some(Some(PatchEnd::Over));
                }
                PatchEnd::Over => {}
                end => anchor.end = Some(end),
            }
        }
    }

    fn tolerance(&self, levels_above_leaf: u32) -> f64 {
        let leaf = if self.strict { STRICT_TOLERANCE } else { TOLERANCE };
        leaf * 0.5f64.powi(levels_above_leaf as i32)
    }

    /// The start maps of the leaves of branches, which are followed on. Large ones are shared among
    /// threads; the others go together in lanes.
    fn followed(&self, branches: Vec<Branch>, wanted: SplitRequest) -> Vec<(Cell, StartMap)> {
        let leaves: usize = branches.iter().map(|branch| branch.leaves.len()).sum();
        if leaves <= LEAVES_IN_LANES {
            return SplitLanes::new(self, branches, wanted).run();
        }
        let follow = |mut branch: Branch| {
            let end = branch.follow(&self.dynamics, wanted);
            let mut start_maps = Vec::new();
            let parts = self.cut(branch, end, wanted, &mut start_maps);
            start_maps.extend(self.followed(parts, wanted));
            start_maps
        };
        branches.into_par_iter().flat_map_iter(follow).collect()
    }

    /// Cuts a cell whose path has ended into the quarters that have leaves; otherwise, adds the
    /// start maps of its leaves.
    pub(super) fn cut(
        &self,
        branch: Branch,
        end: PatchEnd,
        wanted: SplitRequest,
        start_maps: &mut impl Extend<(Cell, StartMap)>,
    ) -> Vec<Branch> {
        let Branch { node, cell, leaves, .. } = &branch;
        let unsolved = matches!(end, PatchEnd::Spread | PatchEnd::Unclear);
        if unsolved && cell.level < wanted.level && !wanted.cancelled.load(Ordering::Relaxed) {
            return self.quarters(&branch, wanted, start_maps);
        }
        let half_rad = side_rad(cell.level + 1);
        let ended = Arc::new(FinishedPatch {
            patch: node.patch.clone(),
            ending: end,
            edge: node.edge,
            half_rad,
        });
        let part = |leaf: &Cell| {
            let half = 0.5f64.powi((leaf.level - cell.level) as i32);
            let middle = leaf.index_in(cell).map(|index| (2.0 * index + 1.0) * half - 1.0);
            (*leaf, StartMap::Part { ended: ended.clone(), middle, half })
        };
        start_maps.extend(leaves.iter().map(part));
        Vec::new()
    }

    fn quarters(
        &self,
        branch: &Branch,
        wanted: SplitRequest,
        start_maps: &mut impl Extend<(Cell, StartMap)>,
    ) -> Vec<Branch> {
        let mut quarters = Vec::new();
        for (middle, cell) in QUARTERS.into_iter().zip(branch.cell.children()) {
            let inside = |leaf: &&Cell| leaf.ancestor(cell.level) == cell;
            let leaves: Vec<Cell> = branch.leaves.iter().filter(inside).copied().collect();
            if leaves.is_empty() {
                continue;
            }
            let mut node = if branch.node.patch.time.0 == 0.0 {
                // Too wide for its polynomials even at rest: there is nothing to take a part of.
                self.released(cell)
            } else {
                branch.node.part(middle)
            };
            if node.settle_edge() {
                let tolerance = self.tolerance(wanted.level - cell.level);
                quarters.push(Branch { node, cell, leaves, tolerance });
            } else {
                start_maps.extend(leaves.into_iter().map(|leaf| (leaf, StartMap::Forbidden)));
            }
        }
        quarters
    }
}

impl Branch {
    /// Returns true if the cell can be followed at all.
    pub(super) fn holds(&self, dynamics: &Dynamics) -> bool {
        self.node.patch.holds(dynamics, self.tolerance)
    }

    /// Follows the cell alone; returns why it ended.
    fn follow(&mut self, dynamics: &Dynamics, wanted: SplitRequest) -> PatchEnd {
        if self.holds(dynamics) {
            self.node.patch.follow(dynamics, wanted.budget, self.tolerance, None)
        } else {
            PatchEnd::Spread
        }
    }
}

impl SplitNode {
    fn part(&self, middle: [f64; 2]) -> Self {
        let edge = self.edge.map(|edge| edge.part(middle, 0.5));
        SplitNode { patch: self.patch.part(middle, 0.5), edge }
    }

    /// Drops the forbidden region's edge where it does not cross the cell; returns false where all
    /// of the cell is forbidden.
    fn settle_edge(&mut self) -> bool {
        let Some(edge) = self.edge else { return true };
        if edge.middle() > edge.spread() {
            return false;
        }
        if edge.middle() < -edge.spread() {
            self.edge = None;
        }
        true
    }
}
