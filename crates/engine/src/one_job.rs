//! One job, run to its end.

use std::time::{Duration, Instant};

use super::{Engine, EngineError, IntegratorConfig, Job, JobResult, Keep, Question, Starts, Wait};

/// Longest wait before `go_on` is called again.
const PATIENCE: Duration = Duration::from_millis(50);

/// Runs one job on an engine and returns its result; none once `go_on` returns false.
pub fn run_job(
    engine: &mut dyn Engine,
    question: Question,
    config: IntegratorConfig,
    starts: Starts,
    keep: Keep,
    go_on: &dyn Fn() -> bool,
) -> Result<Option<JobResult>, EngineError> {
    engine.submit(Job { id: 0, question, config, starts, keep })?;
    while go_on() {
        if let Some(finished) = engine.poll(Wait::Until(Instant::now() + PATIENCE))?.pop() {
            return Ok(Some(finished));
        }
    }
    engine.cancel();
    Ok(None)
}
