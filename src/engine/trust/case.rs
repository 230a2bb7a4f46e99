//! One job on its way up the ladder.

use rayon::prelude::*;

use super::Trust;
use super::judge::{Answer, Judge};
use super::ladder::{CHEAP, IN_F64, Run, rungs};
use crate::engine::{Effort, Finished, Job, Keep, Starts};
use crate::physics::Outcome;

/// A job on its way up the ladder.
pub struct Case {
    job: Job,
    rungs: Vec<Vec<Run>>,
    /// The rung that is being computed, from 0.
    rung: usize,
    /// Starts that are not sure, in order: what the rung computes.
    open: Vec<usize>,
    /// What has been computed.
    done: Vec<Done>,
    /// The finest answer so far to each start.
    outcomes: Vec<Outcome>,
    trusts: Vec<Trust>,
    effort: Effort,
}

/// A run and its answers to some of the starts.
struct Done {
    run: Run,
    /// Which, in order.
    starts: Vec<usize>,
    answers: Vec<Answer>,
}

/// Room for a job's runs in the names of its jobs.
pub const RUNS: u64 = 32;

impl Case {
    /// A case of which nothing is known, and its first jobs.
    pub fn new(job: Job) -> (Self, Vec<Job>) {
        let count = job.starts.len();
        let case = Case {
            rungs: rungs(&job.recipe, matches!(job.starts, Starts::Deep(_))),
            rung: 0,
            open: (0..count).collect(),
            done: Vec::new(),
            outcomes: vec![Outcome::without_time(crate::physics::Status::Unflipped); count],
            trusts: vec![Trust::Unchecked; count],
            effort: Effort::default(),
            job,
        };
        let jobs = case.jobs();
        (case, jobs)
    }

    /// The jobs of the rung that comes next.
    fn jobs(&self) -> Vec<Job> {
        let before: usize = self.rungs[..self.rung].iter().map(Vec::len).sum();
        let one = |(index, run): (usize, &Run)| Job {
            id: self.job.id * RUNS + (before + index) as u64,
            recipe: run.recipe,
            starts: self.starts_of(run),
            keep: Keep::Ends,
            ..self.job
        };
        self.rungs[self.rung].iter().enumerate().map(one).collect()
    }

    fn starts_of(&self, run: &Run) -> Starts {
        match &self.job.starts {
            Starts::Rest(angles) => {
                Starts::Rest(self.open.iter().map(|&start| run.start(angles[start])).collect())
            }
            Starts::Deep(deep) => Starts::Deep(deep.some(&self.open, run.strict)),
            Starts::Paused(_) | Starts::Moving(_) => unreachable!("refused when submitted"),
        }
    }

    /// Takes a run's answers. Once a rung is complete it says what to compute next: nothing, when
    /// every start is sure or the ladder ends.
    pub fn take(&mut self, run: u64, finished: Finished) -> Option<Vec<Job>> {
        self.effort += finished.effort;
        let answer = |(&outcome, &end)| Answer { outcome, end };
        let answers: Vec<Answer> =
            finished.outcomes.iter().zip(&finished.ends).map(answer).collect();
        let run = *self.rungs.iter().flatten().nth(run as usize)?;
        self.done.push(Done { run, starts: self.open.clone(), answers });
        let through: usize = self.rungs[..=self.rung].iter().map(Vec::len).sum();
        if self.done.len() < through {
            return None;
        }
        self.decide();
        self.rung += 1;
        let over = self.open.is_empty() || self.rung == self.rungs.len();
        Some(if over { Vec::new() } else { self.jobs() })
    }

    /// Sorts the open starts into those that are sure by now, and those that stay open.
    fn decide(&mut self) {
        // In the order of their errors, whichever came first.
        self.done.sort_by(|a, b| a.run.error_scale().total_cmp(&b.run.error_scale()));
        let judge = Judge::new(&self.job.question);
        let verdicts: Vec<(Outcome, bool)> =
            self.open.par_iter().map(|&start| self.verdict(&judge, start)).collect();
        let trust = match self.rung + 1 {
            rung if rung <= CHEAP => Trust::Agreed,
            rung if rung <= IN_F64 => Trust::Confirmed,
            _ => Trust::Settled,
        };
        for (start, (outcome, sure)) in std::mem::take(&mut self.open).into_iter().zip(verdicts) {
            self.outcomes[start] = outcome;
            self.trusts[start] = if sure { trust } else { Trust::Uncertain };
            if !sure {
                self.open.push(start);
            }
        }
    }

    /// The finest answer to a start, and whether it is sure.
    fn verdict(&self, judge: &Judge, start: usize) -> (Outcome, bool) {
        let answer = |done: &Done| {
            let place = done.starts.binary_search(&start).ok()?;
            Some((done.run, done.answers[place]))
        };
        let answers: Vec<(Run, Answer)> = self.done.iter().filter_map(answer).collect();
        let (finest, others) = answers.split_first().expect("the first rung has all starts");
        (finest.1.outcome, judge.is_sure(finest, others))
    }

    /// The answer.
    pub fn finish(self) -> Finished {
        Finished {
            id: self.job.id,
            outcomes: self.outcomes,
            trusts: self.trusts,
            effort: self.effort,
            ..Finished::default()
        }
    }
}
