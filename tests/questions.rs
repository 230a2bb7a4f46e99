//! Questions other than the flip, and planes other than the angles at rest, judged by the gold
//! standard.

mod common;

use std::f64::consts::{PI, TAU};

use common::*;
use flipmap::engine::cpu::CpuEngine;
use flipmap::engine::level::{BALANCED, FAST};
use flipmap::engine::{Engine, IntegratorConfig, Method, Precision};
use flipmap::physics::oracle::{flip_within, passages};
use flipmap::physics::taylor::Orbit;
use flipmap::physics::{Angle, Dd, Decimal, Launch, Outcome, Pendulum, Scalar, State, Status};
use flipmap::question::Ask;
use flipmap::scene::{Budget, Fate, Grid, Plane, PlaneKind, QuestionTable, Scene, View};
use flipmap::tiles::moments::Moments;
use flipmap::tiles::{Renderer, Samples};
use rayon::prelude::*;

fn scene(ask: Ask, plane: Plane, width: &str, secs: f64) -> Scene {
    let question = QuestionTable { ask, budget: Budget::secs(secs), ..QuestionTable::default() };
    let view = View { width: width.to_string(), ..View::default() };
    Scene { question, plane, view, ..Scene::default() }.checked().unwrap()
}

fn plane(kind: &str, origin: [&str; 4]) -> Plane {
    let kind: PlaneKind = kind.parse().unwrap();
    Plane { kind, origin: origin.map(str::to_string), ..Plane::default() }
}

fn rendered(
    scene: &Scene,
    side: u32,
    config: IntegratorConfig,
    engine: Box<dyn Engine>,
) -> Samples {
    let mut renderer = Renderer::of(engine, config, false, Some(2)).unwrap();
    renderer.render(scene, [side; 2]).unwrap()
}

fn by_cpu(scene: &Scene, side: u32, config: IntegratorConfig) -> Samples {
    rendered(scene, side, config, Box::new(CpuEngine::new(Some(2)).unwrap()))
}

/// The start of a pixel with its speeds; none if it is forbidden.
fn start(scene: &Scene, side: u32, k: u32) -> Option<State<Dd>> {
    match Grid::new(scene, [side; 2]).fate(k % side, k / side) {
        Fate::Known(_) => None,
        Fate::Open(angle) => Some(State::rest(angle)),
        Fate::Thrown(Launch { angle, speed }) => Some(State { angle, speed }),
    }
}

/// The state after `secs`, with unwrapped angles, by the gold standard.
fn true_state(scene: &Scene, start: State<Dd>, secs: f64) -> State<f64> {
    let state = Orbit::new(scene.build.pendulum_in::<Dd>(), start).state_at(Dd::new(secs));
    State { angle: state.angle.map(Dd::to_f64), speed: state.speed.map(Dd::to_f64) }
}

