//! The tiles of a picture: bands from the top, because no viewer needs any part first.

use std::ops::Range;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// Column and row of the upper left pixel.
    pub origin: [u32; 2],
    /// Width and height in pixels of the picture.
    pub size: [u32; 2],
}

impl Tile {
    /// Returns the column and row of a pixel, by its place among [`Tile::pixels`].
    pub(crate) fn pixel(&self, place: u32) -> [u32; 2] {
        let ([x, y], width) = (self.origin, self.size[0]);
        [x + place % width, y + place / width]
    }

    /// Iterates over the columns and rows of the pixels, row by row.
    pub fn pixels(&self) -> impl Iterator<Item = [u32; 2]> + use<> {
        let ([x0, y0], [w, h]) = (self.origin, self.size);
        (y0..y0 + h).flat_map(move |y| (x0..x0 + w).map(move |x| [x, y]))
    }
}

/// Cuts `rows` of a picture `width` pixels wide into bands of whole rows, each of about
/// `tile_pixels` pixels.
pub fn plan(width: u32, rows: Range<u32>, tile_pixels: usize) -> Vec<Tile> {
    let height = u32::try_from(tile_pixels / width as usize).unwrap_or(u32::MAX).max(1);
    rows.clone()
        .step_by(height as usize)
        .map(|y| Tile { origin: [0, y], size: [width, height.min(rows.end - y)] })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_pixel_is_computed_exactly_once(
            width in 1u32..70, height in 1u32..70, tile_pixels in 1usize..400,
        ) {
            let mut seen = vec![0; (width * height) as usize];
            for tile in plan(width, 0..height, tile_pixels) {
                for [x, y] in tile.pixels() {
                    seen[(y * width + x) as usize] += 1;
                }
            }
            prop_assert!(seen.iter().all(|&count| count == 1));
        }
    }

    #[test]
    fn bands_run_from_the_top() {
        let tops: Vec<u32> = plan(100, 0..10, 300).iter().map(|tile| tile.origin[1]).collect();
        assert_eq!(tops, [0, 3, 6, 9]);
    }
}
