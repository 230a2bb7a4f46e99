//! Deep zoom: cells that are followed as polynomials, compared with pendulums that are integrated
//! one by one in as many digits as they need.

mod rims;

use std::time::{Duration, Instant};

use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::depth::{DepthEngine, Following};
use flipmap_engine::level::{BALANCED, FAST};
use flipmap_engine::trust::TrustEngine;
use flipmap_engine::{
    Cells, Deep, Engine, EventSpec, IntegratorConfig, Job, Keep, Leaf, Precision, Starts, Trust,
    Wait,
};
use flipmap_numbers::{Exact, Fixed, Scalar};
use flipmap_pendulum::{Outcome, Pendulum, Rule, Status, oracle};
use flipmap_render::tiles::{Samples, Work};
use flipmap_scene::lattice::Cell;
use flipmap_scene::{Budget, ExactPlane, Grid, Kind, Scene, View};

/// Views (θ1, θ2, width) with structure, found by following filaments down.
const PLACES: [(&str, &str, &str); 4] = [
    ("1.232005751523457841", "2.083059776986079265", "6e-7"),
    ("1.232005966977461661140937", "2.083059647952103789629524", "6e-13"),
    ("1.2320059669773557237665169225", "2.0830596479518783765072544180", "6e-16"),
    ("1.2320059669773557125404006040739324", "2.0830596479518781884183696604326609", "6e-22"),
];

fn engine() -> DepthEngine<'static> {
    DepthEngine::new(Box::new(CpuEngine::new(None).unwrap()), None).unwrap()
}

fn scene(center: [&str; 2], width: &str) -> Scene {
    let view =
        View { center: center.map(str::to_string), width: width.to_string(), ..View::default() };
    let mut scene = Scene { view, ..Scene::default() };
    scene.question.budget = Budget { auto: true, ..Budget::default() };
    scene.checked().unwrap()
}

/// The samples of a picture, row by row, computed in tiles of about the given number of pixels.
fn samples(
    scene: &Scene,
    size: [u32; 2],
    config: IntegratorConfig,
    engine: &mut dyn Engine,
    tile_pixels: usize,
) -> Samples {
    all_samples(Work::new(scene, size, config, tile_pixels), size, engine)
}

fn all_samples(mut work: Work, size: [u32; 2], engine: &mut dyn Engine) -> Samples {
    let mut all = Samples::unflipped((size[0] * size[1]) as usize);
    loop {
        let finished = work.work(engine, None).unwrap();
        if finished.is_empty() {
            return all;
        }
        for part in finished {
            for (k, [x, y]) in part.tile.pixels().enumerate() {
                all.set((y * size[0] + x) as usize, part.samples.get(k));
                all.assure((y * size[0] + x) as usize, part.samples.assurance(k));
            }
        }
    }
}

/// The outcomes of single pixels, each integrated on its own in fixed-point numbers of `N` limbs.
fn truth<const N: usize>(scene: &Scene, size: [u32; 2], pixels: &[usize]) -> Vec<Outcome> {
    let center = scene.view.center_rad();
    let pixel = scene.view.width_rad().to_f64() / f64::from(size[0]);
    let pendulum: Pendulum<Fixed<N>> = scene.build.pendulum_in();
    let (rule, budget) = (scene.question.rule, Fixed::from_f64(scene.question.budget.secs));
    let one = |&index: &usize| {
        let [x, y] = [index as u32 % size[0], index as u32 / size[0]].map(f64::from);
        let [w, h] = size.map(f64::from);
        let by = [x + 0.5 - w / 2.0, h / 2.0 - y - 0.5].map(|by| Exact::from_f64(by * pixel));
        let angle = [0, 1].map(|i| (center[i] + by[i]).resized::<N>());
        let Outcome { status, time } = oracle::outcome(&pendulum, angle, rule, budget);
        Outcome { status, time: time.to_f64() }
    };
    let (a, b) = pixels.split_at(pixels.len() / 2);
    std::thread::scope(|scope| {
        let first = scope.spawn(|| a.iter().map(one).collect::<Vec<_>>());
        let second: Vec<_> = b.iter().map(one).collect();
        [first.join().unwrap(), second].concat()
    })
}

fn is_right(a: &Outcome, b: &Outcome) -> bool {
    a.status == b.status && (a.status != Status::Answered || (a.time - b.time).abs() <= 1e-3)
}

fn share_right(samples: &Samples, pixels: &[usize], truth: &[Outcome]) -> f64 {
    let right = pixels.iter().zip(truth).filter(|(k, truth)| is_right(&samples.get(**k), truth));
    right.count() as f64 / pixels.len() as f64
}

