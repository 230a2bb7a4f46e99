//! Selections of deep starts, and their exact states.

use crate::engine::{Deep, Leaf, Starts};
use crate::physics::{Dd, Launch, State, Theta};
use crate::scene::lattice::Cell;

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
        Deep { leaves, plane: self.plane.clone(), strict }
    }

    /// Half the side of the leaves in the units of the plane's axes.
    pub fn half_side(&self) -> f64 {
        self.leaves.first().map_or(0.0, |leaf| self.plane.half_side(leaf.cell.level))
    }

    /// The starts, angles in (−π, π] rad and speeds in rad/s; none where a section has no real
    /// solution.
    pub fn exact(&self) -> impl Iterator<Item = Option<State<Theta>>> {
        self.places().map(|(cell, at)| self.plane.start(&cell, at))
    }

    /// The leaf of every start, and its place there.
    pub(super) fn places(&self) -> impl Iterator<Item = (Cell, [f64; 2])> {
        self.leaves.iter().flat_map(|leaf| leaf.points.iter().map(|at| (leaf.cell, *at)))
    }

    /// The starts to the precision of double-double.
    pub fn rounded(&self) -> Starts {
        // A start that does not exist is forbidden on every start map, so none gets here.
        let nowhere = Launch { angle: [Dd::new(f64::NAN); 2], speed: [Dd::new(f64::NAN); 2] };
        let rounded = |state: Option<State<Theta>>| {
            state.map_or(nowhere, |state| Launch {
                angle: state.angle.map(Theta::to_dd),
                speed: state.speed.map(Theta::to_dd),
            })
        };
        if self.plane.is_at_rest() {
            return Starts::Rest(self.exact().map(|state| rounded(state).angle).collect());
        }
        Starts::Thrown(self.exact().map(rounded).collect())
    }
}
