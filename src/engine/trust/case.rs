//! One job on its way through the checks.

use super::Trust;
use crate::engine::level::{BALANCED, FAST};
use crate::engine::{Effort, Finished, Job, Method, Precision, Question, Recipe, Starts, start};
use crate::physics::embedded::{dop853, plus};
use crate::physics::phase::Phase;
use crate::physics::{Outcome, Status};

/// Up to this tolerance a recipe is fine.
const FINE: f64 = 1e-11;
/// The check of what the probe leaves open.
const CHECK: Recipe =
    Recipe { method: Method::Taylor { tolerance: 1e-14 }, precision: Precision::F64 };
/// The last word.
const LAST: Recipe =
    Recipe { method: Method::Taylor { tolerance: 1e-26 }, precision: Precision::Dd };
/// What the last word is checked by where growth was large.
const LAST_CHECK: Recipe =
    Recipe { method: Method::Taylor { tolerance: 1e-23 }, precision: Precision::Dd };

/// How close two answers must be. The later one of each pair has errors at least thirty times
/// smaller than the earlier one, so what is kept is right to far less than these.
const PROBE_SECS: f64 = 2e-2;
/// A coarse answer is only right if it is as close as right means.
const FINE_PROBE_SECS: f64 = 5e-4;
/// See [`PROBE_SECS`].
const CHECK_SECS: f64 = 5e-3;
/// The two in double-double.
const LAST_SECS: f64 = 1e-4;
/// How close the states of two unflipped pendulums must be, in unit vectors and momenta.
const STATE_DISTANCE: f64 = 1e-2;

/// A job on its way through the checks.
pub struct Case {
    pub job: Job,
    /// What each stage answered, for the starts it was given.
    first: Option<Finished>,
    probe: Option<Finished>,
    /// Starts that the stage under way runs.
    open: Vec<usize>,
    /// The best answer to each open start so far, its state if unflipped.
    best: Vec<Answer>,
    trusts: Vec<Trust>,
    effort: Effort,
}

/// An outcome, and of unflipped pendulums the state they reached and when, in reduced units.
#[derive(Clone, Copy, Debug)]
struct Answer {
    outcome: Outcome,
    reached: Option<(Phase<f64>, f64)>,
}

/// Stages of a case, and of the names of its jobs: the recipe asked for,
pub const FIRST: u64 = 0;
/// its probe,
pub const PROBED: u64 = 1;
/// Taylor expansions,
const CHECKED: u64 = 2;
/// those in double-double,
const LAST_WORD: u64 = 3;
/// and those again with other steps.
const LAST_CHECKED: u64 = 4;
/// Room for them in a job's name.
pub const STAGES: u64 = 8;

/// The stage that comes next; after the last there is none.
#[derive(Clone, Copy)]
pub struct Next(u64);

impl Next {
    /// The recipe it runs.
    pub fn recipe(self) -> Option<Recipe> {
        match self.0 {
            CHECKED => Some(CHECK),
            LAST_WORD => Some(LAST),
            LAST_CHECKED => Some(LAST_CHECK),
            _ => None,
        }
    }
}

impl Case {
    /// A case of which nothing is known.
    pub fn new(job: Job) -> Self {
        Case {
            first: None,
            probe: None,
            open: Vec::new(),
            best: Vec::new(),
            trusts: vec![Trust::Unchecked; job.starts.len()],
            effort: Effort::default(),
            job,
        }
    }

    /// The job of the next stage: the open starts by its recipe.
    pub fn job_of(&self, next: Next, recipe: Recipe) -> Job {
        Job {
            id: self.job.id * STAGES + next.0,
            recipe,
            starts: self.open_starts(next),
            keep_unfinished: true,
            ..self.job
        }
    }

    fn is_deep(&self) -> bool {
        matches!(self.job.starts, Starts::Deep(_))
    }

    /// The open starts. Deep ones are followed anew with other cuts, so that the start map is
    /// checked as well as what comes after it; what double-double gives on one of the two is
    /// checked by what it gives on the other.
    fn open_starts(&self, next: Next) -> Starts {
        match &self.job.starts {
            Starts::Rest(angles) => {
                Starts::Rest(self.open.iter().map(|&start| angles[start]).collect())
            }
            Starts::Deep(deep) => Starts::Deep(deep.some(&self.open, next.0 != LAST_CHECKED)),
            Starts::Paused(_) | Starts::Moving(_) => unreachable!("refused when submitted"),
        }
    }

    /// Takes a stage's answer; says what to do next once the stage is complete.
    pub fn take(&mut self, stage: u64, finished: Finished) -> Option<Next> {
        self.effort += finished.effort;
        match stage {
            FIRST => self.first = Some(finished),
            PROBED => self.probe = Some(finished),
            CHECKED => return Some(self.decide(stage, &self.answers(&finished, &CHECK))),
            _ => return Some(self.decide(stage, &self.answers(&finished, &LAST))),
        }
        let first = self.answers(self.first.as_ref()?, &self.job.recipe);
        let probe = self.answers(self.probe.as_ref()?, &probe_of(&self.job.recipe));
        self.best = first;
        self.open = (0..self.best.len()).collect();
        Some(self.decide(PROBED, &probe))
    }

