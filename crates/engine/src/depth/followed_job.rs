//! Deep jobs whose cells are followed, and the known parts of their answers.

use std::cell::LazyCell;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

use super::anchor::digits;
use super::domain_splitting::{DomainSplitting, SplitRequest};
use super::finished_patch::{FORBIDDEN, FinishedPatch};
use super::following::Following;
use super::lines::Lines;
use super::part::PlacedStart;
use super::stats::DepthStats;
use crate::clock::Instant;
use crate::{
    Deep, Effort, EventSpec, FinalState, IntegratorState, Job, JobResult, Moving, MovingStarts,
    Precision, Starts,
};
use flipmap_pendulum::Outcome;
use flipmap_pendulum::flow_patch::Dynamics;
use flipmap_scene::question::Needs;

/// The domain splittings of the pendulums, rules and planes met so far, the latest last.
pub(super) type Splittings = Arc<Mutex<Vec<Arc<DomainSplitting>>>>;

/// Largest number of splittings that are kept.
const MAX_SPLITTINGS: usize = 4;

/// The known part of a deep job, to be merged with the wrapped engine's answers.
pub(super) struct PartialResult {
    /// The job, without its starts.
    pub job: Job,
    pub outcomes: Vec<Outcome>,
    /// Ends of the pendulums; empty unless the job keeps them.
    pub ends: Vec<FinalState>,
    /// States of the pendulums that have not flipped, if the job keeps them.
    pub unfinished: Vec<(usize, IntegratorState)>,
    /// Number of its sub-jobs that have not come back.
    pub sub_jobs: usize,
    /// Indices of the starts that have to be integrated one by one, and the states they are in.
    pub moving: Vec<(usize, Moving)>,
    /// The job's lines, while their samples are integrated.
    pub lines: Option<Lines>,
    /// The starts of patches that are lines. Their states are computed only if the lines leave them
    /// unanswered.
    on_lines: Vec<(Arc<FinishedPatch>, Vec<PlacedStart>)>,
    pub effort: Effort,
}

/// Returns the domain splitting of a question in the plane of some starts, with nudges if the
/// question asks for their growth; creates it if there is none yet.
pub(super) fn splitting_of(
    splittings: &Splittings,
    #[cfg(feature = "sabotage")] sabotage: Option<super::sabotage::Sabotage>,
    question: &EventSpec,
    deep: &Deep,
    nudges: bool,
) -> Arc<DomainSplitting> {
    let mut splittings = splittings.lock().unwrap_or_else(|broken| broken.into_inner());
    let of = |splitting: &&Arc<DomainSplitting>| splitting.is_of(question, deep, nudges);
    if let Some(splitting) = splittings.iter().find(of) {
        return splitting.clone();
    }
    if splittings.len() == MAX_SPLITTINGS {
        splittings.remove(0);
    }
    let splitting = DomainSplitting::new(question, deep, nudges);
    #[cfg(feature = "sabotage")]
    let splitting = splitting.sabotaged(sabotage);
    splittings.push(Arc::new(splitting));
    splittings[splittings.len() - 1].clone()
}

/// Follows the cells of a job and maps its starts through them, using lines where `lines` allows
/// it; returns `None` if cancelled.
pub(super) fn followed(
    mut job: Job,
    splitting: &DomainSplitting,
    lines: bool,
    cancelled: &AtomicBool,
    told: &Following,
) -> Option<PartialResult> {
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
    let mut awaited = PartialResult::of_forbidden(job, count);
    awaited.lines =
        (lines && may_use_lines(&awaited.job)).then(|| Lines::new(splitting.dynamics, unit_secs));
    let (cells, cell_steps) = distribution.followed;
    let cell_secs = begun.elapsed().as_secs_f64();
    let mut depth = DepthStats { cells, cell_steps, cell_secs, ..DepthStats::NOTHING };
    for (patch, starts) in distribution.patches {
        let open = if splitting.is_better_from_release(&patch) {
            awaited.take_alone(&starts, |index| {
                let (cell, at) = places[index];
                splitting.start_alone(cell, at)
            })
        } else {
            awaited.take(&splitting.dynamics, &patch, starts)
        };
        let stats = patch.stats(&splitting.dynamics, unit_secs, open);
        depth = depth.and(DepthStats { digits: digits(level), ..stats });
    }
    awaited.effort = Effort { depth: Some(depth), ..Effort::default() };
    Some(awaited)
}

