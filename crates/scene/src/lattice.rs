//! The lattice: the torus of starts, divided into quarters again and again.
//!
//! Level 0 is one cell, the whole torus from −π to π in both angles. Each level cuts every cell
//! into four quarters, so that 2^level cells lie along each axis, down to level [`DEEPEST`].
//!
//! ```text
//!   π ┌───────────────┬───────┬───────┐   The numbers are indices into `Cell::children`: the
//!     │               │   1   │   3   │   left two from below, then the right two. Quarter 3 of
//!     │       1       ├───┬───┼───────┤   the torus is cut again here, and quarter 0 of that too.
//!     │               │ 1 │ 3 │       │
//!  θ2 │               ├───┼───┤   2   │   The left edge is the right one, and the lower edge the
//!     │               │ 0 │ 2 │       │   upper one: a region beyond ±π meets the same cells
//!     ├───────────────┼───┴───┴───────┤   again.
//!     │       0       │       2       │
//!  −π └───────────────┴───────────────┘
//!    −π              θ1               π
//! ```
//!
//! - Corners are multiples of 2^−level turns, which 448 bits after the point hold exactly.
//! - Planes with speeds or momenta are covered by the same square, enlarged and without repeats
//!   ([`super::Plane::lattice_doublings`]).
//! - A cell does not depend on a view. The window always samples it in the same [`SIDE`] × [`SIDE`]
//!   places (films in fewer, see `tiles::patches`), so a place is the same tile in every view.
//! - (θ1, θ2) → (−θ1, −θ2) maps the lattice onto itself and keeps the flip times from rest. A cell
//!   and its image have the same samples in reverse order, and only one of the two is ever computed
//!   ([`Cell::canonical`]). Only the whole torus is its own image.

use crate::leaf_grid::Grouped;
use crate::{Grid, Scene, Turn};
use flipmap_numbers::{Exact, Scalar};

/// Samples along each side of a cell.
pub const SIDE: u32 = 64;
/// Samples in a cell.
pub const SAMPLES: usize = (SIDE * SIDE) as usize;
/// The deepest level: its cells are about 7e-106 rad wide.
pub const DEEPEST: u32 = 352;

/// A square of the torus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Cell {
    /// Level of the cell: 2^level cells lie along each axis.
    pub level: u32,
    /// Left side in turns, in [0, 1).
    pub x: Turn,
    /// Lower side in turns, in [0, 1).
    pub y: Turn,
}

/// A rectangle of the plane around a centre, to be searched for cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Centre (θ1, θ2) in rad.
    pub center: [Exact; 2],
    /// Half the extent along θ1 and θ2 in rad.
    pub half_rad: [f64; 2],
    /// True if cells repeat beyond ±π, as on the torus; otherwise there are none beyond.
    pub repeats: bool,
}

/// One appearance of a cell in a region; a cell may appear several times, because the torus
/// repeats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// The cell itself.
    pub cell: Cell,
    /// Offset of the cell's middle from the region's centre, rad.
    pub offset: [f64; 2],
}

/// Returns the side of a level's cells in rad.
pub fn side_rad(level: u32) -> f64 {
    std::f64::consts::TAU * 0.5f64.powi(level as i32)
}

/// Returns the distance between a level's samples in rad.
pub fn pitch_rad(level: u32) -> f64 {
    side_rad(level) / f64::from(SIDE)
}

impl Cell {
    /// The whole torus.
    pub const WHOLE: Cell = Cell { level: 0, x: Turn::ZERO, y: Turn::ZERO };

    /// Returns the cell of a level in which a start lies.
    pub fn around(angle: [Exact; 2], level: u32) -> Cell {
        Cell::at(angle.map(Turn::from_theta), level)
    }

    /// Returns the cell of a level in which a place lies.
    pub fn at(place: [Turn; 2], level: u32) -> Cell {
        let [x, y] = place.map(|turn| turn.wrapped().floor(level));
        Cell { level, x, y }
    }

