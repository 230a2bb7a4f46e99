//! Deep zoom: an engine for starts too close together for the number types of engines.
//!
//! It wraps another engine. The leaf of the lattice in which deep starts lie has an ancestor 6 to
//! 11 levels up, the *anchor*. Its middle is followed in as many digits as the depth needs, its
//! whole area as one [`FlowPatch`](flipmap_pendulum::flow_patch::FlowPatch): Taylor polynomials of
//! the flow map in the position of the start. Their coefficients are differences from the middle,
//! for which f64 has enough digits at any depth, as with the reference orbit of a deep Mandelbrot
//! zoom.
//!
//! ```text
//!  level        time ──▶
//!  L−11 … L−6   anchor ├────────────┤ polynomials no longer hold: cut
//!   …           parts               ├──────┤ cut
//!  L            strips                     ├─────────┤ finished patches
//!               samples of their lines               ├── integrated, tell most starts
//!               other starts                         ├── integrated one by one
//! ```
//!
//! Where the polynomials leave out too much, or cannot tell what happens at the top, a cell is cut
//! into parts that continue on their own (automatic domain splitting; Wittig et al., Celest. Mech.
//! Dyn. Astr. 122, 2015; polynomial arithmetic on flows is Berz's differential algebra): into
//! quarters at first, and into strips once one direction has grown far beyond the other
//! ([`domain_splitting`]). The *finished patches* say which starts are forbidden, flip at a known
//! time or stay unflipped, and give the states of the others, which are by then far enough apart
//! for any number type to integrate. By then the states of most patches differ in one direction
//! only; a few samples along it answer most of their starts ([`lines`]). The samples, and the
//! starts that they do not answer, go to the wrapped engine as pendulums in motion ([`takeoff`]);
//! all other jobs are passed on to it.
//!
//! * An answer depends on its place in the lattice alone, not on jobs or other requests.
//! * Anchors, finished patches and samples are kept for later jobs. Cells are followed on threads
//!   of this engine's own.
//! * Strict jobs use other cuts and smaller errors: [`super::trust`] checks one map by another.

mod anchor;
mod deep;
mod domain_splitting;
mod finished_patch;
mod followed_job;
mod following;
mod line_check;
mod line_interval;
mod lines;
mod part;
#[cfg(feature = "sabotage")]
pub mod sabotage;
mod stats;
mod takeoff;

use std::collections::{HashMap, VecDeque};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use self::followed_job::{PartialResult, Splittings, followed, splitting_of};
pub use self::following::Following;
use self::lines::{LineSamples, Need, samples_of};
pub use self::stats::DepthStats;
use self::takeoff::{Purpose, SubJob, by_time};
use super::threads::thread_pool;
use super::{
    Engine, EngineError, EngineKind, GpuStats, IntegratorConfig, Job, JobResult, Keep, Moving,
    Starts, Wait,
};
use crate::clock::Instant;
use flipmap_scene::question::Needs;

/// An engine that follows deep starts for the engine that it wraps.
pub struct DepthEngine<'a> {
    inner: Box<dyn Engine + 'a>,
    pool: rayon::ThreadPool,
    splittings: Splittings,
    /// Deep jobs by identifier; `None` for those whose cells are being followed.
    deep: HashMap<u64, Option<PartialResult>>,
    /// Takeoffs of deep jobs, by the identifiers of the wrapped engine's jobs.
    sub_jobs: HashMap<u64, SubJob>,
    next_sub_job: u64,
    /// Jobs for which the wrapped engine has no free slot yet.
    waiting: VecDeque<Job>,
    flying: usize,
    following: usize,
    /// Samples of lines, for the questions and configurations met so far, the latest last.
    samples: Vec<LineSamples>,
    /// True if samples of lines may answer starts.
    lines: bool,
    /// A deliberate mistake that a test makes.
    #[cfg(feature = "sabotage")]
    sabotage: Option<sabotage::Sabotage>,
    cancelled: Arc<AtomicBool>,
    told: Following,
    sender: Sender<PartialResult>,
    receiver: Receiver<PartialResult>,
}

/// Identifier of the first takeoff, far above those of jobs that are passed on.
const FIRST_SUB_JOB: u64 = 1 << 63;

/// Longest wait for one source of answers before the other is polled.
const TURN: Duration = Duration::from_millis(2);

