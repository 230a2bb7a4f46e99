//! The error for an unusable value in a scene.

use std::borrow::Cow;

/// A setting whose value cannot be used, with the allowed range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{setting}` is {value}; {range}")]
pub struct SceneError {
    /// Name of the setting: a key in a scene file or an option on the command line.
    pub setting: &'static str,
    /// The given value.
    pub value: String,
    /// The allowed range, as a phrase.
    pub range: Cow<'static, str>,
}

impl SceneError {
    /// Creates an error for a value, with the allowed range as a phrase.
    pub fn new(
        setting: &'static str,
        value: impl Into<String>,
        range: impl Into<Cow<'static, str>>,
    ) -> Self {
        SceneError { setting, value: value.into(), range: range.into() }
    }
}
