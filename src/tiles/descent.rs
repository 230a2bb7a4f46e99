//! The descent from a view to ever smaller ones that still have structure.
//!
//! Where neighbours flip at different times, and late, there is more to see below: early flips have
//! long stopped telling neighbours apart. Each step computes a small picture, goes to the liveliest
//! place near a preferred point, and enlarges it.

use super::preview::preview;
use super::{Samples, Work};
use crate::engine::{Engine, EngineError, IntegratorConfig};
use crate::physics::{Scalar, Status, Theta};
use crate::scene::{Budget, Scene};

/// Side in pixels of the small pictures.
const SIDE: u32 = 32;
/// Ratio of the width of a view to that of the next one, √10: two steps are a decade.
const FACTOR: f64 = 3.162_277_660_168_379_5;
/// Distance in pixels along each axis up to which neighbours are compared.
const AROUND: i32 = 2;
/// Upper limit of the differences that count, in natural units of time.
const ENOUGH_UNITS: f64 = 3.0;
/// Mean difference, in those units, at or below which a place has no structure.
const LEAST_UNITS: f64 = 0.05;

/// A descent from each view to the next deeper one.
pub struct Descent {
    scene: Scene,
    config: IntegratorConfig,
    /// Preferred point of the next step, in pixels from the middle.
    wish: [f64; 2],
}

/// The result of a step of a descent.
#[derive(Clone, Debug, PartialEq)]
pub enum DescentStep {
    /// The next view, around a place that has structure.
    Scene(Box<Scene>),
    /// The end of the descent: no structure was found, or the next view would be too small.
    End,
    /// The step was stopped because `go_on` returned false.
    Stopped,
}

impl Descent {
    /// Begins at a checked scene; `wish` is the preferred point, measured from the middle in widths
    /// of the view. The budget follows the depth.
    pub fn new(mut scene: Scene, config: IntegratorConfig, wish: [f64; 2]) -> Self {
        scene.question.budget =
            Budget { auto: true, ..scene.question.budget }.for_view(&scene.build, &scene.view);
        (scene.view.rotate, scene.view.stretch) = (0.0, 1.0);
        Descent { scene, config, wish: wish.map(|part| part * f64::from(SIDE)) }
    }

    /// Returns the next view, which is smaller by half a decade; calls `go_on` now and then.
    pub fn next(
        &mut self,
        engine: &mut dyn Engine,
        go_on: &dyn Fn() -> bool,
    ) -> Result<DescentStep, EngineError> {
        let mut work = Work::new(&self.scene, [SIDE; 2], self.config, (SIDE * SIDE) as usize);
        let samples = preview(&mut work, [SIDE; 2], engine, &|_| go_on())?;
        let Some(samples) = samples else { return Ok(DescentStep::Stopped) };
        let Some([across, above]) = self.liveliest(&samples) else { return Ok(DescentStep::End) };
        let width = self.scene.view.width_rad().to_f64();
        let pixel = width / f64::from(SIDE);
        let center = self.scene.view.center_rad();
        let by = [across, above].map(|by| Theta::from_f64(by * pixel));
        let width = width / FACTOR;
        if width < crate::scene::LEAST_WIDTH {
            return Ok(DescentStep::End);
        }
        // Twelve digits below the width tell the pixels of any screen apart.
        let digits = (12.0 - width.log10()).ceil().max(12.0) as usize;
        let view = &mut self.scene.view;
        view.center = [0, 1].map(|i| (center[i] + by[i]).wrapped().decimal(digits));
        view.width = format!("{width:.3e}");
        view.fit = false;
        self.wish = [0.0; 2];
        let Scene { build, question, view, .. } = &mut self.scene;
        question.budget = question.budget.for_view(build, view);
        Ok(DescentStep::Scene(Box::new(self.scene.clone())))
    }

    /// Returns the offset from the middle, in pixels, of the pixel that differs most from its
    /// neighbours, favouring those near the preferred point; `None` if there is no structure.
    fn liveliest(&self, samples: &Samples) -> Option<[f64; 2]> {
        let unit = self.scene.build.unit_secs();
        let side = SIDE as i32;
        let inside = AROUND..side - AROUND;
        let mut best = (0.0, None);
        for (row, column) in inside.clone().flat_map(|y| inside.clone().map(move |x| (y, x))) {
            let liveliness = self.liveliness(samples, [column, row]) / unit;
            let from_middle =
                [column as f64, (side - 1 - row) as f64].map(|at| at + 0.5 - f64::from(SIDE) / 2.0);
            let far = (from_middle[0] - self.wish[0]).hypot(from_middle[1] - self.wish[1]);
            let score = liveliness / (1.0 + far / f64::from(SIDE));
            if liveliness > LEAST_UNITS && score > best.0 {
                best = (score, Some(from_middle));
            }
        }
        best.1
    }

    /// Returns the mean difference of a pixel's flip time from those of its neighbours, s. Pairs of
    /// which one does not flip, or flips early, count as zero.
    fn liveliness(&self, samples: &Samples, [x, y]: [i32; 2]) -> f64 {
        let budget = self.scene.question.budget.secs;
        let late = |x: i32, y: i32| {
            let outcome = samples.get((y * SIDE as i32 + x) as usize);
            (outcome.status == Status::Flipped && outcome.time > LATE * budget)
                .then_some(outcome.time)
        };
        let Some(here) = late(x, y) else { return 0.0 };
        let most = ENOUGH_UNITS * self.scene.build.unit_secs();
        let around = (-AROUND..=AROUND).flat_map(|dy| (-AROUND..=AROUND).map(move |dx| (dx, dy)));
        let differences = around.filter_map(|(dx, dy)| late(x + dx, y + dy));
        let sum: f64 = differences.map(|there| (there - here).abs().min(most)).sum();
        sum / f64::from((2 * AROUND + 1).pow(2))
    }
}

/// Share of the budget before which flips no longer tell deep neighbours apart.
const LATE: f64 = 0.4;
