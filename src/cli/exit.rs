//! Exit codes, and the one place where errors become messages.

use std::error::Error;
use std::io::{self, Write};
use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue};
use flipmap_engine::EngineError;
use flipmap_engine::choice::ChoiceError;
use flipmap_render::output::{self, OutputError, shell_word};
use flipmap_scene::{BuiltIn, DocumentError, SceneError};

use super::option_names::option_of;
use super::voice::{self, Voice, tell_error};

/// Failures of the program, by exit code.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Exit {
    /// Exit code 2: the command line or one of its files cannot be used.
    #[error("{0}")]
    Usage(String),
    /// Exit code 1: the machine or its file system prevents it.
    #[error("{0}")]
    Failed(String),
    /// Exit code 69: no graphics device here can draw the window.
    #[cfg(feature = "window")]
    #[error("{0}")]
    Unavailable(String),
    /// Exit code 3: results differ too much.
    #[error("{0}")]
    Differs(String),
    /// Exit code 4: shards are incomplete.
    #[error("{0}")]
    Missing(String),
    /// Exit code 75: stopped, and can be resumed.
    #[error("stopped; what was finished is kept: run the same command again to resume")]
    Again,
    /// Exit code 75: stopped before any output was complete; its samples are kept.
    #[error("stopped; no file was written, and the samples are kept: run the same command again")]
    Unwritten,
    /// Exit code 130: stopped, and no unfinished file is left.
    #[error("stopped; no unfinished file was left")]
    Interrupted,
    /// Exit code 130: stopped, with a message about the part that is finished.
    #[error("{0}")]
    Partly(String),
}

/// Prints an error and returns its exit code.
pub(crate) fn report(error: &anyhow::Error) -> ExitCode {
    if output::is_broken_pipe(error.as_ref()) {
        return ExitCode::SUCCESS;
    }
    tell_error(&sentence(error));
    ExitCode::from(code_of(error))
}

/// Maximum number of characters in a message; only one that quotes a very long input has more.
const MAX_CHARACTERS: usize = 2000;

/// Makes a text safe for a terminal. Words quoted from a file or an option can contain control
/// characters, which a terminal would obey, can reverse the direction of writing, and can be very
/// long.
pub(super) fn printable(text: &str) -> String {
    let mut cleaned = String::new();
    for (k, character) in text.chars().enumerate() {
        if k == MAX_CHARACTERS {
            cleaned.push('…');
            break;
        }
        match character {
            '\n' => cleaned.push('\n'),
            other if other.is_control() || is_direction(other) => {
                cleaned.extend(other.escape_unicode());
            }
            other => cleaned.push(other),
        }
    }
    cleaned
}

