//! What is drawn for every cell in view: its own samples, or the best that is known until they
//! come.

use glam::DVec2;

use crate::app::camera::Screen;
use crate::tiles::explorer::{Explorer, MOST_CELLS};
use crate::tiles::lattice::{Cell, Placed, SIDE, side_rad};

/// Part of a tile's samples as a parallelogram on the canvas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// The cell whose samples are drawn, as computed.
    pub source: Cell,
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
    let level = screen.level();
    let mut patches = Vec::new();
    for placed in screen.region().cells(level, MOST_CELLS) {
        let best = std::iter::successors(Some(placed.cell), Cell::parent)
            .find(|cell| explorer.known(*cell).is_some());
        if let Some(source) = best {
            patches.push(patch(screen, &placed, source));
        }
        if best != Some(placed.cell) {
            finer(screen, explorer, &placed, FINER_LEVELS, &mut patches);
        }
    }
    patches
}

/// What is known of the quarters of a cell, and of theirs.
fn finer(
    screen: &Screen,
    explorer: &mut Explorer,
    placed: &Placed,
    levels: u32,
    patches: &mut Vec<Patch>,
) {
    let quarter = side_rad(placed.cell.level).hi / 4.0;
    for cell in placed.cell.children() {
        let away = |bit: u128| if bit == 0 { -quarter } else { quarter };
        let offset = [placed.offset[0] + away(cell.x & 1), placed.offset[1] + away(cell.y & 1)];
        let child = Placed { cell, offset };
        if explorer.known(cell).is_some() {
            patches.push(patch(screen, &child, cell));
        } else if levels > 1 {
            finer(screen, explorer, &child, levels - 1, patches);
        }
    }
}

/// The part of `source`'s samples that covers a cell inside it.
fn patch(screen: &Screen, placed: &Placed, source: Cell) -> Patch {
    let side = side_rad(placed.cell.level).hi;
    let middle = DVec2::from_array(placed.offset);
    let at = |x: f64, y: f64| screen.point_of(middle + DVec2::new(x, y) * (side / 2.0));
    let corner = at(-1.0, 1.0);
    let depth = placed.cell.level - source.level;
    let parts = 2f64.powi(depth as i32);
    let samples = f64::from(SIDE) / parts;
    let column = (placed.cell.x - (source.x << depth)) as f64;
    let row = parts - 1.0 - (placed.cell.y - (source.y << depth)) as f64;
    let texel = DVec2::new(column, row) * samples;
    let (source, mirrored) = source.canonical();
    let (texel, span) = if mirrored {
        (DVec2::splat(f64::from(SIDE)) - texel, DVec2::splat(-samples))
    } else {
        (texel, DVec2::splat(samples))
    };
    Patch {
        source,
        corner,
        right: at(1.0, 1.0) - corner,
        down: at(-1.0, -1.0) - corner,
        texel,
        span,
    }
}
