//! Work that is split, stopped and resumed: large stills and films.
//!
//! A [`Plan`] says what is wanted and in how many shards. [`run()`] computes what is missing of a
//! shard into [`Parts`], files of samples that are either complete or absent; [`mod@merge`] reads
//! them in order and writes the planned output. Shards only divide the work: the samples of a place
//! are the same wherever they are computed, so any number of machines may work, stop, and start
//! again.

pub mod merge;
mod parts;
mod plan;
mod run;
mod task;

pub use parts::{PartError, PartForm, PartForms, Parts};

pub(crate) use parts::PartWriter;
pub use plan::{Plan, PlanError, PlannedOutput};
pub use run::{RunError, run};
pub use task::{StillPass, Task, TaskKind, WorkPiece};
