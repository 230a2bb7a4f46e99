//! The hard cases: starts, pendulums and windows at which flip-time programs go wrong, each with
//! the expected result, the reason for it, and a function that measures it.
//!
//! The tests run every case on every engine, and the report prints the same list, so that what is
//! claimed is what was measured. The judge is the gold standard, in double-double where f64 would
//! not be above suspicion.

mod balance;
mod builds;
mod chaos;
mod methods;
mod orbits;
pub(crate) mod tangent;
mod top;
mod views;

use serde::Serialize;

use super::truth::{oracle_dd, oracle_f64};
pub use flipmap_engine::level::{BALANCED, FAST};
use flipmap_engine::{
    Engine, EngineError, EngineKind, EventSpec, IntegratorConfig, Job, JobResult, Keep, Method,
    Precision, Starts, Wait,
};
use flipmap_numbers::Dd;
use flipmap_pendulum::{Outcome, Rule, Status};
use flipmap_scene::PendulumSpec;

/// A claim and the function that tests it.
#[derive(Clone, Copy)]
pub struct HardCase {
    /// Name of the case in a few words.
    pub name: &'static str,
    /// The expected result.
    pub expected: &'static str,
    /// The reason to expect it, in one sentence.
    pub why: &'static str,
    /// The subject: an engine, or the mathematics that all engines share.
    pub of: Of,
    run: fn(&mut HardBench) -> Result<HardFinding, EngineError>,
}

/// The subject of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// Any engine that has DOP853 in f64.
    Engine,
    /// The processor's engine only: the case needs methods that no other engine has.
    Cpu,
    /// No engine: the case is about the methods themselves.
    Physics,
}

/// The result of a measurement, and the verdict on the claim.
#[derive(Clone, Debug, PartialEq)]
pub struct HardFinding {
    /// The measured numbers as text.
    pub measured: String,
    /// True if the claim held.
    pub held: bool,
}

/// A case and its result, as a row of a report.
#[derive(Clone, Debug, Serialize)]
pub struct HardRow {
    /// Name of the case in a few words.
    pub case: &'static str,
    /// Name of the engine under examination.
    pub engine: String,
    /// The expected result.
    pub expected: &'static str,
    /// The reason to expect it.
    pub why: &'static str,
    /// The measured numbers as text.
    pub measured: String,
    /// True if the result is as expected.
    pub held: bool,
}

impl HardRow {
    /// Measures `case` on the engine called `name`.
    pub(crate) fn of(case: &HardCase, name: String, engine: &mut dyn Engine) -> Self {
        let HardFinding { measured, held } = case.measure(&mut HardBench::new(Box::new(engine)));
        let HardCase { name: case, expected, why, .. } = *case;
        HardRow { case, engine: name, expected, why, measured, held }
    }
}

impl HardFinding {
    fn new(held: bool, measured: String) -> Result<Self, EngineError> {
        Ok(HardFinding { measured, held })
    }
}

impl HardCase {
    /// Measures the case. An engine that fails has not kept the claim.
    pub fn measure(&self, bench: &mut HardBench) -> HardFinding {
        (self.run)(bench).unwrap_or_else(|error| {
            // What is still in flight must not answer the next case.
            bench.engine.cancel();
            HardFinding { measured: error.to_string(), held: false }
        })
    }

    /// Returns true if the case applies to an engine.
    pub fn is_for(&self, engine: EngineKind) -> bool {
        self.of == Of::Engine || engine == EngineKind::Cpu
    }
}

/// All cases, in the order of the report.
pub fn cases() -> Vec<HardCase> {
    [
        top::CASES,
        balance::CASES,
        builds::CASES,
        views::CASES,
        methods::CASES,
        chaos::CASES,
        orbits::CASES,
    ]
    .concat()
}

/// The config that checks the others by another method.
pub(crate) const TAYLOR: IntegratorConfig =
    IntegratorConfig { method: Method::Taylor { tolerance: 1e-15 }, precision: Precision::F64 };
/// The lesson's method in f64 instead of f32.
pub(crate) const LESSON: IntegratorConfig =
    IntegratorConfig { method: Method::LESSON, precision: Precision::F64 };
/// The engine under examination.
pub struct HardBench<'a> {
    engine: Box<dyn Engine + 'a>,
}

impl<'a> HardBench<'a> {
    /// A bench that examines `engine`.
    pub fn new(engine: Box<dyn Engine + 'a>) -> Self {
        HardBench { engine }
    }

    /// The engine's answers, in the order of the starts.
    fn answers(
        &mut self,
        question: &EventSpec,
        config: IntegratorConfig,
        starts: &[[Dd; 2]],
    ) -> Result<Vec<Outcome>, EngineError> {
        Ok(self.finished(question, config, Starts::Rest(starts.to_vec()))?.outcomes)
    }

    /// The configs that claim to be right; the processor's two share no event test.
    fn exact(&self) -> &'static [IntegratorConfig] {
        if self.engine.kind() == EngineKind::Cpu { &[BALANCED, TAYLOR] } else { &[BALANCED] }
    }

    /// Largest error of the exact configs' answers, s.
    fn worst(
        &mut self,
        question: &EventSpec,
        starts: &[[Dd; 2]],
        truth: &[Outcome],
    ) -> Result<f64, EngineError> {
        let mut worst = 0f64;
        for &config in self.exact() {
            worst = worst.max(farthest(&self.answers(question, config, starts)?, truth));
        }
        Ok(worst)
    }

    /// Runs one job to its end and keeps the states of unfinished pendulums.
    fn finished(
        &mut self,
        question: &EventSpec,
        config: IntegratorConfig,
        starts: Starts,
    ) -> Result<JobResult, EngineError> {
        let job = Job { id: 1, question: *question, config, starts, keep: Keep::STATES };
        self.engine.submit(job)?;
        let finished = self.engine.poll(Wait::UntilFinished)?.pop();
        finished.ok_or_else(|| EngineError::Unsupported("the engine gave no answer".to_string()))
    }
}

/// A question about the pendulum of the home map.
fn home(rule: Rule, budget_secs: f64) -> EventSpec {
    EventSpec { build: PendulumSpec::default(), rule, budget_secs, passes: 1 }
}

/// Distance between two outcomes in seconds; infinite if their statuses differ.
pub(crate) fn apart(a: &Outcome, b: &Outcome) -> f64 {
    match (a.status, b.status) {
        (Status::Answered, Status::Answered) => (a.time - b.time).abs(),
        (a, b) if a == b => 0.0,
        _ => f64::INFINITY,
    }
}

/// Largest distance between outcomes with the same index, s.
pub(crate) fn farthest(a: &[Outcome], b: &[Outcome]) -> f64 {
    a.iter().zip(b).map(|(a, b)| apart(a, b)).fold(0.0, f64::max)
}

/// Number of outcomes with this status.
fn count(outcomes: &[Outcome], status: Status) -> usize {
    outcomes.iter().filter(|outcome| outcome.status == status).count()
}
