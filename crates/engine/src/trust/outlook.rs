//! The expected accuracy of unchecked answers: the share of a sample of starts whose errors grow
//! too large for right answers.
//!
//! Every start is computed twice, the second time from a start moved by many times the error scale
//! of the configuration. The distance by which this moves the answer measures the growth of its
//! errors, and hence its error.

use super::Opinion;
use super::judge::{Judge, RunResult};
use super::ladder::{Origin, Run};
use crate::{
    Engine, EngineError, EventSpec, IntegratorConfig, JobResult, Keep, Onset, Starts, run_job,
};
use flipmap_numbers::Dd;
use flipmap_scene::question::Needs;

/// The expected accuracy of a picture, from a sample of its starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AccuracyEstimate {
    /// Number of starts in the sample.
    pub sampled: usize,
    /// Number of those whose errors have grown too large.
    pub beyond: usize,
    /// The second opinion on some of the other starts, if start maps or first moments gave their
    /// answers.
    pub opinion: Opinion,
}

/// The answers to a sample of starts, and marks for those whose errors have grown too large.
pub struct SampledAnswers {
    /// The answers, with their ends.
    pub result: JobResult,
    /// True for starts beyond the horizon.
    pub beyond: Vec<bool>,
}

/// Expected share of right pixels below which a picture deserves a warning.
const ENOUGH: f64 = 0.99;
/// Number of error scales by which starts are moved.
const NUDGE: f64 = 30.0;
/// Share of half a leaf by which deep starts are moved.
const DEEP_NUDGE: f64 = 1e-8;

impl AccuracyEstimate {
    /// Computes some starts, and finds those beyond the horizon; returns `None` once `keep_going`
    /// returns false.
    pub fn sample(
        engine: &mut dyn Engine,
        question: EventSpec,
        (config, ends): (IntegratorConfig, Needs),
        starts: &Starts,
        keep_going: &dyn Fn() -> bool,
    ) -> Result<Option<SampledAnswers>, EngineError> {
        let (from, nudge, leaf_half_rad) = match starts {
            Starts::Deep(deep) => (Origin::Map, DEEP_NUDGE, deep.half_side()),
            _ => (Origin::Rest, NUDGE * Run::new(config, Origin::Rest).scale_from_rest(), 0.0),
        };
        let run = Run::new(config, from);
        let moved = run.nudged([0.6 * nudge, 0.8 * nudge]);
        let ends = if ends == Needs::Outcome { Needs::End } else { ends };
        let keep = Keep { ends, states: false };
        let mut answers = |starts| run_job(engine, question, config, starts, keep, keep_going);
        let Some(result) = answers(starts.clone())? else { return Ok(None) };
        let Some(nudged) = answers(moved_by(starts, moved.nudge))? else { return Ok(None) };
        let judge = Judge::new(&question, ends, leaf_half_rad);
        let all = |result: &JobResult| -> Vec<RunResult> {
            let answers = result.outcomes.iter().zip(&result.ends);
            answers.map(|(&outcome, &end)| RunResult { outcome, end }).collect()
        };
        let is_beyond = |(plain, nudged): (&RunResult, &RunResult)| {
            let scale = |run: &Run| run.error_scale(&plain.end, leaf_half_rad);
            let apart = judge.distance(plain, nudged);
            apart.is_nan() || apart * scale(&run) / scale(&moved) > judge.allowed(plain)
        };
        let beyond = all(&result).iter().zip(&all(&nudged)).map(is_beyond).collect();
        Ok(Some(SampledAnswers { result, beyond }))
    }

    /// Share of pixels that is expected to be right.
    pub fn expected_right(&self) -> f64 {
        let share = |count: usize, all: usize| count as f64 / all.max(1) as f64;
        let within = 1.0 - share(self.beyond, self.sampled);
        within * (1.0 - share(self.opinion.contradicted, self.opinion.asked))
    }

    /// A warning, if too few pixels are expected to be right.
    pub fn warning(&self) -> Option<String> {
        if self.opinion.contradicted > 0 {
            return Some(format!(
                "{} of {} pixels that were integrated directly contradict the picture: accuracy exact marks \
                 what is wrong; please report this view",
                self.opinion.contradicted, self.opinion.asked
            ));
        }
        (self.expected_right() < ENOUGH).then(|| {
            format!(
                "about {:.0} % of the simulated pixels are beyond the horizon, where errors have \
                 grown too large: accuracy exact decides or marks them, and a smaller budget leaves \
                 them out",
                100.0 * (1.0 - self.expected_right())
            )
        })
    }
}

