//! The engine that is always there: threads, and the widest SIMD lanes that the processor has.
//!
//! The equations are those of `flipmap_pendulum`, run on registers instead of scalars. A job is cut
//! into chunks that the threads take as they become free; the answer of a pendulum does not depend
//! on its chunk, its lane or its thread.

mod adaptive;
mod custom;
mod dispatch;
mod extremum;
mod fixed;
mod gather_loop;
mod growth;
mod lane_loop;
mod lane_scheduler;
mod lanes;
mod number;
mod pair;
mod rk4;
mod slowed;
mod step_control;
mod stepper;
mod stretch;
mod taylor;
mod taylor_pair;
mod turns;

pub use custom::outcomes;

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

use pulp::Arch;

use self::dispatch::ChunkInFlight;
use self::lane_scheduler::{Chunk, ChunkResult};
use super::threads::thread_pool;
use super::{
    Engine, EngineError, EngineKind, FinalState, IntegratorConfig, Job, JobResult, Keep, Precision,
    Wait, start,
};
use flipmap_pendulum::{Outcome, Status};
use flipmap_scene::question::Needs;

/// Number of starts in a chunk: enough to keep lanes full, few enough to share out evenly.
const CHUNK: usize = 512;
/// Number of starts in a chunk in double-double, where so few take as long as [`CHUNK`] in f64.
const DD_CHUNK: usize = 8;
const JOB_SIZE: usize = 1 << 15;

/// The engine that computes jobs on the processor.
pub struct CpuEngine {
    pool: rayon::ThreadPool,
    flying: HashMap<u64, PendingJob>,
    cancelled: Arc<AtomicBool>,
    sender: Sender<FinishedChunk>,
    receiver: Receiver<FinishedChunk>,
}

/// A job whose chunks have not all come back.
struct PendingJob {
    chunks_left: usize,
    keep: Keep,
    finished: JobResult,
}

/// A chunk that has come back.
struct FinishedChunk {
    job: u64,
    first: usize,
    answer: ChunkResult,
}

impl CpuEngine {
    /// An engine on `threads` threads, or on one for every core.
    pub fn new(threads: Option<usize>) -> Result<Self, EngineError> {
        let pool = thread_pool("engine", threads)?;
        let (sender, receiver) = channel();
        Ok(CpuEngine { pool, flying: HashMap::new(), cancelled: Arc::default(), sender, receiver })
    }

    /// Returns true if the processor has the method in the precision.
    pub(crate) fn offers(config: &IntegratorConfig) -> bool {
        config.precision != Precision::Df32
            && config.method.least_tolerance(config.precision).is_some()
    }

    /// Returns an error if the processor does not have the method in the precision.
    pub(crate) fn require(config: &IntegratorConfig) -> Result<(), EngineError> {
        if Self::offers(config) {
            return Ok(());
        }
        let IntegratorConfig { method, precision } = config;
        let why = format!("the processor has no method {} in precision {precision}", method.name());
        Err(EngineError::Unsupported(why))
    }

    /// Returns an error if the growth or the extremes of a job's pendulums cannot be computed.
    fn require_keep(job: &Job) -> Result<(), EngineError> {
        job.keep.check(&job.config)?;
        start::check_carried(job)
    }

    fn take(&mut self, landed: FinishedChunk) -> Option<JobResult> {
        let flying = self.flying.get_mut(&landed.job)?;
        let FinishedChunk { first, answer, job } = landed;
        let count = answer.outcomes.len();
        if flying.keep.ends != Needs::Outcome {
            let ends = &mut flying.finished.ends;
            ends.resize(flying.finished.outcomes.len(), FinalState::NOWHERE);
            ends[first..first + count].copy_from_slice(&answer.ends);
        }
        if flying.keep.states {
            let states = answer.states.into_iter().enumerate();
            let kept = states.filter(|(i, _)| answer.outcomes[*i].status == Status::Unflipped);
            flying.finished.unfinished.extend(kept.map(|(i, state)| (first + i, state)));
        }
        flying.finished.outcomes[first..first + count].copy_from_slice(&answer.outcomes);
        flying.finished.effort += answer.effort;
        flying.chunks_left -= 1;
        if flying.chunks_left > 0 {
            return None;
        }
        let mut finished = self.flying.remove(&job)?.finished;
        finished.unfinished.sort_unstable_by_key(|(index, _)| *index);
        Some(finished)
    }
}

