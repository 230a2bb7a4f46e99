//! Growth, periodic orbits, and returns to the start.

use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::level::{BALANCED, FAST};
use flipmap_engine::{
    Engine, EventSpec, IntegratorConfig, Job, Keep, Method, Precision, Starts, Trust,
};
use flipmap_numbers::Dd;
use flipmap_pendulum::extremum::Extremum;
use flipmap_pendulum::taylor::Orbit;
use flipmap_pendulum::{State, Status};
use flipmap_render::tiles::{Renderer, Samples};
use flipmap_scene::question::Needs;
use flipmap_scene::question::QuestionName;
use flipmap_scene::{Plane, PlaneKind, Scene};
use rayon::prelude::*;

use crate::common::{gpu_engine, lesson};
use crate::truth::*;

#[test]
fn growth_is_the_gold_standards_by_every_method() {
    let scene = scene(QuestionName::Growth, plane("speeds", ["2", "-1", "0", "0"]), "8", 8.0);
    let truth: Vec<f64> = (0..81u32)
        .into_par_iter()
        .map(|k| true_exponent(&scene, start(&scene, 9, k).unwrap(), 8.0))
        .collect();
    let share_within = |config: IntegratorConfig, most: f64| {
        let samples = by_cpu(&scene, 9, config);
        let right = truth
            .iter()
            .enumerate()
            .filter(|(k, truth)| (samples.values(*k)[0] - **truth).abs() < most * truth.abs());
        right.count() as f64 / 81.0
    };
    assert!(share_within(BALANCED, 0.01) >= 0.99);
    let fast = share_within(FAST, 0.01);
    assert!(fast >= 0.9, "f32: {fast}");
    let coarse = share_within(lesson(Precision::F64), 0.01);
    assert!(coarse >= 0.8, "RK4: {coarse}");
    assert!(share_within(BALANCED, 1e-14) < 0.5, "the test can fail");
    let finest = share_within(ALL_METHODS[2], 1e-7);
    assert!(finest >= 0.99, "Taylor in f64: {finest}");
}

#[test]
fn growth_and_returns_in_double_double_are_right_to_the_last_digits() {
    let throw = plane("speeds", ["2", "-1", "0", "0"]);
    let growth = scene(QuestionName::Growth, throw.clone(), "8", 12.0);
    let by_dd = by_cpu(&growth, 3, DD);
    let by_f64 = by_cpu(&growth, 3, ALL_METHODS[2]);
    let error = |samples: &Samples, k: u32| {
        let truth = true_exponent(&growth, start(&growth, 3, k).unwrap(), 12.0);
        (samples.values(k as usize)[0] / truth - 1.0).abs()
    };
    let worst = |samples: &Samples| (0..9).map(|k| error(samples, k)).fold(0.0, f64::max);
    assert!(worst(&by_dd) < 1e-9, "{:e}", worst(&by_dd));
    assert!(worst(&by_f64) > worst(&by_dd), "f64 has fewer digits: {:e}", worst(&by_f64));
    let returns = scene(QuestionName::Return, throw, "8", 6.0);
    let (fine, rough) = (by_cpu(&returns, 4, DD), by_cpu(&returns, 4, ALL_METHODS[2]));
    for k in 0..16 {
        let (a, b) = (fine.values(k), rough.values(k));
        assert_eq!(fine.get(k).status, rough.get(k).status, "{k}");
        assert!(a == b || (0..2).all(|i| (a[i] - b[i]).abs() < 1e-6), "{k}: {a:?} {b:?}");
    }
    let engine = CpuEngine::new(Some(2)).unwrap();
    let job = Job {
        id: 0,
        question: EventSpec::from(&returns),
        config: DD,
        starts: Starts::Rest(vec![[Dd::new(1.0); 2]]),
        keep: Keep { ends: Needs::Extremum(Extremum::NearestReturn), states: true },
    };
    let refused = { engine }.submit(job).unwrap_err().to_string();
    assert!(refused.contains("so it cannot be saved"), "{refused}");
}

/// The most precise configuration.
const DD: IntegratorConfig =
    IntegratorConfig { method: Method::Taylor { tolerance: 1e-25 }, precision: Precision::Dd };

