//! The way in which the pixels of the window are integrated.

use crate::engine::choice::{EngineKind, IntegrationSetting};
use crate::scene::RunTable;

/// The way in which pixels are integrated, and the engine that is wanted for it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Integration {
    /// Run table, as a scene's file states it.
    pub run: RunTable,
    /// Integration setting that follows from the run table, for the engines.
    pub setting: IntegrationSetting,
    /// True if every pixel is checked.
    pub verify: bool,
    /// Kind of engine that is wanted.
    pub kind: EngineKind,
}
