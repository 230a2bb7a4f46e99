//! The cells of one level around a frame, with their colours.

use std::collections::HashMap;
use std::io;

use super::Mip;
use super::colours::HIGHEST;
use super::mip::{CellPlace, HEIGHT, Light, SampleLight};
use crate::tiles::patches::{PATCH_SIDE, offset_rad, patch_pitch_rad};
use flipmap_scene::lattice::Cell;
use flipmap_scene::{Grid, Turn, View};

/// Samples along each side of a patch.
const SIDE: usize = PATCH_SIDE as usize;

/// The light of the cells that a frame uses, and of those that the previous frame used.
pub(super) struct UsedLight<'a> {
    /// Light of the previous frame, by its index in the mip.
    pub before: &'a HashMap<u32, Light>,
    pub now: HashMap<u32, Light>,
}

/// The cells of one level around a frame.
pub(super) struct Layer {
    /// Position in samples from the lower left one, for each axis: its change per pixel to the
    /// right, its change per pixel down, and its value at the frame's upper left corner.
    place: [[f64; 3]; 2],
    /// The lower left cell.
    first: Cell,
    columns: usize,
    /// Row by row from the bottom; `None` for a cell without colours.
    cells: Vec<Option<Entry>>,
}

/// Source of a cell's samples: its own colours, or those of a coarser patch around it.
struct Entry {
    light: Light,
    shift: u32,
    /// Column and row of the cell's first sample in the patch, from the lower left, in samples of
    /// this level.
    first: [usize; 2],
    /// Index in the mip of the light for finer levels, if the colours are those of a patch.
    finer: Option<u32>,
}

impl Layer {
    /// Finds the cells of `level` that a frame touches, given its view and its grid of pixels.
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

    /// Returns the layer of the next finer level, made of the quarters of these cells.
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
                    Some(Entry { finer: Some(finer), shift, first, .. }) => {
                        let first = [0, 1].map(|i| 2 * first[i] + quarter[i] * SIDE);
                        Some(Entry::of_part(*finer, shift + 1, first, mip, used)?)
                    }
                    Some(_) => match mip.place(&cell()) {
                        Some(place) => Some(Entry::of_whole(place, mip, used)?),
                        None => None,
                    },
                    None => None,
                });
            }
        }
        // Positions count from the centre of a sample, which moves when the pitch is halved.
        let place = self.place.map(|[right, down, at]| [2.0 * right, 2.0 * down, 2.0 * at + 0.5]);
        let first = self.first.children()[0];
        Ok(Layer { place, first, columns: 2 * self.columns, cells })
    }

    /// Returns the light and height at a place of the frame, in pixels from its upper left corner,
    /// interpolated between four samples; `None` if one of them is missing. The height is 0 if one
    /// of them has none.
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

    /// Returns the height at a place as in [`Self::light`], from 0 to 1; `None` if one of the four
    /// samples is missing or has no height.
    pub(super) fn height(&self, place: [f64; 2]) -> Option<f32> {
        let height = self.light(place)?[HEIGHT];
        (height > 0.0).then(|| (height - 1.0) / HIGHEST as f32)
    }

    /// Returns a sample and its neighbours to the right, above, and above on the right.
    #[inline]
    fn four(&self, column: usize, row: usize) -> Option<[SampleLight; 4]> {
        let (x, y) = (column % SIDE, row % SIDE);
        if x + 1 < SIDE && y + 1 < SIDE {
            // Most groups of four lie in one cell.
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
    /// Returns the colours for a cell: its own, or those of the patch in which it lies.
    fn of(cell: Cell, mip: &mut Mip, used: &mut UsedLight) -> io::Result<Option<Self>> {
        let holders = (0..=cell.level).rev().map(|level| cell.ancestor(level));
        let known = |at: Cell| mip.place(&at).map(|place| (at, place));
        let Some((holder, place)) = holders.into_iter().find_map(known) else { return Ok(None) };
        if holder == cell {
            return Entry::of_whole(place, mip, used).map(Some);
        }
        // A coarser cell that is not a patch is found only where no frame looks.
        let Some(finer) = place.finer else { return Ok(None) };
        let first = cell.index_in(&holder).map(|sides| (sides * f64::from(PATCH_SIDE)) as usize);
        Entry::of_part(finer, cell.level - holder.level, first, mip, used).map(Some)
    }

    /// Returns the cell's own colours.
    fn of_whole(place: CellPlace, mip: &mut Mip, used: &mut UsedLight) -> io::Result<Self> {
        let light = used.light(place.own, mip)?;
        Ok(Entry { light, shift: 0, first: [0; 2], finer: place.finer })
    }

    /// Returns the colours of a part of a patch; `finer` is the index of the patch's light for
    /// finer levels.
    fn of_part(
        finer: u32,
        shift: u32,
        first: [usize; 2],
        mip: &mut Mip,
        used: &mut UsedLight,
    ) -> io::Result<Self> {
        Ok(Entry { light: used.light(finer, mip)?, shift, first, finer: Some(finer) })
    }

    /// Returns the sample at a column and row of the cell, counted from its lower left.
    #[inline]
    fn at(&self, column: usize, row: usize) -> SampleLight {
        let (column, row) =
            ((column + self.first[0]) >> self.shift, (row + self.first[1]) >> self.shift);
        self.light[(SIDE - 1 - row) * SIDE + column]
    }
}

impl UsedLight<'_> {
    /// Returns the light at an index of the mip, read only if neither frame has used it.
    fn light(&mut self, index: u32, mip: &mut Mip) -> io::Result<Light> {
        if let Some(light) = self.now.get(&index) {
            return Ok(light.clone());
        }
        let light = match self.before.get(&index) {
            Some(light) => light.clone(),
            None => mip.light(index)?,
        };
        self.now.insert(index, light.clone());
        Ok(light)
    }
}

/// Returns the cell that lies `by` cells to the right and up.
fn moved(cell: &Cell, by: [i64; 2]) -> Cell {
    let far = by.map(|by| Turn::side(cell.level).times(by as f64));
    Cell::at([cell.x + far[0], cell.y + far[1]], cell.level)
}
