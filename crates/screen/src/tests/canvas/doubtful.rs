//! The mock engine with failures and doubts added, so that every kind of sample occurs.

use std::collections::HashMap;

use flipmap_engine::mock::MockEngine;
use flipmap_engine::{
    Engine, EngineError, EngineKind, IntegratorConfig, Job, JobResult, Starts, Trust, Wait,
};
use flipmap_numbers::Dd;
use flipmap_pendulum::{Outcome, Status};

#[derive(Default)]
pub(crate) struct Doubtful {
    mock: MockEngine,
    starts: HashMap<u64, Vec<[Dd; 2]>>,
}

/// Returns true if the integration from a start fails; the same for mirror images.
pub(crate) fn fails(angle: [Dd; 2]) -> bool {
    (40.0 * angle[0].hi).cos() > 0.95
}

/// Returns true if the answer to a start is uncertain.
pub(crate) fn is_uncertain(angle: [Dd; 2]) -> bool {
    (25.0 * angle[1].hi).cos() > 0.6
}

impl Engine for Doubtful {
    fn submit(&mut self, job: Job) -> Result<(), EngineError> {
        let Starts::Rest(angles) = &job.starts else { panic!("only from rest") };
        self.starts.insert(job.id, angles.clone());
        self.mock.submit(job)
    }

    fn poll(&mut self, wait: Wait) -> Result<Vec<JobResult>, EngineError> {
        let mut finished = self.mock.poll(wait)?;
        for answer in &mut finished {
            let angles = self.starts.remove(&answer.id).expect("a job that was sent");
            for (outcome, angle) in answer.outcomes.iter_mut().zip(&angles) {
                if fails(*angle) {
                    *outcome = Outcome::without_time(Status::Failed);
                }
            }
            let trust = |angle| if is_uncertain(angle) { Trust::Uncertain } else { Trust::Agreed };
            answer.assurances = angles.into_iter().map(|angle| trust(angle).into()).collect();
            answer.unfinished.clear();
        }
        Ok(finished)
    }

    fn cancel(&mut self) {
        self.mock.cancel();
    }

    fn slots(&self) -> usize {
        self.mock.slots()
    }

    fn job_size(&self) -> usize {
        self.mock.job_size()
    }

    fn offers(&self, config: &IntegratorConfig) -> bool {
        self.mock.offers(config)
    }

    fn kind(&self) -> EngineKind {
        EngineKind::Gpu
    }

    fn adapter(&self) -> String {
        self.mock.adapter()
    }
}
