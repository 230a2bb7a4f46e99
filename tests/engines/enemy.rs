//! Windows chosen to break `exact`: no pixel may be wrong and unmarked.

use crate::common;
use flipmap_engine::choice::{EngineRequest, IntegrationSetting};
use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::depth::DepthEngine;
use flipmap_engine::level::BALANCED;
use flipmap_engine::trust::TrustEngine;
use flipmap_engine::{Accuracy, Engine, EngineKind, IntegratorConfig, Method, Precision, Trust};
use flipmap_numbers::{Dd, Scalar};
use flipmap_pendulum::flip::right_secs;
use flipmap_pendulum::{Outcome, Rule, Status, oracle};
use flipmap_render::tiles::preview::preview;
use flipmap_render::tiles::{Samples, Work};
use flipmap_report::hunt::Hunt;
use flipmap_scene::{Budget, Grid, Kind as Sort, PendulumSpec, QuestionSettings, Scene, View};
use rayon::prelude::*;

fn points() -> PendulumSpec {
    PendulumSpec::default()
}

fn rods() -> PendulumSpec {
    PendulumSpec { kind: Sort::Rods, ..PendulumSpec::default() }
}

/// The checked scene of a window.
fn scene(build: PendulumSpec, rule: Rule, budget_secs: f64, view: View) -> Scene {
    let question =
        QuestionSettings { rule, budget: Budget::secs(budget_secs), ..QuestionSettings::default() };
    Scene { build, question, view, ..Scene::default() }.checked().expect("a scene")
}

fn view(center: [&str; 2], width: &str) -> View {
    View { center: center.map(str::to_string), width: width.to_string(), ..View::default() }
}

/// Returns the samples of a picture in which `engine` checks every pixel.
fn checked_by(
    engine: Box<dyn Engine>,
    scene: &Scene,
    side: u32,
    config: IntegratorConfig,
) -> Samples {
    let inner = DepthEngine::new(engine, None).unwrap();
    let mut engine = TrustEngine::new(Box::new(inner), None).unwrap();
    let mut work = Work::new(scene, [side; 2], config, 512);
    preview(&mut work, [side; 2], &mut engine, &|_| true).unwrap().unwrap()
}

fn checked(scene: &Scene, side: u32, config: IntegratorConfig) -> Samples {
    checked_by(Box::new(CpuEngine::new(None).unwrap()), scene, side, config)
}

/// The place and true outcome of every `every`-th pixel, by the gold standard in double-double.
fn truths(scene: &Scene, side: u32, every: usize) -> Vec<(usize, Outcome)> {
    let (pendulum, unit_secs) = scene.build.reduced_in::<Dd>();
    let budget = Dd::new(scene.question.budget.secs) / unit_secs;
    let grid = Grid::new(scene, [side; 2]);
    let truth = |place: usize| {
        let angle = grid.angle_from_pixel(place as u32 % side, place as u32 / side);
        let truth = oracle::outcome(&pendulum, angle, scene.question.rule, budget);
        (place, Outcome { status: truth.status, time: (truth.time * unit_secs).to_f64() })
    };
    let places: Vec<usize> = (0..(side * side) as usize).step_by(every).collect();
    places.into_par_iter().map(truth).collect()
}

/// Returns the answers that are wrong and unmarked, and the number of marked pixels.
fn judged(scene: &Scene, samples: &Samples, truths: &[(usize, Outcome)]) -> (Vec<String>, usize) {
    let right = right_secs(scene.build.unit_secs());
    let marked = |place: usize| samples.trust(place) == Trust::Uncertain;
    let is_wrong = |(place, truth): &&(usize, Outcome)| {
        let given = samples.get(*place);
        let differs = given.status != truth.status || (given.time - truth.time).abs() > right;
        !marked(*place) && differs
    };
    let words = |(place, truth): &(usize, Outcome)| {
        format!("pixel {place}: {:?}, true {truth:?}", samples.get(*place))
    };
    let wrong = truths.iter().filter(is_wrong).map(words).collect();
    (wrong, (0..samples.len()).filter(|&place| marked(place)).count())
}

fn assert_right(scene: &Scene, side: u32, every: usize, most_marked: usize) {
    let samples = checked(scene, side, BALANCED);
    let (wrong, marked) = judged(scene, &samples, &truths(scene, side, every));
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(marked <= most_marked, "{marked} marked");
}

#[test]
fn bars_that_watch_the_first_bob() {
    assert_right(&scene(rods(), Rule::First, 30.0, View::default()), 48, 2, 8);
}

