//! A picture as a pyramid of tiles in a folder, with a page that shows them.
//!
//! The format is Deep Zoom: `map.dzi` gives the size of the picture, and
//! `map_files/LEVEL/COLUMN_ROW.png` are its tiles. Each level is half as large as the next, down to
//! one pixel at level 0. Only one row of tiles per level is held in memory, whatever the picture's
//! height.

mod folder;
mod halving;
mod page;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

pub(crate) use folder::PyramidFolder;
use halving::Halving;

use super::{PngError, PngWriter};
use flipmap_scene::Document;

/// Pixels along the side of a tile.
pub(crate) const TILE_SIDE: u32 = 256;

/// Bytes per pixel.
const RGB: usize = 3;

/// Writes tiles as the rows of a picture come.
pub struct Pyramid {
    folder: PyramidFolder,
    /// The levels, the picture itself first, each coarser than the one before.
    levels: Vec<Level>,
    halving: Halving,
}

impl Pyramid {
    /// Begins the pyramid of a `size` picture of `document`, with `path` as its destination.
    pub fn create(path: &Path, size: [u32; 2], document: &Document) -> io::Result<Self> {
        let folder = PyramidFolder::create(path)?;
        let inside = folder.inside();
        fs::write(inside.join(folder::IMAGE), page::image(size))?;
        fs::write(inside.join(folder::SCENE), document.text())?;
        fs::write(inside.join(folder::PAGE), page::page(size, document)?)?;
        let tiles = inside.join(folder::TILES);
        let sizes = sizes(size);
        let finest = sizes.len() - 1;
        let level = |(below, size): (usize, [u32; 2])| {
            let folder = tiles.join((finest - below).to_string());
            fs::create_dir_all(&folder)?;
            Ok(Level::new(folder, size))
        };
        let levels = sizes.into_iter().enumerate().map(level).collect::<io::Result<_>>()?;
        Ok(Pyramid { folder, levels, halving: Halving::new() })
    }

    /// Writes the next rows, three bytes per pixel.
    pub fn write(&mut self, rgb: &[u8]) -> Result<(), PngError> {
        feed(&mut self.levels, &self.halving, rgb)
    }

    /// Returns the complete folder, not yet renamed to its destination.
    pub fn complete(self) -> Result<PyramidFolder, PngError> {
        if self.levels[0].rows_left > 0 {
            let text = format!("{} rows have not come", self.levels[0].rows_left);
            return Err(io::Error::new(io::ErrorKind::UnexpectedEof, text).into());
        }
        Ok(self.folder)
    }
}

/// Returns the sizes of the levels of a `size` picture, its own first.
fn sizes(size: [u32; 2]) -> Vec<[u32; 2]> {
    let coarser = |size: &[u32; 2]| (*size != [1, 1]).then(|| size.map(|side| side.div_ceil(2)));
    std::iter::successors(Some(size), coarser).collect()
}

/// Passes rows to the first of `levels`, and each full band, halved, to the coarser ones.
fn feed(levels: &mut [Level], halving: &Halving, mut rows: &[u8]) -> Result<(), PngError> {
    let Some((level, coarser)) = levels.split_first_mut() else { return Ok(()) };
    while !rows.is_empty() {
        rows = level.take(rows)?;
        if level.is_full() {
            level.write_tiles()?;
            feed(coarser, halving, &halving.halved(&level.band, level.stride))?;
            level.begin_row();
        }
    }
    Ok(())
}

/// One resolution of the picture.
struct Level {
    folder: PathBuf,
    /// Bytes per row of pixels.
    stride: usize,
    /// Number of rows of pixels that the tiles do not hold yet.
    rows_left: u32,
    /// Index of the row of tiles that is being filled.
    tile_row: u32,
    /// The pixels of that row of tiles.
    band: Vec<u8>,
}

impl Level {
    fn new(folder: PathBuf, [width, height]: [u32; 2]) -> Self {
        let stride = width as usize * RGB;
        let band = Vec::with_capacity(stride * TILE_SIDE.min(height) as usize);
        Level { folder, stride, rows_left: height, tile_row: 0, band }
    }

    /// Returns the size in bytes of the row of tiles that is being filled, once it is full.
    fn room(&self) -> usize {
        self.stride * self.rows_left.min(TILE_SIDE) as usize
    }

    fn is_full(&self) -> bool {
        self.band.len() == self.room()
    }

