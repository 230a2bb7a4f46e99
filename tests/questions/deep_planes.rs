//! Deep views of planes of thrown pendulums.

use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::depth::DepthEngine;
use flipmap_engine::level::{BALANCED, FAST, LESSON};
use flipmap_engine::{IntegratorConfig, Trust};
use flipmap_numbers::{Angle, Fixed, Scalar};
use flipmap_pendulum::taylor::Orbit;
use flipmap_pendulum::{Outcome, State, Status, oracle};
use flipmap_render::tiles::{Renderer, Samples};
use flipmap_scene::question::QuestionName;
use flipmap_scene::{Axis, Budget, Plane, PlaneKind, Scene, View};
use rayon::prelude::*;

use crate::truth::apart;

type Long = Fixed<4>;

const SIDE: u32 = 10;
const COUNT: usize = (SIDE * SIDE) as usize;
/// Width of the views: far below the resolution of f64.
const WIDTH: f64 = 1e-18;

fn plane(kind: &str, origin: [&str; 4]) -> Plane {
    Plane { kind: kind.parse().unwrap(), origin: origin.map(str::to_string), ..Plane::default() }
}

fn scene(plane: Plane, center: [Long; 2], secs: f64) -> Scene {
    let center = center.map(|x| x.to_string());
    let view = View { center, width: WIDTH.to_string(), ..View::default() };
    let mut scene = Scene { view, plane, ..Scene::default() };
    scene.question.budget = Budget::secs(secs);
    scene.checked().unwrap()
}

fn rendered(scene: &Scene, config: IntegratorConfig, verify: bool) -> Samples {
    let inner = Box::new(CpuEngine::new(Some(2)).unwrap());
    let engine = Box::new(DepthEngine::new(inner, Some(2)).unwrap());
    let mut renderer = Renderer::of(engine, config, verify, Some(2)).unwrap();
    renderer.render(scene, [SIDE; 2]).unwrap()
}

/// The start at a position in a plane, rad and rad/s. On a section θ1 = 0, and both speeds solve
/// the equations of the energy and of p2.
fn start(plane: &Plane, at: [Long; 2]) -> State<Long> {
    if plane.kind == PlaneKind::Section {
        let [theta2, p2] = at;
        let pendulum = Scene::default().build.pendulum_in::<Long>();
        let cos = theta2.sin_cos().1;
        // ½A ω1² + C c ω1 ω2 + ½B ω2² = K with ω2 = (p2 − C c ω1) / B, as α ω1² + γ = 0.
        let (a, b, c) = (pendulum.a, pendulum.b, pendulum.c * cos);
        let (half, kinetic) = (
            Long::from_f64(0.5),
            Long::from_f64(plane.energy)
                + pendulum.depth([1.0, 0.0].map(Long::from_f64))
                + pendulum.q * cos,
        );
        let alpha = half * (a - c * c / b);
        let gamma = half * p2 * p2 / b - kinetic;
        let omega1 = (-gamma / alpha).sqrt();
        let angle = [Long::ZERO, theta2];
        return State { angle, speed: [omega1, (p2 - c * omega1) / b] };
    }
    let mut all = [0, 1, 2, 3].map(|i| Long::parse(&plane.origin[i]).unwrap());
    for (axis, value) in plane.axes().into_iter().zip(at) {
        let place = Axis::OF_STARTS.iter().position(|other| *other == axis).unwrap();
        all[place] = value;
    }
    State { angle: [all[0], all[1]].map(Long::wrapped), speed: [all[2], all[3]] }
}

/// The start of a pixel.
fn start_of(scene: &Scene, k: usize) -> State<Long> {
    let half = f64::from(SIDE) / 2.0;
    let [x, y] = [k as u32 % SIDE, k as u32 / SIDE].map(|at| f64::from(at) + 0.5);
    let by = [x - half, half - y].map(|by| Long::from_f64(by * WIDTH / f64::from(SIDE)));
    let center = [0, 1].map(|i| Long::parse(&scene.view.center[i]).unwrap());
    start(&scene.plane, [0, 1].map(|i| center[i] + by[i]))
}

