//! Pictures, films and traces: which samples are computed, in what order, and into which files.

pub mod farm;
pub mod film;
pub mod output;
pub mod tiles;
