//! Helpers for tests of questions: scenes, answers, and true answers by the gold standard.

use std::f64::consts::{PI, TAU};

use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::depth::DepthEngine;
use flipmap_engine::level::{BALANCED, FAST};
use flipmap_engine::{Engine, IntegratorConfig, Method, Precision};
use flipmap_numbers::{Dd, Scalar};
use flipmap_pendulum::oracle::flip_within;
use flipmap_pendulum::passes::{Pass, passes_until};
use flipmap_pendulum::taylor::Orbit;
use flipmap_pendulum::{Launch, Outcome, State, Status};
use flipmap_render::tiles::{Renderer, Samples};
use flipmap_scene::question::QuestionName;
use flipmap_scene::{Budget, Fate, Grid, Plane, PlaneKind, QuestionSettings, Scene, View};
use rayon::prelude::*;

pub(crate) fn scene(ask: QuestionName, plane: Plane, width: &str, secs: f64) -> Scene {
    let question =
        QuestionSettings { ask, budget: Budget::secs(secs), ..QuestionSettings::default() };
    let view = View { width: width.to_string(), ..View::default() };
    Scene { question, plane, view, ..Scene::default() }.checked().unwrap()
}

pub(crate) fn plane(kind: &str, origin: [&str; 4]) -> Plane {
    let kind: PlaneKind = kind.parse().unwrap();
    Plane { kind, origin: origin.map(str::to_string), ..Plane::default() }
}

pub(crate) fn rendered(
    scene: &Scene,
    side: u32,
    config: IntegratorConfig,
    engine: Box<dyn Engine>,
) -> Samples {
    let engine = Box::new(DepthEngine::new(engine, Some(2)).unwrap());
    let mut renderer = Renderer::of(engine, config, false, Some(2)).unwrap();
    renderer.render(scene, [side; 2]).unwrap()
}

pub(crate) fn by_cpu(scene: &Scene, side: u32, config: IntegratorConfig) -> Samples {
    rendered(scene, side, config, Box::new(CpuEngine::new(Some(2)).unwrap()))
}

/// Returns the start of a pixel with its speeds, or `None` if it is forbidden.
pub(crate) fn start(scene: &Scene, side: u32, k: u32) -> Option<State<Dd>> {
    match Grid::new(scene, [side; 2]).fate(k % side, k / side) {
        Fate::Known(_) => None,
        Fate::Open(angle) => Some(State::rest(angle)),
        Fate::Thrown(Launch { angle, speed }) => Some(State { angle, speed }),
        Fate::BesideTop(moments) => {
            let Launch { angle, speed } = moments.launch(scene.build.reduced_in::<Dd>().1);
            Some(State { angle, speed })
        }
    }
}

/// The state after `secs`, with unwrapped angles, by the gold standard.
pub(crate) fn true_state(scene: &Scene, start: State<Dd>, secs: f64) -> State<f64> {
    let state = Orbit::new(scene.build.pendulum_in::<Dd>(), start).state_at(Dd::new(secs));
    State { angle: state.angle.map(Dd::to_f64), speed: state.speed.map(Dd::to_f64) }
}

/// The flip of a thrown pendulum by the gold standard.
pub(crate) fn true_flip(scene: &Scene, start: State<Dd>) -> Outcome {
    let (rule, budget) = (scene.question.watched(), scene.question.budget.secs);
    let mut orbit = Orbit::new(scene.build.pendulum_in::<Dd>(), start);
    while orbit.time().hi <= budget {
        let step = orbit.step();
        if let Some(tau) = flip_within(&step, rule) {
            let secs = (step.start + tau).hi;
            let fits = secs <= budget;
            return if fits {
                Outcome::flipped(secs)
            } else {
                Outcome::without_time(Status::Unflipped)
            };
        }
    }
    Outcome::without_time(Status::Unflipped)
}

/// Difference of two angles on the circle, rad.
pub(crate) fn apart(a: f64, b: f64) -> f64 {
    let by = (a - b).abs() % TAU;
    by.min(TAU - by)
}

