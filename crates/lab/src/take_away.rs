//! What can be taken away from a figure: a picture, a film of its motion, and its data.

use std::io;
use std::path::Path;

use egui::Theme;

use super::Lab;
use super::still::{Still, StillPainter};
use flipmap_engine::EngineError;
use flipmap_render::film::ffmpeg::{Codec, Encoder, FfmpegError, FilmQuality, FrameFormat, tried};
use flipmap_render::output::{Destination, PictureFile, SafeFile};

/// A kind of file that a figure is written to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TakeAway {
    /// The figure at its present moment, without controls.
    Picture,
    /// Its motion from the start, without controls.
    Film,
    /// Its data from the start, as CSV.
    Data,
}

/// Reasons why a figure cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum TakeAwayError {
    /// No adapter to draw on, or a failure of it.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The program ffmpeg cannot be run.
    #[error(
        "a film needs ffmpeg, which cannot be run ({0}); on Debian or Ubuntu: apt-get install ffmpeg"
    )]
    NoFfmpeg(io::Error),
    /// A failure of ffmpeg.
    #[error(transparent)]
    Ffmpeg(FfmpegError),
    /// A file that cannot be written.
    #[error(transparent)]
    File(#[from] io::Error),
}

impl From<FfmpegError> for TakeAwayError {
    fn from(error: FfmpegError) -> Self {
        match error {
            FfmpegError::Missing(why) => TakeAwayError::NoFfmpeg(why),
            error => TakeAwayError::Ffmpeg(error),
        }
    }
}

/// Endings of films; a .webp is a picture.
pub const FILMS: &[&str] = &["gif", "mp4", "mkv"];
/// Frames of a film per second.
const FPS: f64 = 25.0;

impl TakeAway {
    /// All kinds, in the order of buttons.
    pub const ALL: [TakeAway; 3] = [TakeAway::Picture, TakeAway::Film, TakeAway::Data];

    /// Returns the name of the kind.
    pub fn name(self) -> &'static str {
        match self {
            TakeAway::Picture => "Picture",
            TakeAway::Film => "Film",
            TakeAway::Data => "Data",
        }
    }

    /// Returns the usual ending of its files.
    pub fn ending(self) -> &'static str {
        match self {
            TakeAway::Picture => "png",
            TakeAway::Film => "gif",
            TakeAway::Data => "csv",
        }
    }

    /// Writes the figure that is shown to a file: the picture of its present moment, or the film or
    /// the data of its first `secs`. Pictures and films are `size` pixels large.
    pub fn write(
        self,
        lab: &mut Lab,
        path: &Path,
        size: [u32; 2],
        secs: f64,
    ) -> Result<(), TakeAwayError> {
        match self {
            TakeAway::Picture => {
                let still = StillPainter::new(size, Theme::Dark)?.paint(|ui| lab.show_alone(ui))?;
                Ok(write_still(&still, path)?)
            }
            TakeAway::Film => write_film(lab, path, size, secs),
            TakeAway::Data => {
                let data = lab.live().map_or(String::new(), |live| live.csv(secs));
                Ok(SafeFile::write_whole(&Destination::from(path), data.as_bytes())?)
            }
        }
    }
}

/// Returns the codec of a film by its name, or `None` if it is not among [`FILMS`].
pub fn film_codec(path: &Path) -> Option<Codec> {
    Codec::of(path).filter(|codec| *codec != Codec::WebP)
}

/// Writes a picture in the format that its ending names.
pub fn write_still(still: &Still, path: &Path) -> io::Result<()> {
    let mut picture = PictureFile::create(path, still.size, None)?;
    picture.write(&still.rgb)?;
    picture.complete()?.finish()
}

fn write_film(lab: &mut Lab, path: &Path, size: [u32; 2], secs: f64) -> Result<(), TakeAwayError> {
    let no_film = || io::Error::other(format!("a film is a .{}", FILMS.join(", .")));
    let codec = film_codec(path).ok_or_else(no_film)?;
    Encoder::check_place(path)?;
    let frames = FrameFormat { size, fps: FPS };
    let encoding = tried(codec, FilmQuality::default(), frames, path)?;
    let mut painter = StillPainter::new(size, Theme::Dark)?;
    let mut encoder = Encoder::start(&encoding, frames, path)?;
    if let Some(live) = lab.live() {
        live.restart();
    }
    for _ in 0..=(secs * FPS).round() as u32 {
        let still = painter.paint(|ui| lab.show_alone(ui))?;
        encoder.write(&still.rgb)?;
        if let Some(live) = lab.live() {
            live.advance(1.0 / FPS);
        }
    }
    Ok(encoder.finish()?)
}
