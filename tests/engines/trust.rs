//! The reliability of checked answers.

use crate::common::*;
use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::trust::TrustEngine;
use flipmap_engine::{Accuracy, Engine, IntegratorConfig, Keep, Method, Precision, Starts, Trust};
use flipmap_numbers::Dd;
use flipmap_pendulum::{Outcome, Pendulum, Status, oracle};
use flipmap_scene::{Budget, QuestionSettings, Scene, View};
use rayon::prelude::*;

fn exact() -> TrustEngine<'static> {
    TrustEngine::new(Box::new(CpuEngine::new(None).unwrap()), None).unwrap()
}

fn balanced() -> IntegratorConfig {
    Accuracy::Exact.configs()[0]
}

/// Returns the scene of a window: near the energy curve, where flips come late, or in the filigree.
fn window(center: [&str; 2], width: &str, budget: f64) -> Scene {
    let center = center.map(str::to_string);
    let view = View { center, width: width.to_string(), ..View::default() };
    Scene {
        view,
        question: QuestionSettings { budget: Budget::secs(budget), ..QuestionSettings::default() },
        ..Scene::default()
    }
}

/// Returns the gold standard's answers in double-double, from all digits of the starts.
fn truth_in_dd(scene: &Scene, starts: &[[Dd; 2]]) -> Vec<Outcome> {
    let question = question(scene);
    let pendulum: Pendulum<Dd> = question.build.pendulum_in();
    let budget = Dd::new(question.budget_secs);
    let one = |angle: &[Dd; 2]| {
        let outcome = oracle::outcome(&pendulum, *angle, question.rule, budget);
        Outcome { status: outcome.status, time: outcome.time.hi }
    };
    starts.par_iter().map(one).collect()
}

fn is_right(answer: &Outcome, truth: &Outcome) -> bool {
    answer.status == truth.status
        && (answer.status != Status::Answered || (answer.time - truth.time).abs() <= 1e-3)
}

#[test]
fn no_pixel_of_a_late_window_is_wrong_unmarked() {
    for scene in [
        window(["-1.66", "0.1"], "0.08", 30.0),
        window(["-2.2", "-1.6"], "0.4", 30.0),
        window(["1.5", "0.6"], "1e-3", 30.0),
    ] {
        let starts = open_starts(&scene, 14, 1);
        let truth = truth_in_dd(&scene, &starts);
        let answer = finished(&mut exact(), &question(&scene), balanced(), Starts::Rest(starts));
        assert_eq!(answer.assurances.len(), truth.len());
        for ((answer, assurance), truth) in
            answer.outcomes.iter().zip(&answer.assurances).zip(&truth)
        {
            let trust = assurance.trust();
            assert_ne!(trust, Trust::Unchecked);
            assert!(
                trust == Trust::Uncertain || is_right(answer, truth),
                "{answer:?} {truth:?} {trust:?}"
            );
        }
        let uncertain =
            answer.assurances.iter().filter(|it| it.trust() == Trust::Uncertain).count();
        assert_eq!(uncertain, 0, "30 s are no horizon for double-double");
    }
}

#[test]
fn a_coarse_answer_is_corrected_when_it_is_checked() {
    let scene = Scene::default();
    let starts = open_starts(&scene, 512, 12);
    let truth = truth(&question(&scene), &starts);
    let alone = answers(
        &mut CpuEngine::new(None).unwrap(),
        &question(&scene),
        lesson(Precision::F32),
        &starts,
    );
    assert!(share_within(1e-3, &alone, &truth) < 0.93);
    let checked =
        finished(&mut exact(), &question(&scene), lesson(Precision::F32), Starts::Rest(starts));
    assert_eq!(share_within(1e-3, &checked.outcomes, &truth), 1.0);
    let count = |trust| checked.assurances.iter().filter(|it| it.trust() == trust).count();
    assert!(count(Trust::Agreed) > 4 * count(Trust::Confirmed) && count(Trust::Confirmed) > 50);
}

#[test]
fn beyond_every_horizon_pixels_are_marked() {
    // Starts with barely enough energy to flip, which flip after growth has consumed all digits.
    let scene = window(["0.21", "2.88"], "0.1", 1000.0);
    let starts = open_starts(&scene, 4, 1);
    let answer = finished(&mut exact(), &question(&scene), balanced(), Starts::Rest(starts));
    let late: Vec<Trust> = answer
        .outcomes
        .iter()
        .zip(&answer.assurances)
        .filter(|(outcome, _)| outcome.status == Status::Unflipped || outcome.time > 300.0)
        .map(|(_, assurance)| assurance.trust())
        .collect();
    let marked = late.iter().filter(|trust| **trust == Trust::Uncertain).count();
    eprintln!("{} late pixels, {marked} marked", late.len());
    assert!(!late.is_empty() && marked * 10 >= late.len() * 9);
}

#[test]
fn a_paused_pendulum_cannot_be_checked() {
    let mut engine = exact();
    let question = question(&Scene::default());
    let job = flipmap_engine::Job {
        id: 1,
        question,
        config: IntegratorConfig { method: Method::LESSON, precision: Precision::F32 },
        starts: Starts::Resumed { states: Vec::new(), thrown: false },
        keep: Keep::NOTHING,
    };
    assert!(engine.submit(job).unwrap_err().to_string().contains("release"));
}

#[test]
fn double_double_answers_every_start_of_a_long_job() {
    let mut scene = Scene::default();
    scene.question.budget.secs = 2.0;
    let starts = open_starts(&scene, 12, 1);
    assert!(starts.len() > 80);
    let config =
        IntegratorConfig { method: Method::Taylor { tolerance: 1e-25 }, precision: Precision::Dd };
    let mut engine = CpuEngine::new(None).unwrap();
    let answers = answers(&mut engine, &question(&scene), config, &starts);
    assert_eq!(share_within(1e-12, &answers, &truth_in_dd(&scene, &starts)), 1.0);
}
