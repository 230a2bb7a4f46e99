//! Exit codes, and the one place where errors become words.

use std::io::{self, Write};
use std::process::ExitCode;

use flipmap::engine::EngineError;
use flipmap::engine::choice::ChoiceError;
use flipmap::output;
use flipmap::scene::{DocumentError, SceneError};

/// What the program did not do, by exit code.
#[derive(Debug, thiserror::Error)]
pub enum Exit {
    /// Code 2.
    #[error("{0}")]
    Usage(String),
    /// Code 3: what was compared is too different.
    #[error("{0}")]
    Differs(String),
    /// Code 4: shards are not complete.
    #[error("{0}")]
    Missing(String),
    /// Code 75.
    #[error("stopped; what was finished is kept: run the same again to go on")]
    Again,
    /// Code 130.
    #[error("stopped; no unfinished file was left")]
    Interrupted,
    /// Code 130 too, and what there is all the same.
    #[error("{0}")]
    Partly(String),
}

/// Prints an error and gives its code.
pub fn report(error: &anyhow::Error) -> ExitCode {
    if output::is_broken_pipe(error.as_ref()) {
        return ExitCode::SUCCESS;
    }
    // With standard error closed too there is nobody left to tell.
    let _ = writeln!(io::stderr(), "flipmap: {}", sentence(error));
    ExitCode::from(code_of(error))
}

/// What went wrong and why; of a stop only that.
fn sentence(error: &anyhow::Error) -> String {
    match error.downcast_ref() {
        Some(stopped @ (Exit::Interrupted | Exit::Again)) => stopped.to_string(),
        _ => output::sentence(error.as_ref()),
    }
}

fn code_of(error: &anyhow::Error) -> u8 {
    for cause in error.chain() {
        if let Some(exit) = cause.downcast_ref() {
            return match exit {
                Exit::Usage(_) => 2,
                Exit::Differs(_) => 3,
                Exit::Missing(_) => 4,
                Exit::Again => 75,
                Exit::Interrupted | Exit::Partly(_) => 130,
            };
        }
        if cause.is::<SceneError>() || cause.is::<DocumentError>() {
            return 2;
        }
        if let Some(choice) = cause.downcast_ref() {
            return match choice {
                ChoiceError::NoAdapter(_) => 69,
                ChoiceError::UnknownAdapter { .. } => 2,
                ChoiceError::Engine(EngineError::Unsupported(_)) => 2,
                ChoiceError::Engine(_) => 1,
            };
        }
    }
    1
}
