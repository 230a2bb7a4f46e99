//! The second opinion on deep answers: some starts are integrated directly from their release by
//! the gold standard, in as many digits as that takes. It shares no start map, no polynomials in
//! the position of a start, no method and no event test with the engines.

use rayon::prelude::*;

use super::Trust;
use crate::engine::{Deep, Engine, EngineError, IntegratorConfig, Keep, Question, Starts, run_job};
use crate::physics::flip::right_secs;
use crate::physics::{Fixed, Outcome, Scalar, State, Status, Theta, oracle};

/// The result of integrating some starts of a view directly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Opinion {
    /// Number of starts that were integrated directly.
    pub asked: usize,
    /// Number of those whose answers were wrong and not marked.
    pub contradicted: usize,
}

/// Approximate upper bound on the decades by which neighbours move apart per unit of time.
const DECADES_A_UNIT: f64 = 0.16;
/// Decimal digits that must be right at the end, and guard digits.
const DIGITS_AT_END: f64 = 12.0;

impl Opinion {
    /// Forms an opinion on some deep starts: at most `most` of those that `engine`, which checks
    /// its answers, is sure of. None once `go_on` returns false.
    pub fn on(
        engine: &mut dyn Engine,
        (question, config): (Question, IntegratorConfig),
        deep: &Deep,
        most: usize,
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<Opinion>, EngineError> {
        let starts = Starts::Deep(deep.clone());
        let Some(answer) = run_job(engine, question, config, starts, Keep::NOTHING, go_on)? else {
            return Ok(None);
        };
        let is_sure = |k: &usize| {
            let trust = answer.trusts.get(*k).copied().unwrap_or(Trust::Uncertain);
            trust != Trust::Uncertain && answer.outcomes[*k].status != Status::Forbidden
        };
        let starts: Vec<Option<State<Theta>>> = deep.exact().collect();
        let sure: Vec<usize> = (0..starts.len()).filter(is_sure).take(most).collect();
        let wrong = |k: &usize| {
            let differs = |start| differs(&question, start, &answer.outcomes[*k]);
            go_on() && starts[*k].as_ref().is_none_or(differs)
        };
        let contradicted = sure.par_iter().filter(|k| wrong(k)).count();
        Ok(go_on().then_some(Opinion { asked: sure.len(), contradicted }))
    }

    /// A warning, if any answer was contradicted.
    pub fn warning(&self) -> Option<String> {
        (self.contradicted > 0).then(|| {
            format!(
                "{} of {} pixels that were integrated directly contradict the start maps: all \
                 pixels are marked as uncertain; please report this view",
                self.contradicted, self.asked
            )
        })
    }
}

fn differs(question: &Question, start: &State<Theta>, given: &Outcome) -> bool {
    let (_, unit_secs) = question.reduced();
    let decades = DIGITS_AT_END + DECADES_A_UNIT * question.budget_secs / unit_secs;
    let limbs = 1 + (decades * std::f64::consts::LOG2_10 / 64.0).ceil() as usize;
    let truth = match limbs {
        0..=3 => direct::<3>(question, start),
        4 => direct::<4>(question, start),
        5 => direct::<5>(question, start),
        6 => direct::<6>(question, start),
        7 => direct::<7>(question, start),
        _ => direct::<8>(question, start),
    };
    truth.status != given.status || (truth.time - given.time).abs() > right_secs(unit_secs)
}

/// The outcome of a start, integrated in numbers of `N` limbs.
fn direct<const N: usize>(question: &Question, start: &State<Theta>) -> Outcome {
    let (pendulum, unit_secs) = question.reduced_in::<Fixed<N>>();
    let budget = Fixed::from_f64(question.budget_secs) / unit_secs;
    let start = State {
        angle: start.angle.map(Fixed::from_theta),
        speed: start.speed.map(|speed| Fixed::from_theta(speed) * unit_secs),
    };
    let outcome = oracle::outcome_from(&pendulum, &start, question.rule, budget);
    Outcome { status: outcome.status, time: (outcome.time * unit_secs).to_f64() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::cpu::CpuEngine;
    use crate::engine::depth::DepthEngine;
    use crate::engine::level::BALANCED;
    use crate::engine::mock::MockEngine;
    use crate::engine::trust::TrustEngine;
    use crate::engine::{EngineKind, Job, JobResult, Leaf, Wait};
    use crate::physics::Rule;
    use crate::scene::lattice::Cell;
    use crate::scene::{Build, ExactPlane};

    fn starts() -> (Question, Deep) {
        let question =
            Question { build: Build::default(), rule: Rule::Second, budget_secs: 8.0, passes: 1 };
        let cell = Cell::around([2.2, -1.9].map(Theta::from_f64), 80);
        let points = (0..4).map(|k| [0.2 * f64::from(k), -0.3]).collect();
        (
            question,
            Deep {
                leaves: vec![Leaf { cell, points }],
                plane: Box::new(ExactPlane::AT_REST),
                strict: false,
            },
        )
    }

    #[test]
    fn what_start_maps_say_is_what_direct_integration_says() {
        let inner = DepthEngine::new(Box::new(CpuEngine::new(Some(2)).unwrap()), Some(2)).unwrap();
        let mut engine = TrustEngine::new(Box::new(inner), Some(2)).unwrap();
        let (question, deep) = starts();
        let opinion = Opinion::on(&mut engine, (question, BALANCED), &deep, 3, &|| true).unwrap();
        assert_eq!(opinion, Some(Opinion { asked: 3, contradicted: 0 }));
        assert_eq!(opinion.and_then(|opinion| opinion.warning()), None);
    }

    /// An engine that is sure, and wrong by 2 ms.
    struct Wrong(MockEngine, Option<JobResult>);

    impl Engine for Wrong {
        fn submit(&mut self, job: Job) -> Result<(), EngineError> {
            let outcomes = vec![Outcome::flipped(5.700_478 + 2e-3); job.starts.len()];
            let trusts = vec![Trust::Agreed; outcomes.len()];
            self.1 = Some(JobResult { id: job.id, outcomes, trusts, ..JobResult::default() });
            Ok(())
        }
        fn poll(&mut self, _: Wait) -> Result<Vec<JobResult>, EngineError> {
            Ok(self.1.take().into_iter().collect())
        }
        fn cancel(&mut self) {}
        fn slots(&self) -> usize {
            1
        }
        fn job_size(&self) -> usize {
            1
        }
        fn kind(&self) -> EngineKind {
            EngineKind::Gpu
        }
        fn adapter(&self) -> String {
            self.0.adapter()
        }
        fn offers(&self, _: &IntegratorConfig) -> bool {
            true
        }
    }

    #[test]
    fn a_wrong_start_map_is_contradicted() {
        let (question, deep) = starts();
        let mut engine = Wrong(MockEngine::default(), None);
        let opinion = Opinion::on(&mut engine, (question, BALANCED), &deep, 8, &|| true).unwrap();
        assert_eq!(opinion, Some(Opinion { asked: 4, contradicted: 4 }));
        assert!(opinion.unwrap().warning().unwrap().contains("4 of 4"));
    }
}