fn moved_by(starts: &Starts, by: [f64; 2]) -> Starts {
    match starts {
        Starts::Deep(deep) => {
            let all: Vec<usize> = (0..starts.len()).collect();
            Starts::Deep(deep.some(&all, deep.strict, by))
        }
        Starts::Rest(angles) => {
            let moved = |angle: &[Dd; 2]| [0, 1].map(|i| angle[i] + Dd::new(by[i]));
            Starts::Rest(angles.iter().map(moved).collect())
        }
        Starts::Thrown(launches) => {
            Starts::Thrown(launches.iter().map(|launch| launch.moved_by(by.map(Dd::new))).collect())
        }
        Starts::Mixed { starts, thrown } => {
            let moved = |start: &Onset| start.moved_by(by);
            Starts::Mixed { starts: starts.iter().map(moved).collect(), thrown: *thrown }
        }
        Starts::Upright(upright) => moved_by(&Starts::Rest(upright.listed()), by),
        Starts::Resumed { .. } | Starts::Moving(_) => starts.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::CpuEngine;
    use crate::level::BALANCED;
    use crate::{Method, Precision};
    use flipmap_pendulum::Rule;
    use flipmap_scene::PendulumSpec;

    /// Returns the estimate for a row of starts that begins at `from`.
    fn outlook(from: [f64; 2], budget_secs: f64) -> AccuracyEstimate {
        let opinion = Opinion::default();
        let mut engine = CpuEngine::new(Some(2)).unwrap();
        let question = EventSpec {
            build: PendulumSpec::default(),
            rule: Rule::Second,
            budget_secs,
            passes: 1,
        };
        let angle = |k: u32| [from[0] + 4e-4 * f64::from(k), from[1] + 3e-4 * f64::from(k)];
        let starts = Starts::Rest((0..200).map(|k| angle(k).map(Dd::new)).collect());
        let how = (BALANCED, Needs::Outcome);
        let answers = AccuracyEstimate::sample(&mut engine, question, how, &starts, &|| true);
        let beyond = answers.unwrap().unwrap().beyond;
        let count = beyond.iter().filter(|beyond| **beyond).count();
        AccuracyEstimate { sampled: beyond.len(), beyond: count, opinion }
    }

    #[test]
    fn long_budgets_lie_beyond_the_horizon_and_short_ones_do_not() {
        let chaotic = [-1.7, 0.06];
        let (short, long) = (outlook(chaotic, 10.0), outlook(chaotic, 100.0));
        assert_eq!((short.sampled, short.beyond, short.warning()), (200, 0, None));
        assert!(long.beyond > 3, "{long:?}");
        assert!(long.warning().unwrap().contains("beyond the horizon"));
    }

    #[test]
    fn a_third_of_the_starts_with_large_errors_are_beyond_the_horizon_and_no_others() {
        let question = EventSpec {
            build: PendulumSpec::default(),
            rule: Rule::Second,
            budget_secs: 30.0,
            passes: 1,
        };
        let angle = |k: u32| [-1.7 + 4e-4 * f64::from(k), 0.06 + 3e-4 * f64::from(k)];
        let starts = Starts::Rest((0..200).map(|k| angle(k).map(Dd::new)).collect());
        let mut engine = CpuEngine::new(Some(2)).unwrap();
        let mut sample = |config| {
            let how = (config, Needs::Outcome);
            let answers = AccuracyEstimate::sample(&mut engine, question, how, &starts, &|| true);
            answers.unwrap().unwrap()
        };
        let method = Method::dopri5(1e-8);
        let coarse = IntegratorConfig { method, precision: Precision::F64 };
        let (coarse, truth) = (sample(coarse), sample(BALANCED));
        assert!(!truth.beyond.contains(&true));
        let judge = Judge::new(&question, Needs::End, 0.0);
        let answer = |sample: &SampledAnswers, k: usize| RunResult {
            outcome: sample.result.outcomes[k],
            end: sample.result.ends[k],
        };
        let mut counts = [[0; 2]; 2];
        for k in 0..200 {
            let truth = answer(&truth, k);
            let is_wrong = judge.distance(&answer(&coarse, k), &truth) > judge.allowed(&truth);
            counts[usize::from(is_wrong)][usize::from(coarse.beyond[k])] += 1;
        }
        let [[fine, doubted], [missed, found]] = counts;
        assert!(found + missed > 50 && fine > 50, "{counts:?}");
        assert!(2 * found > missed && 10 * doubted < found, "{counts:?}");
    }

    #[test]
    fn forbidden_starts_are_not_beyond_the_horizon() {
        let forbidden = outlook([0.1, 0.1], 100.0);
        assert_eq!((forbidden.sampled, forbidden.beyond), (200, 0));
    }
}
