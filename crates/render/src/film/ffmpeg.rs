//! Films as one file, encoded by ffmpeg: a child process that is fed raw frames.
//!
//! ffmpeg writes to a temporary file beside the destination, which is renamed when the film is
//! complete. Its flags keep dates, versions and thread counts out of the file, so equal frames give
//! equal files.

use std::ffi::OsString;
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, Command, Stdio};
use std::thread::JoinHandle;

use crate::output::{Destination, SafeFile};
use flipmap_scene::SceneError;
use flipmap_scene::film::Film;

/// Codec of a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Codec {
    /// H.264 in an `.mp4`, which anyone can play.
    H264,
    /// FFV1 in an `.mkv`, without loss.
    Ffv1,
    /// A `.gif` that repeats, with 256 colours for each frame.
    Gif,
    /// An animated `.webp` that repeats.
    WebP,
}

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
    Codec(&'static str, &'static str),
    /// A size that the codec does not take.
    #[error("{0}")]
    Size(#[from] SceneError),
    /// A failure of ffmpeg, in its own words.
    #[error("ffmpeg failed: {0}")]
    Failed(String),
    /// A file that could not be created or renamed.
    #[error("cannot write {path}")]
    File {
        /// Path of the film.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
}

impl Codec {
    /// Returns the codec for the extension of a film's name.
    pub fn of(path: &Path) -> Option<Codec> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "mp4" => Some(Codec::H264),
            "mkv" => Some(Codec::Ffv1),
            "gif" => Some(Codec::Gif),
            "webp" => Some(Codec::WebP),
            _ => None,
        }
    }

    fn encoder(self) -> &'static str {
        match self {
            Codec::H264 => "libx264",
            Codec::Ffv1 => "ffv1",
            Codec::Gif => "gif",
            Codec::WebP => "libwebp",
        }
    }

    fn instead(self) -> &'static str {
        match self {
            Codec::H264 => "an .mkv or a folder of numbered pictures",
            Codec::Ffv1 | Codec::Gif | Codec::WebP => "an .mp4 or a folder of numbered pictures",
        }
    }

    /// Name of the container, which the temporary file's name does not reveal.
    fn container(self) -> &'static str {
        match self {
            Codec::H264 => "mp4",
            Codec::Ffv1 => "matroska",
            Codec::Gif => "gif",
            Codec::WebP => "webp",
        }
    }

    fn options(self) -> &'static str {
        match self {
            Codec::H264 => {
                "-vf scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int,\
                 format=yuv420p -c:v libx264 -preset medium -crf 16 -threads 4 -colorspace bt709 \
                 -color_primaries bt709 -color_trc bt709 -movflags +faststart"
            }
            Codec::Ffv1 => "-c:v ffv1 -pix_fmt bgr0 -level 3 -g 1 -slices 4 -slicecrc 1",
            // A palette for each frame: one for all of them would keep the whole film in memory.
            Codec::Gif => {
                "-vf split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=new=1 \
                 -c:v gif -loop 0"
            }
            // Every frame is whole: differences between frames leave blocks behind in smooth areas.
            Codec::WebP => "-c:v libwebp -pix_fmt yuv420p -quality 90 -loop 0",
        }
    }

    /// Refuses a film that ffmpeg could not encode, before anything is computed.
    pub fn check(self, size: [u32; 2]) -> Result<(), FfmpegError> {
        let refuse = |allowed: &str| {
            let value = format!("{}x{}", size[0], size[1]);
            Err(SceneError::new("size", value, allowed).into())
        };
        if size.contains(&1) {
            return refuse("a film needs 2 pixels a side or more, a folder takes any");
        }
        if self == Codec::H264 && size.iter().any(|side| side % 2 == 1) {
            let [width, height] = size.map(|side| side.next_multiple_of(2));
            return refuse(&format!(
                "an .mp4 needs even sides, such as {width}x{height}; .mkv takes any"
            ));
        }
        let listed = Command::new("ffmpeg")
            .args(["-hide_banner", "-encoders"])
            .stdin(Stdio::null())
            .output()
            .map_err(FfmpegError::Missing)?;
        let listed = String::from_utf8_lossy(&listed.stdout).into_owned();
        let has = listed.split_whitespace().any(|word| word == self.encoder());
        if has { Ok(()) } else { Err(FfmpegError::Codec(self.encoder(), self.instead())) }
    }
}

