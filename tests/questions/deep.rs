//! States and growth in deep views, read from polynomials of the flow or integrated after them.

use std::f64::consts::TAU;

use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::depth::DepthEngine;
use flipmap_engine::level::{BALANCED, FAST};
use flipmap_engine::{IntegratorConfig, Trust};
use flipmap_numbers::{Exact, Fixed, Scalar};
use flipmap_pendulum::State;
use flipmap_pendulum::tangents::TangentMap;
use flipmap_pendulum::taylor::Orbit;
use flipmap_render::tiles::{Renderer, Samples};
use flipmap_scene::question::QuestionName;
use flipmap_scene::{Budget, Scene, View};
use rayon::prelude::*;

use crate::truth::apart;

const SIDE: u32 = 10;
/// Number of pixels.
const COUNT: usize = (SIDE * SIDE) as usize;

/// A deep view: θ1 and θ2, and the width.
const VIEW: ([&str; 2], &str) =
    (["1.232005966977461660140937", "2.083059647952103789629524"], "6e-13");

fn scene() -> Scene {
    let center = VIEW.0.map(str::to_string);
    let view = View { center, width: VIEW.1.to_string(), ..View::default() };
    let mut scene = Scene { view, ..Scene::default() };
    scene.question.budget = Budget { auto: true, ..Budget::default() };
    let mut scene = scene.checked().unwrap();
    scene.question.ask = QuestionName::State;
    scene
}

fn rendered(scene: &Scene, config: IntegratorConfig, verify: bool) -> Samples {
    let inner = Box::new(CpuEngine::new(Some(2)).unwrap());
    let engine = Box::new(DepthEngine::new(inner, Some(2)).unwrap());
    let mut renderer = Renderer::of(engine, config, verify, Some(2)).unwrap();
    renderer.render(scene, [SIDE; 2]).unwrap()
}

/// The states of a pixel at two times, with unwrapped angles, each integrated on its own in long
/// numbers.
fn truth(scene: &Scene, k: u32, times_secs: [f64; 2]) -> [State<f64>; 2] {
    let mut orbit = orbit_of(scene, k);
    times_secs.map(|secs| {
        let state = orbit.state_at(Fixed::<4>::from_f64(secs));
        State { angle: state.angle.map(Scalar::to_f64), speed: state.speed.map(Scalar::to_f64) }
    })
}

/// The motion of a pixel's pendulum in long numbers.
fn orbit_of(scene: &Scene, k: u32) -> Orbit<Fixed<4>> {
    let pixel = scene.view.width_rad().to_f64() / f64::from(SIDE);
    let half = f64::from(SIDE) / 2.0;
    let [x, y] = [k % SIDE, k / SIDE].map(|at| f64::from(at) + 0.5);
    let by = [x - half, half - y].map(|by| Exact::from_f64(by * pixel));
    let center = scene.view.center_rad();
    let angle = [0, 1].map(|i| (center[i] + by[i]).resized::<4>());
    Orbit::new(scene.build.pendulum_in(), State::rest(angle))
}

/// The exponent of a pixel over the budget, from tangent maps of short stretches of its motion, which
/// is integrated on its own in long numbers.
fn exponent(scene: &Scene, k: u32) -> f64 {
    let secs = scene.question.budget.secs;
    let (pendulum, unit_secs) = scene.build.pendulum().reduced();
    let mut orbit = orbit_of(scene, k);
    let stretches = (4.0 * secs).ceil() as u32;
    let stretch = secs / f64::from(stretches);
    let mut map = TangentMap::identity();
    for i in 0..stretches {
        let state = orbit.state_at(Fixed::<4>::from_f64(f64::from(i) * stretch));
        let angle = state.angle.map(|angle| angle.wrapped().to_f64());
        let speed = state.speed.map(|speed| speed.to_f64() * unit_secs);
        let phase = pendulum.phase(&State { angle, speed });
        map = map.followed_by(&pendulum, &phase, stretch / unit_secs);
    }
    map.log_growth() / secs
}

/// Returns true for each pixel whose state is right within 1e-3 rad, including its turns.
fn right(samples: &Samples, truths: &[State<f64>]) -> Vec<bool> {
    let is_right = |(k, truth): (usize, &State<f64>)| {
        let values = samples.values(k);
        let near = (0..2).all(|i| apart(values[i], truth.angle[i]) < 1e-3);
        let turned = |i: usize| (values[i] + TAU * values[4 + i] - truth.angle[i]).abs() < 1e-2;
        near && turned(0) && turned(1)
    };
    truths.iter().enumerate().map(is_right).collect()
}