    /// Takes as many bytes as fit, and returns the rest.
    fn take<'a>(&mut self, rows: &'a [u8]) -> io::Result<&'a [u8]> {
        if self.rows_left == 0 {
            return Err(io::Error::other("more rows have come than the picture has"));
        }
        let (now, later) = rows.split_at(rows.len().min(self.room() - self.band.len()));
        self.band.extend_from_slice(now);
        Ok(later)
    }

    /// Writes the row of tiles, on all cores.
    fn write_tiles(&self) -> Result<(), PngError> {
        let columns = self.stride.div_ceil(RGB * TILE_SIDE as usize);
        (0..columns).into_par_iter().try_for_each(|column| {
            let file = self.folder.join(format!("{column}_{}.png", self.tile_row));
            Ok(fs::write(file, self.tile(column)?)?)
        })
    }

    fn tile(&self, column: usize) -> Result<Vec<u8>, PngError> {
        let wide = RGB * TILE_SIDE as usize;
        let bytes = wide * column..self.stride.min(wide * (column + 1));
        let size = [bytes.len() / RGB, self.band.len() / self.stride].map(|side| side as u32);
        let mut png = PngWriter::without_scene(Vec::new(), size)?;
        for row in self.band.chunks_exact(self.stride) {
            png.write(&row[bytes.clone()])?;
        }
        png.finish()
    }

    fn begin_row(&mut self) {
        self.band.clear();
        self.tile_row += 1;
        self.rows_left -= self.rows_left.min(TILE_SIDE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::BufReader;

    /// Returns a picture in which no two pixels and no two tiles are equal.
    fn picture([width, height]: [u32; 2]) -> Vec<u8> {
        let pixel = |x: u32, y: u32| [x % 251, y % 241, x / 251 + 16 * (y / 241)];
        let rows = (0..height).flat_map(|y| (0..width).flat_map(move |x| pixel(x, y)));
        rows.map(|channel| channel as u8).collect()
    }

    fn tile(folder: &Path, level: usize, column: usize, row: usize) -> ([u32; 2], Vec<u8>) {
        let path = folder.join(format!("map_files/{level}/{column}_{row}.png"));
        let file = BufReader::new(fs::File::open(path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let size = [reader.info().width, reader.info().height];
        let mut rgb = Vec::new();
        while let Some(row) = reader.next_row().unwrap() {
            rgb.extend_from_slice(row.data());
        }
        (size, rgb)
    }

    /// Returns a level assembled from its tiles.
    fn level(folder: &Path, level: usize, [width, height]: [u32; 2]) -> Vec<u8> {
        let [width, height] = [width, height].map(|side| side as usize);
        let mut whole = vec![0; width * height * RGB];
        for (column, left) in (0..width).step_by(256).enumerate() {
            for (row, top) in (0..height).step_by(256).enumerate() {
                let (size, rgb) = tile(folder, level, column, row);
                let expected = [(width - left).min(256), (height - top).min(256)];
                assert_eq!(size.map(|side| side as usize), expected);
                for (y, bytes) in rgb.chunks(expected[0] * RGB).enumerate() {
                    let at = ((top + y) * width + left) * RGB;
                    whole[at..at + bytes.len()].copy_from_slice(bytes);
                }
            }
        }
        whole
    }

    fn write(path: &Path, size: [u32; 2], part: usize) {
        let mut pyramid = Pyramid::create(path, size, &Document::default()).unwrap();
        picture(size).chunks(part).for_each(|rows| pyramid.write(rows).unwrap());
        pyramid.complete().unwrap().finish().unwrap();
    }

    #[test]
    fn every_level_is_the_finer_one_halved_and_the_finest_the_picture() {
        let folder = tempfile::tempdir().unwrap();
        for (name, size, part) in [("wide", [700, 601], 2100 * 300), ("tall", [3, 515], 7)] {
            let path = folder.path().join(name);
            write(&path, size, part);
            let (mut fine, sizes) = (picture(size), sizes(size));
            assert_eq!(sizes.last(), Some(&[1, 1]));
            for (below, size) in sizes.iter().enumerate() {
                let found = level(&path, sizes.len() - 1 - below, *size);
                assert!(found == fine, "{name} {size:?}");
                fine = Halving::new().halved(&fine, size[0] as usize * RGB);
            }
            let files = fs::read_dir(path.join("map_files")).unwrap().count();
            assert_eq!(files, sizes.len());
        }
    }

    #[test]
    fn levels_are_counted_as_other_viewers_do() {
        assert_eq!(sizes([1, 1]).len(), 1);
        assert_eq!(sizes([256, 2]).len(), 9);
        assert_eq!(sizes([257, 2]).len(), 10);
        assert_eq!(sizes([1_000_000, 1_000_000]).len(), 21);
        assert_eq!(sizes([5, 3]), [[5, 3], [3, 2], [2, 1], [1, 1]]);
    }

    #[test]
    fn equal_pictures_are_equal_tiles() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a", "b"].map(|name| folder.path().join(name));
        write(&a, [300, 300], 900);
        write(&b, [300, 300], 5000);
        for name in ["map_files/9/1_1.png", "map_files/0/0_0.png", "map.dzi", "index.html"] {
            assert!(fs::read(a.join(name)).unwrap() == fs::read(b.join(name)).unwrap(), "{name}");
        }
    }

    #[test]
    fn what_fails_or_is_cut_short_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map");
        let begun = || Pyramid::create(&path, [300, 300], &Document::default()).unwrap();
        let left = || fs::read_dir(folder.path()).unwrap().count();
        let mut short = begun();
        short.write(&picture([300, 299])).unwrap();
        assert!(short.complete().is_err() && left() == 0);

        let mut failing = begun();
        fs::remove_dir_all(failing.folder.inside().join("map_files/9")).unwrap();
        assert!(failing.write(&picture([300, 300])).is_err());
        drop(failing);
        assert_eq!(left(), 0);

        let mut long = begun();
        assert!(long.write(&picture([300, 301])).is_err());
    }
}
