//! Measurements of films: the time of a long one, without making it.
//!
//! The film zooms from home to the scene `seabed` in 60 s. Short zooms from some widths are sampled,
//! of which each stands for the octaves around it, and the frames of one of them are painted and
//! encoded. Deep zooms are of full size and six octaves, as many as one reference serves.

use std::path::Path;
use std::time::Instant;

use serde::Serialize;

use super::backend::Backend;
use super::measure::Bench;
use super::plan::BALANCED;
use super::{Report, ReportError, as_words};
use flipmap_engine::depth::DepthEngine;
use flipmap_engine::{Engine, IntegratorConfig};
use flipmap_numbers::Scalar;
pub(crate) use flipmap_render::farm::{
    PartError, Parts, Plan, PlanError, PlannedOutput, RunError, Task, run,
};
use flipmap_render::film::ffmpeg::FilmQuality;
use flipmap_render::film::{FilmRecipe, FilmRenderError};
use flipmap_scene::film::Film;
use flipmap_scene::keys::{Easing, Key};
use flipmap_scene::{BuiltIn, Document, Sampling};

/// Scene at which the long film ends.
const TARGET: &str = "seabed";
/// Width and height of the long film in pixels.
const SIZE: [u32; 2] = [1920, 1080];
/// Frames per second of the long film.
const FPS: f64 = 60.0;
/// Number of frames of the long film.
const FRAMES: u32 = 3600;
/// Number of frames of a short zoom.
const FRAMES_IN_ZOOM: u32 = 24;

/// A zoom that stands for the octaves around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShortZoom {
    /// Width of the first frame, rad.
    pub width_rad: f64,
    /// Number of times that the width is halved.
    octaves: u32,
    size: [u32; 2],
}

/// A zoom of half the long film's size, for widths where pixels are integrated one by one.
const fn small(width_rad: f64) -> ShortZoom {
    ShortZoom { width_rad, octaves: 1, size: [SIZE[0] / 2, SIZE[1] / 2] }
}

const fn deep(width_rad: f64) -> ShortZoom {
    ShortZoom { width_rad, octaves: 6, size: SIZE }
}

/// The zooms, from the widest to the deepest.
pub(super) const ZOOMS: [ShortZoom; 16] = [
    small(3.0),
    small(1.0),
    small(0.3),
    small(0.1),
    small(3e-2),
    small(1e-2),
    small(1e-3),
    small(1e-4),
    small(1e-5),
    deep(1e-7),
    deep(1e-9),
    deep(1e-13),
    deep(1e-20),
    deep(1e-30),
    deep(1e-45),
    deep(6e-60),
];

/// The zoom whose frames are painted.
const PAINTED: ShortZoom = ShortZoom { width_rad: 1e-20, octaves: 1, size: SIZE };

/// Time that the samples of a short zoom take.
#[derive(Clone, Debug, Serialize)]
pub struct ZoomRow {
    /// Short name of the engine.
    pub engine: String,
    /// The integrator config of the samples.
    #[serde(flatten, serialize_with = "as_words")]
    pub config: IntegratorConfig,
    /// Width of the first frame, rad.
    pub width_rad: f64,
    /// Number of samples.
    pub samples: u64,
    /// Seconds to compute and keep them.
    pub secs: f64,
}

/// Time that frames of the long film take, and the number of its samples.
#[derive(Clone, Debug, Serialize)]
pub struct PaintingRow {
    /// Number of samples of the long film.
    pub film_samples: u64,
    /// Number of frames that were painted and encoded.
    pub frames: u32,
    /// Seconds that they took.
    pub secs: f64,
}

/// Time that the long film takes, in s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LongFilm {
    /// Seconds for its samples.
    pub sampling_secs: f64,
    /// Seconds for its frames.
    pub painting_secs: f64,
}

