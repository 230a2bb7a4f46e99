//! Measurements of deep zoom: share of right pixels, steps and time per pixel, in views from 1 rad
//! down to 6e-61 rad wide.
//!
//! The truth about a pixel is the gold standard in fixed-point numbers long enough for its depth,
//! with each pixel integrated on its own from its release: it has nothing in common with start
//! maps.

use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::backend::Backend;
use super::measure::Bench;
use super::plan::BALANCED;
use super::statistics::{Errors, median};
use super::{ReportError, StopTest, as_words};
use flipmap_engine::depth::DepthEngine;
use flipmap_engine::{Cells, Effort, Engine, IntegratorConfig};
use flipmap_numbers::{Exact, Fixed, Scalar};
use flipmap_pendulum::{Outcome, Pendulum, oracle};
use flipmap_render::tiles::preview::preview;
use flipmap_render::tiles::{Samples, Work};
use flipmap_scene::{Scene, View};

/// A view on a filament, found by zooming in from (1.0, 2.0).
#[derive(Clone, Copy, Debug)]
pub(super) struct FilamentPlace {
    /// θ1, θ2 of the centre, rad.
    pub center: [&'static str; 2],
    /// Width of the view, rad.
    pub width: &'static str,
}

/// Pixels along each side of the picture that is compared with the truth. In smaller ones cells end earlier,
/// and pixels are less right.
const SIDE: u32 = 384;
/// Pixels along each side of the picture that is timed.
const TIMED_SIDE: u32 = 128;
/// Number of timed pictures, after one to warm up.
const ROUNDS: usize = 3;

/// Results of a config in a deep view.
#[derive(Clone, Debug, Serialize)]
pub struct DepthRow {
    /// Short name of the engine that answered.
    pub engine: String,
    /// The integrator config of the pixels from where the start map ends.
    #[serde(flatten, serialize_with = "as_words")]
    pub config: IntegratorConfig,
    /// Width of the view, rad.
    pub width_rad: f64,
    /// Budget of the view, which follows its width, s.
    pub budget_secs: f64,
    /// Decimal digits in which the anchor is followed; 0 if every pixel begins at its release.
    pub digits: u32,
    /// Seconds until the first picture of 384 × 384 is complete, its reference included.
    pub first_secs: f64,
    /// Errors of the answers.
    #[serde(flatten)]
    pub errors: Errors,
    /// Right-hand side evaluations per pixel of the larger, timed picture.
    pub rhs_per_pixel: f64,
    /// Steps tried per pixel of that picture.
    pub steps_per_pixel: f64,
    /// Microseconds per pixel of that picture, with the reference known: the median of the rounds.
    pub us_per_pixel: f64,
    /// The same time for each way to compute the pixels; only for `balanced` on f64.
    pub us_by_way: Option<UsByWay>,
}

/// Ways to compute the pixels of a deep view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DepthWay {
    /// Directly from the release.
    Direct,
    /// Through cells and strips, each pixel by itself.
    Cells,
    /// Through cells and strips, most pixels told by samples of lines.
    Lines,
}

/// Microseconds per pixel by the way in which it is computed.
#[derive(Clone, Debug, Serialize)]
pub struct UsByWay {
    /// Directly from the release, if the number type tells the pixels apart.
    pub directly: Option<f64>,
    /// Through cells and strips alone.
    pub by_cells: f64,
    /// Through strips, with lines.
    pub by_lines: f64,
}

impl DepthWay {
    /// Every way.
    pub(crate) const ALL: [DepthWay; 3] = [DepthWay::Direct, DepthWay::Cells, DepthWay::Lines];

    /// Name of the way.
    pub(crate) fn name(self) -> &'static str {
        match self {
            DepthWay::Direct => "direct",
            DepthWay::Cells => "cells",
            DepthWay::Lines => "lines",
        }
    }
}

impl UsByWay {
    /// The time by one way.
    pub(crate) fn of(&self, way: DepthWay) -> Option<f64> {
        match way {
            DepthWay::Direct => self.directly,
            DepthWay::Cells => Some(self.by_cells),
            DepthWay::Lines => Some(self.by_lines),
        }
    }
}

impl FilamentPlace {
    fn view(&self) -> View {
        let center = self.center.map(str::to_string);
        View { center, width: self.width.to_string(), ..View::default() }
    }

    /// The scene of the view, with a budget that follows its depth.
    fn scene(&self) -> Scene {
        let mut scene = Scene { view: self.view(), ..Scene::default() };
        scene.question.budget.auto = true;
        scene.settled()
    }

    /// Width of the view, rad.
    fn width_rad(&self) -> f64 {
        self.view().width_rad().to_f64()
    }

