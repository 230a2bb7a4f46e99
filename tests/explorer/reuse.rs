//! Known samples are not computed again: places seen before, other budgets, mirror images, and
//! turns around the torus. Until new samples are known, the previous ones are shown.

use std::collections::HashSet;

use flipmap_engine::Keep;
use flipmap_engine::mock::MockEngine;
use flipmap_numbers::Exact;
use flipmap_pendulum::{Outcome, Status};
use flipmap_render::tiles::cache::TILE_BYTES;
use flipmap_render::tiles::explorer::{Explorer, MAX_CELLS};
use flipmap_render::tiles::view_target::{Physics, ViewTarget};
use flipmap_scene::lattice::{Cell, Region, side_rad};

use super::common::*;
use super::ledger::Ledger;

#[test]
fn a_view_seen_before_is_not_computed_again() {
    let mut engine = Ledger::default();
    let mut explorer = explored(&lively(6), &mut engine);
    let side = side_rad(6);
    let path: Vec<ViewTarget> = (1..6)
        .map(|step| target([2.0 + 0.9 * side * f64::from(step), 1.0], 6))
        .chain((1..4).map(|zoom| target([2.0, 1.0], 6 + zoom)))
        .chain((1..4).map(|zoom| target([2.0, 1.0], 6 - zoom)))
        .collect();
    for target in &path {
        explorer.target(target);
        explorer.work(&mut engine, None).unwrap();
    }
    let (simulated, jobs) = (explorer.counts().simulated, engine.jobs.len());
    assert!(simulated > 0);
    for target in path.iter().rev() {
        explorer.target(target);
        let progress = explorer.progress();
        assert!(progress.idle && progress.done == progress.wanted, "at once: {progress:?}");
        explorer.work(&mut engine, None).unwrap();
    }
    assert_eq!((explorer.counts().simulated, engine.jobs.len()), (simulated, jobs));
}

#[test]
fn another_view_begins_another_picture_and_a_moving_pointer_does_not() {
    let (told, events) = std::sync::mpsc::channel();
    let mut engine = MockEngine { told: Some(told), ..MockEngine::default() };
    let mut explorer = Explorer::new(ROOMY);
    let mut pictures = |target: &ViewTarget| {
        explorer.target(target);
        explorer.work(&mut engine, None).unwrap();
        let events: Vec<String> = events.try_iter().collect();
        let begins = events.iter().position(|event| event == "picture");
        assert!(begins.is_none_or(|place| place == 0), "before its first job: {events:?}");
        events.iter().filter(|event| *event == "picture").count()
    };
    let view = lively(5);
    assert_eq!(pictures(&view), 1);
    let pointed = ViewTarget { pointer: Some([0.01, 0.0]), refinements: 2, ..view.clone() };
    assert_eq!(pictures(&pointed), 0);
    assert_eq!(pictures(&ViewTarget { physics: physics(3.71), ..view.clone() }), 1);
    assert_eq!(pictures(&ViewTarget { budget_secs: 60.0, ..view }), 1);
}

/// Counts the unflipped samples in the known cells of the view and the ring around it, at the level
/// of the view.
fn unflipped(explorer: &mut Explorer, target: &ViewTarget) -> usize {
    let cells = target.region.scaled(3.0).cells(target.level, MAX_CELLS);
    let cells: HashSet<Cell> = cells.into_iter().map(|placed| placed.cell.canonical().0).collect();
    let known = cells.into_iter().filter_map(|cell| Some(explorer.known(cell)?.0.samples.clone()));
    let unflipped = |outcome: &Outcome| outcome.status == Status::Unflipped;
    known.map(|samples| samples.iter().filter(unflipped).count()).sum()
}

#[test]
fn a_larger_budget_continues_what_did_not_flip() {
    for verified in [false, true] {
        let physics = Physics { verified, ..physics(9.81) };
        let small = ViewTarget { physics, region: lively(5).region.scaled(2.0), ..lively(5) };
        let mut engine = Ledger::default();
        let mut explorer = explored(&small, &mut engine);
        assert!(engine.jobs.iter().all(|job| (job.keep == Keep::STATES) != verified));
        let left = unflipped(&mut explorer, &small);
        assert!(left > 10_000, "{left}");
        let (simulated, sent) = (explorer.counts().simulated, engine.sent);
        let large = ViewTarget { budget_secs: 50.0, ..small };
        explorer.target(&large);
        explorer.work(&mut engine, None).unwrap();
        assert_eq!(explorer.counts().simulated - simulated, left as u64);
        // A check begins at the release, so checked pendulums start again from rest.
        let [rest, continued] = if verified { [left, 0] } else { [0, left] };
        assert_eq!(engine.sent, [sent[0] + rest, sent[1] + continued]);
        assert!(unflipped(&mut explorer, &large) < left, "some flip before 50 s");
        assert!(
            in_view(&large).into_iter().all(|cell| wrong(&mut explorer, &large, cell) == Some(0))
        );
    }
}

