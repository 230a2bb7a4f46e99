//! Frames as numbered pictures. Each is a PNG that carries its scene, with a JSON file beside it; a
//! manifest follows once all are there.
//!
//! Each frame's JSON file is written before its picture. A numbered picture without one, or without
//! a scene, therefore comes from another program, and a folder that holds such a picture is refused
//! before anything is computed. So is a folder in which a frame is write-protected or a link, since
//! a link's target is not the film's.

use std::fs;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::output::{
    Destination, PngError, PngWriter, SafeFile, carries_scene, open_plain, read_plain, read_text,
    sha256,
};
use flipmap_scene::film::{Film, Shot};
use flipmap_scene::palette::budget_range_secs;
use flipmap_scene::{Document, Scene, location};

/// An error that kept a frame from being written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {path}")]
pub struct FrameError {
    path: PathBuf,
    source: PngError,
}

/// The contents of the JSON file beside a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Sidecar {
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

#[derive(Serialize, Deserialize)]
struct Manifest {
    format: u32,
    frames: u32,
    fps: f64,
    size: [u32; 2],
    /// The numbered pictures, in order.
    pictures: Vec<Sidecar>,
}

/// Largest size of a picture's file in bytes: that of the largest frame, uncompressed.
const MAX_PICTURE_BYTES: u64 = 2 << 30;
/// Name of the manifest's file.
const MANIFEST: &str = "manifest.json";

/// A folder of frames.
pub struct Frames {
    folder: PathBuf,
    size: [u32; 2],
    fps: f64,
    /// Colours and run settings of all frames; its scene does not matter.
    document: Document,
    done: Vec<Sidecar>,
}

impl Frames {
    /// Opens a folder, creating it if necessary. The document says how all frames are painted.
    pub(crate) fn open(
        folder: &Path,
        film: &Film,
        document: &Document,
    ) -> Result<Self, FrameError> {
        Self::check(folder)
            .map_err(|source| FrameError { path: folder.to_path_buf(), source: source.into() })?;
        Ok(Frames {
            folder: folder.to_path_buf(),
            size: film.size,
            fps: film.fps,
            document: document.clone(),
            done: Vec::new(),
        })
    }

    /// Returns true for the name of a frame or of its JSON file.
    pub fn are_named(name: &str) -> bool {
        let stem = name.strip_suffix(".png").or_else(|| name.strip_suffix(".json"));
        stem.is_some_and(|stem| stem.len() >= 6 && stem.bytes().all(|byte| byte.is_ascii_digit()))
    }

    /// Creates a folder if necessary. Refuses a folder that cannot be written to, and one in which
    /// a file with the name of a frame or of the manifest is foreign or write-protected.
    pub fn check(folder: &Path) -> io::Result<()> {
        fs::create_dir_all(folder)?;
        tempfile::tempfile_in(folder)?;
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if let Some(why) = objection(&path) {
                let name = path.file_name().unwrap_or_default().display();
                return Err(io::Error::other(format!("it holds {name}, {why}")));
            }
        }
        Ok(())
    }

    /// Returns true if a frame's files are there, complete and up to date, and then counts it as
    /// done.
    pub(crate) fn has(&mut self, frame: u32, shot: &Shot) -> bool {
        let [png, json] = self.paths(frame);
        let Some(beside) = Sidecar::read(&json) else { return false };
        let Ok(picture) = read_plain(&png, MAX_PICTURE_BYTES) else { return false };
        let same = beside == self.beside(frame, shot, &picture);
        if same {
            self.done.push(beside);
        }
        same
    }

    /// Writes a frame and the JSON file beside it.
    pub(crate) fn write(&mut self, frame: u32, shot: &Shot, rgb: &[u8]) -> Result<(), FrameError> {
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
        // An earlier film's manifest does not describe this one.
        remove(&self.folder.join(MANIFEST))?;
        put(&json, text.as_bytes()).map_err(failed(&json))?;
        put(&png, &picture).map_err(failed(&png))?;
        self.done.push(beside);
        Ok(())
    }

    /// Writes the manifest, which says that all frames are there.
    pub(crate) fn finish(self) -> Result<(), FrameError> {
        let Frames { folder, size, fps, mut done, .. } = self;
        // Frames that were there already came first.
        done.sort_by_key(|beside| beside.frame);
        let frames = done.len() as u32;
        let manifest = Manifest { format: 1, frames, fps, size, pictures: done };
        let text = serde_json::to_string_pretty(&manifest).expect("plain fields are JSON") + "\n";
        remove_from(&folder, frames)?;
        let path = folder.join(MANIFEST);
        put(&path, text.as_bytes()).map_err(|source| FrameError { path, source })
    }

    fn paths(&self, frame: u32) -> [PathBuf; 2] {
        ["png", "json"].map(|ending| self.folder.join(format!("{frame:06}.{ending}")))
    }

    /// Returns the document of a frame. Its times are written out: a still would otherwise spread
    /// its colours over its own.
    fn document_of(&self, shot: &Shot) -> Document {
        let mut document = self.document.clone().with_scene(shot.scene.clone());
        let Scene { build, question, .. } = &shot.scene;
        let picture = &mut document.picture;
        if picture.times.is_empty() && picture.paints_times(question.ask) {
            picture.times = budget_range_secs(build.unit_secs(), question.budget.secs).to_vec();
        }
        document
    }

    fn beside(&self, frame: u32, shot: &Shot, picture: &[u8]) -> Sidecar {
        Sidecar {
            frame,
            secs: f64::from(frame) / self.fps,
            location: location::text(&shot.scene),
            clock: shot.clock_secs,
            scene_sha256: sha256(self.document_of(shot).text().as_bytes()),
            png_sha256: sha256(picture),
        }
    }
}

