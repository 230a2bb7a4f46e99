//! The order in which a window's cells are computed.
//!
//! Coarse levels come first, so that something is soon drawn everywhere; within a level, the cells
//! nearest to the pointer or the middle come first. A ring around the view comes last.

use std::collections::HashSet;

use super::explorer::MOST_CELLS;
use super::view_target::ViewTarget;
use crate::scene::lattice::{Cell, DEEPEST, Region, side_rad};

/// Levels from one pass to the next finer one, which has a quarter of the sample distance.
pub(super) const LEVEL_STEP: u32 = 2;
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