#[test]
fn a_cell_is_right_where_only_some_passes_had_room_for_states() {
    let mut engine =
        Ledger::over(MockEngine { backwards: false, job_size: 64, ..MockEngine::default() });
    let small = lively(3);
    let mut began_anew = 0;
    for room in 7..30 {
        let mut explorer = Explorer::new(room * TILE_BYTES);
        explorer.target(&small);
        explorer.work(&mut engine, None).unwrap();
        let large = ViewTarget { budget_secs: 45.0, ..small.clone() };
        let [rest, _] = engine.sent;
        explorer.target(&large);
        explorer.work(&mut engine, None).unwrap();
        began_anew += engine.sent[0] - rest;
        for cell in in_view(&large) {
            assert_eq!(wrong(&mut explorer, &large, cell), Some(0), "{room} {cell:?}");
        }
    }
    assert!(began_anew > 10_000, "some states were dropped");
}

#[test]
fn a_smaller_budget_computes_nothing() {
    let large = ViewTarget { budget_secs: 50.0, ..lively(5) };
    let mut engine = Ledger::default();
    let mut explorer = explored(&large, &mut engine);
    let simulated = explorer.counts().simulated;
    for budget_secs in [30.0, 10.5, 45.0] {
        let target = ViewTarget { budget_secs, ..large.clone() };
        explorer.target(&target);
        assert!(explorer.progress().idle);
        explorer.work(&mut engine, None).unwrap();
        assert_eq!(explorer.counts().simulated, simulated, "{budget_secs} s");
        assert!(
            in_view(&target).into_iter().all(|cell| wrong(&mut explorer, &target, cell) == Some(0))
        );
    }
}

#[test]
fn a_budget_raised_in_flight_waits_for_what_flies() {
    let mut engine = Ledger::default();
    let mut explorer = Explorer::new(ROOMY);
    explorer.target(&lively(5));
    for budget_secs in [41.0, 43.0, 45.0] {
        frame(&mut explorer, &mut engine);
        explorer.target(&ViewTarget { budget_secs, ..lively(5) });
    }
    explorer.work(&mut engine, None).unwrap();
    assert_eq!((engine.cancels, engine.again, engine.doubled), (0, 0, 0));
    let target = ViewTarget { budget_secs: 45.0, ..lively(5) };
    assert!(
        in_view(&target).into_iter().all(|cell| wrong(&mut explorer, &target, cell) == Some(0))
    );
}

#[test]
fn mirror_images_are_computed_once() {
    let mut engine = Ledger::default();
    let mut explorer = explored(&lively(6), &mut engine);
    let simulated = explorer.counts().simulated;
    let image = target([-2.0, -1.0], 6);
    explorer.target(&image);
    explorer.work(&mut engine, None).unwrap();
    assert_eq!(explorer.counts().simulated, simulated);
    assert!(in_view(&image).into_iter().all(|cell| wrong(&mut explorer, &image, cell) == Some(0)));
    // A view that contains the images of its own cells: half of the cells suffice.
    let middle =
        ViewTarget { region: Region { half_rad: [2.5; 2], ..image.region }, ..target([0.0; 2], 4) };
    let middle =
        ViewTarget { region: Region { center: [Exact::ZERO; 2], ..middle.region }, ..middle };
    let mut engine = Ledger::default();
    explored(&middle, &mut engine);
    let cells: HashSet<Cell> = cells_of(&engine.jobs, &[1, 4]).into_iter().collect();
    let distinct: HashSet<Cell> = cells.iter().map(|cell| cell.canonical().0).collect();
    assert_eq!(distinct.len(), cells.len(), "a cell and its image");
}

#[test]
fn the_plane_wraps_around() {
    let pi = std::f64::consts::PI;
    let mut engine = Ledger::default();
    let east = target([pi, -2.9], 4);
    let mut explorer = explored(&east, &mut engine);
    let sides: HashSet<bool> = in_view(&east).iter().map(|cell| cell.x.to_f64() < 0.5).collect();
    assert_eq!(sides.len(), 2, "cells from both ends");
    assert!(in_view(&east).into_iter().all(|cell| wrong(&mut explorer, &east, cell) == Some(0)));
    let simulated = explorer.counts().simulated;
    for west in [target([-pi, -2.9], 4), target([pi, 2.0 * pi - 2.9], 4)] {
        explorer.target(&west);
        explorer.work(&mut engine, None).unwrap();
        assert_eq!(explorer.counts().simulated, simulated, "{:?}", west.region.center);
    }
}

#[test]
fn several_turns_in_view_are_computed_once() {
    let mut target = target([0.4, 0.2], 2);
    target.region.half_rad = [10.0, 8.0];
    let mut engine = Ledger::default();
    let mut explorer = explored(&target, &mut engine);
    let placed = target.region.cells(2, MAX_CELLS).len();
    assert!(placed > 60, "{placed}");
    // 16 cells of level 2, none of them entirely forbidden, and one cell of level 0.
    let cells: HashSet<Cell> = cells_of(&engine.jobs, &[0, 2]).into_iter().collect();
    assert_eq!(cells.len(), 8 + 1);
    assert_eq!((engine.again, engine.doubled), (0, 0));
    assert!(
        in_view(&target).into_iter().all(|cell| wrong(&mut explorer, &target, cell) == Some(0))
    );
}

