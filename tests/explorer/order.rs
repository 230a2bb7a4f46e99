//! The order in which cells are computed, and the work that is abandoned.

use std::collections::{HashMap, HashSet};
use std::time::Instant;

use flipmap_engine::Engine;
use flipmap_engine::mock::MockEngine;
use flipmap_numbers::{Exact, Scalar};
use flipmap_render::tiles::explorer::{Explorer, MAX_CELLS};
use flipmap_render::tiles::view_target::ViewTarget;
use flipmap_scene::lattice::{Cell, Region, side_rad};

use super::common::*;
use super::ledger::Ledger;

/// Distances of the canonical cells of a region from the pointer or the middle of the view,
/// whichever is nearer, taken over all places where a cell or its image appears.
fn distances(target: &ViewTarget, region: &Region, level: u32) -> HashMap<Cell, f64> {
    let mut nearest = HashMap::new();
    for placed in region.cells(level, MAX_CELLS) {
        let from = |at: [f64; 2]| (placed.offset[0] - at[0]).hypot(placed.offset[1] - at[1]);
        let distance = target.pointer.map_or(f64::INFINITY, from).min(from([0.0; 2]));
        let least = nearest.entry(placed.cell.canonical().0).or_insert(distance);
        *least = distance.min(*least);
    }
    nearest
}

#[test]
fn passes_follow_each_other_and_each_begins_with_what_is_near() {
    let (middle, side) = (Cell::around([2.0, 1.0].map(Exact::from_f64), 9), side_rad(9));
    let [x, y] = [2.3 * side, 1.2 * side];
    let region = Region { center: middle.center(), half_rad: [x, y], repeats: true };
    let wide = ViewTarget { region, ..lively(9) };
    for pointer in [None, Some([0.8 * x, -0.6 * y]), Some([-x, y])] {
        let target = ViewTarget { pointer, ..wide.clone() };
        let mut engine = Ledger::default();
        explored(&target, &mut engine);
        let cells = cells_of(&engine.jobs, &[6, 9]);
        // The new samples of a pass are those that the pass before it lacks.
        let pass = |(cell, count): (&Cell, &usize)| match (cell.level, count) {
            (9, 64) => 0,
            (6, 1024) => 1,
            (9, 192) => 2,
            (9, 768) => 3,
            (9, 3072) => 4,
            other => panic!("{other:?}"),
        };
        let passes: Vec<usize> = cells.iter().zip(&engine.counts).map(pass).collect();
        assert!(passes.is_sorted(), "{passes:?}");
        for (pass, level) in [9, 6, 9, 9, 9].into_iter().enumerate() {
            let distances = distances(&target, &target.region, level);
            let begun = cells.iter().zip(&passes).filter(|(_, its)| **its == pass);
            let begun: Vec<_> = begun.map(|(cell, _)| distances[cell]).collect();
            assert!(begun.is_sorted(), "{pointer:?}, pass {pass}");
            assert_eq!(begun.len(), distances.len(), "all of level {level} in view, and no more");
        }
    }
}

#[test]
fn every_pass_adds_its_samples_to_the_progress() {
    let target = lively(9);
    let mut explorer = Explorer::new(ROOMY);
    explorer.target(&target);
    let mut engine = MockEngine { job_size: 1, ..MockEngine::default() };
    let mut shares = vec![explorer.progress().share];
    while !explorer.is_done() {
        explorer.work(&mut engine, Some(Instant::now())).unwrap();
        let progress = explorer.progress();
        assert!(progress.done == 0 || progress.share > 0.25, "{progress:?}");
        shares.push(progress.share);
    }
    assert!(shares.is_sorted() && shares[0] == 0.0 && shares.last() == Some(&1.0), "{shares:?}");
    for pass in [1.0 / 64.0, 1.0 / 16.0, 1.0 / 4.0] {
        assert!(shares.contains(&pass), "the end of a pass is missing: {shares:?}");
    }
    // With a larger budget the work begins again.
    explorer.target(&ViewTarget { budget_secs: target.budget_secs + 1.0, ..target });
    assert_eq!(explorer.progress().share, 0.0);
}

#[test]
fn large_cards_get_jobs_of_many_cells() {
    let side = side_rad(9);
    let center = Cell::around([2.0, 1.0].map(Exact::from_f64), 9).center();
    let region = Region { center, half_rad: [7.2 * side; 2], repeats: true };
    let jobs = [1 << 16, 1 << 20].map(|job_size| {
        let mut engine = Ledger::over(MockEngine { job_size, ..MockEngine::default() });
        explored(&ViewTarget { region, ..lively(9) }, &mut engine);
        (engine.jobs.len(), engine.counts.into_iter().max().unwrap())
    });
    // A job of the last pass has eight cells, then 128.
    let [(many, small), (few, large)] = jobs;
    assert!(many > 5 * few && large > 10 * small, "{jobs:?}");
}

