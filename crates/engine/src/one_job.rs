//! One job, run to its end.

use std::time::Duration;

use super::{Engine, EngineError, EventSpec, IntegratorConfig, Job, JobResult, Keep, Starts, Wait};
use crate::clock::Instant;

/// Longest wait before `keep_going` is called again.
const PATIENCE: Duration = Duration::from_millis(50);

/// Runs one job on an engine and returns its result, or `None` once `keep_going` returns false.
pub fn run_job(
    engine: &mut dyn Engine,
    question: EventSpec,
    config: IntegratorConfig,
    starts: Starts,
    keep: Keep,
    keep_going: &dyn Fn() -> bool,
) -> Result<Option<JobResult>, EngineError> {
    engine.submit(Job { id: 0, question, config, starts, keep })?;
    while keep_going() {
        if let Some(finished) = engine.poll(Wait::Until(Instant::now() + PATIENCE))?.pop() {
            return Ok(Some(finished));
        }
    }
    engine.cancel();
    Ok(None)
}