/// The flip of a thrown pendulum by the gold standard.
fn true_flip(scene: &Scene, start: State<Dd>) -> Outcome {
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
fn apart(a: f64, b: f64) -> f64 {
    let by = (a - b).abs() % TAU;
    by.min(TAU - by)
}

/// Share of a scene's pixels whose state is right within `most` rad, with right turns and speeds
/// within ten times that.
fn share_of_right_states(scene: &Scene, side: u32, samples: &Samples, most: f64) -> f64 {
    let is_right = |k: u32| {
        let truth = true_state(scene, start(scene, side, k)?, scene.question.end_secs());
        let values = samples.values(k as usize);
        let turns = truth.angle.map(|angle| ((angle - PI) / TAU).ceil());
        // At ±π itself a turn may be counted to either side.
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

#[test]
fn states_after_12_s_are_the_gold_standards() {
    let scene = scene(Ask::State, Plane::default(), "6.283185307179586", 12.0);
    let samples = by_cpu(&scene, 24, BALANCED);
    assert_eq!(samples.channels(), 6);
    let share = share_of_right_states(&scene, 24, &samples, 1e-3);
    assert!(share >= 0.99, "{share}");
    let fast = share_of_right_states(&scene, 24, &by_cpu(&scene, 24, FAST), 1e-3);
    assert!(fast < share, "the test can fail: {fast}");
}

#[test]
fn a_state_lies_at_its_time_and_not_at_the_end_of_the_budget() {
    let mut scene = scene(Ask::State, plane("speeds", ["0.4", "-2", "0", "0"]), "14", 30.0);
    scene.question.at = Some(2.5);
    let samples = by_cpu(&scene, 12, BALANCED);
    assert_eq!(share_of_right_states(&scene, 12, &samples, 1e-7), 1.0);
    let mut later = scene.clone();
    later.question.at = Some(2.6);
    assert!(share_of_right_states(&later, 12, &samples, 1e-7) < 0.1, "the test can fail");
}

#[test]
fn normal_modes_swing_as_they_must() {
    // ω² = (g/l)(2 ± √2), with θ2 = ∓√2 θ1; errors of the linear theory are of third order.
    for sign in [-1.0, 1.0] {
        let amplitude = 1e-4;
        let mut scene = scene(Ask::State, Plane::default(), "1e-12", 3.0);
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

/// Share of a scene's open pixels whose flip is right within 1 ms.
fn share_of_right_flips(scene: &Scene, side: u32, samples: &Samples) -> f64 {
    let is_right = |k: u32| {
        let (truth, found) = (true_flip(scene, start(scene, side, k)?), samples.get(k as usize));
        Some(truth.status == found.status && (truth.time - found.time).abs() < 1e-3)
    };
    let right: Vec<bool> = (0..side * side).into_par_iter().filter_map(is_right).collect();
    assert!(right.len() as u32 > side * side / 4, "{}", right.len());
    right.iter().filter(|right| **right).count() as f64 / right.len() as f64
}

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
            let mut scene = scene(Ask::Flip, plane.clone(), width, 8.0);
            scene.build.friction = friction.map(Decimal::from);
            let share = share_of_right_flips(&scene, 14, &by_cpu(&scene, 14, BALANCED));
            assert!(share >= 0.99, "{:?} {friction:?}: {share}", scene.plane);
        }
    }
}

#[test]
fn checked_pixels_of_other_questions_and_planes_are_sure_or_marked() {
    let mut swung = scene(Ask::Flip, plane("speeds", ["0", "0", "0", "0"]), "24", 20.0);
    swung.view.center = ["1".into(), "2".into()];
    let state = scene(Ask::State, Plane::default(), "6.283185307179586", 20.0);
    for scene in [swung, state] {
        let engine = Box::new(CpuEngine::new(Some(2)).unwrap());
        let mut renderer = Renderer::of(engine, BALANCED, true, Some(2)).unwrap();
        let samples = renderer.render(&scene, [12; 2]).unwrap();
        let counts = renderer.counts();
        assert!(counts.uncertain() < 8, "{}", counts.uncertain());
        for k in 0..144 {
            let Some(start) = start(&scene, 12, k) else { continue };
            if samples.trust(k as usize) == flipmap::engine::Trust::Uncertain {
                continue;
            }
            if scene.question.ask == Ask::State {
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
    let scene = scene(Ask::First, Plane::default(), "6.283185307179586", 10.0);
    let samples = by_cpu(&scene, 30, BALANCED);
    let flips = |rule| {
        let question = QuestionTable { ask: Ask::Flip, rule, ..scene.question };
        by_cpu(&Scene { question, ..scene.clone() }, 30, BALANCED)
    };
    let [first, second] =
        [flipmap::physics::Rule::First, flipmap::physics::Rule::Second].map(flips);
    let secs = |samples: &Samples, k| match samples.get(k) {
        Outcome { status: Status::Flipped, time } => time,
        _ => f64::INFINITY,
    };
    let mut seen = [0; 2];
    for k in (0..900).filter(|k| samples.get(*k).status == Status::Flipped) {
        let [bob, time] = [samples.values(k)[0], samples.values(k)[1]];
        let [one, two] = [secs(&first, k), secs(&second, k)];
        assert_eq!(bob, if one < two { 1.0 } else { 2.0 }, "{k}: {one} {two}");
        assert!((time - one.min(two)).abs() < 1e-3, "{k}");
        seen[bob as usize - 1] += 1;
    }
    assert!(seen.iter().all(|count| *count > 20), "{seen:?}");
}

#[test]
#[cfg_attr(no_gpu, ignore = "FLIPMAP_NO_GPU=1 declares that there is no adapter")]
fn the_card_answers_as_the_processor_does() {
    let state = scene(Ask::State, Plane::default(), "6.283185307179586", 4.0);
    let swung = scene(Ask::State, plane("speeds", ["1", "-1", "0", "0"]), "12", 4.0);
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

fn scene_of_flips() -> Scene {
    scene(Ask::Flip, plane("second", ["-2", "0", "4", "0"]), "9", 8.0)
}

/// The growth of the largest of all nudges by the gold standard: central differences of orbits in
/// double-double.
fn true_exponent(scene: &Scene, start: State<Dd>, secs: f64) -> f64 {
    const NUDGE: f64 = 1e-11;
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
    // The largest singular value by power iteration on the map after its transpose.
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

#[test]
fn growth_is_the_gold_standards_by_every_method() {
    let scene = scene(Ask::Growth, plane("speeds", ["2", "-1", "0", "0"]), "8", 8.0);
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
    assert!(share_within(lesson(Precision::F64), 0.01) >= 0.95);
    assert!(share_within(BALANCED, 1e-14) < 0.5, "the test can fail");
}

/// A step of the Poincaré map: from a start on the section θ1 = 0 to the next passage of θ1 = 0 with
/// dθ1/dt > 0, as its duration in units of time with θ2, and p2 there.
fn returned(pendulum: &Pendulum<Dd>, start: State<Dd>) -> [Dd; 3] {
    let mut orbit = Orbit::new(*pendulum, start);
    let mut left = false;
    loop {
        let step = orbit.step();
        let [from, to] = [Dd::new(0.0), step.end() - step.start].map(|tau| step.state(tau));
        left |= to.angle[0].abs().hi > 1e-3;
        if !(left && from.angle[0].hi < 0.0 && to.angle[0].hi >= 0.0) {
            continue;
        }
        // Newton's method, which the direction of the passage makes converge.
        let mut tau = step.end() - step.start;
        for _ in 0..60 {
            let state = step.state(tau);
            tau = tau - state.angle[0] / state.speed[0];
        }
        let State { angle, speed } = step.state(tau);
        let cos = (angle[0] - angle[1]).sin_cos().1;
        let p2 = pendulum.b * speed[1] + pendulum.c * cos * speed[0];
        return [step.start + tau, angle[1], p2];
    }
}

#[test]
fn periodic_orbits_of_a_computer_assisted_proof_are_found_on_the_section() {
    // ChaseHendrick/double-pendulum (2026, not peer reviewed), with m = l = g = 1 and the energy
    // less by 0: H = -2 cos θ1 - cos θ2 + kinetic.
    let orbits = [
        (-0.5, "-1.2448609709185", [3.7047745436, 3.7047745487], [-3.23158, -3.23150]),
        (0.0, "-1.46237309248", [2.9534890074, 2.9534890134], [-3.80869, -3.80863]),
        (0.5, "-1.627044959203", [2.5643622220, 2.5643622277], [-3.33283, -3.33277]),
    ];
    let build = flipmap::scene::Build::new(flipmap::scene::Kind::Points, [1.0; 2], [1.0; 2], 1.0);
    let pendulum = build.pendulum_in::<Dd>();
    for (energy, p2, time, trace) in orbits {
        let section = Plane { kind: PlaneKind::Section, energy, ..Plane::default() };
        let p2 = Dd::parse(p2).unwrap();
        let from = |theta2: f64, by: f64| {
            let launch = section.launch(&pendulum, [Dd::new(theta2), p2 + Dd::new(by)]).unwrap();
            returned(&pendulum, State { angle: launch.angle, speed: launch.speed })
        };
        let [secs, theta2, after] = from(0.0, 0.0);
        assert!(time[0] - 1e-10 < secs.hi && secs.hi < time[1] + 1e-10, "{energy}: {secs}");
        assert!((theta2 + Dd::TAU).abs().hi < 1e-9 && (after - p2).abs().hi < 1e-9, "{energy}");
        let by = 1e-8;
        let [ahead, behind] = [from(by, 0.0), from(-by, 0.0)];
        let [above, below] = [from(0.0, by), from(0.0, -by)];
        let found = ((ahead[1] - behind[1]) + (above[2] - below[2])).hi / (2.0 * by);
        assert!(trace[0] - 1e-5 < found && found < trace[1] + 1e-5, "{energy}: {found}");
        let multiplier = (found.abs() + (found * found - 4.0).sqrt()) / 2.0;
        println!("{energy}: {secs} s, trace {found}, exponent {}", multiplier.ln() / secs.hi);
    }
}

/// All passes of the top by both bobs up to the end of the budget by the gold standard, in order: the
/// time in s, the bob, and true if it is anticlockwise.
fn true_passes(scene: &Scene, start: State<Dd>) -> Vec<(f64, usize, bool)> {
    let budget = scene.question.end_secs();
    let mut orbit = Orbit::new(scene.build.pendulum_in::<Dd>(), start);
    let mut passes = Vec::new();
    while orbit.time().hi <= budget {
        let step = orbit.step();
        for bob in 0..2 {
            for tau in passages(&step.angle[bob], step.length) {
                let speed = step.state(tau).speed[bob];
                passes.push(((step.start + tau).hi, bob, speed.hi > 0.0));
            }
        }
    }
    passes.retain(|(secs, ..)| *secs <= budget);
    passes.sort_by(|a, b| a.0.total_cmp(&b.0));
    passes
}

const ALL_METHODS: [IntegratorConfig; 5] = [
    BALANCED,
    IntegratorConfig { method: Method::Dopri5 { tolerance: 1e-10 }, precision: Precision::F64 },
    IntegratorConfig { method: Method::Taylor { tolerance: 1e-15 }, precision: Precision::F64 },
    IntegratorConfig { method: Method::Rk4 { step_secs: 1.0 / 2000.0 }, precision: Precision::F64 },
    FAST,
];

#[test]
fn every_flip_is_counted_by_every_method() {
    let scene = scene(Ask::Flips, plane("speeds", ["2.5", "-1", "0", "0"]), "24", 6.0);
    let side = 12;
    let truth: Vec<[f64; 4]> = (0..side * side)
        .into_par_iter()
        .map(|k| {
            let mut counts = [0.0; 4];
            for (_, bob, left) in true_passes(&scene, start(&scene, side, k).unwrap()) {
                counts[2 * bob + usize::from(!left)] += 1.0;
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
    let mut scene = scene(Ask::Flip, Plane::default(), "6.283185307179586", 8.0);
    scene.question.count = 3;
    let side = 20;
    let truth: Vec<Option<f64>> = (0..side * side)
        .into_par_iter()
        .map(|k| {
            let passes = true_passes(&scene, start(&scene, side, k)?);
            passes.iter().filter(|(_, bob, _)| *bob == 1).map(|(secs, ..)| *secs).nth(2)
        })
        .collect();
    let seen = truth.iter().flatten().count();
    assert!(seen > 40, "{seen}");
    for config in ALL_METHODS {
        let samples = by_cpu(&scene, side, config);
        let is_right = |k: &usize| match (truth[*k], samples.get(*k)) {
            (Some(truth), Outcome { status: Status::Flipped, time }) => (truth - time).abs() < 1e-3,
            (None, Outcome { status, .. }) => status != Status::Flipped,
            _ => false,
        };
        let right = (0..truth.len()).filter(is_right).count();
        assert!(right * 100 >= truth.len() * 97, "{config:?}: {right} of {}", truth.len());
    }
}

#[test]
fn friction_slows_every_method_alike() {
    let mut scene = scene(Ask::State, plane("speeds", ["2.5", "-1", "0", "0"]), "20", 6.0);
    scene.build.friction = [0.2, 0.1].map(Decimal::from);
    for config in ALL_METHODS {
        let share = share_of_right_states(&scene, 10, &by_cpu(&scene, 10, config), 1e-3);
        assert!(share >= 0.98, "{config:?}: {share}");
    }
    let samples = by_cpu(&scene, 10, BALANCED);
    scene.build.friction = [0.2, 0.11].map(Decimal::from);
    assert!(share_of_right_states(&scene, 10, &samples, 1e-3) < 0.1, "the test can fail");
}

#[test]
fn what_friction_takes_is_what_energy_loses() {
    let friction = [0.2, 0.1].map(Decimal::from);
    let pendulum = flipmap::scene::Build { friction, ..Default::default() }.pendulum();
    let [b1, b2] = pendulum.friction.unwrap();
    let begin = State { angle: [2.5, -1.0], speed: [3.0, 8.0] };
    let mut orbit = Orbit::new(pendulum, begin);
    // Five points of Gauss and Legendre in each step of the expansion.
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

#[test]
fn a_film_of_states_passes_through_the_states_of_stills() {
    for plane in [Plane::default(), plane("speeds", ["2", "-1", "0", "0"])] {
        let mut scene = scene(Ask::State, plane, "6.2", 30.0);
        let mut engine = CpuEngine::new(Some(2)).unwrap();
        let mut moments = Moments::new(&scene, [15, 11], BALANCED, 40);
        for at in [0.0, 0.3, 2.5, 2.5, 4.0] {
            let samples = moments.at(&mut engine, at, &|| true).unwrap().unwrap().clone();
            scene.question.at = Some(at);
            let mut renderer =
                Renderer::of(Box::new(CpuEngine::new(Some(2)).unwrap()), BALANCED, false, Some(2))
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
