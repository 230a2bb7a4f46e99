//! Chooses and orders the pixels to compute, and runs the one loop that computes them.
//!
//! Pictures, films and windows cut their contents into tiles, each in its own way and order. All of
//! them implement the trait `TileSource` of `in_flight.rs` and so share one loop, which turns tiles
//! into jobs, keeps the engine's slots full and returns tiles as they finish. Pixels that energy
//! forbids, or that a mirror image or an earlier run answers, never reach the engine.
//!
//! - [`Work`] (`work.rs`) computes a picture in bands of rows from the top, each a tile.
//!   [`PlainPixels`] save most of the samples where pixels have several.
//! - [`patch_work::PatchWork`] computes the [`patches`] of a film: cells of the lattice, each as
//!   fine as the closest frame that shows it needs, in the order given.
//! - [`explorer::Explorer`] computes what a window shows: cells of a lattice that does not move
//!   with the view, first a few samples of each, last the finer samples at edges.
//! - [`Points`] (`points.rs`) are pixels of any grids, answered in their order.
//! - [`descent`] and [`Renderer`] build on [`Work`]; [`outlook()`] and [`opinion()`] check answers.
//!
//! Nothing here depends on a graphics card: the tests run on the mock engine.

mod adaptive;
mod bands;
pub mod cache;
pub mod descent;
mod direct_check;
pub mod explorer;
mod feasible;
mod in_flight;
pub mod moments;
mod open_tile;
mod opinion;
mod order;
mod outlook;
pub(crate) mod patch_work;
pub(crate) mod patches;
mod plan;
mod points;
pub mod preview;
pub mod reader;
mod refinement;
mod renderer;
mod samples;
mod saved_pixels;
mod stride;
pub mod view_target;
mod work;

pub(crate) use adaptive::PlainPixels;
pub use feasible::{check_feasible, check_steps, follows_cells};
pub use opinion::opinion;
pub use outlook::outlook;
pub use plan::plan;
pub use points::Points;
pub use renderer::Renderer;
pub(crate) use samples::number_of;
pub use samples::{Counts, Samples};
pub use saved_pixels::SavedPixels;
pub use stride::Stride;
pub(crate) use work::FinishedTile;
pub use work::{Work, mirrored_bytes};
