//! The colours of patches, and of every cell above them at 1/2, 1/4, … of their resolution; under
//! light from the side, their heights too.
//!
//! Each level shows flips within its own budget ([`super::FrameGroup::shown`]), so a cell looks
//! different in the means of every level above it. A cell keeps only its look in its own level and,
//! if it is a patch, its look in the next finer one; the looks for the levels above are averaged
//! into cells of those levels and dropped.
//!
//! The colours lie in an unnamed file, which the system caches in memory while there is room: a
//! deep zoom may have more colours than fit.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::Arc;

use crate::tiles::patches::{PATCH_SAMPLES, PATCH_SIDE};
use flipmap_scene::lattice::Cell;

/// Linear light of a sample, red, green and blue, and its height: 1 to 65535, or 0 without one.
pub(crate) type SampleLight = [u16; 4];

/// The samples of a patch, row by row from the top.
pub type Light = Arc<[SampleLight]>;

/// Number of levels above its own for which a cell has a look. Still higher levels use the last
/// look: there, a whole frame of the cell's level is less than a sample wide, unless it has more
/// than 4096 samples across.
const LEVELS_ABOVE: usize = 12;

/// Number of looks of a cell.
pub(super) const LOOKS: usize = LEVELS_ABOVE + 2;

/// The colours of a cell as shown by the next finer level, its own, the one above, and so on. Equal
/// looks share one `Arc`.
pub type Looks = [Light; LOOKS];

/// Index of the look in the next finer level; [`OWN`] is the one in the cell's own level.
const FINER: usize = 0;
const OWN: usize = 1;

/// Index of the height among the numbers of a sample.
pub(super) const HEIGHT: usize = 3;

/// The colours of cells, in a file.
pub(crate) struct Mip {
    file: File,
    places: HashMap<Cell, CellPlace>,
    /// Number of channels per sample in the file: 3, or 4 if the film is lit and has heights.
    channels: usize,
}

/// Place of a cell's colours in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct CellPlace {
    /// Index of its look in its own level.
    pub own: u32,
    /// Index of its look in finer levels, if it is a patch; cells inside a patch have no colours of
    /// their own.
    pub finer: Option<u32>,
}

impl Mip {
    /// Builds the mip of `patches`, given in depth-first order of quarters of quarters; `looks`
    /// returns their looks one by one in that order. The file lies in `folder`, and has heights if
    /// the film `is_lit` from the side.
    pub(crate) fn build<E: From<io::Error>>(
        patches: &[Cell],
        is_lit: bool,
        folder: &Path,
        looks: &mut dyn FnMut() -> Result<Looks, E>,
    ) -> Result<Mip, E> {
        let channels = HEIGHT + usize::from(is_lit);
        let mut builder = Builder {
            out: BufWriter::with_capacity(1 << 20, tempfile::tempfile_in(folder)?),
            written: 0,
            places: HashMap::new(),
            channels,
            looks,
        };
        if !patches.is_empty() {
            builder.build(Cell::WHOLE, patches)?;
        }
        let file = builder.out.into_inner().map_err(io::IntoInnerError::into_error)?;
        Ok(Mip { file, places: builder.places, channels })
    }

    /// Returns the place of a cell's colours, if it has any.
    pub(super) fn place(&self, cell: &Cell) -> Option<CellPlace> {
        self.places.get(cell).copied()
    }

    /// Reads the look at an index.
    pub(super) fn light(&mut self, index: u32) -> io::Result<Light> {
        let mut numbers = vec![0u16; self.channels * PATCH_SAMPLES];
        self.file.seek(SeekFrom::Start(u64::from(index) * 2 * numbers.len() as u64))?;
        self.file.read_exact(bytemuck::cast_slice_mut(&mut numbers))?;
        let sample = |numbers: &[u16]| {
            std::array::from_fn(|channel| numbers.get(channel).copied().unwrap_or(0))
        };
        Ok(numbers.chunks_exact(self.channels).map(sample).collect())
    }
}

