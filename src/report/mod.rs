//! What this machine's engines are worth: speed against error, measured.
//!
//! A [`Session`] works through a list of tasks ([`plan`]) on the same [`Ground`]: the open
//! starts of the home map and the gold standard's answers to some of them. After each task the
//! [`Report`] is complete in itself and says what is still missing; [`pages`] lays it out for
//! people, [`Folder`] writes it.

pub mod backend;
pub mod baseline;
mod beyond;
mod chapters;
mod depth;
mod depth_pages;
mod exact;
#[cfg(test)]
mod fixtures;
mod folder;
pub mod hard;
mod html;
pub mod hunt;
mod levels;
mod machine;
mod markdown;
mod measure;
pub mod motion;
pub mod pages;
pub mod plan;
mod plot;
mod session;
pub mod statistics;
pub mod stopwatch;
mod targets;
mod test_set;
pub mod truth;
mod windows;

use serde::Serialize;

use crate::engine::choice::ChoiceError;
use crate::engine::{EngineError, IntegratorConfig};

pub use backend::{Backend, BackendFilter};
pub use beyond::{Flips, LateRow, WindowRow};
pub use depth::DepthRow;
pub use exact::Checks;
pub use folder::Folder;
pub use hard::HardRow;
pub use machine::Machine;
pub use motion::MotionError;
pub use pages::{Block, Section, Table};
pub use plan::Thoroughness;
pub use session::Session;
pub use statistics::{Band, Errors};
pub use targets::Target;
pub use test_set::TestSet;

/// Asked again and again: whether to stop.
pub type StopTest<'a> = &'a (dyn Fn() -> bool + Sync);

/// Why there is no more of a report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// As was asked for.
    #[error("stopped")]
    Stopped,
    /// No engine fits what was asked for.
    #[error(transparent)]
    Choice(#[from] ChoiceError),
    /// An engine failed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// A file could not be written.
    #[error("cannot write {path}: {why}")]
    Write {
        /// Which.
        path: String,
        /// Why.
        why: std::io::Error,
    },
    /// A plot could not be drawn, or a table not be written as JSON.
    #[error("cannot lay out the report: {0}")]
    Layout(String),
}

/// Everything measured so far.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// What it was measured on.
    pub machine: Machine,
    /// With fewer settings and starts.
    pub quick: bool,
    /// Starts compared with the gold standard, at most.
    pub sample: usize,
    /// Whether nothing is missing.
    pub complete: bool,
    /// Measurements that were planned and not made.
    pub missing: Vec<String>,
    /// Engine by engine, config by config.
    pub rows: Vec<Row>,
    /// What the engines do not offer.
    pub not_offered: Vec<Refusal>,
    /// What kernels made for their scene gain.
    pub specialising: Vec<Specialising>,
    /// Errors in angle and energy.
    pub motion: Vec<MotionError>,
    /// What was hoped for, and what came of it.
    pub targets: Vec<Target>,
    /// The accuracy `exact`, engine by engine.
    pub exact: Vec<Row>,
    /// Windows beyond the home map.
    pub windows: Vec<WindowRow>,
    /// `exact` beside double-double, where flips come late.
    pub late: Vec<LateRow>,
    /// Deep zoom, place by place.
    pub depth: Vec<DepthRow>,
    /// The hard cases.
    pub hard: Vec<HardRow>,
}

/// An engine with a config.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// `cpu` or `gpu`.
    pub engine: String,
    /// Its full name.
    pub adapter: String,
    /// Threads of the processor, where it is the processor that computes.
    pub threads: Option<usize>,
    /// How it was integrated.
    #[serde(flatten, serialize_with = "as_words")]
    pub config: IntegratorConfig,
    /// Starts in each timed round.
    pub starts: usize,
    /// Timed rounds.
    pub rounds: usize,
    /// Microseconds for each integrated pixel: the median of the rounds.
    pub us_per_pixel: f64,
    /// Of the fastest round.
    pub us_least: f64,
    /// Of the slowest round.
    pub us_most: f64,
    /// From the fastest to the slowest round, as a share of the median.
    pub spread: f64,
    /// What the scalar loop took between the rounds.
    pub scalar_us_per_pixel: f64,
    /// How many times faster than the scalar loop.
    pub times_scalar: f64,
    /// Against the gold standard.
    #[serde(flatten)]
    pub errors: Errors,
    /// Right-hand sides; an expansion to order N counts as N.
    pub rhs_per_pixel: f64,
    /// Steps tried.
    pub steps_per_pixel: f64,
    /// Share of the lanes' steps that were of use.
    pub lane_use: f64,
    /// The errors by true flip time.
    pub bands: Vec<Band>,
    /// What came of checking every pixel, if that was done.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub checks: Option<Checks>,
}

impl Row {
    /// A row in which nothing was measured yet.
    pub fn new(backend: &Backend, config: IntegratorConfig) -> Self {
        Row::named(backend.name(), &backend.adapter(), backend.threads(), config)
    }

    fn named(
        engine: &str,
        adapter: &str,
        threads: Option<usize>,
        config: IntegratorConfig,
    ) -> Self {
        Row {
            engine: engine.to_string(),
            adapter: adapter.to_string(),
            threads,
            config,
            starts: 0,
            rounds: 0,
            us_per_pixel: f64::NAN,
            us_least: f64::NAN,
            us_most: f64::NAN,
            spread: f64::NAN,
            scalar_us_per_pixel: f64::NAN,
            times_scalar: f64::NAN,
            errors: Errors::default(),
            rhs_per_pixel: f64::NAN,
            steps_per_pixel: f64::NAN,
            lane_use: f64::NAN,
            bands: Vec::new(),
            checks: None,
        }
    }

    /// The engine's full name.
    pub fn full_name(&self) -> String {
        format!("{}: {}", self.engine, self.adapter)
    }

    /// `cpu`, or `gpu` with the adapter's name.
    pub fn short_name(&self) -> String {
        backend::short_name(&self.engine, &self.adapter)
    }
}

/// Something that an engine does not do.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Refusal {
    /// Its name.
    pub engine: String,
    /// What it was asked for.
    pub what: String,
    /// What it answered.
    pub reason: String,
}

/// A kernel made for its scene beside the general one.
#[derive(Clone, Debug, Serialize)]
pub struct Specialising {
    /// On which adapter.
    pub adapter: String,
    /// How it was integrated.
    #[serde(flatten, serialize_with = "as_words")]
    pub config: IntegratorConfig,
    /// Median microseconds of the general kernel.
    pub general_us_per_pixel: f64,
    /// Median microseconds of the other.
    pub specialised_us_per_pixel: f64,
    /// How many times faster it is, the median of the rounds.
    pub ratio: f64,
}

/// A config as the three texts by which files know it.
fn as_words<S: serde::Serializer>(
    config: &IntegratorConfig,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Words {
        method: &'static str,
        precision: String,
        setting: String,
    }
    let IntegratorConfig { method, precision } = config;
    let (precision, setting) = (precision.to_string(), method.setting());
    Words { method: method.name(), precision, setting }.serialize(serializer)
}
