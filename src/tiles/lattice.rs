//! The dyadic lattice on the torus from whose cells the window is drawn.
//!
//! Level 0 is one cell, the whole torus from −π to π in both angles; every level halves the side
//! of its cells. A cell is always sampled in the same [`SIDE`] × [`SIDE`] places, so a place seen
//! before is the same tile whatever the view was. Mirrored about the origin the lattice is itself,
//! and so is the map from rest: of a cell and its image only one is ever computed.

use crate::physics::Dd;
use crate::scene::{Grid, Scene};

/// Samples along each side of a cell.
pub const SIDE: u32 = 128;
/// Samples in a cell.
pub const SAMPLES: usize = (SIDE * SIDE) as usize;
/// The deepest level whose cells lie apart in double-double.
pub const DEEPEST: u32 = 96;

/// A square of the torus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Cell {
    /// 2^level cells lie along each axis.
    pub level: u32,
    /// From θ1 = −π to the right.
    pub x: u128,
    /// From θ2 = −π upwards.
    pub y: u128,
}

/// A rectangle of the plane around a centre, in which cells are looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// θ1, θ2 in rad.
    pub center: [Dd; 2],
    /// Half its extent along θ1 and θ2, rad.
    pub half_rad: [f64; 2],
}

/// A cell where it appears in a region: the torus repeats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Which.
    pub cell: Cell,
    /// Its middle less the region's centre, rad.
    pub offset: [f64; 2],
}

/// The side of a level's cells in rad.
pub fn side_rad(level: u32) -> Dd {
    Dd::TAU * Dd::new(0.5f64.powi(level as i32))
}

/// The distance of a level's samples in rad.
pub fn pitch_rad(level: u32) -> f64 {
    side_rad(level).hi / f64::from(SIDE)
}

impl Cell {
    /// The whole torus.
    pub const WHOLE: Cell = Cell { level: 0, x: 0, y: 0 };

    /// The cell of a level in which a start lies.
    pub fn around(angle: [Dd; 2], level: u32) -> Cell {
        let [x, y] = angle.map(|theta| wrapped_index(index_of(theta, level), level));
        Cell { level, x, y }
    }

    /// Its middle, in (−π, π).
    pub fn center(&self) -> [Dd; 2] {
        [self.x, self.y].map(|index| middle(index as i128, self.level))
    }

    /// The cell a level up that it is a quarter of.
    pub fn parent(&self) -> Option<Cell> {
        let level = self.level.checked_sub(1)?;
        Some(Cell { level, x: self.x / 2, y: self.y / 2 })
    }

    /// Its quarters: the left two from below, then the right two.
    pub fn children(&self) -> [Cell; 4] {
        [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(x, y)| Cell {
            level: self.level + 1,
            x: 2 * self.x + x,
            y: 2 * self.y + y,
        })
    }

    /// Its image under (θ1, θ2) → (−θ1, −θ2).
    pub fn mirrored(&self) -> Cell {
        let last = (1 << self.level) - 1;
        Cell { level: self.level, x: last - self.x, y: last - self.y }
    }

    /// Of the cell and its image the one that is computed, and whether that is the image.
    pub fn canonical(&self) -> (Cell, bool) {
        let image = self.mirrored();
        if image < *self { (image, true) } else { (*self, false) }
    }

    /// Its samples as a picture of `scene`'s pendulum, row 0 at the top.
    pub fn grid(&self, scene: &Scene) -> Grid {
        let pixel = side_rad(self.level) / Dd::new(f64::from(SIDE));
        Grid::square(scene, self.center(), pixel, [SIDE; 2])
    }

    /// The sample nearest to a start inside the cell: its column and row.
    pub fn sample_at(&self, angle: [Dd; 2]) -> [u32; 2] {
        let center = self.center();
        let pitch = pitch_rad(self.level);
        let place = |i: usize| (angle[i] - center[i]).wrapped().hi / pitch;
        let half = f64::from(SIDE / 2);
        let index = |samples: f64| samples.floor().clamp(0.0, f64::from(SIDE - 1)) as u32;
        [index(half + place(0)), index(half - place(1))]
    }
}

impl Region {
    /// The cells of a level that touch the region, wherever they appear in it, row by row.
    /// At most `most` of them; none if there are more.
    pub fn cells(&self, level: u32, most: usize) -> Vec<Placed> {
        let [columns, rows] = [0, 1].map(|axis| self.indices(axis, level));
        let count = |range: &std::ops::RangeInclusive<i128>| {
            usize::try_from(range.end() - range.start() + 1).unwrap_or(usize::MAX)
        };
        if count(&columns).saturating_mul(count(&rows)) > most {
            return Vec::new();
        }
        rows.flat_map(|y| columns.clone().map(move |x| [x, y]))
            .map(|index| self.placed(index, level))
            .collect()
    }

