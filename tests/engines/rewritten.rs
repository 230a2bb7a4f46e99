//! A graphics card whose jobs are changed on the way. It implements only the required methods of an
//! engine, so it makes every check itself; a software adapter leaves expansions to the processor.

use flipmap_engine::gpu::GpuEngine;
use flipmap_engine::{Engine, EngineError, EngineKind, IntegratorConfig, Job, JobResult, Wait};

pub(crate) struct Rewritten {
    pub(crate) engine: GpuEngine,
    pub(crate) rewrite: fn(Job) -> Job,
}

impl Engine for Rewritten {
    fn submit(&mut self, job: Job) -> Result<(), EngineError> {
        self.engine.submit((self.rewrite)(job))
    }
    fn poll(&mut self, wait: Wait) -> Result<Vec<JobResult>, EngineError> {
        self.engine.poll(wait)
    }
    fn cancel(&mut self) {
        self.engine.cancel();
    }
    fn slots(&self) -> usize {
        self.engine.slots()
    }
    fn job_size(&self) -> usize {
        self.engine.job_size()
    }
    fn kind(&self) -> EngineKind {
        self.engine.kind()
    }
    fn adapter(&self) -> String {
        self.engine.adapter()
    }
    fn offers(&self, config: &IntegratorConfig) -> bool {
        self.engine.offers(config)
    }
}
