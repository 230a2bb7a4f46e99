//! The plane of starts that a view lies in: a flat piece of the four-dimensional space of angles
//! and speeds, or a section of constant energy through it.

use std::f64::consts::PI;
use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::allowed::{did_you_mean, names_of};
use super::angle_text::in_rad;
use super::exact_length::exactly;
use super::{PendulumSpec, SceneError, Setting};
use flipmap_numbers::{Dd, Real, Scalar};
use flipmap_pendulum::{Launch, Pendulum};

/// A plane of starts. Its coordinates are those of [`super::View::center`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Plane {
    /// The quantities across and up.
    pub kind: PlaneKind,
    /// Start (θ1, θ2, ω1, ω2) in rad and rad/s, as decimal strings; it gives the two quantities
    /// that are not on an axis.
    #[serde(deserialize_with = "exactly")]
    pub origin: [String; 4],
    /// Total energy of a section in J, which is zero with both rods level and at rest.
    pub energy: f64,
}

/// The quantities on the axes of a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaneKind {
    /// Two of the angles and speeds.
    Axes([Axis; 2]),
    /// The angle θ2 and the momentum p2 where θ1 = 0 and dθ1/dt > 0, at a given energy.
    Section,
}

/// A quantity on an axis of a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// The angle θ1, rad.
    Theta1,
    /// The angle θ2, rad.
    Theta2,
    /// The angular velocity ω1, rad/s.
    Omega1,
    /// The angular velocity ω2, rad/s.
    Omega2,
    /// The momentum p2 = ∂L/∂ω2, kg m²/s.
    Momentum2,
}

/// The names of axes that can be combined.
const AXES: [(&str, Axis); 4] = [
    ("theta1", Axis::Theta1),
    ("theta2", Axis::Theta2),
    ("omega1", Axis::Omega1),
    ("omega2", Axis::Omega2),
];

impl PlaneKind {
    /// The planes with names of their own.
    pub const NAMED: [(&str, PlaneKind); 5] = [
        ("angles", PlaneKind::Axes([Axis::Theta1, Axis::Theta2])),
        ("speeds", PlaneKind::Axes([Axis::Omega1, Axis::Omega2])),
        ("first", PlaneKind::Axes([Axis::Theta1, Axis::Omega1])),
        ("second", PlaneKind::Axes([Axis::Theta2, Axis::Omega2])),
        ("section", PlaneKind::Section),
    ];
    /// The plane of both angles.
    pub(super) const ANGLES: PlaneKind = PlaneKind::NAMED[0].1;

    /// Returns all planes as alternatives.
    pub(super) fn choices() -> String {
        let [named, axes] =
            [&PlaneKind::NAMED.map(|(name, _)| name)[..], &AXES.map(|(name, _)| name)]
                .map(|names| names.join(", "));
        format!("{named}, or two of {axes} with a comma between them")
    }
}

impl Axis {
    /// The quantities of a start, in the order of an origin.
    pub const OF_STARTS: [Axis; 4] = [Axis::Theta1, Axis::Theta2, Axis::Omega1, Axis::Omega2];

    /// Returns true if values 2π apart are the same place.
    pub fn wraps(self) -> bool {
        matches!(self, Axis::Theta1 | Axis::Theta2)
    }

    /// Returns the name of the quantity in files.
    pub fn name(self) -> &'static str {
        let named = AXES.iter().find(|(_, axis)| *axis == self);
        named.map_or("momentum2", |(name, _)| *name)
    }

    /// Returns the symbol of the quantity.
    pub fn symbol(self) -> &'static str {
        match self {
            Axis::Theta1 => "θ1",
            Axis::Theta2 => "θ2",
            Axis::Omega1 => "ω1",
            Axis::Omega2 => "ω2",
            Axis::Momentum2 => "p2",
        }
    }

    /// Returns the unit of the quantity.
    pub fn unit(self) -> &'static str {
        match self {
            Axis::Theta1 | Axis::Theta2 => "rad",
            Axis::Omega1 | Axis::Omega2 => "rad/s",
            Axis::Momentum2 => "kg m²/s",
        }
    }

    /// Converts the text of a coordinate to a decimal number in the axis's unit; angles may be in
    /// degrees or in multiples of π.
    pub fn in_unit(self, text: &str) -> String {
        if self.wraps() { in_rad(text) } else { text.trim().to_string() }
    }

    /// Returns the index of the quantity among (θ1, θ2, ω1, ω2); the momentum takes the place of
    /// ω2.
    pub(super) fn place(self) -> usize {
        match self {
            Axis::Theta1 => 0,
            Axis::Theta2 => 1,
            Axis::Omega1 => 2,
            Axis::Omega2 | Axis::Momentum2 => 3,
        }
    }
}