struct Builder<'a, E> {
    out: BufWriter<File>,
    /// Number of looks in the file.
    written: u32,
    places: HashMap<Cell, CellPlace>,
    channels: usize,
    looks: &'a mut dyn FnMut() -> Result<Looks, E>,
}

impl<E: From<io::Error>> Builder<'_, E> {
    /// Writes the looks of a cell and of all cells inside it, given its patches, and returns the
    /// cell's looks.
    fn build(&mut self, cell: Cell, patches: &[Cell]) -> Result<Looks, E> {
        let is_patch = patches == [cell];
        let looks = if is_patch { (self.looks)()? } else { self.halved(&cell, patches)? };
        let own = self.write(&looks[OWN])?;
        let finer = match is_patch {
            true if Arc::ptr_eq(&looks[FINER], &looks[OWN]) => Some(own),
            true => Some(self.write(&looks[FINER])?),
            false => None,
        };
        self.places.insert(cell, CellPlace { own, finer });
        Ok(looks)
    }

    /// Writes a look and returns its index.
    fn write(&mut self, light: &Light) -> io::Result<u32> {
        let numbers: Vec<u16> =
            light.iter().flat_map(|sample| &sample[..self.channels]).copied().collect();
        self.out.write_all(bytemuck::cast_slice(&numbers))?;
        self.written += 1;
        Ok(self.written - 1)
    }

    /// Builds the quarters of a cell that is coarser than its patches, and returns the cell's
    /// looks.
    fn halved(&mut self, cell: &Cell, patches: &[Cell]) -> Result<Looks, E> {
        // Children: the left two from below, then the right two.
        let mut quarters = [const { None }; 4];
        let mut rest = patches;
        for (child, quarter) in cell.children().into_iter().zip(&mut quarters) {
            let inside = |patch: &Cell| patch.ancestor(child.level) == child;
            let count = rest.iter().take_while(|patch| inside(patch)).count();
            let (own, others) = rest.split_at(count);
            rest = others;
            if !own.is_empty() {
                *quarter = Some(self.build(child, own)?);
            }
        }
        Ok(halved_looks(&quarters))
    }
}

/// Returns the looks of a cell, given those of its quarters that are seen. Every level lies one
/// level further above the quarters than above the cell.
fn halved_looks(quarters: &[Option<Looks>; 4]) -> Looks {
    let from = |look: usize| (look + 1).min(LOOKS - 1);
    let mut looks: Vec<Light> = Vec::with_capacity(LOOKS);
    for look in OWN..LOOKS {
        let same = |looks: &Looks| Arc::ptr_eq(&looks[from(look)], &looks[from(look - 1)]);
        let light = match looks.last() {
            Some(before) if quarters.iter().flatten().all(same) => before.clone(),
            _ => quartered(quarters.each_ref().map(|looks| looks.as_ref().map(|l| &l[from(look)]))),
        };
        looks.push(light);
    }
    // Unused: finer levels show the quarters themselves.
    looks.insert(FINER, looks[0].clone());
    looks.try_into().expect("as many looks")
}

/// Returns the means over 2 × 2 samples of the quarters; a missing quarter is black.
fn quartered(quarters: [Option<&Light>; 4]) -> Light {
    let mut all = vec![[0; 4]; PATCH_SAMPLES];
    for (k, light) in quarters.into_iter().enumerate() {
        if let Some(light) = light {
            // Rows count from the top.
            put_quarter(&mut all, light, [k / 2, 1 - k % 2]);
        }
    }
    all.into()
}

/// Writes the means over 2 × 2 samples of `light` into the quarter of `all` at `right` and `down`,
/// each 0 or 1.
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

