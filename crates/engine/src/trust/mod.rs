//! Verification: every start is computed again and again, by other methods and in more digits,
//! until its answer is *sure*, or else the answer is marked as uncertain.
//!
//! Nearby starts move apart exponentially, so a single run cannot know its own error. But every run
//! has an *error scale*, the error at the release that grows into its expected error at the end,
//! and all runs of a start share the growth from there on. So the distance between a fine and a
//! coarse run measures the growth, and growth times the fine run's scale is the fine run's error:
//! an a-posteriori estimate.
//!
//! ```text
//!  all starts     the requested configuration, and DOPRI5 in f32     [ladder]
//!                 └ sure? ── the finest run against the others        [judge]
//!  those left     the same in f32 from a start 3e-7 rad aside
//!                 DOP853 and DOPRI5 in f64
//!                 Taylor expansions in f64, DOP853 from starts 1e-12 aside
//!                 extrapolated midpoint rules in double-double
//!                 Taylor expansions in double-double
//!                 midpoint rules again, finer
//!  what is left   is uncertain
//! ```
//!
//! The finest answer so far is sure when three things hold: the chance that the other runs are so
//! near it by accident, although it is wrong, is below 1e-6; one of the runs that agree uses
//! another method with another event test; and growth explains the runs that are far off. An answer
//! counts as wrong if its flip time is off by more than is allowed, or if its run may have taken a
//! near miss of the top for a crossing. This is a statistical argument, not an enclosure.
//!
//! Nine in ten starts of the home map are sure after the first rung. [`TrustEngine`] wraps another
//! engine and adds a [`Trust`] to each of its answers. Deep starts climb a ladder of their own, and
//! some are integrated directly ([`Opinion`]); unchecked pictures have an [`AccuracyEstimate`].

use crate::EngineKind;
use crate::clock::Instant;
use std::collections::{HashMap, VecDeque};
use std::time::Duration;

use serde::{Deserialize, Serialize};

mod assurance;
mod checked_job;
pub mod direct;
mod judge;
mod ladder;
mod opinion;
mod outlook;

pub use self::assurance::Assurance;
use self::checked_job::{CheckedJob, RUNS};
pub use self::opinion::Opinion;
pub use self::outlook::AccuracyEstimate;
use super::cpu::CpuEngine;
use super::depth::DepthEngine;
use super::{Engine, EngineError, GpuStats, IntegratorConfig, Job, JobResult, Starts, Wait};
use flipmap_pendulum::{Outcome, Status};

/// Degree to which an answer is sure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[repr(u8)]
pub enum Trust {
    /// An answer that was not checked.
    #[default]
    Unchecked = 0,
    /// An answer that cheap checks make sure.
    Agreed = 1,
    /// An answer that checks in more digits of f64 make sure.
    Confirmed = 2,
    /// An answer that checks in double-double make sure.
    Settled = 3,
    /// An answer that no check makes sure.
    Uncertain = 4,
}

impl Trust {
    /// Every value with its name, in order.
    pub const ALL: [(&'static str, Trust); 5] = [
        ("unchecked", Trust::Unchecked),
        ("agreed", Trust::Agreed),
        ("confirmed", Trust::Confirmed),
        ("settled", Trust::Settled),
        ("uncertain", Trust::Uncertain),
    ];

    /// Trust in an outcome that is proved before anything is computed. Forbidden outcomes need no
    /// trust, and count as unchecked.
    pub fn of_proved(outcome: &Outcome) -> Trust {
        if outcome.status == Status::Forbidden { Trust::Unchecked } else { Trust::Agreed }
    }
}

/// An engine that checks the answers of the engine that it wraps. The wrapped engine runs the
/// configurations for which [`Engine::checks_by`] returns true, the processor all others.
pub struct TrustEngine<'a> {
    inner: Box<dyn Engine + 'a>,
    /// The processor; `None` if `inner` is the processor itself.
    checker: Option<DepthEngine<'static>>,
    waiting: [VecDeque<Job>; 2],
    flying: [usize; 2],
    cases: HashMap<u64, CheckedJob>,
    /// True if every answer is marked, even those found sure.
    distrusts: bool,
}

/// Longest wait for one engine before the other is polled.
const TURN: Duration = Duration::from_millis(2);

impl<'a> TrustEngine<'a> {
    /// Wraps `inner` to check its answers; the processor's part runs on `threads` threads.
    pub fn new(inner: Box<dyn Engine + 'a>, threads: Option<usize>) -> Result<Self, EngineError> {
        let checker = if inner.kind() == EngineKind::Cpu {
            None
        } else {
            Some(DepthEngine::new(Box::new(CpuEngine::new(threads)?), threads)?)
        };
        Ok(TrustEngine {
            inner,
            checker,
            waiting: Default::default(),
            flying: [0; 2],
            cases: HashMap::new(),
            distrusts: false,
        })
    }

