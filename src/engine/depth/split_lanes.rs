//! Branches of a domain splitting that are followed together, one in each SIMD lane.

use std::sync::atomic::Ordering;

use super::domain_splitting::{Distribution, DomainSplitting, SplitRequest};
use super::part::{Branch, BranchState, PlacedStart, SplitNode, SplitPart};
use crate::physics::flow_patch::{Follower, JET_LANES, PatchEnd, carry};
use crate::physics::jet::Jet;

/// Branches that are followed together: a lane whose part has ended takes the next one.
pub(super) struct SplitLanes<'a> {
    splitting: &'a DomainSplitting,
    wanted: SplitRequest<'a>,
    waiting: Vec<Branch>,
    lanes: Vec<Lane>,
    all: Distribution,
}

/// A part that is being followed.
struct Lane {
    part: SplitPart,
    starts: Vec<PlacedStart>,
    edge: Option<Jet>,
    follower: Follower,
}

impl<'a> SplitLanes<'a> {
    /// Lanes for branches that have not been followed yet.
    pub(super) fn new(
        splitting: &'a DomainSplitting,
        waiting: Vec<Branch>,
        wanted: SplitRequest<'a>,
    ) -> Self {
        SplitLanes { splitting, wanted, waiting, lanes: Vec::new(), all: Distribution::default() }
    }

    /// Follows all branches to their ends, or only some if cancelled.
    pub(super) fn run(mut self) -> Distribution {
        loop {
            self.fill();
            if self.lanes.is_empty() || self.wanted.cancelled.load(Ordering::Relaxed) {
                return self.all;
            }
            self.step();
        }
    }

    fn fill(&mut self) {
        while self.lanes.len() < JET_LANES {
            let Some(Branch { part, starts, way }) = self.waiting.pop() else { return };
            match way {
                BranchState::Ended(finished) => {
                    let parts =
                        self.splitting.cut(part, starts, finished, self.wanted, &mut self.all);
                    self.waiting.extend(parts);
                }
                BranchState::Open(node) if self.splitting.holds(&node, &part) => {
                    let SplitNode { patch, edge } = *node;
                    let tolerance = self.splitting.tolerance(part.above[0]);
                    let follower = Follower::new(patch, self.wanted.budget, tolerance);
                    self.lanes.push(Lane { part, starts, edge, follower });
                }
                BranchState::Open(node) => self.end(part, starts, *node, PatchEnd::Spread),
            }
        }
    }

    /// Plans, carries and takes one step in every lane.
    fn step(&mut self) {
        let dynamics = &self.splitting.dynamics;
        let mut plans = Vec::with_capacity(JET_LANES);
        let mut lane = 0;
        while lane < self.lanes.len() {
            match self.lanes[lane].follower.plan(dynamics, None) {
                Ok(plan) => {
                    plans.push(plan);
                    lane += 1;
                }
                Err(end) => self.leave(lane, end),
            }
        }
        let planned: Vec<_> =
            self.lanes.iter().zip(&plans).map(|(lane, plan)| (&lane.follower, *plan)).collect();
        if planned.is_empty() {
            return;
        }
        let after = carry(dynamics, &planned);
        for (lane, (plan, after)) in plans.into_iter().zip(after).enumerate().rev() {
            if let Some(end) = self.lanes[lane].follower.take(dynamics, plan, after, None) {
                self.leave(lane, end);
            }
        }
    }

    /// Frees a lane whose part has ended.
    fn leave(&mut self, lane: usize, end: PatchEnd) {
        let Lane { part, starts, edge, follower } = self.lanes.remove(lane);
        self.end(part, starts, SplitNode { patch: follower.into_patch(), edge }, end);
    }

    fn end(&mut self, part: SplitPart, starts: Vec<PlacedStart>, node: SplitNode, end: PatchEnd) {
        let finished = self.splitting.finish(&part, node, end, self.wanted, &mut self.all);
        self.waiting.push(Branch { part, starts, way: BranchState::Ended(finished) });
    }
}
