//! Where the frames of a film go: numbered pictures in a folder, or a single file.

use std::io;
use std::path::Path;

use super::ffmpeg::{Codec, Encoder, Encoding};
use super::{FilmRenderError, Frames};
use crate::output::{Destination, OutputError, SafeFile};
use flipmap_scene::Document;
use flipmap_scene::film::{Film, Shot};

/// Destination of a film.
pub(super) enum FilmSink {
    /// A folder of numbered pictures.
    Frames(Box<Frames>),
    /// A single file.
    Encoder(Encoder),
}

impl FilmSink {
    /// Refuses a destination that could not be written, before anything is computed.
    pub(super) fn check(path: &Path) -> Result<(), OutputError> {
        let checked = match Codec::of(path) {
            Some(_) => Encoder::check_place(path).and_then(|()| SafeFile::check(&path.into())),
            None => Frames::check(path),
        };
        let name = Destination::File(path.to_path_buf());
        checked.map_err(|source: io::Error| OutputError::Create { setting: "output", name, source })
    }

    /// Opens a file with an encoding, or else a folder. The document says how the film is painted.
    pub(super) fn open(
        path: &Path,
        film: &Film,
        document: &Document,
        encoding: Option<Encoding>,
    ) -> Result<Self, FilmRenderError> {
        Ok(match encoding {
            Some(encoding) => FilmSink::Encoder(Encoder::start(&encoding, film.into(), path)?),
            None => FilmSink::Frames(Box::new(Frames::open(path, film, document)?)),
        })
    }

    /// Returns true if a frame is there, complete and up to date; always false for a single file.
    pub(super) fn has(&mut self, frame: u32, shot: &Shot) -> bool {
        match self {
            FilmSink::Frames(frames) => frames.has(frame, shot),
            FilmSink::Encoder(_) => false,
        }
    }

    /// Writes the next frame.
    pub(super) fn write(
        &mut self,
        frame: u32,
        shot: &Shot,
        rgb: &[u8],
    ) -> Result<(), FilmRenderError> {
        match self {
            FilmSink::Frames(frames) => Ok(frames.write(frame, shot, rgb)?),
            FilmSink::Encoder(encoder) => Ok(encoder.write(rgb)?),
        }
    }

    /// Completes the film.
    pub(super) fn finish(self) -> Result<(), FilmRenderError> {
        match self {
            FilmSink::Frames(frames) => Ok(frames.finish()?),
            FilmSink::Encoder(encoder) => Ok(encoder.finish()?),
        }
    }
}
