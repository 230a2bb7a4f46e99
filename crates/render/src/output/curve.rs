//! Coverage of pixels by the energy curve; only pixels near it are examined.

use std::ops::Range;

use rayon::prelude::*;

use flipmap_scene::Grid;

/// A band of rows, with the blocks of pixels that the energy curve may touch.
pub(crate) struct CurveBand {
    /// True for each block, from the left, that is not clear of the curve.
    near: Vec<bool>,
}

/// Side of a block in pixels.
const BLOCK: u32 = 16;
/// Half the width of the energy curve in pixels.
const HALF_WIDTH: f64 = 0.75;
/// Smallest distance in pixels from the curve to the middle of a pixel that it does not touch.
const REACH: f64 = HALF_WIDTH + 0.5;

impl CurveBand {
    /// Returns the band in which a row of a grid lies.
    pub(crate) fn around(grid: &Grid, row: u32) -> Self {
        let first_row = row - row % BLOCK;
        let columns = (0..grid.size()[0]).step_by(BLOCK as usize);
        let near = |x| !grid.is_clear_of_curve([x, first_row], [BLOCK; 2], REACH);
        CurveBand { near: columns.map(near).collect() }
    }

    /// Returns the bands that contain these rows, from the top.
    pub(super) fn all(grid: &Grid, rows: Range<u32>) -> Vec<Self> {
        let bands = rows.start / BLOCK..rows.end.div_ceil(BLOCK);
        bands.into_par_iter().map(|band| CurveBand::around(grid, band * BLOCK)).collect()
    }

    /// Returns the band of a row, given the bands of the rows from `first` on; `None` if there are
    /// no bands.
    pub(super) fn of_row(bands: &[CurveBand], first: u32, row: u32) -> Option<&CurveBand> {
        bands.get((row / BLOCK - first / BLOCK) as usize)
    }

    /// Returns the share of a pixel in this band that the energy curve covers, calculated from the
    /// curve's distance to the pixel's middle.
    pub(crate) fn cover(&self, grid: &Grid, column: u32, row: u32) -> f64 {
        if !self.near[(column / BLOCK) as usize] {
            return 0.0;
        }
        (REACH - grid.pixels_from_curve(column, row)).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::{Scene, View};

    #[test]
    fn bands_leave_out_no_pixel_of_the_curve() {
        let view = View { rotate: 12.0, ..View::default() };
        for scene in [Scene::default(), Scene { view, ..Scene::default() }] {
            let grid = Grid::new(&scene.checked().unwrap(), [150, 83]);
            let mut touched = 0;
            // From a row in the middle of a band.
            let bands = CurveBand::all(&grid, 7..83);
            for (row, column) in (7..83).flat_map(|row| (0..150).map(move |x| (row, x))) {
                let band = CurveBand::of_row(&bands, 7, row).expect("a band of each row");
                let whole = (REACH - grid.pixels_from_curve(column, row)).clamp(0.0, 1.0);
                assert_eq!(band.cover(&grid, column, row), whole, "({column}, {row})");
                touched += u32::from(whole > 0.0);
            }
            assert!(touched > 100, "{touched}");
        }
    }
}
