//! Helpers shared by the engines' tests: starts of a scene, the gold standard's answers to them, a
//! plain scalar RK4, and shares of right pixels.
#![allow(dead_code)]

use flipmap_engine::gpu::open_checked;
use flipmap_engine::gpu::{GpuEngine, device};
use flipmap_engine::{
    Engine, EventSpec, IntegratorConfig, Job, JobResult, Keep, Method, Precision, Starts, Wait,
};
use flipmap_numbers::Dd;
use flipmap_pendulum::{Outcome, Status, oracle};
use flipmap_report::baseline;
use flipmap_scene::{Fate, Grid, Scene};
use rayon::prelude::*;

/// The configuration of the lesson: RK4 at 120 steps a second.
pub(crate) fn lesson(precision: Precision) -> IntegratorConfig {
    IntegratorConfig { method: Method::LESSON, precision }
}

/// An engine on the first adapter, preferring a software adapter so that results are the same
/// everywhere. Without an adapter the test fails with a message on what to install.
pub(crate) fn gpu_engine() -> GpuEngine {
    let adapter = device::adapters().into_iter().next_back();
    let adapter = adapter.unwrap_or_else(|| {
        panic!(
            "{}; or declare its absence with FLIPMAP_NO_GPU=1",
            flipmap_engine::adapters::INSTALL_HINT
        )
    });
    eprintln!("adapter: {}", device::describe(&adapter));
    open_checked(adapter, &[]).expect("the adapter opens")
}

/// The question that a scene asks.
pub(crate) fn question(scene: &Scene) -> EventSpec {
    EventSpec::from(scene)
}

/// The open starts of every `every`-th column and row of a square picture.
pub(crate) fn open_starts(scene: &Scene, side: u32, every: u32) -> Vec<[Dd; 2]> {
    let grid = Grid::new(scene, [side, side]);
    let lines = (every / 2..side).step_by(every as usize);
    lines
        .clone()
        .flat_map(|y| lines.clone().map(move |x| (x, y)))
        .filter_map(|(x, y)| match grid.fate(x, y) {
            Fate::Open(angle) => Some(angle),
            _ => None,
        })
        .collect()
}

/// An engine's answers, in the order of the starts.
pub(crate) fn answers(
    engine: &mut dyn Engine,
    question: &EventSpec,
    config: IntegratorConfig,
    starts: &[[Dd; 2]],
) -> Vec<Outcome> {
    finished(engine, question, config, Starts::Rest(starts.to_vec())).outcomes
}

/// Runs one job to its end, keeping the states of unflipped pendulums.
pub(crate) fn finished(
    engine: &mut dyn Engine,
    question: &EventSpec,
    config: IntegratorConfig,
    starts: Starts,
) -> JobResult {
    let job = Job { id: 7, question: *question, config, starts, keep: Keep::STATES };
    engine.submit(job).expect("the job is taken");
    let mut finished = engine.poll(Wait::UntilFinished).expect("the engine works");
    assert_eq!(finished.len(), 1);
    finished.remove(0)
}

/// The gold standard's answers in f64.
pub(crate) fn truth(question: &EventSpec, starts: &[[Dd; 2]]) -> Vec<Outcome> {
    let one = |angle: &[Dd; 2]| {
        let angle = angle.map(|theta| theta.hi);
        oracle::outcome(&question.build.pendulum(), angle, question.rule, question.budget_secs)
    };
    starts.par_iter().map(one).collect()
}

/// Answers of a plain RK4 at 120 steps a second in f64, one pendulum at a time.
pub(crate) fn scalar_rk4(question: &EventSpec, starts: &[[Dd; 2]]) -> Vec<Outcome> {
    starts.par_iter().map(|&angle| baseline::outcome(question, angle)).collect()
}

/// Returns the share of answers with the true status and, if flipped, within `secs` of the true
/// time.
pub(crate) fn share_within(secs: f64, answers: &[Outcome], truth: &[Outcome]) -> f64 {
    assert!(!truth.is_empty() && answers.len() == truth.len());
    let close = |(a, b): &(&Outcome, &Outcome)| {
        a.status == b.status && (a.status != Status::Answered || (a.time - b.time).abs() <= secs)
    };
    answers.iter().zip(truth).filter(close).count() as f64 / truth.len() as f64
}

/// Returns the answers and true outcomes of the starts that truly flip before `secs`.
pub(crate) fn flips_before(
    secs: f64,
    answers: &[Outcome],
    truth: &[Outcome],
) -> (Vec<Outcome>, Vec<Outcome>) {
    let early = |t: &Outcome| t.status == Status::Answered && t.time < secs;
    answers.iter().zip(truth).filter(|(_, t)| early(t)).map(|(a, t)| (*a, *t)).unzip()
}
