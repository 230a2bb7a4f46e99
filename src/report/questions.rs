//! Measurements of the questions other than the first flip: speed, and errors against orbits of the
//! gold standard in double-double.

use std::collections::HashMap;
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::backend::Backend;
use super::measure::Bench;
use super::statistics::quantile;
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
    /// Median error, in the unit of the tolerance; infinite if half have no answer or a wrong one.
    pub median_error: Option<f64>,
    /// 90th percentile of the errors.
    pub p90_error: Option<f64>,
    /// The error within which an answer is right, in words.
    pub tolerance: &'static str,
}

/// Side of the map that is computed, in pixels.
const SIDE: u32 = 96;
/// Side of the map that is computed first, so that kernels are compiled.
const FIRST_SIDE: u32 = 8;
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

/// The true channels of a pixel with this index; `None` where the true orbit has no answer.
type QuestionTruth = (usize, Option<Vec<f64>>);

/// The truth about some pixels of each question, found when it is first needed.
#[derive(Default)]
pub(super) struct QuestionTruths(HashMap<&'static str, Vec<QuestionTruth>>);

impl Bench<'_> {
    /// Measures a question on the home map.
    pub(super) fn question(
        &self,
        (ask, budget_secs): (Ask, f64),
        config: IntegratorConfig,
        backend: &mut Backend,
        truths: &mut QuestionTruths,
    ) -> Result<QuestionRow, ReportError> {
        let budget = Budget::secs(budget_secs);
        let question = QuestionTable { ask, budget, ..QuestionTable::default() };
        let scene = Scene { question, ..Scene::default() };
        self.map(&scene, FIRST_SIDE, config, backend)?;
        let begun = Instant::now();
        let (samples, simulated) = self.map(&scene, SIDE, config, backend)?;
        let us = begun.elapsed().as_secs_f64() * 1e6;
        let name = ask.kind().name;
        if !truths.0.contains_key(name) {
            let most = COMPARED[usize::from(self.care.quick)];
            truths.0.insert(name, true_channels(&scene, most, self.stop)?);
        }
        let truth = &truths.0[name];
        let error = |(k, truth): &QuestionTruth| {
            let answered = samples.get(*k).status == Status::Flipped;
            error(ask, answered.then(|| samples.values(*k)), truth.as_deref())
        };
        let mut errors: Vec<f64> = truth.iter().map(error).collect();
        errors.sort_by(f64::total_cmp);
        let (largest, within) = tolerance(ask);
        let right = errors.iter().filter(|error| **error <= largest).count();
        Ok(QuestionRow {
            question: name,
            budget_secs,
            engine: backend.short_name(),
            config,
            us_per_pixel: us / simulated.max(1) as f64,
            compared: errors.len(),
            right: right as f64 / errors.len().max(1) as f64,
            median_error: quantile(&errors, 0.5),
            p90_error: quantile(&errors, 0.9),
            tolerance: within,
        })
    }

    /// A map of a scene, and the number of its pixels that were integrated.
    fn map(
        &self,
        scene: &Scene,
        side: u32,
        config: IntegratorConfig,
        backend: &mut Backend,
    ) -> Result<(Samples, u64), ReportError> {
        let engine = backend.engine();
        let mut work = Work::new(scene, [side; 2], config, engine.job_size());
        let samples = preview(&mut work, [side; 2], engine, &|_| !(self.stop)())?;
        Ok((samples.ok_or(ReportError::Stopped)?, work.counts().simulated))
    }
}

/// The largest error of a right answer, and the same in words.
fn tolerance(ask: Ask) -> (f64, &'static str) {
    match ask {
        Ask::Flip => (1e-3, "1 ms"),
        Ask::First => (1e-3, "the bob, and 1 ms"),
        Ask::Flips => (0.0, "every count"),
        Ask::State => (1e-3, "1e-3 rad"),
        Ask::Growth => (0.01, "1 %"),
        Ask::Return => (1e-3, "1e-3"),
    }
}