#[test]
fn deep_pixels_are_those_of_pendulums_integrated_in_long_numbers() {
    let size = [24, 24];
    let pixels: Vec<usize> = (5..576).step_by(24).collect();
    for (theta1, theta2, width) in PLACES {
        let scene = scene([theta1, theta2], width);
        let truth = truth::<4>(&scene, size, &pixels);
        let flips: Vec<f64> =
            truth.iter().filter(|o| o.status == Status::Answered).map(|o| o.time).collect();
        let spread = flips.iter().fold(0.0, |most, t| f64::max(most, (t - flips[0]).abs()));
        assert!(flips.len() > 12 && spread > 0.5, "no structure at {width}: {spread}");
        // One of the 24 pixels is a share of 0.04.
        for (config, least) in [(BALANCED, 0.95), (FAST, 0.83)] {
            let samples = samples(&scene, size, config, &mut engine(), 4096);
            let share = share_right(&samples, &pixels, &truth);
            assert!(share >= least, "{share} of {width} in {}", config.precision);
        }
        let other = scene_beside(&scene);
        let wrong = samples(&other, size, BALANCED, &mut engine(), 4096);
        assert!(share_right(&wrong, &pixels, &truth) < 0.5, "the comparison can fail");
    }
}

/// The same scene, moved to the right by a quarter of its width.
fn scene_beside(scene: &Scene) -> Scene {
    let mut other = scene.clone();
    let by = Exact::from_f64(scene.view.width_rad().to_f64() / 4.0);
    other.view.center[0] = (scene.view.center_rad()[0] + by).to_string();
    other
}

#[test]
fn no_answer_depends_on_tiles_or_on_what_else_is_asked() {
    let (theta1, theta2, width) = PLACES[1];
    let scene = scene([theta1, theta2], width);
    let whole = samples(&scene, [40, 40], BALANCED, &mut engine(), 1600);
    let mut used = engine();
    samples(&scene_beside(&scene), [40, 40], BALANCED, &mut used, 1600);
    for tile_pixels in [40, 333] {
        let cut = samples(&scene, [40, 40], BALANCED, &mut used, tile_pixels);
        assert!((0..1600).all(|k| cut.get(k) == whole.get(k)), "tiles of {tile_pixels}");
    }
}

/// A deep job of a picture's pixels.
fn deep_job(scene: &Scene, size: [u32; 2], keep: Keep) -> Job {
    let grid = Grid::new(scene, size);
    let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y]));
    let leaves = grid.grouped(BALANCED.leaf_pixels(), (0..).zip(pixels)).into_iter();
    let leaf = |(cell, points): (Cell, Vec<(u32, [f64; 2])>)| Leaf {
        cell,
        points: points.into_iter().map(|(_, point)| point).collect(),
    };
    let starts = Starts::Deep(Deep {
        leaves: leaves.map(leaf).collect(),
        plane: Box::new(ExactPlane::AT_REST),
        strict: false,
    });
    let question = EventSpec::from(scene);
    Job { id: 3, question, config: BALANCED, starts, keep }
}

/// Returns a deep job's outcomes, and the number of starts answered from their neighbours on a
/// line. A job that keeps the final states of its pendulums integrates each of them.
fn answered(scene: &Scene, size: [u32; 2], keep: Keep) -> (Vec<Outcome>, u64) {
    let mut engine = engine();
    engine.submit(deep_job(scene, size, keep)).unwrap();
    let result = engine.poll(Wait::UntilFinished).unwrap().remove(0);
    (result.outcomes, result.effort.depth.unwrap().told_by_lines)
}

#[test]
fn starts_on_lines_are_told_what_they_would_find_alone() {
    let changed = |k: usize, change: fn(&mut Scene)| {
        let mut scene = scene([PLACES[k].0, PLACES[k].1], PLACES[k].2);
        change(&mut scene);
        scene.checked().unwrap()
    };
    let centre = ["-1.4530791906636347015765625", "0.4518709860169754505796875"];
    let mut rods = scene(centre, "1e-16");
    rods.build.kind = Kind::Rods;
    let scenes = [
        changed(0, |_| {}),
        changed(1, |scene| scene.view.rotate = 31.0),
        changed(2, |scene| scene.view.stretch = 2.0),
        changed(3, |_| {}),
        changed(1, |scene| scene.question.rule = Rule::Either),
        rods,
    ];
    for (k, scene) in scenes.iter().enumerate() {
        let size = [80, 60];
        let (on_lines, told) = answered(scene, size, Keep::NOTHING);
        let (alone, none_told) = answered(scene, size, Keep::ENDS);
        assert!(told > 400 && none_told == 0, "{told} of 4800 are told in scene {k}");
        for (a, b) in on_lines.iter().zip(&alone) {
            let apart = (a.time - b.time).abs();
            assert!(a.status == b.status && apart < 5e-4, "scene {k}: {a:?}, alone {b:?}");
        }
    }
}

