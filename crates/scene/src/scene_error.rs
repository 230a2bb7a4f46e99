//! The error for an unusable value of a setting.

use std::fmt::Display;

use super::pasted::decimal_hint;

/// A setting whose value cannot be used, with the allowed values.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.called(&format_args!("`{setting}`")))]
pub struct SceneError {
    /// Name of the setting: a key in a scene file or an option on the command line.
    pub setting: &'static str,
    /// The given value.
    pub value: String,
    /// The allowed values, as a phrase.
    pub allowed: String,
}

impl SceneError {
    /// Creates an error for a value, with the allowed values as a phrase.
    pub fn new(
        setting: &'static str,
        value: impl Into<String>,
        allowed: impl Into<String>,
    ) -> Self {
        SceneError { setting, value: value.into(), allowed: allowed.into() }
    }

    /// Adds a hint if the text of `count` numbers has commas where the decimal points should be.
    #[must_use]
    pub(crate) fn hinting(mut self, text: &str, count: usize) -> Self {
        self.allowed += &decimal_hint(text, count);
        self
    }

    /// Returns the error as a sentence that calls the setting by another name.
    pub fn called(&self, name: &dyn Display) -> String {
        format!("{name} is {}; {}", self.value, self.allowed)
    }
}
