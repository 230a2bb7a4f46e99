//! Positions of a deep picture's pixels in the lattice.
//!
//! A start map belongs to a cell of the lattice rather than to a picture, a tile or a shard. A
//! pixel is therefore described by a leaf of the lattice and a point in that leaf.

use super::ExactPlane;
use super::lattice::Cell;
use super::turn::Turn;
use flipmap_numbers::{Dd, Exact, Scalar};

/// Pixels grouped by leaf: each has its index among all pixels and its point in the leaf, in [−1,
/// 1]².
pub type Grouped = Vec<(Cell, Vec<(u32, [f64; 2])>)>;

/// A grid's pixels as positions in the lattice.
#[derive(Clone, Debug)]
pub(super) struct LeafGrid {
    middle: [Turn; 2],
    right: [Turn; 2],
    up: [Turn; 2],
    /// Pixel spacing that sets the level of the leaves, in rad of the lattice.
    pixel: f64,
}

impl LeafGrid {
    /// Places a plane's grid around `center`, with `steps` per pixel to the right and upwards, all
    /// in the units of the plane's axes.
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

    /// Returns the same pixels, to be grouped by the leaves of a grid with closer pixels.
    pub(super) fn in_leaves_of(self, others: &LeafGrid) -> Self {
        LeafGrid { pixel: others.pixel, ..self }
    }

    /// Groups pixels of a picture of `size` by leaf, with about `leaf_pixels` pixels along a leaf's
    /// side. Each pixel is given with its index among all.
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
        // Products of long numbers dominate the time here, so each column and row computes its own
        // once.
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

/// Offsets from the middle of a picture, cached for the columns or rows used so far.
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
