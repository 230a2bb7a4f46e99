//! Measurements of the questions other than the first flip: speed, and errors against orbits of the
//! gold standard in double-double.

use std::collections::HashMap;
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::backend::Backend;
use super::measure::Bench;
use super::question_truth::true_answer;
use super::statistics::quantile;
use super::{ReportError, StopTest, as_words};
use flipmap_engine::IntegratorConfig;
use flipmap_numbers::Dd;
use flipmap_pendulum::{State, Status};
use flipmap_render::tiles::preview::preview;
use flipmap_render::tiles::{Samples, Work};
use flipmap_scene::question::{Judgement, QuestionName};
use flipmap_scene::{Budget, Fate, Grid, QuestionSettings, Scene};

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
    /// Share of the compared pixels that are right.
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

/// The questions that are measured here: first flips have chapters of their own.
pub(super) fn measured_questions() -> impl Iterator<Item = QuestionName> {
    QuestionName::ALL.into_iter().filter(|ask| !ask.is_time())
}

/// The true channels of a pixel with this index; `None` where the true orbit has no answer.
type QuestionTruth = (usize, Option<Vec<f64>>);

/// The truth about some pixels of each question, found when it is first needed.
#[derive(Default)]
pub(super) struct QuestionTruths(HashMap<&'static str, Vec<QuestionTruth>>);

impl Bench<'_> {
    /// Measures a question on the home map.
    pub(super) fn question(
        &self,
        ask: QuestionName,
        config: IntegratorConfig,
        backend: &mut Backend,
        truths: &mut QuestionTruths,
    ) -> Result<QuestionRow, ReportError> {
        let Judgement { budget_secs, max_error, words, .. } = ask.kind().judged;
        let budget = Budget::secs(budget_secs);
        let question = QuestionSettings { ask, budget, ..QuestionSettings::default() };
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
            let answered = samples.get(*k).status == Status::Answered;
            error(ask, answered.then(|| samples.values(*k)), truth.as_deref())
        };
        let mut errors: Vec<f64> = truth.iter().map(error).collect();
        errors.sort_by(f64::total_cmp);
        let right = errors.iter().filter(|error| **error <= max_error).count();
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
            tolerance: words,
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

/// The error of an answer's channels; infinite if only one of answer and truth is there.
fn error(ask: QuestionName, answer: Option<&[f64]>, truth: Option<&[f64]>) -> f64 {
    match (answer, truth) {
        (Some(answer), Some(truth)) => (ask.kind().judged.error)(answer, truth),
        (None, None) => 0.0,
        _ => f64::INFINITY,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_without_a_truth_is_infinitely_wrong() {
        assert_eq!(error(QuestionName::Return, None, Some(&[0.1, 2.0])), f64::INFINITY);
        assert_eq!(error(QuestionName::Return, Some(&[0.1, 2.0]), None), f64::INFINITY);
        assert_eq!(error(QuestionName::Return, None, None), 0.0);
        assert_eq!(error(QuestionName::Return, Some(&[0.5, 2.0]), Some(&[0.25, 2.0])), 0.25);
    }
}