#[test]
fn direct_integration_cells_and_lines_agree() {
    let size = [48, 36];
    // Widths and budgets, which end before direct integration reaches its horizon.
    let views = [
        ("1e-2", 26.0),
        ("1e-3", 26.0),
        ("1e-4", 26.0),
        ("1e-5", 26.0),
        ("1e-6", 26.0),
        ("1e-8", 34.0),
        ("1e-10", 40.0),
    ];
    for (width, secs) in views {
        let mut scene = scene(["-1.6601", "0.1003"], width);
        scene.question.budget = Budget::secs(secs);
        let by = |cells: Cells, engine: DepthEngine<'static>| {
            let mut engine = engine;
            let work = Work::new(&scene, size, BALANCED, 4096).with_cells(cells);
            all_samples(work, size, &mut engine)
        };
        let directly = by(Cells::Never, engine());
        let ways = [by(Cells::Always, engine()), by(Cells::Always, engine().without_lines())];
        for (k, way) in ways.iter().enumerate() {
            let differs = |p: &usize| !is_right(&way.get(*p), &directly.get(*p));
            let differing: Vec<usize> = (0..48 * 36).filter(differs).collect();
            assert!(differing.is_empty(), "{} pixels at {width}, way {k}", differing.len());
        }
        let other = scene_beside(&scene);
        let wrong = samples(&other, size, BALANCED, &mut engine(), 4096);
        let moved = (0..48 * 36).filter(|p| wrong.get(*p) != directly.get(*p)).count();
        assert!(moved > 0, "the comparison can fail");
    }
}

#[test]
fn the_seam_between_direct_integration_and_cells_cannot_be_seen() {
    // At regular flips both methods work: in double-double from rest, and through cells.
    for width in ["3e-3", "1e-4", "1e-6", "1e-8", "1e-11"] {
        let scene = scene(["2.2", "-1.9"], width);
        let cells = samples(&scene, [16, 16], BALANCED, &mut engine(), 256);
        let direct = flipmap_engine::Method::named("taylor", Precision::Dd).unwrap();
        let direct = IntegratorConfig { method: direct, precision: Precision::Dd };
        let alone = samples(&scene, [16, 16], direct, &mut engine(), 256);
        for k in 0..256 {
            let (a, b) = (cells.get(k), alone.get(k));
            assert!((a.time - b.time).abs() < 1e-8 && a.status == b.status, "{width}: {a:?} {b:?}");
        }
    }
}

/// Finds by bisection a θ2 at which, for this θ1, flips within `secs` begin or end. Exactly one of
/// the places `between` must flip in time.
fn edge(theta1: &str, between: [&str; 2], secs: f64) -> String {
    let flips_early = |theta2: Fixed<4>| {
        let pendulum: Pendulum<Fixed<4>> = Scene::default().build.pendulum_in();
        let angle = [Fixed::<4>::parse(theta1).unwrap(), theta2];
        let budget = Fixed::from_f64(secs);
        oracle::outcome(&pendulum, angle, Rule::Second, budget).status == Status::Answered
    };
    let mut ends = between.map(|text| Fixed::<4>::parse(text).unwrap());
    let early = flips_early(ends[1]);
    assert_ne!(flips_early(ends[0]), early);
    for _ in 0..140 {
        let middle = (ends[0] + ends[1]).halved(1);
        ends[usize::from(flips_early(middle) == early)] = middle;
    }
    ends[1].resized::<8>().to_string()
}

#[test]
fn a_grazing_edge_is_one_clean_line_at_every_depth() {
    let edge = edge("-1.602", ["1.8", "2.1"], 2.0);
    for width in ["1e-5", "1e-10", "1e-16", "1e-22", "1e-30"] {
        let scene = scene(["-1.602", &edge], width);
        let size = [24, 24];
        let samples = samples(&scene, size, BALANCED, &mut engine(), 4096);
        let side = |k: usize| {
            let outcome = samples.get(k);
            outcome.status == Status::Answered && outcome.time < 2.0
        };
        for column in 0..24 {
            let changes =
                (1..24).filter(|row| side(row * 24 + column) != side((row - 1) * 24 + column));
            assert!(changes.count() <= 1, "column {column} at {width} is torn");
        }
        let early = (0..576).filter(|k| side(*k)).count();
        assert!((100..476).contains(&early), "{early} at {width}");
        let pixels: Vec<usize> = (3..576).step_by(48).collect();
        let truth = truth::<4>(&scene, size, &pixels);
        assert!(share_right(&samples, &pixels, &truth) >= 0.9, "{width}");
    }
}

/// θ1 = π, where the torus closes, in more digits than any of the views need.
const SEAM: &str = "3.14159265358979323846264338327950288419716939937510582097494459";