impl<'a> DepthEngine<'a> {
    /// Follows deep starts for `inner` on `threads` threads, or on one for every core.
    pub fn new(inner: Box<dyn Engine + 'a>, threads: Option<usize>) -> Result<Self, EngineError> {
        let pool = thread_pool("depth", threads)?;
        let (sender, receiver) = channel();
        Ok(DepthEngine {
            inner,
            pool,
            splittings: Splittings::default(),
            deep: HashMap::new(),
            sub_jobs: HashMap::new(),
            next_sub_job: FIRST_SUB_JOB,
            waiting: VecDeque::new(),
            flying: 0,
            following: 0,
            samples: Vec::new(),
            lines: true,
            #[cfg(feature = "sabotage")]
            sabotage: None,
            cancelled: Arc::default(),
            told: Following::default(),
            sender,
            receiver,
        })
    }

    /// Turns lines off: the engine integrates every start for which polynomials give no outcome.
    pub fn without_lines(mut self) -> Self {
        self.lines = false;
        self
    }

    /// Makes the engine report its progress in following the middle of a deep view to `following`.
    pub fn telling(mut self, following: Following) -> Self {
        self.told = following;
        self
    }

    /// Makes all start maps of the engine wrong.
    #[cfg(feature = "sabotage")]
    pub fn sabotaged(mut self, sabotage: sabotage::Sabotage) -> Self {
        self.sabotage = Some(sabotage);
        self
    }

    fn follow(&mut self, job: Job) {
        let Starts::Deep(deep) = &job.starts else { return };
        let nudges = job.keep.ends == Needs::Growth;
        let splitting = splitting_of(
            &self.splittings,
            #[cfg(feature = "sabotage")]
            self.sabotage,
            &job.question,
            deep,
            nudges,
        );
        let (sender, cancelled) = (self.sender.clone(), self.cancelled.clone());
        let (lines, told) = (self.lines, self.told.clone());
        self.deep.insert(job.id, None);
        self.following += 1;
        self.pool.spawn_fifo(move || {
            if let Some(followed) = followed(job, &splitting, lines, &cancelled, &told) {
                // The receiver is gone once the job is cancelled.
                let _ = sender.send(followed);
            }
        });
    }

    /// Queues the next samples of a job's lines or, once these have answered all they can, the
    /// starts that are left. Returns the job's result if all of it is known.
    fn keep_going(&mut self, mut awaited: PartialResult) -> Option<JobResult> {
        if let Some(mut lines) = awaited.lines.take() {
            match lines.ask(samples_of(&mut self.samples, &awaited.job)) {
                Need::Nothing => awaited.take_lines(lines),
                Need::Others => awaited.lines = Some(lines),
                Need::Samples(wanted) => {
                    for (since, group) in by_time(wanted) {
                        let (places, states) = group.into_iter().unzip();
                        let purpose = Purpose::Samples(places);
                        self.depart(&mut awaited, Keep::ENDS, purpose, since, states);
                    }
                    awaited.lines = Some(lines);
                }
            }
        }
        if awaited.lines.is_none() {
            for (since, starts) in by_time(std::mem::take(&mut awaited.moving)) {
                let states = starts.iter().map(|(_, state)| state.clone()).collect();
                let keep = awaited.job.keep;
                self.depart(&mut awaited, keep, Purpose::Starts(starts), since, states);
            }
            if awaited.sub_jobs == 0 {
                self.deep.remove(&awaited.job.id);
                return Some(awaited.result());
            }
        }
        self.deep.insert(awaited.job.id, Some(awaited));
        None
    }

    /// Queues pendulums of a deep job.
    fn depart(
        &mut self,
        awaited: &mut PartialResult,
        keep: Keep,
        purpose: Purpose,
        since: f64,
        states: Vec<Moving>,
    ) {
        let id = self.next_sub_job;
        self.next_sub_job += 1;
        awaited.sub_jobs += 1;
        self.sub_jobs.insert(id, SubJob { job: awaited.job.id, purpose });
        self.waiting.push_back(SubJob::job(id, &awaited.job, keep, since, states));
    }

