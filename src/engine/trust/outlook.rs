//! The outlook on unchecked answers: the share of a sample of starts whose errors grow beyond what
//! still counts as right.
//!
//! Every start is computed twice, the second time from a place moved by many times the error scale
//! of the configuration. The distance by which this moves the answer measures the growth of its
//! errors, and hence its error.

use super::judge::{Judge, RunResult};
use super::ladder::{Origin, Run};
use crate::engine::{
    Engine, EngineError, IntegratorConfig, JobResult, Keep, Question, Starts, run_job,
};
use crate::physics::Dd;

/// The expectation for a picture, from a sample of its starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outlook {
    /// Number of starts in the sample.
    pub sampled: usize,
    /// Number of those whose errors have grown too large.
    pub beyond: usize,
}

/// Expected share of right pixels below which a picture deserves a warning.
const ENOUGH: f64 = 0.99;
/// Number of error scales by which starts are moved.
const NUDGE: f64 = 30.0;
/// Share of half a leaf by which deep starts are moved.
const DEEP_NUDGE: f64 = 1e-8;

impl Outlook {
    /// Computes the outlook from these starts; none once `go_on` returns false.
    pub fn of(
        engine: &mut dyn Engine,
        question: Question,
        config: IntegratorConfig,
        starts: &Starts,
        go_on: &dyn Fn() -> bool,
    ) -> Result<Option<Outlook>, EngineError> {
        let (from, nudge, leaf_half_rad) = match starts {
            Starts::Deep(deep) => (Origin::Map, DEEP_NUDGE, deep.half_side()),
            _ => (Origin::Rest, NUDGE * Run::new(config, Origin::Rest).scale_from_rest(), 0.0),
        };
        let run = Run::new(config, from);
        let moved = run.nudged([0.6 * nudge, 0.8 * nudge]);
        let mut answers = |starts| {
            let finished = run_job(engine, question, config, starts, Keep::ENDS, go_on)?;
            let answer = |(outcome, end)| RunResult { outcome, end };
            let all = |f: JobResult| f.outcomes.into_iter().zip(f.ends).map(answer).collect();
            Ok::<Option<Vec<RunResult>>, EngineError>(finished.map(all))
        };
        let Some(plain) = answers(starts.clone())? else { return Ok(None) };
        let Some(nudged) = answers(moved_by(starts, moved.nudge))? else { return Ok(None) };
        let judge = Judge::new(&question, leaf_half_rad);
        let is_beyond = |(plain, nudged): &(&RunResult, &RunResult)| {
            let scale = |run: &Run| run.error_scale(&plain.end, leaf_half_rad);
            let apart = judge.distance(plain, nudged);
            apart.is_nan() || apart * scale(&run) / scale(&moved) > judge.allowed(plain)
        };
        let beyond = plain.iter().zip(&nudged).filter(is_beyond).count();
        Ok(Some(Outlook { sampled: plain.len(), beyond }))
    }

    /// Share of pixels that is expected to be right.
    pub fn expected_right(&self) -> f64 {
        1.0 - self.beyond as f64 / self.sampled.max(1) as f64
    }

    /// A warning, if too few pixels are expected to be right.
    pub fn warning(&self) -> Option<String> {
        (self.expected_right() < ENOUGH).then(|| {
            format!(
                "about {:.0} % of the simulated pixels are beyond the horizon, where errors have \
                 grown too large: `accuracy` exact decides or marks them, a smaller budget leaves \
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
        Starts::Upright(upright) => moved_by(&Starts::Rest(upright.listed()), by),
        Starts::Resumed { .. } | Starts::Moving(_) => starts.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::cpu::CpuEngine;
    use crate::engine::level::BALANCED;
    use crate::physics::Rule;
    use crate::scene::Build;

    /// The outlook of starts in a row from one of them.
    fn outlook(from: [f64; 2], budget_secs: f64) -> Outlook {
        let mut engine = CpuEngine::new(Some(2)).unwrap();
        let question =
            Question { build: Build::default(), rule: Rule::Second, budget_secs, passes: 1 };
        let angle = |k: u32| [from[0] + 4e-4 * f64::from(k), from[1] + 3e-4 * f64::from(k)];
        let starts = Starts::Rest((0..200).map(|k| angle(k).map(Dd::new)).collect());
        Outlook::of(&mut engine, question, BALANCED, &starts, &|| true).unwrap().unwrap()
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
    fn forbidden_starts_are_not_beyond_the_horizon() {
        let forbidden = outlook([0.1, 0.1], 100.0);
        assert_eq!((forbidden.sampled, forbidden.beyond), (200, 0));
    }
}