impl Sidecar {
    /// Reads a frame's JSON file; returns `None` if it is not one.
    fn read(json: &Path) -> Option<Sidecar> {
        serde_json::from_str(&read_text(json).ok()?).ok()
    }
}

/// Returns the reason why a file with the name of a frame or of the manifest cannot be replaced;
/// `None` if it can, or if it has another name.
fn objection(path: &Path) -> Option<&'static str> {
    let name = path.file_name()?.to_str()?;
    let is_ours = match name {
        MANIFEST => is_manifest,
        _ if Frames::are_named(name) => is_frame,
        _ => return None,
    };
    let found = path.symlink_metadata().ok()?;
    // A pipe or a folder would take no frame, and a link leads to a file that is not the film's.
    if !found.is_file() || !is_ours(path) {
        return Some("which is not a frame of a film by flipmap: name another folder");
    }
    let protected = found.permissions().readonly();
    protected.then_some("which is write-protected: remove it, or name another folder")
}

/// Returns true if a file is a manifest.
fn is_manifest(path: &Path) -> bool {
    read_text(path).is_ok_and(|text| serde_json::from_str::<Manifest>(&text).is_ok())
}

/// Returns true if a file is a frame, or the JSON file beside one.
fn is_frame(path: &Path) -> bool {
    let is_picture = |path: &Path| open_plain(path).is_ok_and(|f| carries_scene(BufReader::new(f)));
    let is_json = path.extension().is_some_and(|ending| ending == "json");
    Sidecar::read(&path.with_extension("json")).is_some() && (is_json || is_picture(path))
}

/// Removes frames of an earlier, longer film, so that players find only this one in the folder.
fn remove_from(folder: &Path, frames: u32) -> Result<(), FrameError> {
    for frame in frames.. {
        let [png, json] = ["png", "json"].map(|ending| folder.join(format!("{frame:06}.{ending}")));
        if Sidecar::read(&json).is_none() || objection(&png).is_some() {
            return Ok(());
        }
        remove(&png)?;
        remove(&json)?;
    }
    Ok(())
}

/// Removes a file if it is there.
fn remove(path: &Path) -> Result<(), FrameError> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(FrameError { path: path.to_path_buf(), source: source.into() })
        }
        _ => Ok(()),
    }
}

fn put(path: &Path, bytes: &[u8]) -> Result<(), PngError> {
    Ok(SafeFile::write_whole(&Destination::from(path), bytes)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::keys::Keys;

    #[test]
    fn a_film_made_again_makes_no_frame_and_has_the_same_manifest() {
        let folder = tempfile::tempdir().unwrap();
        let keys = Keys::parse("[[key]]\nsecs = 0\n[[key]]\nsecs = 1\n").unwrap();
        // Frame times at this rate need all the digits that JSON can hold.
        let film = Film { size: [2, 2], fps: 30.0, frames: 31, keys: keys.keys };
        let made = |missing: Option<u32>| {
            let mut frames = Frames::open(folder.path(), &film, &Document::default()).unwrap();
            let mut new = Vec::new();
            // All frames that exist are looked up before any other is made.
            let (known, unknown): (Vec<u32>, Vec<u32>) =
                (0..film.frames).partition(|frame| Some(*frame) != missing);
            for frame in known.into_iter().chain(unknown) {
                let shot = film.shot(frame);
                if !frames.has(frame, &shot) {
                    frames.write(frame, &shot, &[frame as u8; 12]).unwrap();
                    new.push(frame);
                }
            }
            frames.finish().unwrap();
            (new, fs::read_to_string(folder.path().join(MANIFEST)).unwrap())
        };
        let (new, manifest) = made(None);
        assert_eq!(new.len(), 31);
        assert_eq!(made(None), (Vec::new(), manifest.clone()));
        fs::remove_file(folder.path().join("000007.png")).unwrap();
        assert_eq!(made(Some(7)), (vec![7], manifest));
    }

    #[test]
    fn pipes_under_the_names_of_frames_are_not_waited_for() {
        for name in ["000000.json", "000000.png", MANIFEST] {
            let folder = tempfile::tempdir().unwrap();
            let pipe = folder.path().join(name);
            assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
            let error = Frames::check(folder.path()).unwrap_err().to_string();
            assert!(error.contains(name), "{error}");
        }
    }

    #[test]
    fn a_manifest_describes_the_frames_that_are_there() {
        let folder = tempfile::tempdir().unwrap();
        let keys = Keys::parse("[[key]]\nsecs = 0\n[[key]]\nsecs = 1\n").unwrap();
        let film = Film { size: [4, 3], fps: 1.0, frames: 1, keys: keys.keys };
        let open = || Frames::open(folder.path(), &film, &Document::default()).unwrap();
        let (rgb, shot) = ([7; 36], film.shot(0));
        let mut frames = open();
        frames.write(0, &shot, &rgb).unwrap();
        frames.finish().unwrap();
        assert!(folder.path().join(MANIFEST).exists());
        let mut again = open();
        assert!(again.has(0, &shot), "what is there is not made again");
        again.write(0, &shot, &[9; 36]).unwrap();
        assert!(!folder.path().join(MANIFEST).exists(), "it says how the frames were");
        drop(again);
        fs::remove_file(folder.path().join("000000.json")).unwrap();
        let refused = Frames::open(folder.path(), &film, &Document::default());
        assert!(refused.is_err_and(|error| error.to_string().contains("cannot write")));
    }
}
