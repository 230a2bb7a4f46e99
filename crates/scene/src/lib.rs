//! Plain data describing what a picture shows, independent of how it is computed.
//!
//! A [`Scene`] combines a pendulum ([`PendulumSpec`]), a question ([`QuestionSettings`]; see
//! [`question`]), a [`Plane`] of starts and a [`View`] of that plane. The pendulum and the question
//! define the work for one start; the plane and the view select the starts, and a [`Grid`] finds
//! the start of each pixel. A [`Document`] stores a scene as a TOML file or as text inside a PNG,
//! and a [`Setting`] names one value of a scene. [`palette`] has the colours, [`keys`] the films
//! and [`lattice`] the recursive division of the plane into cells, which are the window's tiles.
//!
//! ```
//! use flipmap_scene::Document;
//!
//! let document = Document::parse("[pendulum]\nmasses = [1.0, 2.0]\n[view]\nwidth = \"0.5\"")?;
//! assert_eq!(document.scene().view.width, "0.5");
//! # Ok::<(), flipmap_scene::DocumentError>(())
//! ```
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

mod allowed;
mod angle_text;
mod budget;
mod built_in;
mod document;
mod exact_length;
mod exact_plane;
pub mod film;
pub mod film_length;
mod grid;
pub mod keys;
pub mod lattice;
mod leaf_grid;
pub mod location;
mod number_in_file;
pub mod palette;
mod pasted;
mod picture;
mod pixel_axes;
mod plane;
pub mod question;
mod question_table;
mod scene_error;
mod settings;
mod turn;
mod upright;
mod view;
mod words;

pub use allowed::{between, did_you_mean, in_a_row, named, not_among};
pub use angle_text::in_rad;
pub use budget::Budget;
pub use built_in::{BUILT_IN, BuiltIn};
pub use document::{Document, DocumentError, RunTable, one_line};
pub use exact_plane::ExactPlane;
pub use grid::{Fate, Grid};
pub use leaf_grid::Grouped;
pub use pasted::{decimal_hint, number, number_within, plain_numbers};
pub use picture::{PictureTable, Sampling, Scale, Shown};
pub use pixel_axes::PixelAxes;
pub use plane::{Axis, Plane, PlaneKind};
pub use question_table::QuestionSettings;
pub use scene_error::SceneError;
pub use settings::{Setting, SettingDef};
pub use turn::Turn;
pub use upright::SeparableGrid;
pub use view::{MIN_WIDTH, View};

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use self::exact_length::exactly;
use crate::question::QuestionName;
use flipmap_numbers::{Dd, Decimal, Scalar};
use flipmap_pendulum::{Pendulum, Rule};

/// Kind of pendulum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Bobs on massless rods.
    #[default]
    Points,
    /// Uniform bars.
    Rods,
}

impl Kind {
    /// Every kind with its name.
    pub(crate) const ALL: [(&'static str, Kind); 2] =
        [("points", Kind::Points), ("rods", Kind::Rods)];
}

/// A pendulum described by its kind, masses, lengths, gravity and friction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PendulumSpec {
    /// Bobs or bars.
    pub kind: Kind,
    /// Masses m1, m2 in kg.
    #[serde(deserialize_with = "exactly")]
    pub masses: [Decimal; 2],
    /// Lengths l1, l2 in m.
    #[serde(deserialize_with = "exactly")]
    pub lengths: [Decimal; 2],
    /// Gravity g in m/s².
    pub gravity: Decimal,
    /// Friction b1, b2 at the two pivots in N m s.
    #[serde(skip_serializing_if = "is_frictionless", deserialize_with = "exactly")]
    pub friction: [Decimal; 2],
}

fn is_frictionless(friction: &[Decimal; 2]) -> bool {
    friction.iter().all(|b| b.value() == 0.0)
}

impl Default for PendulumSpec {
    fn default() -> Self {
        PendulumSpec::new(Kind::Points, [1.0; 2], [1.0; 2], 9.81)
    }
}

impl PendulumSpec {
    /// Range of a mass in kg.
    pub const MASSES_KG: RangeInclusive<f64> = 1e-9..=1e9;
    /// Range of a length in m.
    pub const LENGTHS_M: RangeInclusive<f64> = 1e-9..=1e9;
    /// Range of gravity in m/s²; it can also be 0.
    pub const GRAVITIES: RangeInclusive<f64> = 1e-9..=1e9;
    /// Range of the friction at a pivot in N m s.
    pub const FRICTIONS: RangeInclusive<f64> = 0.0..=1e9;

