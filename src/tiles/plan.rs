//! The tiles of a picture and their order.

/// A rectangle of pixels, or every `stride`-th of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// Its upper left pixel.
    pub origin: [u32; 2],
    /// Width and height in pixels of the picture.
    pub size: [u32; 2],
    /// Only columns and rows that are multiples of this (counted from the picture's corner),
    /// and only those that no coarser tile has done.
    pub stride: Stride,
}

/// Which pixels of its rectangle a tile computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stride {
    /// All of them.
    All,
    /// Multiples of `step`; those that are multiples of twice that are done already unless
    /// this is the `first` pass.
    Every {
        /// A power of two.
        step: u32,
        /// Whether nothing is done yet.
        first: bool,
    },
}

impl Tile {
    /// The pixels to compute, row by row.
    pub fn pixels(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let [x0, y0] = self.origin;
        let [w, h] = self.size;
        (y0..y0 + h)
            .flat_map(move |y| (x0..x0 + w).map(move |x| [x, y]))
            .filter(|&pixel| self.computes(pixel))
    }

    fn computes(&self, [x, y]: [u32; 2]) -> bool {
        let multiple = |step: u32| x % step == 0 && y % step == 0;
        match self.stride {
            Stride::All => true,
            Stride::Every { step, first } => multiple(step) && (first || !multiple(2 * step)),
        }
    }
}

/// In which order tiles are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Whole bands from the top: nobody watches.
    Straight,
    /// The whole picture coarsely, then finer and finer, each time from the middle outwards.
    CoarseFirst,
}

/// The first pass of [`Order::CoarseFirst`] computes one pixel in this many, each way.
const COARSEST: u32 = 8;

/// The tiles of a `size` picture of which the first `rows` rows are wanted, each of about
/// `tile_pixels` pixels to compute.
pub fn plan(size: [u32; 2], rows: u32, order: Order, tile_pixels: usize) -> Vec<Tile> {
    match order {
        Order::Straight => bands(size, rows, tile_pixels),
        Order::CoarseFirst => {
            let passes =
                std::iter::successors(Some(COARSEST), |step| (*step > 1).then(|| step / 2));
            passes
                .flat_map(|step| {
                    let first = step == COARSEST;
                    let side = ((tile_pixels as f64).sqrt() as u32).max(1) * step;
                    squares(size, rows, side, Stride::Every { step, first })
                })
                .collect()
        }
    }
}

fn bands([width, _]: [u32; 2], rows: u32, tile_pixels: usize) -> Vec<Tile> {
    let height = (tile_pixels as u32 / width).max(1);
    (0..rows)
        .step_by(height as usize)
        .map(|y| Tile { origin: [0, y], size: [width, height.min(rows - y)], stride: Stride::All })
        .collect()
}

fn squares([width, _]: [u32; 2], rows: u32, side: u32, stride: Stride) -> Vec<Tile> {
    let mut tiles: Vec<Tile> = (0..rows)
        .step_by(side as usize)
        .flat_map(|y| (0..width).step_by(side as usize).map(move |x| [x, y]))
        .map(|[x, y]| Tile {
            origin: [x, y],
            size: [side.min(width - x), side.min(rows - y)],
            stride,
        })
        .collect();
    let from_middle = |tile: &Tile| {
        let off = |i: usize, length: u32| {
            let middle = f64::from(tile.origin[i]) + f64::from(tile.size[i]) / 2.0;
            middle - f64::from(length) / 2.0
        };
        off(0, width).hypot(off(1, rows))
    };
    tiles.sort_by(|a, b| from_middle(a).total_cmp(&from_middle(b)));
    tiles
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_pixel_is_computed_exactly_once(
            width in 1u32..70, height in 1u32..70, tile_pixels in 1usize..400, coarse: bool,
        ) {
            let order = if coarse { Order::CoarseFirst } else { Order::Straight };
            let mut seen = vec![0; (width * height) as usize];
            for tile in plan([width, height], height, order, tile_pixels) {
                for [x, y] in tile.pixels() {
                    seen[(y * width + x) as usize] += 1;
                }
            }
            prop_assert!(seen.iter().all(|&count| count == 1));
        }
    }

    #[test]
    fn straight_bands_run_from_the_top() {
        let tiles = plan([100, 10], 10, Order::Straight, 300);
        let tops: Vec<u32> = tiles.iter().map(|tile| tile.origin[1]).collect();
        assert_eq!(tops, [0, 3, 6, 9]);
    }

    #[test]
    fn coarse_first_covers_the_whole_picture_before_refining() {
        let tiles = plan([64, 64], 64, Order::CoarseFirst, 16);
        let steps: Vec<u32> = tiles
            .iter()
            .map(|tile| match tile.stride {
                Stride::Every { step, .. } => step,
                Stride::All => 0,
            })
            .collect();
        assert!(steps.is_sorted_by(|a, b| a >= b) && steps[0] == COARSEST);
    }
}
