//! The start of a pinned pixel, at rest or with speeds.

use super::reach::Reach;
use flipmap_numbers::Exact;
use flipmap_pendulum::Launch;
use flipmap_scene::Scene;

/// The start of a pinned pixel and of the one beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinStart {
    /// Place on the lattice of the plane that is shown; none once another plane is shown.
    pub place: Option<[Exact; 2]>,
    /// θ1 and θ2 of the pixel in rad; exact for a pixel at rest.
    pub angle: [Exact; 2],
    /// Starts of the pixel and of its neighbour.
    pub launches: [Launch; 2],
}

impl PinStart {
    /// Returns the starts from rest of a pixel and of the one beside it, from their θ1 and θ2 in
    /// rad.
    pub fn at_rest(angles: [[Exact; 2]; 2]) -> Self {
        let launches = angles.map(|angle| Launch::at_rest(angle.map(Exact::to_dd)));
        PinStart { place: Some(angles[0]), angle: angles[0], launches }
    }

    /// Returns the starts of a pixel of a scene's plane and of its neighbour, from their places on
    /// the lattice; none where a section has no pendulum.
    pub fn on_plane(scene: &Scene, reach: Reach, places: [[Exact; 2]; 2]) -> Option<Self> {
        if scene.plane.is_at_rest() {
            return Some(PinStart::at_rest(places));
        }
        let pendulum = scene.build.pendulum_in();
        let at = |place| scene.plane.launch(&pendulum, reach.coordinates(place).map(Exact::to_dd));
        let own = at(places[0])?;
        let beside = at(places[1]).unwrap_or(own);
        let angle = own.angle.map(Exact::from_dd);
        Some(PinStart { place: Some(places[0]), angle, launches: [own, beside] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_numbers::Scalar;
    use flipmap_scene::{Plane, PlaneKind};

    #[test]
    fn a_place_of_another_plane_is_a_start_with_speeds() {
        let places = [[0.5, 0.25], [0.51, 0.25]].map(|place| place.map(Exact::from_f64));
        let start = |plane: Plane| {
            let scene = Scene { plane, ..Scene::default() };
            PinStart::on_plane(&scene, Reach::of(&scene), places)
        };
        let home = start(Plane::default()).unwrap();
        assert_eq!(home, PinStart::at_rest(places));
        let kind: PlaneKind = "first".parse().unwrap();
        let origin = ["0", "1.5", "0", "-2"].map(str::to_string);
        let thrown = start(Plane { kind, origin, ..Plane::default() }).unwrap();
        let Launch { angle, speed } = thrown.launches[0];
        assert!((angle[1].hi, speed[1].hi) == (1.5, -2.0));
        assert!(speed[0].hi > 1.0, "the lattice covers fast starts: {speed:?}");
        assert!(thrown.launches[1] != thrown.launches[0]);
        let section = Plane { kind: PlaneKind::Section, energy: -29.0, ..Plane::default() };
        assert!(start(section).is_none(), "hardly any energy");
    }
}
