//! The choice of samples to draw for every cell in view: the cell's own or, until they arrive, the
//! finest known ones. Samples of the previous pendulum stand in while nothing is known of a new
//! one.

use glam::DVec2;

use super::fading::Fading;
use crate::camera::Screen;
use flipmap_render::tiles::cache::CachedCell;
use flipmap_render::tiles::explorer::{Explorer, MAX_CELLS};
use flipmap_scene::lattice::{Cell, Placed, SIDE, side_rad};

/// A part of a tile's samples, drawn as a parallelogram on the canvas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Patch {
    /// Cell whose samples, or those of its mirror image, are drawn.
    pub source: Cell,
    /// Set that the samples belong to.
    pub set: PatchSet,
    /// The first (upper left) corner, in points from the middle of the canvas, y down.
    pub corner: DVec2,
    /// The side from the first corner to the right, in points.
    pub right: DVec2,
    /// The side from the first corner downwards, in points.
    pub down: DVec2,
    /// Position of the first corner among the samples, in samples from their upper left.
    pub texel: DVec2,
    /// Number of samples along each side; negative for the mirror image.
    pub span: DVec2,
    /// Opacity of the samples, from 0 to 1.
    pub alpha: f32,
}

impl Patch {
    /// Returns the quarter of the patch in a column and in a row counted from below, each 0 or 1.
    fn quarter(&self, [column, from_below]: [f64; 2]) -> Patch {
        let (right, down, span) = (self.right / 2.0, self.down / 2.0, self.span / 2.0);
        let at = DVec2::new(column, 1.0 - from_below);
        let corner = self.corner + right * at.x + down * at.y;
        Patch { corner, right, down, texel: self.texel + span * at, span, ..*self }
    }
}

/// The samples that a patch may show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PatchSet {
    /// Samples of the previous target's physics.
    Before,
    /// Samples of the target.
    Own,
    /// Finer samples of the target, of which perhaps only those at edges were computed.
    Finer,
}

impl PatchSet {
    /// Returns what is known of a cell in the set, and true if the samples are those of its mirror
    /// image, in reverse order.
    pub(crate) fn known(self, explorer: &mut Explorer, cell: Cell) -> Option<(&CachedCell, bool)> {
        match self {
            PatchSet::Before => explorer.known_before(cell),
            PatchSet::Own => explorer.known(cell),
            PatchSet::Finer => explorer.known_finer(cell),
        }
    }
}

/// Number of finer levels that stand in for an unknown cell, as after zooming out.
const FINER_LEVELS: u32 = 2;

/// Returns the patches of every cell of a screen at its level, in drawing order. New patches appear
/// gradually. Known samples of up to `finer_levels` finer levels replace coarser ones.
pub(crate) fn cover(
    screen: &Screen,
    explorer: &mut Explorer,
    fading: &mut Fading,
    finer_levels: u32,
) -> Vec<CoveredCell> {
    let mut cells = Vec::new();
    for placed in screen.region().cells(screen.level(), MAX_CELLS) {
        let mut patches = Vec::new();
        let now = best(screen, explorer, &placed, PatchSet::Own, fading);
        let mut whole = now.whole;
        if !now.whole {
            let before = best(screen, explorer, &placed, PatchSet::Before, fading);
            whole |= before.whole;
            patches.extend(before.patches);
        }
        match now.patches[..] {
            [own] if own.source == placed.cell && own.alpha >= 1.0 => {
                refine(screen, explorer, &placed, own, finer_levels, &mut patches);
            }
            _ => patches.extend(now.patches),
        }
        cells.push(CoveredCell { patches, whole });
    }
    cells
}

/// Appends the patch `own` of a cell, with parts of it replaced where samples of up to `levels`
/// finer levels are known.
fn refine(
    screen: &Screen,
    explorer: &mut Explorer,
    placed: &Placed,
    own: Patch,
    levels: u32,
    patches: &mut Vec<Patch>,
) {
    if levels == 0 {
        patches.push(own);
        return;
    }
    let children = children(placed);
    let finer = children.map(|child| known(explorer, child.cell, PatchSet::Finer));
    if finer.iter().all(Option::is_none) {
        patches.push(own);
        return;
    }
    for (child, finer) in children.iter().zip(finer) {
        match finer {
            Some(source) => {
                let patch = patch(screen, child, source);
                refine(screen, explorer, child, patch, levels - 1, patches);
            }
            None => patches.push(own.quarter(child.cell.index_in(&placed.cell))),
        }
    }
}

