//! The domain splitting from an anchor down to its smallest parts: a part is followed as long as
//! its polynomials hold, then cut.
//!
//! An anchor's middle is followed in as many digits as its depth needs. Everything below the anchor
//! is a difference from that middle, for which f64 has enough digits: a leaf lies at most
//! [`MAX_LEVELS_BELOW`](super::anchor::MAX_LEVELS_BELOW) levels below its anchor.
//!
//! A cell is cut into quarters as long as its states differ in two directions. Energy is conserved,
//! so one direction grows far beyond the other; from then on cells are cut only across it, into
//! strips as long as the cell:
//!
//! ```text
//!   ┌───────┬───────┐     ┌───────────────┐
//!   │       │       │     │╲   ╲   ╲   ╲  │   Strips become narrower than a leaf. What happens
//!   ├───────┼───────┤ ──▶ │ ╲   ╲   ╲   ╲ │   in one is the same all along, to first order, so
//!   │       │       │     │  ╲   ╲   ╲   ╲│   that all tiles share it.
//!   └───────┴───────┘     └───────────────┘
//! ```
//!
//! Everything about a part follows from its place in the lattice, so no answer depends on which
//! other parts were requested.

use std::cell::LazyCell;
use std::collections::{BTreeMap, HashMap};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use rayon::prelude::*;

use super::anchor::{Anchor, anchor_level};
use super::finished_patch::{FinishedPatch, PartKey};
use super::following::Following;
use super::part::{Branch, BranchState, Cut, PlacedStart, SplitNode, SplitPart};
use crate::{Deep, EventSpec, Leaf, Moving};
use flipmap_numbers::frame::Frame;
use flipmap_numbers::{Exact, Scalar};
use flipmap_pendulum::crossing::FAR;
use flipmap_pendulum::flow_patch::{Dynamics, FlowPatch, PatchEnd};
use flipmap_pendulum::opening::{Opening, from_top};
use flipmap_pendulum::tangents::TangentMap;
use flipmap_pendulum::{Rule, control};
use flipmap_scene::lattice::Cell;
use flipmap_scene::{ExactPlane, PendulumSpec, question::Needs};

/// Largest truncation error of a leaf's polynomials, in unit vectors and scaled momenta. An error
/// made further up grows with the cells that are cut from there, so the tolerance is halved with
/// every level above the leaves.
const TOLERANCE: f64 = 1e-12;
/// The same tolerance for strict start maps, which check others and share no cut with them.
const STRICT_TOLERANCE: f64 = 1e-13;
/// Largest number of finished patches that are kept, of some 2 kB each.
const MAX_FINISHED_PATCHES: usize = 20_000;
/// Largest extent of a strip's states along the bands, as a share of their extent across them.
const MAX_EXTENT_ALONG: f64 = 0.25;
/// Least width of strips that are lines, in levels relative to leaves. There are few of them, and
/// following one saves the integration of all its pixels.
const MIN_STRIP_WIDTH_LEVEL: i32 = -3;
/// Least area of strips that are not lines, in levels relative to leaves: following a smaller one
/// costs more than integrating its pixels (measured).
const MIN_STRIP_AREA_LEVEL: i32 = -3;
/// Growth of the largest nudge beyond which all other nudges have grown into it, to one part in
/// this number.
const ALIGNED: f64 = 1e4;
/// Least number of starts for which a job's parts are followed on several threads.
const MANY_STARTS: usize = 1 << 16;

/// The domain splitting of one pendulum, rule and plane.
pub(super) struct DomainSplitting {
    pub dynamics: Dynamics,
    pub build: PendulumSpec,
    pub rule: Rule,
    pub plane: ExactPlane,
    pub strict: bool,
    /// The first moments of starts that are followed alone.
    opening: Opening,
    /// True if the growth of nudges is followed.
    pub nudges: bool,
    pub anchors: Mutex<HashMap<Cell, Arc<Mutex<Anchor>>>>,
    /// A deliberate mistake that a test makes.
    #[cfg(feature = "sabotage")]
    pub sabotage: Option<super::sabotage::Sabotage>,
    finished: Mutex<HashMap<PartKey, Arc<FinishedPatch>>>,
}