#[test]
fn a_changed_pendulum_shows_the_one_before_until_it_is_known() {
    let mut engine = Ledger::default();
    let home = lively(5);
    let mut explorer = explored(&home, &mut engine);
    let cells = in_view(&home);
    let before = |explorer: &mut Explorer, cell: &Cell| {
        explorer.known_before(*cell).map(|(known, _)| known.serial)
    };
    assert!(cells.iter().all(|cell| before(&mut explorer, cell).is_none()));
    let of_home: Vec<u64> =
        cells.iter().map(|cell| explorer.known(*cell).expect("computed").0.serial).collect();
    // A slider passes through several values, for which few or no samples become known.
    for gravity in [9.0, 8.0, 7.0, 6.0] {
        explorer.target(&ViewTarget { physics: physics(gravity), ..home });
        for (cell, serial) in cells.iter().zip(&of_home) {
            assert!(explorer.known(*cell).is_none());
            assert_eq!(before(&mut explorer, cell), Some(*serial));
        }
    }
    explorer.work(&mut engine, None).unwrap();
    assert!(cells.iter().all(|cell| explorer.known(*cell).is_some()));
    let simulated = explorer.counts().simulated;
    explorer.target(&home);
    let progress = explorer.progress();
    assert!(progress.idle && progress.done == progress.wanted, "{progress:?}");
    assert_eq!(explorer.counts().simulated, simulated);
    assert!(cells.iter().all(|cell| before(&mut explorer, cell).is_some()), "of the last slider");
}

#[test]
fn what_is_in_view_stays_where_there_is_no_room_for_more() {
    // No pendulum here has a saved state, so all tiles have the same size.
    let path = (0..6).map(|step| target([2.0 + 0.5 * side_rad(8) * f64::from(step), 0.5], 8));
    let mut engine = Ledger::default();
    let most = path.clone().map(|target| explored(&target, &mut engine).bytes()).max();
    let mut explorer = Explorer::new(most.expect("several views"));
    for target in path {
        explorer.target(&target);
        explorer.work(&mut engine, None).unwrap();
        let progress = explorer.progress();
        assert_eq!(progress.done, progress.wanted, "half of it was computed before");
        assert!(explorer.bytes() <= most.expect("several views"));
        explorer.target(&ViewTarget { pointer: Some([0.0; 2]), ..target });
        assert!(explorer.progress().idle, "nothing that this view wants has gone");
    }
}

#[test]
fn a_refused_job_is_computed_once_the_engine_takes_it() {
    let mut engine = Ledger::default();
    let mut explorer = Explorer::new(ROOMY);
    explorer.target(&lively(6));
    for refused in [0, 5, 9] {
        engine.mock.fail_at = Some(refused);
        assert!(explorer.work(&mut engine, None).is_err());
    }
    engine.mock.fail_at = None;
    explorer.work(&mut engine, None).unwrap();
    let target = lively(6);
    assert!(
        in_view(&target).into_iter().all(|cell| wrong(&mut explorer, &target, cell) == Some(0))
    );
    assert_eq!((engine.again, engine.doubled), (0, 0));
}

#[test]
fn a_pendulum_that_changes_all_the_time_is_seen_to_change() {
    let mut engine = Ledger::slow();
    let home = lively(9);
    let mut explorer = explored(&home, &mut engine);
    let mut drawn = Vec::new();
    // A slider that moves before the coarse map of any value is complete.
    for k in 1..=200 {
        let gravity = 9.81 - 0.01 * f64::from(k);
        explorer.target(&ViewTarget { physics: physics(gravity), ..home.clone() });
        frame(&mut explorer, &mut engine);
        let now = explorer.drawn().expect("a map").build.gravity;
        if drawn.last() != Some(&now) {
            drawn.push(now);
        }
    }
    assert!((5..150).contains(&drawn.len()), "{} maps of 200 values", drawn.len());
    explorer.work(&mut engine, None).unwrap();
    let last = ViewTarget { physics: physics(9.81 - 0.01 * 200.0), ..home };
    assert!(!explorer.is_behind() && explorer.drawn() == Some(&last.physics));
    for cell in in_view(&last) {
        assert_eq!(wrong(&mut explorer, &last, cell), Some(0), "the last value is complete");
    }
}

#[test]
fn another_place_or_question_does_not_wait_for_a_pendulum() {
    let mut engine = Ledger::slow();
    let home = lively(9);
    let mut explorer = explored(&home, &mut engine);
    let changed = ViewTarget { physics: physics(5.0), ..home.clone() };
    explorer.target(&changed);
    explorer.target(&ViewTarget { physics: physics(4.0), ..home.clone() });
    assert!(explorer.is_behind(), "the first coarse map comes before");
    explorer.target(&ViewTarget { physics: physics(4.0), ..target([-2.0, 1.0], 9) });
    assert!(!explorer.is_behind(), "another place");
    explorer.target(&changed);
    let mut asked = changed.physics.clone();
    asked.question.count = 2;
    explorer.target(&ViewTarget { physics: asked, ..home });
    assert!(!explorer.is_behind(), "another question");
}
