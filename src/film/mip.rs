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

/// Linear light of a sample, red, green and blue, and its height: 1 to 65535, or 0 without one.
pub type SampleLight = [u16; 4];

/// The samples of a patch, row by row from the top.
pub type Light = Arc<[SampleLight]>;

/// Index of the height among the numbers of a sample.
pub(super) const HEIGHT: usize = 3;

/// The colours of cells, in a file.
pub struct Mip {
    file: File,
    /// Index of each cell in the file, and true if it is a patch.
    places: HashMap<Cell, (u32, bool)>,
    /// Number of numbers per sample in the file: heights are kept only if the film is lit.
    channels: usize,
}

impl Mip {
    /// Builds the mip of `patches`, given in depth-first order of quarters of quarters; `light`
    /// returns theirs one by one in that order. The file lies in `folder`, and keeps heights if the
    /// film `is_lit` from the side.
    pub fn build<E: From<io::Error>>(
        patches: &[Cell],
        is_lit: bool,
        folder: &Path,
        light: &mut dyn FnMut() -> Result<Light, E>,
    ) -> Result<Mip, E> {
        let channels = HEIGHT + usize::from(is_lit);
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

    /// Reads the colours of a cell that has some.
    pub fn light(&mut self, cell: &Cell) -> io::Result<Light> {
        let (place, _) = self.places[cell];
        let mut numbers = vec![0u16; self.channels * PATCH_SAMPLES];
        self.file.seek(SeekFrom::Start(u64::from(place) * 2 * numbers.len() as u64))?;
        self.file.read_exact(bytemuck::cast_slice_mut(&mut numbers))?;
        let sample = |numbers: &[u16]| {
            std::array::from_fn(|channel| numbers.get(channel).copied().unwrap_or(0))
        };
        Ok(numbers.chunks_exact(self.channels).map(sample).collect())
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
        let numbers: Vec<u16> =
            light.iter().flat_map(|sample| &sample[..self.channels]).copied().collect();
        self.out.write_all(bytemuck::cast_slice(&numbers))?;
        self.places.insert(cell, (place, is_patch));
        Ok(light)
    }

    /// The means of two by two samples of a cell's quarters; black where no frame looks.
    fn halved(&mut self, cell: &Cell, patches: &[Cell]) -> Result<Light, E> {
        let mut all = vec![[0; 4]; PATCH_SAMPLES];
        let mut rest = patches;
        for (k, child) in cell.children().into_iter().enumerate() {
            let inside = |patch: &Cell| patch.ancestor(child.level) == child;
            let count = rest.iter().take_while(|patch| inside(patch)).count();
            let (own, others) = rest.split_at(count);
            rest = others;
            if !own.is_empty() {
                let light = self.build(child, own)?;
                // Children: the left two from below, then the right two; rows count from the top.
                put_quarter(&mut all, &light, [k / 2, 1 - k % 2]);
            }
        }
        Ok(all.into())
    }
}

/// Puts a patch's means into the quarter of another, so many quarters to the right and down.
fn put_quarter(all: &mut [SampleLight], light: &[SampleLight], [right, down]: [usize; 2]) {
    let side = PATCH_SIDE as usize;
    let half = side / 2;
    for row in 0..half {
        for column in 0..half {
            let from = 2 * row * side + 2 * column;
            let four = [0, 1, side, side + 1].map(|by| light[from + by]);
            all[(down * half + row) * side + right * half + column] = mean(four);
        }
    }
}

/// The mean of four samples; a place that is partly without a height has none.
fn mean(four: [SampleLight; 4]) -> SampleLight {
    let of = |channel: usize| four.map(|sample| u32::from(sample[channel]));
    let mut mean =
        std::array::from_fn(|channel| ((of(channel).iter().sum::<u32>() + 2) / 4) as u16);
    if of(HEIGHT).contains(&0) {
        mean[HEIGHT] = 0;
    }
    mean
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
            Ok::<Light, io::Error>(vec![[next; 4]; PATCH_SAMPLES].into())
        };
        let folder = tempfile::tempdir().unwrap();
        let mut mip = Mip::build(&patches, false, folder.path(), &mut light).unwrap();
        assert_eq!(mip.is_patch(&a), Some(true));
        assert_eq!(mip.is_patch(&d), Some(false));
        assert_eq!(mip.is_patch(&d.children()[2]), None);
        let side = PATCH_SIDE as usize;
        let at = |light: &Light, column: usize, row: usize| light[row * side + column][0];
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
            Ok::<Light, io::Error>(heights.map(|height| [7, 8, 9, height]).collect())
        };
        let folder = tempfile::tempdir().unwrap();
        let mut mip = Mip::build(&parts, true, folder.path(), &mut light).unwrap();
        let whole = mip.light(&Cell::WHOLE).unwrap();
        let side = PATCH_SIDE as usize;
        let at = |column: usize, row: usize| whole[row * side + column][HEIGHT];
        // The first quarter lies below on the left, and its first sample is its upper left one.
        assert_eq!([at(0, side / 2), at(1, side / 2), at(0, 0)], [0, 100, 200]);
        assert_eq!(whole[0][..3], [7, 8, 9]);
    }
}
