//! The order in which a window's cells are computed.
//!
//! Coarse levels come first, so that something is soon drawn everywhere; within a level, the cells
//! nearest to the pointer or the middle come first. A ring around the view comes last. Once all of
//! these are known, finer levels follow, of which only the samples at edges are computed
//! (`refinement.rs`).

use std::collections::HashSet;

use super::explorer::MOST_CELLS;
use super::view_target::ViewTarget;
use crate::scene::lattice::{Cell, DEEPEST, Region, SIDE, side_rad};

/// Levels from one pass to the next finer one, which has a quarter of the sample distance.
const LEVEL_STEP: u32 = 2;
/// Number of passes before the finest.
const COARSE_PASSES: u32 = 2;

/// The pass that a cell belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum CellPass {
    /// A level above the target's.
    Coarse,
    /// The target's level.
    Own,
    /// A level below the target's, of which only the samples at edges are computed.
    Finer,
}

/// A canonical cell to be known, and its pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Wanted {
    pub cell: Cell,
    pub pass: CellPass,
}

/// Returns the first `most` cells that a target needs, each once, without those of finer levels.
pub(super) fn wanted(target: &ViewTarget, most: usize) -> Vec<Wanted> {
    let mut seen = HashSet::new();
    passes(target).into_iter().flatten().filter(|w| seen.insert(w.cell)).take(most).collect()
}

/// Returns a target's cells pass by pass.
fn passes(target: &ViewTarget) -> Vec<Vec<Wanted>> {
    // The coarsest level of all has a pass, too: it takes a moment, and is a whole map.
    let mut coarse: Vec<_> =
        (1..=COARSE_PASSES).rev().map(|n| target.level.saturating_sub(n * LEVEL_STEP)).collect();
    coarse.dedup();
    coarse.retain(|&level| level < target.level);
    let mut passes: Vec<_> = coarse
        .into_iter()
        .map(|level| nearest_first(target, &target.region, level, CellPass::Coarse))
        .collect();
    passes.push(nearest_first(target, &target.region, target.level, CellPass::Own));
    let ring = side_rad(target.level.min(DEEPEST));
    let around =
        Region { half_rad: target.region.half_rad.map(|half| half + 0.5 * ring), ..target.region };
    passes.push(nearest_first(target, &around, target.level, CellPass::Own));
    passes
}

/// Returns the cells of the first `levels` finer levels, level by level and each once.
pub(super) fn finer(target: &ViewTarget, levels: u32) -> Vec<Wanted> {
    let mut seen = HashSet::new();
    let cells = (1..=levels)
        .flat_map(|n| nearest_first(target, &target.region, target.level + n, CellPass::Finer));
    cells.filter(|w| seen.insert(w.cell)).collect()
}

fn nearest_first(target: &ViewTarget, region: &Region, level: u32, pass: CellPass) -> Vec<Wanted> {
    let mirrors = target.physics.mirrors();
    let mut placed = region.cells(level, MOST_CELLS);
    let far = |offset: [f64; 2], from: [f64; 2]| (offset[0] - from[0]).hypot(offset[1] - from[1]);
    let distance = |offset: [f64; 2]| {
        let middle = far(offset, [0.0, 0.0]);
        target.pointer.map_or(middle, |pointer| middle.min(far(offset, pointer)))
    };
    placed.sort_by(|a, b| distance(a.offset).total_cmp(&distance(b.offset)));
    let canonical = placed.into_iter().map(|placed| placed.cell.computed(mirrors).0);
    canonical.map(|cell| Wanted { cell, pass }).collect()
}

/// Number of samples along a leaf of the cells of a level; those of the target's level have `finest`. The
/// pass before the finest has the same leaves, so that what is followed for it need not be followed
/// again; the last digits of its samples then depend on the target. So have the finer levels. The first
/// pass has larger leaves, since it is to be seen soon.
pub(super) fn leaf_pixels(finest: u32, target_level: u32, level: u32) -> u32 {
    if level > target_level {
        return (finest << (level - target_level)).min(SIDE);
    }
    let coarser = target_level.saturating_sub(level);
    let shared = if coarser <= LEVEL_STEP { coarser } else { 0 };
    (finest >> shared).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::{Scalar, Theta};

    #[test]
    fn the_last_two_passes_have_the_same_leaves() {
        let target = 40;
        let place = [2.2, -1.9].map(Theta::from_f64);
        let leaf_level = |level: u32, finest| {
            let leaf = leaf_pixels(finest, target, level);
            Cell::around(place, level).leaves(SIDE, leaf)[0].0.level
        };
        for finest in [16, 64] {
            let [first, last, own, finer] = [36, 38, 40, 41].map(|level| leaf_level(level, finest));
            assert_eq!((first, last, finer), (own - 4, own, own), "{finest} samples along a leaf");
        }
        assert_eq!(leaf_pixels(2, target, 38), 1, "a leaf has a sample");
    }
}
