//! Which pixels are computed in which order, and the one loop that does it.
//!
//! A picture is cut into [`Tile`]s. [`Work`] turns them into jobs, keeps the engine's slots
//! full, and hands tiles back as they finish. A window
//! draws from an [`explorer::Explorer`], whose tiles are cells of a lattice that does not move
//! with the view. Both are built on the same in_flight to the engine. Pixels that energy forbids, or
//! that a mirror image already answers, never reach it.
//!
//! Nothing here knows a graphics card: the tests run it on the mock engine.

pub mod cache;
pub mod descent;
pub mod explorer;
mod in_flight;
mod open_tile;
mod opinion;
mod order;
mod outlook;
pub mod patch_work;
pub mod patches;
mod plan;
pub mod preview;
mod renderer;
mod samples;
mod saved_pixels;
pub mod view_target;
mod work;

pub use opinion::opinion;
pub use outlook::outlook;
pub use plan::{Tile, plan};
pub use renderer::Renderer;
pub use samples::{Counts, Samples};
pub use saved_pixels::{SavedPixel, SavedPixels};
pub use work::{FinishedTile, Work};
