//! Deep zoom: an engine for starts too close together for the number types of engines.
//!
//! It wraps another engine. The leaf of the lattice in which deep starts lie has an ancestor 6 to
//! 11 levels up, the *anchor*. Its middle is followed in as many digits as the depth needs, its
//! whole area as one [`FlowPatch`](crate::physics::flow_patch::FlowPatch): Taylor polynomials of
//! the flow map in the position of the start. Their coefficients are differences from the middle,
//! for which f64 has digits enough at any depth, as with the reference orbit of a deep Mandelbrot
//! zoom.
//!
//! ```text
//!  level        time ──▶
//!  L−11 … L−6   anchor ├────────────┤ polynomials no longer hold: quarters
//!   …           quarter             ├──────┤ quarters
//!  L            leaf                       ├─────────┤ start map
//!               samples of its line                   ├── integrated, tell most starts
//!               other starts                          ├── integrated one by one
//! ```
//!
//! Where the polynomials leave out too much, or cannot tell what happens at the top, the cell is
//! cut into quarters that continue on their own (automatic domain splitting; Wittig et al., Celest.
//! Mech. Dyn. Astr. 122, 2015; polynomial arithmetic on flows is Berz's differential algebra). The
//! finished patch gives each of its leaves a *start map*: which starts are forbidden, flip at a
//! known time or stay unflipped, and in which states the others are, far enough apart by then that
//! any number type can integrate them. By then most leaves have one direction alone; a few samples
//! along it tell most of its starts ([`lines`]). Samples, and the starts that these do not tell, go to
//! the wrapped engine as pendulums in motion, and all other jobs are passed on to it.
//!
//! * An answer depends on its leaf's place in the lattice alone, not on jobs or other requests.
//! * Anchors and splittings are cached, and cells are followed on threads of this engine's own, eight
//!   at a time in SIMD lanes ([`split_lanes`]).
//! * Strict jobs use other cuts and smaller errors: [`super::trust`] checks one map by another.

mod deep;
mod domain_splitting;
mod finished_patch;
mod followed_job;
mod following;
mod line_interval;
mod lines;
mod part;
mod split_lanes;
mod stats;

use std::collections::{HashMap, VecDeque};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use self::followed_job::{Awaited, Followed, Splittings, followed, splitting_of};
pub use self::following::Following;
use self::lines::{LineSamples, Lines, Need, samples_of};
pub use self::stats::DepthStats;
use super::{
    Engine, EngineError, EngineKind, IntegratorConfig, Job, JobResult, Keep, Starts, Wait,
};

/// An engine that follows deep starts for the engine that it wraps.
pub struct DepthEngine<'a> {
    inner: Box<dyn Engine + 'a>,
    pool: rayon::ThreadPool,
    splittings: Splittings,
    /// Deep jobs by identifier: some are being followed, others are with the wrapped engine.
    deep: HashMap<u64, Awaited>,
    /// Jobs for which the wrapped engine has no free slot yet.
    waiting: VecDeque<Job>,
    flying: usize,
    following: usize,
    /// Samples of lines, for the questions and configurations met so far, the latest last.
    samples: Vec<LineSamples>,
    cancelled: Arc<AtomicBool>,
    told: Following,
    sender: Sender<Followed>,
    receiver: Receiver<Followed>,
}

/// Longest wait for one source of answers before the other is looked at.
const TURN: Duration = Duration::from_millis(2);

impl<'a> DepthEngine<'a> {
    /// Follows deep starts for `inner` on `threads` threads, or on one for every core.
    pub fn new(inner: Box<dyn Engine + 'a>, threads: Option<usize>) -> Result<Self, EngineError> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.unwrap_or(0))
            .thread_name(|index| format!("depth-{index}"))
            .build()
            .map_err(|error| EngineError::Unsupported(format!("cannot start threads: {error}")))?;
        let (sender, receiver) = channel();
        Ok(DepthEngine {
            inner,
            pool,
            splittings: Splittings::default(),
            deep: HashMap::new(),
            waiting: VecDeque::new(),
            flying: 0,
            following: 0,
            samples: Vec::new(),
            cancelled: Arc::default(),
            told: Following::default(),
            sender,
            receiver,
        })
    }

    /// Makes the engine report its progress in following a middle to `following`.
    pub fn telling(mut self, following: Following) -> Self {
        self.told = following;
        self
    }

