//! Errors on the way from samples to files, and the text of any error as one sentence.

use std::error::Error;
use std::io;

use super::device::StoppedWriting;
use super::{Destination, PngError};
use flipmap_engine::EngineError;
use flipmap_scene::SceneError;

/// Reasons why a file could not be written.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// A file that could not be created.
    #[error("`{setting}`: cannot write {name}")]
    Create {
        /// The setting that named the file.
        setting: &'static str,
        /// The destination.
        name: Destination,
        /// The cause.
        source: io::Error,
    },
    /// A file that could not be written or renamed to its destination.
    #[error("cannot write {name}")]
    Write {
        /// The destination.
        name: Destination,
        /// The cause.
        source: PngError,
    },
    /// A picture that cannot be painted with these settings.
    #[error("{0}")]
    Picture(#[from] SceneError),
}

/// Reasons why a picture was not completed.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The engine failed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// A file could not be written.
    #[error("{0}")]
    Output(#[from] OutputError),
    /// A request to stop.
    #[error("stopped; no unfinished file was left")]
    Stopped,
}

/// Iterates over an error and its causes, outermost first.
fn causes<'a>(error: &'a (dyn Error + 'static)) -> impl Iterator<Item = &'a (dyn Error + 'static)> {
    std::iter::successors(Some(error), |cause| (*cause).source())
}

/// Returns an error and its causes as one sentence, outermost first. Adjacent repetitions are
/// dropped, because some libraries repeat their source.
pub fn sentence(error: &(dyn Error + 'static)) -> String {
    let mut causes: Vec<String> = causes(error).map(ToString::to_string).collect();
    causes.dedup();
    causes.join(": ")
}

/// Returns true if a request to stop ended a write that waited for its reader.
pub fn is_stopped(error: &(dyn Error + 'static)) -> bool {
    let stopped = |cause: &io::Error| cause.get_ref().is_some_and(|why| why.is::<StoppedWriting>());
    causes(error).any(|cause| cause.downcast_ref().is_some_and(stopped))
}

/// Returns true if the reader at the other end has gone.
pub fn is_broken_pipe(error: &(dyn Error + 'static)) -> bool {
    let broken = |cause: &io::Error| cause.kind() == io::ErrorKind::BrokenPipe;
    causes(error).any(|cause| cause.downcast_ref().is_some_and(broken))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn failed(kind: io::ErrorKind) -> RenderError {
        let name = Destination::from(Path::new("map.png"));
        OutputError::Write { name, source: io::Error::from(kind).into() }.into()
    }

    #[test]
    fn every_cause_is_said_once() {
        let full = sentence(&failed(io::ErrorKind::StorageFull));
        assert_eq!(full, "cannot write map.png: no storage space");
    }

    #[test]
    fn a_broken_pipe_is_found_under_what_it_broke() {
        assert!(is_broken_pipe(&failed(io::ErrorKind::BrokenPipe)));
        assert!(!is_broken_pipe(&failed(io::ErrorKind::StorageFull)));
    }
}