    /// Sets whether from now on every answer is marked, because one that was sure has been
    /// contradicted.
    pub fn distrust(&mut self, distrusts: bool) {
        self.distrusts = distrusts;
    }

    /// Index of the engine that runs a configuration: 0 for the wrapped one, 1 for the processor
    /// beside it.
    fn place_of(&self, config: &IntegratorConfig) -> usize {
        usize::from(self.checker.is_some() && !self.inner.checks_by(config))
    }

    fn engine(&mut self, place: usize) -> &mut (dyn Engine + 'a) {
        match (&mut self.checker, place) {
            (Some(checker), 1) => checker,
            _ => self.inner.as_mut(),
        }
    }

    fn send(&mut self, job: Job) {
        let place = self.place_of(&job.config);
        self.waiting[place].push_back(job);
    }

    /// Keeps both engines' slots full.
    fn feed(&mut self) -> Result<(), EngineError> {
        for place in 0..2 {
            while self.flying[place] < self.engine(place).slots() {
                let Some(job) = self.waiting[place].pop_front() else { break };
                self.engine(place).submit(job)?;
                self.flying[place] += 1;
            }
        }
        Ok(())
    }

    /// Waits briefly for either engine and returns the jobs that have finished.
    fn land(&mut self, until: Instant) -> Result<Vec<JobResult>, EngineError> {
        let mut landed = Vec::new();
        let both = self.flying.iter().all(|&flying| flying > 0);
        for place in 0..2 {
            if self.flying[place] > 0 {
                let until = if both { until.min(Instant::now() + TURN) } else { until };
                let finished = self.engine(place).poll(Wait::Until(until))?;
                self.flying[place] -= finished.len();
                landed.extend(finished);
            }
        }
        Ok(landed)
    }

    /// Passes a run's answers to their checked job, and sends the jobs that follow from them.
    fn take(&mut self, finished: JobResult) -> Option<JobResult> {
        let (id, run) = (finished.id / RUNS, finished.id % RUNS);
        let jobs = self.cases.get_mut(&id)?.take(run, finished)?;
        if jobs.is_empty() {
            let mut finished = self.cases.remove(&id).map(CheckedJob::finish)?;
            if self.distrusts {
                for assurance in &mut finished.assurances {
                    *assurance = assurance.with_trust(Trust::Uncertain);
                }
            }
            return Some(finished);
        }
        jobs.into_iter().for_each(|job| self.send(job));
        None
    }
}

impl Engine for TrustEngine<'_> {
    fn submit(&mut self, job: Job) -> Result<(), EngineError> {
        if let Starts::Resumed { .. } | Starts::Moving(_) = job.starts {
            let why = "checking begins at the release: a paused pendulum cannot be checked";
            return Err(EngineError::Unsupported(why.to_string()));
        }
        let id = job.id;
        let (case, jobs) = CheckedJob::new(job);
        jobs.into_iter().for_each(|job| self.send(job));
        self.cases.insert(id, case);
        self.feed()
    }

    fn poll(&mut self, wait: Wait) -> Result<Vec<JobResult>, EngineError> {
        loop {
            self.feed()?;
            let until = match wait {
                Wait::Until(moment) => moment,
                Wait::UntilFinished => Instant::now() + Duration::from_secs(1),
            };
            let landed = self.land(until)?;
            let finished: Vec<JobResult> =
                landed.into_iter().filter_map(|finished| self.take(finished)).collect();
            let late = matches!(wait, Wait::Until(moment) if Instant::now() >= moment);
            if !finished.is_empty() || self.cases.is_empty() || late {
                return Ok(finished);
            }
        }
    }

    fn begin_picture(&mut self) {
        self.inner.begin_picture();
    }

    fn cancel(&mut self) {
        self.inner.cancel();
        if let Some(checker) = &mut self.checker {
            checker.cancel();
        }
        self.waiting = Default::default();
        self.flying = [0; 2];
        self.cases.clear();
    }

    /// Two more than the wrapped engine's: while a checked job waits for its slowest pixel, other
    /// jobs fill the engines.
    fn slots(&self) -> usize {
        self.inner.slots() + 2
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

    fn gpu_stats(&self) -> Option<GpuStats> {
        self.inner.gpu_stats()
    }

    fn distrusts(&self) -> bool {
        self.distrusts
    }
}

#[cfg(test)]
mod clauses;
#[cfg(test)]
mod witnesses;