/// A request for the patches of some starts: the leaves' level, the reduced budget, the
/// cancellation flag, and the progress to report to.
#[derive(Clone, Copy)]
pub(super) struct SplitRequest<'a> {
    pub level: u32,
    pub budget: f64,
    pub cancelled: &'a AtomicBool,
    pub told: &'a Following,
}

/// The patches to which starts belong, with the starts in coordinates of the patch, and the indices
/// of those that are forbidden.
#[derive(Default)]
pub(super) struct Distribution {
    pub patches: Vec<(Arc<FinishedPatch>, Vec<PlacedStart>)>,
    pub forbidden: Vec<usize>,
    /// Number of parts that were followed, and number of their steps.
    pub followed: (u64, u64),
}

impl DomainSplitting {
    pub(super) fn new(question: &EventSpec, deep: &Deep, nudges: bool) -> Self {
        let ends = if nudges { Needs::Growth } else { Needs::End };
        DomainSplitting {
            dynamics: Dynamics::new(question.reduced().0, question.rule),
            build: question.build,
            rule: question.rule,
            plane: *deep.plane,
            strict: deep.strict,
            opening: EventSpec { budget_secs: f64::INFINITY, ..*question }.opening(ends),
            nudges,
            anchors: Mutex::default(),
            #[cfg(feature = "sabotage")]
            sabotage: None,
            finished: Mutex::default(),
        }
    }

    /// Adds a deliberate mistake.
    #[cfg(feature = "sabotage")]
    pub(super) fn sabotaged(mut self, sabotage: Option<super::sabotage::Sabotage>) -> Self {
        self.sabotage = sabotage;
        self
    }

    pub(super) fn is_of(&self, question: &EventSpec, deep: &Deep, nudges: bool) -> bool {
        let alike = self.build == question.build && self.rule == question.rule;
        let together = self.plane == *deep.plane && self.strict == deep.strict;
        alike && together && self.nudges == nudges
    }

    /// Finds the patches of a job's starts; returns `None` if cancelled.
    pub(super) fn distribute(&self, deep: &Deep, wanted: SplitRequest) -> Option<Distribution> {
        let mut all = Distribution::default();
        for (anchor, starts) in by_anchor(deep, wanted.level) {
            let branch = self.anchored_branch(anchor, starts, wanted)?;
            all.append(match branch {
                Ok(branch) => self.followed(vec![branch], wanted),
                Err(starts) => Distribution::forbidden(&starts),
            });
        }
        (!wanted.cancelled.load(Ordering::Relaxed)).then_some(all)
    }

    pub(super) fn tolerance(&self, levels_above_leaf: i32) -> f64 {
        let leaf = if self.strict { STRICT_TOLERANCE } else { TOLERANCE };
        leaf * 0.5f64.powi(levels_above_leaf.max(0))
    }

    /// Follows branches to their ends, on several threads if there are many starts. A small job
    /// uses one thread: a thread that waits for others may begin another job.
    fn followed(&self, branches: Vec<Branch>, wanted: SplitRequest) -> Distribution {
        let starts: usize = branches.iter().map(|branch| branch.starts.len()).sum();
        let follow = |branch| self.followed_branch(branch, wanted);
        let add = |mut all: Distribution, more| {
            all.append(more);
            all
        };
        if starts < MANY_STARTS {
            return branches.into_iter().map(follow).fold(Distribution::default(), add);
        }
        branches.into_par_iter().map(follow).reduce(Distribution::default, add)
    }

    fn followed_branch(&self, branch: Branch, wanted: SplitRequest) -> Distribution {
        let mut all = Distribution::default();
        let Branch { part, starts, way } = branch;
        let finished = match way {
            BranchState::Ended(finished) => finished,
            BranchState::Open(mut node) => {
                let end = self.follow(&mut node, &part, wanted.budget);
                self.finish(&part, *node, end, wanted, &mut all)
            }
        };
        let parts = self.cut(part, starts, finished, wanted, &mut all);
        all.append(self.followed(parts, wanted));
        all
    }

    /// Follows a part alone; returns why it ended.
    fn follow(&self, node: &mut SplitNode, part: &SplitPart, budget: f64) -> PatchEnd {
        if self.holds(node, part) {
            node.patch.follow(&self.dynamics, budget, self.tolerance(part.above[0]), None)
        } else {
            PatchEnd::Spread
        }
    }

