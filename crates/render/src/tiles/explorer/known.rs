//! Looks up the known cells of a window, and how far its target is computed.

use std::sync::Arc;

use super::{Explorer, MAX_CELLS, ViewProgress};
use crate::tiles::cache::{CachedCell, SampleSet};
use crate::tiles::order::{CellPass, Wanted};
use crate::tiles::refinement::Coarser;
use crate::tiles::view_target::Physics;
use flipmap_scene::lattice::Cell;

impl Explorer {
    /// Returns the physics of the cells that are drawn: the previous physics while its cells stand
    /// in for the target's.
    pub fn drawn(&self) -> Option<&Physics> {
        let key = self.before.filter(|_| !self.progress().covered).unwrap_or(self.key);
        self.physics.get(key).map(|known| &known.physics)
    }

    /// Returns what is known of a cell of the target, canonical or not, and true if the samples are
    /// those of its mirror image, in reverse order.
    pub fn known(&mut self, cell: Cell) -> Option<(&CachedCell, bool)> {
        self.target.as_ref()?;
        self.look(self.key, cell)
    }

    /// Works like [`Explorer::known`] for the previous physics, which is still drawn in places
    /// where nothing of the target's physics is known.
    pub fn known_before(&mut self, cell: Cell) -> Option<(&CachedCell, bool)> {
        self.look(self.before?, cell)
    }

    /// Works like [`Explorer::known`], but also finds cells of which only the samples at edges were
    /// computed, and skips cells computed with less than the target's budget, in which fewer
    /// samples have flipped than in the cells beside them.
    pub fn known_finer(&mut self, cell: Cell) -> Option<(&CachedCell, bool)> {
        let set = self.finer_set(cell)?;
        let (computed, mirrored) = cell.computed(self.mirrors(self.key));
        self.cache.get(set, computed).map(|known| (known, mirrored))
    }

    fn look(&mut self, physics: usize, cell: Cell) -> Option<(&CachedCell, bool)> {
        let (computed, mirrored) = cell.computed(self.mirrors(physics));
        let set = SampleSet { physics, refined: false };
        self.cache.get(set, computed).map(|known| (known, mirrored))
    }

    /// Returns a set of samples of the target's physics.
    pub(super) fn set(&self, refined: bool) -> SampleSet {
        SampleSet { physics: self.key, refined }
    }

    /// Returns the key under which the cache keeps a wanted cell of the target.
    pub(super) fn cache_key(&self, wanted: &Wanted) -> (SampleSet, Cell) {
        (self.set(wanted.pass == CellPass::Finer), wanted.cell)
    }

    /// Returns what is known of a cell of the target's physics, without counting it as used.
    pub(super) fn peek(&self, cell: Cell) -> Option<&CachedCell> {
        self.cache.peek(self.set(false), cell.computed(self.mirrors(self.key)).0)
    }

    /// Works like [`Explorer::known_finer`], without counting the cell as used.
    pub(super) fn peek_finer(&self, cell: Cell) -> Option<&CachedCell> {
        let (computed, _) = cell.computed(self.mirrors(self.key));
        self.cache.peek(self.finer_set(cell)?, computed)
    }

    /// Returns the set in which a cell is known to the target's budget.
    fn finer_set(&self, cell: Cell) -> Option<SampleSet> {
        let budget_secs = self.target.as_ref()?.budget_secs;
        let (computed, _) = cell.computed(self.mirrors(self.key));
        let is_known = |set: &SampleSet| {
            self.cache.peek(*set, computed).is_some_and(|known| known.is_complete(budget_secs))
        };
        [false, true].map(|refined| self.set(refined)).into_iter().find(is_known)
    }

    /// Returns, for each of these cells, the samples from which those far from edges are
    /// interpolated.
    pub(super) fn coarser(&self, cells: &[Cell]) -> Vec<Option<Coarser>> {
        let of = |cell: &Cell| {
            let parent = cell.parent()?;
            let (_, mirrored) = parent.computed(self.mirrors(self.key));
            let samples = Arc::clone(&self.peek_finer(parent)?.samples);
            Some(Coarser::of(cell, &parent, samples, mirrored))
        };
        cells.iter().map(of).collect()
    }

    pub(super) fn mirrors(&self, key: usize) -> bool {
        self.physics.get(key).is_some_and(|known| known.mirrors)
    }

    /// Returns the progress of the newest target.
    pub fn progress(&self) -> ViewProgress {
        let Some(target) = &self.target else { return ViewProgress::default() };
        let known = |cell: Cell| self.peek(cell);
        let placed = target.region.cells(target.level, MAX_CELLS);
        let share = |cell| known(cell).map_or(0.0, |known| known.share(target.budget_secs));
        let shares: Vec<f64> = placed.iter().map(|placed| share(placed.cell)).collect();
        let drawn = |cell: Cell| {
            std::iter::successors(Some(cell), Cell::parent).any(|cell| known(cell).is_some())
        };
        let share = shares.iter().sum::<f64>() / shares.len().max(1) as f64;
        let finer = if share < 1.0 { 0.0 } else { self.refinement.share(self.left()) };
        let way = if self.refinement.is_wanted() { 0.5 * (share + finer) } else { share };
        ViewProgress {
            level: target.level,
            wanted: placed.len(),
            done: shares.iter().filter(|share| **share == 1.0).count(),
            share,
            way,
            covered: !placed.is_empty() && placed.iter().all(|placed| drawn(placed.cell)),
            idle: self.is_done() || self.refinement.begun > 0,
            refines: self.refines(),
        }
    }

    /// Returns true if only finer samples at edges are being computed.
    pub fn refines(&self) -> bool {
        !self.is_done() && self.refinement.begun > 0
    }
}
