//! The trial of an encoder on one frame: an ffmpeg may list encoders that cannot write, write
//! nothing, or never end.

use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::JoinHandle;
use std::time::Duration;

use super::{Codec, Encoding, FfmpegError, FilmQuality, FrameFormat, spawned};
use crate::output::{Destination, SafeFile};
use flipmap_engine::clock::Instant;

/// Time within which ffmpeg must have encoded a frame.
const PATIENCE: Duration = Duration::from_secs(30);
/// Number of the last characters of ffmpeg's messages that are told.
const TOLD: usize = 300;

/// Returns the first encoder of a codec that writes a frame of the film to a file beside `to`.
pub fn tried(
    codec: Codec,
    quality: FilmQuality,
    frames: FrameFormat,
    to: &Path,
) -> Result<Encoding, FfmpegError> {
    codec.check(frames.size, quality)?;
    let listed = listed_encoders()?;
    let is_listed = |encoder: &str| listed.split_whitespace().any(|word| word == encoder);
    let mut failure = None;
    for encoder in codec.encoders().iter().copied().filter(|encoder| is_listed(encoder)) {
        let encoding = Encoding { codec, encoder, quality };
        match encode_one(&encoding, frames, to) {
            Ok(()) => return Ok(encoding),
            Err(FfmpegError::Trial(why)) => failure = failure.or(Some(why)),
            Err(error) => return Err(error),
        }
    }
    Err(match failure {
        Some(why) => FfmpegError::Trial(why),
        None => FfmpegError::Codec(codec.encoders().join(" or "), codec.instead()),
    })
}

/// Returns what ffmpeg says of its encoders.
fn listed_encoders() -> Result<String, FfmpegError> {
    let mut child = Command::new("ffmpeg")
        .args(["-hide_banner", "-encoders"])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .map_err(FfmpegError::Missing)?;
    let listening = child.stdout.take().map(listened);
    ended(&mut child)?;
    Ok(listening.and_then(|thread| thread.join().ok()).unwrap_or_default())
}

/// Reads all that a child says, on a thread of its own.
fn listened(mut from: impl Read + Send + 'static) -> JoinHandle<String> {
    std::thread::spawn(move || {
        let mut said = Vec::new();
        // What was said until an error is what is known.
        let _ = from.read_to_end(&mut said);
        String::from_utf8_lossy(&said).into_owned()
    })
}

/// Waits until a child has ended; ends one that takes too long.
fn ended(child: &mut Child) -> Result<ExitStatus, FfmpegError> {
    let begun = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return Ok(status),
            Ok(None) if begun.elapsed() < PATIENCE => std::thread::sleep(Duration::from_millis(5)),
            _ => {
                // It may have ended a moment ago.
                let _ = child.kill();
                let _ = child.wait();
                let secs = PATIENCE.as_secs();
                return Err(FfmpegError::Trial(format!("it did not end within {secs} s")));
            }
        }
    }
}

/// Encodes a black frame to a file that is removed again.
fn encode_one(encoding: &Encoding, frames: FrameFormat, to: &Path) -> Result<(), FfmpegError> {
    let unwritable = |source| FfmpegError::File { path: to.to_path_buf(), source };
    let file = SafeFile::create(&Destination::from(to)).map_err(unwritable)?;
    // A pipe or a device has been refused before.
    let Some(beside) = file.beside() else { return Ok(()) };
    let mut child = spawned(encoding, frames, beside)?;
    let bytes = frames.size.map(|side| side as usize).iter().product::<usize>() * 3;
    let stdin = child.stdin.take();
    // It may stop reading; its messages and the file then say why.
    let feeding = std::thread::spawn(move || stdin.map(|mut to| to.write_all(&vec![0; bytes])));
    let listening = child.stderr.take().map(listened);
    let status = ended(&mut child)?;
    drop(feeding.join());
    let said = listening.and_then(|thread| thread.join().ok()).unwrap_or_default();
    let size = beside.metadata().map_or(0, |found| found.len());
    // What else it says, as of libraries without version information, is no failure.
    if status.success() && size > 0 {
        return Ok(());
    }
    let lines: Vec<&str> = said.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    Err(FfmpegError::Trial(match lines[..] {
        [] if status.success() => "it wrote nothing".to_string(),
        [] => format!("it ended early ({status})"),
        _ => lines.join("; ").chars().take(TOLD).collect(),
    }))
}