impl LongFilm {
    /// The time that follows from a report's rows; `None` unless every zoom and the frames were measured.
    pub(crate) fn of(report: &Report) -> Option<Self> {
        let painting = report.painting.as_ref()?;
        let zooms = &report.zooms[..];
        if zooms.len() != ZOOMS.len() {
            return None;
        }
        let octave = |width_rad: f64| width_rad.log2();
        let ends = [BuiltIn::home().document(), target()];
        let [home, seabed] =
            ends.map(|scene| octave(scene.view.fitted(SIZE.map(f64::from)).width_rad().to_f64()));
        // Each zoom stands for the octaves nearer to it than to any other.
        let middle =
            |pair: &[ZoomRow]| f64::midpoint(octave(pair[0].width_rad), octave(pair[1].width_rad));
        let inner: Vec<f64> = zooms.windows(2).map(middle).collect();
        let borders = [vec![home], inner, vec![seabed]].concat();
        let share = |k: usize| (borders[k] - borders[k + 1]) / (home - seabed);
        let secs_a_sample = |row: &ZoomRow| row.secs / row.samples as f64;
        let mean: f64 =
            zooms.iter().enumerate().map(|(k, row)| share(k) * secs_a_sample(row)).sum();
        Some(LongFilm {
            sampling_secs: painting.film_samples as f64 * mean,
            painting_secs: f64::from(FRAMES) * painting.secs / f64::from(painting.frames),
        })
    }

    /// Seconds for samples and frames.
    pub(crate) fn secs(&self) -> f64 {
        self.sampling_secs + self.painting_secs
    }
}

impl ShortZoom {
    /// The zoom to the point at which the long film ends.
    fn film(&self) -> Film {
        let last_rad = self.width_rad / 2f64.powi(self.octaves as i32);
        let at = |width_rad: f64| {
            let mut scene = target();
            scene.view.width = format!("{width_rad:e}");
            scene
        };
        film(self.size, FRAMES_IN_ZOOM, [at(self.width_rad), at(last_rad)])
    }
}

/// The scene at which the long film ends, with one sample a pixel.
fn target() -> Document {
    let mut scene = BuiltIn::named(TARGET).expect("a built-in scene").document();
    scene.picture.samples = Sampling::SINGLE;
    scene.picture.times.clear();
    scene
}

/// The film from home to the target.
fn long_film() -> Film {
    let home = BuiltIn::home().document().view;
    let mut first = target();
    first.view = home;
    film(SIZE, FRAMES, [first, target()])
}

/// A zoom between two scenes whose budgets follow their widths.
fn film(size: [u32; 2], frames: u32, scenes: [Document; 2]) -> Film {
    let last_secs = f64::from(frames) / FPS;
    let keys = scenes.into_iter().zip([0.0, last_secs]).map(|(mut scene, secs)| {
        scene.view = scene.view.fitted(size.map(f64::from));
        Key { secs, easing: Easing::Linear, clock: None, scene: scene.settled() }
    });
    Film { size, frames, fps: FPS, keys: keys.collect() }
}

impl Bench<'_> {
    /// Measures the samples of a short zoom.
    pub(super) fn zoom(
        &self,
        zoom: &ShortZoom,
        backend: &mut Backend,
    ) -> Result<ZoomRow, ReportError> {
        let engine = backend.short_name();
        let folder = folder()?;
        let (task, secs) = self.sampled(zoom.film(), backend, folder.path())?;
        Ok(ZoomRow {
            engine,
            config: BALANCED,
            width_rad: zoom.width_rad,
            samples: task.samples(),
            secs,
        })
    }

    /// Measures the painting and encoding of frames, and counts the samples of the long film.
    pub(super) fn painting(&self, backend: &mut Backend) -> Result<PaintingRow, ReportError> {
        let folder = folder()?;
        let film_samples = planned(long_film(), backend.engine(), folder.path())?.samples();
        let film = PAINTED.film();
        let (task, _) = self.sampled(film.clone(), backend, folder.path())?;
        let (document, output) = (&film.keys[0].scene, &folder.path().join("film.mp4"));
        let recipe = FilmRecipe { film: &film, document, output };
        let encoding = recipe.check(FilmQuality::default())?;
        let begun = Instant::now();
        let mut parts = Parts::scan(&task.folder, task.forms())?;
        recipe.merge(encoding, &task, &mut parts, &|_, _| !(self.stop)())?;
        Ok(PaintingRow { film_samples, frames: film.frames, secs: begun.elapsed().as_secs_f64() })
    }

    /// Computes the samples of a film, and returns them as a finished task with its seconds.
    fn sampled(
        &self,
        film: Film,
        backend: &mut Backend,
        folder: &Path,
    ) -> Result<(Task, f64), ReportError> {
        let begun = Instant::now();
        let mut engine = DepthEngine::new(Box::new(backend.engine()), self.threads)?;
        let task = planned(film, &engine, folder)?;
        let missing = task.missing(1, &Parts::default());
        run(&task, &missing, &mut engine, &|_, _| !(self.stop)())?;
        Ok((task, begun.elapsed().as_secs_f64()))
    }
}