    fn follow(&mut self, job: Job) {
        let Starts::Deep(deep) = &job.starts else { return };
        let splitting = splitting_of(&self.splittings, &job.question, deep.strict);
        let (sender, cancelled) = (self.sender.clone(), self.cancelled.clone());
        let told = self.told.clone();
        self.deep.insert(job.id, Awaited::default());
        self.following += 1;
        self.pool.spawn_fifo(move || {
            if let Some(followed) = followed(job, &splitting, &cancelled, &told) {
                // The receiver is gone once the job is cancelled.
                let _ = sender.send(followed);
            }
        });
    }

    /// Takes a deep job whose cells have been followed; returns its result if all of it is known.
    fn take_followed(&mut self, followed: Followed) -> Option<JobResult> {
        self.following -= 1;
        let Followed { job, awaited, lines } = followed;
        match lines {
            Some(lines) => self.sample(job, awaited, lines),
            None => self.integrate(job, awaited),
        }
    }

    /// Queues the next samples of a job's lines; once these tell all they can, the starts that are
    /// left.
    fn sample(&mut self, job: Job, mut awaited: Awaited, mut lines: Lines) -> Option<JobResult> {
        match lines.ask(samples_of(&mut self.samples, &job)) {
            Need::Nothing => {
                awaited.effort.depth = awaited.effort.depth.map(|depth| lines.counted(depth));
                let Lines { known, mut alone, .. } = lines;
                for (place, outcome) in known {
                    awaited.outcomes[place] = outcome;
                }
                alone.sort_unstable();
                awaited.moving.retain(|(place, _)| alone.binary_search(place).is_ok());
                return self.integrate(job, awaited);
            }
            Need::Samples(wanted) => {
                let starts = Starts::Moving(wanted);
                self.waiting.push_back(Job { starts, keep: Keep::Ends, ..job.clone() });
            }
            Need::Others => {}
        }
        let id = job.id;
        awaited.lines = Some((job, lines));
        self.deep.insert(id, awaited);
        None
    }

    /// Goes on with the jobs that need no samples but those of others; returns the results of those
    /// that this completes.
    fn sample_on(&mut self) -> Vec<JobResult> {
        let waits = |awaited: &Awaited| {
            awaited.lines.as_ref().is_some_and(|(_, lines)| lines.is_waiting_for_others())
        };
        let mut ready: Vec<u64> =
            self.deep.iter().filter(|(_, awaited)| waits(awaited)).map(|(id, _)| *id).collect();
        ready.sort_unstable();
        let mut finished = Vec::new();
        for id in ready {
            let Some(mut awaited) = self.deep.remove(&id) else { continue };
            let Some((job, lines)) = awaited.lines.take() else { continue };
            finished.extend(self.sample(job, awaited, lines));
        }
        finished
    }

    /// Queues the starts that have to be integrated one by one; returns the result if there are none.
    fn integrate(&mut self, job: Job, awaited: Awaited) -> Option<JobResult> {
        if awaited.moving.is_empty() {
            self.deep.remove(&job.id);
            let Awaited { outcomes, ends, effort, .. } = awaited;
            let ends = if job.keep == Keep::Ends { ends } else { Vec::new() };
            return Some(JobResult { id: job.id, outcomes, ends, effort, ..JobResult::default() });
        }
        let states = awaited.moving.iter().map(|(_, state)| *state).collect();
        self.deep.insert(job.id, awaited);
        self.waiting.push_back(Job { starts: Starts::Moving(states), ..job });
        None
    }

    /// Takes a result of the wrapped engine, and returns what it completes: deep jobs, or, if it
    /// belongs to none, the result itself.
    fn take_finished(&mut self, finished: JobResult) -> Vec<JobResult> {
        self.flying -= 1;
        let Some(mut awaited) = self.deep.remove(&finished.id) else { return vec![finished] };
        if let Some((job, lines)) = &mut awaited.lines {
            lines.answer(samples_of(&mut self.samples, job), &finished);
            awaited.effort += finished.effort;
            self.deep.insert(finished.id, awaited);
            return self.sample_on();
        }
        vec![awaited.complete(finished)]
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
                finished.extend(self.take_followed(followed));
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
                    finished.extend(self.take_followed(followed));
                }
                continue;
            }
            let turn = if self.following > 0 { until.min(Instant::now() + TURN) } else { until };
            for answer in self.inner.poll(Wait::Until(turn))? {
                finished.extend(self.take_finished(answer));
            }
        }
    }

    fn cancel(&mut self) {
        self.cancelled.store(true, Ordering::Relaxed);
        self.cancelled = Arc::default();
        (self.sender, self.receiver) = channel();
        self.inner.cancel();
        self.deep.clear();
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
}

impl Drop for DepthEngine<'_> {
    fn drop(&mut self) {
        self.cancel();
    }
}