    /// The region `times` as large.
    pub fn scaled(&self, times: f64) -> Region {
        Region { half_rad: self.half_rad.map(|half| half * times), ..*self }
    }

    fn indices(&self, axis: usize, level: u32) -> std::ops::RangeInclusive<i128> {
        let half = Dd::new(self.half_rad[axis]);
        let first = index_of(self.center[axis] - half, level);
        let last = index_of(self.center[axis] + half, level);
        first..=last
    }

    fn placed(&self, index: [i128; 2], level: u32) -> Placed {
        let offset = [0, 1].map(|i| (middle(index[i], level) - self.center[i]).hi);
        let [x, y] = index.map(|index| wrapped_index(index, level));
        Placed { cell: Cell { level, x, y }, offset }
    }
}

/// The unwrapped index of the cell that holds an angle.
fn index_of(theta: Dd, level: u32) -> i128 {
    let cells = (theta + Dd::PI) / side_rad(level);
    let whole = cells.round();
    let whole = if whole > cells { whole - Dd::new(1.0) } else { whole };
    whole.hi as i128 + whole.lo as i128
}

fn wrapped_index(index: i128, level: u32) -> u128 {
    index.rem_euclid(1 << level).unsigned_abs()
}

/// The middle of the cell with an unwrapped index; exactly odd about the origin.
fn middle(index: i128, level: u32) -> Dd {
    let odd = 2 * index + 1 - (1i128 << level);
    let hi = odd as f64;
    let lo = (odd - hi as i128) as f64;
    Dd::TAU * (Dd::new(hi) + Dd::new(lo)) * Dd::new(0.5f64.powi(level as i32 + 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn region(center: [f64; 2], half: f64) -> Region {
        Region { center: center.map(Dd::new), half_rad: [half; 2] }
    }

    fn cells() -> impl Strategy<Value = Cell> {
        (0..DEEPEST).prop_flat_map(|level| {
            let index = 0..1u128 << level;
            (index.clone(), index).prop_map(move |(x, y)| Cell { level, x, y })
        })
    }

    proptest! {
        #[test]
        fn a_cell_is_found_again_from_its_middle(cell in cells()) {
            prop_assert_eq!(Cell::around(cell.center(), cell.level), cell);
        }

        #[test]
        fn the_image_lies_exactly_opposite(cell in cells()) {
            let image = cell.mirrored();
            prop_assert_eq!(image.center(), cell.center().map(|theta| -theta));
            prop_assert_eq!(image.mirrored(), cell);
            prop_assert_eq!(image.canonical().0, cell.canonical().0);
        }

        #[test]
        fn quarters_lie_inside(cell in cells().prop_filter("not the last", |c| c.level + 1 < DEEPEST)) {
            let children = cell.children();
            prop_assert!(children.iter().all(|child| child.parent() == Some(cell)));
            prop_assert!(children.iter().all(|c| Cell::around(c.center(), cell.level) == cell));
        }
    }

    #[test]
    fn a_region_is_covered_and_no_more() {
        let region = region([0.3, -0.2], 0.5);
        let cells = region.cells(4, 1000);
        let side = side_rad(4).hi;
        for placed in &cells {
            for axis in 0..2 {
                assert!(placed.offset[axis].abs() <= 0.5 + side / 2.0);
            }
        }
        // Any point of the region lies in one of them.
        for (dx, dy) in [(-0.5, -0.5), (0.5, 0.5), (0.0, 0.1), (-0.49, 0.3)] {
            let angle = [Dd::new(0.3 + dx), Dd::new(-0.2 + dy)];
            let around = Cell::around(angle, 4);
            assert!(cells.iter().any(|placed| placed.cell == around));
        }
    }

    #[test]
    fn the_torus_repeats() {
        let wide = region([0.0, 0.0], 4.0).cells(1, 1000);
        assert_eq!(wide.len(), 16);
        let home = Cell { level: 1, x: 0, y: 0 };
        let offsets: Vec<f64> =
            wide.iter().filter(|p| p.cell == home).map(|p| p.offset[0]).collect();
        assert!(offsets.iter().any(|x| *x > 4.0) && offsets.iter().any(|x| *x < 0.0));
        assert!(region([0.0, 0.0], 4.0).cells(12, 1000).is_empty(), "too many is none");
    }

    #[test]
    fn samples_are_the_pixels_of_the_grid() {
        let cell = Cell { level: 5, x: 7, y: 20 };
        let grid = cell.grid(&Scene::default());
        for (column, row) in [(0, 0), (127, 127), (5, 90)] {
            assert_eq!(cell.sample_at(grid.angle_from_pixel(column, row)), [column, row]);
        }
        let image = cell.mirrored().grid(&Scene::default());
        let (here, there) = (grid.angle_from_pixel(3, 9), image.angle_from_pixel(124, 118));
        assert_eq!(here, there.map(|theta| -theta));
    }
}
