//! Selections of deep starts, and their exact states.

use crate::{Deep, EventSpec, Leaf, StartList, Starts};
use flipmap_numbers::{Dd, Exact, Scalar};
use flipmap_pendulum::opening::from_top;
use flipmap_pendulum::{Launch, State};
use flipmap_scene::lattice::Cell;
use flipmap_scene::question::Needs;

impl Deep {
    /// Selects starts by their indices, in ascending order, and moves them by `by`, in units of
    /// half the side of their leaf.
    pub(crate) fn some(&self, places: &[usize], strict: bool, by: [f64; 2]) -> Deep {
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
    pub(crate) fn half_side(&self) -> f64 {
        self.leaves.first().map_or(0.0, |leaf| self.plane.half_side(leaf.cell.level))
    }

    /// The starts, angles in (−π, π] rad and speeds in rad/s; `None` where a section has no real
    /// solution.
    pub(crate) fn exact(&self) -> impl Iterator<Item = Option<State<Exact>>> {
        self.places().map(|(cell, at)| self.plane.start(&cell, at))
    }

    /// Returns the leaf of every start, and the place of the start in it.
    pub(super) fn places(&self) -> impl Iterator<Item = (Cell, [f64; 2])> {
        self.leaves.iter().flat_map(|leaf| leaf.points.iter().map(|at| (leaf.cell, *at)))
    }

    /// Returns the starts for an integration from their release, to the precision of double-double,
    /// or to a higher one beside the top.
    pub(crate) fn rounded(&self, question: &EventSpec, ends: Needs) -> Starts {
        let opening = question.opening(ends);
        let unit_secs = question.reduced_in::<Exact>().1;
        let mut starts = StartList::default();
        for start in self.exact() {
            // A start that does not exist is forbidden on every start map, so none gets here.
            let Some(start) = start else {
                starts.push_thrown(NOWHERE);
                continue;
            };
            let reduced = State { speed: start.speed.map(|speed| speed * unit_secs), ..start };
            let from_top = start.angle.map(|angle| from_top(angle).to_f64());
            if opening.concerns(from_top, reduced.speed.map(Exact::to_f64)) {
                starts.push_beside_top(Box::new(opening.first_moments(&reduced)));
            } else if self.plane.is_at_rest() {
                starts.push_at_rest(start.angle.map(Exact::to_dd));
            } else {
                let [angle, speed] = [start.angle, start.speed].map(|pair| pair.map(Exact::to_dd));
                starts.push_thrown(Launch { angle, speed });
            }
        }
        starts.into_starts()
    }
}

/// A start that does not exist.
const NOWHERE: Launch =
    Launch { angle: [Dd { hi: f64::NAN, lo: 0.0 }; 2], speed: [Dd { hi: f64::NAN, lo: 0.0 }; 2] };
