//! Parts of an anchor: where they lie, how often they may still be cut, and which starts are in
//! them.

use std::sync::Arc;

use super::finished_patch::{FinishedPatch, PartKey};
use flipmap_numbers::frame::Frame;
use flipmap_numbers::jet::Jet;
use flipmap_pendulum::flow_patch::{Dynamics, FlowPatch};
use flipmap_scene::ExactPlane;
use flipmap_scene::lattice::Cell;

/// A start of a job.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedStart {
    /// Index in the job.
    pub index: usize,
    /// Place, in coordinates of the anchor or of a part.
    pub at: [f64; 2],
}

/// A rectangle of an anchor: a cell of the lattice, or a strip along the bands.
#[derive(Clone, Copy, Debug)]
pub(super) struct SplitPart {
    pub key: PartKey,
    /// The part as a cell or, for a strip, the cell that it was cut from.
    pub cell: Cell,
    /// Place in the anchor.
    pub frame: Frame,
    /// Levels by which it is larger than a leaf, across the bands and along them.
    pub above: [i32; 2],
    /// True for a strip.
    pub is_strip: bool,
}

/// A way to cut a part.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    /// The frame that is cut, in the part's coordinates.
    pub frame: Frame,
    /// The axes along which it is halved.
    pub axes: [bool; 2],
    /// True if the results are strips.
    pub strips: bool,
}

/// A part that is being followed, with the starts in it, in coordinates of the anchor.
pub(super) struct Branch {
    pub part: SplitPart,
    pub starts: Vec<PlacedStart>,
    pub way: BranchState,
}

/// The progress of following a part.
pub(super) enum BranchState {
    /// Followed to the time at which it was cut from a larger part.
    Open(Box<SplitNode>),
    /// Followed to the end.
    Ended(Arc<FinishedPatch>),
}

/// A patch and the edge of the forbidden region, if there is one.
#[derive(Clone)]
pub(super) struct SplitNode {
    pub patch: FlowPatch,
    pub edge: Option<Jet>,
}

impl SplitPart {
    /// The whole of an anchor.
    pub(super) fn whole(anchor: Cell, leaf_level: u32, strict: bool) -> Self {
        let above = [(leaf_level - anchor.level) as i32; 2];
        let key = PartKey { anchor, leaf_level, strict, path: 1 };
        SplitPart { key, cell: anchor, frame: Frame::WHOLE, above, is_strip: false }
    }

    /// Half its side across the bands in the units of the plane's axes.
    pub(super) fn half_side(&self, plane: &ExactPlane) -> f64 {
        self.frame.half_sides()[0] * plane.half_side(self.key.anchor.level)
    }

    /// The parts into which it is cut, each with its frame in the coordinates of `cut`'s frame.
    pub(super) fn parts(&self, cut: &Cut) -> Vec<(Frame, SplitPart)> {
        let outer = self.frame.outside(&cut.frame);
        let above = [0, 1].map(|axis| self.above[axis] - i32::from(cut.axes[axis]));
        let part = |(index, frame)| {
            let key = PartKey { path: 4 * self.key.path + index as u64, ..self.key };
            let cell = if cut.strips { self.cell } else { self.cell.children()[index] };
            let place = outer.outside(&frame);
            (frame, SplitPart { key, cell, frame: place, above, is_strip: cut.strips })
        };
        Frame::parts(cut.axes).enumerate().map(part).collect()
    }

    /// Distributes starts among the parts into which it is cut.
    pub(super) fn distribute(&self, cut: &Cut, starts: &[PlacedStart]) -> Vec<Vec<PlacedStart>> {
        let outer = self.frame.outside(&cut.frame);
        let mut parts = vec![Vec::new(); Frame::parts(cut.axes).count()];
        for start in starts {
            parts[Frame::part_of(cut.axes, outer.inward(start.at))].push(*start);
        }
        parts
    }
}

impl SplitNode {
    /// The part of the patch in a frame.
    pub(super) fn part(&self, dynamics: &Dynamics, frame: &Frame) -> Self {
        let edge = self.edge.map(|edge| edge.part(frame));
        SplitNode { patch: self.patch.part(dynamics, frame), edge }
    }

    /// Drops the forbidden region's edge where it does not cross the patch; returns false where all
    /// of it is forbidden.
    pub(super) fn settle_edge(&mut self) -> bool {
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
