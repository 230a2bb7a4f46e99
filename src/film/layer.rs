//! The cells of one level around a frame, with their colours.

use std::collections::HashMap;
use std::io;

use super::Mip;
use super::colours::HIGHEST;
use super::mip::{HEIGHT, Light, SampleLight};
use crate::scene::lattice::Cell;
use crate::scene::{Grid, Turn, View};
use crate::tiles::patches::{PATCH_SIDE, offset_rad, patch_pitch_rad};

/// Samples along each side of a patch.
const SIDE: usize = PATCH_SIDE as usize;

/// The light of the cells that a frame uses, and of those that the frame before it used.
pub(super) struct UsedLight<'a> {
    pub before: &'a HashMap<Cell, Light>,
    pub now: HashMap<Cell, Light>,
}

/// The cells of one level around a frame.
pub(super) struct Layer {
    /// The place of a point of the frame in samples from the lower left one, along both axes: what
    /// it changes by for each pixel to the right and down, and where the frame's upper left corner is.
    place: [[f64; 3]; 2],
    /// The lower left cell.
    first: Cell,
    columns: usize,
    /// Rows from below.
    cells: Vec<Option<Entry>>,
}

/// Place of a cell's samples: in its own colours, or in those of a coarser patch around it.
struct Entry {
    light: Light,
    shift: u32,
    /// Samples of this level in the patch before the cell's own, to the right and up.
    first: [usize; 2],
    /// True if the light is a patch's: no finer cells have colours of their own.
    is_patch: bool,
}

impl Layer {
    /// The cells of `level` that a frame touches, given its view and its pixels.
    pub(super) fn around(
        view: &View,
        grid: &Grid,
        level: u32,
        mip: &mut Mip,
        used: &mut UsedLight,
    ) -> io::Result<Self> {
        let ([right, up], size) = (grid.pixel_axes(), grid.size());
        let pitch = patch_pitch_rad(level);
        let center = view.center_rad().map(Turn::from_theta);
        let middle = Cell::at(center, level);
        let corner = offset_rad([middle.x, middle.y], center).map(|rad| rad / pitch);
        let half = [0, 1].map(|i| {
            let extent = f64::from(size[0]) * right[i].abs() + f64::from(size[1]) * up[i].abs();
            0.5 * extent / pitch + 1.0
        });
        let cells_to =
            |i: usize, samples: f64| ((samples - corner[i]) / f64::from(PATCH_SIDE)).floor() as i64;
        let [x, y] = [0, 1].map(|i| cells_to(i, -half[i])..=cells_to(i, half[i]));
        let first = moved(&middle, [*x.start(), *y.start()]);
        let place = [(0, &x), (1, &y)].map(|(i, cells)| {
            let origin = corner[i] + (*cells.start() * i64::from(PATCH_SIDE)) as f64;
            let [right, up] = [right[i] / pitch, up[i] / pitch];
            let [across, down] = size.map(|side| 0.5 * f64::from(side));
            [right, -up, down * up - across * right - origin - 0.5]
        });
        let mut cells = Vec::new();
        for row in y {
            for column in x.clone() {
                cells.push(Entry::of(moved(&middle, [column, row]), mip, used)?);
            }
        }
        Ok(Layer { place, first, columns: x.count(), cells })
    }

    /// The quarters of its cells: the next finer level.
    pub(super) fn finer(&self, mip: &mut Mip, used: &mut UsedLight) -> io::Result<Self> {
        let mut cells = Vec::with_capacity(4 * self.cells.len());
        for row in 0..2 * (self.cells.len() / self.columns) {
            for column in 0..2 * self.columns {
                let whole = self.cells[row / 2 * self.columns + column / 2].as_ref();
                let quarter = [column % 2, row % 2];
                let cell = || {
                    let whole = moved(&self.first, [column / 2, row / 2].map(|k| k as i64));
                    whole.children()[2 * quarter[0] + quarter[1]]
                };
                cells.push(match whole {
                    Some(whole) if whole.is_patch => Some(whole.quarter(quarter)),
                    Some(_) => Entry::of_own(cell(), mip, used)?,
                    None => None,
                });
            }
        }
        // Places lie between samples, which are half as far apart.
        let place = self.place.map(|[right, down, at]| [2.0 * right, 2.0 * down, 2.0 * at + 0.5]);
        let first = self.first.children()[0];
        Ok(Layer { place, first, columns: 2 * self.columns, cells })
    }

