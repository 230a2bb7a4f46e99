//! Flips on every plane, counts of them, checks, and the graphics engine.

use flipmap_engine::Precision;
use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::level::{BALANCED, FAST};
use flipmap_numbers::Decimal;
use flipmap_pendulum::{Outcome, Status};
use flipmap_render::tiles::{Renderer, Samples};
use flipmap_scene::question::QuestionName;
use flipmap_scene::{Plane, PlaneKind, QuestionSettings, Scene};
use rayon::prelude::*;

use crate::common::{gpu_engine, lesson};
use crate::truth::*;

#[test]
fn flips_on_every_plane_are_the_gold_standards() {
    let planes = [
        (plane("speeds", ["0", "0", "0", "0"]), "24"),
        (plane("first", ["0", "1.5", "0", "-3"]), "9"),
        (plane("second", ["-2", "0", "4", "0"]), "9"),
        (plane("theta1,omega2", ["0", "0.5", "-1", "0"]), "9"),
        (plane("angles", ["0", "0", "3", "-5"]), "6.28"),
        (Plane { kind: PlaneKind::Section, energy: 5.0, ..Plane::default() }, "8"),
    ];
    for (plane, width) in planes {
        for friction in [[0.0, 0.0], [0.1, 0.05]] {
            let mut scene = scene(QuestionName::Flip, plane.clone(), width, 8.0);
            scene.build.friction = friction.map(Decimal::from);
            let share = share_of_right_flips(&scene, 14, &by_cpu(&scene, 14, BALANCED));
            assert!(share >= 0.99, "{:?} {friction:?}: {share}", scene.plane);
        }
    }
}

#[test]
fn checked_pixels_of_other_questions_and_planes_are_sure_or_marked() {
    let mut swung = scene(QuestionName::Flip, plane("speeds", ["0", "0", "0", "0"]), "24", 20.0);
    swung.view.center = ["1".into(), "2".into()];
    let state = scene(QuestionName::State, Plane::default(), "6.283185307179586", 20.0);
    for scene in [swung, state] {
        let engine = Box::new(CpuEngine::new(Some(2)).unwrap());
        let mut renderer = Renderer::of(engine, BALANCED, true, Some(2)).unwrap();
        let samples = renderer.render(&scene, [12; 2]).unwrap();
        let counts = renderer.counts();
        assert!(counts.uncertain() < 8, "{}", counts.uncertain());
        for k in 0..144 {
            let Some(start) = start(&scene, 12, k) else { continue };
            if samples.trust(k as usize) == flipmap_engine::Trust::Uncertain {
                continue;
            }
            if scene.question.ask == QuestionName::State {
                let truth = true_state(&scene, start, 20.0);
                let values = samples.values(k as usize);
                let off =
                    (0..2).map(|bob| apart(values[bob], truth.angle[bob])).fold(0.0, f64::max);
                assert!(off < 1e-3, "{k}: {off:e}");
            } else {
                let (truth, found) = (true_flip(&scene, start), samples.get(k as usize));
                assert_eq!(truth.status, found.status, "{k}");
                assert!((truth.time - found.time).abs() < 1e-3, "{k}");
            }
        }
    }
}

#[test]
fn the_bob_that_goes_first_is_the_one_whose_own_flip_comes_first() {
    let scene = scene(QuestionName::First, Plane::default(), "6.283185307179586", 10.0);
    let samples = by_cpu(&scene, 30, BALANCED);
    let flips = |rule| {
        let question = QuestionSettings { ask: QuestionName::Flip, rule, ..scene.question };
        by_cpu(&Scene { question, ..scene.clone() }, 30, BALANCED)
    };
    let [first, second] =
        [flipmap_pendulum::Rule::First, flipmap_pendulum::Rule::Second].map(flips);
    let secs = |samples: &Samples, k| match samples.get(k) {
        Outcome { status: Status::Answered, time } => time,
        _ => f64::INFINITY,
    };
    let mut seen = [0; 2];
    for k in (0..900).filter(|k| samples.get(*k).status == Status::Answered) {
        let [bob, time] = [samples.values(k)[0], samples.values(k)[1]];
        let [one, two] = [secs(&first, k), secs(&second, k)];
        assert_eq!(bob, if one < two { 1.0 } else { 2.0 }, "{k}: {one} {two}");
        assert!((time - one.min(two)).abs() < 1e-3, "{k}");
        seen[bob as usize - 1] += 1;
    }
    assert!(seen.iter().all(|count| *count > 20), "{seen:?}");
}

#[test]
fn every_flip_is_counted_by_every_method() {
    let scene = scene(QuestionName::Flips, plane("speeds", ["2.5", "-1", "0", "0"]), "24", 6.0);
    let side = 12;
    let truth: Vec<[f64; 4]> = (0..side * side)
        .into_par_iter()
        .map(|k| {
            let mut counts = [0.0; 4];
            for pass in true_passes(&scene, start(&scene, side, k).unwrap()) {
                counts[2 * (pass.bob - 1) + usize::from(!pass.anticlockwise)] += 1.0;
            }
            counts
        })
        .collect();
    assert!((0..4).all(|way| truth.iter().any(|counts| counts[way] > 5.0)), "all ways are seen");
    for config in ALL_METHODS {
        let samples = by_cpu(&scene, side, config);
        let right = (0..truth.len()).filter(|k| samples.values(*k) == truth[*k]).count();
        assert!(right * 100 >= truth.len() * 97, "{config:?}: {right} of {}", truth.len());
    }
}

