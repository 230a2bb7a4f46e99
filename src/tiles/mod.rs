//! Which pixels are computed in which order, and the one loop that does it.
//!
//! A picture is cut into [`Tile`]s. [`Work`] turns them into jobs, keeps the engine's slots
//! full, and hands tiles back as they finish. Headless callers let it run to the end; a window
//! gives it a deadline and draws between. Pixels that energy forbids, or that a mirror image
//! already answers, never reach the engine.
//!
//! Nothing here knows a graphics card: the tests run it on the mock engine.

mod flights;
mod kept;
mod plan;
mod samples;
mod work;

pub use kept::{Kept, Known};
pub use plan::{Tile, plan};
pub use samples::{Counts, Samples};
pub use work::{FinishedTile, Work};