    /// Computes the truth about some pixels of the picture that is compared.
    fn truth(&self, pixels: &[usize], stop: StopTest) -> Result<Vec<Outcome>, ReportError> {
        let one = |pixel: &usize| {
            if stop() {
                return Err(ReportError::Stopped);
            }
            Ok(match self.width_rad() {
                width if width > 1e-24 => self.truth_in::<4>(*pixel),
                width if width > 1e-40 => self.truth_in::<5>(*pixel),
                _ => self.truth_in::<6>(*pixel),
            })
        };
        pixels.par_iter().map(one).collect()
    }

    fn truth_in<const N: usize>(&self, pixel: usize) -> Outcome {
        let scene = self.scene();
        let half = f64::from(SIDE) / 2.0;
        let [x, y] = [pixel as u32 % SIDE, pixel as u32 / SIDE].map(f64::from);
        let pixel_rad = self.width_rad() / f64::from(SIDE);
        let by = [x + 0.5 - half, half - y - 0.5].map(|by| Exact::from_f64(by * pixel_rad));
        let center = scene.view.center_rad();
        let angle = [0, 1].map(|i| (center[i] + by[i]).resized::<N>());
        let pendulum: Pendulum<Fixed<N>> = scene.build.pendulum_in();
        let budget = Fixed::from_f64(scene.question.budget.secs);
        let outcome = oracle::outcome(&pendulum, angle, scene.question.rule, budget);
        Outcome { status: outcome.status, time: outcome.time.to_f64() }
    }
}

