//! What the program says on standard error, and in which form.

use std::io::{Write, stderr};
use std::sync::OnceLock;

use serde_json::json;

use super::exit::printable;

/// The form of what is said.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Voice {
    /// Lines of text.
    #[default]
    Plain,
    /// Warnings and errors only, for `--quiet`.
    Quiet,
    /// JSON objects, one in each line, for `--progress json`.
    Json,
}

static VOICE: OnceLock<Voice> = OnceLock::new();

/// Beginning of the lines that this program says.
const NAME: &str = "flipmap: ";
/// Beginning of those that warn.
const WARNING: &str = "flipmap: warning: ";

impl Voice {
    /// Returns the voice for people.
    pub(super) fn of(quiet: bool) -> Self {
        if quiet { Voice::Quiet } else { Voice::Plain }
    }

    /// Returns the line for a text, if it is said.
    fn line(self, text: &str) -> Option<String> {
        match self {
            Voice::Quiet if !text.starts_with(WARNING) => None,
            Voice::Plain | Voice::Quiet => Some(printable(text)),
            Voice::Json => Some(match text.strip_prefix(WARNING) {
                Some(warning) => json!({ "warning": warning }).to_string(),
                None => json!({ "message": text.strip_prefix(NAME).unwrap_or(text) }).to_string(),
            }),
        }
    }
}

/// Returns the voice of this run.
pub(super) fn current() -> Voice {
    VOICE.get().copied().unwrap_or_default()
}

/// Chooses the voice of this run, once.
pub(super) fn set(voice: Voice) {
    // A second call would come from a second command line, which there is not.
    let _ = VOICE.set(voice);
}

/// Says a line; a failure is ignored, as there is nowhere left to report it.
pub(super) fn tell(text: &str) {
    if let Some(line) = current().line(text) {
        let _ = writeln!(stderr(), "{line}");
    }
}

/// Says an object of progress.
pub(super) fn tell_json(object: &serde_json::Value) {
    let _ = writeln!(stderr(), "{object}");
}

/// Says why the program ends, in every voice.
pub(super) fn tell_error(text: &str) {
    let line = match current() {
        Voice::Json => json!({ "error": text }).to_string(),
        Voice::Plain | Voice::Quiet => printable(&format!("{NAME}{text}")),
    };
    let _ = writeln!(stderr(), "{line}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_voice_says_its_part() {
        let lines = |voice: Voice| {
            ["flipmap: 3 pixels", "flipmap: warning: few", "left"].map(|text| voice.line(text))
        };
        let some = |text: &str| Some(text.to_string());
        assert_eq!(lines(Voice::of(false))[0], some("flipmap: 3 pixels"));
        assert_eq!(lines(Voice::of(true)), [None, some("flipmap: warning: few"), None]);
        let json =
            ["{\"message\":\"3 pixels\"}", "{\"warning\":\"few\"}", "{\"message\":\"left\"}"];
        assert_eq!(lines(Voice::Json), json.map(some));
    }
}
