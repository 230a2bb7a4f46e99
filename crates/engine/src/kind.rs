//! The two kinds of engine.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The hardware that an engine computes on. Its text, in files too, is `cpu` or `gpu`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum EngineKind {
    /// The processor.
    Cpu,
    /// A graphics adapter.
    Gpu,
}

impl fmt::Display for EngineKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            EngineKind::Cpu => "cpu",
            EngineKind::Gpu => "gpu",
        })
    }
}

/// The error for a text that names no kind of engine.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown engine '{0}': it must be cpu or gpu")]
pub struct UnknownEngine(String);

impl TryFrom<String> for EngineKind {
    type Error = UnknownEngine;

    fn try_from(text: String) -> Result<Self, UnknownEngine> {
        match text.as_str() {
            "cpu" => Ok(EngineKind::Cpu),
            "gpu" => Ok(EngineKind::Gpu),
            _ => Err(UnknownEngine(text)),
        }
    }
}

impl From<EngineKind> for String {
    fn from(kind: EngineKind) -> Self {
        kind.to_string()
    }
}
