//! Views for the tests, and checks of the samples in view against the mock engine's formula.

use std::time::{Duration, Instant};

use flipmap_engine::mock::MockEngine;
use flipmap_engine::{EventSpec, IntegratorConfig, Job, Method, Precision};
use flipmap_numbers::{Decimal, Exact, Scalar};
use flipmap_pendulum::{Outcome, Status};
use flipmap_render::tiles::cache::{CachedCell, TILE_BYTES};
use flipmap_render::tiles::explorer::{Explorer, MAX_CELLS};
use flipmap_render::tiles::view_target::{Physics, ViewTarget};
use flipmap_scene::lattice::{Cell, Region, SIDE, side_rad};
use flipmap_scene::{Budget, Fate, PendulumSpec, QuestionSettings, Scene};

use super::ledger::Ledger;

pub(crate) const ROOMY: usize = 4000 * TILE_BYTES;

pub(crate) fn physics(gravity: f64) -> Physics {
    let build = PendulumSpec { gravity: Decimal::from(gravity), ..PendulumSpec::default() };
    let config = IntegratorConfig { method: Method::LESSON, precision: Precision::F32 };
    Physics::of(&Scene { build, ..Scene::default() }, config, false)
}

/// A view that is two or three cells wide.
pub(crate) fn target(center: [f64; 2], level: u32) -> ViewTarget {
    let half = 0.7 * side_rad(level);
    ViewTarget {
        physics: physics(9.81),
        budget_secs: 30.0,
        region: Region {
            center: center.map(Exact::from_f64),
            half_rad: [half, 0.8 * half],
            repeats: true,
        },
        level,
        pointer: None,
        refinements: 0,
    }
}

/// A view in which most pendulums flip, some of them late.
pub(crate) fn lively(level: u32) -> ViewTarget {
    target([2.0, 1.0], level)
}

pub(crate) fn scene(target: &ViewTarget) -> Scene {
    let question = QuestionSettings {
        rule: target.physics.question.rule,
        budget: Budget::secs(target.budget_secs),
        ..QuestionSettings::default()
    };
    Scene { build: target.physics.build, question, ..Scene::default() }
}

pub(crate) fn explored(target: &ViewTarget, engine: &mut Ledger) -> Explorer {
    let mut explorer = Explorer::new(ROOMY);
    explorer.target(target);
    explorer.work(engine, None).unwrap();
    explorer
}

/// The deadline of a frame that has time for everything except waiting.
pub(crate) fn in_time() -> Option<Instant> {
    Some(Instant::now() + Duration::from_secs(60))
}

/// Works for one frame of a window; jobs are still in flight when it ends.
pub(crate) fn frame(explorer: &mut Explorer, engine: &mut Ledger) {
    explorer.work(engine, in_time()).unwrap();
}

/// The jobs that were submitted while a window drew `frames` frames.
pub(crate) fn jobs_of_frames(
    explorer: &mut Explorer,
    engine: &mut Ledger,
    frames: usize,
) -> Vec<Job> {
    let sent = engine.jobs.len();
    (0..frames).for_each(|_| frame(explorer, engine));
    engine.jobs[sent..].to_vec()
}

/// The canonical cells that were computed from rest, in the order in which they were started.
pub(crate) fn cells_of(jobs: &[Job], levels: &[u32]) -> Vec<Cell> {
    jobs.iter()
        .filter_map(Ledger::first_start)
        .map(|angle| cell_of(angle.map(Exact::from_dd), levels))
        .collect()
}

pub(crate) fn in_view(target: &ViewTarget) -> Vec<Cell> {
    cells(target, target.level)
}

/// The cells of a level in view.
pub(crate) fn cells(target: &ViewTarget, level: u32) -> Vec<Cell> {
    target.region.cells(level, MAX_CELLS).into_iter().map(|placed| placed.cell).collect()
}

/// The outcome as a window with this budget shows it.
pub(crate) fn shown(outcome: Outcome, budget_secs: f64) -> Outcome {
    if outcome.status == Status::Answered && outcome.time > budget_secs {
        return Outcome::without_time(Status::Unflipped);
    }
    outcome
}

/// Compares a cell's samples with the mock engine's formula. Returns the number of samples that
/// differ, or `None` if the cell is not known.
pub(crate) fn wrong(explorer: &mut Explorer, target: &ViewTarget, cell: Cell) -> Option<usize> {
    let drawn = drawn(explorer.known(cell)?, target);
    Some(drawn.into_iter().zip(truth(target, cell)).filter(|(drawn, truth)| drawn != truth).count())
}

/// The outcomes of a cell that a window draws, in the order of its own samples.
pub(crate) fn drawn((known, mirrored): (&CachedCell, bool), target: &ViewTarget) -> Vec<Outcome> {
    let mut samples: Vec<Outcome> =
        known.samples.iter().map(|outcome| shown(outcome, target.budget_secs)).collect();
    if mirrored {
        samples.reverse();
    }
    samples
}

/// The outcomes of a cell's samples by the mock engine's formula.
pub(crate) fn truth(target: &ViewTarget, cell: Cell) -> Vec<Outcome> {
    let (scene, question) = (scene(target), EventSpec::from(&scene(target)));
    let grid = cell.grid(&scene, SIDE);
    let outcome = |place: u32| match grid.fate(place % SIDE, place / SIDE) {
        Fate::Known(outcome) => outcome,
        Fate::Thrown(_) | Fate::BesideTop(_) => unreachable!("at rest, far from the top"),
        Fate::Open(angle) => MockEngine::answer(&question, angle),
    };
    (0..SIDE * SIDE).map(outcome).collect()
}

/// Finds the cell of a job's first start, among the given levels.
pub(crate) fn cell_of(angle: [Exact; 2], levels: &[u32]) -> Cell {
    let fits = |level: &&u32| {
        let cell = Cell::around(angle, **level);
        let [column, row] = cell.sample_at(angle);
        cell.grid(&Scene::default(), SIDE).angle_from_pixel(column, row) == angle.map(Exact::to_dd)
    };
    let level = levels.iter().find(fits).expect("a sample of one of the levels");
    Cell::around(angle, *level)
}

#[test]
fn the_comparison_can_fail() {
    let mut engine = Ledger::default();
    let mut explorer = explored(&lively(5), &mut engine);
    let cell = in_view(&lively(5))[0];
    assert_eq!(wrong(&mut explorer, &lively(5), cell), Some(0));
    let other = ViewTarget { physics: physics(5.0), ..lively(5) };
    assert!(wrong(&mut explorer, &other, cell).is_some_and(|wrong| wrong > 1000));
    let larger = ViewTarget { budget_secs: 60.0, ..lively(5) };
    let late = in_view(&larger).into_iter().filter_map(|c| wrong(&mut explorer, &larger, c));
    assert!(late.sum::<usize>() > 1000);
}
