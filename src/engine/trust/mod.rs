//! Verification: answers checked by other methods until two independent ones agree.
//!
//! Every pendulum is run twice: by the recipe asked for, and by a probe, another method in
//! another precision. A fine recipe's probe is a fast one in f32: where the two are close, chaos
//! has not amplified the probe's errors of 1e-7 much, so it cannot have amplified the recipe's
//! of 1e-12, and the check was cheap. A coarse recipe's probe is a fine one. All that is not
//! close is run by Taylor expansions in f64, with another event test; where those are far from
//! the best answer too, in double-double; and where that was far again, in double-double with
//! other steps. What still disagrees is uncertain.
//!
//! The engine here wraps another one and adds a [`Trust`] to each of its answers.

use std::collections::{HashMap, VecDeque};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

mod case;

use self::case::{Case, FIRST, PROBED, STAGES, probe_of};
use super::cpu::CpuEngine;
use super::depth::DepthEngine;
use super::{Engine, EngineError, Finished, Job, Recipe, Starts, Wait};

/// How sure an answer is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[repr(u8)]
pub enum Trust {
    /// Nobody looked.
    #[default]
    Unchecked = 0,
    /// A cheap check agrees.
    Agreed = 1,
    /// An expensive one does.
    Confirmed = 2,
    /// Decided in double-double.
    Settled = 3,
    /// Independent answers disagree even there.
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
}

/// The engine of recipes and probes, and the processor for what comes after.
pub struct TrustEngine<'a> {
    inner: Box<dyn Engine + 'a>,
    /// None where `inner` is the processor itself.
    checker: Option<DepthEngine<'static>>,
    waiting: [VecDeque<Job>; 2],
    flying: [usize; 2],
    cases: HashMap<u64, Case>,
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
        })
    }

    /// 0 for the wrapped engine, 1 for the processor beside it.
    fn place_of(&self, recipe: &Recipe) -> usize {
        usize::from(self.checker.is_some() && !self.inner.offers(recipe))
    }

    fn engine(&mut self, place: usize) -> &mut (dyn Engine + 'a) {
        match (&mut self.checker, place) {
            (Some(checker), 1) => checker,
            _ => self.inner.as_mut(),
        }
    }

    fn send(&mut self, job: Job) {
        let place = self.place_of(&job.recipe);
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
    fn land(&mut self, until: Instant) -> Result<Vec<Finished>, EngineError> {
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

    /// Takes an answer to its case, and sends what follows from it; a case without open starts
    /// is finished.
    fn take(&mut self, finished: Finished) -> Option<Finished> {
        let (id, stage) = (finished.id / STAGES, finished.id % STAGES);
        let case = self.cases.get_mut(&id)?;
        let next = case.take(stage, finished)?;
        if let Some(recipe) = next.recipe() {
            let job = case.job_of(next, recipe);
            self.send(job);
            return None;
        }
        self.cases.remove(&id).map(Case::finish)
    }
}

impl Engine for TrustEngine<'_> {
    fn submit(&mut self, job: Job) -> Result<(), EngineError> {
        if let Starts::Paused(_) | Starts::Moving(_) = job.starts {
            let why = "checking begins at the release: a paused pendulum cannot be checked";
            return Err(EngineError::Unsupported(why.to_string()));
        }
        for (stage, recipe) in [(FIRST, job.recipe), (PROBED, probe_of(&job.recipe))] {
            let id = job.id * STAGES + stage;
            let mut job = Job { id, recipe, keep_unfinished: true, ..job.clone() };
            if let Starts::Deep(deep) = &mut job.starts {
                deep.strict = stage == PROBED;
            }
            self.send(job);
        }
        self.cases.insert(job.id, Case::new(job));
        self.feed()
    }

    fn poll(&mut self, wait: Wait) -> Result<Vec<Finished>, EngineError> {
        loop {
            self.feed()?;
            let until = match wait {
                Wait::Until(moment) => moment,
                Wait::UntilFinished => Instant::now() + Duration::from_secs(1),
            };
            let landed = self.land(until)?;
            let finished: Vec<Finished> =
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

    fn offers(&self, recipe: &Recipe) -> bool {
        self.inner.offers(recipe)
    }
}
