//! States at a time, films of them, and friction.

use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::level::{BALANCED, FAST};
use flipmap_engine::{Engine, IntegratorConfig, Precision};
use flipmap_numbers::Decimal;
use flipmap_pendulum::taylor::Orbit;
use flipmap_pendulum::{State, Status};
use flipmap_render::tiles::moments::Moments;
use flipmap_render::tiles::{Renderer, Samples};
use flipmap_scene::Plane;
use flipmap_scene::question::QuestionName;

use crate::common::{gpu_engine, lesson};
use crate::truth::*;

#[test]
fn states_after_12_s_are_the_gold_standards() {
    let scene = scene(QuestionName::State, Plane::default(), "6.283185307179586", 12.0);
    // Some 1,100 of these starts are not forbidden.
    let samples = by_cpu(&scene, 40, BALANCED);
    assert_eq!(samples.channels(), 6);
    let share = share_of_right_states(&scene, 40, &samples, 1e-3);
    assert!(share >= 0.99, "{share}");
    let fast = share_of_right_states(&scene, 40, &by_cpu(&scene, 40, FAST), 1e-3);
    assert!(fast < share, "the test can fail: {fast}");
}

#[test]
fn a_state_lies_at_its_time_and_not_at_the_end_of_the_budget() {
    let mut scene =
        scene(QuestionName::State, plane("speeds", ["0.4", "-2", "0", "0"]), "14", 30.0);
    scene.question.at = Some(2.5);
    let samples = by_cpu(&scene, 12, BALANCED);
    assert_eq!(share_of_right_states(&scene, 12, &samples, 1e-7), 1.0);
    let mut later = scene.clone();
    later.question.at = Some(2.6);
    assert!(share_of_right_states(&later, 12, &samples, 1e-7) < 0.1, "the test can fail");
}

#[test]
fn a_pendulum_thrown_back_returns_to_where_it_was_thrown() {
    let origin = ["0.7", "-0.4", "0", "0"];
    let there = scene(QuestionName::State, plane("speeds", origin), "8", 4.0);
    let samples = by_cpu(&there, 8, BALANCED);
    let mut most = 0f64;
    for k in 0..64 {
        let thrown = start(&there, 8, k).unwrap();
        let [theta1, theta2, omega1, omega2, ..] = samples.values(k as usize) else { panic!() };
        let mut back = scene(
            QuestionName::State,
            plane("speeds", [&theta1.to_string(), &theta2.to_string(), "0", "0"]),
            "1e-9",
            4.0,
        );
        back.view.center = [-omega1, -omega2].map(|speed| speed.to_string());
        let home = by_cpu(&back, 1, BALANCED);
        let home = home.values(0);
        let angles = (0..2).map(|i| apart(home[i], thrown.angle[i].hi));
        let speeds = (0..2).map(|i| (home[2 + i] + thrown.speed[i].hi).abs());
        most = angles.chain(speeds).fold(most, f64::max);
    }
    assert!(most < 1e-5, "{most:e}");
    assert!(most > 1e-15, "the way back is not the way there");
}

#[test]
fn normal_modes_swing_as_they_must() {
    // ω² = (g/l)(2 ± √2), with θ2 = ∓√2 θ1; errors of the linear theory are of third order.
    for sign in [-1.0, 1.0] {
        let amplitude = 1e-4;
        let mut scene = scene(QuestionName::State, Plane::default(), "1e-12", 3.0);
        let theta2 = -sign * 2f64.sqrt() * amplitude;
        scene.view.center = [amplitude.to_string(), theta2.to_string()];
        let samples = by_cpu(&scene, 1, BALANCED);
        let omega = (9.81 * (2.0 + sign * 2f64.sqrt())).sqrt();
        let expected = (omega * 3.0).cos();
        let values = samples.values(0);
        assert!((values[0] - amplitude * expected).abs() < 1e-9, "{values:?}");
        assert!((values[1] - theta2 * expected).abs() < 1e-9, "{values:?}");
    }
}

#[test]
fn a_film_of_states_passes_through_the_states_of_stills() {
    let (fast, coarse) = (plane("speeds", ["2", "-1", "0", "0"]), lesson(Precision::F64));
    for (plane, config) in [(Plane::default(), BALANCED), (fast.clone(), BALANCED), (fast, coarse)]
    {
        let mut scene = scene(QuestionName::State, plane, "62", 30.0);
        let mut engine = CpuEngine::new(Some(2)).unwrap();
        let mut moments = Moments::new(&scene, [15, 11], config, 40);
        for at in [0.0, 0.3, 2.5, 2.5, 4.0] {
            let samples = moments.at(&mut engine, at, &|| true).unwrap().unwrap().clone();
            scene.question.at = Some(at);
            let mut renderer =
                Renderer::of(Box::new(CpuEngine::new(Some(2)).unwrap()), config, false, Some(2))
                    .unwrap();
            let still = renderer.render(&scene, [15, 11]).unwrap();
            let off = |samples: &Samples, k: usize| {
                (0..2).map(|i| apart(samples.values(k)[i], still.values(k)[i])).fold(0.0, f64::max)
            };
            let most = (0..165).map(|k| off(&samples, k)).fold(0.0, f64::max);
            assert!(most < 1e-9, "{at}: {most:e}");
        }
        assert!(moments.at(&mut engine, 5.0, &|| false).unwrap().is_none(), "it can be stopped");
    }
}

