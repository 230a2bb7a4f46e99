//! A mock engine with a ledger that records the time span over which each pendulum was simulated,
//! and detects spans that were simulated twice.

use std::collections::{HashMap, HashSet};

use flipmap_engine::mock::MockEngine;
use flipmap_engine::{
    Engine, EngineError, EngineKind, EventSpec, IntegratorConfig, IntegratorState, Job, JobResult,
    Starts, Wait,
};
use flipmap_numbers::Dd;

/// The identity of a pendulum: the bits of its start and its gravity.
type Name = [u64; 5];

/// A span of a pendulum's simulated time.
#[derive(Clone, Copy)]
struct Span {
    name: Name,
    from_secs: f64,
    to_secs: f64,
}

#[derive(Default)]
pub(crate) struct Ledger {
    pub mock: MockEngine,
    /// True if the next poll fails and drops the jobs in flight, as a lost device does.
    pub fail_poll: bool,
    /// Number of polls without a result before each poll that has one.
    idle_polls: usize,
    /// True if the engine ignores cancellation and answers the jobs.
    pub deaf: bool,
    /// Number of pendulums simulated twice over the same time.
    pub again: usize,
    /// Number of pendulums submitted while they were already in flight.
    pub doubled: usize,
    pub cancels: usize,
    /// The submitted jobs, each with only the first of its starts.
    pub jobs: Vec<Job>,
    /// Number of starts of each submitted job.
    pub counts: Vec<usize>,
    /// Numbers of starts submitted from rest, and of starts submitted to be resumed.
    pub sent: [usize; 2],
    polls: usize,
    flying: HashMap<u64, Vec<Span>>,
    done_secs: HashMap<Name, f64>,
}

fn name(question: &EventSpec, [theta1, theta2]: [Dd; 2]) -> Name {
    [theta1.hi, theta1.lo, theta2.hi, theta2.lo, question.build.gravity.value()].map(f64::to_bits)
}

/// The time spans over which a job simulates its pendulums, for one pendulum in eight, so that the
/// ledger stays small.
fn spans(job: &Job) -> Vec<Span> {
    let span = |angle, from_secs| Span {
        name: name(&job.question, angle),
        from_secs,
        to_secs: job.question.budget_secs,
    };
    let mut spans: Vec<Span> = match &job.starts {
        Starts::Rest(angles) => angles.iter().map(|angle| span(*angle, 0.0)).collect(),
        Starts::Resumed { states, .. } => states.iter().map(|state| resumed(state, span)).collect(),
        _ => panic!("no depth and no plane with speeds is aimed at here"),
    };
    spans.retain(|span| {
        let mixed = |sum: u64, bits: &u64| (sum ^ bits).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        span.name.iter().fold(0, mixed) >> 61 == 0
    });
    spans
}

fn resumed(state: &IntegratorState, span: impl Fn([Dd; 2], f64) -> Span) -> Span {
    let [from_secs, _, hi1, lo1, hi2, lo2, ..] = state.numbers;
    span([Dd { hi: hi1, lo: lo1 }, Dd { hi: hi2, lo: lo2 }], from_secs)
}

impl Ledger {
    pub(crate) fn over(mock: MockEngine) -> Self {
        Ledger { mock, ..Ledger::default() }
    }

    /// Makes the ledger of an engine that finishes nothing in two of three frames.
    pub(crate) fn slow() -> Self {
        Ledger { idle_polls: 2, ..Ledger::default() }
    }

    /// The first start of a job whose starts are at rest.
    pub(crate) fn first_start(job: &Job) -> Option<[Dd; 2]> {
        match &job.starts {
            Starts::Rest(angles) => angles.first().copied(),
            _ => None,
        }
    }

    fn book(&mut self, span: Span) {
        let done = self.done_secs.entry(span.name).or_insert(0.0);
        self.again += usize::from(span.from_secs < *done);
        *done = done.max(span.to_secs);
    }
}

impl Engine for Ledger {
    fn submit(&mut self, job: Job) -> Result<(), EngineError> {
        let (id, spans) = (job.id, spans(&job));
        let first = match &job.starts {
            Starts::Rest(angles) => Starts::Rest(angles.iter().take(1).copied().collect()),
            Starts::Resumed { states, thrown } => Starts::Resumed {
                states: states.iter().take(1).cloned().collect(),
                thrown: *thrown,
            },
            _ => panic!("no depth and no plane with speeds is aimed at here"),
        };
        let index = usize::from(matches!(job.starts, Starts::Resumed { .. }));
        let (count, light) = (job.starts.len(), Job { starts: first, ..job.clone() });
        assert!(count > 0, "an empty job");
        self.mock.submit(job)?;
        self.sent[index] += count;
        self.jobs.push(light);
        self.counts.push(count);
        let flying: HashSet<Name> = self.flying.values().flatten().map(|span| span.name).collect();
        self.doubled += spans.iter().filter(|span| flying.contains(&span.name)).count();
        self.flying.insert(id, spans);
        Ok(())
    }

    fn poll(&mut self, wait: Wait) -> Result<Vec<JobResult>, EngineError> {
        if std::mem::take(&mut self.fail_poll) {
            self.cancel();
            return Err(EngineError::DeviceLost("a test".to_string()));
        }
        self.polls += 1;
        if wait != Wait::UntilFinished && !self.polls.is_multiple_of(self.idle_polls + 1) {
            return Ok(Vec::new());
        }
        let finished = self.mock.poll(wait)?;
        for answer in &finished {
            for span in self.flying.remove(&answer.id).unwrap_or_default() {
                self.book(span);
            }
        }
        Ok(finished)
    }

    fn cancel(&mut self) {
        self.cancels += 1;
        self.flying.clear();
        if !self.deaf {
            self.mock.cancel();
        }
    }

    fn slots(&self) -> usize {
        self.mock.slots()
    }

    fn job_size(&self) -> usize {
        self.mock.job_size()
    }

    fn offers(&self, config: &IntegratorConfig) -> bool {
        self.mock.offers(config)
    }

    fn kind(&self) -> EngineKind {
        EngineKind::Gpu
    }

    fn adapter(&self) -> String {
        self.mock.adapter()
    }
}
