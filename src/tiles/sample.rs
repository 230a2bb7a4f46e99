//! A sample of a picture's pixels: what its makers look at before or after the picture.

use super::in_flight::OpenTile;
use crate::engine::{IntegratorConfig, Trust};
use crate::scene::{Grid, Scene};

/// Some pixels of a picture of `size`, sorted by what is known of them.
pub(super) fn open(
    scene: &Scene,
    size: [u32; 2],
    config: IntegratorConfig,
    pixels: &[[u32; 2]],
) -> OpenTile {
    let grid = Grid::new(scene, size);
    if grid.pixel_rad() < config.deep_below() {
        let opening = |place: u32| {
            let [column, row] = pixels[place as usize];
            grid.opening(column, row).map(|outcome| (outcome, Trust::Agreed))
        };
        let groups = grid.grouped(pixels.iter().copied());
        OpenTile::deep(pixels.len(), groups, opening)
    } else {
        OpenTile::new(pixels.iter().map(|&[column, row]| (grid.fate(column, row), None)))
    }
}