    /// Light and height at a place of the frame, in pixels from its upper left corner, interpolated
    /// between four samples; none where one of them is missing. The height is 0 beside a sample
    /// without one.
    pub(super) fn light(&self, [across, down]: [f64; 2]) -> Option<[f32; 4]> {
        let along = |[right, below, at]: [f64; 3]| across * right + down * below + at;
        let (x, y) = (along(self.place[0]), along(self.place[1]));
        if x < 0.0 || y < 0.0 {
            return None;
        }
        let (column, row) = (x as usize, y as usize);
        let (right, above) = ((x - column as f64) as f32, (y - row as f64) as f32);
        let (left, below) = (1.0 - right, 1.0 - above);
        let four = self.four(column, row)?;
        let weights = [left * below, right * below, left * above, right * above];
        let mut sum = [0.0; 4];
        for (sample, weight) in four.iter().zip(weights) {
            for (sum, number) in sum.iter_mut().zip(sample) {
                *sum += weight * f32::from(*number);
            }
        }
        if four.iter().any(|sample| sample[HEIGHT] == 0) {
            sum[HEIGHT] = 0.0;
        }
        Some(sum)
    }

    /// The height at such a place, from 0 to 1; none beside a sample without one.
    pub(super) fn height(&self, place: [f64; 2]) -> Option<f32> {
        let height = self.light(place)?[HEIGHT];
        (height > 0.0).then(|| (height - 1.0) / HIGHEST as f32)
    }

    /// A sample with those to its right, above it, and above that on its right.
    #[inline]
    fn four(&self, column: usize, row: usize) -> Option<[SampleLight; 4]> {
        let (x, y) = (column % SIDE, row % SIDE);
        if x + 1 < SIDE && y + 1 < SIDE {
            // Most lie in one cell.
            let entry = self.entry(column / SIDE, row / SIDE)?;
            return Some([
                entry.at(x, y),
                entry.at(x + 1, y),
                entry.at(x, y + 1),
                entry.at(x + 1, y + 1),
            ]);
        }
        let sample = |column: usize, row: usize| {
            let entry = self.entry(column / SIDE, row / SIDE)?;
            Some(entry.at(column % SIDE, row % SIDE))
        };
        Some([
            sample(column, row)?,
            sample(column + 1, row)?,
            sample(column, row + 1)?,
            sample(column + 1, row + 1)?,
        ])
    }

    #[inline]
    fn entry(&self, column: usize, row: usize) -> Option<&Entry> {
        if column >= self.columns {
            return None;
        }
        self.cells.get(row * self.columns + column)?.as_ref()
    }
}

impl Entry {
    /// The colours for a cell: its own, or those of the patch in which it lies.
    fn of(cell: Cell, mip: &mut Mip, used: &mut UsedLight) -> io::Result<Option<Self>> {
        let levels = (0..=cell.level).rev();
        let known = |level: u32| {
            let at = cell.ancestor(level);
            mip.is_patch(&at).map(|is_patch| (at, is_patch))
        };
        let Some((holder, is_patch)) = levels.into_iter().find_map(known) else { return Ok(None) };
        let shift = cell.level - holder.level;
        // A coarser cell that is not a patch is found only where no frame looks.
        if shift > 0 && !is_patch {
            return Ok(None);
        }
        let first = cell.index_in(&holder).map(|sides| (sides * f64::from(PATCH_SIDE)) as usize);
        Ok(Some(Entry { light: used.light(holder, mip)?, shift, first, is_patch }))
    }

    /// The colours of a cell itself, if it has some.
    fn of_own(cell: Cell, mip: &mut Mip, used: &mut UsedLight) -> io::Result<Option<Self>> {
        let Some(is_patch) = mip.is_patch(&cell) else { return Ok(None) };
        Ok(Some(Entry { light: used.light(cell, mip)?, shift: 0, first: [0; 2], is_patch }))
    }

    /// The colours of a quarter of a patch or of a part of one.
    fn quarter(&self, quarter: [usize; 2]) -> Self {
        let first = [0, 1].map(|i| 2 * self.first[i] + quarter[i] * SIDE);
        Entry { light: self.light.clone(), shift: self.shift + 1, first, is_patch: true }
    }

    /// The sample so many samples to the right and up in the cell.
    #[inline]
    fn at(&self, column: usize, row: usize) -> SampleLight {
        let (column, row) =
            ((column + self.first[0]) >> self.shift, (row + self.first[1]) >> self.shift);
        self.light[(SIDE - 1 - row) * SIDE + column]
    }
}

impl UsedLight<'_> {
    /// The light of a cell that has some.
    fn light(&mut self, cell: Cell, mip: &mut Mip) -> io::Result<Light> {
        if let Some(light) = self.now.get(&cell) {
            return Ok(light.clone());
        }
        let light = match self.before.get(&cell) {
            Some(light) => light.clone(),
            None => mip.light(&cell)?,
        };
        self.now.insert(cell, light.clone());
        Ok(light)
    }
}

/// The cell so many cells to the right and up.
fn moved(cell: &Cell, by: [i64; 2]) -> Cell {
    let far = by.map(|by| Turn::side(cell.level).times(by as f64));
    Cell::at([cell.x + far[0], cell.y + far[1]], cell.level)
}
