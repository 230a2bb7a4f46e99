//! Settings for the integration of the window's pixels.

use flipmap_engine::EngineKind;
use flipmap_engine::run_settings::RunSpec;

/// Settings for the integration of pixels, and the wanted engine.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Integration {
    /// The resolved settings.
    pub spec: RunSpec,
    /// Kind of engine that is wanted; `None` for the fastest.
    pub kind: Option<EngineKind>,
}