impl PartialResult {
    /// Creates the result of a job as if all its starts were forbidden.
    fn of_forbidden(job: Job, count: usize) -> Self {
        let (outcome, end) = FORBIDDEN;
        let ends = if job.keep.ends == Needs::Outcome { 0 } else { count };
        PartialResult {
            job,
            outcomes: vec![outcome; count],
            ends: vec![end; ends],
            unfinished: Vec::new(),
            sub_jobs: 0,
            moving: Vec::new(),
            lines: None,
            on_lines: Vec::new(),
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
            let (grown, map_error) = (begun.grown, begun.map_error);
            let mut end = FinalState { clearance, grown, map_error, ..*end };
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
        for (place, outcome) in &lines.known {
            self.outcomes[*place] = *outcome;
        }
        let mut is_alone = vec![false; self.outcomes.len()];
        lines.alone.iter().for_each(|index| is_alone[*index] = true);
        for (patch, starts) in std::mem::take(&mut self.on_lines) {
            let alone = starts.iter().filter(|start| is_alone[start.index]);
            self.moving
                .extend(alone.map(|start| (start.index, patch.state(&lines.dynamics, start.at))));
        }
    }

    /// The result of the job, once all is known.
    pub(super) fn result(self) -> JobResult {
        let PartialResult { job: Job { id, .. }, outcomes, ends, mut unfinished, effort, .. } =
            self;
        unfinished.sort_unstable_by_key(|(index, _)| *index);
        JobResult { id, outcomes, ends, unfinished, effort, ..JobResult::default() }
    }

    /// Takes starts that are followed alone from their release, and returns the number of those
    /// that move. `begun` returns the state of the start with an index, or `None` if it is
    /// forbidden.
    fn take_alone(
        &mut self,
        starts: &[PlacedStart],
        begun: impl Fn(usize) -> Option<Moving>,
    ) -> usize {
        let before = self.moving.len();
        let moving = starts.iter().filter_map(|start| Some((start.index, begun(start.index)?)));
        self.moving.extend(moving);
        self.moving.len() - before
    }

    /// Takes the outcomes and the states that a patch gives to its starts. Returns the number of
    /// starts whose outcome it does not give.
    fn take(
        &mut self,
        dynamics: &Dynamics,
        patch: &Arc<FinishedPatch>,
        mut starts: Vec<PlacedStart>,
    ) -> usize {
        let (question, (_, unit_secs)) = (self.job.question, self.job.question.reduced());
        starts.retain(|PlacedStart { index, at }| {
            let Some((outcome, end)) = patch.known(dynamics, &question, unit_secs, *at) else {
                return true;
            };
            self.outcomes[*index] = outcome;
            if let Some(known) = self.ends.get_mut(*index) {
                *known = end;
            }
            false
        });
        let open = starts.len();
        let lines = self.lines.as_mut().filter(|_| open > 0);
        if lines.is_some_and(|lines| lines.add(patch, &starts)) {
            self.on_lines.push((patch.clone(), starts));
        } else {
            let states = starts.iter().map(|start| (start.index, patch.state(dynamics, start.at)));
            self.moving.extend(states);
        }
        open
    }
}

/// Returns true if a job's starts may be answered from their neighbours on a line: the job wants
/// only outcomes, by a method whose errors are far smaller than the differences between neighbours.
pub(super) fn may_use_lines(job: &Job) -> bool {
    let adaptive = job.config.method.step_secs().is_none();
    adaptive && job.config.precision != Precision::F32 && job.keep.ends == Needs::Outcome
}