#[test]
fn the_third_flip_is_found_by_every_method() {
    let mut scene = scene(QuestionName::Flip, Plane::default(), "6.283185307179586", 8.0);
    scene.question.count = 3;
    let side = 20;
    let truth: Vec<Option<f64>> = (0..side * side)
        .into_par_iter()
        .map(|k| {
            let passes = true_passes(&scene, start(&scene, side, k)?);
            passes.iter().filter(|pass| pass.bob == 2).map(|pass| pass.time.hi).nth(2)
        })
        .collect();
    let seen = truth.iter().flatten().count();
    assert!(seen > 40, "{seen}");
    for config in ALL_METHODS {
        let samples = by_cpu(&scene, side, config);
        let is_right = |k: &usize| match (truth[*k], samples.get(*k)) {
            (Some(truth), Outcome { status: Status::Answered, time }) => {
                (truth - time).abs() < 1e-3
            }
            (None, Outcome { status, .. }) => status != Status::Answered,
            _ => false,
        };
        let right = (0..truth.len()).filter(is_right).count();
        assert!(right * 100 >= truth.len() * 97, "{config:?}: {right} of {}", truth.len());
    }
}

#[test]
#[cfg_attr(no_gpu, ignore = "FLIPMAP_NO_GPU=1 declares that there is no adapter")]
fn the_card_answers_as_the_processor_does() {
    let state = scene(QuestionName::State, Plane::default(), "6.283185307179586", 4.0);
    let swung = scene(QuestionName::State, plane("speeds", ["1", "-1", "0", "0"]), "12", 4.0);
    for scene in [state, swung] {
        for config in [BALANCED, FAST, lesson(Precision::F64)] {
            let samples = rendered(&scene, 12, config, Box::new(gpu_engine()));
            let share = share_of_right_states(&scene, 12, &samples, 1e-2);
            assert!(share > 0.95, "{config:?}: {share}");
        }
    }
    for friction in [[0.0, 0.0], [0.1, 0.05]] {
        let mut flips = scene_of_flips();
        flips.build.friction = friction.map(Decimal::from);
        let samples = rendered(&flips, 14, BALANCED, Box::new(gpu_engine()));
        assert!(share_of_right_flips(&flips, 14, &samples) >= 0.99, "{friction:?}");
    }
}

#[test]
#[cfg_attr(no_gpu, ignore = "FLIPMAP_NO_GPU=1 declares that there is no adapter")]
fn the_card_counts_as_the_processor_does() {
    let all = scene(QuestionName::Flips, plane("speeds", ["2.5", "-1", "0", "0"]), "24", 6.0);
    let mut third = scene(QuestionName::Flip, Plane::default(), "6.283185307179586", 8.0);
    third.question.count = 3;
    for scene in [all, third] {
        for config in [BALANCED, FAST, lesson(Precision::F32), lesson(Precision::F64)] {
            let by_card = rendered(&scene, 16, config, Box::new(gpu_engine()));
            let by_cpu = by_cpu(&scene, 16, config);
            let is_same = |k: &usize| {
                let (a, b) = (by_card.values(*k), by_cpu.values(*k));
                let near = a.iter().zip(b).all(|(a, b)| a == b || (a - b).abs() < 1e-3);
                by_card.get(*k).status == by_cpu.get(*k).status && near
            };
            let same = (0..256).filter(is_same).count();
            assert!(same >= 250, "{:?} {config:?}: {same} of 256", scene.question.ask);
        }
    }
}

#[test]
fn two_bobs_that_pass_in_one_step_are_counted_once_each() {
    let mut scene =
        scene(QuestionName::Flips, plane("speeds", ["3.135", "3.13", "0", "0"]), "0.2", 0.2);
    scene.view.center = ["3", "3"].map(|speed| speed.parse().unwrap());
    for config in ALL_METHODS {
        let samples = by_cpu(&scene, 4, config);
        for k in 0..16 {
            assert_eq!(samples.values(k), [1.0, 0.0, 1.0, 0.0], "{config:?} {k}");
        }
    }
    if cfg!(not(no_gpu)) {
        let samples = rendered(&scene, 4, lesson(Precision::F64), Box::new(gpu_engine()));
        assert!((0..16).all(|k| samples.values(k) == [1.0, 0.0, 1.0, 0.0]));
    }
}

fn scene_of_flips() -> Scene {
    scene(QuestionName::Flip, plane("second", ["-2", "0", "4", "0"]), "9", 8.0)
}

/// Rounding can put a bob that is exactly at the top on either side of it. When each change of side
/// counted as a pass, the count of one start in this picture never ended.
#[test]
fn counts_in_fixed_steps_end() {
    let folder = tempfile::tempdir().unwrap();
    let mut render = std::process::Command::new(env!("CARGO_BIN_EXE_flipmap"))
        .current_dir(&folder)
        .args(["render", "turns", "--size", "64x48", "--engine", "cpu", "--accuracy", "lesson"])
        .args(["-o", "turns.png"])
        .spawn()
        .unwrap();
    let begun = std::time::Instant::now();
    while render.try_wait().unwrap().is_none() {
        if begun.elapsed() > std::time::Duration::from_secs(120) {
            render.kill().unwrap();
            panic!("a second's work has not ended after two minutes");
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    assert!(render.wait().unwrap().success());
}