    /// Compares a stage's answers with the best so far. What agrees is decided; the rest stays
    /// open for the stage that follows.
    fn decide(&mut self, stage: u64, answers: &[Answer]) -> Next {
        let fine = is_fine(&self.job.recipe);
        let (secs, trust) = match stage {
            // Another start map is no finer than the one it checks.
            PROBED if fine && !self.is_deep() => (PROBE_SECS, Trust::Agreed),
            PROBED => (FINE_PROBE_SECS, Trust::Agreed),
            CHECKED => (CHECK_SECS, Trust::Confirmed),
            LAST_WORD => (CHECK_SECS, Trust::Settled),
            _ if self.is_deep() => (FINE_PROBE_SECS, Trust::Settled),
            _ => (LAST_SECS, Trust::Settled),
        };
        let open = std::mem::take(&mut self.open);
        for (&start, answer) in open.iter().zip(answers) {
            // Two answers from one start map share its errors.
            let apart = stage != LAST_WORD || !self.is_deep();
            let close = apart && are_close(&self.job.question, &self.best[start], answer, secs);
            // A coarse probe and the last check are coarser than what they check.
            let better = match stage {
                PROBED => !fine && !close,
                CHECKED => self.job.recipe.precision != Precision::Dd,
                LAST_CHECKED => false,
                _ => true,
            };
            if better {
                self.best[start] = *answer;
            }
            if close {
                self.trusts[start] = trust;
            } else if stage == LAST_CHECKED {
                self.trusts[start] = Trust::Uncertain;
            } else {
                self.open.push(start);
            }
        }
        Next(if self.open.is_empty() { STAGES } else { stage + 1 })
    }

    /// Each outcome with the state it reached, if that was kept.
    fn answers(&self, finished: &Finished, recipe: &Recipe) -> Vec<Answer> {
        let unreached = |&outcome: &Outcome| Answer { outcome, reached: None };
        let mut answers: Vec<Answer> = finished.outcomes.iter().map(unreached).collect();
        for (index, paused) in &finished.unfinished {
            answers[*index].reached = start::reached(&self.job.question, recipe, paused);
        }
        answers
    }

    /// The answer.
    pub fn finish(self) -> Finished {
        let outcomes: Vec<Outcome> = self.best.iter().map(|answer| answer.outcome).collect();
        Finished {
            id: self.job.id,
            outcomes,
            unfinished: Vec::new(),
            trusts: self.trusts,
            effort: self.effort,
        }
    }
}

/// Whether a recipe's errors are far below those of the coarse probe.
fn is_fine(recipe: &Recipe) -> bool {
    recipe.precision != Precision::F32 && recipe.method.tolerance().is_some_and(|t| t <= FINE)
}

/// What a recipe is probed by: a fine one by `fast`, a coarse one by `balanced`.
pub fn probe_of(recipe: &Recipe) -> Recipe {
    if is_fine(recipe) { FAST } else { BALANCED }
}

/// Whether two answers are the same: flips within `secs`, or unflipped in nearly one state.
fn are_close(question: &Question, a: &Answer, b: &Answer, secs: f64) -> bool {
    match (a.outcome.status, b.outcome.status) {
        (Status::Flipped, Status::Flipped) => (a.outcome.time - b.outcome.time).abs() <= secs,
        (Status::Unflipped, Status::Unflipped) => match (a.reached, b.reached) {
            (Some(a), Some(b)) => distance(question, a, b) <= STATE_DISTANCE,
            _ => false,
        },
        _ => false,
    }
}

/// Longest step by which one state is brought to the time of the other, reduced units.
const CATCH_UP: f64 = 0.05;

/// The distance of two states, the earlier one moved on to the time of the later.
fn distance(question: &Question, a: (Phase<f64>, f64), b: (Phase<f64>, f64)) -> f64 {
    let (pendulum, _) = question.reduced();
    let scale = pendulum.momentum_scale().map(|scale| 1.0 / scale);
    let ((mut phase, from), (late, to)) = if a.1 <= b.1 { (a, b) } else { (b, a) };
    let steps = ((to - from) / CATCH_UP).ceil();
    for _ in 0..steps as usize {
        let trial = dop853(&pendulum, scale, &phase, (to - from) / steps);
        phase = plus(&phase, &trial.change);
    }
    let unit = |i: usize| if i < 4 { 1.0 } else { scale[i - 4] };
    (0..6).map(|i| (phase[i] - late[i]).abs() * unit(i)).fold(0.0, f64::max)
}