#[test]
fn a_judge_that_is_right_finds_what_is_wrong() {
    let scene = scene(rods(), Rule::First, 30.0, View::default());
    let mut samples = checked(&scene, 16, BALANCED);
    let flipped = (0..samples.len()).find(|&k| samples.get(k).status == Status::Answered).unwrap();
    let late = samples.get(flipped).time + 2e-3;
    samples.set(flipped, Outcome::flipped(late));
    assert_eq!(judged(&scene, &samples, &truths(&scene, 16, 1)).0.len(), 1);
}

#[test]
fn two_minutes_of_the_home_map() {
    assert_right(&scene(points(), Rule::Second, 120.0, View::default()), 40, 5, 40);
}

#[test]
fn a_pendulum_256_times_faster() {
    let fast = PendulumSpec::new(Sort::Points, [1.0; 2], [0.015625; 2], 1024.0);
    assert_right(&scene(fast, Rule::First, 0.7, View::default()), 32, 3, 60);
}

#[test]
fn both_coordinates_and_the_acceleration_vanish() {
    let center = ["1.5707963267948966192313216916397514", "3.1415926535897932384626433832795029"];
    let flat = View { stretch: 1e6, ..view(center, "1e-6") };
    assert_right(&scene(points(), Rule::Second, 30.0, flat), 16, 1, 0);
    let aside = ["1.5707967767948966192313216916397514", "3.1415926535897932384626433832795029"];
    let all = scene(points(), Rule::Second, 30.0, view(aside, "6e-14"));
    let samples = checked(&all, 16, BALANCED);
    assert!(samples.iter().all(|outcome| outcome.time < 1e-3 && outcome.time > 0.0));
    assert_right(&all, 16, 1, 0);
}

#[test]
fn deep_pixels_whose_maps_agree_by_accident() {
    let center = ["2.09361346098012980290894985198974609375", "1.9"];
    assert_right(&scene(points(), Rule::Second, 40.0, view(center, "6.9849193e-11")), 24, 3, 6);
}

#[test]
fn deep_pixels_that_polynomials_know_are_no_doubts() {
    let center = ["-1.65907312822246439054652000777423381805419921875", "0.1"];
    assert_right(&scene(points(), Rule::Second, 40.0, view(center, "7.1054274e-17")), 24, 16, 0);
}

/// Asserts that every configuration of an engine gives checked answers that are right or marked.
fn every_configuration_is_checked(engine: &dyn Fn() -> Box<dyn Engine>) {
    let scene = scene(rods(), Rule::First, 30.0, View::default());
    let truths = truths(&scene, 24, 1);
    let dopri5 = Method::dopri5;
    let dop853 = Method::dop853;
    let taylor = |tolerance| Method::Taylor { tolerance };
    let all = [
        (Method::LESSON, Precision::F32),
        (Method::LESSON, Precision::F64),
        (dopri5(1e-6), Precision::F32),
        (dopri5(1e-9), Precision::F64),
        (dopri5(1e-9), Precision::Df32),
        (dop853(1e-11), Precision::Df32),
        (taylor(1e-15), Precision::F64),
        (taylor(1e-25), Precision::Dd),
    ];
    let configs = all.map(|(method, precision)| IntegratorConfig { method, precision });
    let offered: Vec<IntegratorConfig> =
        configs.into_iter().filter(|config| engine().offers(config)).collect();
    assert!(offered.len() >= 4, "{offered:?}");
    for config in offered {
        let samples = checked_by(engine(), &scene, 24, config);
        let (wrong, marked) = judged(&scene, &samples, &truths);
        assert!(wrong.is_empty() && marked <= 4, "{config:?}: {marked} marked, {wrong:#?}");
    }
}

#[test]
fn every_configuration_of_the_processor_is_checked() {
    every_configuration_is_checked(&|| Box::new(CpuEngine::new(None).unwrap()));
}

mod gpu {
    pub(crate) fn every_configuration_of_a_graphics_card_is_checked() {
        super::every_configuration_is_checked(&|| Box::new(super::common::gpu_engine()));
    }
}

needs_adapter!(gpu: every_configuration_of_a_graphics_card_is_checked);

#[test]
fn a_small_hunt_comes_home_with_nothing() {
    let setting = IntegrationSetting::Accuracy(Accuracy::Exact);
    let request =
        EngineRequest { kind: Some(EngineKind::Cpu), setting, ..EngineRequest::default() };
    let hunt = Hunt::run(30.0, 5, 11, &request, &|| false, &mut |_| {}).unwrap();
    assert_eq!(hunt.windows, 5);
    assert!(hunt.judged > 1000 && hunt.wrong.is_empty(), "{hunt:#?}");
}