/// Returns the arguments with which ffmpeg writes `film` to `to`, reading frames from standard
/// input.
pub fn arguments(codec: Codec, film: &Film, to: &Path) -> Vec<OsString> {
    let [width, height] = film.size;
    let text = format!(
        "-hide_banner -loglevel error -y -f rawvideo -pixel_format rgb24 \
         -video_size {width}x{height} -framerate {} -i pipe:0 -an {} -map_metadata -1 \
         -fflags +bitexact -flags:v +bitexact -f {}",
        film.fps,
        codec.options(),
        codec.container()
    );
    let words = text.split_whitespace().map(OsString::from);
    words.chain([to.as_os_str().to_owned()]).collect()
}

/// A film being encoded; dropping it unfinished leaves no file.
pub struct Encoder {
    child: Child,
    errors: Option<JoinHandle<Vec<String>>>,
    file: Option<SafeFile>,
    path: PathBuf,
}

fn no_plain_file() -> io::Error {
    io::Error::other("ffmpeg has to seek in it: name a plain file")
}

/// Number of ffmpeg's last lines that are shown when it fails.
const LAST_LINES: usize = 5;

impl Encoder {
    /// Refuses pipes and devices.
    pub(crate) fn check_place(path: &Path) -> io::Result<()> {
        let is_plain = !path.exists() || path.is_file() || path.is_dir();
        if is_plain { Ok(()) } else { Err(no_plain_file()) }
    }

    /// Starts ffmpeg.
    pub(crate) fn start(codec: Codec, film: &Film, path: &Path) -> Result<Self, FfmpegError> {
        let unwritable = |source| FfmpegError::File { path: path.to_path_buf(), source };
        let file = SafeFile::create(&Destination::from(path)).map_err(unwritable)?;
        let beside = file.beside().ok_or_else(|| unwritable(no_plain_file()))?;
        let mut child = Command::new("ffmpeg")
            .args(arguments(codec, film, beside))
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(FfmpegError::Missing)?;
        let errors = child.stderr.take().map(|stderr| std::thread::spawn(|| last_lines(stderr)));
        Ok(Encoder { child, errors, file: Some(file), path: path.to_path_buf() })
    }

    /// Passes a frame on to ffmpeg.
    pub(crate) fn write(&mut self, rgb: &[u8]) -> Result<(), FfmpegError> {
        let Some(stdin) = &mut self.child.stdin else { return Ok(()) };
        if stdin.write_all(rgb).is_ok() {
            return Ok(());
        }
        // ffmpeg has stopped reading, and its messages say why.
        Err(self.failure())
    }

    /// Waits until ffmpeg is done, and renames the film to its destination.
    pub(crate) fn finish(mut self) -> Result<(), FfmpegError> {
        drop(self.child.stdin.take());
        let status = self.child.wait();
        let lines = self.last_lines();
        // On a full disk ffmpeg may complain and still exit as if all were well.
        if !lines.is_empty() || !status.is_ok_and(|status| status.success()) {
            return Err(failed(lines, "it ended early"));
        }
        let file = self.file.take().expect("it is taken only here");
        let path = self.path.clone();
        file.finish().map_err(|source| FfmpegError::File { path, source })
    }

    fn last_lines(&mut self) -> Vec<String> {
        self.errors.take().and_then(|thread| thread.join().ok()).unwrap_or_default()
    }

    fn failure(&mut self) -> FfmpegError {
        drop(self.child.stdin.take());
        let ended = self.child.wait().map_or_else(|error| error.to_string(), |it| it.to_string());
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
