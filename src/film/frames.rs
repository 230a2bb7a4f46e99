//! Frames as numbered pictures: each a PNG that carries its scene, with a JSON file beside it, and
//! a manifest once all are there.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::output::{Destination, PngError, PngWriter, SafeFile, sha256};
use crate::scene::film::{Film, Shot};
use crate::scene::{Document, location};

/// An error that kept a frame from being written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {path}")]
pub struct FrameError {
    path: PathBuf,
    source: PngError,
}

/// The contents of the JSON file beside a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Beside {
    /// Number of the frame, from 0.
    frame: u32,
    /// Time of the frame in the film, s.
    secs: f64,
    /// The location that the frame shows, as a line that can be pasted.
    location: String,
    /// Simulated seconds that have passed, if the film has a clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    clock: Option<f64>,
    /// Digest of the text inside the picture: scene, colours and the settings it was computed with.
    scene_sha256: String,
    /// Digest of the PNG file.
    png_sha256: String,
}

#[derive(Serialize)]
struct Manifest<'a> {
    format: u32,
    frames: u32,
    fps: f64,
    size: [u32; 2],
    /// The numbered pictures, in order.
    pictures: &'a [Beside],
}

/// A folder of frames.
pub struct Frames {
    folder: PathBuf,
    size: [u32; 2],
    fps: f64,
    /// Colours and run settings of all frames; its scene does not matter.
    document: Document,
    done: Vec<Beside>,
}

impl Frames {
    /// Opens a folder, creating it if necessary. The document says how all frames are painted.
    pub fn open(folder: &Path, film: &Film, document: &Document) -> Result<Self, FrameError> {
        let refused =
            |source: io::Error| FrameError { path: folder.to_path_buf(), source: source.into() };
        fs::create_dir_all(folder).map_err(refused)?;
        let foreign = folder.join("000000.png").exists() && !folder.join("000000.json").exists();
        if foreign {
            let why = "it holds numbered pictures that are no film of flipmap's: name another";
            return Err(refused(io::Error::other(why)));
        }
        Ok(Frames {
            folder: folder.to_path_buf(),
            size: film.size,
            fps: film.fps,
            document: document.clone(),
            done: Vec::new(),
        })
    }

    /// Returns true if a frame is there, whole and as it should be.
    pub fn has(&mut self, frame: u32, shot: &Shot) -> bool {
        let [png, json] = self.paths(frame);
        let Ok(text) = fs::read_to_string(json) else { return false };
        let Ok(beside) = serde_json::from_str::<Beside>(&text) else { return false };
        let Ok(picture) = fs::read(png) else { return false };
        let same = beside == self.beside(frame, shot, &picture);
        if same {
            self.done.push(beside);
        }
        same
    }

    /// Writes a frame and the JSON file beside it.
    pub fn write(&mut self, frame: u32, shot: &Shot, rgb: &[u8]) -> Result<(), FrameError> {
        let [png, json] = self.paths(frame);
        let failed = |path: &Path| {
            let path = path.to_path_buf();
            move |source| FrameError { path, source }
        };
        let document = self.document_of(shot);
        let encoded = || {
            let mut picture = PngWriter::new(Vec::new(), self.size, &document)?;
            picture.write(rgb)?;
            picture.finish()
        };
        let picture = encoded().map_err(failed(&png))?;
        let beside = self.beside(frame, shot, &picture);
        let text = serde_json::to_string_pretty(&beside).expect("plain fields are JSON") + "\n";
        put(&png, &picture).map_err(failed(&png))?;
        put(&json, text.as_bytes()).map_err(failed(&json))?;
        self.done.push(beside);
        Ok(())
    }

    /// Writes the manifest, which says that all frames are there.
    pub fn finish(self) -> Result<(), FrameError> {
        let Frames { folder, size, fps, done, .. } = self;
        let frames = done.len() as u32;
        let manifest = Manifest { format: 1, frames, fps, size, pictures: &done };
        let text = serde_json::to_string_pretty(&manifest).expect("plain fields are JSON") + "\n";
        remove_from(&folder, frames)?;
        let path = folder.join("manifest.json");
        put(&path, text.as_bytes()).map_err(|source| FrameError { path, source })
    }

    fn paths(&self, frame: u32) -> [PathBuf; 2] {
        ["png", "json"].map(|ending| self.folder.join(format!("{frame:06}.{ending}")))
    }

    fn document_of(&self, shot: &Shot) -> Document {
        self.document.clone().with_scene(shot.scene.clone())
    }

    fn beside(&self, frame: u32, shot: &Shot, picture: &[u8]) -> Beside {
        Beside {
            frame,
            secs: f64::from(frame) / self.fps,
            location: location::text(&shot.scene),
            clock: shot.clock_secs,
            scene_sha256: sha256(self.document_of(shot).text().as_bytes()),
            png_sha256: sha256(picture),
        }
    }
}

/// Removes frames of an earlier, longer film, so that players find only this one in the folder.
fn remove_from(folder: &Path, frames: u32) -> Result<(), FrameError> {
    for frame in frames.. {
        let [png, json] = ["png", "json"].map(|ending| folder.join(format!("{frame:06}.{ending}")));
        if !(png.exists() && json.exists()) {
            return Ok(());
        }
        for path in [png, json] {
            fs::remove_file(&path).map_err(|source| FrameError { path, source: source.into() })?;
        }
    }
    Ok(())
}

fn put(path: &Path, bytes: &[u8]) -> Result<(), PngError> {
    Ok(SafeFile::write_whole(&Destination::from(path), bytes)?)
}
