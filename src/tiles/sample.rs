//! A sample of a picture's pixels: what its makers look at before or after the picture.

use super::flights::Open;
use crate::engine::{Recipe, Trust};
use crate::scene::{Grid, Scene};

/// Some pixels of a picture of `size`, sorted by what is known of them.
pub(super) fn open(scene: &Scene, size: [u32; 2], recipe: Recipe, pixels: &[[u32; 2]]) -> Open {
    let grid = Grid::new(scene, size);
    if grid.pixel_rad() < recipe.deep_below() {
        let opening = |place: u32| {
            let [column, row] = pixels[place as usize];
            grid.opening(column, row).map(|outcome| (outcome, Trust::Agreed))
        };
        let groups = grid.grouped(pixels.iter().copied());
        Open::deep(pixels.len(), groups, opening)
    } else {
        Open::new(pixels.iter().map(|&[column, row]| (grid.fate(column, row), None)))
    }
}
