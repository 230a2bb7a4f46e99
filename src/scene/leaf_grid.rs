//! The places in the lattice at which the pixels of a deep picture lie.
//!
//! Start maps belong to cells of the lattice, never to a picture, a tile or a shard. A pixel is
//! therefore a leaf of the lattice and a point in it.

use super::ExactPlane;
use super::lattice::Cell;
use super::turn::Turn;
use crate::physics::{Dd, Scalar, Theta};

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
    pub(super) fn new(plane: &ExactPlane, center: [Theta; 2], steps: [[Dd; 2]; 2]) -> Self {
        let from_zero = |by: Theta| Turn::from_theta(by) - Turn::from_theta(Theta::ZERO);
        let [right, up] = steps.map(|step| plane.to_lattice(step.map(Theta::from_dd)));
        let length = |by: [Theta; 2]| by[0].to_f64().hypot(by[1].to_f64());
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

    /// The leaf of a point `across` pixels to the right of the centre and `above` pixels above it,
    /// and the point's place in that leaf.
    fn leaf_point(&self, level: u32, across: f64, above: f64) -> (Cell, [f64; 2]) {
        let place =
            [0, 1].map(|i| self.middle[i] + self.right[i].times(across) + self.up[i].times(above));
        let cell = Cell::at(place, level);
        (cell, cell.point(place))
    }

    /// Groups pixels of a picture of `size` by their leaves, with about `leaf_pixels` along a side.
    pub(super) fn grouped(
        &self,
        size: [u32; 2],
        leaf_pixels: u32,
        pixels: impl Iterator<Item = [u32; 2]>,
    ) -> Grouped {
        let sides = std::f64::consts::TAU / (f64::from(leaf_pixels) * self.pixel);
        let level = sides.log2().floor().max(0.0) as u32;
        let mut groups = std::collections::BTreeMap::<Cell, Vec<_>>::new();
        for (place, [column, row]) in (0..).zip(pixels) {
            let across = f64::from(column) + 0.5 - f64::from(size[0]) / 2.0;
            let above = f64::from(size[1]) / 2.0 - f64::from(row) - 0.5;
            let (cell, point) = self.leaf_point(level, across, above);
            groups.entry(cell).or_default().push((place, point));
        }
        groups.into_iter().collect()
    }
}
