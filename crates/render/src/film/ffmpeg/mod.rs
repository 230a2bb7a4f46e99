//! Films as one file, encoded by ffmpeg: a child process that is fed raw frames.
//!
//! The encoder is tried on one frame before anything is computed. ffmpeg writes to a temporary file
//! beside the destination, which is opened again, its frames counted, and renamed. Its flags keep
//! dates, versions and thread counts out of the file, so equal frames give equal files.

mod codec;
mod count;
mod encoder;
mod trial;

use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

pub use codec::{Codec, Encoding, FilmQuality};
pub use encoder::Encoder;
pub use trial::tried;

use flipmap_scene::SceneError;
use flipmap_scene::film::Film;

/// Reasons why there is no film.
#[derive(Debug, thiserror::Error)]
pub enum FfmpegError {
    /// The program ffmpeg cannot be run.
    #[error(
        "cannot run ffmpeg ({0}); on Debian or Ubuntu: apt-get install ffmpeg, or name a folder \
         for numbered pictures, which need nothing"
    )]
    Missing(io::Error),
    /// An ffmpeg that was built without the codec.
    #[error("this ffmpeg has no encoder {0}; install one that has, or write {1}")]
    Codec(String, &'static str),
    /// An ffmpeg that could not encode the frame that was tried.
    #[error("ffmpeg failed on a first frame, before anything was computed: {0}")]
    Trial(String),
    /// A size that the codec does not take.
    #[error("{0}")]
    Size(#[from] SceneError),
    /// A failure of ffmpeg, in its own words.
    #[error("ffmpeg failed: {0}")]
    Failed(String),
    /// A film that has other frames than were written.
    #[error("ffmpeg was given {given} frames, and the film that it wrote has {found}")]
    Frames {
        /// Number of frames that were written.
        given: u64,
        /// Number of frames in the file.
        found: u64,
    },
    /// A file that could not be created or renamed.
    #[error("cannot write {path}")]
    File {
        /// Path of the film.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
}

/// The frames of a film as they come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameFormat {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Number of frames per second.
    pub fps: f64,
}

impl From<&Film> for FrameFormat {
    fn from(film: &Film) -> Self {
        FrameFormat { size: film.size, fps: film.fps }
    }
}

/// Starts ffmpeg, which reads frames from its standard input and says what fails on standard error.
fn spawned(encoding: &Encoding, frames: FrameFormat, to: &Path) -> Result<Child, FfmpegError> {
    Command::new("ffmpeg")
        .args(arguments(encoding, frames, to))
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(FfmpegError::Missing)
}

/// Returns the arguments with which ffmpeg writes a film to `to`, reading frames from standard
/// input.
pub fn arguments(encoding: &Encoding, frames: FrameFormat, to: &Path) -> Vec<OsString> {
    let [width, height] = frames.size;
    let text = format!(
        "-hide_banner -loglevel error -y -f rawvideo -pixel_format rgb24 \
         -video_size {width}x{height} -framerate {} -i pipe:0 -an {} -map_metadata -1 \
         -fflags +bitexact -flags:v +bitexact -f {}",
        frames.fps,
        encoding.options(frames.size),
        encoding.codec.container()
    );
    let words = text.split_whitespace().map(OsString::from);
    // A name with a colon would be taken for an address.
    let mut file = OsString::from("file:");
    file.push(to);
    words.chain([file]).collect()
}