    /// Takes a result of the wrapped engine, and returns what it completes: deep jobs, or, if it
    /// belongs to none, the result itself.
    fn take_finished(&mut self, finished: JobResult) -> Vec<JobResult> {
        self.flying -= 1;
        let Some(SubJob { job, purpose }) = self.sub_jobs.remove(&finished.id) else {
            return vec![finished];
        };
        let Some(Some(awaited)) = self.deep.get_mut(&job) else { return Vec::new() };
        awaited.sub_jobs -= 1;
        awaited.effort += finished.effort;
        match purpose {
            Purpose::Samples(places) => {
                samples_of(&mut self.samples, &awaited.job).insert(places, &finished);
            }
            Purpose::Starts(starts) => awaited.merge(&starts, &finished),
        }
        self.landed()
    }

    /// Continues the jobs that have no sub-jobs in flight, because all are complete or because the
    /// jobs wait for samples of other jobs. Returns the results of the jobs that are complete.
    fn landed(&mut self) -> Vec<JobResult> {
        let is_ready = |awaited: &PartialResult| awaited.sub_jobs == 0;
        let mut ready: Vec<u64> = Vec::new();
        for (id, awaited) in &self.deep {
            ready.extend(awaited.as_ref().is_some_and(is_ready).then_some(*id));
        }
        ready.sort_unstable();
        let mut finished = Vec::new();
        for id in ready {
            let awaited = self.deep.get_mut(&id).and_then(Option::take);
            finished.extend(awaited.and_then(|awaited| self.keep_going(awaited)));
        }
        finished
    }

    /// Keeps the wrapped engine's slots full.
    fn feed(&mut self) -> Result<(), EngineError> {
        while self.flying < self.inner.slots() {
            let Some(job) = self.waiting.pop_front() else { break };
            self.inner.submit(job)?;
            self.flying += 1;
        }
        Ok(())
    }
}

impl Engine for DepthEngine<'_> {
    fn submit(&mut self, job: Job) -> Result<(), EngineError> {
        match job.starts {
            Starts::Deep(_) => self.follow(job),
            _ => self.waiting.push_back(job),
        }
        self.feed()
    }

    fn poll(&mut self, wait: Wait) -> Result<Vec<JobResult>, EngineError> {
        let mut finished = Vec::new();
        loop {
            while let Ok(followed) = self.receiver.try_recv() {
                self.following -= 1;
                finished.extend(self.keep_going(followed));
            }
            self.feed()?;
            let idle = self.flying == 0 && self.following == 0;
            let late = matches!(wait, Wait::Until(moment) if Instant::now() >= moment);
            if !finished.is_empty() || idle || late {
                return Ok(finished);
            }
            let until = match wait {
                Wait::Until(moment) => moment,
                Wait::UntilFinished => Instant::now() + Duration::from_secs(1),
            };
            if self.flying == 0 {
                let left = until.saturating_duration_since(Instant::now());
                if let Ok(followed) = self.receiver.recv_timeout(left) {
                    self.following -= 1;
                    finished.extend(self.keep_going(followed));
                }
                continue;
            }
            let turn = if self.following > 0 { until.min(Instant::now() + TURN) } else { until };
            for answer in self.inner.poll(Wait::Until(turn))? {
                finished.extend(self.take_finished(answer));
            }
        }
    }

    fn begin_picture(&mut self) {
        self.inner.begin_picture();
    }

    fn cancel(&mut self) {
        self.cancelled.store(true, Ordering::Relaxed);
        self.cancelled = Arc::default();
        (self.sender, self.receiver) = channel();
        self.inner.cancel();
        self.deep.clear();
        self.sub_jobs.clear();
        self.waiting.clear();
        self.samples.iter_mut().for_each(LineSamples::cancel);
        (self.flying, self.following) = (0, 0);
    }

    /// One more than the wrapped engine's: one job is followed while others are integrated.
    fn slots(&self) -> usize {
        self.inner.slots() + 1
    }

    fn job_size(&self) -> usize {
        self.inner.job_size()
    }

    fn kind(&self) -> EngineKind {
        self.inner.kind()
    }

    fn adapter(&self) -> String {
        self.inner.adapter()
    }

    fn offers(&self, config: &IntegratorConfig) -> bool {
        self.inner.offers(config)
    }

    fn checks_by(&self, config: &IntegratorConfig) -> bool {
        self.inner.checks_by(config)
    }

    fn gpu_stats(&self) -> Option<GpuStats> {
        self.inner.gpu_stats()
    }
}

impl Drop for DepthEngine<'_> {
    fn drop(&mut self) {
        self.cancel();
    }
}
