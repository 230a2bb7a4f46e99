//! Deep jobs whose cells are followed, and what is known of their answers.

use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

use super::domain_splitting::{DomainSplitting, SplitRequest};
use super::finished_patch::MappedStart;
use super::following::Following;
use super::lines::Lines;
use super::part::PlacedStart;
use super::stats::DepthStats;
use crate::engine::{
    Effort, End, Job, JobResult, Keep, Method, Moving, Precision, Question, Starts,
};
use crate::physics::{Outcome, Status};

/// The domain splittings of the pendulums and rules met so far, the latest last.
pub(super) type Splittings = Arc<Mutex<Vec<Arc<DomainSplitting>>>>;

/// Largest number of splittings that are kept.
const MOST_SPLITTINGS: usize = 4;

/// The known part of a deep job, to be merged with the wrapped engine's answer.
#[derive(Default)]
pub(super) struct Awaited {
    pub outcomes: Vec<Outcome>,
    pub ends: Vec<End>,
    /// Indices of the starts that the wrapped engine integrates, and the states they begin in.
    pub moving: Vec<(usize, Moving)>,
    /// The job and its lines, while samples of these are integrated.
    pub lines: Option<(Job, Lines)>,
    pub effort: Effort,
}

/// A deep job whose cells have been followed, with its lines if it may use any.
pub(super) struct Followed {
    pub job: Job,
    pub awaited: Awaited,
    pub lines: Option<Lines>,
}

/// Returns the domain splitting of a question, made if there is none yet.
pub(super) fn splitting_of(
    splittings: &Splittings,
    question: &Question,
    strict: bool,
) -> Arc<DomainSplitting> {
    let mut splittings = splittings.lock().unwrap_or_else(|broken| broken.into_inner());
    if let Some(splitting) = splittings.iter().find(|splitting| splitting.is_of(question, strict)) {
        return splitting.clone();
    }
    if splittings.len() == MOST_SPLITTINGS {
        splittings.remove(0);
    }
    splittings.push(Arc::new(DomainSplitting::new(question, strict)));
    splittings[splittings.len() - 1].clone()
}

/// Follows the cells of a job and maps its starts through them; returns none if cancelled.
pub(super) fn followed(
    mut job: Job,
    splitting: &DomainSplitting,
    cancelled: &AtomicBool,
    told: &Following,
) -> Option<Followed> {
    let count = job.starts.len();
    let Starts::Deep(deep) = std::mem::replace(&mut job.starts, Starts::Moving(Vec::new())) else {
        return None;
    };
    let question = job.question;
    let (_, unit_secs) = question.reduced();
    let level = deep.leaves.first().map_or(0, |leaf| leaf.cell.level);
    let wanted = SplitRequest { level, budget: question.budget_secs / unit_secs, cancelled, told };
    let distribution = splitting.distribute(&deep, wanted)?;
    let dynamics = &splitting.dynamics;
    let mut lines = may_use_lines(&job).then(|| Lines::new(*dynamics, unit_secs));
    let mut awaited = Awaited::of_forbidden(count);
    let mut depth = DepthStats::NOTHING;
    for (patch, starts) in &distribution.patches {
        let before = awaited.moving.len();
        for PlacedStart { index, at } in starts {
            let start = patch.start(dynamics, &question, unit_secs, *at);
            awaited.take(*index, start);
        }
        let moving = &awaited.moving[before..];
        depth = depth.and(DepthStats {
            digits: splitting.digits(level),
            ..patch.stats(dynamics, unit_secs, moving.len())
        });
        if let Some(lines) = lines.as_mut().filter(|_| !moving.is_empty()) {
            lines.add(patch, moving);
        }
    }
    awaited.moving.sort_unstable_by_key(|(index, _)| *index);
    awaited.effort = Effort { depth: Some(depth), ..Effort::default() };
    Some(Followed { job, awaited, lines })
}

impl Awaited {
    /// Nothing but forbidden starts.
    fn of_forbidden(count: usize) -> Self {
        let outcomes = vec![Outcome { status: Status::Forbidden, time: 0.0 }; count];
        Awaited { outcomes, ends: vec![End::NOWHERE; count], ..Awaited::default() }
    }

    /// Merges the wrapped engine's answers for the starts in motion.
    pub(super) fn complete(self, finished: JobResult) -> JobResult {
        let Awaited { mut outcomes, mut ends, moving, mut effort, .. } = self;
        for (&(place, _), outcome) in moving.iter().zip(&finished.outcomes) {
            outcomes[place] = *outcome;
        }
        for ((place, begun), end) in moving.iter().zip(&finished.ends) {
            let clearance = end.clearance.min(begun.clearance);
            ends[*place] = End { clearance, grown: begun.grown, ..*end };
        }
        if finished.ends.is_empty() {
            ends.clear();
        }
        let unfinished = finished.unfinished.into_iter().map(|(k, state)| (moving[k].0, state));
        effort += finished.effort;
        let unfinished = unfinished.collect();
        JobResult { outcomes, ends, unfinished, effort, ..finished }
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

/// Returns true if a job's starts may be told from those beside them on a line: it wants outcomes
/// alone, of a method whose errors are far below what neighbours differ by.
fn may_use_lines(job: &Job) -> bool {
    let adaptive = !matches!(job.config.method, Method::Rk4 { .. });
    adaptive && job.config.precision != Precision::F32 && job.keep != Keep::Ends
}
