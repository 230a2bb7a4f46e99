//! Work that is split, stopped and resumed: large stills and films.
//!
//! A [`Plan`] says what is wanted and in how many shards. [`compute()`] computes what is missing of a
//! shard into [`Parts`], files of samples that are either complete or absent; [`merge_still`] or
//! [`FilmRecipe::merge`](crate::film::FilmRecipe::merge) reads them in order and writes the planned
//! output. Shards only divide the work: the samples of a place
//! are the same wherever they are computed, so any number of machines may work, stop, and start
//! again.

mod film_samples;
mod frames;
mod merge;
mod parts;
mod plan;
mod run;
mod spread;
mod task;

pub use film_samples::{FilmSamples, FilmSamplesError};
pub(crate) use frames::frames;
pub use merge::{MergeError, merge_still};
pub use parts::{PartError, PartForm, PartForms, Parts};

pub(crate) use parts::PartWriter;
pub use plan::{Plan, PlanError, PlannedOutput};
pub use run::{RunError, compute, run};
pub use spread::{OpenChoices, is_deep, spread_film};
pub use task::{StillPass, Task, TaskKind, WorkPiece};
