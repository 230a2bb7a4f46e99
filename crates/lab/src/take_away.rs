//! What can be taken away from a figure: a picture, a film of its motion, and its data.

use std::io;
use std::ops::RangeInclusive;
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
    Film(Codec),
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

/// Frames per second of a film, unless the user says otherwise.
pub const FPS: f64 = 25.0;

/// Returns the range of a film's frames per second. A figure catches up with a quarter of a second at
/// most between two frames, and players show the frames of a GIF no faster than 50 a second.
pub fn fps_range(codec: Codec) -> RangeInclusive<f64> {
    match codec {
        Codec::Gif => 4.0..=50.0,
        Codec::Mp4 | Codec::Ffv1 | Codec::WebP => 4.0..=60.0,
    }
}

/// How large, how long and how smooth what is taken away is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Width and height of pictures and films in pixels.
    pub size_px: [u32; 2],
    /// Length of films and data in s, from the figure's start.
    pub secs: f64,
    /// Frames of a film per second.
    pub fps: f64,
}

impl TakeAway {
    /// All kinds, in the order of buttons.
    pub const ALL: [TakeAway; 4] = [
        TakeAway::Picture,
        TakeAway::Film(Codec::Gif),
        TakeAway::Film(Codec::WebP),
        TakeAway::Data,
    ];

    /// Returns the name of the kind.
    pub fn name(self) -> &'static str {
        match self {
            TakeAway::Picture => "Picture",
            TakeAway::Film(Codec::Mp4) => "MP4 film",
            TakeAway::Film(Codec::Ffv1) => "FFV1 film",
            TakeAway::Film(Codec::Gif) => "GIF film",
            TakeAway::Film(Codec::WebP) => "WebP film",
            TakeAway::Data => "Data",
        }
    }

    /// Returns the usual ending of its files.
    pub fn ending(self) -> &'static str {
        match self {
            TakeAway::Picture => "png",
            TakeAway::Film(Codec::Mp4) => "mp4",
            TakeAway::Film(Codec::Ffv1) => "mkv",
            TakeAway::Film(Codec::Gif) => "gif",
            TakeAway::Film(Codec::WebP) => "webp",
            TakeAway::Data => "csv",
        }
    }

    /// Writes the figure that is shown to a file: the picture of its present moment, or the film or
    /// the data of its first seconds.
    pub fn write(self, lab: &mut Lab, path: &Path, extent: Extent) -> Result<(), TakeAwayError> {
        match self {
            TakeAway::Picture => {
                let mut painter = StillPainter::new(extent.size_px, Theme::Dark)?;
                Ok(write_still(&painter.paint(|ui| lab.show_alone(ui))?, path)?)
            }
            TakeAway::Film(codec) => write_film(lab, path, codec, extent),
            TakeAway::Data => {
                let data = lab.live().map_or(String::new(), |live| live.csv(extent.secs));
                Ok(SafeFile::write_whole(&Destination::from(path), data.as_bytes())?)
            }
        }
    }
}

/// Writes a picture in the format that its ending names.
pub fn write_still(still: &Still, path: &Path) -> io::Result<()> {
    let mut picture = PictureFile::create(path, still.size, None)?;
    picture.write(&still.rgb)?;
    picture.complete()?.finish()
}

fn write_film(
    lab: &mut Lab,
    path: &Path,
    codec: Codec,
    extent: Extent,
) -> Result<(), TakeAwayError> {
    let Extent { size_px: size, secs, fps } = extent;
    Encoder::check_place(path)?;
    let frames = FrameFormat { size, fps };
    let encoding = tried(codec, FilmQuality::default(), frames, path)?;
    let mut painter = StillPainter::new(size, Theme::Dark)?;
    let mut encoder = Encoder::start(&encoding, frames, path)?;
    if let Some(live) = lab.live() {
        live.restart();
    }
    for _ in 0..=(secs * fps).round() as u32 {
        let still = painter.paint(|ui| lab.show_alone(ui))?;
        encoder.write(&still.rgb)?;
        if let Some(live) = lab.live() {
            live.advance(1.0 / fps);
        }
    }
    Ok(encoder.finish()?)
}
