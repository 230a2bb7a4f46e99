//! Reports on this machine's engines: speed against error, measured.
//!
//! A [`Session`] works through a list of tasks ([`plan`]) on the same [`TestSet`]: the open starts
//! of the home map and the gold standard's answers to some of them. After each task the [`Report`]
//! is complete in itself and lists what is still missing; [`Folder`] writes it, as JSON and as a
//! page for readers.
//!
//! The hard cases stand in [`hard`], each with what makes it hard:
//!
//! ```
//! for case in flipmap_report::hard::cases() {
//!     println!("{}: {}", case.name, case.why);
//! }
//! ```
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

mod backend;
pub mod baseline;
mod beyond;
mod claims;
mod depth;
mod exact;
mod films;
#[cfg(test)]
mod fixtures;
mod folder;
pub mod hard;
pub mod hunt;
mod levels;
mod machine;
mod measure;
mod measurement;
pub mod motion;
mod page;
pub mod plan;
mod question_truth;
mod questions;
mod session;
pub mod statistics;
pub mod stopwatch;
mod test_set;
pub mod truth;
mod verdict;
mod windows;

use serde::Serialize;

use flipmap_engine::choice::ChoiceError;
use flipmap_engine::{EngineError, EngineKind, IntegratorConfig};

pub use backend::{Backend, BackendFilter};
pub use beyond::{Flips, LateRow, WindowRow};
pub use claims::Claim;
pub use depth::DepthRow;
pub use exact::Checks;
pub use films::{LongFilm, PaintingRow, ZoomRow};
pub use folder::Folder;
pub use hard::HardRow;
pub use machine::Machine;
pub use measurement::Chapter;
pub use motion::MotionError;
pub use plan::Thoroughness;
pub use questions::QuestionRow;
pub use session::Session;
pub use statistics::{Band, Errors};
pub use test_set::TestSet;

/// Stop test, polled throughout the work: returns true to stop it.
pub type StopTest<'a> = &'a (dyn Fn() -> bool + Sync);

/// The reason a report ended early.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// Stopped on request.
    #[error("stopped")]
    Stopped,
    /// No engine fits the request.
    #[error(transparent)]
    Choice(#[from] ChoiceError),
    /// An engine failed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// A file could not be written.
    #[error("cannot write {path}: {why}")]
    Write {
        /// Path of the file.
        path: String,
        /// The I/O error.
        why: std::io::Error,
    },
    /// A film that is measured could not be made.
    #[error("cannot measure a film: {0}")]
    Film(String),
    /// The results could not be written as JSON.
    #[error("cannot lay out the report: {0}")]
    Layout(String),
}

/// The results of all measurements so far.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Report {
    /// The machine that was measured.
    pub machine: Machine,
    /// True if measured with fewer settings and starts.
    pub quick: bool,
    /// The chapters that were asked for; empty if all were.
    pub only: Vec<Chapter>,
    /// Largest number of starts compared with the gold standard.
    pub sample: usize,
    /// True if nothing is missing.
    pub complete: bool,
    /// Planned measurements that have not been made.
    pub missing: Vec<String>,
    /// Speed and errors, engine by engine, config by config.
    pub rows: Vec<Row>,
    /// Requests that an engine refused.
    pub not_offered: Vec<Refusal>,
    /// Gains of kernels made for their scene.
    pub specialising: Vec<Specialising>,
    /// Errors in angle and energy, by method and time.
    pub motion: Vec<MotionError>,
    /// What flipmap claims about its answers, beside the results.
    #[serde(rename = "targets")]
    pub claims: Vec<Claim>,
    /// Rows of the accuracy `exact`, engine by engine.
    pub exact: Vec<Row>,
    /// Errors of `balanced` in windows beyond the home map.
    pub windows: Vec<WindowRow>,
    /// Comparison of `exact` with double-double, where flips come late.
    pub late: Vec<LateRow>,
    /// Results of deep zoom, place by place.
    pub depth: Vec<DepthRow>,
    /// Speed and errors of the questions other than the first flip.
    pub questions: Vec<QuestionRow>,
    /// Times of short zooms, which stand for parts of a long film, from the widest to the deepest.
    pub zooms: Vec<ZoomRow>,
    /// Time of the frames of a long film.
    pub painting: Option<PaintingRow>,
    /// Results of the hard cases.
    pub hard: Vec<HardRow>,
}

/// Measurements of an engine with a config.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The kind of engine.
    pub engine: EngineKind,
    /// Full name of the adapter, or the processor's threads and SIMD width.
    pub adapter: String,
    /// Number of threads if the processor computes, `None` for an adapter.
    pub threads: Option<usize>,
    /// The integrator config that was measured.
    #[serde(flatten, serialize_with = "as_words")]
    pub config: IntegratorConfig,
    /// Number of starts in each timed round.
    pub starts: usize,
    /// Number of timed rounds.
    pub rounds: usize,
    /// Microseconds per integrated pixel: the median of the rounds.
    pub us_per_pixel: f64,
    /// Microseconds per pixel of the fastest round.
    pub us_least: f64,
    /// Microseconds per pixel of the slowest round.
    pub us_most: f64,
    /// Difference between the slowest and the fastest round, as a share of the median.
    pub spread: f64,
    /// Microseconds per pixel of the scalar loop, run between the rounds.
    pub scalar_us_per_pixel: f64,
    /// Speed as a multiple of the scalar loop's.
    pub times_scalar: f64,
    /// Errors against the gold standard.
    #[serde(flatten)]
    pub errors: Errors,
    /// Right-hand side evaluations per pixel; an expansion to order N counts as N.
    pub rhs_per_pixel: f64,
    /// Steps tried per pixel.
    pub steps_per_pixel: f64,
    /// Share of the lanes' steps that were useful.
    pub lane_use: f64,
    /// The errors by true flip time.
    pub bands: Vec<Band>,
    /// Results of checking every pixel, if that was done.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub checks: Option<Checks>,
}

impl Row {
    /// A row without measurements yet.
    pub fn new(backend: &Backend, config: IntegratorConfig) -> Self {
        Row::named(backend.kind(), &backend.adapter(), backend.threads(), config)
    }

    fn named(
        engine: EngineKind,
        adapter: &str,
        threads: Option<usize>,
        config: IntegratorConfig,
    ) -> Self {
        Row {
            engine,
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
        backend::short_name(self.engine, &self.adapter)
    }
}

/// A request that an engine refused.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Refusal {
    /// Name of the engine.
    pub engine: String,
    /// The request.
    pub what: String,
    /// The engine's reason.
    pub reason: String,
}

/// Comparison of a kernel made for its scene with the general one.
#[derive(Clone, Debug, Serialize)]
pub struct Specialising {
    /// Full name of the adapter.
    pub adapter: String,
    /// The integrator config that was measured.
    #[serde(flatten, serialize_with = "as_words")]
    pub config: IntegratorConfig,
    /// Median microseconds per pixel of the general kernel.
    pub general_us_per_pixel: f64,
    /// Median microseconds per pixel of the specialised kernel.
    pub specialised_us_per_pixel: f64,
    /// Speed-up by the specialised kernel: the median of the rounds' ratios.
    pub ratio: f64,
}

/// Serialises a config as the three texts that stand for it in files.
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
