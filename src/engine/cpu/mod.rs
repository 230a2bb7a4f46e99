//! The engine that is always there: threads, and the widest SIMD lanes the processor has.
//!
//! The equations are those of `physics`, run on registers instead of scalars. A job is cut into
//! chunks that the threads take as they come free; what a pendulum's answer is does not depend
//! on its chunk, its lane or its thread.

mod flock;
mod lanes;

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Instant;

use pulp::{Arch, Simd, WithSimd};

use self::flock::{Answer, Chunk, run};
use self::lanes::{F32Lanes, F64Lanes};
use super::method::{Method, Steps};
use super::{Engine, EngineError, Finished, Job, Paused, Precision, Starts, Wait};
use crate::physics::trig::Turning;
use crate::physics::{Dd, Outcome, State, Status};

/// Starts in a chunk: long enough to keep lanes full, short enough to share out evenly.
const CHUNK: usize = 512;
const JOB_SIZE: usize = 1 << 15;

/// The processor computing jobs.
pub struct CpuEngine {
    pool: rayon::ThreadPool,
    flying: HashMap<u64, Flying>,
    cancelled: Arc<AtomicBool>,
    sender: Sender<Landed>,
    receiver: Receiver<Landed>,
}

/// A job whose chunks have not all come back.
struct Flying {
    chunks_left: usize,
    keep_unfinished: bool,
    finished: Finished,
}

/// A chunk that has come back.
struct Landed {
    job: u64,
    first: usize,
    answer: Answer,
}

impl CpuEngine {
    /// An engine on `threads` threads, or on one for every core.
    pub fn new(threads: Option<usize>) -> Result<Self, EngineError> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.unwrap_or(0))
            .thread_name(|index| format!("engine-{index}"))
            .build()
            .map_err(|error| EngineError::Unsupported(format!("cannot start threads: {error}")))?;
        let (sender, receiver) = channel();
        Ok(CpuEngine { pool, flying: HashMap::new(), cancelled: Arc::default(), sender, receiver })
    }

    fn take(&mut self, landed: Landed) -> Option<Finished> {
        let flying = self.flying.get_mut(&landed.job)?;
        let Landed { first, answer, job } = landed;
        let count = answer.outcomes.len();
        if flying.keep_unfinished {
            let kept = (0..count).filter(|&i| answer.outcomes[i].status == Status::Unflipped);
            flying.finished.unfinished.extend(kept.map(|i| (first + i, answer.states[i])));
        }
        flying.finished.outcomes[first..first + count].copy_from_slice(&answer.outcomes);
        flying.finished.rhs_evaluations += answer.rhs_evaluations;
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
        let Method::Rk4 { step_secs } = job.recipe.method;
        let steps = Steps::new(&job.question, step_secs, job.recipe.precision)?;
        let starts = states_at_start(&job);
        let count = starts.len();
        let flying = Flying {
            chunks_left: count.div_ceil(CHUNK),
            keep_unfinished: job.keep_unfinished,
            finished: Finished {
                id: job.id,
                outcomes: vec![Outcome::without_time(Status::Unflipped); count],
                unfinished: Vec::new(),
                rhs_evaluations: 0,
            },
        };
        self.flying.insert(job.id, flying);
        let turning = job.recipe.turning(&job.question);
        let (precision, question) = (job.recipe.precision, job.question);
        for (index, chunk) in starts.chunks(CHUNK).enumerate() {
            let (starts, sender) = (chunk.to_vec(), self.sender.clone());
            let cancelled = self.cancelled.clone();
            self.pool.spawn_fifo(move || {
                let chunk = Chunk {
                    question: &question,
                    steps,
                    starts: &starts,
                    compensated: precision == Precision::F32,
                    cancelled: &cancelled,
                };
                let flown = Arch::new().dispatch(Flight { chunk: &chunk, precision, turning });
                if let Some(answer) = flown {
                    // Nobody listens any more once the engine is dropped.
                    let _ = sender.send(Landed { job: job.id, first: index * CHUNK, answer });
                }
            });
        }
        Ok(())
    }

    fn poll(&mut self, wait: Wait) -> Result<Vec<Finished>, EngineError> {
        let mut finished = Vec::new();
        while !self.flying.is_empty() {
            while let Ok(landed) = self.receiver.try_recv() {
                finished.extend(self.take(landed));
            }
            if !finished.is_empty() || self.flying.is_empty() {
                break;
            }
            let landed = match wait {
                Wait::UntilFinished => {
                    self.receiver.recv().map_err(|_| RecvTimeoutError::Disconnected)
                }
                Wait::Until(moment) => {
                    self.receiver.recv_timeout(moment.saturating_duration_since(Instant::now()))
                }
            };
            match landed {
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

    /// Enough that the threads find chunks of the next job while the last ones finish.
    fn slots(&self) -> usize {
        2
    }

    fn job_size(&self) -> usize {
        JOB_SIZE
    }

    fn name(&self) -> &'static str {
        "cpu"
    }

    fn adapter(&self) -> String {
        let set = match Arch::new() {
            #[cfg(target_arch = "x86_64")]
            Arch::V4(_) => "AVX-512",
            #[cfg(target_arch = "x86_64")]
            Arch::V3(_) => "AVX2",
            _ => "no SIMD beyond the baseline",
        };
        format!("{} threads, {set}", self.pool.current_num_threads())
    }
}

impl Drop for CpuEngine {
    fn drop(&mut self) {
        self.cancel();
    }
}

/// A chunk on its way to the widest lanes.
struct Flight<'a> {
    chunk: &'a Chunk<'a>,
    precision: Precision,
    turning: Turning,
}

impl WithSimd for Flight<'_> {
    type Output = Option<Answer>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) -> Self::Output {
        macro_rules! lanes {
            ($lanes:ident) => {
                match self.turning {
                    Turning::Small(2) => run::<$lanes<S>, 2>(set, self.chunk),
                    Turning::Small(4) => run::<$lanes<S>, 4>(set, self.chunk),
                    Turning::Small(6) => run::<$lanes<S>, 6>(set, self.chunk),
                    _ => run::<$lanes<S>, 0>(set, self.chunk),
                }
            };
        }
        match self.precision {
            Precision::F32 => lanes!(F32Lanes),
            Precision::F64 => lanes!(F64Lanes),
        }
    }
}

/// The job's starts as states, rounded to its precision.
fn states_at_start(job: &Job) -> Vec<Paused> {
    match &job.starts {
        Starts::Paused(paused) => paused.clone(),
        Starts::Rest(angles) => angles
            .iter()
            .map(|angle| {
                let parts = angle.map(|theta| split(theta, job.recipe.precision));
                Paused {
                    steps: 0,
                    state: State::rest([parts[0].0, parts[1].0]),
                    rest: [parts[0].1, parts[1].1],
                }
            })
            .collect(),
    }
}

fn split(theta: Dd, precision: Precision) -> (f64, f64) {
    match precision {
        Precision::F64 => (theta.hi, 0.0),
        Precision::F32 => {
            let high = f64::from(theta.hi as f32);
            (high, f64::from(((theta.hi - high) + theta.lo) as f32))
        }
    }
}