/// A film as a task of one shard.
fn planned(film: Film, engine: &dyn Engine, folder: &Path) -> Result<Task, ReportError> {
    let plan = Plan::new(PlannedOutput::Film(film), 1, (engine, BALANCED, false), false);
    Ok(Task::new(plan, &folder.join("film.toml"))?)
}

fn folder() -> Result<tempfile::TempDir, ReportError> {
    tempfile::tempdir().map_err(|why| ReportError::Film(why.to_string()))
}

impl From<RunError> for ReportError {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Engine(error) => error.into(),
            RunError::Stopped => ReportError::Stopped,
            RunError::Part(error) => error.into(),
        }
    }
}

impl From<FilmRenderError> for ReportError {
    fn from(error: FilmRenderError) -> Self {
        match error {
            FilmRenderError::Stopped => ReportError::Stopped,
            error => ReportError::Film(error.to_string()),
        }
    }
}

impl From<PartError> for ReportError {
    fn from(error: PartError) -> Self {
        ReportError::Film(error.to_string())
    }
}

impl From<PlanError> for ReportError {
    fn from(error: PlanError) -> Self {
        ReportError::Film(error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Thoroughness, fixtures};
    use super::*;
    use crate::TestSet;

    #[test]
    fn the_long_film_takes_as_long_as_its_samples_and_its_frames() {
        // A million samples at a million a second; 24 frames in 6 s.
        let mut report = fixtures::report();
        let film = LongFilm::of(&report).unwrap();
        assert!((film.sampling_secs - 1.0).abs() < 1e-12, "{film:?}");
        assert!((film.painting_secs - 900.0).abs() < 1e-9, "{film:?}");
        // The deepest zoom stands for the octaves from halfway to 1e-45 to the end: an eighth.
        report.zooms[15].secs *= 2.0;
        let slower = LongFilm::of(&report).unwrap().sampling_secs;
        assert!((0.12..0.14).contains(&(slower - 1.0)), "{slower}");
        report.zooms.pop();
        assert_eq!(LongFilm::of(&report), None, "part of the way is not measured");
    }

    #[test]
    fn every_film_can_be_made_and_each_zoom_lies_within_the_long_one() {
        let long = long_film();
        long.check().unwrap();
        let end = |film: &Film| film.keys[1].scene.view.clone();
        for zoom in ZOOMS {
            let film = zoom.film();
            film.check().unwrap();
            assert_eq!(end(&film).center, end(&long).center);
            assert!(end(&film).width_rad().to_f64() >= 0.1 * end(&long).width_rad().to_f64());
            let [first, last] = [0, 1].map(|k| film.keys[k].scene.question.budget.secs);
            assert!(first <= last && first >= 30.0, "{first} {last}");
        }
        assert!(ZOOMS.windows(2).all(|pair| pair[0].width_rad > pair[1].width_rad));
    }

    #[test]
    fn zooms_are_sampled_in_full_and_a_stop_is_heard() {
        let zoom = ShortZoom { width_rad: 1.0, octaves: 1, size: [16, 16] };
        let test_set = TestSet::home(0, &|| false).unwrap();
        let mut backend = Backend::processor(Some(1)).unwrap();
        let mut measure = |stop: &(dyn Fn() -> bool + Sync)| {
            let care = &Thoroughness::QUICK;
            Bench { test_set: &test_set, care, threads: Some(1), stop }.zoom(&zoom, &mut backend)
        };
        let row = measure(&|| false).unwrap();
        assert!(row.samples >= 256 && row.secs > 0.0, "{row:?}");
        assert!(matches!(measure(&|| true), Err(ReportError::Stopped)));
    }
}