#[test]
fn deep_views_across_the_seam_of_the_torus_are_right() {
    let edge = edge(SEAM, ["2.0", "2.2"], 1.5);
    for width in ["1e-6", "1e-12", "1e-20"] {
        let scene = scene([SEAM, &edge], width);
        let samples = samples(&scene, [24, 24], BALANCED, &mut engine(), 4096);
        let pixels: Vec<usize> = (3..576).step_by(24).collect();
        let truth = truth::<4>(&scene, [24, 24], &pixels);
        assert!(share_right(&samples, &pixels, &truth) >= 0.95, "{width}");
        let early = |k: &usize| samples.get(*k).time < 1.5;
        let early = (0..576).filter(early).count();
        assert!((100..476).contains(&early), "{early} at {width}: the edge is in view");
    }
}

#[test]
fn threads_change_no_deep_answer() {
    let (theta1, theta2, width) = PLACES[1];
    let scene = scene([theta1, theta2], width);
    let by = |threads: usize| {
        let cpu = Box::new(CpuEngine::new(Some(threads)).unwrap());
        let mut engine = DepthEngine::new(cpu, Some(threads)).unwrap();
        samples(&scene, [40, 40], BALANCED, &mut engine, 1600)
    };
    let (one, three) = (by(1), by(3));
    assert!((0..1600).all(|k| one.get(k) == three.get(k)));
}

#[test]
fn another_budget_before_changes_no_deep_answer() {
    let (theta1, theta2, width) = PLACES[1];
    let scene = scene([theta1, theta2], width);
    let secs = scene.question.budget.secs;
    let within = |secs: f64, engine: &mut dyn Engine| {
        let mut scene = scene.clone();
        scene.question.budget = Budget::secs(secs);
        samples(&scene, [40, 40], BALANCED, engine, 1600)
    };
    for before in [secs - 5.0, secs + 15.0] {
        let mut engine_before = engine();
        within(before, &mut engine_before);
        let (later, alone) = (within(secs, &mut engine_before), within(secs, &mut engine()));
        assert!((0..1600).all(|k| later.get(k) == alone.get(k)), "{before} s, then {secs} s");
    }
}

#[test]
fn lines_are_right_where_bands_are_curved() {
    for width in ["2e-5", "2e-6"] {
        let scene = scene([PLACES[0].0, PLACES[0].1], width);
        let (on_lines, _) = answered(&scene, [60, 45], Keep::NOTHING);
        let (alone, none_told) = answered(&scene, [60, 45], Keep::ENDS);
        assert_eq!(none_told, 0);
        let differs = |(a, b): &(&Outcome, &Outcome)| !is_right(a, b);
        let differing = on_lines.iter().zip(&alone).filter(differs).count();
        assert_eq!(differing, 0, "{width}");
    }
}

#[test]
fn exact_works_at_depth() {
    let (theta1, theta2, width) = PLACES[2];
    let scene = scene([theta1, theta2], width);
    let mut engine = TrustEngine::new(Box::new(engine()), None).unwrap();
    let samples = samples(&scene, [12, 12], BALANCED, &mut engine, 4096);
    let pixels: Vec<usize> = (0..144).filter(|k| samples.trust(*k) != Trust::Uncertain).collect();
    assert!(pixels.len() >= 140, "{} are sure", pixels.len());
    let some: Vec<usize> = pixels.into_iter().step_by(9).collect();
    assert_eq!(share_right(&samples, &some, &truth::<4>(&scene, [12, 12], &some)), 1.0);
}

#[test]
fn cancelled_deep_work_stops_at_once() {
    let following = Following::default();
    let mut engine = engine().telling(following.clone());
    let mut deep = scene(["-1.6601", "0.1003"], "1e-60");
    deep.question.budget = Budget::secs(1000.0);
    engine.submit(deep_job(&deep, [24, 24], Keep::NOTHING)).unwrap();
    let begun = Instant::now();
    while following.secs().is_none_or(|[secs, _]| secs < 1.0) {
        assert!(begun.elapsed() < Duration::from_secs(60), "nothing is followed");
        std::thread::sleep(Duration::from_millis(1));
    }
    let cancelled = Instant::now();
    engine.cancel();
    // A slice that has begun runs to its end, but no further: two units of 0.32 s.
    let max_secs = following.secs().map_or(0.0, |[secs, _]| secs) + 0.7;
    while let Some([secs, _]) = following.secs() {
        assert!(secs < max_secs, "it goes on to {secs} s");
        assert!(cancelled.elapsed() < Duration::from_secs(10), "it does not stop");
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(engine.poll(Wait::UntilFinished).unwrap().is_empty());
    let (theta1, theta2, width) = PLACES[0];
    let after = scene([theta1, theta2], width);
    engine.submit(deep_job(&after, [8, 8], Keep::NOTHING)).unwrap();
    let result = engine.poll(Wait::UntilFinished).unwrap().remove(0);
    assert_eq!(result.outcomes, answered(&after, [8, 8], Keep::NOTHING).0);
}