fn outcome(scene: &Scene, start: &State<Long>, secs: f64) -> Outcome<Long> {
    let (pendulum, rule) = (scene.build.pendulum_in(), scene.question.rule);
    oracle::outcome_from(&pendulum, start, rule, Long::from_f64(secs))
}

/// Finds a place on the line between two places at which the flip time jumps.
fn jump(plane: &Plane, ends: [[f64; 2]; 2], secs: f64) -> [Long; 2] {
    let scene = Scene { plane: plane.clone(), ..Scene::default() };
    let time = |at: &[Long; 2]| match outcome(&scene, &start(plane, *at), secs) {
        Outcome { status: Status::Answered, time } => time.to_f64(),
        _ => secs,
    };
    let on_the_way = |k: u32| {
        let share = f64::from(k) / 64.0;
        [0, 1].map(|i| Long::from_f64(ends[0][i] + share * (ends[1][i] - ends[0][i])))
    };
    let row: Vec<_> = (0..=64).map(on_the_way).map(|at| (at, time(&at))).collect();
    let apart = |pair: &&[([Long; 2], f64)]| (pair[1].1 - pair[0].1).abs();
    let widest = row.windows(2).max_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap();
    let (mut a, mut b) = (widest[0], widest[1]);
    for _ in 0..64 {
        let middle = [0, 1].map(|i| (a.0[i] + b.0[i]).halved(1));
        let middle = (middle, time(&middle));
        if (middle.1 - a.1).abs() > (b.1 - middle.1).abs() { b = middle } else { a = middle }
    }
    assert!((a.1 - b.1).abs() > 0.05, "the time jumps between {a:?} and {b:?}");
    a.0
}

/// Planes, each with two places between which the flip time jumps within the first 8 s.
fn places() -> [(Plane, [[f64; 2]; 2]); 4] {
    [
        (plane("speeds", ["0.4", "-0.3", "0", "0"]), [[6.0, 4.0], [8.0, -6.0]]),
        (plane("first", ["0", "0.5", "0", "-2"]), [[0.2, 7.0], [2.0, 5.0]]),
        (Plane { energy: 10.0, ..plane("section", ["0"; 4]) }, [[-1.0, 3.0], [1.0, 6.0]]),
        (plane("theta2,omega1", ["1", "0", "0", "3"]), [[-3.0, 4.0], [3.0, 7.0]]),
    ]
}

/// Share of pixels whose flips are right within 1 ms.
fn share(samples: &Samples, truths: &[Outcome<Long>]) -> f64 {
    let is_right = |k: &usize| {
        let (given, truth) = (samples.get(*k), &truths[*k]);
        given.status == truth.status && (given.time - truth.time.to_f64()).abs() < 1e-3
    };
    (0..COUNT).filter(is_right).count() as f64 / COUNT as f64
}

#[test]
fn deep_flips_of_thrown_pendulums_are_right_on_both_sides_of_a_jump() {
    for (plane, ends) in places() {
        let scene = scene(plane.clone(), jump(&plane, ends, 8.0), 8.0);
        let starts: Vec<State<Long>> = (0..COUNT).map(|k| start_of(&scene, k)).collect();
        let truths: Vec<Outcome<Long>> =
            starts.par_iter().map(|start| outcome(&scene, start, 8.0)).collect();
        let times = truths.iter().map(|truth| truth.time.to_f64());
        let [least, most] = [f64::min, f64::max].map(|of| times.clone().reduce(of).unwrap());
        assert!(most - least > 0.05, "both sides of the jump are in view");
        for config in [BALANCED, FAST] {
            let share = share(&rendered(&scene, config, false), &truths);
            assert!(share >= 0.99, "{share} by {config:?} on {plane:?}");
        }
        assert!(share(&rendered(&scene, LESSON, false), &truths) >= 0.9);
        let checked = rendered(&scene, BALANCED, true);
        let sure = (0..COUNT).filter(|k| checked.trust(*k) != Trust::Uncertain).count();
        assert!(sure > COUNT / 2 && share(&checked, &truths) >= 0.99, "{sure} are sure");
        let mut other = scene.clone();
        other.plane.origin = ["0.4", "-0.29", "0", "0.1"].map(str::to_string);
        other.plane.energy += 0.5;
        assert!(share(&rendered(&other, BALANCED, false), &truths) < 0.8, "it can fail");
    }
}