/// Returns the mean of four samples; it has a height only if all four have one.
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

    /// Returns looks that are all the same.
    fn alike(light: Vec<SampleLight>) -> Looks {
        let light: Light = light.into();
        std::array::from_fn(|_| light.clone())
    }

    fn own(mip: &mut Mip, cell: &Cell) -> Light {
        let place = mip.place(cell).unwrap();
        mip.light(place.own).unwrap()
    }

    #[test]
    fn every_cell_above_patches_has_their_means() {
        let [a, b, c, d] = Cell::WHOLE.children();
        // The last quarter is finer, and half of it is not seen.
        let [e, f, ..] = d.children();
        let patches = [a, b, c, e, f];
        let mut next = 0u16;
        let mut looks = || {
            next += 1000;
            Ok::<Looks, io::Error>(alike(vec![[next; 4]; PATCH_SAMPLES]))
        };
        let folder = tempfile::tempdir().unwrap();
        let mut mip = Mip::build(&patches, false, folder.path(), &mut looks).unwrap();
        let place = mip.place(&a).unwrap();
        assert_eq!(place.finer, Some(place.own));
        assert_eq!(mip.place(&d).unwrap().finer, None);
        assert_eq!(mip.place(&d.children()[2]), None);
        let looks = mip.file.metadata().unwrap().len() / (2 * 3 * PATCH_SAMPLES as u64);
        assert_eq!(looks, 7, "one each of five patches and two cells above them");
        let side = PATCH_SIDE as usize;
        let at = |light: &Light, column: usize, row: usize| light[row * side + column][0];
        let whole = own(&mut mip, &Cell::WHOLE);
        let corners = [[0, side - 1], [0, 0], [side - 1, side - 1], [side - 1, 0]];
        let seen = corners.map(|[column, row]| at(&whole, column, row));
        assert_eq!(seen, [1000, 2000, 3000, 0], "a, b, c, and what nobody sees");
        assert_eq!(at(&whole, side / 2, 0), 5000, "f is the upper left quarter of d");
        assert_eq!(at(&own(&mut mip, &e), 3, 3), 4000);
    }

    #[test]
    fn each_level_has_the_means_of_its_own_looks() {
        // Patches three levels down, dark for the whole torus and brighter by 100 for each finer
        // level.
        let two = Cell::WHOLE.children().map(|cell| cell.children());
        let patches: Vec<Cell> = two.iter().flatten().flat_map(Cell::children).collect();
        let mut looks = || {
            let light = |k: usize| vec![[400u16.saturating_sub(100 * k as u16); 4]; PATCH_SAMPLES];
            Ok::<Looks, io::Error>(std::array::from_fn(|k| light(k).into()))
        };
        let folder = tempfile::tempdir().unwrap();
        let mut mip = Mip::build(&patches, false, folder.path(), &mut looks).unwrap();
        let seen = [patches[9], two[1][0], two[1][0].ancestor(1), Cell::WHOLE].map(|cell| {
            let light = own(&mut mip, &cell);
            assert!(light.iter().all(|sample| *sample == light[0]));
            light[0][0]
        });
        assert_eq!(seen, [300, 200, 100, 0]);
        let finer = mip.place(&patches[9]).unwrap().finer.unwrap();
        assert_eq!(mip.light(finer).unwrap()[0][0], 400, "a patch in a level finer than its own");
    }

    #[test]
    fn a_place_has_the_mean_height_of_samples_that_all_have_one() {
        let parts = Cell::WHOLE.children();
        let mut next = 0u16;
        let mut looks = || {
            next += 1;
            let heights =
                (0..PATCH_SAMPLES).map(|k| if k == 0 && next == 1 { 0 } else { next * 100 });
            Ok::<Looks, io::Error>(alike(heights.map(|height| [7, 8, 9, height]).collect()))
        };
        let folder = tempfile::tempdir().unwrap();
        let mut mip = Mip::build(&parts, true, folder.path(), &mut looks).unwrap();
        let whole = own(&mut mip, &Cell::WHOLE);
        let side = PATCH_SIDE as usize;
        let at = |column: usize, row: usize| whole[row * side + column][HEIGHT];
        // The first quarter lies below on the left, and its first sample is its upper left one.
        assert_eq!([at(0, side / 2), at(1, side / 2), at(0, 0)], [0, 100, 200]);
        assert_eq!(whole[0][..3], [7, 8, 9]);
    }
}