#[test]
fn a_film_of_any_question_about_a_time_passes_through_its_stills() {
    for ask in
        [QuestionName::Flips, QuestionName::Growth, QuestionName::Return, QuestionName::Speed]
    {
        for config in [BALANCED, FAST, lesson(Precision::F64)] {
            let mut scene = scene(ask, plane("speeds", ["2", "-1", "0", "0"]), "20", 30.0);
            let mut engine = CpuEngine::new(Some(2)).unwrap();
            let mut moments = Moments::new(&scene, [11, 9], config, 40);
            for at in [0.5, 1.25, 3.0] {
                let samples = moments.at(&mut engine, at, &|| true).unwrap().unwrap().clone();
                scene.question.at = Some(at);
                let still = {
                    let engine = Box::new(CpuEngine::new(Some(2)).unwrap());
                    let mut renderer = Renderer::of(engine, config, false, Some(2)).unwrap();
                    renderer.render(&scene, [11, 9]).unwrap()
                };
                for k in 0..99 {
                    assert_eq!(samples.get(k).status, still.get(k).status, "{ask} {k}");
                    let same = samples.values(k).iter().zip(still.values(k));
                    assert!(same.clone().all(|(a, b)| a == b), "{ask} {config:?} {at} {k}");
                }
            }
        }
    }
}

#[test]
fn friction_slows_every_method_alike() {
    let mut scene = scene(QuestionName::State, plane("speeds", ["2.5", "-1", "0", "0"]), "20", 6.0);
    scene.build.friction = [0.2, 0.1].map(Decimal::from);
    for config in ALL_METHODS {
        let share = share_of_right_states(&scene, 10, &by_cpu(&scene, 10, config), 1e-3);
        // The error of f32 is far above 1e-3 rad after 6 s of fast chaos.
        let least = if config == FAST { 0.8 } else { 0.98 };
        assert!(share >= least, "{config:?}: {share}");
    }
    let samples = by_cpu(&scene, 10, BALANCED);
    scene.build.friction = [0.2, 0.11].map(Decimal::from);
    assert!(share_of_right_states(&scene, 10, &samples, 1e-3) < 0.1, "the test can fail");
}

/// Checks that if friction has brought all pendulums to rest, a budget a hundred times as large
/// changes no answer and costs at most `factor` times as much. The cost depends on the length of
/// slices.
fn rests(
    ask: QuestionName,
    config: IntegratorConfig,
    factor: f64,
    engine: &dyn Fn() -> Box<dyn Engine>,
) {
    let spent = |secs: f64| {
        let plane = plane("speeds", ["1", "-1", "0", "0"]);
        let mut scene = scene(ask, plane, "10", secs);
        scene.build.friction = [2.0, 1.0].map(Decimal::from);
        let mut renderer = Renderer::of(engine(), config, false, Some(2)).unwrap();
        let samples = renderer.render(&scene, [12; 2]).unwrap();
        (samples, renderer.counts().effort.steps)
    };
    let ((short, less), (long, more)) = (spent(100.0), spent(10_000.0));
    assert_eq!(short, long, "{ask} {config:?}");
    assert!(short.iter().any(|outcome| outcome.status == Status::Answered), "{ask} {config:?}");
    assert!((more as f64) < factor * less as f64, "{ask} {config:?}: {more} beside {less}");
}

#[test]
fn what_friction_has_brought_to_rest_is_done_by_every_method() {
    for config in ALL_METHODS {
        for ask in [QuestionName::Flip, QuestionName::Flips, QuestionName::First] {
            rests(ask, config, 1.5, &|| Box::new(CpuEngine::new(Some(2)).unwrap()));
        }
    }
}

#[cfg_attr(no_gpu, ignore = "FLIPMAP_NO_GPU=1 declares that there is no adapter")]
#[test]
fn what_friction_has_brought_to_rest_is_done_on_a_card() {
    for config in [lesson(Precision::F32), FAST, BALANCED] {
        for ask in [QuestionName::Flip, QuestionName::Flips] {
            // On a busy machine one slice can last for many budgets.
            rests(ask, config, 30.0, &|| Box::new(gpu_engine()));
        }
    }
}

#[test]
fn what_friction_takes_is_what_energy_loses() {
    let friction = [0.2, 0.1].map(Decimal::from);
    let pendulum = flipmap_scene::PendulumSpec { friction, ..Default::default() }.pendulum();
    let [b1, b2] = pendulum.friction.unwrap();
    let begin = State { angle: [2.5, -1.0], speed: [3.0, 8.0] };
    let mut orbit = Orbit::new(pendulum, begin);
    // Gauss-Legendre quadrature with five points in each step of the expansion.
    let nodes = [0.0, 0.538_469_310_105_683_1, 0.906_179_845_938_664];
    let weights = [0.568_888_888_888_888_9, 0.478_628_670_499_366_5, 0.236_926_885_056_189_1];
    let mut work = 0.0;
    while orbit.time() < 10.0 {
        let step = orbit.step();
        let power = |tau: f64| {
            let [w1, w2] = step.state(tau).speed;
            b1 * w1 * w1 + b2 * (w2 - w1) * (w2 - w1)
        };
        let quarter = step.length / 4.0;
        for part in 0..4 {
            let middle = (f64::from(part) + 0.5) * quarter;
            for (node, weight) in nodes.iter().zip(weights) {
                let sides: &[f64] = if *node == 0.0 { &[1.0] } else { &[1.0, -1.0] };
                for side in sides {
                    work += weight * 0.5 * quarter * power(middle + side * node * 0.5 * quarter);
                }
            }
        }
    }
    let lost = pendulum.energy(&begin) - pendulum.energy(orbit.state());
    assert!(lost > 10.0 && (work - lost).abs() < 1e-9 * lost, "{work} {lost}");
}