#[test]
fn deep_states_of_thrown_pendulums_are_right() {
    let places = places();
    let (plane, _) = &places[0];
    let mut scene = scene(plane.clone(), [6.0, 4.0].map(Long::from_f64), 20.0);
    scene.question.ask = QuestionName::State;
    let samples = rendered(&scene, BALANCED, false);
    let truth = |k: usize| {
        let mut orbit = Orbit::new(scene.build.pendulum_in(), start_of(&scene, k));
        orbit.state_at(Long::from_f64(20.0)).angle.map(Scalar::to_f64)
    };
    for k in [0, 9, 44, 99] {
        let (angles, values) = (truth(k), samples.values(k));
        let is_right = |i: usize| {
            let whole = values[i] + std::f64::consts::TAU * values[4 + i];
            apart(values[i], angles[i]) < 1e-3 && (whole - angles[i]).abs() < 1e-2
        };
        assert!(is_right(0) && is_right(1), "{values:?} for {angles:?}");
    }
}

#[test]
fn a_deep_view_of_a_sections_end_is_forbidden_beyond_it() {
    let plane = Plane { energy: 10.0, ..plane("section", ["0"; 4]) };
    // p2² = 2 B (E + P + Q cos θ2), where ω1 vanishes.
    let pendulum = Scene::default().build.pendulum_in::<Long>();
    let theta2 = Long::from_f64(0.5);
    let kinetic = Long::from_f64(10.0) + pendulum.p + pendulum.q * theta2.sin_cos().1;
    let p2 = (pendulum.b * kinetic * Long::from_f64(2.0)).sqrt();
    let scene = scene(plane, [theta2, p2], 6.0);
    let samples = rendered(&scene, BALANCED, false);
    let has_solution = |k: usize| {
        let [x, y] = [k as u32 % SIDE, k as u32 / SIDE].map(|at| f64::from(at) + 0.5);
        let by = [x - 5.0, 5.0 - y].map(|by| Long::from_f64(by * WIDTH / f64::from(SIDE)));
        let kinetic = Long::from_f64(10.0) + pendulum.p + pendulum.q * (theta2 + by[0]).sin_cos().1;
        let p2 = p2 + by[1];
        pendulum.b * kinetic * Long::from_f64(2.0) > p2 * p2
    };
    let solved = (0..COUNT).filter(|k| has_solution(*k)).count();
    assert!((20..80).contains(&solved), "the end crosses the view: {solved}");
    for k in 0..COUNT {
        let forbidden = samples.get(k).status == Status::Forbidden;
        assert_eq!(forbidden, !has_solution(k), "pixel {k}");
        if !forbidden {
            let truth = outcome(&scene, &start_of(&scene, k), 6.0);
            let given = samples.get(k);
            let near = (given.time - truth.time.to_f64()).abs() < 1e-3;
            assert!(given.status == truth.status && near, "{given:?} for {truth:?}");
        }
    }
}

#[test]
fn starts_faster_than_the_lattice_reaches_are_integrated_from_their_throw() {
    let mut scene = scene(places()[0].0.clone(), [2000.0, 3.0].map(Long::from_f64), 0.01);
    scene.view.width = "1e-9".to_string();
    let share = rendered(&scene, BALANCED, false);
    let truths: Vec<Outcome<Long>> =
        (0..COUNT).map(|_| outcome(&scene, &start_of(&scene, 0), 0.01)).collect();
    let is_right = |k: usize| (share.get(k).time - truths[k].time.to_f64()).abs() < 1e-6;
    assert!((0..COUNT).all(is_right));
}