/// Returns the quarters of a cell, each with its offset.
fn children(placed: &Placed) -> [Placed; 4] {
    let quarter = side_rad(placed.cell.level) / 4.0;
    placed.cell.children().map(|cell| {
        let away = cell.index_in(&placed.cell).map(|side| (2.0 * side - 1.0) * quarter);
        let offset = [placed.offset[0] + away[0], placed.offset[1] + away[1]];
        Placed { cell, offset }
    })
}

/// The patches that show a cell.
#[derive(Debug)]
pub(crate) struct CoveredCell {
    /// The patches in drawing order.
    pub patches: Vec<Patch>,
    /// True if they cover the whole cell.
    pub whole: bool,
}

fn best(
    screen: &Screen,
    explorer: &mut Explorer,
    placed: &Placed,
    set: PatchSet,
    fading: &mut Fading,
) -> CoveredCell {
    let mut own = known(explorer, placed.cell, set);
    let mut beneath = None;
    if own.is_none_or(|own| own.spacing > 1) {
        beneath = coarser(explorer, placed.cell, set);
        own = own.filter(|own| beneath.is_none_or(|coarser| own.spacing <= coarser.spacing));
    }
    let alpha = match own {
        Some(_) if set == PatchSet::Own => fading.cover(placed.cell),
        Some(_) => 1.0,
        None => 0.0,
    };
    let mut patches = Vec::new();
    if alpha < 1.0 {
        beneath = beneath.or_else(|| coarser(explorer, placed.cell, set));
        patches.extend(beneath.map(|source| patch(screen, placed, source)));
    }
    let whole = own.is_some() || !patches.is_empty();
    match own {
        Some(source) if patches.is_empty() => patches.push(patch(screen, placed, source)),
        Some(source) => patches.push(Patch { alpha, ..patch(screen, placed, source) }),
        None if set == PatchSet::Own => fading.stand_in(placed.cell),
        None => {}
    }
    let spacing = own.or(beneath).map_or(u32::MAX, |shown| shown.spacing);
    if spacing > 1 {
        finer(screen, explorer, placed, (set, spacing), FINER_LEVELS, &mut patches);
    }
    CoveredCell { patches, whole }
}

/// A cell whose samples, or those of its mirror image, are known.
#[derive(Clone, Copy)]
struct KnownSource {
    cell: Cell,
    set: PatchSet,
    mirrored: bool,
    /// Distance between the samples, in places of the cell that is drawn.
    spacing: u32,
}

fn known(explorer: &mut Explorer, cell: Cell, set: PatchSet) -> Option<KnownSource> {
    let (known, mirrored) = set.known(explorer, cell)?;
    Some(KnownSource { cell, set, mirrored, spacing: known.stride.places() })
}

/// Returns the finest known samples of the cells that contain a cell.
fn coarser(explorer: &mut Explorer, cell: Cell, set: PatchSet) -> Option<KnownSource> {
    let ancestors = std::iter::successors(cell.parent(), Cell::parent);
    let source = |(level, ancestor)| {
        let source = known(explorer, ancestor, set)?;
        let spacing = source.spacing.checked_shl(level).unwrap_or(u32::MAX);
        Some(KnownSource { spacing, ..source })
    };
    (1..).zip(ancestors).filter_map(source).min_by_key(|source| source.spacing)
}

/// Appends the patches of a cell's descendants whose known samples lie closer together than
/// `spacing` places of the cell, searched down `levels` levels.
fn finer(
    screen: &Screen,
    explorer: &mut Explorer,
    placed: &Placed,
    (set, spacing): (PatchSet, u32),
    levels: u32,
    patches: &mut Vec<Patch>,
) {
    let spacing = spacing.saturating_mul(2);
    for child in children(placed) {
        let source = known(explorer, child.cell, set).filter(|source| source.spacing < spacing);
        if let Some(source) = source {
            patches.push(patch(screen, &child, source));
        } else if levels > 1 {
            finer(screen, explorer, &child, (set, spacing), levels - 1, patches);
        }
    }
}

/// Returns the part of `source`'s samples that covers a cell inside it.
fn patch(screen: &Screen, placed: &Placed, source: KnownSource) -> Patch {
    let KnownSource { cell: source, set, mirrored, .. } = source;
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
    let (texel, span) = if mirrored {
        (DVec2::splat(f64::from(SIDE)) - texel, DVec2::splat(-samples))
    } else {
        (texel, DVec2::splat(samples))
    };
    let (right, down) = (at(1.0, 1.0) - corner, at(-1.0, -1.0) - corner);
    Patch { source, set, corner, right, down, texel, span, alpha: 1.0 }
}
