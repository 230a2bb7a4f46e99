//! Counts the frames of a finished film.

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;
use std::process::{Command, Stdio};

use super::{Codec, FfmpegError};

/// Returns the number of frames in a film.
pub(super) fn frames_in(codec: Codec, path: &Path) -> Result<u64, FfmpegError> {
    match codec {
        // ffmpeg reads no animated WebP.
        Codec::WebP => {
            File::open(path).and_then(|file| animated_frames(BufReader::new(file))).map_err(|why| {
                FfmpegError::Failed(format!("the film that it wrote cannot be read: {why}"))
            })
        }
        _ => packets(path),
    }
}

/// Counts the packets of the film's pictures; one holds a frame.
fn packets(path: &Path) -> Result<u64, FfmpegError> {
    let mut file = OsString::from("file:");
    file.push(path);
    let output = Command::new("ffmpeg")
        .args(["-hide_banner", "-loglevel", "error", "-i"])
        .arg(file)
        .args(["-map", "0:v:0", "-c", "copy", "-f", "framecrc", "pipe:1"])
        .stdin(Stdio::null())
        .output()
        .map_err(FfmpegError::Missing)?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr).trim().replace('\n', "; ");
        let why = if said.is_empty() { output.status.to_string() } else { said };
        return Err(FfmpegError::Failed(format!("the film that it wrote cannot be read: {why}")));
    }
    // A packet's line begins with the number of its stream, which is the only one.
    let lines = output.stdout.split(|byte| *byte == b'\n');
    Ok(lines.filter(|line| line.starts_with(b"0,")).count() as u64)
}

/// Counts the frames of a WebP: its chunks ANMF, or one picture (WebP container specification).
fn animated_frames(mut file: impl Read + Seek) -> io::Result<u64> {
    let mut head = [0; 12];
    file.read_exact(&mut head)?;
    if &head[..4] != b"RIFF" || &head[8..] != b"WEBP" {
        return Err(io::Error::other("it is no WebP"));
    }
    let mut frames = 0;
    let mut is_still = false;
    let mut chunk = [0; 8];
    while file.read_exact(&mut chunk).is_ok() {
        let [a, b, c, d] = [chunk[4], chunk[5], chunk[6], chunk[7]];
        let length = i64::from(u32::from_le_bytes([a, b, c, d]));
        frames += u64::from(&chunk[..4] == b"ANMF");
        is_still |= chunk.starts_with(b"VP8 ") || chunk.starts_with(b"VP8L");
        // Chunks have even lengths.
        file.seek(SeekFrom::Current(length + length % 2))?;
    }
    Ok(if frames == 0 && is_still { 1 } else { frames })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn frames_of_a_webp_are_its_chunks() {
        let chunk = |name: &[u8; 4], length: u32| {
            let bytes = vec![7; (length + length % 2) as usize];
            [&name[..], &length.to_le_bytes(), &bytes].concat()
        };
        let film = |chunks: &[Vec<u8>]| {
            let body = chunks.concat();
            [b"RIFF\x00\x00\x00\x00WEBP", &body[..]].concat()
        };
        let count = |chunks: &[Vec<u8>]| animated_frames(Cursor::new(film(chunks))).unwrap();
        assert_eq!(count(&[chunk(b"VP8X", 10), chunk(b"ANMF", 5), chunk(b"ANMF", 8)]), 2);
        assert_eq!(count(&[chunk(b"VP8 ", 3)]), 1);
        assert_eq!(count(&[chunk(b"VP8X", 10)]), 0);
        assert!(animated_frames(Cursor::new(b"GIF89a......".to_vec())).is_err());
    }
}
