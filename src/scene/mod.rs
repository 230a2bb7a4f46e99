//! What a picture shows, as plain data: never how it is computed.
//!
//! A [`Scene`] is a pendulum, a question and a view. Two scenes are the same work exactly when
//! their pendulums and questions are equal; the view only says which starts are asked for.
//! [`Document`] is a scene as people keep it: a TOML file, or the text inside a PNG.

mod budget;
mod built_in;
mod document;
pub mod film;
mod grid;
pub mod keys;
pub mod lattice;
pub mod location;
pub mod palette;
mod picture;
mod spots;
mod view;
mod words;

pub use budget::Budget;
pub use built_in::{BUILT_IN, BuiltIn};
pub use document::{Document, DocumentError, RunTable};
pub use grid::{Fate, Grid};
pub use picture::{PictureTable, Scale};
pub use spots::Grouped;
pub use view::{LEAST_WIDTH, View};
pub use words::Word;

use serde::{Deserialize, Serialize};

use crate::physics::{Pendulum, Rule};

/// How a pendulum is built.
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
    /// Every kind with its word.
    pub const ALL: [(&'static str, Kind); 2] = [("points", Kind::Points), ("rods", Kind::Rods)];
}

/// A pendulum as people build it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Build {
    /// Bobs or bars.
    pub kind: Kind,
    /// m1, m2 in kg.
    pub masses: [f64; 2],
    /// l1, l2 in m.
    pub lengths: [f64; 2],
    /// g in m/s².
    pub gravity: f64,
}

impl Default for Build {
    fn default() -> Self {
        Build { kind: Kind::Points, masses: [1.0, 1.0], lengths: [1.0, 1.0], gravity: 9.81 }
    }
}

impl Build {
    /// The five numbers.
    pub fn pendulum(&self) -> Pendulum<f64> {
        match self.kind {
            Kind::Points => Pendulum::points(self.masses, self.lengths, self.gravity),
            Kind::Rods => Pendulum::rods(self.masses, self.lengths, self.gravity),
        }
    }

    /// The pendulum's natural unit of time; without gravity, when nothing moves, 1 s.
    pub fn unit_secs(&self) -> f64 {
        let pendulum = self.pendulum();
        if pendulum.q > 0.0 { pendulum.reduced().1 } else { 1.0 }
    }
}

/// What is asked about every start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Question {
    /// Which bob is watched.
    pub rule: Rule,
    /// Simulated seconds a pixel may use.
    pub budget: Budget,
}

impl Default for Question {
    fn default() -> Self {
        Question { rule: Rule::Second, budget: Budget::default() }
    }
}

/// What to compute, never how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// The pendulum.
    pub build: Build,
    /// What is asked about it.
    pub question: Question,
    /// From where to where.
    pub view: View,
}

/// A number of a scene that cannot be used, with the range that can.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{option} is {value}; {range}")]
pub struct SceneError {
    /// The option or key.
    pub option: &'static str,
    /// What was given.
    pub value: String,
    /// What is allowed, as a phrase.
    pub range: &'static str,
}

impl Scene {
    /// Checks every number, so that nothing after this needs to.
    pub fn checked(mut self) -> Result<Self, SceneError> {
        const WIDE: std::ops::RangeInclusive<f64> = 1e-9..=1e9;
        let refuse = |option, value: f64, range| {
            Err(SceneError { option, value: format!("{value:?}"), range })
        };
        let Build { masses, lengths, gravity, .. } = self.build;
        if let Some(mass) = masses.into_iter().find(|m| !WIDE.contains(m)) {
            return refuse("--masses", mass, "each mass must lie between 1e-9 and 1e9 kg");
        }
        if let Some(length) = lengths.into_iter().find(|l| !WIDE.contains(l)) {
            return refuse("--lengths", length, "each length must lie between 1e-9 and 1e9 m");
        }
        if !(gravity == 0.0 || WIDE.contains(&gravity)) {
            return refuse("--gravity", gravity, "it must be 0 or lie between 1e-9 and 1e9 m/s²");
        }
        self.view.check()?;
        self.question.budget = self.question.budget.for_view(&self.build, &self.view);
        let budget = self.question.budget.secs;
        if !(1e-9..=1e6).contains(&budget) {
            return refuse("--budget", budget, "it must lie between 1e-9 and 1e6 s, or be auto");
        }
        Ok(self)
    }
}