    /// Returns the middle of the cell in rad, in (−π, π); exactly odd about the origin.
    pub fn center(&self) -> [Exact; 2] {
        self.middle().map(Turn::to_theta)
    }

    /// Returns the middle of the cell in turns.
    pub fn middle(&self) -> [Turn; 2] {
        [self.x, self.y].map(|corner| corner + Turn::side(self.level + 1))
    }

    /// Returns the cell one level up that contains this one, or `None` for the whole torus.
    pub fn parent(&self) -> Option<Cell> {
        Some(self.ancestor(self.level.checked_sub(1)?))
    }

    /// Returns the cell of a coarser level that contains this one.
    pub fn ancestor(&self, level: u32) -> Cell {
        Cell { level, x: self.x.floor(level), y: self.y.floor(level) }
    }

    /// Returns the quarters of the cell: the left two from below, then the right two.
    pub fn children(&self) -> [Cell; 4] {
        let half = Turn::side(self.level + 1);
        let zero = Turn::ZERO;
        [(zero, zero), (zero, half), (half, zero), (half, half)].map(|(x, y)| Cell {
            level: self.level + 1,
            x: self.x + x,
            y: self.y + y,
        })
    }

    /// Returns the offset of the lower left corner from that of a containing cell, in sides of this
    /// cell.
    pub fn index_in(&self, ancestor: &Cell) -> [f64; 2] {
        let sides = 2f64.powi(self.level as i32);
        [self.x - ancestor.x, self.y - ancestor.y].map(|by| by.to_f64() * sides)
    }

    /// Maps a place inside the cell to [−1, 1]².
    pub(crate) fn point(&self, place: [Turn; 2]) -> [f64; 2] {
        let half = 2f64.powi(self.level as i32 + 1);
        let corner = [self.x, self.y];
        [0, 1].map(|i| (place[i] - corner[i]).wrapped().to_f64() * half - 1.0)
    }

    /// Groups the cell's `samples` × `samples` samples by leaves, the cells that start maps belong
    /// to. Each leaf has `leaf` samples along a side; both numbers are powers of two. A leaf may be
    /// larger than the cell.
    pub fn leaves(&self, samples: u32, leaf: u32) -> Grouped {
        if leaf > samples {
            let holder = self.ancestor(self.level.saturating_sub((leaf / samples).ilog2()));
            let along = samples << (self.level - holder.level);
            let before = self.index_in(&holder).map(|sides| sides as u32 * samples);
            return vec![(holder, points_of([0, 0], samples, samples, (before, along)))];
        }
        let leaves = samples / leaf;
        let level = self.level + leaves.ilog2();
        let mut groups = Grouped::new();
        let mut x = self.x;
        for i in 0..leaves {
            let mut y = self.y;
            for j in 0..leaves {
                let points = points_of([i * leaf, j * leaf], leaf, samples, ([0, 0], leaf));
                groups.push((Cell { level, x, y }, points));
                y = y + Turn::side(level);
            }
            x = x + Turn::side(level);
        }
        groups
    }

    /// Returns the cell's image under (θ1, θ2) → (−θ1, −θ2).
    pub(crate) fn mirrored(&self) -> Cell {
        let last = Turn::side(0) - Turn::side(self.level);
        Cell { level: self.level, x: last - self.x, y: last - self.y }
    }

    /// Returns the cell or its image, whichever is computed, and true if it is the image.
    pub fn canonical(&self) -> (Cell, bool) {
        let image = self.mirrored();
        if image < *self { (image, true) } else { (*self, false) }
    }

    /// Returns the cell whose samples are computed for this one, and true if it is the image of
    /// this one. `mirrors` is true if images have equal samples.
    pub fn computed(&self, mirrors: bool) -> (Cell, bool) {
        if mirrors { self.canonical() } else { (*self, false) }
    }

