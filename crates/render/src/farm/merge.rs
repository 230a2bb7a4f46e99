//! Joins parts into the planned output: a still's files, or a film's frames.

use std::io;
use std::path::Path;
use std::sync::Arc;

use super::task::{FrameGroupTask, FrameTask, StillPass, TaskKind};
use super::{PartError, Parts, Task};
use crate::film::ffmpeg::{Codec, Encoder, FfmpegError};
use crate::film::{Colours, FlipWindow, FrameError, FramePainter, Frames, Mip};
use crate::output::{Destination, Legend, OutputError, Paths, RowPainter, SafeFile, Sinks};
use crate::tiles::{PlainPixels, Samples};
use flipmap_pendulum::Status;
use flipmap_scene::film::{Film, Shot};
use flipmap_scene::palette::{AnswerColours, Tones, equalised};
use flipmap_scene::{Document, PictureTable, Sampling, SceneError};

/// Reasons why the parts could not be joined.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// An error of a part.
    #[error(transparent)]
    Part(#[from] PartError),
    /// An error of a still's file.
    #[error("{0}")]
    Output(#[from] OutputError),
    /// An error of a frame.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// An error of the film.
    #[error(transparent)]
    Ffmpeg(#[from] FfmpegError),
    /// A picture that cannot be painted with these settings.
    #[error("{0}")]
    Picture(#[from] SceneError),
    /// An error of the temporary file that holds the colours of a film's patches.
    #[error("cannot keep colours beside the samples, which takes nearly as much room again")]
    Colours(#[from] io::Error),
    /// A request to stop.
    #[error("stopped; what was computed is kept, merge again")]
    Stopped,
}

/// Number of rows that are passed on together.
const ROWS: u32 = 64;

/// Writes a still from its parts. `keep_going` takes the samples done and returns false to stop.
pub fn still(
    document: &Document,
    passes: &[StillPass],
    parts: &mut Parts,
    paths: &Paths,
    keep_going: &mut dyn FnMut(u64) -> bool,
) -> Result<(), MergeError> {
    let size = document.run.size.unwrap_or([1, 1]);
    let mut sinks = Sinks::open(paths, document, size)?;
    let mut done = 0;
    let mut each = |sampling: Sampling,
                    take: &mut dyn FnMut(Samples) -> Result<(), OutputError>| {
        let rows = passes.iter().find(|rows| rows.sampling == sampling).ok_or(PartError::Gone)?;
        let mut row = 0;
        while row < rows.size[1] {
            let samples = some_rows(rows, parts, row)?;
            row += (samples.len() / rows.size[0] as usize) as u32;
            done += samples.len() as u64;
            take(samples)?;
            if !keep_going(done) {
                return Err(MergeError::Stopped);
            }
        }
        Ok(())
    };
    for pass in sinks.passes(document.picture.samples) {
        if pass.sampling == Sampling::Corners {
            let mut middles = Samples::default();
            each(Sampling::SINGLE, &mut |samples| {
                middles.append(samples);
                Ok(())
            })?;
            let colours = AnswerColours::new(&document.scene(), &document.picture)?;
            let plain = PlainPixels::among(middles, size, &colours, pass.sampling);
            sinks.write_middles(&pass, &Arc::new(plain))?;
        }
        each(pass.sampling, &mut |samples| sinks.write(&pass, &samples))?;
    }
    Ok(sinks.finish()?)
}

/// Returns some rows of samples from `row` on; a row that is not computed is read from its mirror
/// image.
fn some_rows(pass: &StillPass, parts: &mut Parts, row: u32) -> Result<Samples, PartError> {
    if row < pass.rows {
        return parts.rows(&pass.of, row, ROWS.min(pass.rows - row));
    }
    parts.rows(&pass.of, pass.size[1] - 1 - row, 1).map(|row| row.image(row.len()))
}

/// Destination of a film.
pub enum FilmSink {
    /// A folder of numbered pictures.
    Frames(Box<Frames>),
    /// A single file.
    Encoder(Encoder),
}

impl FilmSink {
    /// Refuses a destination that could not be written, before anything is computed.
    pub fn check(path: &Path) -> io::Result<()> {
        if Codec::of(path).is_some() {
            Encoder::check_place(path)?;
            return SafeFile::check(&Destination::from(path));
        }
        Frames::check(path)
    }

    /// Opens a destination by its name: a file with a known extension, or else a folder. The
    /// document says how the film is painted.
    pub fn open(path: &Path, film: &Film, document: &Document) -> Result<Self, MergeError> {
        Ok(match Codec::of(path) {
            Some(codec) => FilmSink::Encoder(Encoder::start(codec, film, path)?),
            None => FilmSink::Frames(Box::new(Frames::open(path, film, document)?)),
        })
    }

    /// Returns true if a frame is there, complete and up to date; always false for a single file.
    pub fn has(&mut self, frame: u32, shot: &Shot) -> bool {
        match self {
            FilmSink::Frames(frames) => frames.has(frame, shot),
            FilmSink::Encoder(_) => false,
        }
    }

    /// Writes the next frame.
    pub fn write(&mut self, frame: u32, shot: &Shot, rgb: &[u8]) -> Result<(), MergeError> {
        match self {
            FilmSink::Frames(frames) => Ok(frames.write(frame, shot, rgb)?),
            FilmSink::Encoder(encoder) => Ok(encoder.write(rgb)?),
        }
    }

    /// Completes the film.
    pub fn finish(self) -> Result<(), MergeError> {
        match self {
            FilmSink::Frames(frames) => Ok(frames.finish()?),
            FilmSink::Encoder(encoder) => Ok(encoder.finish()?),
        }
    }
}

/// Paints a film from its parts, with a still for each frame. `keep_going` takes the number of
/// frames done and returns false to stop.
pub fn frames(
    film: &Film,
    frames: &[FrameTask],
    picture: &PictureTable,
    parts: &mut Parts,
    mut sink: FilmSink,
    keep_going: &mut dyn FnMut(u64) -> bool,
) -> Result<(), MergeError> {
    for (number, FrameTask { shot, pass }) in (0..).zip(frames) {
        if sink.has(number, shot) {
            continue;
        }
        let mut painter = RowPainter::new(&shot.scene, film.size, picture)?;
        let (mut rgb, mut row) = (Vec::new(), 0);
        while row < pass.size[1] {
            let samples = some_rows(pass, parts, row)?;
            row += (samples.len() / pass.size[0] as usize) as u32;
            rgb.extend(painter.paint(&samples));
        }
        sink.write(number, shot, &rgb)?;
        if !keep_going(u64::from(number) + 1) {
            return Err(MergeError::Stopped);
        }
    }
    sink.finish()
}

/// Consecutive frames of a group that show the same flips.
struct EqualFrames {
    shown: FlipWindow,
    frames: Vec<(u32, Shot)>,
}

/// Paints a film from its parts. `keep_going` takes the number of frames done and returns false to
/// stop.
pub fn film(
    task: &Task,
    picture: &PictureTable,
    parts: &mut Parts,
    mut sink: FilmSink,
    keep_going: &mut dyn FnMut(u64) -> bool,
) -> Result<(), MergeError> {
    let TaskKind::Film(film, groups) = &task.work else { return Err(PartError::Gone.into()) };
    let colours = Colours::new(tones(film, picture)?, picture.relief > 0.0);
    let mut painter = FramePainter::new(film.size, picture);
    let legend = legend(film, picture)?;
    for group in groups {
        for EqualFrames { shown, mut frames } in alike(film, group) {
            frames.retain(|(frame, shot)| !sink.has(*frame, shot));
            if frames.is_empty() {
                continue;
            }
            let mut mip = coloured(group, parts, &colours, &shown, &task.folder)?;
            for (frame, shot) in frames {
                let mut rgb = painter.paint(&shot, &mut mip)?;
                if let Some(legend) = &legend {
                    legend.lay_over(&mut rgb, film.size[0]);
                }
                sink.write(frame, &shot, &rgb)?;
                if !keep_going(u64::from(frame) + 1) {
                    return Err(MergeError::Stopped);
                }
            }
            painter.forget();
        }
    }
    sink.finish()
}

/// Returns the legend of a film of flips, if its picture has one; refuses frames with too little
/// room.
pub fn legend(film: &Film, picture: &PictureTable) -> Result<Option<Legend>, SceneError> {
    if !picture.legend {
        return Ok(None);
    }
    let mut scene = film.keys[0].scene.scene();
    scene.question.budget.secs = film.budget_secs();
    let colours = AnswerColours::new(&scene, picture)?;
    Legend::new(&colours, scene.question.ask, film.size).map(Some)
}

/// Returns the single colour scale of a film.
pub fn tones(film: &Film, picture: &PictureTable) -> Result<Tones, SceneError> {
    Tones::new(picture, film.keys[0].scene.pendulum.unit_secs(), film.budget_secs())
}

fn alike(film: &Film, group: &FrameGroupTask) -> Vec<EqualFrames> {
    let mut all: Vec<EqualFrames> = Vec::new();
    for frame in group.group.frames.clone() {
        let shot = film.shot(frame);
        let shown = FlipWindow::of(film, &shot);
        match all.last_mut() {
            Some(last) if last.shown == shown => last.frames.push((frame, shot)),
            _ => all.push(EqualFrames { shown, frames: vec![(frame, shot)] }),
        }
    }
    all
}

/// Builds the mip of a group's patches, in a file in `folder`.
fn coloured(
    group: &FrameGroupTask,
    parts: &mut Parts,
    colours: &Colours,
    shown: &FlipWindow,
    folder: &Path,
) -> Result<Mip, MergeError> {
    let mut patches = group.group.patches.iter();
    let mut looks = || {
        let patch = patches.next().ok_or(PartError::Gone)?;
        let (cell, mirrored) = patch.canonical();
        let samples = parts.patch(group.of(&cell), &cell)?;
        let samples = if mirrored { samples.image(samples.len()) } else { samples };
        Ok(colours.looks(&samples, &group.group.shown(patch, *shown)))
    };
    Mip::build(&group.group.patches, colours.is_lit(), folder, &mut looks)
}

/// Stride between the samples of a patch that the spread of colours uses: every fourth row, one
/// column further each time.
const SAMPLED_ROWS: usize = 65;

/// Returns the times over which a deep film's colours are spread: all its depths count alike, and
/// the times are the same in every frame. Empty if nothing flips.
pub fn spread(task: &Task, parts: &mut Parts) -> Result<Vec<f64>, PartError> {
    let TaskKind::Film(_, groups) = &task.work else { return Ok(Vec::new()) };
    let mut times = Vec::new();
    for group in groups {
        for cell in group.cells.iter() {
            let samples = parts.patch(group.of(cell), cell)?;
            let some = samples.iter().step_by(SAMPLED_ROWS);
            times.extend(some.filter(|o| o.status == Status::Answered).map(|o| o.time));
        }
    }
    Ok(equalised(times.into_iter(), PictureTable::MAX_TIMES - 1))
}