#[test]
fn deep_states_are_those_of_pendulums_integrated_in_long_numbers() {
    let mut scene = scene();
    let last = scene.question.budget.secs;
    let times = [0.6 * last, 0.8 * last];
    let all: Vec<[State<f64>; 2]> =
        (0..SIDE * SIDE).into_par_iter().map(|k| truth(&scene, k, times)).collect();
    for (time, least) in [(0, 1.0), (1, 0.9)] {
        let at = times[time];
        scene.question.at = Some(at);
        let truths: Vec<State<f64>> = all.iter().map(|states| states[time]).collect();
        let share = |samples: &Samples| {
            let right = right(samples, &truths);
            right.iter().filter(|right| **right).count() as f64 / right.len() as f64
        };
        let samples = rendered(&scene, BALANCED, false);
        assert!(share(&samples) >= least, "{} after {at} s", share(&samples));
        assert!(share(&rendered(&scene, FAST, false)) > 0.5, "after {at} s");
        if time == 1 {
            let far = |a: &State<f64>| apart(a.angle[1], truths[0].angle[1]) > 0.1;
            assert!(
                truths.iter().filter(|truth| far(truth)).count() > COUNT / 5,
                "they have parted"
            );
            let turned: Vec<f64> = (0..COUNT).map(|k| samples.values(k)[5]).collect();
            assert!(turned.iter().any(|turns| *turns != 0.0), "some turns are counted");
            let mut other = scene.clone();
            other.view.width = "1.2e-12".to_string();
            assert!(share(&rendered(&other, BALANCED, false)) < 0.5, "the comparison can fail");
            let checked = rendered(&scene, BALANCED, true);
            let right = right(&checked, &truths);
            let sure = |k: &usize| checked.trust(*k) != Trust::Uncertain;
            assert!((0..COUNT).filter(sure).all(|k| right[k]), "what is sure is right");
            assert!((0..COUNT).filter(sure).count() > COUNT / 2, "most are sure");
        }
    }
}

#[test]
fn deep_growth_is_that_of_tangents_along_motions_in_long_numbers() {
    let mut scene = scene();
    scene.question.ask = QuestionName::Growth;
    let last = scene.question.budget.secs;
    let some: Vec<usize> = (0..COUNT).step_by(5).collect();
    // First while all pendulums swing together, then after they have separated.
    for (part, least_apart, least_by_f32) in [(0.6, 0.0, 1.0), (1.0, 0.02, 0.3)] {
        scene.question.budget = Budget { secs: part * last, ..Budget::default() };
        let truths: Vec<f64> = some.par_iter().map(|k| exponent(&scene, *k as u32)).collect();
        let [least, most] =
            [f64::min, f64::max].map(|of| truths.iter().copied().reduce(of).unwrap());
        assert!(least > 0.5 && most - least >= least_apart, "{least} to {most}");
        let is_right = |samples: &Samples, i: usize| {
            (samples.values(some[i])[0] / truths[i] - 1.0).abs() < 1e-2
        };
        let share = |samples: &Samples| {
            let right = (0..some.len()).filter(|i| is_right(samples, *i));
            right.count() as f64 / some.len() as f64
        };
        let balanced = share(&rendered(&scene, BALANCED, false));
        assert!(balanced >= 0.99, "{balanced} after {part}");
        let fast = share(&rendered(&scene, FAST, false));
        assert!(fast >= least_by_f32, "{fast} after {part}");
        if least_apart > 0.0 {
            let mut other = scene.clone();
            other.view.center[0] = "1.2320059770".to_string();
            let other = share(&rendered(&other, BALANCED, false));
            assert!(other < 0.9, "the comparison can fail: {other}");
            let checked = rendered(&scene, BALANCED, true);
            let sure = |i: &usize| checked.trust(some[*i]) != Trust::Uncertain;
            assert!((0..some.len()).filter(sure).all(|i| is_right(&checked, i)), "sure is right");
        }
    }
}

#[test]
fn growth_after_a_short_time_is_right_however_narrow_the_view() {
    let center = ["-1.129", "-0.46"].map(str::to_string);
    for (width, secs) in [("1e-12", 0.3), ("1e-12", 1.0), ("1e-6", 1.0), ("1e-4", 5.0)] {
        let view = View { center: center.clone(), width: width.to_string(), ..View::default() };
        let mut scene = Scene { view, ..Scene::default() };
        scene.question.ask = QuestionName::Growth;
        scene.question.budget = Budget { secs, ..Budget::default() };
        let samples = rendered(&scene, BALANCED, false);
        for k in (0..COUNT).step_by(11) {
            let (answer, truth) = (samples.values(k)[0], exponent(&scene, k as u32));
            assert!((answer / truth - 1.0).abs() < 1e-4, "{width} after {secs}: {answer} {truth}");
        }
    }
}
