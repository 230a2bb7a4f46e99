//! Starts through an engine, by the clock.

use std::time::{Duration, Instant};

use super::{ReportError, StopTest};
use crate::engine::{Effort, Engine, EngineError, Job, Question, Recipe, Starts, Wait};
use crate::physics::{Dd, Outcome};

/// What came of a run.
pub struct Ran {
    /// One for each start, in their order.
    pub outcomes: Vec<Outcome>,
    /// What it took.
    pub effort: Effort,
    /// Microseconds for each start, from the first submission to the last answer.
    pub us_per_pixel: f64,
}

/// How often a stop is looked for.
const PATIENCE: Duration = Duration::from_millis(50);

/// All `starts` in jobs of the engine's size, with as many in flight as it wants.
pub fn run(
    engine: &mut dyn Engine,
    question: &Question,
    recipe: Recipe,
    starts: &[[Dd; 2]],
    stop: StopTest,
) -> Result<Ran, ReportError> {
    let begun = Instant::now();
    let answered = answers(engine, question, recipe, starts, stop);
    let us_per_pixel = begun.elapsed().as_secs_f64() * 1e6 / starts.len() as f64;
    if answered.is_err() {
        // What is still in flight must not answer the next run.
        engine.cancel();
    }
    let (outcomes, effort) = answered?;
    if outcomes.len() != starts.len() {
        let message = format!("{} answers to {} starts", outcomes.len(), starts.len());
        return Err(EngineError::Driver(message).into());
    }
    Ok(Ran { outcomes, effort, us_per_pixel })
}

fn answers(
    engine: &mut dyn Engine,
    question: &Question,
    recipe: Recipe,
    starts: &[[Dd; 2]],
    stop: StopTest,
) -> Result<(Vec<Outcome>, Effort), ReportError> {
    let size = engine.job_size();
    let mut answers: Vec<Vec<Outcome>> = vec![Vec::new(); starts.len().div_ceil(size)];
    let mut jobs = (0..).zip(starts.chunks(size));
    let (mut flying, mut effort) = (0, Effort::default());
    loop {
        while flying < engine.slots() {
            let Some((id, starts)) = jobs.next() else { break };
            let starts = Starts::Rest(starts.to_vec());
            engine.submit(Job {
                id,
                question: *question,
                recipe,
                starts,
                keep_unfinished: false,
            })?;
            flying += 1;
        }
        if flying == 0 {
            return Ok((answers.concat(), effort));
        }
        for finished in engine.poll(Wait::Until(Instant::now() + PATIENCE))? {
            flying -= 1;
            effort += finished.effort;
            answers[finished.id as usize] = finished.outcomes;
        }
        if stop() {
            return Err(ReportError::Stopped);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::cpu::CpuEngine;
    use crate::report::{Ground, plan};

    #[test]
    fn every_start_is_answered_in_order_and_a_stop_is_heeded() {
        let ground = Ground::home(40, &|| false).unwrap();
        let starts: Vec<[Dd; 2]> = ground.sample.iter().map(|(start, _)| *start).collect();
        let mut engine = CpuEngine::new(Some(1)).unwrap();
        let mut attempt =
            |stop: StopTest| run(&mut engine, &ground.question, plan::BALANCED, &starts, stop);
        let ran = attempt(&|| false).unwrap();
        let pairs = ran.outcomes.iter().zip(&ground.sample);
        assert!(pairs.clone().all(|(answer, (_, truth))| answer.status == truth.status));
        assert!(ran.effort.steps > 40 && ran.us_per_pixel > 0.0);
        assert!(matches!(attempt(&|| true), Err(ReportError::Stopped)));
    }
}
