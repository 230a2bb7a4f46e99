//! The engine that is always there: threads, and the widest SIMD lanes that the processor has.
//!
//! The equations are those of `flipmap_pendulum`, run on registers instead of scalars. A job is cut
//! into chunks that the threads take as they become free; the answer of a pendulum does not depend
//! on its chunk, its lane or its thread.

mod adaptive;
mod custom;
mod fixed;
mod growing;
mod lane_scheduler;
mod lanes;
mod nearest;
mod number;
mod one_by_one;
mod pair;
mod slowed;
mod step_control;
mod stretch;
mod tangents;
mod taylor;
mod taylor_pair;
mod turns;

pub use custom::outcomes;
pub use pair::{Dop853, Dopri5, EmbeddedPair};

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

use pulp::{Arch, Simd, WithSimd};

use self::lane_scheduler::{Chunk, ChunkResult};
use self::lanes::{F32Lanes, F64Lanes};
use self::number::{Compensated, Two};
use self::pair::{Midpoints, OnCubic, OnQuartic};
use self::taylor_pair::TaylorPair;
use super::pace::{Adaptive, Pace, Steps};
use super::threads::thread_pool;
use super::{
    Engine, EngineError, EngineKind, FinalState, IntegratorConfig, Job, JobResult, Keep, Method,
    Precision, Wait, WantedEnds, start,
};
use flipmap_numbers::Dd;
use flipmap_numbers::trig::Turning;
use flipmap_pendulum::series::{ORDER_DD, ORDER_F64};
use flipmap_pendulum::{Outcome, Status};

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

    /// Returns an error if the growth or the returns of a job's pendulums cannot be computed.
    fn require_keep(job: &Job) -> Result<(), EngineError> {
        job.keep.check(&job.config)?;
        start::check_carried(job)
    }

    fn take(&mut self, landed: FinishedChunk) -> Option<JobResult> {
        let flying = self.flying.get_mut(&landed.job)?;
        let FinishedChunk { first, answer, job } = landed;
        let count = answer.outcomes.len();
        if flying.keep.ends != WantedEnds::None {
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

/// A chunk to be run in the widest lanes.
struct ChunkInFlight<'a> {
    chunk: &'a Chunk<'a>,
}

impl WithSimd for ChunkInFlight<'_> {
    type Output = Option<ChunkResult>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) -> Self::Output {
        match self.chunk.keep.ends {
            ends if ends.are_carried() && self.is_taylor() => return self.in_taylor_steps(),
            WantedEnds::Growth => return self.growth(set),
            WantedEnds::Return => return self.nearest(),
            _ => {}
        }
        match self.chunk.pace {
            Pace::Fixed(steps) => self.fixed(set, steps),
            Pace::Adaptive(pace) => self.adaptive(set, pace),
        }
    }
}

impl ChunkInFlight<'_> {
    #[inline(always)]
    fn fixed<S: Simd>(self, set: S, steps: Steps) -> Option<ChunkResult> {
        let Chunk { question, config, .. } = *self.chunk;
        macro_rules! lanes {
            ($lanes:ident) => {
                match steps.turning(question, config.precision) {
                    Turning::Small(2) => fixed::run::<$lanes<S>, 2>(set, self.chunk, steps),
                    Turning::Small(4) => fixed::run::<$lanes<S>, 4>(set, self.chunk, steps),
                    Turning::Small(6) => fixed::run::<$lanes<S>, 6>(set, self.chunk, steps),
                    _ => fixed::run::<$lanes<S>, 0>(set, self.chunk, steps),
                }
            };
        }
        match config.precision {
            Precision::F32 => lanes!(F32Lanes),
            _ => lanes!(F64Lanes),
        }
    }

    fn is_taylor(&self) -> bool {
        matches!(self.chunk.config.method, Method::Taylor { .. })
    }

    /// Computes growth or returns in Taylor steps of the same tolerance at all times.
    fn in_taylor_steps(self) -> Option<ChunkResult> {
        const N: usize = ORDER_F64 + 1;
        const M: usize = ORDER_DD + 1;
        let is_dd = self.chunk.config.precision == Precision::Dd;
        let order = if is_dd { TaylorPair::<M>::ORDER } else { TaylorPair::<N>::ORDER };
        let pace = self.chunk.pace.steady(self.chunk.config.method, order);
        let chunk = Chunk { pace, ..*self.chunk };
        match (chunk.keep.ends, is_dd) {
            (WantedEnds::Growth, false) => growing::run::<f64, TaylorPair<N>>(&chunk),
            (WantedEnds::Growth, true) => growing::run::<Dd, TaylorPair<M>>(&chunk),
            (_, false) => nearest::run::<f64, TaylorPair<N>>(&chunk),
            (_, true) => nearest::run::<Dd, TaylorPair<M>>(&chunk),
        }
    }

    fn nearest(self) -> Option<ChunkResult> {
        let IntegratorConfig { method, precision } = self.chunk.config;
        match (method, precision) {
            (Method::Dopri5 { .. }, Precision::F32) => nearest::run::<f32, Dopri5>(self.chunk),
            (Method::Dopri5 { .. }, _) => nearest::run::<f64, Dopri5>(self.chunk),
            (_, Precision::F32) => nearest::run::<f32, Dop853>(self.chunk),
            _ => nearest::run::<f64, Dop853>(self.chunk),
        }
    }

    #[inline(always)]
    fn growth<S: Simd>(self, set: S) -> Option<ChunkResult> {
        match (self.chunk.config.method, self.chunk.config.precision) {
            (Method::Dopri5 { .. }, Precision::F32) => {
                tangents::run::<F32Lanes<S>, Dopri5>(set, self.chunk)
            }
            (Method::Dopri5 { .. }, _) => tangents::run::<F64Lanes<S>, Dopri5>(set, self.chunk),
            (Method::Extrapolation { .. }, _) => {
                tangents::run::<Two<F64Lanes<S>>, Midpoints>(set, self.chunk)
            }
            (_, Precision::F32) => tangents::run::<F32Lanes<S>, Dop853>(set, self.chunk),
            _ => tangents::run::<F64Lanes<S>, Dop853>(set, self.chunk),
        }
    }

    #[inline(always)]
    fn adaptive<S: Simd>(self, set: S, pace: Adaptive) -> Option<ChunkResult> {
        let chunk = self.chunk;
        match (chunk.config.method, chunk.config.precision) {
            (Method::Dopri5 { .. }, Precision::F32) => {
                adaptive::run::<Compensated<F32Lanes<S>>, OnQuartic>(set, chunk, pace)
            }
            (Method::Dopri5 { .. }, _) => adaptive::run::<F64Lanes<S>, OnQuartic>(set, chunk, pace),
            (Method::Extrapolation { .. }, _) => {
                adaptive::run::<Two<F64Lanes<S>>, OnCubic<Midpoints>>(set, chunk, pace)
            }
            (Method::Taylor { .. }, Precision::Dd) => {
                let dd = |hi, lo| Dd { hi, lo };
                taylor::run::<Two<F64Lanes<S>>, Dd, { ORDER_DD + 1 }>(set, chunk, pace, dd)
            }
            (Method::Taylor { .. }, _) => {
                taylor::run::<F64Lanes<S>, f64, { ORDER_F64 + 1 }>(set, chunk, pace, |high, _| high)
            }
            (_, Precision::F32) => {
                adaptive::run::<Compensated<F32Lanes<S>>, OnCubic<Dop853>>(set, chunk, pace)
            }
            _ => adaptive::run::<F64Lanes<S>, OnCubic<Dop853>>(set, chunk, pace),
        }
    }
}
