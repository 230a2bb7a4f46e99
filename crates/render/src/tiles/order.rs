//! The order in which a window's cells are computed.
//!
//! Passes over the view come one after the other, each with four times the samples of the one
//! before, so something is soon drawn everywhere; within a pass, the cells nearest to the pointer
//! or the middle come first. Coarse cells that reach beyond the view come after the first pass, to
//! stand in when the view moves; if starts are followed as cells, the coarse cells come first,
//! because their larger leaves are known sooner. Once all of these are known, finer levels follow,
//! of which only the samples at edges are computed (`refinement.rs`).

use std::collections::HashSet;

use super::explorer::MAX_CELLS;
use super::stride::Stride;
use super::view_target::ViewTarget;
use flipmap_scene::lattice::{Cell, pitch_rad};

/// Number of levels from the target's to that of the cells which reach beyond the view.
const AROUND_LEVELS: u32 = 3;

/// The pass that a cell belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum CellPass {
    /// Samples of the target's level.
    Own(Stride),
    /// Samples of a level above the target's, which reach beyond the view.
    Around,
    /// A level below the target's, of which only the samples at edges are computed.
    Finer,
}

impl CellPass {
    /// Returns the stride of the pass's samples in a cell.
    pub(super) fn stride(self) -> Stride {
        match self {
            CellPass::Own(stride) => stride,
            CellPass::Around => Stride::TWO,
            CellPass::Finer => Stride::ONE,
        }
    }
}

/// A canonical cell that is wanted, and its pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Wanted {
    pub cell: Cell,
    pub pass: CellPass,
}

/// Returns the cells that a target needs, except those of finer levels, pass by pass. At most
/// `most` of them are distinct.
pub(super) fn wanted(target: &ViewTarget, most: usize) -> Vec<Wanted> {
    let mut own = nearest_first(target, target.level);
    own.truncate(most);
    let mut around = Vec::new();
    if target.level > 0 {
        around = nearest_first(target, target.level.saturating_sub(AROUND_LEVELS));
    }
    around.truncate(most - own.len());
    let pass = |pass, cells: &[Cell]| -> Vec<Wanted> {
        cells.iter().map(|&cell| Wanted { cell, pass }).collect()
    };
    let mut passes = Stride::PASSES.map(|stride| pass(CellPass::Own(stride), &own));
    let around = pass(CellPass::Around, &around);
    let is_followed = target.physics.config.is_deep(pitch_rad(target.level));
    let place = if is_followed { 0 } else { own.len() };
    passes[0].splice(place..place, around);
    passes.concat()
}

/// Returns the cells of the first `levels` finer levels, level by level and each once.
pub(super) fn finer(target: &ViewTarget, levels: u32) -> Vec<Wanted> {
    let cells = (1..=levels).flat_map(|n| nearest_first(target, target.level + n));
    cells.map(|cell| Wanted { cell, pass: CellPass::Finer }).collect()
}

/// Returns the canonical cells of a level in view, each once, the nearest to the pointer or the
/// middle first.
fn nearest_first(target: &ViewTarget, level: u32) -> Vec<Cell> {
    let mirrors = target.physics.mirrors();
    let mut placed = target.region.cells(level, MAX_CELLS);
    let far = |offset: [f64; 2], from: [f64; 2]| (offset[0] - from[0]).hypot(offset[1] - from[1]);
    let distance = |offset: [f64; 2]| {
        let middle = far(offset, [0.0, 0.0]);
        target.pointer.map_or(middle, |pointer| middle.min(far(offset, pointer)))
    };
    placed.sort_by(|a, b| distance(a.offset).total_cmp(&distance(b.offset)));
    let mut seen = HashSet::new();
    let canonical = placed.into_iter().map(|placed| placed.cell.computed(mirrors).0);
    canonical.filter(|cell| seen.insert(*cell)).collect()
}

/// Returns the number of samples along a leaf of the cells of a level; at the target's level it is
/// `finest`. Finer levels have the same leaves, so a leaf that was followed for one level need not
/// be followed again; the last digits of their samples then depend on the target.
pub(super) fn leaf_pixels(finest: u32, target_level: u32, level: u32) -> u32 {
    finest << level.saturating_sub(target_level)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_numbers::{Exact, Scalar};
    use flipmap_scene::lattice::SIDE;

    #[test]
    fn finer_levels_have_the_same_leaves() {
        let target = 40;
        let place = [2.2, -1.9].map(Exact::from_f64);
        let leaf_level = |level: u32, finest| {
            let leaf = leaf_pixels(finest, target, level);
            Cell::around(place, level).leaves(SIDE, leaf)[0].0.level
        };
        for finest in [16, 64] {
            let own = leaf_level(40, finest);
            assert_eq!((leaf_level(41, finest), leaf_level(37, finest)), (own, own - 3));
        }
    }
}
