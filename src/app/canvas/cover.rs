//! What is drawn for every cell in view: its own samples, or the best that is known until they
//! come; and while nothing is known of a changed pendulum, what was known of the one before.

use glam::DVec2;

use crate::app::camera::Screen;
use crate::scene::lattice::{Cell, Placed, SIDE, side_rad};
use crate::tiles::explorer::{Explorer, MOST_CELLS};

/// Part of a tile's samples as a parallelogram on the canvas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// The cell whose samples are drawn, as computed.
    pub source: Cell,
    /// Whether they are of the physics that was aimed at before.
    pub before: bool,
    /// The first corner and the way along its sides, in points from the canvas' middle, y down.
    pub corner: DVec2,
    /// To the right.
    pub right: DVec2,
    /// Down.
    pub down: DVec2,
    /// Of the first corner among the samples, from their upper left.
    pub texel: DVec2,
    /// Samples across; negative for the mirror image.
    pub span: DVec2,
}

/// Levels below a cell that stand in for it while it is not known, as when one has zoomed out.
const FINER_LEVELS: u32 = 2;

/// The patches of a screen at its level, in the order in which they are drawn.
pub fn cover(screen: &Screen, explorer: &mut Explorer) -> Vec<Patch> {
    let mut patches = Vec::new();
    for placed in screen.region().cells(screen.level(), MOST_CELLS) {
        let now = best(screen, explorer, &placed, false);
        if !now.whole {
            patches.extend(best(screen, explorer, &placed, true).patches);
        }
        patches.extend(now.patches);
    }
    patches
}

/// The best that is known of a cell.
struct Best {
    /// In the order in which they are drawn.
    patches: Vec<Patch>,
    /// Whether they leave nothing of the cell free.
    whole: bool,
}

fn best(screen: &Screen, explorer: &mut Explorer, placed: &Placed, before: bool) -> Best {
    let source = std::iter::successors(Some(placed.cell), Cell::parent)
        .find(|cell| is_known(explorer, *cell, before));
    let mut patches: Vec<Patch> =
        source.map(|source| patch(screen, placed, source, before)).into_iter().collect();
    if source != Some(placed.cell) {
        finer(screen, explorer, placed, before, FINER_LEVELS, &mut patches);
    }
    Best { patches, whole: source.is_some() }
}

fn is_known(explorer: &mut Explorer, cell: Cell, before: bool) -> bool {
    if before { explorer.known_before(cell).is_some() } else { explorer.known(cell).is_some() }
}

/// What is known of the quarters of a cell, and of theirs.
fn finer(
    screen: &Screen,
    explorer: &mut Explorer,
    placed: &Placed,
    before: bool,
    levels: u32,
    patches: &mut Vec<Patch>,
) {
    let quarter = side_rad(placed.cell.level) / 4.0;
    for cell in placed.cell.children() {
        let away = cell.index_in(&placed.cell).map(|side| (2.0 * side - 1.0) * quarter);
        let offset = [placed.offset[0] + away[0], placed.offset[1] + away[1]];
        let child = Placed { cell, offset };
        if is_known(explorer, cell, before) {
            patches.push(patch(screen, &child, cell, before));
        } else if levels > 1 {
            finer(screen, explorer, &child, before, levels - 1, patches);
        }
    }
}

/// The part of `source`'s samples that covers a cell inside it.
fn patch(screen: &Screen, placed: &Placed, source: Cell, before: bool) -> Patch {
    let side = side_rad(placed.cell.level);
    let middle = DVec2::from_array(placed.offset);
    let at = |x: f64, y: f64| screen.point_of(middle + DVec2::new(x, y) * (side / 2.0));
    let corner = at(-1.0, 1.0);
    let depth = placed.cell.level - source.level;
    let parts = 2f64.powi(depth as i32);
    let samples = f64::from(SIDE) / parts;
    let [column, from_below] = placed.cell.index_in(&source);
    let row = parts - 1.0 - from_below;
    let texel = DVec2::new(column, row) * samples;
    let (source, mirrored) = source.canonical();
    let (texel, span) = if mirrored {
        (DVec2::splat(f64::from(SIDE)) - texel, DVec2::splat(-samples))
    } else {
        (texel, DVec2::splat(samples))
    };
    let (right, down) = (at(1.0, 1.0) - corner, at(-1.0, -1.0) - corner);
    Patch { source, before, corner, right, down, texel, span }
}