/// The error of an answer's channels: of angles in rad, of times in s, of an exponent relative to the
/// true one, of counts their sum. Infinite if only one of answer and truth is there, or for the wrong
/// bob.
fn error(ask: Ask, answer: Option<&[f64]>, truth: Option<&[f64]>) -> f64 {
    let (answer, truth) = match (answer, truth) {
        (Some(answer), Some(truth)) => (answer, truth),
        (None, None) => return 0.0,
        _ => return f64::INFINITY,
    };
    let apart = |k: usize| (answer[k] - truth[k]).abs();
    match ask {
        Ask::State => {
            let turned = |k: usize| Dd::new(answer[k] - truth[k]).wrapped().hi.abs();
            turned(0).max(turned(1))
        }
        Ask::Growth => apart(0) / truth[0].abs(),
        Ask::First if apart(0) > 0.0 => f64::INFINITY,
        Ask::First => apart(1),
        Ask::Flips => (0..4).map(apart).sum(),
        Ask::Flip | Ask::Return => apart(0),
    }
}

/// The truth about some pixels of a map, evenly spread.
fn true_channels(
    scene: &Scene,
    most: usize,
    stop: StopTest,
) -> Result<Vec<QuestionTruth>, ReportError> {
    let grid = Grid::new(scene, [SIDE; 2]);
    let count = (SIDE * SIDE) as usize;
    let open = (0..count as u32).filter_map(|k| match grid.fate(k % SIDE, k / SIDE) {
        Fate::Open(angle) => Some((k as usize, State::rest(angle))),
        _ => None,
    });
    let open: Vec<(usize, State<Dd>)> = open.collect();
    let every = (open.len() / most).max(1);
    let some: Vec<_> = open.into_iter().step_by(every).collect();
    let truth = |(k, start): &(usize, State<Dd>)| {
        if stop() { Err(ReportError::Stopped) } else { Ok((*k, true_answer(scene, *start))) }
    };
    some.par_iter().map(truth).collect()
}

/// The channels of the true orbit, as far as [`error`] compares them; `None` without an answer.
fn true_answer(scene: &Scene, start: State<Dd>) -> Option<Vec<f64>> {
    let secs = scene.question.end_secs();
    let mut orbit = Orbit::new(scene.build.pendulum_in::<Dd>(), start);
    match scene.question.ask {
        Ask::State => {
            let state = orbit.state_at(Dd::new(secs));
            Some(state.angle.map(|angle| angle.wrapped().hi).to_vec())
        }
        Ask::Growth => Some(vec![exponent(scene, start, secs)]),
        Ask::Return => Some(vec![nearest(scene, orbit, secs)]).filter(|least| least[0].is_finite()),
        Ask::Flips => {
            let all = passes_until(orbit, secs);
            let count = |k: usize| all.iter().filter(|pass| channel_of(pass) == k).count() as f64;
            (!all.is_empty()).then(|| (0..4).map(count).collect())
        }
        Ask::First => {
            let all = passes_until(orbit, secs);
            all.first().map(|pass| vec![pass.bob as f64, pass.time.hi])
        }
        Ask::Flip => {
            let all = passes_until(orbit, secs);
            all.iter().find(|pass| pass.bob == 2).map(|pass| vec![pass.time.hi])
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_those_of_the_channels() {
        let of = |ask, answer: &[f64], truth: &[f64]| error(ask, Some(answer), Some(truth));
        assert!((of(Ask::State, &[3.1, 0.0], &[-3.1, 0.02]) - 0.0832).abs() < 1e-3, "over the top");
        assert!((of(Ask::Growth, &[1.1], &[1.0]) - 0.1).abs() < 1e-12);
        assert_eq!(of(Ask::First, &[1.0, 2.5], &[1.0, 2.0]), 0.5);
        assert_eq!(of(Ask::First, &[2.0, 2.0], &[1.0, 2.0]), f64::INFINITY);
        assert_eq!(of(Ask::Flips, &[1.0, 0.0, 2.0, 0.0], &[0.0, 0.0, 4.0, 0.0]), 3.0);
        assert_eq!(error(Ask::Return, None, Some(&[0.1])), f64::INFINITY);
        assert_eq!(error(Ask::Return, None, None), 0.0);
    }
}
