//! In which order a window's cells are computed.
//!
//! Coarse levels come first, so that something is soon drawn everywhere; in each level the cells
//! near the pointer or the middle; a ring around the view last.

use std::collections::HashSet;

use super::explorer::MOST_CELLS;
use super::view_target::ViewTarget;
use crate::scene::lattice::{Cell, DEEPEST, Region, side_rad};

/// Levels between one pass and the next finer one: a quarter of the distance each time.
const LEVEL_STEP: u32 = 2;
/// Passes before the finest.
const COARSE_PASSES: u32 = 2;

/// The cells that an target wants, canonical, each once, and whether they are of the aim's own
/// level: the first `most` of them.
pub fn wanted(target: &ViewTarget, most: usize) -> Vec<(Cell, bool)> {
    let mut seen = HashSet::new();
    let cells = passes(target)
        .into_iter()
        .flat_map(|(cells, finest)| cells.into_iter().map(move |cell| (cell, finest)));
    cells.filter(|(cell, _)| seen.insert(*cell)).take(most).collect()
}

/// The cells of an target pass by pass, canonical, and whether they are of its own level.
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
    let mut placed = region.cells(level, MOST_CELLS);
    let far = |offset: [f64; 2], from: [f64; 2]| (offset[0] - from[0]).hypot(offset[1] - from[1]);
    let distance = |offset: [f64; 2]| {
        let middle = far(offset, [0.0, 0.0]);
        target.pointer.map_or(middle, |pointer| middle.min(far(offset, pointer)))
    };
    placed.sort_by(|a, b| distance(a.offset).total_cmp(&distance(b.offset)));
    placed.into_iter().map(|placed| placed.cell.canonical().0).collect()
}
