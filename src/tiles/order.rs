//! The order in which a window's cells are computed.
//!
//! Coarse levels come first, so that something is soon drawn everywhere; within a level, the cells
//! nearest to the pointer or the middle come first. A ring around the view comes last.

use std::collections::HashSet;

use super::explorer::MOST_CELLS;
use super::view_target::ViewTarget;
use crate::scene::lattice::{Cell, DEEPEST, Region, side_rad};

/// Levels from one pass to the next finer one, which has a quarter of the sample distance.
const LEVEL_STEP: u32 = 2;
/// Number of passes before the finest.
const COARSE_PASSES: u32 = 2;

/// Returns the first `most` cells that a target needs, canonical and each once, with true for those
/// of the target's own level.
pub(super) fn wanted(target: &ViewTarget, most: usize) -> Vec<(Cell, bool)> {
    let mut seen = HashSet::new();
    let cells = passes(target)
        .into_iter()
        .flat_map(|(cells, finest)| cells.into_iter().map(move |cell| (cell, finest)));
    cells.filter(|(cell, _)| seen.insert(*cell)).take(most).collect()
}

/// Returns a target's cells pass by pass, canonical, with true for its own level.
fn passes(target: &ViewTarget) -> Vec<(Vec<Cell>, bool)> {
    let coarse = (1..=COARSE_PASSES).rev().filter_map(|n| target.level.checked_sub(n * LEVEL_STEP));
    let mut passes: Vec<_> =
        coarse.map(|level| (nearest_first(target, &target.region, level), false)).collect();
    passes.push((nearest_first(target, &target.region, target.level), true));
    let ring = side_rad(target.level.min(DEEPEST));
    let around =
        Region { half_rad: target.region.half_rad.map(|half| half + 0.5 * ring), ..target.region };
    passes.push((nearest_first(target, &around, target.level), true));
    passes
}

fn nearest_first(target: &ViewTarget, region: &Region, level: u32) -> Vec<Cell> {
    let mirrors = target.physics.mirrors();
    let mut placed = region.cells(level, MOST_CELLS);
    let far = |offset: [f64; 2], from: [f64; 2]| (offset[0] - from[0]).hypot(offset[1] - from[1]);
    let distance = |offset: [f64; 2]| {
        let middle = far(offset, [0.0, 0.0]);
        target.pointer.map_or(middle, |pointer| middle.min(far(offset, pointer)))
    };
    placed.sort_by(|a, b| distance(a.offset).total_cmp(&distance(b.offset)));
    placed.into_iter().map(|placed| placed.cell.computed(mirrors).0).collect()
}

/// Number of samples along a leaf of the cells of a level; those of the target's level have `finest`. The
/// pass before the finest has the same leaves, so that what is followed for it need not be followed
/// again; the last digits of its samples then depend on the target. The first pass has larger leaves,
/// since it is to be seen soon.
pub(super) fn leaf_pixels(finest: u32, target_level: u32, level: u32) -> u32 {
    let coarser = target_level.saturating_sub(level);
    let shared = if coarser <= LEVEL_STEP { coarser } else { 0 };
    (finest >> shared).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::{Scalar, Theta};
    use crate::scene::lattice::SIDE;

    #[test]
    fn the_last_two_passes_have_the_same_leaves() {
        let target = 40;
        let place = [2.2, -1.9].map(Theta::from_f64);
        let leaf_level = |level: u32, finest| {
            let leaf = leaf_pixels(finest, target, level);
            Cell::around(place, level).leaves(SIDE, leaf)[0].0.level
        };
        for finest in [16, 64] {
            let [first, last, own] = [36, 38, 40].map(|level| leaf_level(level, finest));
            assert_eq!((first, last), (own - 4, own), "{finest} samples along a leaf");
        }
        assert_eq!(leaf_pixels(2, target, 38), 1, "a leaf has a sample");
    }
}
