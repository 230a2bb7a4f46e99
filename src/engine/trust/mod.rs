//! Verification: every start computed again and again, by other methods and in more digits, until
//! its answer is sure.
//!
//! ```text
//!  all starts     the config asked for, and DOPRI5 in f32            [ladder]
//!                 └ sure? ── the finest run against the others        [judge]
//!  those left     the same in f32 from a start a millionth aside
//!                 DOP853 and DOPRI5 in f64
//!                 Taylor expansions in f64, DOP853 from starts 1e-12 aside
//!                 extrapolated midpoint rules in double-double
//!                 Taylor expansions in double-double, midpoint rules again
//!  what is left   is uncertain
//! ```
//!
//! Nine in ten starts of the home map leave after the first rung. The engine here wraps another
//! one and adds a [`Trust`] to each of its answers. Deep starts climb a ladder of their own, and a few
//! of them are integrated directly ([`Opinion`]); pictures that nobody checks have an [`Outlook`].

use std::collections::{HashMap, VecDeque};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

mod checked_job;
mod judge;
mod ladder;
mod opinion;
mod outlook;

use self::checked_job::{CheckedJob, RUNS};
pub use self::opinion::Opinion;
pub use self::outlook::Outlook;
use super::cpu::CpuEngine;
use super::depth::DepthEngine;
use super::{Engine, EngineError, IntegratorConfig, Job, JobResult, Starts, Wait};
use crate::physics::{Outcome, Status};

/// How sure an answer is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[repr(u8)]
pub enum Trust {
    /// Nobody looked.
    #[default]
    Unchecked = 0,
    /// Cheap checks show it to be right.
    Agreed = 1,
    /// More digits of f64 do.
    Confirmed = 2,
    /// Double-double does.
    Settled = 3,
    /// Nothing does.
    Uncertain = 4,
}

impl Trust {
    /// Every value with its word, in order.
    pub const ALL: [(&'static str, Trust); 5] = [
        ("unchecked", Trust::Unchecked),
        ("agreed", Trust::Agreed),
        ("confirmed", Trust::Confirmed),
        ("settled", Trust::Settled),
        ("uncertain", Trust::Uncertain),
    ];

    /// Of an outcome that is proved before anything is computed. Nobody asks about forbidden ones.
    pub fn of_proved(outcome: &Outcome) -> Trust {
        if outcome.status == Status::Forbidden { Trust::Unchecked } else { Trust::Agreed }
    }
}

/// The engine of configs and probes, and the processor for what comes after.
pub struct TrustEngine<'a> {
    inner: Box<dyn Engine + 'a>,
    /// None where `inner` is the processor itself.
    checker: Option<DepthEngine<'static>>,
    waiting: [VecDeque<Job>; 2],
    flying: [usize; 2],
    cases: HashMap<u64, CheckedJob>,
    /// Whether nothing it finds sure is to be called so.
    distrusts: bool,
}

/// How long one engine is waited for before the other is looked at.
const TURN: Duration = Duration::from_millis(2);

impl<'a> TrustEngine<'a> {
    /// Checks what `inner` answers; the processor's part on `threads` threads.
    pub fn new(inner: Box<dyn Engine + 'a>, threads: Option<usize>) -> Result<Self, EngineError> {
        let checker = if inner.name() == "cpu" {
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

    /// Whether from now on every answer is marked, for one that was sure has been contradicted.
    pub fn distrust(&mut self, distrusts: bool) {
        self.distrusts = distrusts;
    }

    /// 0 for the wrapped engine, 1 for the processor beside it.
    fn place_of(&self, config: &IntegratorConfig) -> usize {
        usize::from(self.checker.is_some() && !self.inner.offers(config))
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

    /// Waits a little for either engine.
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

    /// Takes an answer to its case, and sends what follows from it.
    fn take(&mut self, finished: JobResult) -> Option<JobResult> {
        let (id, run) = (finished.id / RUNS, finished.id % RUNS);
        let jobs = self.cases.get_mut(&id)?.take(run, finished)?;
        if jobs.is_empty() {
            let mut finished = self.cases.remove(&id).map(CheckedJob::finish)?;
            if self.distrusts {
                finished.trusts.fill(Trust::Uncertain);
            }
            return Some(finished);
        }
        jobs.into_iter().for_each(|job| self.send(job));
        None
    }
}

impl Engine for TrustEngine<'_> {
    fn submit(&mut self, job: Job) -> Result<(), EngineError> {
        if let Starts::Resumed(_) | Starts::Moving(_) = job.starts {
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

    fn cancel(&mut self) {
        self.inner.cancel();
        if let Some(checker) = &mut self.checker {
            checker.cancel();
        }
        self.waiting = Default::default();
        self.flying = [0; 2];
        self.cases.clear();
    }

    /// Cases wait for their slowest pixel; others fill the engines meanwhile.
    fn slots(&self) -> usize {
        self.inner.slots() + 2
    }

    fn job_size(&self) -> usize {
        self.inner.job_size()
    }

    fn name(&self) -> &'static str {
        self.inner.name()
    }

    fn adapter(&self) -> String {
        self.inner.adapter()
    }

    fn offers(&self, config: &IntegratorConfig) -> bool {
        self.inner.offers(config)
    }
}
