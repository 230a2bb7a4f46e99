//! Every start at its own angles: a page follows no cells, so it ends where the device's number type
//! cannot tell starts apart.

use flipmap_engine::gpu::GpuEngine;
use flipmap_engine::{
    Deep, Engine, EngineError, EngineKind, IntegratorConfig, Job, JobResult, Starts, Wait,
};
use flipmap_numbers::Exact;
use flipmap_pendulum::Launch;

/// An engine on a device that integrates deep starts from their release.
pub(crate) struct DirectEngine(pub GpuEngine);

/// Returns the starts of deep leaves, leaf by leaf.
fn released(deep: &Deep) -> Starts {
    let points = deep.leaves.iter().flat_map(|leaf| leaf.points.iter().map(|&at| (leaf.cell, at)));
    let starts = points.map(|(cell, at)| {
        let start = deep.plane.start(&cell, at).expect("only flat planes have deep cells");
        let [angle, speed] = [start.angle, start.speed].map(|pair| pair.map(Exact::to_dd));
        Launch { angle, speed }
    });
    if deep.plane.is_at_rest() {
        Starts::Rest(starts.map(|launch| launch.angle).collect())
    } else {
        Starts::Thrown(starts.collect())
    }
}

impl Engine for DirectEngine {
    fn submit(&mut self, job: Job) -> Result<(), EngineError> {
        let starts = match &job.starts {
            Starts::Deep(deep) => released(deep),
            _ => return self.0.submit(job),
        };
        self.0.submit(Job { starts, ..job })
    }

    fn poll(&mut self, wait: Wait) -> Result<Vec<JobResult>, EngineError> {
        self.0.poll(wait)
    }

    fn cancel(&mut self) {
        self.0.cancel();
    }

    fn begin_picture(&mut self) {
        self.0.begin_picture();
    }

    fn slots(&self) -> usize {
        self.0.slots()
    }

    fn job_size(&self) -> usize {
        self.0.job_size()
    }

    fn kind(&self) -> EngineKind {
        self.0.kind()
    }

    fn adapter(&self) -> String {
        self.0.adapter()
    }

    fn offers(&self, config: &IntegratorConfig) -> bool {
        self.0.offers(config)
    }
}