/// Returns true for a character that overrides or isolates the direction of writing.
fn is_direction(character: char) -> bool {
    matches!(character, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Maximum number of characters in a line of a usage error.
const MAX_LINE_CHARACTERS: usize = 400;

/// Prints clap's help, or its error, cleaned like any other, and exits with clap's code.
pub(super) fn leave(error: &clap::Error) -> ! {
    if !error.use_stderr() {
        let code = match error.print() {
            Err(why) if why.kind() != io::ErrorKind::BrokenPipe => {
                tell_error(&format!("cannot write standard output: {why}"));
                1
            }
            _ => 0,
        };
        std::process::exit(code)
    }
    let text = error.render().to_string();
    let lines: Vec<String> = text.lines().map(|line| shortened(&in_our_words(line))).collect();
    let text = printable(&(lines.join("\n") + &meant(error)));
    if says_json() {
        voice::set(Voice::Json);
        tell_error(text.trim_start_matches("error: ").trim_end());
    } else {
        let _ = writeln!(io::stderr(), "{}", text.trim_end());
    }
    std::process::exit(error.exit_code())
}

/// Returns a line about the command that was probably meant, if a scene stands in its place.
fn meant(error: &clap::Error) -> String {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else {
        return String::new();
    };
    if BuiltIn::named(word).is_none() && !word.ends_with(".toml") && !word.ends_with(".png") {
        return String::new();
    }
    format!("\n\n  tip: '{word}' is a scene: flipmap render {0}", shell_word(word.as_ref()))
}

/// Returns a line of clap's with what Rust's parsers of numbers say in the words of people.
fn in_our_words(line: &str) -> String {
    let number = "it must be a whole number";
    let said = ["invalid digit found in string", "cannot parse integer from empty string"];
    said.iter().fold(line.to_string(), |line, words| line.replace(words, number))
}

/// Returns true if the command line, which could not be read, asks for JSON.
fn says_json() -> bool {
    let words: Vec<_> = std::env::args_os().collect();
    let is_pair = |pair: &[std::ffi::OsString]| pair[0] == "--progress" && pair[1] == "json";
    words.windows(2).any(is_pair) || words.iter().any(|word| word == "--progress=json")
}

/// Cuts the middle, which is a quoted value, out of a very long line; clap's words are at its ends.
fn shortened(line: &str) -> String {
    let characters: Vec<char> = line.chars().collect();
    if characters.len() <= MAX_LINE_CHARACTERS {
        return line.to_string();
    }
    let half = MAX_LINE_CHARACTERS / 2;
    let [head, tail] = [&characters[..half], &characters[characters.len() - half..]];
    head.iter().chain(&['…']).chain(tail).collect()
}

/// Describes an error and its causes; for a stop, only the stop.
fn sentence(error: &anyhow::Error) -> String {
    if output::is_stopped(error.as_ref()) {
        return Exit::Interrupted.to_string();
    }
    match error.downcast_ref() {
        Some(stopped @ (Exit::Interrupted | Exit::Again | Exit::Unwritten)) => stopped.to_string(),
        _ => with_options(error.as_ref()),
    }
}

impl Exit {
    /// Returns the usage error for an error of the library.
    pub(super) fn usage(error: &(dyn Error + 'static)) -> Exit {
        Exit::Usage(with_options(error))
    }
}

/// Describes an error and its causes, outermost first, and calls each setting by its option. What an
/// error repeats of its cause is said once.
fn with_options(error: &(dyn Error + 'static)) -> String {
    let causes = std::iter::successors(Some(error), |cause| (*cause).source());
    let said = causes.map(|cause| match cause.downcast_ref::<SceneError>() {
        Some(error) => error.called(&option_of(error.setting)),
        None => without_its_cause(cause),
    });
    said.filter(|words| !words.is_empty()).collect::<Vec<_>>().join(": ")
}

fn without_its_cause(error: &(dyn Error + 'static)) -> String {
    if let Some(OutputError::Create { setting, name, .. }) = error.downcast_ref() {
        return format!("{}: cannot write {name}", option_of(setting));
    }
    let words = error.to_string();
    let cause = error.source().map(ToString::to_string);
    match cause.and_then(|cause| words.strip_suffix(&cause).map(str::to_string)) {
        Some(words) => words.trim_end_matches([':', ' ']).to_string(),
        None => words,
    }
}

fn code_of(error: &anyhow::Error) -> u8 {
    if output::is_stopped(error.as_ref()) {
        return 130;
    }
    for cause in error.chain() {
        if let Some(exit) = cause.downcast_ref() {
            return match exit {
                Exit::Failed(_) => 1,
                #[cfg(feature = "window")]
                Exit::Unavailable(_) => 69,
                Exit::Usage(_) => 2,
                Exit::Differs(_) => 3,
                Exit::Missing(_) => 4,
                Exit::Again | Exit::Unwritten => 75,
                Exit::Interrupted | Exit::Partly(_) => 130,
            };
        }
        if cause.is::<SceneError>() || cause.is::<DocumentError>() {
            return 2;
        }
        // A name with the ending of another format.
        if let Some(OutputError::Create { source, .. }) = cause.downcast_ref()
            && source.kind() == io::ErrorKind::InvalidInput
        {
            return 2;
        }
        if let Some(choice) = cause.downcast_ref() {
            return match choice {
                ChoiceError::NoAdapter(_) => 69,
                ChoiceError::UnknownAdapter(_) => 2,
                ChoiceError::Engine(EngineError::Setting(_) | EngineError::Unsupported(_)) => 2,
                ChoiceError::Engine(_) => 1,
            };
        }
    }
    1
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_render::farm::FilmSamplesError;
    use flipmap_render::output::{Destination, RenderError};

    #[test]
    fn a_stop_says_what_is_there() {
        let said = |exit: Exit| {
            let error = anyhow::Error::from(exit);
            (code_of(&error), sentence(&error))
        };
        let (code, unwritten) = said(Exit::Unwritten);
        assert!(code == 75 && unwritten.contains("no file was written"), "{unwritten}");
        let (code, again) = said(Exit::Again);
        assert!(code == 75 && again.contains("what was finished is kept"), "{again}");
    }

    #[test]
    fn settings_are_called_by_their_options_at_any_depth() {
        let small = || SceneError::new("width", "'0'", "it must be `more`");
        let said = "--width is '0'; it must be `more`";
        assert_eq!(with_options(&small()), said);
        assert_eq!(with_options(&DocumentError::from(small())), said);
        let painted = RenderError::from(OutputError::from(small()));
        assert_eq!(with_options(&painted), said);
        let name = Destination::from(std::path::Path::new("map.png"));
        let source = io::Error::other("full");
        let created = OutputError::Create { setting: "output", name, source };
        assert_eq!(with_options(&RenderError::from(created)), "-o: cannot write map.png: full");
    }

    #[test]
    fn what_an_error_repeats_of_its_cause_is_said_once() {
        let source = io::Error::other("full");
        let kept = FilmSamplesError::Write { folder: "f.samples".into(), source };
        assert_eq!(with_options(&kept), "cannot keep samples in f.samples: full");
    }

    #[test]
    fn messages_hold_nothing_that_a_terminal_obeys_and_have_an_end() {
        assert_eq!(printable("the name \u{1b}[31m\nθ1"), "the name \\u{1b}[31m\nθ1");
        assert_eq!(printable("a\u{202e}b\u{2066}\r\u{9b}"), r"a\u{202e}b\u{2066}\u{d}\u{9b}");
        assert_eq!(printable(&"9".repeat(1_000_000)).chars().count(), MAX_CHARACTERS + 1);
    }
}