    /// Returns the `samples` × `samples` samples as a picture of `scene`'s pendulum and plane, row
    /// 0 at the top.
    pub fn grid(&self, scene: &Scene, samples: u32) -> Grid {
        let doublings = scene.plane.lattice_doublings(&scene.build);
        let side = Exact::pi().doubled(1 + doublings).halved(self.level);
        let pixel = side / Exact::from_f64(f64::from(samples));
        let center = self.center().map(|middle| middle.doubled(doublings));
        Grid::square(scene, center, pixel.to_dd(), [samples; 2])
    }

    /// Returns the column and row of the sample nearest to a start inside the cell.
    pub fn sample_at(&self, angle: [Exact; 2]) -> [u32; 2] {
        let center = self.center();
        let pitch = pitch_rad(self.level);
        let place = |i: usize| (angle[i] - center[i]).wrapped().to_f64() / pitch;
        let half = f64::from(SIDE / 2);
        let index = |samples: f64| samples.floor().clamp(0.0, f64::from(SIDE - 1)) as u32;
        [index(half + place(0)), index(half - place(1))]
    }
}

impl Region {
    /// Returns the cells of a level that touch the region, at every place where they appear in it,
    /// row by row. The result is empty if there are more than `most`.
    pub fn cells(&self, level: u32, most: usize) -> Vec<Placed> {
        let side_rad = side_rad(level);
        let count = |half: f64| 2.0 * half / side_rad;
        if count(self.half_rad[0]).max(1.0) * count(self.half_rad[1]).max(1.0) > most as f64 {
            return Vec::new();
        }
        let [columns, rows] = [0, 1].map(|axis| self.sides(axis, level));
        if columns.len() * rows.len() > most {
            return Vec::new();
        }
        let column = &columns;
        let exists = |corner: &[Turn; 2]| self.repeats || *corner == corner.map(Turn::wrapped);
        rows.iter()
            .flat_map(|&y| column.iter().map(move |&x| [x, y]))
            .filter(exists)
            .map(|corner| self.placed(corner, level))
            .collect()
    }

    /// Returns the region with its extent multiplied by `times`.
    pub fn scaled(&self, times: f64) -> Region {
        Region { half_rad: self.half_rad.map(|half| half * times), ..*self }
    }

    /// Returns the left or lower sides of the cells along an axis, not wrapped.
    fn sides(&self, axis: usize, level: u32) -> Vec<Turn> {
        let half = Exact::from_f64(self.half_rad[axis]);
        let first = Turn::from_theta(self.center[axis] - half).floor(level);
        let last = Turn::from_theta(self.center[axis] + half).floor(level);
        let next = |at: &Turn| Some(*at + Turn::side(level)).filter(|next| *next <= last);
        std::iter::successors(Some(first), next).collect()
    }

    fn placed(&self, corner: [Turn; 2], level: u32) -> Placed {
        let middle = corner.map(|corner| corner + Turn::side(level + 1));
        let offset = [0, 1].map(|i| (middle[i].to_theta() - self.center[i]).to_f64());
        let [x, y] = corner.map(Turn::wrapped);
        Placed { cell: Cell { level, x, y }, offset }
    }
}