#[test]
#[cfg_attr(no_gpu, ignore = "FLIPMAP_NO_GPU=1 declares that there is no adapter")]
fn the_card_computes_the_growth_that_the_processor_does() {
    for plane in [Plane::default(), plane("speeds", ["1", "-1", "0", "0"])] {
        let scene = scene(QuestionName::Growth, plane, "6", 8.0);
        for config in [BALANCED, FAST, lesson(Precision::F64), lesson(Precision::F32)] {
            let by_card = rendered(&scene, 12, config, Box::new(gpu_engine()));
            let by_cpu = by_cpu(&scene, 12, config);
            let allowed = if config.precision == Precision::F32 { 0.05 } else { 1e-3 };
            let is_near = |k: &usize| {
                let (a, b) = (by_card.values(*k)[0], by_cpu.values(*k)[0]);
                (a / b - 1.0).abs() < allowed
            };
            let near = (0..144).filter(is_near).count();
            assert!(near >= 137, "{config:?}: {near} of 144");
        }
    }
}

#[test]
#[cfg_attr(no_gpu, ignore = "FLIPMAP_NO_GPU=1 declares that there is no adapter")]
fn the_card_finds_the_returns_that_the_processor_does() {
    for plane in [Plane::default(), plane("speeds", ["1", "-1", "0", "0"])] {
        let scene = scene(QuestionName::Return, plane, "6", 5.0);
        for config in [BALANCED, FAST, lesson(Precision::F64), lesson(Precision::F32)] {
            let by_card = rendered(&scene, 12, config, Box::new(gpu_engine()));
            let by_cpu = by_cpu(&scene, 12, config);
            // Lanes and cards round f32 differently, and chaos amplifies the difference.
            let [near, soon] =
                if config.precision == Precision::F32 { [1e-3, 1e-3] } else { [1e-6, 1e-4] };
            let is_same = |k: &usize| {
                let (a, b) = (by_card.values(*k), by_cpu.values(*k));
                let alike = by_card.get(*k).status == by_cpu.get(*k).status;
                alike && (a == b || ((a[0] - b[0]).abs() < near && (a[1] - b[1]).abs() < soon))
            };
            let same = (0..144).filter(is_same).count();
            let seen = (0..144).filter(|k| by_cpu.values(*k)[0].is_finite()).count();
            assert!(same >= 134 && seen > 72, "{config:?}: {same} of 144, {seen} return");
        }
    }
}

/// Pairs of f32 have many more digits than f32, so they agree with f64. The kernel compiles slowly.
#[test]
#[cfg_attr(no_gpu, ignore = "FLIPMAP_NO_GPU=1 declares that there is no adapter")]
fn pairs_of_floats_find_the_returns_of_f64() {
    let scene = scene(QuestionName::Return, plane("speeds", ["1", "-1", "0", "0"]), "6", 3.0);
    let method = Method::dopri5(1e-10);
    let by_pairs = IntegratorConfig { method, precision: Precision::Df32 };
    let by_card = rendered(&scene, 8, by_pairs, Box::new(gpu_engine()));
    let by_cpu = by_cpu(&scene, 8, BALANCED);
    let share_within = |most: f64| {
        let is_same = |k: &usize| {
            let (a, b) = (by_card.values(*k), by_cpu.values(*k));
            let alike = by_card.get(*k).status == by_cpu.get(*k).status;
            alike && (a == b || (0..2).all(|i| (a[i] - b[i]).abs() < most))
        };
        (0..64).filter(is_same).count() as f64 / 64.0
    };
    assert!(share_within(1e-5) >= 0.95, "{}", share_within(1e-5));
    assert!(share_within(1e-12) < 0.9, "the test can fail");
}

#[test]
fn sure_exponents_and_returns_are_right_and_those_beyond_the_horizon_are_marked() {
    let plane = plane("speeds", ["2", "-1", "0", "0"]);
    let scene = |ask, secs| scene(ask, plane.clone(), "8", secs);
    let growth = scene(QuestionName::Growth, 6.0);
    let (samples, uncertain) = checked(&growth, 9);
    assert!(uncertain < 30, "{uncertain} of 81 are uncertain");
    let wrong = (0..81u32).into_par_iter().filter(|&k| {
        let truth = || true_exponent(&growth, start(&growth, 9, k).unwrap(), 6.0);
        let is_sure = samples.trust(k as usize) != Trust::Uncertain;
        is_sure && (samples.values(k as usize)[0] / truth() - 1.0).abs() > 0.01
    });
    assert_eq!(wrong.count(), 0);
    let (_, beyond) = checked(&scene(QuestionName::Growth, 120.0), 9);
    assert!(beyond > 40, "only {beyond} of 81 are marked after 120 s");

    // Pixels that are not marked agree with another run of the same start.
    let returns = scene(QuestionName::Return, 6.0);
    let (samples, uncertain) = checked(&returns, 9);
    assert!(uncertain < 30, "{uncertain} of 81 are uncertain");
    let finer = by_cpu(&returns, 9, ALL_METHODS[0]);
    for k in 0..81 {
        let ([mine, _], [its, _]) = (samples.values(k), finer.values(k)) else { panic!() };
        let is_sure = samples.trust(k) != Trust::Uncertain;
        let answered = samples.get(k).status == Status::Answered;
        assert!(!is_sure || !answered || (mine - its).abs() < 2e-3, "{k}: {mine} {its}");
    }
}

