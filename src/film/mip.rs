//! The colours of patches, and of every cell above them at 1/2, 1/4, … of their resolution; under
//! light from the side, their heights too.
//!
//! They lie in an unnamed file, which the system keeps in memory as far as there is room: a deep
//! zoom may have more colours than fit.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::Arc;

use crate::scene::lattice::Cell;
use crate::tiles::patches::{PATCH_SAMPLES, PATCH_SIDE};

/// Linear light of a patch: three numbers per sample, row by row from the top. Under light from the
/// side each has a fourth, its height: 1 to 65535, or 0 without one.
pub type Light = Arc<[u16]>;

/// Index of the height among the numbers of a sample.
pub(super) const HEIGHT: usize = 3;

/// The colours of cells, in a file.
pub struct Mip {
    file: File,
    /// Index of each cell in the file, and true if it is a patch.
    places: HashMap<Cell, (u32, bool)>,
    /// Number of numbers per sample, 3 or 4.
    channels: usize,
}

impl Mip {
    /// Builds the mip of `patches`, given in depth-first order of quarters of quarters; `light`
    /// returns theirs one by one in that order, with 3 or 4 numbers per sample. The file lies in
    /// `folder`.
    pub fn build<E: From<io::Error>>(
        patches: &[Cell],
        channels: usize,
        folder: &Path,
        light: &mut dyn FnMut() -> Result<Light, E>,
    ) -> Result<Mip, E> {
        let mut builder = Builder {
            out: BufWriter::with_capacity(1 << 20, tempfile::tempfile_in(folder)?),
            places: HashMap::new(),
            channels,
            light,
        };
        if !patches.is_empty() {
            builder.build(Cell::WHOLE, patches)?;
        }
        let file = builder.out.into_inner().map_err(io::IntoInnerError::into_error)?;
        Ok(Mip { file, places: builder.places, channels })
    }

    /// Returns true for a patch, false for a cell above patches, `None` where there are no colours.
    pub fn is_patch(&self, cell: &Cell) -> Option<bool> {
        self.places.get(cell).map(|(_, patch)| *patch)
    }

    /// Number of numbers per sample, 3 or 4.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Reads the colours of a cell that has some.
    pub fn light(&mut self, cell: &Cell) -> io::Result<Light> {
        let (place, _) = self.places[cell];
        let mut numbers = vec![0u16; self.channels * PATCH_SAMPLES];
        self.file.seek(SeekFrom::Start(u64::from(place) * 2 * numbers.len() as u64))?;
        self.file.read_exact(bytemuck::cast_slice_mut(&mut numbers))?;
        Ok(numbers.into())
    }
}

struct Builder<'a, E> {
    out: BufWriter<File>,
    places: HashMap<Cell, (u32, bool)>,
    channels: usize,
    light: &'a mut dyn FnMut() -> Result<Light, E>,
}

impl<E: From<io::Error>> Builder<'_, E> {
    /// Writes and returns the colours of a cell, whose patches these are.
    fn build(&mut self, cell: Cell, patches: &[Cell]) -> Result<Light, E> {
        let is_patch = patches == [cell];
        let light = if is_patch { (self.light)()? } else { self.halved(&cell, patches)? };
        let place = self.places.len() as u32;
        self.out.write_all(bytemuck::cast_slice(&light))?;
        self.places.insert(cell, (place, is_patch));
        Ok(light)
    }

    /// The means of two by two samples of a cell's quarters; black where no frame looks.
    fn halved(&mut self, cell: &Cell, patches: &[Cell]) -> Result<Light, E> {
        let mut all = vec![0u16; self.channels * PATCH_SAMPLES];
        let mut rest = patches;
        for (k, child) in cell.children().into_iter().enumerate() {
            let inside = |patch: &Cell| patch.ancestor(child.level) == child;
            let count = rest.iter().take_while(|patch| inside(patch)).count();
            let (own, others) = rest.split_at(count);
            rest = others;
            if !own.is_empty() {
                let light = self.build(child, own)?;
                // Children: the left two from below, then the right two; rows count from the top.
                put_quarter(&mut all, &light, self.channels, [k / 2, 1 - k % 2]);
            }
        }
        Ok(all.into())
    }
}

/// Puts a patch's means into the quarter of another, so many quarters to the right and down.
fn put_quarter(all: &mut [u16], light: &[u16], channels: usize, [right, down]: [usize; 2]) {
    let side = PATCH_SIDE as usize;
    let half = side / 2;
    for row in 0..half {
        for column in 0..half {
            let to = channels * ((down * half + row) * side + right * half + column);
            let from = 2 * row * side + 2 * column;
            for channel in 0..channels {
                let at = |by: usize| light[channels * (from + by) + channel];
                let four = [at(0), at(1), at(side), at(side + 1)];
                // A place that is partly without a height has none.
                let lacks = channel == HEIGHT && four.contains(&0);
                let sum: u32 = four.into_iter().map(u32::from).sum();
                all[to + channel] = if lacks { 0 } else { ((sum + 2) / 4) as u16 };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_above_patches_has_their_means() {
        let [a, b, c, d] = Cell::WHOLE.children();
        // The last quarter is finer, and half of it is not seen.
        let [e, f, ..] = d.children();
        let patches = [a, b, c, e, f];
        let mut next = 0u16;
        let mut light = || {
            next += 1000;
            Ok::<Light, io::Error>(vec![next; 3 * PATCH_SAMPLES].into())
        };
        let folder = tempfile::tempdir().unwrap();
        let mut mip = Mip::build(&patches, 3, folder.path(), &mut light).unwrap();
        assert_eq!(mip.is_patch(&a), Some(true));
        assert_eq!(mip.is_patch(&d), Some(false));
        assert_eq!(mip.is_patch(&d.children()[2]), None);
        let side = PATCH_SIDE as usize;
        let at = |light: &Light, column: usize, row: usize| light[3 * (row * side + column)];
        let whole = mip.light(&Cell::WHOLE).unwrap();
        let corners = [[0, side - 1], [0, 0], [side - 1, side - 1], [side - 1, 0]];
        let seen = corners.map(|[column, row]| at(&whole, column, row));
        assert_eq!(seen, [1000, 2000, 3000, 0], "a, b, c, and what nobody sees");
        assert_eq!(at(&whole, side / 2, 0), 5000, "f is the upper left quarter of d");
        assert_eq!(at(&mip.light(&e).unwrap(), 3, 3), 4000);
    }

    #[test]
    fn a_place_has_the_mean_height_of_samples_that_all_have_one() {
        let parts = Cell::WHOLE.children();
        let mut next = 0u16;
        let mut light = || {
            next += 1;
            let heights =
                (0..PATCH_SAMPLES).map(|k| if k == 0 && next == 1 { 0 } else { next * 100 });
            let numbers = heights.flat_map(|height| [7, 8, 9, height]);
            Ok::<Light, io::Error>(numbers.collect())
        };
        let folder = tempfile::tempdir().unwrap();
        let mut mip = Mip::build(&parts, 4, folder.path(), &mut light).unwrap();
        let whole = mip.light(&Cell::WHOLE).unwrap();
        let side = PATCH_SIDE as usize;
        let at = |column: usize, row: usize| whole[4 * (row * side + column) + HEIGHT];
        // The first quarter lies below on the left, and its first sample is its upper left one.
        assert_eq!([at(0, side / 2), at(1, side / 2), at(0, 0)], [0, 100, 200]);
        assert_eq!(whole[..3], [7, 8, 9]);
    }
}
