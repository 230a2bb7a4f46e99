//! Tiles of other questions and planes show the same as a picture of the same starts.

use flipmap_engine::IntegratorConfig;
use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::level::BALANCED;
use flipmap_numbers::{Exact, Scalar};
use flipmap_pendulum::Status;
use flipmap_render::tiles::Work;
use flipmap_render::tiles::explorer::Explorer;
use flipmap_render::tiles::view_target::{Physics, ViewTarget};
use flipmap_scene::lattice::{Cell, Region, SIDE, side_rad};
use flipmap_scene::question::QuestionName;
use flipmap_scene::{Budget, Plane, QuestionSettings, Scene, View};

use crate::common::ROOMY;

const CONFIG: IntegratorConfig = BALANCED;

fn scene(ask: QuestionName, plane: &str) -> Scene {
    let question =
        QuestionSettings { ask, budget: Budget::secs(0.6), ..QuestionSettings::default() };
    let origin = ["0.4", "2.5", "0", "-1"].map(str::to_string);
    let plane = Plane { kind: plane.parse().unwrap(), origin, energy: 3.0 };
    Scene { question, plane, ..Scene::default() }.without_unused().checked().unwrap()
}

fn target(scene: &Scene, cell: Cell) -> ViewTarget {
    let half = 0.4 * side_rad(cell.level);
    let repeats = scene.plane.is_torus();
    ViewTarget {
        physics: Physics::of(scene, CONFIG, false),
        budget_secs: scene.question.budget.secs,
        region: Region { center: cell.center(), half_rad: [half; 2], repeats },
        level: cell.level,
        pointer: None,
        refinements: 0,
    }
}

/// The cell's samples as a picture, each with its status and channels.
fn picture(scene: &Scene, cell: Cell) -> Vec<(Status, Vec<f64>)> {
    let doublings = scene.plane.lattice_doublings(&scene.build);
    let center = cell.center().map(|middle| middle.doubled(doublings).decimal(60));
    let side = Exact::pi().doubled(1 + doublings).halved(cell.level);
    let view = View { center, width: side.decimal(40), ..View::default() };
    let scene = Scene { view, ..scene.clone() };
    let mut work = Work::new(&scene, [SIDE; 2], CONFIG, 4096);
    let mut engine = CpuEngine::new(None).unwrap();
    let mut pixels = vec![(Status::Failed, Vec::new()); (SIDE * SIDE) as usize];
    while !work.is_done() {
        for done in work.work(&mut engine, None).unwrap() {
            for (k, [x, y]) in done.tile.pixels().enumerate() {
                let status = done.samples.get(k).status;
                pixels[(y * SIDE + x) as usize] = (status, done.samples.values(k).to_vec());
            }
        }
    }
    pixels
}

#[test]
fn a_tile_has_the_answers_of_a_picture_of_its_starts() {
    for (ask, plane, at) in [
        (QuestionName::State, "angles", [-1.0, 2.0]),
        (QuestionName::State, "first", [-0.2, 0.1]),
        (QuestionName::First, "speeds", [0.5, 0.4]),
        (QuestionName::Flip, "section", [0.7, 0.5]),
        (QuestionName::Growth, "second", [0.1, -0.1]),
    ] {
        let scene = scene(ask, plane);
        let cell = Cell::around(at.map(Exact::from_f64), 6);
        let mut explorer = Explorer::new(ROOMY);
        explorer.target(&target(&scene, cell));
        explorer.work(&mut CpuEngine::new(None).unwrap(), None).unwrap();
        let (known, mirrored) = explorer.known(cell).expect("it is in view");
        assert_eq!(known.samples.channels(), ask.kind().channels.len());
        let samples = std::sync::Arc::clone(&known.samples);
        let samples = if mirrored { samples.image(samples.len()) } else { (*samples).clone() };
        let mut answered = 0;
        for (place, (status, values)) in picture(&scene, cell).into_iter().enumerate() {
            assert_eq!(samples.get(place).status, status, "{ask} {plane} {place}");
            if status != Status::Answered {
                continue;
            }
            answered += 1;
            for (mine, its) in samples.values(place).iter().zip(values) {
                assert!((mine - its).abs() < 1e-6 * (1.0 + its.abs()), "{ask} {plane} {place}");
            }
        }
        assert!(answered > 1000, "{ask} {plane}: {answered}");
    }
}

#[test]
fn without_symmetry_every_cell_is_computed() {
    let cells = |ask, plane: &str| {
        let plane = Plane { kind: plane.parse().unwrap(), ..Plane::default() };
        let scene = Scene { plane, ..scene(ask, "angles") };
        let home = Cell { level: 2, ..Cell::WHOLE };
        let region = Region { half_rad: [3.0; 2], ..target(&scene, home).region };
        let region = Region { center: [Exact::ZERO; 2], ..region };
        let target = ViewTarget { region, level: 2, ..target(&scene, home) };
        let mut explorer = Explorer::new(ROOMY);
        explorer.target(&target);
        explorer.work(&mut flipmap_engine::mock::MockEngine::default(), None).unwrap();
        explorer.counts().pixels
    };
    let tile = u64::from(SIDE * SIDE);
    // Of the 16 cells of level 2, half are mirror images.
    assert_eq!(cells(QuestionName::Flip, "angles"), tile * 8);
    assert_eq!(cells(QuestionName::State, "angles"), tile * 16);
}