/// Returns `count` × `count` samples of a cell, from the column and row `first` on, counted from
/// the lower left. Each sample has its index among the cell's `samples` × `samples` and its point
/// in a leaf. The leaf has `along` samples along a side, `before` of which lie to the left of the
/// returned samples and below them.
fn points_of(
    first: [u32; 2],
    count: u32,
    samples: u32,
    (before, along): ([u32; 2], u32),
) -> Vec<(u32, [f64; 2])> {
    // Rows count from the top.
    let place = |a: u32, b: u32| (samples - 1 - first[1] - b) * samples + first[0] + a;
    let at = |k: u32| f64::from(2 * k + 1) / f64::from(along) - 1.0;
    let all = (0..count).flat_map(|b| (0..count).map(move |a| [a, b]));
    all.map(|[a, b]| (place(a, b), [at(before[0] + a), at(before[1] + b)])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn region(center: [f64; 2], half: f64) -> Region {
        Region { center: center.map(Exact::from_f64), half_rad: [half; 2], repeats: true }
    }

    fn cells() -> impl Strategy<Value = Cell> {
        (0..DEEPEST).prop_flat_map(|level| {
            let limbs = any::<[u64; 7]>().prop_map(move |limbs| {
                let mut all = [0; 8];
                all[..7].copy_from_slice(&limbs);
                Turn::from_limbs(all).floor(level)
            });
            (limbs.clone(), limbs).prop_map(move |(x, y)| Cell { level, x, y })
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
        let side = side_rad(4);
        for placed in &cells {
            for axis in 0..2 {
                assert!(placed.offset[axis].abs() <= 0.5 + side / 2.0);
            }
        }
        // Any point of the region lies in one of them.
        for (dx, dy) in [(-0.5, -0.5), (0.5, 0.5), (0.0, 0.1), (-0.49, 0.3)] {
            let angle = [0.3 + dx, -0.2 + dy].map(Exact::from_f64);
            let around = Cell::around(angle, 4);
            assert!(cells.iter().any(|placed| placed.cell == around));
        }
    }

    #[test]
    fn the_torus_repeats() {
        let wide = region([0.0, 0.0], 4.0).cells(1, 1000);
        assert_eq!(wide.len(), 16);
        let home = Cell { level: 1, ..Cell::WHOLE };
        let offsets: Vec<f64> =
            wide.iter().filter(|p| p.cell == home).map(|p| p.offset[0]).collect();
        assert!(offsets.iter().any(|x| *x > 4.0) && offsets.iter().any(|x| *x < 0.0));
        assert!(region([0.0, 0.0], 4.0).cells(12, 1000).is_empty(), "too many is none");
        let bounded = Region { repeats: false, ..region([0.0, 0.0], 4.0) };
        assert_eq!(bounded.cells(1, 1000).len(), 4, "each once");
    }

    #[test]
    fn samples_are_the_pixels_of_the_grid() {
        let cell = Cell { level: 5, x: Turn::from_f64(7.0 / 32.0), y: Turn::from_f64(20.0 / 32.0) };
        let grid = cell.grid(&Scene::default(), SIDE);
        for (column, row) in [(0, 0), (63, 63), (5, 45)] {
            let start = grid.angle_from_pixel(column, row).map(Exact::from_dd);
            assert_eq!(cell.sample_at(start), [column, row]);
        }
        let image = cell.mirrored().grid(&Scene::default(), SIDE);
        let (here, there) = (grid.angle_from_pixel(3, 9), image.angle_from_pixel(60, 54));
        assert_eq!(here, there.map(|theta| -theta));
    }

    #[test]
    fn samples_are_shared_out_to_leaves() {
        let cell = Cell::around([2.2, -1.9].map(Exact::from_f64), 20);
        for (samples, leaf, leaves, level) in [(128, 64, 4, 21), (128, 16, 64, 23), (32, 64, 1, 19)]
        {
            let groups = cell.leaves(samples, leaf);
            assert_eq!(groups.len(), leaves);
            assert!(groups.iter().all(|(leaf, _)| leaf.level == level));
            let grid = cell.grid(&Scene::default(), samples);
            for (leaf, points) in &groups {
                for (place, [x, y]) in points {
                    let start = grid.angle_from_pixel(place % samples, place / samples);
                    let there =
                        leaf.point(start.map(|angle| Turn::from_theta(Exact::from_dd(angle))));
                    assert!((there[0] - x).abs() < 1e-9 && (there[1] - y).abs() < 1e-9);
                }
            }
            let mut places: Vec<u32> = groups
                .iter()
                .flat_map(|(_, points)| points.iter().map(|(place, _)| *place))
                .collect();
            places.sort_unstable();
            assert!(places.into_iter().eq(0..samples * samples));
        }
    }
}
