//! The places in the lattice at which the pixels of a deep picture lie.
//!
//! Start maps belong to cells of the lattice, never to a picture, a tile or a shard. A pixel is
//! therefore a leaf of the lattice and a point in it.

use super::ExactPlane;
use super::lattice::Cell;
use super::turn::Turn;
use flipmap_numbers::{Dd, Exact, Scalar};

/// Pixels by the leaf in which they lie: for each its place among all and its point in [−1, 1]².
pub type Grouped = Vec<(Cell, Vec<(u32, [f64; 2])>)>;

/// The pixels of a grid as places in the lattice.
#[derive(Clone, Debug)]
pub(super) struct LeafGrid {
    middle: [Turn; 2],
    right: [Turn; 2],
    up: [Turn; 2],
    /// Distance between the pixels that decide the level of the leaves, in rad of the lattice.
    pixel: f64,
}

impl LeafGrid {
    /// The places of a plane's grid around `center`, with the steps to the right and upwards per
    /// pixel; all in the units of the plane's axes.
    pub(super) fn new(plane: &ExactPlane, center: [Exact; 2], steps: [[Dd; 2]; 2]) -> Self {
        let from_zero = |by: Exact| Turn::from_theta(by) - Turn::from_theta(Exact::ZERO);
        let [right, up] = steps.map(|step| plane.to_lattice(step.map(Exact::from_dd)));
        let length = |by: [Exact; 2]| by[0].to_f64().hypot(by[1].to_f64());
        let pixel = (length(right) * length(up)).sqrt();
        LeafGrid {
            middle: plane.to_lattice(center).map(Turn::from_theta),
            right: right.map(from_zero),
            up: up.map(from_zero),
            pixel,
        }
    }

    /// The same places in the leaves of another grid, whose pixels lie closer.
    pub(super) fn in_leaves_of(self, others: &LeafGrid) -> Self {
        LeafGrid { pixel: others.pixel, ..self }
    }

    /// Groups some pixels of a picture of `size` by their leaves, with about `leaf_pixels` along a side;
    /// each comes with its place among all.
    pub(super) fn grouped(
        &self,
        size: [u32; 2],
        leaf_pixels: u32,
        pixels: impl Iterator<Item = (u32, [u32; 2])>,
    ) -> Grouped {
        let sides = std::f64::consts::TAU / (f64::from(leaf_pixels) * self.pixel);
        let level = sides.log2().floor().max(0.0) as u32;
        let across = |column: u32| f64::from(column) + 0.5 - f64::from(size[0]) / 2.0;
        let above = |row: u32| f64::from(size[1]) / 2.0 - f64::from(row) - 0.5;
        // Products of long numbers take longer than all else here: one for each column and row.
        let mut columns = Offsets::new(|column| self.right.map(|step| step.times(across(column))));
        let mut rows = Offsets::new(|row| self.up.map(|step| step.times(above(row))));
        let mut groups = std::collections::BTreeMap::<Cell, Vec<_>>::new();
        for (place, [column, row]) in pixels {
            let (right, up) = (columns.at(column), rows.at(row));
            let at = [0, 1].map(|i| self.middle[i] + right[i] + up[i]);
            let cell = Cell::at(at, level);
            groups.entry(cell).or_default().push((place, cell.point(at)));
        }
        groups.into_iter().collect()
    }
}

/// Distances from the middle of a picture, of the columns or rows met so far.
struct Offsets<F> {
    known: Vec<Option<[Turn; 2]>>,
    compute: F,
}

impl<F: Fn(u32) -> [Turn; 2]> Offsets<F> {
    fn new(compute: F) -> Self {
        Offsets { known: Vec::new(), compute }
    }

    fn at(&mut self, index: u32) -> [Turn; 2] {
        let place = index as usize;
        if place >= self.known.len() {
            self.known.resize(place + 1, None);
        }
        *self.known[place].get_or_insert_with(|| (self.compute)(index))
    }
}