#[test]
fn the_newest_view_wins() {
    let (here, there) = (lively(12), target([-1.5, 2.0], 12));
    let mut engine = Ledger::default();
    let mut explorer = Explorer::new(ROOMY);
    explorer.target(&here);
    frame(&mut explorer, &mut engine);
    assert!(!engine.mock.queue.is_empty());
    explorer.target(&there);
    let sent = jobs_of_frames(&mut explorer, &mut engine, 200);
    assert_eq!(engine.cancels, 1, "what flew for the old view is dropped");
    let wanted: HashSet<Cell> = [9, 12]
        .into_iter()
        .flat_map(|level| there.region.cells(level, MAX_CELLS))
        .map(|placed| placed.cell.canonical().0)
        .collect();
    let cells = cells_of(&sent, &[9, 12]);
    assert!(cells.iter().all(|cell| wanted.contains(cell)));
    let progress = explorer.progress();
    assert!(progress.idle && progress.done == progress.wanted, "{progress:?}");
}

#[test]
fn what_is_still_useful_flies_on() {
    let mut engine = Ledger::default();
    let mut explorer = Explorer::new(ROOMY);
    let mut target = lively(12);
    explorer.target(&target);
    for _ in 0..20 {
        frame(&mut explorer, &mut engine);
        target.region.center[0] = target.region.center[0] + Exact::from_f64(0.02 * side_rad(12));
        explorer.target(&target);
    }
    explorer.work(&mut engine, None).unwrap();
    assert_eq!((engine.cancels, engine.again, engine.doubled), (0, 0, 0));
    assert!(
        in_view(&target).into_iter().all(|cell| wrong(&mut explorer, &target, cell) == Some(0))
    );
}

#[test]
fn late_answers_of_a_grounded_engine_are_nobodys() {
    let mut engine = Ledger::default();
    let mut explorer = Explorer::new(ROOMY);
    let before = lively(7);
    explorer.target(&before);
    frame(&mut explorer, &mut engine);
    let known = |explorer: &mut Explorer| -> Vec<Option<u64>> {
        let cells = in_view(&before).into_iter();
        cells.map(|cell| explorer.known(cell).map(|(known, _)| known.serial)).collect()
    };
    let kept = known(&mut explorer);
    // The engine still holds its old jobs, and returns them first.
    explorer.target(&target([-1.0, 2.5], 7));
    explorer.ground();
    engine.deaf = true;
    explorer.work(&mut engine, None).unwrap();
    let target = target([-1.0, 2.5], 7);
    assert!(
        in_view(&target).into_iter().all(|cell| wrong(&mut explorer, &target, cell) == Some(0))
    );
    assert_eq!(known(&mut explorer), kept);
}

#[test]
fn a_frame_without_time_prepares_one_job() {
    let mut engine = Ledger::default();
    let mut explorer = Explorer::new(ROOMY);
    explorer.target(&lively(7));
    for jobs in 1..4 {
        explorer.work(&mut engine, Some(Instant::now())).unwrap();
        assert_eq!(engine.jobs.len(), jobs);
    }
    frame(&mut explorer, &mut engine);
    assert_eq!(engine.jobs.len(), 3 + engine.slots() + 1, "with time, every slot twice filled");
    assert_eq!(engine.mock.queue.len(), engine.slots());
}

#[test]
fn among_cells_without_an_open_pixel_a_frame_asks_to_go_on() {
    // Around (0, 0) nothing can ever flip, so hardly any job is in flight that would wake a window.
    let mut engine = Ledger::default();
    let mut explorer = Explorer::new(ROOMY);
    explorer.target(&ViewTarget {
        region: target([0.0, 0.0], 4).region.scaled(3.0),
        ..target([0.0, 0.0], 4)
    });
    let mut asked = 0;
    while !explorer.is_done() {
        explorer.work(&mut engine, Some(Instant::now())).unwrap();
        let flies = !engine.mock.queue.is_empty();
        assert!(flies || explorer.is_done() || explorer.is_waiting(), "it would sleep for ever");
        asked += u32::from(explorer.is_waiting());
    }
    assert!(asked > 2, "{asked} frames asked to go on");
    let progress = explorer.progress();
    assert!(progress.wanted > 10 && progress.done == progress.wanted, "{progress:?}");
    assert!(!explorer.is_waiting());
}
