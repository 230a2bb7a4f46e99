//! A film that ffmpeg encodes as its frames come.

use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr};
use std::thread::JoinHandle;

use super::count::frames_in;
use super::{Codec, Encoding, FfmpegError, FrameFormat, spawned};
use crate::output::{Destination, SafeFile};

/// A film being encoded; dropping it unfinished leaves no file.
pub struct Encoder {
    child: Child,
    errors: Option<JoinHandle<Vec<String>>>,
    file: Option<SafeFile>,
    path: PathBuf,
    codec: Codec,
    frames: u64,
}

fn no_plain_file() -> io::Error {
    io::Error::other("ffmpeg has to seek in it: name a plain file")
}

/// Number of ffmpeg's last lines that are shown when it fails.
const LAST_LINES: usize = 5;

impl Encoder {
    /// Refuses pipes and devices.
    pub fn check_place(path: &Path) -> io::Result<()> {
        let is_plain = !path.exists() || path.is_file() || path.is_dir();
        if is_plain { Ok(()) } else { Err(no_plain_file()) }
    }

    /// Starts ffmpeg.
    pub fn start(
        encoding: &Encoding,
        frames: FrameFormat,
        path: &Path,
    ) -> Result<Self, FfmpegError> {
        let unwritable = |source| FfmpegError::File { path: path.to_path_buf(), source };
        let file = SafeFile::create(&Destination::from(path)).map_err(unwritable)?;
        let beside = file.beside().ok_or_else(|| unwritable(no_plain_file()))?;
        let mut child = spawned(encoding, frames, beside)?;
        let errors = child.stderr.take().map(|stderr| std::thread::spawn(|| last_lines(stderr)));
        Ok(Encoder {
            child,
            errors,
            file: Some(file),
            path: path.to_path_buf(),
            codec: encoding.codec,
            frames: 0,
        })
    }

    /// Passes a frame on to ffmpeg.
    pub fn write(&mut self, rgb: &[u8]) -> Result<(), FfmpegError> {
        let Some(stdin) = &mut self.child.stdin else { return Ok(()) };
        self.frames += 1;
        if stdin.write_all(rgb).is_ok() {
            return Ok(());
        }
        // ffmpeg has stopped reading, and its messages say why.
        Err(self.failure())
    }

    /// Waits until ffmpeg is done, counts the frames of the film, and renames it to its destination.
    pub fn finish(mut self) -> Result<(), FfmpegError> {
        drop(self.child.stdin.take());
        let status = self.child.wait();
        let lines = self.last_lines();
        if !status.is_ok_and(|status| status.success()) {
            return Err(failed(lines, "it ended early"));
        }
        let file = self.file.take().expect("it is taken only here");
        if let Some(beside) = file.beside() {
            // On a full disk ffmpeg may complain and still exit as if all were well; it may also
            // complain of what does no harm.
            let given = self.frames;
            let counted = frames_in(self.codec, beside).and_then(|found| {
                if found == given { Ok(()) } else { Err(FfmpegError::Frames { given, found }) }
            });
            counted.map_err(|why| match lines[..] {
                [] => why,
                _ => failed(lines, "it ended early"),
            })?;
        }
        let path = self.path.clone();
        file.finish().map_err(|source| FfmpegError::File { path, source })
    }

    fn last_lines(&mut self) -> Vec<String> {
        self.errors.take().and_then(|thread| thread.join().ok()).unwrap_or_default()
    }

    fn failure(&mut self) -> FfmpegError {
        drop(self.child.stdin.take());
        let ended = match self.child.wait() {
            Ok(status) if status.success() => "it ended before it had all frames".to_string(),
            Ok(status) => status.to_string(),
            Err(error) => error.to_string(),
        };
        failed(self.last_lines(), &ended)
    }
}

fn failed(lines: Vec<String>, ended: &str) -> FfmpegError {
    FfmpegError::Failed(if lines.is_empty() { ended.to_string() } else { lines.join("; ") })
}

impl Drop for Encoder {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn last_lines(stderr: ChildStderr) -> Vec<String> {
    let mut last = Vec::new();
    for line in BufReader::new(stderr).lines().map_while(Result::ok) {
        last.push(line);
        if last.len() > LAST_LINES {
            last.remove(0);
        }
    }
    last
}
