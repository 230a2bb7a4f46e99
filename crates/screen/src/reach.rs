//! The part of a plane of starts that a camera can reach, and the scale of its lattice.

use flipmap_numbers::{Exact, Scalar};
use flipmap_scene::Scene;

/// Scale and extent of the lattice, a square from −π to π, on a plane of starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reach {
    /// Number of doublings from the lattice to the units of the plane's axes.
    pub doublings: u32,
    /// True if the square repeats beyond its sides, as the torus does; else nothing lies beyond
    /// them.
    pub repeats: bool,
}

impl Reach {
    /// The torus of both angles, in rad.
    pub const TORUS: Reach = Reach { doublings: 0, repeats: true };

    /// Returns the reach of a scene's plane.
    pub fn of(scene: &Scene) -> Self {
        let doublings = scene.plane.lattice_doublings(&scene.build);
        Reach { doublings, repeats: scene.plane.is_torus() }
    }

    /// Returns the number of units of the axes in a lattice radian.
    pub fn units(self) -> f64 {
        2f64.powi(self.doublings as i32)
    }

    /// Returns the place of coordinates on the lattice, in lattice radians.
    pub fn place(self, coordinates: [Exact; 2]) -> [Exact; 2] {
        self.inside(coordinates.map(|x| x.halved(self.doublings)))
    }

    /// Returns the coordinates of a place, in the units of the axes.
    pub fn coordinates(self, place: [Exact; 2]) -> [Exact; 2] {
        place.map(|x| x.doubled(self.doublings))
    }

    /// Moves a place into the square: wraps it on the torus, else moves it to the nearest side.
    pub(crate) fn inside(self, place: [Exact; 2]) -> [Exact; 2] {
        let pi = Exact::pi();
        let bounded = |x: Exact| match x {
            _ if x > pi => pi,
            _ if x < -pi => -pi,
            _ => x,
        };
        if self.repeats { place.map(Exact::wrapped) } else { place.map(bounded) }
    }

    /// Returns the difference of two places, the short way round a torus, in lattice radians.
    pub(crate) fn difference(self, to: [Exact; 2], from: [Exact; 2]) -> [f64; 2] {
        [0, 1].map(|i| {
            let by = to[i] - from[i];
            if self.repeats { by.wrapped().to_f64() } else { by.to_f64() }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bounded_plane_ends_where_a_torus_goes_on() {
        let place = [3.5, -3.5].map(Exact::from_f64);
        let torus = Reach::TORUS.inside(place).map(Exact::to_f64);
        assert!(torus[0] < -2.0 && torus[1] > 2.0);
        let bounded = Reach { doublings: 4, repeats: false };
        assert_eq!(bounded.inside(place), [Exact::pi(), -Exact::pi()]);
        let speeds = bounded.coordinates([0.5, -0.25].map(Exact::from_f64));
        assert_eq!(speeds.map(Exact::to_f64), [8.0, -4.0]);
        assert_eq!(bounded.place(speeds).map(Exact::to_f64), [0.5, -0.25]);
    }
}
