//! What is to be measured.

use std::ops::RangeInclusive;

use flipmap_engine::EngineError;
use flipmap_estimate::EstimateError;
use flipmap_scene::question::QuestionName;
use flipmap_scene::{Scene, SceneError, between, named};
use serde::{Deserialize, Serialize};

use crate::basins::has_basins;
use crate::sampling::{Stage, growing};

/// Something that can be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Statistic {
    /// The shares of the classes, and of flips by time.
    Areas,
    /// The share that has not flipped yet, against time, and the law of its tail.
    Survival,
    /// The uncertainty exponent of the edges.
    Edges,
    /// The box-counting dimension of the edges.
    Boxes,
    /// The basin entropy.
    Entropy,
    /// Whether three basins share one boundary.
    Wada,
    /// The distribution of exponents of growth.
    Growth,
    /// The exponent of a fat fractal.
    Fat,
}

impl Statistic {
    /// Every statistic with its name, in order.
    pub const ALL: [(&'static str, Statistic); 8] = [
        ("areas", Statistic::Areas),
        ("survival", Statistic::Survival),
        ("edges", Statistic::Edges),
        ("boxes", Statistic::Boxes),
        ("entropy", Statistic::Entropy),
        ("wada", Statistic::Wada),
        ("growth", Statistic::Growth),
        ("fat", Statistic::Fat),
    ];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        Statistic::ALL.iter().find(|(_, one)| *one == self).map_or("", |(name, _)| name)
    }

    /// Returns the statistics with these names, in order and each once, or a phrase that lists the
    /// names and says which one was not among them.
    pub fn named<S: AsRef<str>>(names: &[S]) -> Result<Vec<Self>, (&str, String)> {
        let one = |name: &S| named("statistics", &Statistic::ALL, name.as_ref());
        let mut all = Vec::new();
        for name in names {
            all.push(one(name).map_err(|why| (name.as_ref(), why))?);
        }
        all.sort_unstable();
        all.dedup();
        Ok(all)
    }

    /// Returns true if answers are sorted into classes for it.
    pub(crate) fn needs_basins(self) -> bool {
        match self {
            Statistic::Areas
            | Statistic::Survival
            | Statistic::Edges
            | Statistic::Boxes
            | Statistic::Entropy
            | Statistic::Wada
            | Statistic::Fat => true,
            Statistic::Growth => false,
        }
    }

    /// Returns true if a stage of sampling serves it.
    pub(crate) fn needs(self, stage: Stage) -> bool {
        match self {
            Statistic::Areas | Statistic::Survival => matches!(stage, Stage::Starts(_)),
            Statistic::Edges => matches!(stage, Stage::PairsApart(_)),
            Statistic::Boxes | Statistic::Wada => stage == Stage::Picture,
            Statistic::Entropy | Statistic::Fat => matches!(stage, Stage::BoxesOf(_)),
            Statistic::Growth => matches!(stage, Stage::Exponents(_) | Stage::SectionAt(_)),
        }
    }
}

/// What is to be measured, of which scene, from how many samples.
#[derive(Clone, Debug, PartialEq)]
pub struct SurveyOrder {
    /// The scene, checked.
    pub scene: Scene,
    /// What is to be measured.
    pub of: Vec<Statistic>,
    /// Number of starts for areas; the other statistics take their share of it.
    pub samples: u32,
    /// Seed of all random numbers.
    pub seed: u64,
    /// If given, a pair of starts also differs if its flips are farther apart than this, s.
    pub apart_secs: Option<f64>,
}

/// Errors of a survey.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    /// An engine failed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// A setting cannot be used.
    #[error("{0}")]
    Setting(#[from] SceneError),
    /// Nothing that was ordered could be estimated.
    #[error("{what}: {why}")]
    Estimate {
        /// Name of the statistic.
        what: &'static str,
        /// The reason.
        why: EstimateError,
    },
    /// The survey was stopped.
    #[error("stopped")]
    Stopped,
    /// A file could not be read or written.
    #[error("cannot write {path}: {why}")]
    Write {
        /// Path of the file.
        path: String,
        /// The reason.
        why: std::io::Error,
    },
    /// A plot or a page could not be drawn.
    #[error("cannot draw the page: {0}")]
    Page(String),
}

impl SurveyOrder {
    /// Range of the number of samples.
    pub const SAMPLES: RangeInclusive<u32> = 1600..=1_048_576;
    /// Range of the time that sets two flips apart, s.
    pub const APART_SECS: RangeInclusive<f64> = 1e-3..=1e6;
    /// Smallest width of a view that is measured, in the units of its plane: in narrower ones, flips come
    /// so late that double-double leaves many answers unsure.
    pub const LEAST_WIDTH: f64 = 1e-12;

    /// The order of everything that can be measured of a checked scene.
    pub fn of(scene: Scene) -> Self {
        let is_possible = |statistic: &Statistic| match statistic {
            Statistic::Wada => scene.question.ask == QuestionName::First,
            Statistic::Growth => can_grow(&scene).is_ok(),
            other => !other.needs_basins() || has_basins(scene.question.ask),
        };
        let of = Statistic::ALL.iter().map(|(_, one)| *one).filter(is_possible).collect();
        SurveyOrder { scene, of, samples: 200_000, seed: 1, apart_secs: None }
    }

    /// Seed of the places of a stage. Each seed has numbers of its own for all stages, so that surveys with
    /// neighbouring seeds share no places.
    pub(crate) fn seed_of(&self, stage: u64) -> u64 {
        self.seed.wrapping_sub(1).wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(1 + stage)
    }

    /// Refuses what cannot be measured.
    pub(crate) fn check(&self) -> Result<(), SceneError> {
        let ask = self.scene.question.ask;
        if let Some(one) = self.of.iter().find(|one| one.needs_basins() && !has_basins(ask)) {
            let why = format!(
                "{} needs a question with classes: flip or first; of others only growth can be measured",
                one.name()
            );
            return Err(SceneError::new("ask", ask.to_string(), why));
        }
        if self.of.contains(&Statistic::Wada) && ask != QuestionName::First {
            let why = "wada needs three classes, which only the question first has";
            return Err(SceneError::new("ask", ask.to_string(), why));
        }
        let width = self.scene.view.width_rad().hi;
        if width < Self::LEAST_WIDTH {
            let why = format!("it must be at least {:e} to be measured", Self::LEAST_WIDTH);
            return Err(SceneError::new("width", self.scene.view.width.clone(), why));
        }
        if let Some(secs) = self.apart_secs.filter(|secs| !Self::APART_SECS.contains(secs)) {
            let allowed = format!("it must lie {} s", between(&Self::APART_SECS));
            return Err(SceneError::new("apart", secs.to_string(), allowed));
        }
        if self.of.contains(&Statistic::Growth) {
            can_grow(&self.scene)?;
        }
        Ok(())
    }
}

/// Smallest budget for exponents of growth, in the pendulum's natural unit of time.
const LEAST_GROWTH_UNITS: f64 = 10.0;

/// Refuses scenes in which exponents of growth tell nothing.
fn can_grow(scene: &Scene) -> Result<(), SceneError> {
    let scene = growing(scene).checked()?;
    let (secs, least) = (scene.question.budget.secs, LEAST_GROWTH_UNITS * scene.build.unit_secs());
    if secs < least {
        let allowed = format!("for growth to be measured it must be at least {least:.2} s");
        return Err(SceneError::new("budget", secs.to_string(), allowed));
    }
    Ok(())
}
