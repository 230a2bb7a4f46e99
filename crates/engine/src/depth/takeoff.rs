//! Takeoffs: pendulums of a deep job that set out at about the same time and are integrated
//! together.

use std::collections::BTreeMap;

use super::finished_patch::PartKey;
use super::followed_job::may_use_lines;
use super::lines::Place;
use crate::{Job, Keep, Moving, MovingStarts, Starts};

/// Reduced time within which pendulums set out together.
const TOGETHER: f64 = 4.0;

/// Pendulums on their way through the wrapped engine.
pub(super) struct SubJob {
    /// The deep job that they belong to.
    pub job: u64,
    pub purpose: Purpose,
}

/// The purpose of a sub-job's pendulums.
pub(super) enum Purpose {
    /// Samples of lines, at these places.
    Samples(Vec<(PartKey, Place)>),
    /// Starts of the job by their indices, with the states in which they set out.
    Starts(Vec<(usize, Moving)>),
}

impl SubJob {
    /// The job that integrates pendulums for a deep job; all have set out by the time `since`.
    pub(super) fn job(id: u64, deep: &Job, keep: Keep, since: f64, states: Vec<Moving>) -> Job {
        let (_, unit_secs) = deep.question.reduced();
        let end = may_use_lines(deep).then_some(deep.question.budget_secs / unit_secs);
        let starts = Starts::Moving(MovingStarts { since, end, states });
        Job { id, question: deep.question, config: deep.config, starts, keep }
    }
}

/// Groups pendulums by the time at which they set out. Each group comes with the last time at which
/// any of its pendulums can set out, so that every pendulum's answer depends on its own time alone.
pub(super) fn by_time<T>(all: Vec<(T, Moving)>) -> impl Iterator<Item = (f64, Vec<(T, Moving)>)> {
    let mut groups: BTreeMap<i64, Vec<(T, Moving)>> = BTreeMap::new();
    for one in all {
        groups.entry((one.1.time[0] / TOGETHER).ceil() as i64).or_default().push(one);
    }
    groups.into_iter().map(|(group, all)| (group as f64 * TOGETHER, all))
}
