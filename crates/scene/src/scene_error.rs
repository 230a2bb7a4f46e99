//! The refusal of a value of a scene.

use std::borrow::Cow;

/// A number of a scene that cannot be used, with the range of those that can.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{setting}` is {value}; {range}")]
pub struct SceneError {
    /// The name of the setting: a key of a scene, an option of the command line.
    pub setting: &'static str,
    /// The given value.
    pub value: String,
    /// The allowed range, as a phrase.
    pub range: Cow<'static, str>,
}

impl SceneError {
    /// The refusal of a value, with the range of those that can be used.
    pub fn new(
        setting: &'static str,
        value: impl Into<String>,
        range: impl Into<Cow<'static, str>>,
    ) -> Self {
        SceneError { setting, value: value.into(), range: range.into() }
    }
}
