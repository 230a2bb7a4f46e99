//! Measurements of the questions other than the first flip: speed, and errors against orbits of the
//! gold standard in double-double.

use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::backend::Backend;
use super::measure::Bench;
use super::{ReportError, StopTest, as_words};
use crate::engine::IntegratorConfig;
use crate::physics::passes::{Pass, passes_until};
use crate::physics::phase::distance;
use crate::physics::taylor::Orbit;
use crate::physics::{Dd, State, Status, tangents};
use crate::question::Ask;
use crate::scene::{Budget, Fate, Grid, QuestionTable, Scene};
use crate::tiles::preview::preview;
use crate::tiles::{Samples, Work};

/// A question, answered by an engine with a config.
#[derive(Clone, Debug, Serialize)]
pub struct QuestionRow {
    /// Name of the question.
    pub question: &'static str,
    /// Budget in s.
    pub budget_secs: f64,
    /// Short name of the engine that answered.
    pub engine: String,
    /// The integrator config of the answers.
    #[serde(flatten, serialize_with = "as_words")]
    pub config: IntegratorConfig,
    /// Microseconds per integrated pixel.
    pub us_per_pixel: f64,
    /// Number of pixels compared with the gold standard.
    pub compared: usize,
    /// Share of those that are right.
    pub right: f64,
    /// The error within which an answer is right, in words.
    pub tolerance: &'static str,
}

/// Side of the map that is computed, in pixels.
const SIDE: u32 = 96;
/// Number of pixels that are compared, evenly spread, in a whole and in a quick report.
const COMPARED: [usize; 2] = [256, 64];

/// The questions that are measured, with their budgets in s.
pub(super) const QUESTIONS: [(Ask, f64); 5] = [
    (Ask::State, 12.0),
    (Ask::First, 12.0),
    (Ask::Flips, 8.0),
    (Ask::Growth, 8.0),
    (Ask::Return, 5.0),
];

impl Bench<'_> {
    /// Measures a question on the home map.
    pub(super) fn question(
        &self,
        (ask, budget_secs): (Ask, f64),
        config: IntegratorConfig,
        backend: &mut Backend,
    ) -> Result<QuestionRow, ReportError> {
        let budget = Budget::secs(budget_secs);
        let question = QuestionTable { ask, budget, ..QuestionTable::default() };
        let scene = Scene { question, ..Scene::default() };
        let engine = backend.engine();
        let begun = Instant::now();
        let mut work = Work::new(&scene, [SIDE; 2], config, engine.job_size());
        let samples = preview(&mut work, [SIDE; 2], engine, &|_| !(self.stop)())?;
        let samples = samples.ok_or(ReportError::Stopped)?;
        let us = begun.elapsed().as_secs_f64() * 1e6;
        let most = COMPARED[usize::from(self.care.quick)];
        let (compared, right) = compared(&scene, &samples, most, self.stop)?;
        Ok(QuestionRow {
            question: ask.kind().name,
            budget_secs,
            engine: backend.short_name(),
            config,
            us_per_pixel: us / work.counts().simulated.max(1) as f64,
            compared,
            right: right as f64 / compared.max(1) as f64,
            tolerance: tolerance(ask),
        })
    }
}

fn tolerance(ask: Ask) -> &'static str {
    match ask {
        Ask::Flip => "1 ms",
        Ask::First => "the bob, and 1 ms",
        Ask::Flips => "every count",
        Ask::State => "1e-3 rad",
        Ask::Growth => "1 %",
        Ask::Return => "1e-3",
    }
}

/// Numbers of the pixels compared and of those that are right.
fn compared(
    scene: &Scene,
    samples: &Samples,
    most: usize,
    stop: StopTest,
) -> Result<(usize, usize), ReportError> {
    let grid = Grid::new(scene, [SIDE; 2]);
    let count = (SIDE * SIDE) as usize;
    let open = (0..count as u32).filter_map(|k| match grid.fate(k % SIDE, k / SIDE) {
        Fate::Open(angle) => Some((k as usize, State::rest(angle))),
        _ => None,
    });
    let open: Vec<(usize, State<Dd>)> = open.collect();
    let every = (open.len() / most).max(1);
    let some: Vec<_> = open.into_iter().step_by(every).collect();
    let judge = |(k, start): &(usize, State<Dd>)| {
        let answered = samples.get(*k).status == Status::Flipped;
        !stop() && is_right(scene, *start, answered.then(|| samples.values(*k)))
    };
    let right = some.par_iter().filter(|pixel| judge(pixel)).count();
    if stop() { Err(ReportError::Stopped) } else { Ok((some.len(), right)) }
}