impl Default for Plane {
    fn default() -> Self {
        let zero = || "0".to_string();
        Plane { kind: PlaneKind::ANGLES, origin: [zero(), zero(), zero(), zero()], energy: 0.0 }
    }
}

impl Plane {
    /// Error text for an energy given to a plane that has none.
    pub(super) const ENERGY_IS_FOR: &str =
        "only the plane section has an energy: omit it, or use the plane section";

    /// Error text for an origin given to a section.
    pub(super) const NO_ORIGIN: &str =
        "the plane section has no origin: omit it, or use another plane";

    /// Range of the four numbers of an origin.
    pub(super) const ORIGINS: RangeInclusive<f64> = -1e6..=1e6;
    /// Range of the energy of a section, J.
    pub const ENERGIES_J: RangeInclusive<f64> = -1e12..=1e12;

    /// The quantities across and up.
    pub fn axes(&self) -> [Axis; 2] {
        match self.kind {
            PlaneKind::Axes(axes) => axes,
            PlaneKind::Section => [Axis::Theta2, Axis::Momentum2],
        }
    }

    /// Returns true if the plane is the torus of both angles, with pendulums released from rest.
    pub fn is_at_rest(&self) -> bool {
        self.kind == PlaneKind::ANGLES
            && self.origin[2..].iter().all(|speed| Dd::parse(speed) == Some(Dd::new(0.0)))
    }

    /// Returns true if the starts at (−x, −y) and (x, y) are mirror images for all x and y.
    pub fn is_symmetric(&self) -> bool {
        let is_zero = |value: &String| Dd::parse(value) == Some(Dd::new(0.0));
        let axes = self.axes().map(Axis::place);
        let off_axis = (0..4).filter(|place| !axes.contains(place));
        self.kind != PlaneKind::Section
            && off_axis.into_iter().all(|place| is_zero(&self.origin[place]))
    }

    /// Returns true if both axes are angles, so that the plane repeats in both directions.
    pub fn is_torus(&self) -> bool {
        self.axes().into_iter().all(Axis::wraps)
    }

    /// Returns the number of doublings that enlarge the lattice, a square from −π to π, to cover
    /// the plane in the units of its axes. The number is 0 for a torus, and otherwise just enough
    /// to reach [`FASTEST`] or all momenta of a section; angles then repeat within the lattice.
    pub fn lattice_doublings(&self, build: &PendulumSpec) -> u32 {
        if self.is_torus() {
            return 0;
        }
        let most = match self.kind {
            PlaneKind::Axes(_) => FASTEST / build.unit_secs(),
            PlaneKind::Section => {
                let Pendulum { b, p, q, .. } = build.pendulum();
                (2.0 * b * (self.energy + p + q)).max(0.0).sqrt()
            }
        };
        (most / PI).log2().ceil().max(0.0) as u32
    }

    /// Checks that every number can be used for this pendulum.
    pub(crate) fn check(&self, build: &PendulumSpec) -> Result<(), SceneError> {
        let refuse = |setting, value: String, range: &'static str| {
            Err(SceneError::new(setting, value, range))
        };
        if let PlaneKind::Axes([across, up]) = self.kind
            && across == up
        {
            return refuse("plane", format!("'{}'", self.kind), "its two axes must differ");
        }
        for value in &self.origin {
            let is_fine = Dd::parse(value).is_some_and(|value| Self::ORIGINS.contains(&value.hi));
            let required = Setting::Origin.require(is_fine, &format_args!("'{value}'"));
            required.map_err(|error| error.hinting(value, 1))?;
        }
        let is_section = self.kind == PlaneKind::Section;
        let is_zero = |value: &String| Dd::parse(value) == Some(Dd::new(0.0));
        if is_section && !self.origin.iter().all(is_zero) {
            return refuse("origin", format!("'{}'", self.origin.join(",")), Self::NO_ORIGIN);
        }
        if !is_section && self.energy != 0.0 {
            return refuse("energy", format!("'{}'", self.energy), Self::ENERGY_IS_FOR);
        }
        let Pendulum { p, q, .. } = build.pendulum();
        Setting::Energy.require(Self::ENERGIES_J.contains(&self.energy), &self.energy)?;
        if is_section && self.energy < -(p + q) {
            let range = format!(
                "a section's energy must be at least that of the hanging pendulum, {} J",
                -(p + q)
            );
            return Err(SceneError::new("energy", format!("{} J", self.energy), range));
        }
        Ok(())
    }

    /// Returns the start at a position in rad, rad/s or kg m²/s, or `None` where a section has no
    /// real solution. `pendulum` is in SI units.
    pub fn launch(&self, pendulum: &Pendulum<Dd>, at: [Dd; 2]) -> Option<Launch> {
        self.numbers().launch(pendulum, at)
    }

    /// Returns the numbers of the plane.
    pub(super) fn numbers(&self) -> PlaneNumbers {
        PlaneNumbers {
            kind: self.kind,
            axes: self.axes(),
            is_at_rest: self.is_at_rest(),
            origin: [0, 1, 2, 3].map(|i| Dd::parse(&self.origin[i]).unwrap_or_default()),
            energy: Dd::new(self.energy),
        }
    }
}

