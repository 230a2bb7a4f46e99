//! An engine without physics, so that everything above engines can be tested in milliseconds:
//! a start's answer is a formula of its angles, and jobs finish only when polled.

use std::collections::VecDeque;

use super::{Effort, Engine, EngineError, Finished, Job, Recipe, Starts, Wait};
use crate::physics::{Outcome, Status};

/// Answers jobs in the order of submission, or backwards, one a poll.
#[derive(Default)]
pub struct MockEngine {
    /// Answer the newest job first.
    pub backwards: bool,
    /// Refuse the job with this number of submissions before it.
    pub fail_at: Option<usize>,
    /// Jobs taken so far.
    pub submitted: usize,
    /// Starts answered so far.
    pub answered: usize,
    /// Most jobs that were ever in flight.
    pub most_in_flight: usize,
    /// Jobs in flight.
    pub queue: VecDeque<Job>,
}

impl MockEngine {
    /// The answer to a start: unflipped where θ2 > 1, else flipped at a time that tells it.
    pub fn answer(angle: [f64; 2]) -> Outcome {
        if angle[1] > 1.0 {
            return Outcome::without_time(Status::Unflipped);
        }
        Outcome::flipped(10.0 + angle[0] + 0.01 * angle[1])
    }
}

impl Engine for MockEngine {
    fn submit(&mut self, job: Job) -> Result<(), EngineError> {
        if self.fail_at == Some(self.submitted) {
            return Err(EngineError::OutOfMemory { mib: 1 });
        }
        self.submitted += 1;
        self.queue.push_back(job);
        self.most_in_flight = self.most_in_flight.max(self.queue.len());
        Ok(())
    }

    fn poll(&mut self, _: Wait) -> Result<Vec<Finished>, EngineError> {
        let job = if self.backwards { self.queue.pop_back() } else { self.queue.pop_front() };
        let Some(job) = job else {
            return Ok(Vec::new());
        };
        let Starts::Rest(angles) = &job.starts else {
            return Err(EngineError::Unsupported("the mock only starts from rest".to_string()));
        };
        self.answered += angles.len();
        let outcomes = angles.iter().map(|a| Self::answer(a.map(|theta| theta.hi))).collect();
        let effort = Effort { rhs_evaluations: angles.len() as u64, ..Effort::default() };
        Ok(vec![Finished {
            id: job.id,
            outcomes,
            unfinished: Vec::new(),
            trusts: Vec::new(),
            effort,
        }])
    }

    fn cancel(&mut self) {
        self.queue.clear();
    }

    fn slots(&self) -> usize {
        3
    }

    fn job_size(&self) -> usize {
        64
    }

    fn offers(&self, _: &Recipe) -> bool {
        true
    }

    fn name(&self) -> &'static str {
        "mock"
    }

    fn adapter(&self) -> String {
        "none".to_string()
    }
}
