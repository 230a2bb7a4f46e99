//! Selections of deep starts, and their angles.

use crate::engine::{Deep, Leaf};
use crate::physics::{Scalar, Theta};
use crate::scene::lattice::side_rad;

impl Deep {
    /// Selects some of the starts, by their indices among all, in order, and moves them by a share
    /// of half their leaf.
    pub fn some(&self, places: &[usize], strict: bool, by: [f64; 2]) -> Deep {
        let mut wanted = places.iter().copied().peekable();
        let (mut leaves, mut first) = (Vec::new(), 0);
        for leaf in &self.leaves {
            let end = first + leaf.points.len();
            let mut points = Vec::new();
            while let Some(place) = wanted.next_if(|place| *place < end) {
                let [x, y] = leaf.points[place - first];
                points.push([x + by[0], y + by[1]]);
            }
            if !points.is_empty() {
                leaves.push(Leaf { cell: leaf.cell, points });
            }
            first = end;
        }
        Deep { leaves, strict }
    }

    /// Half the side of the leaves in rad.
    pub fn half_rad(&self) -> f64 {
        self.leaves.first().map_or(0.0, |leaf| side_rad(leaf.cell.level + 1))
    }

    /// The angles of the starts in rad.
    pub fn exact_angles(&self) -> Vec<[Theta; 2]> {
        let half = Theta::from_f64(self.half_rad());
        let angle = |leaf: &Leaf, at: &[f64; 2]| {
            let center = leaf.cell.center();
            [0, 1].map(|i| (center[i] + Theta::from_f64(at[i]) * half).wrapped())
        };
        self.leaves.iter().flat_map(|leaf| leaf.points.iter().map(|at| angle(leaf, at))).collect()
    }
}
