//! Names that shells complete as values of an option. Other values are refused elsewhere, in the
//! words of the library. An option that also takes files has none: shells complete files.

use std::ffi::OsStr;

use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use clap::{Arg, Command};

/// A parser of any text that suggests these names.
#[derive(Clone, Debug)]
pub(super) struct Suggested(pub Vec<&'static str>);

impl Suggested {
    /// Suggests the names of a closed set.
    pub(super) fn of<T>(set: &[(&'static str, T)]) -> Self {
        Suggested(set.iter().map(|(name, _)| *name).collect())
    }
}

impl TypedValueParser for Suggested {
    type Value = String;

    fn parse_ref(
        &self,
        command: &Command,
        option: Option<&Arg>,
        value: &OsStr,
    ) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, option, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        if self.0.is_empty() {
            return None;
        }
        Some(Box::new(self.0.iter().map(PossibleValue::new)))
    }
}
