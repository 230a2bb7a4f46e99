//! `film`: a film of a zoom through scenes, or of a file of keys.

use std::path::{Path, PathBuf};
use std::time::Instant;

use flipmap::{Document, EngineRequest, Renderer, RunSpec, Setting};
use flipmap_engine::choice::choose;
use flipmap_render::farm::{
    FilmSamples, FilmSamplesError, OpenChoices, PartError, Parts, RunError, compute, is_deep,
    spread_film,
};
use flipmap_render::film::ffmpeg::{Codec, Encoding, FilmQuality};
use flipmap_render::film::{FilmRecipe, FilmRenderError, check_film, settle_colours};
use flipmap_render::output::{holds_keys, read_text};
use flipmap_scene::View;
use flipmap_scene::film::{Film, FilmError, FilmKind};
use flipmap_scene::film_length::{FilmLength, home_before, zoom_through};
use flipmap_scene::keys::{Key, Keys};
use pyo3::exceptions::{PyOSError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::clock::Clock;
use crate::fork::refuse_after_fork;
use crate::map::{Run, about, choice_error, failed};
use crate::scene::{document, value_error, with_words};

/// What Python says of a film; `None` leaves a choice to the program.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Making {
    output: PathBuf,
    scenes: Vec<String>,
    size: [u32; 2],
    secs: Option<f64>,
    frames: Option<u32>,
    fps: Option<f64>,
    palette: Option<String>,
    quality: Option<u8>,
    full_chroma: bool,
    samples: Option<PathBuf>,
}

/// Makes a film of one or more scenes, or of keys, in a file or a folder. Returns a dictionary with
/// its `frames`, `fps` and `size`, and `seconds` and `engine` of the work.
#[pyfunction]
pub(crate) fn film<'py>(
    py: Python<'py>,
    making: Making,
    words: Vec<(String, String)>,
    run: Run,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let output = making.output.display();
    Codec::of_film(&making.output)
        .map_err(|why| value_error(format!("`output` is '{output}'; {why}")))?;
    let (film, spec) = planned(keys(&making.scenes, &words)?, &making, &run)?;
    let request = run.request(&spec)?.answering(&film.keys[0].scene.question);
    refuse_after_fork()?;

    let made = PyDict::new(py);
    made.set_item("frames", film.frames)?;
    made.set_item("fps", film.fps)?;
    made.set_item("size", film.size)?;
    let begun = Instant::now();
    let clock = Clock::new(progress, u64::from(film.frames));
    let work = Work { film, making: &making, request, verify: spec.verify };
    let done = py.detach(|| work.make(&clock));
    // What Python raised is the reason for a stop.
    let engine = match done {
        Ok(engine) => engine,
        Err(error) => return Err(clock.into_raised().unwrap_or(error)),
    };
    clock.finish(py)?;
    made.set_item("engine", engine)?;
    made.set_item("seconds", begun.elapsed().as_secs_f64())?;
    Ok(made)
}

/// Returns the keys of a file or a text of keys, or those of a zoom: through several scenes, or from
/// the whole map to one.
fn keys(scenes: &[String], words: &[(String, String)]) -> PyResult<Vec<Key>> {
    let of_view =
        |name: &str| Setting::named(name).is_some_and(|word| View::SETTINGS.contains(&word));
    let load = |name: &String| document(Some(name), words);
    if let [scene] = scenes
        && !scene.contains("[[key]]")
        && !holds_keys(Path::new(scene))
    {
        let mut last = load(scene)?;
        // These times suit the view at the end, not the zoom towards it.
        last.picture.times.clear();
        return Ok(zoom_through(vec![home_before(&last), last]));
    }
    if let Some((name, _)) = words.iter().find(|(name, _)| of_view(name)) {
        return Err(value_error(format!(
            "`{name}` would give all keys the same view: write the views into the scenes"
        )));
    }
    match scenes {
        [text] => {
            let read = || read_text(Path::new(text)).map_err(PyErr::from);
            let text = if text.contains('\n') { text.clone() } else { read()? };
            let mut keys = Keys::parse(&text).map_err(value_error)?.keys;
            for key in &mut keys {
                key.scene = with_words(std::mem::take(&mut key.scene), words)?;
            }
            Ok(keys)
        }
        _ => Ok(zoom_through(scenes.iter().map(load).collect::<PyResult<_>>()?)),
    }
}

