//! Timed runs of starts through an engine.

use std::time::{Duration, Instant};

use super::{ReportError, StopTest};
use flipmap_engine::{
    Assurance, Effort, Engine, EngineError, EventSpec, IntegratorConfig, Job, JobResult, Keep,
    Starts, Wait,
};
use flipmap_numbers::Dd;
use flipmap_pendulum::Outcome;

/// The results of a run.
pub struct TimedRun {
    /// Outcomes of the starts, in their order.
    pub outcomes: Vec<Outcome>,
    /// Assurance of each outcome; empty if nothing was checked.
    pub assurances: Vec<Assurance>,
    /// Effort of the run, summed over its jobs.
    pub effort: Effort,
    /// Microseconds per start, from the first submission to the last answer.
    pub us_per_pixel: f64,
}

/// Longest wait for answers between two checks for a stop.
const PATIENCE: Duration = Duration::from_millis(50);

/// Runs all `starts` in jobs of the engine's size, with as many in flight as it has slots.
pub fn run(
    engine: &mut dyn Engine,
    question: &EventSpec,
    config: IntegratorConfig,
    starts: &[[Dd; 2]],
    stop: StopTest,
) -> Result<TimedRun, ReportError> {
    let begun = Instant::now();
    let answered = answers(engine, question, config, starts, stop);
    let us_per_pixel = begun.elapsed().as_secs_f64() * 1e6 / starts.len() as f64;
    if answered.is_err() {
        // What is still in flight must not answer the next run.
        engine.cancel();
    }
    let answered = answered?;
    let effort = answered.iter().fold(Effort::default(), |mut sum, finished| {
        sum += finished.effort;
        sum
    });
    let (outcomes, assurances): (Vec<_>, Vec<_>) =
        answered.into_iter().map(|finished| (finished.outcomes, finished.assurances)).unzip();
    let (outcomes, assurances) = (outcomes.concat(), assurances.concat());
    let unsure = !assurances.is_empty() && assurances.len() != starts.len();
    if outcomes.len() != starts.len() || unsure {
        let message = format!(
            "{} answers, {} of them checked, to {} starts",
            outcomes.len(),
            assurances.len(),
            starts.len()
        );
        return Err(EngineError::Driver(message).into());
    }
    Ok(TimedRun { outcomes, assurances, effort, us_per_pixel })
}

/// The engine's answers, job by job in the order of the starts.
fn answers(
    engine: &mut dyn Engine,
    question: &EventSpec,
    config: IntegratorConfig,
    starts: &[[Dd; 2]],
    stop: StopTest,
) -> Result<Vec<JobResult>, ReportError> {
    let mut jobs = (0..).zip(starts.chunks(engine.job_size()));
    let mut answers: Vec<JobResult> = Vec::new();
    let mut flying = 0;
    loop {
        while flying < engine.slots() {
            let Some((id, starts)) = jobs.next() else { break };
            let starts = Starts::Rest(starts.to_vec());
            let question = *question;
            engine.submit(Job { id, question, config, starts, keep: Keep::NOTHING })?;
            flying += 1;
        }
        if flying == 0 {
            answers.sort_unstable_by_key(|finished| finished.id);
            return Ok(answers);
        }
        let landed = engine.poll(Wait::Until(Instant::now() + PATIENCE))?;
        flying -= landed.len();
        answers.extend(landed);
        if stop() {
            return Err(ReportError::Stopped);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{TestSet, plan};
    use flipmap_engine::cpu::CpuEngine;

    #[test]
    fn every_start_is_answered_in_order_and_a_stop_is_heeded() {
        let test_set = TestSet::home(40, &|| false).unwrap();
        let starts: Vec<[Dd; 2]> = test_set.sample.iter().map(|(start, _)| *start).collect();
        let mut engine = CpuEngine::new(Some(1)).unwrap();
        let mut attempt =
            |stop: StopTest| run(&mut engine, &test_set.question, plan::BALANCED, &starts, stop);
        let ran = attempt(&|| false).unwrap();
        let pairs = ran.outcomes.iter().zip(&test_set.sample);
        assert!(pairs.clone().all(|(answer, (_, truth))| answer.status == truth.status));
        assert!(ran.effort.steps > 40 && ran.us_per_pixel > 0.0);
        assert!(matches!(attempt(&|| true), Err(ReportError::Stopped)));
    }
}
