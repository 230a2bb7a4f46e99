//! Branches of a domain splitting that are followed together, one in each SIMD lane.

use std::sync::atomic::Ordering;

use super::domain_splitting::{Branch, DomainSplitting, SplitRequest};
use super::start_map::StartMap;
use crate::physics::flow_patch::{Follower, JET_LANES, PatchEnd, carry};
use crate::scene::lattice::Cell;

/// Branches that are followed together: a lane whose cell has ended takes the next one.
pub(super) struct SplitLanes<'a> {
    splitting: &'a DomainSplitting,
    wanted: SplitRequest<'a>,
    waiting: Vec<Branch>,
    lanes: Vec<(Branch, Follower)>,
    start_maps: Vec<(Cell, StartMap)>,
}

impl<'a> SplitLanes<'a> {
    /// Lanes for branches that have not been followed yet.
    pub(super) fn new(
        splitting: &'a DomainSplitting,
        waiting: Vec<Branch>,
        wanted: SplitRequest<'a>,
    ) -> Self {
        SplitLanes { splitting, wanted, waiting, lanes: Vec::new(), start_maps: Vec::new() }
    }

    /// Follows all branches to their leaves and returns the start maps; some, if cancelled.
    pub(super) fn run(mut self) -> Vec<(Cell, StartMap)> {
        loop {
            self.fill();
            if self.lanes.is_empty() || self.wanted.cancelled.load(Ordering::Relaxed) {
                return self.start_maps;
            }
            self.step();
        }
    }

    fn fill(&mut self) {
        while self.lanes.len() < JET_LANES {
            let Some(branch) = self.waiting.pop() else { return };
            if branch.holds(&self.splitting.dynamics) {
                let patch = branch.node.patch.clone();
                let follower = Follower::new(patch, self.wanted.budget, branch.tolerance);
                self.lanes.push((branch, follower));
            } else {
                self.end(branch, PatchEnd::Spread);
            }
        }
    }

    /// Plans, carries and takes one step in every lane.
    fn step(&mut self) {
        let dynamics = &self.splitting.dynamics;
        let mut plans = Vec::with_capacity(JET_LANES);
        let mut lane = 0;
        while lane < self.lanes.len() {
            match self.lanes[lane].1.plan(dynamics, None) {
                Ok(plan) => {
                    plans.push(plan);
                    lane += 1;
                }
                Err(end) => self.leave(lane, end),
            }
        }
        let planned: Vec<_> =
            self.lanes.iter().zip(&plans).map(|((_, follower), plan)| (follower, *plan)).collect();
        if planned.is_empty() {
            return;
        }
        let after = carry(dynamics, &planned);
        for (lane, (plan, after)) in plans.into_iter().zip(after).enumerate().rev() {
            if let Some(end) = self.lanes[lane].1.take(dynamics, plan, after, None) {
                self.leave(lane, end);
            }
        }
    }

    /// Frees a lane whose cell has ended.
    fn leave(&mut self, lane: usize, end: PatchEnd) {
        let (mut branch, follower) = self.lanes.remove(lane);
        branch.node.patch = follower.into_patch();
        self.end(branch, end);
    }

    fn end(&mut self, branch: Branch, end: PatchEnd) {
        let parts = self.splitting.cut(branch, end, self.wanted, &mut self.start_maps);
        self.waiting.extend(parts);
    }
}