/// Returns the film of keys, and the settings of its run.
fn planned(mut keys: Vec<Key>, making: &Making, run: &Run) -> PyResult<(Film, RunSpec)> {
    let Some(first) = keys.first_mut() else { return Err(value_error(FilmError::Few(0))) };
    let Making { secs, frames, fps, size, .. } = *making;
    let Document { picture, run: table, .. } = &mut first.scene;
    // The times of one view do not suit the others.
    picture.forget_view_times();
    if let Some(palette) = &making.palette {
        picture.palette.clone_from(palette);
    }
    if picture.samples.along() == 1 {
        picture.samples = Film::SAMPLES;
    }
    picture.check().map_err(value_error)?;
    picture.check_size(size).map_err(value_error)?;
    let spec = RunSpec::resolve(table.overlaid(run.words(size))).map_err(value_error)?;
    *table = spec.table.clone();
    let film = FilmLength { secs, frames, fps }.film(keys, size).and_then(Film::settled);
    Ok((film.map_err(value_error)?, spec))
}

/// A film to be made.
struct Work<'a> {
    film: Film,
    making: &'a Making,
    request: EngineRequest,
    verify: bool,
}

impl Work<'_> {
    /// Makes the film; returns what computed it.
    fn make(&self, clock: &Clock) -> PyResult<String> {
        let quality =
            FilmQuality { level: self.making.quality, full_chroma: self.making.full_chroma };
        let document = self.film.keys[0].scene.clone();
        let recipe =
            FilmRecipe { film: &self.film, document: &document, output: &self.making.output };
        let encoding = recipe.check(quality).map_err(film_error)?;
        if self.film.kind() == FilmKind::Flips {
            return self.painted(document.clone(), encoding, clock);
        }
        let mut renderer = Renderer::new(&self.request).map_err(choice_error)?;
        recipe.render(encoding, &mut renderer, clock).map_err(film_error)?;
        Ok(about(&mut renderer))
    }

    /// Makes the film from samples of first flips, which are kept: the same call goes on after a stop.
    fn painted(
        &self,
        mut document: Document,
        encoding: Option<Encoding>,
        clock: &Clock,
    ) -> PyResult<String> {
        let (film, output) = (&self.film, &self.making.output);
        let folder = self.making.samples.clone().unwrap_or_else(|| FilmSamples::beside(output));
        let kept = FilmSamples::open(&folder).map_err(samples_error)?;
        // Another engine would differ from the existing samples in the last digits.
        let request = match kept.earlier() {
            Some(earlier) => earlier.request_like(self.request.clone()),
            None => self.request.clone(),
        };
        let chosen = choose(&request, &|_| ()).map_err(choice_error)?;
        check_film(film, &chosen.config).map_err(failed)?;
        let task = kept.task(film.clone(), self.verify, &chosen).map_err(samples_error)?;
        let scan = || Parts::scan(&task.folder, task.forms()).map_err(part_error);
        let mut parts = scan()?;
        parts.remove_damaged().map_err(part_error)?;
        let missing = task.missing(1, &parts);
        let mut renderer = Renderer::try_from(chosen).map_err(failed)?;
        if !missing.is_empty() {
            drop(parts);
            compute(&task, &missing, &mut renderer, clock).map_err(run_error)?;
            parts = scan()?;
        }
        if is_deep(film) && document.picture.times.is_empty() {
            let palette = self.making.palette.is_none();
            let open = OpenChoices { cycles: true, palette, repeat: true };
            spread_film(&task, &mut parts, open, &mut document.picture).map_err(part_error)?;
        }
        settle_colours(film, &mut document.picture).map_err(value_error)?;
        let recipe = FilmRecipe { film, document: &document, output };
        recipe.merge(encoding, &task, &mut parts, clock).map_err(film_error)?;
        Ok(about(&mut renderer))
    }
}

fn film_error(error: FilmRenderError) -> PyErr {
    match error {
        FilmRenderError::Engine(error) => failed(error),
        FilmRenderError::Part(error) => part_error(error),
        FilmRenderError::Picture(error) => value_error(error),
        FilmRenderError::Output(error) => PyOSError::new_err(whole(&error)),
        FilmRenderError::Frame(error) => PyOSError::new_err(whole(&error)),
        FilmRenderError::Colours(error) => PyOSError::new_err(whole(&error)),
        error @ (FilmRenderError::Ffmpeg(_) | FilmRenderError::Stopped) => {
            PyRuntimeError::new_err(whole(&error))
        }
    }
}

fn run_error(error: RunError) -> PyErr {
    match error {
        RunError::Engine(error) => failed(error),
        RunError::Part(error) => part_error(error),
        error @ RunError::Stopped => PyRuntimeError::new_err(error.to_string()),
    }
}

fn part_error(error: PartError) -> PyErr {
    PyOSError::new_err(whole(&error))
}

fn samples_error(error: FilmSamplesError) -> PyErr {
    match error {
        FilmSamplesError::Plan(error) => value_error(error),
        error => PyOSError::new_err(format!("`samples`: {error}")),
    }
}

/// Describes an error and its causes.
fn whole(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(Some(error), |cause| cause.source());
    causes.map(ToString::to_string).collect::<Vec<_>>().join(": ")
}