    /// Returns true if a part can be followed at all.
    fn holds(&self, node: &SplitNode, part: &SplitPart) -> bool {
        node.patch.holds(&self.dynamics, self.tolerance(part.above[0]))
    }

    /// Keeps a part that has been followed to its end, and counts it in `all`.
    fn finish(
        &self,
        part: &SplitPart,
        node: SplitNode,
        end: PatchEnd,
        wanted: SplitRequest,
        all: &mut Distribution,
    ) -> Arc<FinishedPatch> {
        all.followed = (all.followed.0 + 1, all.followed.1 + node.patch.steps);
        let patch = Arc::new(FinishedPatch::new((&self.plane, part), node, end, wanted.budget));
        if !wanted.cancelled.load(Ordering::Relaxed) {
            let mut kept = self.finished.lock().unwrap_or_else(|broken| broken.into_inner());
            if kept.len() >= MAX_FINISHED_PATCHES {
                kept.clear();
            }
            kept.insert(part.key, patch.clone());
        }
        patch
    }

    /// Cuts a part that has ended, and returns the resulting parts that have starts. If the part is
    /// not cut, adds it to the patches of `all`.
    fn cut(
        &self,
        part: SplitPart,
        starts: Vec<PlacedStart>,
        finished: Arc<FinishedPatch>,
        wanted: SplitRequest,
        all: &mut Distribution,
    ) -> Vec<Branch> {
        let goes_on = finished.is_open() && !wanted.cancelled.load(Ordering::Relaxed);
        let Some(cut) = goes_on.then(|| self.cut_of(&part, &finished)).flatten() else {
            let inside =
                |start: PlacedStart| PlacedStart { at: part.frame.inward(start.at), ..start };
            all.patches.push((finished, starts.into_iter().map(inside).collect()));
            return Vec::new();
        };
        let framed = LazyCell::new(|| finished.node().part(&self.dynamics, &cut.frame));
        let mut branches = Vec::new();
        let groups = part.distribute(&cut, &starts);
        for ((frame, part), starts) in part.parts(&cut).into_iter().zip(groups) {
            if starts.is_empty() {
                continue;
            }
            if let Some(known) = self.known(&part.key, wanted.budget) {
                branches.push(Branch { part, starts, way: BranchState::Ended(known) });
                continue;
            }
            let mut node = if finished.patch.time.0 == 0.0 {
                // The cell is too wide for its polynomials even at rest.
                self.released(part.cell)
            } else {
                self.with_own_nudges(framed.part(&self.dynamics, &frame), &part)
            };
            if node.settle_edge() {
                branches.push(Branch { part, starts, way: BranchState::Open(Box::new(node)) });
            } else {
                all.forbidden.extend(starts.iter().map(|start| start.index));
            }
        }
        branches
    }

    /// Gives a part that was just cut the nudges of its own middle from the release. Once all
    /// nudges except those across one direction have grown into the same one, the nudges inherited
    /// from the larger part are as good and stay.
    fn with_own_nudges(&self, node: SplitNode, part: &SplitPart) -> SplitNode {
        if !node.patch.has_grown_less_than(ALIGNED) {
            return node;
        }
        let Some((pendulum, start)) = self.reduced(part.key.anchor, part.frame.middle) else {
            return node;
        };
        let patch =
            node.patch.with_nudges_from(&self.dynamics, &pendulum.phase(&start).map(Exact::to_f64));
        SplitNode { patch, ..node }
    }

    /// Returns true if the starts of a patch are better followed from their release. This is so if
    /// the patch ends at the release, because it is too large for its polynomials, undescribed, or
    /// beside the top. It is also so if nudges have grown so little that those of the middle do not
    /// stand for all, and that any number type has enough digits.
    pub(super) fn is_better_from_release(&self, patch: &FinishedPatch) -> bool {
        let ends_at_release = patch.is_open() && patch.patch.time.0 == 0.0;
        ends_at_release || patch.patch.has_grown_less_than(ALIGNED)
    }