/// Checked samples of `side` × `side` pixels, and the number of uncertain ones.
fn checked(scene: &Scene, side: u32) -> (Samples, u64) {
    let engine = Box::new(CpuEngine::new(Some(2)).unwrap());
    let mut renderer = Renderer::of(engine, BALANCED, true, Some(2)).unwrap();
    let samples = renderer.render(scene, [side; 2]).unwrap();
    (samples, renderer.counts().uncertain())
}

#[test]
fn a_periodic_orbit_returns_to_its_start_and_others_do_not() {
    let build =
        flipmap_scene::PendulumSpec::new(flipmap_scene::Kind::Points, [1.0; 2], [1.0; 2], 1.0);
    let orbits = [(-0.5, -1.2448609709185, 3.704_774_545), (0.5, -1.627044959203, 2.564_362_225)];
    for (energy, p2, secs) in orbits {
        let plane = Plane { kind: PlaneKind::Section, energy, ..Plane::default() };
        let mut scene = scene(QuestionName::Return, plane, "1e-9", 4.0);
        scene.build = build;
        scene.view.center = ["0".to_string(), format!("{p2}")];
        for config in &ALL_METHODS[..2] {
            let there = by_cpu(&scene, 1, *config);
            let [distance, time] = [there.values(0)[0], there.values(0)[1]];
            assert!(distance < 1e-7 && (time - secs).abs() < 1e-6, "{distance:e} {time}");
        }
        scene.view.center[1] = format!("{}", p2 + 0.01);
        let beside = by_cpu(&scene, 1, BALANCED).values(0)[0];
        assert!(beside > 1e-3, "{beside:e}");
    }
}

#[test]
fn the_nearest_return_is_the_least_distance_along_the_orbit() {
    let scene = scene(QuestionName::Return, plane("speeds", ["2", "1", "0", "0"]), "10", 5.0);
    let coarse = [FAST, lesson(Precision::F64), lesson(Precision::F32)];
    let mut by_config: Vec<(Samples, f64)> =
        coarse.iter().map(|config| (by_cpu(&scene, 8, *config), 5e-3)).collect();
    by_config.push((by_cpu(&scene, 8, BALANCED), 1e-3));
    by_config.push((by_cpu(&scene, 8, ALL_METHODS[2]), 1e-3));
    let pendulum = scene.build.pendulum();
    let weight = pendulum.momentum_scale().map(|scale| 1.0 / scale);
    for k in (0..64).step_by(5) {
        let begin = start(&scene, 8, k).unwrap();
        let near = |state: State<Dd>| {
            let state =
                State { angle: state.angle.map(|x| x.hi), speed: state.speed.map(|x| x.hi) };
            pendulum.phase(&state)
        };
        let from = near(begin);
        let mut orbit = Orbit::new(scene.build.pendulum_in::<Dd>(), begin);
        let (mut before, mut falls, mut least) = (0.0, false, f64::INFINITY);
        for step in 1..=20_000 {
            let phase = near(orbit.state_at(Dd::new(5.0 * f64::from(step) / 20_000.0)));
            let unit = |i: usize| if i < 4 { 1.0 } else { weight[i - 4] };
            let distance =
                (0..6).map(|i| ((phase[i] - from[i]) * unit(i)).powi(2)).sum::<f64>().sqrt();
            falls |= distance < before;
            // A minimum inside the budget, not its end.
            if falls && distance > before {
                least = least.min(before);
            }
            before = distance;
        }
        for (samples, allowed) in &by_config {
            let found = samples.values(k as usize)[0];
            let is_right = (found - least).abs() < *allowed
                || (least.is_infinite() && samples.get(k as usize).status != Status::Answered);
            assert!(is_right, "{k}: {found} {least}");
        }
    }
}
