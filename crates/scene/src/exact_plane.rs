//! Planes of starts in exact numbers, and neighbourhoods of their points as polynomials.
//!
//! The lattice is a square from −π to π. To cover a plane that is not a torus, it is enlarged by a
//! power of two, in the units of the plane's axes ([`Plane::lattice_doublings`]).

use super::lattice::{Cell, side_rad};
use super::plane::{omega2_beside, speeds_on_section, square_of_omega1};
use super::{Axis, PendulumSpec, Plane};
use flipmap_numbers::jet::Jet;
use flipmap_numbers::{Angle, Exact, Scalar};
use flipmap_pendulum::{Pendulum, Rule, State};

/// A plane of starts in exact numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactPlane {
    /// Indices of the quantities across and up among θ1, θ2, ω1 and ω2; on a section, p2 takes the
    /// place of ω2.
    places: [usize; 2],
    /// The quantities that do not vary, in rad and rad/s.
    origin: [Exact; 4],
    /// Number of doublings of the lattice.
    doublings: u32,
    /// The energy that determines both speeds, if the plane is a section.
    section: Option<Section>,
}

/// The energy of a section in J, and the pendulum in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Section {
    energy: Exact,
    pendulum: Pendulum<Exact>,
}

impl ExactPlane {
    /// The torus of both angles, with pendulums released from rest.
    pub const AT_REST: ExactPlane =
        ExactPlane { places: [0, 1], origin: [Exact::ZERO; 4], doublings: 0, section: None };

    /// Converts a checked plane to exact numbers.
    pub(crate) fn new(plane: &Plane, build: &PendulumSpec) -> Self {
        let axes = plane.axes();
        let section = axes.contains(&Axis::Momentum2).then(|| Section {
            energy: Exact::from_f64(plane.energy),
            pendulum: build.pendulum_in(),
        });
        let origin = match section {
            Some(_) => [Exact::ZERO; 4],
            None => [0, 1, 2, 3].map(|i| Exact::parse(&plane.origin[i]).unwrap_or(Exact::ZERO)),
        };
        let doublings = plane.lattice_doublings(build);
        ExactPlane { places: axes.map(Axis::place), origin, doublings, section }
    }

    /// Returns true if every position has a start and the start's quantities are linear in the
    /// position.
    pub(crate) fn is_flat(&self) -> bool {
        self.section.is_none()
    }

    /// Returns `Some(true)` if the energy shared by all starts of a section forbids every flip, and
    /// `None` if the plane is not a section.
    pub fn forbids_section(&self, rule: Rule) -> Option<bool> {
        let Section { energy, pendulum } = &self.section?;
        Some(pendulum.forbids_depth(rule, -*energy))
    }

    /// Returns true if the plane's starts are at rest.
    pub fn is_at_rest(&self) -> bool {
        let is_still =
            |place: usize| !self.places.contains(&place) && self.origin[place] == Exact::ZERO;
        self.is_flat() && is_still(2) && is_still(3)
    }

    /// Returns true if the lattice reaches all positions up to `half` from a centre along each
    /// axis, in the units of the axes. Angles repeat, so all of them are reached.
    pub(crate) fn reaches(&self, center: [f64; 2], half: [f64; 2]) -> bool {
        let most = self.half_side(0);
        (0..2).all(|i| self.places[i] < 2 || center[i].abs() + half[i] < most)
    }

    /// Converts a position from the units of the axes to those of the lattice.
    pub fn to_lattice(&self, at: [Exact; 2]) -> [Exact; 2] {
        at.map(|x| x.halved(self.doublings))
    }

    /// Returns half the side of a level's cells in the units of the axes.
    pub fn half_side(&self, level: u32) -> f64 {
        side_rad(level + 1) * 2f64.powi(self.doublings as i32)
    }

    /// Returns the start at a point of a cell, in [−1, 1]²: angles in (−π, π] rad, speeds in rad/s.
    /// Returns `None` where a section has no real solution.
    pub fn start(&self, cell: &Cell, at: [f64; 2]) -> Option<State<Exact>> {
        let half = Exact::from_f64(self.half_side(cell.level));
        let center = cell.center().map(|middle| middle.doubled(self.doublings));
        self.start_at([0, 1].map(|i| center[i] + Exact::from_f64(at[i]) * half))
    }

    /// Returns the start at a position in the units of the axes: angles in (−π, π] rad, speeds in
    /// rad/s. Returns `None` where a section has no real solution.
    pub(crate) fn start_at(&self, position: [Exact; 2]) -> Option<State<Exact>> {
        let mut start = self.origin;
        for (place, value) in self.places.into_iter().zip(position) {
            start[place] = value;
        }
        let [theta1, theta2, omega1, last] = start;
        let angle = [theta1, theta2].map(Exact::wrapped);
        let speed = match &self.section {
            None => [omega1, last],
            Some(Section { energy, pendulum }) => {
                speeds_on_section(pendulum, *energy, angle[1], last)?
            }
        };
        Some(State { angle, speed })
    }