impl Engine for CpuEngine {
    fn submit(&mut self, job: Job) -> Result<(), EngineError> {
        Self::require(&job.config)?;
        Self::require_keep(&job)?;
        let pace = job.pace()?;
        let starts = start::states(&job)?;
        let count = starts.len();
        let dd = job.config.precision == Precision::Dd;
        let size = if dd { DD_CHUNK } else { CHUNK };
        let flying = PendingJob {
            chunks_left: count.div_ceil(size).max(1),
            keep: job.keep,
            finished: JobResult {
                id: job.id,
                outcomes: vec![Outcome::without_time(Status::Unflipped); count],
                ..JobResult::default()
            },
        };
        self.flying.insert(job.id, flying);
        if starts.is_empty() {
            let answer = ChunkResult::default();
            let _ = self.sender.send(FinishedChunk { job: job.id, first: 0, answer });
        }
        let (config, question) = (job.config, job.question);
        for (index, chunk) in starts.chunks(size).enumerate() {
            let (starts, sender) = (chunk.to_vec(), self.sender.clone());
            let cancelled = self.cancelled.clone();
            self.pool.spawn_fifo(move || {
                let chunk = Chunk {
                    question: &question,
                    config,
                    pace,
                    starts: &starts,
                    keep: job.keep,
                    cancelled: &cancelled,
                };
                let flown = Arch::new().dispatch(ChunkInFlight { chunk: &chunk });
                if let Some(answer) = flown {
                    // The receiver is gone once the engine is dropped or its jobs are cancelled.
                    let _ = sender.send(FinishedChunk { job: job.id, first: index * size, answer });
                }
            });
        }
        Ok(())
    }

    fn poll(&mut self, wait: Wait) -> Result<Vec<JobResult>, EngineError> {
        let mut finished = Vec::new();
        while !self.flying.is_empty() {
            while let Ok(landed) = self.receiver.try_recv() {
                finished.extend(self.take(landed));
            }
            if !finished.is_empty() || self.flying.is_empty() {
                break;
            }
            match wait.receive(&self.receiver) {
                Ok(landed) => finished.extend(self.take(landed)),
                Err(_) => break,
            }
        }
        Ok(finished)
    }

    fn cancel(&mut self) {
        self.cancelled.store(true, Ordering::Relaxed);
        self.cancelled = Arc::default();
        (self.sender, self.receiver) = channel();
        self.flying.clear();
    }

    /// Two jobs, so that the threads find chunks of the next one while the last ones finish.
    fn slots(&self) -> usize {
        2
    }

    fn job_size(&self) -> usize {
        JOB_SIZE
    }

    fn kind(&self) -> EngineKind {
        EngineKind::Cpu
    }

    fn offers(&self, config: &IntegratorConfig) -> bool {
        CpuEngine::offers(config)
    }

    fn adapter(&self) -> String {
        let set = instruction_set();
        format!("{} threads, {set}", self.pool.current_num_threads())
    }
}

impl Drop for CpuEngine {
    fn drop(&mut self) {
        self.cancel();
    }
}

/// Name of the widest SIMD instruction set of this processor.
pub fn instruction_set() -> &'static str {
    match Arch::new() {
        #[cfg(target_arch = "x86_64")]
        Arch::V4(_) => "AVX-512",
        #[cfg(target_arch = "x86_64")]
        Arch::V3(_) => "AVX2",
        _ => "no SIMD beyond the baseline",
    }
}
