//! One job on its climb up the ladder.

use rayon::prelude::*;

use super::judge::{Judge, JudgedAnswer, RunResult};
use super::ladder::{Origin, Run, Rung, compared, rungs};
use super::{Assurance, Trust};
use crate::{Effort, FinalState, Job, JobResult, Keep, Starts};
use flipmap_numbers::Dd;
use flipmap_pendulum::{Outcome, Status};
use flipmap_scene::question::Needs;

/// A job whose starts climb the ladder until they are sure.
pub(super) struct CheckedJob {
    job: Job,
    rungs: Vec<Rung>,
    /// Half the side of the leaves in rad, for deep starts.
    leaf_half_rad: Option<f64>,
    /// Index of the rung that is being computed, from 0.
    rung: usize,
    /// Indices of the starts that are not sure, in order: the rung computes these.
    open: Vec<usize>,
    /// Runs that have been computed.
    done: Vec<Done>,
    /// Finest answer to each start so far.
    finest: Vec<RunResult>,
    assurances: Vec<Assurance>,
    effort: Effort,
}

/// A run and its answers to some of the starts.
struct Done {
    /// Index of the run among all runs of the ladder.
    index: u64,
    run: Run,
    /// Indices of these starts, in order.
    starts: Vec<usize>,
    answers: Vec<RunResult>,
}

/// The answer to a start that has not been computed.
const UNANSWERED: RunResult = RunResult {
    outcome: Outcome { status: Status::Unflipped, time: 0.0 },
    end: FinalState::NOWHERE,
};

/// Number of identifiers that are reserved for the runs of a checked job.
pub(super) const RUNS: u64 = 32;

impl CheckedJob {
    /// Creates a checked job without answers, and the jobs of its first rung.
    pub(super) fn new(job: Job) -> (Self, Vec<Job>) {
        let job = Job { starts: job.starts.listed(), ..job };
        let count = job.starts.len();
        let leaf_half_rad = match &job.starts {
            Starts::Deep(deep) => Some(deep.half_side()),
            _ => None,
        };
        let case = CheckedJob {
            rungs: rungs(&job.config, leaf_half_rad),
            leaf_half_rad,
            rung: 0,
            open: (0..count).collect(),
            done: Vec::new(),
            finest: vec![UNANSWERED; count],
            assurances: vec![Assurance::default(); count],
            effort: Effort::default(),
            job,
        };
        let jobs = case.jobs();
        (case, jobs)
    }

    /// The jobs of the current rung.
    fn jobs(&self) -> Vec<Job> {
        let before = self.runs_up_to(self.rung);
        let one = |(index, run): (usize, &Run)| Job {
            id: self.job.id * RUNS + (before + index) as u64,
            config: run.config,
            starts: self.starts_of(run),
            keep: Keep { ends: compared(self.job.keep.ends), states: false },
            ..self.job
        };
        self.rungs[self.rung].runs.iter().enumerate().map(one).collect()
    }

    /// Number of runs in the first `rungs` rungs.
    fn runs_up_to(&self, rungs: usize) -> usize {
        self.rungs[..rungs].iter().map(|rung| rung.runs.len()).sum()
    }

    fn starts_of(&self, run: &Run) -> Starts {
        match &self.job.starts {
            Starts::Rest(angles) => {
                let by = run.nudge.map(Dd::new);
                let moved = |&start: &usize| [0, 1].map(|i| angles[start][i] + by[i]);
                Starts::Rest(self.open.iter().map(moved).collect())
            }
            Starts::Thrown(launches) => {
                let by = run.nudge.map(Dd::new);
                let moved = |&start: &usize| launches[start].moved_by(by);
                Starts::Thrown(self.open.iter().map(moved).collect())
            }
            Starts::Mixed { starts, thrown } => {
                let moved = |&start: &usize| starts[start].moved_by(run.nudge);
                Starts::Mixed { starts: self.open.iter().map(moved).collect(), thrown: *thrown }
            }
            Starts::Deep(deep) => {
                let strict = run.from == Origin::StrictMap;
                let some = deep.some(&self.open, strict, run.nudge);
                match run.from {
                    Origin::Rest => some.rounded(&self.job.question, self.job.keep.ends),
                    Origin::Map | Origin::StrictMap => Starts::Deep(some),
                }
            }
            Starts::Upright(_) | Starts::Resumed { .. } | Starts::Moving(_) => {
                unreachable!("listed or refused when submitted")
            }
        }
    }

    /// Takes a run's answers. Once the rung is complete, returns the jobs of the next one, or an
    /// empty list if every start is sure or the ladder ends.
    pub(super) fn take(&mut self, index: u64, finished: JobResult) -> Option<Vec<Job>> {
        self.effort += finished.effort;
        let run = *self.rungs.iter().flat_map(|rung| &rung.runs).nth(index as usize)?;
        let answer = |(&outcome, &end): (&Outcome, &FinalState)| RunResult { outcome, end };
        let answers: Vec<RunResult> =
            finished.outcomes.iter().zip(&finished.ends).map(answer).collect();
        self.done.push(Done { index, run, starts: self.open.clone(), answers });
        if self.done.len() < self.runs_up_to(self.rung + 1) {
            return None;
        }
        self.decide();
        self.rung += 1;
        let over = self.open.is_empty() || self.rung == self.rungs.len();
        Some(if over { Vec::new() } else { self.jobs() })
    }

    /// Sorts the open starts into those that are sure by now and those that stay open.
    fn decide(&mut self) {
        // Runs finish in any order.
        self.done.sort_by_key(|done| done.index);
        let leaf_half_rad = self.leaf_half_rad.unwrap_or(0.0);
        let judge = Judge::new(&self.job.question, self.job.keep.ends, leaf_half_rad);
        let judged: Vec<JudgedAnswer> =
            self.open.par_iter().map(|&start| judge.judge(&self.answers(start))).collect();
        let rung_trust = self.rungs[self.rung].trust;
        for (start, judged) in std::mem::take(&mut self.open).into_iter().zip(judged) {
            let JudgedAnswer { answer, is_sure, error_secs } = judged;
            let trust = if is_sure { rung_trust } else { Trust::Uncertain };
            self.finest[start] = answer;
            self.assurances[start] =
                error_secs.map_or(trust.into(), |error_secs| Assurance::new(trust, error_secs));
            if !is_sure {
                self.open.push(start);
            }
        }
    }

    /// All answers to a start so far.
    fn answers(&self, start: usize) -> Vec<(Run, RunResult)> {
        let answer = |done: &Done| {
            let place = done.starts.binary_search(&start).ok()?;
            Some((done.run, done.answers[place]))
        };
        self.done.iter().filter_map(answer).collect()
    }

    /// The result of the job.
    pub(super) fn finish(self) -> JobResult {
        let ends = match self.job.keep.ends {
            Needs::Outcome => Vec::new(),
            Needs::End | Needs::Growth | Needs::Extremum(_) => {
                self.finest.iter().map(|answer| answer.end).collect()
            }
        };
        JobResult {
            id: self.job.id,
            outcomes: self.finest.iter().map(|answer| answer.outcome).collect(),
            ends,
            assurances: self.assurances,
            effort: self.effort,
            ..JobResult::default()
        }
    }
}

#[cfg(test)]
impl CheckedJob {
    /// Returns true if the answer to a start is sure by now.
    pub(super) fn is_sure(&self, start: usize) -> bool {
        !matches!(self.assurances[start].trust(), Trust::Unchecked | Trust::Uncertain)
    }
}
