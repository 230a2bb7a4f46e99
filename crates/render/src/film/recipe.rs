//! The only path from a film to its file or its numbered pictures. Frames are computed one by one,
//! or painted from the parts of a task.

use std::io;
use std::path::Path;

use super::ffmpeg::{Codec, Encoding, FfmpegError, FilmQuality, tried};
use super::sink::FilmSink;
use super::{FrameError, check_insets};
use crate::Watch;
use crate::farm::{PartError, Parts, Task, frames};
use crate::output::{OutputError, RowPainter};
use crate::tiles::moments::Moments;
use crate::tiles::{Renderer, check_feasible, check_steps};
use flipmap_engine::{Cells, EngineError, IntegratorConfig};
use flipmap_scene::film::{Film, FilmKind, Shot};
use flipmap_scene::{Document, SceneError};

/// Reasons why a film was not completed.
#[derive(Debug, thiserror::Error)]
pub enum FilmRenderError {
    /// The engine failed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// An error of a part.
    #[error(transparent)]
    Part(#[from] PartError),
    /// A destination that cannot be written.
    #[error("{0}")]
    Output(#[from] OutputError),
    /// An error of a frame.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// An error of a film in a single file.
    #[error(transparent)]
    Ffmpeg(#[from] FfmpegError),
    /// Frames that cannot be painted with these settings.
    #[error("{0}")]
    Picture(#[from] SceneError),
    /// An error of the temporary file that holds the colours of a film's patches.
    #[error("cannot keep colours beside the samples, which takes nearly as much room again")]
    Colours(#[from] io::Error),
    /// A request to stop.
    #[error("stopped; what was computed is kept")]
    Stopped,
}

/// A film to be made.
pub struct FilmRecipe<'a> {
    /// Keys, frames and their size, checked and settled.
    pub film: &'a Film,
    /// Colours and run settings of all frames; its scene does not matter.
    pub document: &'a Document,
    /// File or folder to write.
    pub output: &'a Path,
}

impl FilmRecipe<'_> {
    /// Refuses a film that could not be painted or written, before an engine is started. Returns how
    /// a file is encoded, after a trial on one frame; none for a folder.
    pub fn check(&self, quality: FilmQuality) -> Result<Option<Encoding>, FilmRenderError> {
        check_insets(self.film, &self.document.picture)?;
        FilmSink::check(self.output)?;
        let codec = Codec::of(self.output);
        Ok(codec.map(|codec| tried(codec, quality, self.film.into(), self.output)).transpose()?)
    }

    /// Computes and writes the film frame by frame, with the encoding that [`Self::check`] has
    /// returned, and skips frames that are there already. If they are states at advancing times,
    /// every pendulum is followed only once.
    pub fn render(
        &self,
        encoding: Option<Encoding>,
        renderer: &mut Renderer,
        watch: &dyn Watch,
    ) -> Result<(), FilmRenderError> {
        let (film, picture, config) = (self.film, &self.document.picture, renderer.config());
        check_film(film, &config)?;
        let size = samples_of(film);
        let mut moments = Moments::can_make(film, renderer.is_checked(), &config).then(|| {
            let job_size = renderer.engine().job_size();
            Moments::new(&film.shot(0).scene, size, config, job_size)
        });
        self.write(encoding, watch, &mut |frame, shot| {
            let goes_on = || watch.keep_going(u64::from(frame), u64::from(film.frames));
            let mut painter = RowPainter::new(&shot.scene, film.size, picture)?;
            if let Some(moments) = &mut moments {
                let at_secs = shot.scene.question.end_secs();
                let samples = moments.at(renderer.engine(), at_secs, &goes_on)?;
                return Ok(painter.paint(samples.ok_or(FilmRenderError::Stopped)?));
            }
            let samples = renderer.render_while(&shot.scene, size, &|_, _| goes_on())?;
            Ok(painter.paint(&samples.ok_or(FilmRenderError::Stopped)?))
        })
    }

    /// Paints and writes the film from the complete parts of its task, with the encoding that
    /// [`Self::check`] has returned, and skips frames that are there already.
    pub fn merge(
        &self,
        encoding: Option<Encoding>,
        task: &Task,
        parts: &mut Parts,
        watch: &dyn Watch,
    ) -> Result<(), FilmRenderError> {
        let mut paint = frames(task, &self.document.picture, parts)?;
        self.write(encoding, watch, paint.as_mut())
    }

    /// Writes the frames that are not there yet, each with the pixels that `paint` returns.
    fn write(
        &self,
        encoding: Option<Encoding>,
        watch: &dyn Watch,
        paint: &mut FramePixels,
    ) -> Result<(), FilmRenderError> {
        let film = self.film;
        let mut sink = FilmSink::open(self.output, film, self.document, encoding)?;
        for frame in 0..film.frames {
            let shot = film.shot(frame);
            if sink.has(frame, &shot) {
                continue;
            }
            let rgb = paint(frame, &shot)?;
            sink.write(frame, &shot, &rgb)?;
            if !watch.keep_going(u64::from(frame) + 1, u64::from(film.frames)) {
                return Err(FilmRenderError::Stopped);
            }
        }
        sink.finish()
    }
}

/// Returns the pixels of a frame that shows a shot, three bytes each. Frames come in their order,
/// and some may be left out.
pub(crate) type FramePixels<'a> = dyn FnMut(u32, &Shot) -> Result<Vec<u8>, FilmRenderError> + 'a;

/// Returns an error if an engine with this configuration cannot compute a film.
pub fn check_film(film: &Film, config: &IntegratorConfig) -> Result<(), EngineError> {
    if film.kind() == FilmKind::Flips {
        return check_steps(&film.keys[0].scene.scene(), config);
    }
    let size = samples_of(film);
    let mut scenes = film.keys.iter().map(|key| key.scene.scene());
    scenes.try_for_each(|scene| check_feasible(&scene, size, config, Cells::Auto))
}

/// Returns the width and height of a film's frames in samples.
pub fn samples_of(film: &Film) -> [u32; 2] {
    film.size.map(|side| side * film.keys[0].scene.picture.samples.along())
}