/// Returns the share of a scene's pixels whose state is right: angles within `most` rad, exact
/// turns, and speeds within ten times `most`.
pub(crate) fn share_of_right_states(scene: &Scene, side: u32, samples: &Samples, most: f64) -> f64 {
    let is_right = |k: u32| {
        let truth = true_state(scene, start(scene, side, k)?, scene.question.end_secs());
        let values = samples.values(k as usize);
        let turns = truth.angle.map(|angle| ((angle - PI) / TAU).ceil());
        // At exactly ±π a turn may count on either side.
        let whole = |bob: usize| values[bob] + TAU * values[4 + bob] - truth.angle[bob];
        let near = |bob: usize| {
            apart(values[bob], truth.angle[bob]) < most
                && (values[2 + bob] - truth.speed[bob]).abs() < 10.0 * most
                && whole(bob).abs() < 2.0 * most
                && (values[4 + bob] == turns[bob] || values[bob].abs() > PI - most)
        };
        Some((0..2).all(near))
    };
    let right: Vec<bool> = (0..side * side).into_par_iter().filter_map(is_right).collect();
    assert!(right.len() as u32 > side * side / 2);
    right.iter().filter(|right| **right).count() as f64 / right.len() as f64
}

/// Share of a scene's open pixels whose flip is right within 1 ms.
pub(crate) fn share_of_right_flips(scene: &Scene, side: u32, samples: &Samples) -> f64 {
    let is_right = |k: u32| {
        let (truth, found) = (true_flip(scene, start(scene, side, k)?), samples.get(k as usize));
        Some(truth.status == found.status && (truth.time - found.time).abs() < 1e-3)
    };
    let right: Vec<bool> = (0..side * side).into_par_iter().filter_map(is_right).collect();
    assert!(right.len() as u32 > side * side / 4, "{}", right.len());
    right.iter().filter(|right| **right).count() as f64 / right.len() as f64
}

/// Returns the growth of the fastest-growing nudge by the gold standard, from central differences
/// of orbits in double-double.
pub(crate) fn true_exponent(scene: &Scene, start: State<Dd>, secs: f64) -> f64 {
    // Far larger than the errors of orbits in double-double, far smaller than the inverse of any
    // growth.
    const NUDGE: f64 = 1e-16;
    let unit = scene.build.unit_secs();
    let column = |k: usize| {
        let ends = [-NUDGE, NUDGE].map(|by| {
            let mut moved = start;
            if k < 2 {
                moved.angle[k] = moved.angle[k] + Dd::new(by);
            } else {
                moved.speed[k - 2] = moved.speed[k - 2] + Dd::new(by / unit);
            }
            Orbit::new(scene.build.pendulum_in::<Dd>(), moved).state_at(Dd::new(secs))
        });
        let angle = |i: usize| (ends[1].angle[i] - ends[0].angle[i]).hi / (2.0 * NUDGE);
        let speed = |i: usize| (ends[1].speed[i] - ends[0].speed[i]).hi * unit / (2.0 * NUDGE);
        [angle(0), angle(1), speed(0), speed(1)]
    };
    let columns = [0, 1, 2, 3].map(column);
    // The largest singular value, by power iteration with the map and its transpose.
    let mut nudge = [1.0, 0.7, -0.4, 0.2];
    let mut growth = 0.0;
    for _ in 0..200 {
        let moved: [f64; 4] =
            std::array::from_fn(|i| (0..4).map(|k| columns[k][i] * nudge[k]).sum());
        growth = moved.iter().map(|x| x * x).sum::<f64>().sqrt();
        let back: [f64; 4] =
            std::array::from_fn(|k| (0..4).map(|i| columns[k][i] * moved[i]).sum());
        let length = back.iter().map(|x| x * x).sum::<f64>().sqrt();
        nudge = back.map(|x| x / length);
    }
    growth.ln() / secs
}

/// All passes of the top by both bobs up to the end of the budget by the gold standard, in order.
pub(crate) fn true_passes(scene: &Scene, start: State<Dd>) -> Vec<Pass> {
    passes_until(Orbit::new(scene.build.pendulum_in::<Dd>(), start), scene.question.end_secs())
}

pub(crate) const ALL_METHODS: [IntegratorConfig; 5] = [
    BALANCED,
    IntegratorConfig { method: Method::dopri5(1e-10), precision: Precision::F64 },
    IntegratorConfig { method: Method::Taylor { tolerance: 1e-15 }, precision: Precision::F64 },
    IntegratorConfig { method: Method::Rk4 { step_secs: 1.0 / 2000.0 }, precision: Precision::F64 },
    FAST,
];
