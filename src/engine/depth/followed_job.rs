//! Deep jobs whose cells are followed, and what is known of their answers.

use std::cell::LazyCell;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use super::anchor::digits;
use super::domain_splitting::{DomainSplitting, SplitRequest};
use super::finished_patch::MappedStart;
use super::following::Following;
use super::lines::Lines;
use super::part::PlacedStart;
use super::stats::DepthStats;
use crate::engine::{
    Deep, Effort, End, Ends, IntegratorState, Job, JobResult, Method, Moving, MovingStarts,
    Precision, Question, Starts,
};
use crate::physics::{Outcome, Status};

/// The domain splittings of the pendulums, rules and planes met so far, the latest last.
pub(super) type Splittings = Arc<Mutex<Vec<Arc<DomainSplitting>>>>;

/// Largest number of splittings that are kept.
const MOST_SPLITTINGS: usize = 4;

/// The known part of a deep job, to be merged with the wrapped engine's answers.
pub(super) struct Awaited {
    /// The job, without its starts.
    pub job: Job,
    pub outcomes: Vec<Outcome>,
    pub ends: Vec<End>,
    /// States of the starts that are unflipped, if they are kept.
    pub unfinished: Vec<(usize, IntegratorState)>,
    /// Number of its takeoffs that have not come back.
    pub takeoffs: usize,
    /// Indices of the starts that are not known, and the states they are in.
    pub moving: Vec<(usize, Moving)>,
    /// The job's lines, while samples of these are integrated.
    pub lines: Option<Lines>,
    pub effort: Effort,
}

/// Returns the domain splitting of a question in the plane of some starts, with nudges if the question
/// asks for their growth; creates it if there is none yet.
pub(super) fn splitting_of(
    splittings: &Splittings,
    question: &Question,
    deep: &Deep,
    nudges: bool,
) -> Arc<DomainSplitting> {
    let mut splittings = splittings.lock().unwrap_or_else(|broken| broken.into_inner());
    let of = |splitting: &&Arc<DomainSplitting>| splitting.is_of(question, deep, nudges);
    if let Some(splitting) = splittings.iter().find(of) {
        return splitting.clone();
    }
    if splittings.len() == MOST_SPLITTINGS {
        splittings.remove(0);
    }
    splittings.push(Arc::new(DomainSplitting::new(question, deep, nudges)));
    splittings[splittings.len() - 1].clone()
}

/// Follows the cells of a job and maps its starts through them, using lines where `lines` allows
/// it; returns none if cancelled.
pub(super) fn followed(
    mut job: Job,
    splitting: &DomainSplitting,
    lines: bool,
    cancelled: &AtomicBool,
    told: &Following,
) -> Option<Awaited> {
    let count = job.starts.len();
    let Starts::Deep(deep) =
        std::mem::replace(&mut job.starts, Starts::Moving(MovingStarts::default()))
    else {
        return None;
    };
    let question = job.question;
    let (_, unit_secs) = question.reduced();
    let level = deep.leaves.first().map_or(0, |leaf| leaf.cell.level);
    let wanted = SplitRequest { level, budget: question.budget_secs / unit_secs, cancelled, told };
    let begun = Instant::now();
    let distribution = splitting.distribute(&deep, wanted)?;
    let places = LazyCell::new(|| deep.places().collect::<Vec<_>>());
    let dynamics = &splitting.dynamics;
    let mut lines = (lines && may_use_lines(&job)).then(|| Lines::new(*dynamics, unit_secs));
    let mut awaited = Awaited::of_forbidden(job, count);
    let (cells, cell_steps) = distribution.followed;
    let cell_secs = begun.elapsed().as_secs_f64();
    let mut depth = DepthStats { cells, cell_steps, cell_secs, ..DepthStats::NOTHING };
    for (patch, starts) in &distribution.patches {
        let before = awaited.moving.len();
        for PlacedStart { index, at } in starts {
            let start = if splitting.tells_nothing(patch) {
                let (cell, at) = places[*index];
                splitting.start_alone(cell, at)
            } else {
                patch.start(dynamics, &question, unit_secs, *at)
            };
            awaited.take(*index, start);
        }
        let moving = &awaited.moving[before..];
        depth = depth.and(DepthStats {
            digits: digits(level),
            ..patch.stats(dynamics, unit_secs, moving.len())
        });
        if let Some(lines) = lines.as_mut().filter(|_| !moving.is_empty()) {
            lines.add(patch, moving);
        }
    }
    awaited.effort = Effort { depth: Some(depth), ..Effort::default() };
    awaited.lines = lines;
    Some(awaited)
}

impl Awaited {
    /// A job of forbidden starts.
    fn of_forbidden(job: Job, count: usize) -> Self {
        Awaited {
            job,
            outcomes: vec![Outcome { status: Status::Forbidden, time: 0.0 }; count],
            ends: vec![End::NOWHERE; count],
            unfinished: Vec::new(),
            takeoffs: 0,
            moving: Vec::new(),
            lines: None,
            effort: Effort::default(),
        }
    }

    /// Merges the wrapped engine's answers for some starts that were in motion.
    pub(super) fn merge(&mut self, starts: &[(usize, Moving)], finished: &JobResult) {
        for ((place, _), outcome) in starts.iter().zip(&finished.outcomes) {
            self.outcomes[*place] = *outcome;
        }
        for ((place, begun), end) in starts.iter().zip(&finished.ends) {
            let clearance = end.clearance.min(begun.clearance);
            let mut end = End { clearance, grown: begun.grown, ..*end };
            for (turns, before) in end.gathered.turns.iter_mut().zip(begun.turns) {
                *turns += before;
            }
            self.ends[*place] = end;
        }
        let unfinished = finished.unfinished.iter().map(|(k, state)| (starts[*k].0, state.clone()));
        self.unfinished.extend(unfinished);
    }

    /// Takes the outcomes that lines give; the starts that are left have to be integrated alone.
    pub(super) fn take_lines(&mut self, lines: Lines) {
        self.effort.depth = self.effort.depth.map(|depth| lines.counted(depth));
        let Lines { known, mut alone, .. } = lines;
        for (place, outcome) in known {
            self.outcomes[place] = outcome;
        }
        alone.sort_unstable();
        self.moving.retain(|(place, _)| alone.binary_search(place).is_ok());
    }

    /// The result of the job, once all is known.
    pub(super) fn result(self) -> JobResult {
        let Awaited { job: Job { id, keep, .. }, outcomes, ends, mut unfinished, effort, .. } =
            self;
        let ends = if keep.ends == Ends::None { Vec::new() } else { ends };
        unfinished.sort_unstable_by_key(|(index, _)| *index);
        JobResult { id, outcomes, ends, unfinished, effort, ..JobResult::default() }
    }

    fn take(&mut self, index: usize, start: MappedStart) {
        match start {
            MappedStart::Known(outcome, end) => {
                self.outcomes[index] = outcome;
                self.ends[index] = end;
            }
            MappedStart::Moving(state) => {
                self.outcomes[index] = Outcome::without_time(Status::Unflipped);
                self.moving.push((index, state));
            }
        }
    }
}

/// Returns true if a job's starts may be answered from their neighbours on a line: the job wants
/// only outcomes, by a method whose errors are far smaller than the differences between neighbours.
pub(super) fn may_use_lines(job: &Job) -> bool {
    let adaptive = !matches!(job.config.method, Method::Rk4 { .. });
    adaptive && job.config.precision != Precision::F32 && job.keep.ends == Ends::None
}