    /// Checks every number.
    fn check(&self) -> Result<(), SceneError> {
        let pairs = [
            (Setting::Masses, self.masses, Self::MASSES_KG),
            (Setting::Lengths, self.lengths, Self::LENGTHS_M),
            (Setting::Friction, self.friction, Self::FRICTIONS),
        ];
        for (setting, pair, range) in pairs {
            let is_fine = pair.iter().all(|number| range.contains(&number.value()));
            setting.require(is_fine, &format_args!("{},{}", pair[0], pair[1]))?;
        }
        let gravity = self.gravity.value();
        let is_fine = gravity == 0.0 || Self::GRAVITIES.contains(&gravity);
        Setting::Gravity.require(is_fine, &self.gravity)
    }

    /// Returns a frictionless pendulum with masses in kg, lengths in m and gravity in m/s².
    pub fn new(kind: Kind, masses: [f64; 2], lengths: [f64; 2], gravity: f64) -> Self {
        let [masses, lengths] = [masses, lengths].map(|pair| pair.map(Decimal::from));
        let friction = [0.0.into(); 2];
        PendulumSpec { kind, masses, lengths, gravity: gravity.into(), friction }
    }

    /// Returns the masses m1, m2 in kg, rounded to f64.
    pub fn masses_kg(&self) -> [f64; 2] {
        self.masses.map(|mass| mass.value())
    }

    /// Returns the lengths l1, l2 in m, rounded to f64.
    pub fn lengths_m(&self) -> [f64; 2] {
        self.lengths.map(|length| length.value())
    }

    /// Returns the pendulum's five numbers (A, B, C, P, Q), rounded to f64.
    pub fn pendulum(&self) -> Pendulum<f64> {
        self.pendulum_in::<Dd>().to_f64()
    }

    /// Returns the pendulum's five numbers, computed in `T` from the given decimals.
    pub fn pendulum_in<T: Scalar>(&self) -> Pendulum<T> {
        let [masses, lengths] =
            [self.masses, self.lengths].map(|pair| pair.map(|x| T::from_theta(x.exact())));
        let gravity = T::from_theta(self.gravity.exact());
        let pendulum = match self.kind {
            Kind::Points => Pendulum::points(masses, lengths, gravity),
            Kind::Rods => Pendulum::rods(masses, lengths, gravity),
        };
        let friction = self.friction.map(|b| T::from_theta(b.exact()));
        Pendulum { friction: self.has_friction().then_some(friction), ..pendulum }
    }

    /// Returns true if either pivot has friction.
    pub fn has_friction(&self) -> bool {
        !is_frictionless(&self.friction)
    }

    /// Returns the five numbers in reduced units (C = Q = 1) and the unit of time √(C/Q) in s. They
    /// are formed from ratios so that no product leaves the range of a fixed-point number.
    pub fn reduced_in<T: Scalar>(&self) -> (Pendulum<T>, T) {
        let of = |decimal: Decimal| T::from_theta(decimal.exact());
        let [[m1, m2], [l1, l2]] = [self.masses, self.lengths].map(|pair| pair.map(of));
        let (mass, length) = (m1 / m2, l1 / l2);
        let [one, two, three] = [1.0, 2.0, 3.0].map(T::from_f64);
        let (a, b, p, least_det) = match self.kind {
            Kind::Points => ((mass + one) * length, l2 / l1, (mass + one) * length, mass),
            Kind::Rods => (
                two * (mass / three + one) * length,
                two * l2 / (three * l1),
                (mass + two) * length,
                (T::from_f64(4.0) * mass + three) / T::from_f64(9.0),
            ),
        };
        let unit_secs = (l1 / of(self.gravity)).sqrt();
        // Friction is in units of √(CQ) = Q √(l1/g), because C = Q l1/g.
        let force = match self.kind {
            Kind::Points => m2 * l2 * of(self.gravity),
            Kind::Rods => m2 * l2 * of(self.gravity) / two,
        };
        let friction = self.friction.map(|b| of(b) / (force * unit_secs));
        let friction = self.has_friction().then_some(friction);
        (Pendulum { a, b, c: one, p, q: one, least_det, friction, lengths: [l1, l2] }, unit_secs)
    }

    /// Returns the pendulum's natural unit of time in s, or 1 s without gravity, when nothing
    /// moves.
    pub fn unit_secs(&self) -> f64 {
        if self.gravity.value() > 0.0 { self.reduced_in::<Dd>().1.to_f64() } else { 1.0 }
    }
}

/// A description of what to compute, independent of how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// The pendulum.
    pub build: PendulumSpec,
    /// The question asked about every start.
    pub question: QuestionSettings,
    /// The part of the plane that is shown.
    pub view: View,
    /// The plane of starts that contains the view.
    pub plane: Plane,
}