/// The numbers of a plane, read from its decimal strings once for all pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneNumbers {
    kind: PlaneKind,
    /// The quantities across and up.
    pub axes: [Axis; 2],
    /// True if the plane is the torus of both angles, with pendulums released from rest.
    pub is_at_rest: bool,
    origin: [Dd; 4],
    energy: Dd,
}

impl PlaneNumbers {
    /// Returns the start at a position (see [`Plane::launch`]).
    pub(super) fn launch(&self, pendulum: &Pendulum<Dd>, at: [Dd; 2]) -> Option<Launch> {
        if self.kind == PlaneKind::Section {
            return self.on_section(pendulum, at);
        }
        let mut start = self.origin;
        for (axis, value) in self.axes.into_iter().zip(at) {
            start[axis.place()] = value;
        }
        let [theta1, theta2, omega1, omega2] = start;
        Some(Launch { angle: [theta1, theta2].map(wrapped), speed: [omega1, omega2] })
    }

    /// Returns the start where θ1 = 0 and ω1 > 0 with the section's energy.
    fn on_section(&self, pendulum: &Pendulum<Dd>, [theta2, p2]: [Dd; 2]) -> Option<Launch> {
        let speed = speeds_on_section(pendulum, self.energy, theta2, p2)?;
        Some(Launch { angle: [Dd::new(0.0), wrapped(theta2)], speed })
    }
}

/// Returns both speeds where θ1 = 0 and ω1 > 0 at an energy, if there is a real solution.
pub(super) fn speeds_on_section<T: Scalar>(
    pendulum: &Pendulum<T>,
    energy: T,
    theta2: T,
    p2: T,
) -> Option<[T; 2]> {
    let direction = theta2.sin_cos();
    let square = square_of_omega1(pendulum, energy, direction, p2);
    if square < T::zero() {
        return None;
    }
    let omega1 = square.sqrt();
    Some([omega1, omega2_beside(pendulum, omega1, direction.1, p2)])
}

/// Returns ω1² where θ1 = 0, for a direction of θ2 given as its sine and its cosine c. The
/// equations ½A ω1² + ½B ω2² + C c ω1 ω2 = K and p2 = C c ω1 + B ω2 yield ω1² = (2BK − p2²) / (AB −
/// C² c²).
pub(super) fn square_of_omega1<T: Real>(
    pendulum: &Pendulum<T>,
    energy: T,
    (sin, cos): (T, T),
    p2: T,
) -> T {
    let Pendulum { b, c, p, q, least_det, .. } = *pendulum;
    let kinetic = energy + p + q * cos;
    (b * kinetic + b * kinetic - p2 * p2) / (least_det + c * c * sin * sin)
}

/// Returns ω2 for a given ω1 where θ1 = 0; `cos` is the cosine of θ2.
pub(super) fn omega2_beside<T: Real>(pendulum: &Pendulum<T>, omega1: T, cos: T, p2: T) -> T {
    (p2 - pendulum.c * cos * omega1) / pendulum.b
}

/// Largest angular velocity that the lattice reaches, in rad per natural unit of time √(l1/g).
const FASTEST: f64 = 16.0;

/// Wraps an angle to (−π, π]; an angle that is already there is returned without rounding.
pub(super) fn wrapped(angle: Dd) -> Dd {
    if angle <= Dd::PI && angle > -Dd::PI { angle } else { angle.wrapped() }
}

impl fmt::Display for PlaneKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((name, _)) = PlaneKind::NAMED.iter().find(|(_, kind)| kind == self) {
            return f.write_str(name);
        }
        let PlaneKind::Axes(axes) = self else { return f.write_str("section") };
        let name = |axis: Axis| AXES[axis.place()].0;
        write!(f, "{},{}", name(axes[0]), name(axes[1]))
    }
}

