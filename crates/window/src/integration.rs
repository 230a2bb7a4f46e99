//! The way in which the pixels of the window are integrated.

use flipmap_engine::EngineKind;
use flipmap_engine::run_settings::RunSpec;

/// The way in which pixels are integrated, and the engine that is wanted for it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Integration {
    /// The resolved settings.
    pub spec: RunSpec,
    /// Kind of engine that is wanted; `None` for the fastest.
    pub kind: Option<EngineKind>,
}