    /// Returns the differences of a cell's starts from its middle: both angles in rad, both speeds
    /// in rad/s. Returns `None` where a section's cell has starts without a real solution.
    pub fn differences(&self, cell: &Cell) -> Option<[Jet; 4]> {
        let mut jets = [Jet::constant(0.0); 4];
        for (i, place) in self.places.into_iter().enumerate() {
            jets[place] = Jet::coordinate(i, self.half_side(cell.level));
        }
        let Some(Section { energy, pendulum }) = &self.section else { return Some(jets) };
        let [theta2, p2] = cell.center().map(|middle| middle.doubled(self.doublings));
        let direction = theta2.wrapped().sin_cos();
        // Near the section's edge its terms nearly cancel, so the middle is computed exactly.
        let middle = square_of_omega1(pendulum, *energy, direction, p2).to_f64();
        let (sin, cos) = direction;
        let direction = Jet::sin_cos_around((sin.to_f64(), cos.to_f64()), jets[1]);
        let p2 = Jet::constant(p2.to_f64()) + jets[3];
        let pendulum = pendulum.to_f64().map(Jet::constant);
        let energy = Jet::constant(energy.to_f64());
        let square = square_of_omega1(&pendulum, energy, direction, p2).with_middle(middle);
        if square.middle() <= square.spread() {
            return None;
        }
        let omega1 = square.sqrt();
        let omega2 = omega2_beside(&pendulum, omega1, direction.1, p2);
        Some([jets[0], jets[1], omega1.with_middle(0.0), omega2.with_middle(0.0)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PlaneKind, Turn};
    use flipmap_numbers::Dd;

    #[test]
    fn starts_of_a_cell_are_those_of_the_plane() {
        let build = PendulumSpec::default();
        let origin = ["0.5", "-1.25", "3", "-0.5"].map(str::to_string);
        for kind in ["angles", "speeds", "first", "omega2,theta1", "section"] {
            let kind: PlaneKind = kind.parse().unwrap();
            let plane = Plane { kind, origin: origin.clone(), energy: 3.0 };
            let exact = ExactPlane::new(&plane, &build);
            assert!(!exact.is_at_rest());
            let place = [0.75, -0.5].map(Exact::from_f64);
            let turns = exact.to_lattice(place).map(Turn::from_theta);
            let cell = Cell::at(turns, 40);
            let at = cell.point(turns);
            let start = exact.start(&cell, at).unwrap();
            let want = plane.launch(&build.pendulum_in(), place.map(Exact::to_dd)).unwrap();
            let near = |a: Exact, b: Dd| (a.to_dd() - b).abs().to_f64() < 1e-22;
            assert!((0..2).all(|i| near(start.angle[i], want.angle[i])), "{kind}");
            assert!((0..2).all(|i| near(start.speed[i], want.speed[i])), "{kind}");
            let middle = exact.start(&cell, [0.0; 2]).unwrap();
            let [a1, a2, w1, w2] = exact.differences(&cell).unwrap().map(|jet| jet.at(at));
            let by = |now: Exact, then: Exact| (now - then).to_f64();
            let moved = [
                by(start.angle[0], middle.angle[0]) - a1,
                by(start.angle[1], middle.angle[1]) - a2,
                by(start.speed[0], middle.speed[0]) - w1,
                by(start.speed[1], middle.speed[1]) - w2,
            ];
            assert!(moved.iter().all(|by| by.abs() < 1e-25), "{moved:?}");
        }
        assert_eq!(ExactPlane::new(&Plane::default(), &build), ExactPlane::AT_REST);
        assert!(ExactPlane::AT_REST.reaches([1e6; 2], [1.0; 2]), "angles repeat");
        let plane = Plane { kind: "first".parse().unwrap(), ..Plane::default() };
        let exact = ExactPlane::new(&plane, &build);
        assert!(exact.reaches([1e6, 49.0], [1.0; 2]) && !exact.reaches([0.0, 5000.0], [1.0; 2]));
    }

    #[test]
    fn a_section_ends_where_its_energy_does() {
        let build = PendulumSpec::default();
        let plane = Plane { kind: PlaneKind::Section, energy: 0.0, ..Plane::default() };
        let exact = ExactPlane::new(&plane, &build);
        let cell = |p2: f64| {
            let place = exact.to_lattice([0.5, p2].map(Exact::from_f64));
            Cell::around(place, 60)
        };
        assert!(exact.start(&cell(3.0), [0.0; 2]).is_some());
        assert!(exact.start(&cell(9.0), [0.0; 2]).is_none());
        assert!(exact.differences(&cell(3.0)).is_some() && exact.differences(&cell(9.0)).is_none());
    }
}