impl Scene {
    /// Checks every number, so that no later code needs to, and guesses an automatic budget;
    /// [`Scene::settled`] computes it.
    pub fn checked(mut self) -> Result<Self, SceneError> {
        self.build.check()?;
        self.view.check(self.plane.axes())?;
        self.question.budget = self.question.budget.guessed(&self.build, &self.view);
        let budget = self.question.budget.secs;
        Setting::Budget.require(Budget::SECS.contains(&budget), &format!("{budget:?}"))?;
        self.question.check()?;
        self.plane.check(&self.build)?;
        if self.build.gravity == 0.0 && !self.is_flip_from_rest() {
            let allowed = format!(
                "for this question and plane it must lie {} m/s²; without gravity only flips from \
                 rest are answered",
                between(&PendulumSpec::GRAVITIES)
            );
            let value = self.build.gravity.to_string();
            return Err(SceneError::new(Setting::Gravity.name(), value, allowed));
        }
        Ok(self)
    }

    /// Resets values that the question or the plane does not use; call it after changing either.
    #[must_use]
    pub fn without_unused(mut self) -> Self {
        let (kind, question) = (self.question.ask.kind(), &mut self.question);
        if !question.has_rule() {
            question.rule = Rule::default();
        }
        if !kind.has_count {
            question.count = 1;
        }
        if !kind.at_a_time {
            question.at = None;
        }
        let section = self.plane.kind == PlaneKind::Section;
        let Plane { origin, energy, .. } = Plane::default();
        if section {
            self.plane.origin = origin;
        } else {
            self.plane.energy = energy;
        }
        self
    }

    /// Returns true if the scene asks for first flips of pendulums released from rest. Every part
    /// of the program supports this question and plane.
    pub fn is_flip_from_rest(&self) -> bool {
        self.question.ask == QuestionName::Flip
            && self.question.count == 1
            && self.plane.is_at_rest()
    }

    /// Returns true if following cells of starts by polynomials can answer the question.
    pub fn has_cells(&self) -> bool {
        self.question.follows_cells()
    }

    /// Refuses a scene that asks for anything but first flips of pendulums released from rest.
    pub fn require_flip_from_rest(&self) -> Result<(), SceneError> {
        let Scene { question, plane, .. } = self;
        let range = "here only flips of pendulums released from rest are possible; flipmap render \
                     takes every question and plane";
        if question.ask != QuestionName::Flip {
            let value = question.ask.to_string();
            return Err(SceneError::new("ask", value, range));
        }
        if question.count > 1 {
            let value = question.count.to_string();
            return Err(SceneError::new("count", value, range));
        }
        if !plane.is_at_rest() {
            let value = plane.kind.to_string();
            return Err(SceneError::new("plane", value, range));
        }
        Ok(())
    }

    /// Returns true if pixels opposite each other across the view's centre have equal answers.
    pub fn is_symmetric(&self) -> bool {
        let wraps = self.plane.axes().map(Axis::wraps);
        self.view.is_symmetric(wraps)
            && self.plane.is_symmetric()
            && self.question.ask.kind().is_even
    }

    /// Computes the automatic budget of a checked scene whose pendulums start at rest, which takes
    /// seconds at great depths ([`Budget::for_view`]).
    #[must_use]
    pub fn settled(mut self) -> Self {
        if self.plane.is_at_rest() {
            self.question.budget = self.question.budget.for_view(&self.build, &self.view);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_numbers::Exact;

    #[test]
    fn the_five_numbers_are_right_to_the_last_digit_of_every_type() {
        fn error<T: Scalar>(kind: Kind) -> f64 {
            let build = PendulumSpec::new(kind, [0.1, 0.7], [1.0, 0.6], 1.62);
            let (reduced, unit) = build.reduced_in::<T>();
            let plain = build.pendulum_in::<T>();
            let (same, unit_too) = plain.reduced();
            let off = |a: T, b: T| ((a - b) / b).to_f64().abs();
            let least = |x: &Pendulum<T>| off(x.least_det, x.a * x.b - x.c * x.c);
            let pairs = [(reduced.a, same.a), (reduced.b, same.b), (reduced.p, same.p)];
            let numbers = pairs.map(|(a, b)| off(a, b)).into_iter().fold(0.0, f64::max);
            numbers.max(least(&reduced)).max(least(&plain)).max(off(unit, unit_too))
        }
        for (_, kind) in Kind::ALL {
            assert!(error::<f64>(kind) < 4e-15, "{kind:?}");
            assert!(error::<Dd>(kind) < 1e-30, "{kind:?} {:e}", error::<Dd>(kind));
            assert!(error::<Exact>(kind) < 1e-131, "{kind:?} {:e}", error::<Exact>(kind));
        }
    }

    #[test]
    fn a_pendulum_is_built_from_decimals_and_not_from_floats() {
        let build = PendulumSpec::new(Kind::Points, [1.0, 1.0], [1.0, 0.6], 9.81);
        let tenths = build.pendulum_in::<Dd>().q * Dd::new(1000.0);
        assert!((tenths - Dd::new(5886.0)).abs().hi < 1e-27, "{tenths}");
    }
}