/// Cache of the truths computed so far, so that every config is compared with the same ones.
#[derive(Debug, Default)]
pub(super) struct Truths(Vec<(&'static str, Vec<(usize, Outcome)>)>);

impl Truths {
    fn of(
        &mut self,
        place: &FilamentPlace,
        count: usize,
        stop: StopTest,
    ) -> Result<&[(usize, Outcome)], ReportError> {
        let known = self.0.iter().position(|(width, _)| *width == place.width);
        let known = match known {
            Some(known) => known,
            None => {
                let all = (SIDE * SIDE) as usize;
                // Evenly spread over the picture, no pixel twice.
                let pixels: Vec<usize> =
                    (0..count).map(|k| (k * all + all / 2) / count.max(1)).collect();
                let truth = place.truth(&pixels, stop)?;
                self.0.push((place.width, pixels.into_iter().zip(truth).collect()));
                self.0.len() - 1
            }
        };
        Ok(&self.0[known].1)
    }
}

impl Bench<'_> {
    /// Measures a config at a place.
    pub(super) fn depth(
        &self,
        place: &FilamentPlace,
        config: IntegratorConfig,
        backend: &mut Backend,
        truths: &mut Truths,
    ) -> Result<DepthRow, ReportError> {
        let scene = place.scene();
        let name = backend.short_name();
        let mut engine = DepthEngine::new(Box::new(backend.engine()), self.threads)?;
        let begun = Instant::now();
        let (samples, effort) = self.picture(&scene, SIDE, config, Cells::Auto, &mut engine)?;
        let first_secs = begun.elapsed().as_secs_f64();
        let (us_per_pixel, timed) = self.timed(place, config, Cells::Auto, &mut engine)?;
        drop(engine);
        let us_by_way = match config == BALANCED {
            true => Some(self.ways(place, config, backend)?),
            false => None,
        };
        let pixels = f64::from(TIMED_SIDE * TIMED_SIDE);
        let count = if place.width_rad() > 1e-24 {
            self.care.depth_starts
        } else {
            self.care.deepest_starts
        };
        let truth = truths.of(place, count, self.stop)?;
        let pairs: Vec<_> = truth.iter().map(|(k, truth)| (samples.get(*k), *truth)).collect();
        Ok(DepthRow {
            engine: name,
            config,
            width_rad: place.width_rad(),
            budget_secs: scene.question.budget.secs,
            digits: effort.depth.map_or(0, |depth| depth.digits),
            first_secs,
            errors: Errors::of(&pairs),
            rhs_per_pixel: timed.rhs_evaluations as f64 / pixels,
            steps_per_pixel: timed.steps as f64 / pixels,
            us_per_pixel,
            us_by_way,
        })
    }

    /// Times the ways to compute the pixels at a place.
    fn ways(
        &self,
        place: &FilamentPlace,
        config: IntegratorConfig,
        backend: &mut Backend,
    ) -> Result<UsByWay, ReportError> {
        let mut timed = |cells: Cells, lines: bool| {
            let engine = DepthEngine::new(Box::new(backend.engine()), self.threads)?;
            let mut engine = if lines { engine } else { engine.without_lines() };
            self.timed(place, config, cells, &mut engine).map(|(us_per_pixel, _)| us_per_pixel)
        };
        let pixel_rad = place.width_rad() / f64::from(TIMED_SIDE);
        let direct = Cells::Never.check(&config, pixel_rad).is_ok();
        Ok(UsByWay {
            directly: direct.then(|| timed(Cells::Never, false)).transpose()?,
            by_cells: timed(Cells::Always, false)?,
            by_lines: timed(Cells::Always, true)?,
        })
    }

    /// The time of a pixel in µs, and the effort, of the larger picture. After one that finds the
    /// reference, each round computes the view beside the last one, about which nothing is known.
    fn timed(
        &self,
        place: &FilamentPlace,
        config: IntegratorConfig,
        cells: Cells,
        engine: &mut dyn Engine,
    ) -> Result<(f64, Effort), ReportError> {
        let (mut scene, mut times, mut effort) = (place.scene(), Vec::new(), Effort::default());
        self.picture(&scene, TIMED_SIDE, config, cells, engine)?;
        let width = Exact::from_f64(place.width_rad());
        for _ in 0..ROUNDS {
            scene.view.center[0] = (scene.view.center_rad()[0] + width).to_string();
            let begun = Instant::now();
            (_, effort) = self.picture(&scene, TIMED_SIDE, config, cells, engine)?;
            times.push(begun.elapsed().as_secs_f64() * 1e6 / f64::from(TIMED_SIDE * TIMED_SIDE));
        }
        Ok((median(&times).unwrap_or(f64::NAN), effort))
    }

    fn picture(
        &self,
        scene: &Scene,
        side: u32,
        config: IntegratorConfig,
        cells: Cells,
        engine: &mut dyn Engine,
    ) -> Result<(Samples, Effort), ReportError> {
        let mut work = Work::new(scene, [side; 2], config, engine.job_size()).with_cells(cells);
        let samples = preview(&mut work, [side; 2], engine, &|_| !(self.stop)())?;
        Ok((samples.ok_or(ReportError::Stopped)?, work.counts().effort))
    }
}

/// The places: a wide one, then each a thousand times narrower than the one before down to 2e-18,
/// then 2e-22, 2e-30, 2e-50 and 6e-61 rad.
pub(super) const PLACES: [FilamentPlace; 11] = [
    FilamentPlace { center: ["1.1867", "2.0438"], width: "1" },
    FilamentPlace { center: ["1.186751171875", "2.043855078125"], width: "2e-3" },
    FilamentPlace { center: ["1.186731091796875", "2.044025366796875"], width: "2e-6" },
    FilamentPlace { center: ["1.186731002827734375", "2.044025554308203125"], width: "2e-9" },
    FilamentPlace {
        center: ["1.186731002723802734375", "2.044025554305537109375"],
        width: "2e-12",
    },
    FilamentPlace {
        center: ["1.186731002723680473828125", "2.044025554305620741015625"],
        width: "2e-15",
    },
    FilamentPlace {
        center: ["1.186731002723680501301171875", "2.044025554305620842132421875"],
        width: "2e-18",
    },
    FilamentPlace {
        center: ["1.1867310027236805013017550390625", "2.0440255543056208421702266796875"],
        width: "2e-22",
    },
    FilamentPlace {
        center: [
            "1.186731002723680501301760333398676171875",
            "2.044025554305620842170211050417647265625",
        ],
        width: "2e-30",
    },
    FilamentPlace {
        center: [
            "1.18673100272368050130176033339862846767107803060697977734375",
            "2.04402555430562084217021105041761853068902558338534834765625",
        ],
        width: "2e-50",
    },
    FilamentPlace {
        center: [
            "1.186731002723680501301760333398628467671078030606980411925096073828125",
            "2.044025554305620842170211050417618530689025583385348156881813920703125",
        ],
        width: "6.325e-61",
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::Status;

    #[test]
    fn places_lie_in_one_another_and_have_structure() {
        for pair in PLACES.windows(2) {
            let [wide, narrow] = [0, 1].map(|k| pair[k].scene().view);
            let apart = |i: usize| (wide.center_rad()[i] - narrow.center_rad()[i]).to_f64().abs();
            assert!(apart(0).max(apart(1)) < wide.width_rad().to_f64(), "{}", narrow.width);
        }
        let truth =
            PLACES[0].truth(&[128, 25_600, 51_300, 76_900, 102_600, 128_200], &|| false).unwrap();
        let flips = truth.iter().filter(|outcome| outcome.status == Status::Answered);
        let flips: Vec<f64> = flips.map(|outcome| outcome.time).collect();
        assert!(flips.windows(2).any(|pair| (pair[0] - pair[1]).abs() > 0.1), "{flips:?}");
        assert!(matches!(PLACES[0].truth(&[0], &|| true), Err(ReportError::Stopped)));
    }
}