impl FromStr for PlaneKind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some((_, kind)) = PlaneKind::NAMED.iter().find(|(name, _)| *name == text) {
            return Ok(*kind);
        }
        let axis =
            |word: &str| AXES.iter().find(|(name, _)| *name == word.trim()).map(|(_, axis)| *axis);
        let axes = text.split_once(',').and_then(|(across, up)| Some([axis(across)?, axis(up)?]));
        axes.map(PlaneKind::Axes).ok_or_else(|| {
            let meant = did_you_mean(&names_of(&PlaneKind::NAMED), text);
            format!("the planes are {}{meant}", PlaneKind::choices())
        })
    }
}

impl Serialize for PlaneKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for PlaneKind {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::State;

    #[test]
    fn planes_are_known_by_name_or_by_their_axes() {
        for (name, kind) in PlaneKind::NAMED {
            assert_eq!((name.parse(), kind.to_string().as_str()), (Ok(kind), name));
        }
        let mixed = PlaneKind::Axes([Axis::Theta1, Axis::Omega2]);
        assert_eq!(
            (" theta1 ,omega2".parse(), mixed.to_string().as_str()),
            (Ok(mixed), "theta1,omega2")
        );
        assert!("sideways".parse::<PlaneKind>().unwrap_err().contains("section"));
    }

    #[test]
    fn a_section_has_its_energy_and_no_start_beyond_it() {
        let build = PendulumSpec::default();
        let pendulum = build.pendulum_in::<Dd>();
        for energy in [-5.0, 0.0, 12.5] {
            let plane = Plane { kind: PlaneKind::Section, energy, ..Plane::default() };
            let Launch { angle, speed } =
                plane.launch(&pendulum, [Dd::new(0.7), Dd::new(-0.9)]).unwrap();
            let near = |pair: [Dd; 2]| pair.map(|x| x.hi);
            let state = State { angle: near(angle), speed: near(speed) };
            assert!((pendulum.to_f64().energy(&state) - energy).abs() < 1e-12);
            assert!(speed[0].hi > 0.0 && angle[0].hi == 0.0);
            let phase = pendulum.to_f64().phase(&state);
            assert!((phase[5] + 0.9).abs() < 1e-13, "p2 is the coordinate");
            assert!(plane.launch(&pendulum, [Dd::new(0.7), Dd::new(99.0)]).is_none());
        }
    }

    #[test]
    fn the_lattice_reaches_every_start_worth_showing() {
        let build = PendulumSpec::default();
        let reach = |kind, energy| {
            let plane = Plane { kind, energy, ..Plane::default() };
            PI * f64::from(1 << plane.lattice_doublings(&build))
        };
        assert_eq!(reach(PlaneKind::ANGLES, 0.0), PI);
        let fastest = reach(PlaneKind::NAMED[1].1, 0.0);
        assert!((50.0..101.0).contains(&fastest), "{fastest} rad/s");
        // p2² ≤ 2 B (E + P + Q), with B = 1 kg m² and P + Q = 29.43 J.
        let momentum = reach(PlaneKind::Section, 30.0);
        assert!((10.9..21.9).contains(&momentum), "{momentum} kg m²/s");
    }

    #[test]
    fn bad_planes_are_refused_by_name() {
        let refused = |change: fn(&mut Plane)| {
            let mut plane = Plane::default();
            change(&mut plane);
            plane.check(&PendulumSpec::default()).unwrap_err().to_string()
        };
        Plane::default().check(&PendulumSpec::default()).unwrap();
        let twice = refused(|plane| plane.kind = PlaneKind::Axes([Axis::Omega1; 2]));
        assert!(twice.contains("`plane` is 'omega1,omega1'; its two axes"), "{twice}");
        let far = refused(|plane| plane.origin[2] = "1e9".into());
        assert!(far.contains("`origin` is '1e9'"), "{far}");
        let low = refused(|plane| {
            (plane.kind, plane.energy) = (PlaneKind::Section, -30.0);
        });
        assert!(low.contains("`energy` is -30 J"), "{low}");
        let origin = refused(|plane| {
            (plane.kind, plane.origin[3]) = (PlaneKind::Section, "1".into());
        });
        assert!(origin.contains("`origin` is '0,0,0,1'; the plane section has no"), "{origin}");
        let none = refused(|plane| plane.energy = 5.0);
        assert!(none.contains("`energy` is '5'; only the plane section"), "{none}");
    }
}