/// Returns true if the channels of an answer, or its lack, are those of the true orbit.
fn is_right(scene: &Scene, start: State<Dd>, answer: Option<&[f64]>) -> bool {
    let secs = scene.question.end_secs();
    let orbit = || Orbit::new(scene.build.pendulum_in::<Dd>(), start);
    match (scene.question.ask, answer) {
        (Ask::State, Some(values)) => {
            let truth = orbit().state_at(Dd::new(secs));
            let off = |bob: usize| (Dd::new(values[bob]) - truth.angle[bob]).wrapped().hi.abs();
            off(0) < 1e-3 && off(1) < 1e-3
        }
        (Ask::Growth, Some(values)) => {
            let truth = exponent(scene, start, secs);
            (values[0] - truth).abs() < 0.01 * truth.abs()
        }
        (Ask::Return, answer) => {
            let least = nearest(scene, orbit(), secs);
            match answer {
                Some(values) => (values[0] - least).abs() < 1e-3,
                None => least.is_infinite(),
            }
        }
        (ask, answer) => {
            let all = passes_until(orbit(), secs);
            match (ask, answer) {
                (Ask::Flips, Some(values)) => {
                    let count = |k: usize| all.iter().filter(|pass| channel_of(pass) == k).count();
                    (0..4).all(|k| values[k] == count(k) as f64)
                }
                (Ask::First, Some(values)) => all.first().is_some_and(|pass| {
                    values[0] == pass.bob as f64 && (values[1] - pass.time.hi).abs() < 1e-3
                }),
                (_, None) => all.is_empty(),
                _ => false,
            }
        }
    }
}

/// Number of a pass's channel of the question `flips`.
fn channel_of(pass: &Pass) -> usize {
    2 * (pass.bob - 1) + usize::from(!pass.anticlockwise)
}

/// The exponent of the largest of all nudges by central differences of orbits.
fn exponent(scene: &Scene, start: State<Dd>, secs: f64) -> f64 {
    const NUDGE: f64 = 1e-11;
    let unit = scene.build.unit_secs();
    let column = |k: usize| {
        let [behind, ahead] = [-NUDGE, NUDGE].map(|by| {
            let mut moved = start;
            match k {
                0 | 1 => moved.angle[k] = moved.angle[k] + Dd::new(by),
                _ => moved.speed[k - 2] = moved.speed[k - 2] + Dd::new(by / unit),
            }
            Orbit::new(scene.build.pendulum_in::<Dd>(), moved).state_at(Dd::new(secs))
        });
        let slope = |a: Dd, b: Dd| (a - b).hi / (2.0 * NUDGE);
        let angle = |i: usize| slope(ahead.angle[i], behind.angle[i]);
        let speed = |i: usize| slope(ahead.speed[i], behind.speed[i]) * unit;
        [angle(0), angle(1), speed(0), speed(1)]
    };
    tangents::largest_singular_value([0, 1, 2, 3].map(column)).ln() / secs
}

/// The least distance from the start after having left it, from states a ten-thousandth apart.
fn nearest(scene: &Scene, mut orbit: Orbit<Dd>, secs: f64) -> f64 {
    const STATES: u32 = 10_000;
    let pendulum = scene.build.pendulum();
    let inverse_scale = pendulum.momentum_scale().map(|scale| 1.0 / scale);
    let near = |state: State<Dd>| {
        let state = State { angle: state.angle.map(|x| x.hi), speed: state.speed.map(|x| x.hi) };
        pendulum.phase(&state)
    };
    let from = near(*orbit.state());
    let (mut before, mut has_left, mut least) = (0.0, false, f64::INFINITY);
    for k in 1..=STATES {
        let phase = near(orbit.state_at(Dd::new(secs * f64::from(k) / f64::from(STATES))));
        let apart = distance(&phase, &from, inverse_scale);
        has_left |= apart < before;
        if has_left && apart > before {
            least = least.min(before);
        }
        before = apart;
    }
    least
}