    /// Returns the state of a start that is followed alone from its release; `None` if forbidden.
    pub(super) fn start_alone(&self, cell: Cell, at: [f64; 2]) -> Option<Moving> {
        let (pendulum, start) = self.reduced(cell, at)?;
        let phase = pendulum.phase(&start);
        if pendulum.forbids_depth(self.rule, -pendulum.energy_of(&phase)) {
            return None;
        }
        let at_release = Moving {
            time: [0.0; 2],
            phase: phase.map(Exact::to_f64),
            step: control::FIRST,
            clearance: FAR,
            grown: 1.0,
            map_error: 0.0,
            turns: [0; 2],
            nudges: self.nudges.then(|| Box::new(TangentMap::identity())),
        };
        let from_top = start.angle.map(|angle| from_top(angle).to_f64());
        if !self.opening.concerns(from_top, start.speed.map(Exact::to_f64)) {
            return Some(at_release);
        }
        let moments = self.opening.first_moments(&start);
        Some(Moving {
            time: [moments.length, 0.0],
            phase: moments.end(&self.dynamics.pendulum),
            turns: moments.gathered().turns,
            ..at_release
        })
    }

    fn known(&self, key: &PartKey, budget: f64) -> Option<Arc<FinishedPatch>> {
        let kept = self.finished.lock().unwrap_or_else(|broken| broken.into_inner());
        kept.get(key).filter(|finished| finished.serves(budget)).cloned()
    }

    /// Returns the cut of a part whose polynomials no longer hold, or `None` if the part is small
    /// enough.
    fn cut_of(&self, part: &SplitPart, finished: &FinishedPatch) -> Option<Cut> {
        if part.is_strip {
            let axes = self.axes_of_strip(part.above, finished);
            return axes.map(|axes| Cut { frame: Frame::WHOLE, axes, strips: true });
        }
        if finished.patch.time.0 > 0.0 {
            let frame = Frame::turned(finished.patch.growing_angle(&self.dynamics));
            if !self.is_long(&finished.patch.part(&self.dynamics, &frame)) {
                return Some(Cut { frame, axes: [true, false], strips: true });
            }
        }
        (part.above[0] > 0).then_some(Cut {
            frame: Frame::WHOLE,
            axes: [true, true],
            strips: false,
        })
    }

    /// Returns the axes along which a strip is cut: first to the width of a leaf, then for as long
    /// as cutting costs less than it saves. A narrow, long strip that is not a line is not cut
    /// along its length, which would take as long or longer (measured).
    fn axes_of_strip(
        &self,
        [across, along]: [i32; 2],
        finished: &FinishedPatch,
    ) -> Option<[bool; 2]> {
        let is_long = self.is_long(&finished.patch);
        if across > 0 {
            return Some([true, along > 0 && is_long]);
        }
        let axes = if finished.curve(&self.dynamics).is_some() {
            [across > MIN_STRIP_WIDTH_LEVEL && !is_long, false]
        } else if across + along > MIN_STRIP_AREA_LEVEL {
            [true, false]
        } else {
            [false; 2]
        };
        axes.contains(&true).then_some(axes)
    }

    /// Returns true if the states of a patch also differ along the second axis.
    fn is_long(&self, patch: &FlowPatch) -> bool {
        let [across, along] = patch.extents(&self.dynamics);
        along > MAX_EXTENT_ALONG * across
    }
}

/// Groups a job's starts by the anchors of their leaves, in coordinates of the anchor.
fn by_anchor(deep: &Deep, level: u32) -> BTreeMap<Cell, Vec<PlacedStart>> {
    let mut groups: BTreeMap<Cell, Vec<PlacedStart>> = BTreeMap::new();
    let mut index = 0;
    for Leaf { cell, points } in &deep.leaves {
        let anchor = cell.ancestor(anchor_level(level));
        let half = 0.5f64.powi((cell.level - anchor.level) as i32);
        let middle = cell.index_in(&anchor).map(|index| (2.0 * index + 1.0) * half - 1.0);
        let group = groups.entry(anchor).or_default();
        for point in points {
            let at = [0, 1].map(|i| middle[i] + half * point[i]);
            group.push(PlacedStart { index, at });
            index += 1;
        }
    }
    groups
}

impl Distribution {
    fn forbidden(starts: &[PlacedStart]) -> Self {
        let forbidden = starts.iter().map(|start| start.index).collect();
        Distribution { forbidden, ..Distribution::default() }
    }

    fn append(&mut self, mut more: Distribution) {
        self.patches.append(&mut more.patches);
        self.forbidden.append(&mut more.forbidden);
        self.followed.0 += more.followed.0;
        self.followed.1 += more.followed.1;
    }
}
