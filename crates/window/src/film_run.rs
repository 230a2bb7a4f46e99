//! Films made from the window by `flipmap video` in a process of its own. They are bit for bit the
//! same as from a terminal, keep their samples when stopped, and survive a crash of the window.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

use serde::Deserialize;

use super::compute_service::lower_priority;
use super::export::{ExportStage, thousands};
use flipmap_engine::choice::EngineRequest;

/// A film to make from a file of keys.
#[derive(Clone, Copy, Debug)]
pub struct FilmOrder<'a> {
    /// File of the keys.
    pub keys: &'a Path,
    /// Width and height of a frame in pixels.
    pub size: [u32; 2],
    /// Frames per second.
    pub fps: f64,
    /// File of the film.
    pub output: &'a Path,
    /// Engine to compute with.
    pub engine: &'a EngineRequest,
}

/// A function that returns the command for making a film, which reports its progress as lines of
/// JSON on standard error. The command-line program provides it, because it alone knows its
/// options.
pub(crate) type FilmCommand = fn(&FilmOrder) -> std::io::Result<Command>;

/// A film that the window makes in the background.
#[derive(Clone, Debug)]
pub(crate) struct FilmRequest {
    /// Command that makes it.
    pub command: FilmCommand,
    /// Keys as the text of their file.
    pub keys: String,
    /// Width and height of a frame in pixels.
    pub size: [u32; 2],
    /// Frames per second.
    pub fps: f64,
    /// File of the film.
    pub path: PathBuf,
}

/// A reason why there is no film.
#[derive(Debug, thiserror::Error)]
pub(crate) enum FilmRunError {
    /// The process could not be started or watched.
    #[error("the film could not be begun: {0}")]
    Process(#[from] std::io::Error),
    /// The process refused or failed; holds its message.
    #[error("{0}")]
    Said(String),
    /// The user stopped it; its samples are kept.
    #[error("stopped")]
    Stopped,
}

/// What the process says in a line.
#[derive(Deserialize)]
#[serde(untagged)]
enum Line {
    Progress(Progress),
    Error { error: String },
}

/// Progress of the process.
#[derive(Deserialize)]
struct Progress {
    done: u64,
    total: u64,
    secs_left: f64,
}

/// Time between two checks whether the film should be stopped.
const TICK: Duration = Duration::from_millis(100);

/// Makes a film; calls `set` with its progress, and stops it when `stopped` returns true.
pub(super) fn film(
    request: &FilmRequest,
    engine: &EngineRequest,
    set: &dyn Fn(ExportStage),
    stopped: &(dyn Fn() -> bool + Sync),
) -> Result<(), FilmRunError> {
    set(ExportStage::Starting("planning the film".to_string()));
    let keys = tempfile::Builder::new().prefix("flipmap-keys-").suffix(".toml").tempfile()?;
    std::fs::write(keys.path(), &request.keys)?;
    let output = &std::path::absolute(&request.path)?;
    let FilmRequest { size, fps, .. } = *request;
    let order = FilmOrder { keys: keys.path(), size, fps, output, engine };
    let mut command = (request.command)(&order)?;
    // The process inherits the niceness of this thread.
    lower_priority();
    let pipes = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = pipes.spawn()?;
    let lines = child.stderr.take().map(lines_of);
    let mut said = String::new();
    let mut asked = false;
    while let Some(lines) = &lines {
        match lines.recv_timeout(TICK) {
            Ok(line) => match serde_json::from_str(&line) {
                Ok(Line::Progress(progress)) => set(stage(&progress)),
                Ok(Line::Error { error }) => said = error,
                // Messages of the program, and lines of others, as of a library that panics.
                Err(_) if line.starts_with('{') => {}
                Err(_) => said = line,
            },
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
        if stopped() && !asked {
            asked = true;
            ask_to_stop(&mut child)?;
        }
    }
    let status = child.wait()?;
    match status.success() {
        true => Ok(()),
        false if asked => Err(FilmRunError::Stopped),
        false if said.is_empty() => Err(FilmRunError::Said(format!("the film ended: {status}"))),
        false => Err(FilmRunError::Said(said)),
    }
}

/// Largest number of bytes read as one line.
const MAX_LINE: u64 = 1 << 16;

/// Returns the lines of a stream as they come, read on a thread of their own.
fn lines_of(stream: impl Read + Send + 'static) -> Receiver<String> {
    let (sender, lines) = sync_channel(16);
    std::thread::spawn(move || {
        let mut stream = BufReader::new(stream);
        let mut bytes = Vec::new();
        while matches!((&mut stream).take(MAX_LINE).read_until(b'\n', &mut bytes), Ok(1..)) {
            let line = String::from_utf8_lossy(&bytes).trim_end().to_string();
            bytes.clear();
            if sender.send(line).is_err() {
                break;
            }
        }
    });
    lines
}

fn stage(line: &Progress) -> ExportStage {
    let share = line.done as f64 / line.total.max(1) as f64;
    let left = match line.secs_left {
        secs if secs < 90.0 => format!("{} s left", secs.round()),
        secs => format!("{} min left", thousands((secs / 60.0).round())),
    };
    ExportStage::Running { share, pace: left }
}

/// Asks the process to stop after it has finished the samples in hand.
#[cfg(unix)]
fn ask_to_stop(child: &mut Child) -> std::io::Result<()> {
    use rustix::process::{Pid, Signal, kill_process};
    Ok(kill_process(Pid::from_child(child), Signal::TERM)?)
}

#[cfg(not(unix))]
fn ask_to_stop(child: &mut Child) -> std::io::Result<()> {
    child.kill()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_is_read_from_lines_and_told_as_time_left() {
        let lines = lines_of(
            &b"{\"done\":1,\"total\":4,\"pixels_per_sec\":2,\"secs_left\":7.4}\n{\"error\":\"no\"}\n"[..],
        );
        let line = || serde_json::from_str(&lines.recv().unwrap()).unwrap();
        let Line::Progress(progress) = line() else { panic!("no progress") };
        let ExportStage::Running { share, pace } = stage(&progress) else { panic!("not running") };
        assert_eq!((share, pace.as_str()), (0.25, "7 s left"));
        assert!(matches!(line(), Line::Error { error } if error == "no"));
        assert!(lines.recv().is_err());
        let long = Progress { done: 0, total: 0, secs_left: 3600.0 };
        assert_eq!(stage(&long), ExportStage::Running { share: 0.0, pace: "60 min left".into() });
    }
}
