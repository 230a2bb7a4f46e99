//! Finer samples at edges, which are computed last and only where they change the picture.

use flipmap_engine::Engine;
use flipmap_pendulum::Status;
use flipmap_render::tiles::explorer::Explorer;
use flipmap_render::tiles::view_target::ViewTarget;
use flipmap_scene::lattice::SAMPLES;

use super::common::*;
use super::ledger::Ledger;

/// The level of the views; a view of two or three cells of this level contains an edge.
const LEVEL: u32 = 6;

fn smoothed() -> ViewTarget {
    ViewTarget { refinements: 2, ..lively(LEVEL) }
}

/// Returns the number of known samples of finer cells, and how many of them differ from the mock
/// engine's formula in status or time.
fn compared(explorer: &mut Explorer, target: &ViewTarget, level: u32) -> [usize; 2] {
    let mut counts = [0, 0];
    for cell in cells(target, level) {
        let Some(known) = explorer.known_finer(cell) else { continue };
        for (drawn, truth) in drawn(known, target).into_iter().zip(truth(target, cell)) {
            let is_far = truth.status == Status::Answered && (drawn.time - truth.time).abs() > 1e-3;
            counts[0] += 1;
            counts[1] += usize::from(drawn.status != truth.status || is_far);
        }
    }
    counts
}

#[test]
fn they_come_last_and_only_at_edges_and_are_right_everywhere() {
    let (mut engine, mut plain) = (Ledger::default(), Ledger::default());
    let (target, mut explorer) = (smoothed(), explored(&smoothed(), &mut engine));
    explored(&lively(LEVEL), &mut plain);
    let levels = [LEVEL - 3, LEVEL, LEVEL + 1, LEVEL + 2];
    let order = cells_of(&engine.jobs, &levels).into_iter().map(|cell| cell.level.max(LEVEL));
    let order: Vec<u32> = order.collect();
    assert!(order.is_sorted() && order.last() == Some(&(LEVEL + 2)), "{order:?}");
    let extra = engine.sent[0] - plain.sent[0];
    for level in [LEVEL + 1, LEVEL + 2] {
        let [samples, wrong] = compared(&mut explorer, &target, level);
        let all = cells(&target, level).len() * SAMPLES;
        println!("level {level}: {samples} of {all} known, {wrong} wrong, {extra} computed in all");
        assert!(samples > 0 && samples < all, "smooth quarters have none");
        assert!(wrong == 0 && extra < all / 10, "few are computed, and none is wrong");
    }
    assert_eq!((engine.again, engine.doubled), (0, 0));
    // The comparison detects a wrong pendulum.
    let other = ViewTarget { physics: physics(9.0), ..target };
    assert!(compared(&mut explorer, &other, LEVEL + 1)[1] > 1000);
}

#[test]
fn a_view_is_complete_before_them_and_a_pointer_does_not_begin_them_again() {
    let mut engine = Ledger::default();
    let mut explorer = Explorer::new(ROOMY);
    explorer.target(&smoothed());
    while !explorer.progress().idle {
        explorer.work(&mut engine, in_time()).unwrap();
    }
    let progress = explorer.progress();
    assert!(progress.refines && progress.done == progress.wanted, "{progress:?}");
    let pointer = Some([0.0, 0.001]);
    explorer.target(&ViewTarget { pointer, ..smoothed() });
    assert!(explorer.progress().refines && engine.cancels == 0);
    // A view that asks for no finer samples drops that work.
    explorer.target(&ViewTarget { pointer, ..lively(LEVEL) });
    explorer.work(&mut engine, None).unwrap();
    assert!(explorer.is_done() && !explorer.progress().refines);
    explorer.target(&smoothed());
    assert!(!explorer.is_done() && explorer.progress().idle);
    explorer.work(&mut engine, None).unwrap();
    assert!(explorer.is_done() && engine.again == 0);
}

#[test]
fn what_was_seen_closer_with_a_smaller_budget_is_no_finer_sample() {
    let mut engine = Ledger::default();
    let mut explorer = explored(&lively(LEVEL + 1), &mut engine);
    let later = ViewTarget { budget_secs: 60.0, ..smoothed() };
    explorer.target(&later);
    explorer.work(&mut engine, None).unwrap();
    let [samples, wrong] = compared(&mut explorer, &later, LEVEL + 1);
    assert!(samples > 0 && wrong == 0, "{wrong} of {samples}");
    let sent = engine.jobs.len();
    explorer.target(&ViewTarget { pointer: Some([0.0; 2]), ..later });
    explorer.work(&mut engine, None).unwrap();
    assert_eq!(engine.jobs.len(), sent, "nor is it computed again and again");
}

#[test]
fn a_larger_budget_computes_them_anew_where_nothing_had_flipped() {
    let later = ViewTarget { budget_secs: 60.0, ..smoothed() };
    let mut engine = Ledger::default();
    let mut explorer = explored(&smoothed(), &mut engine);
    explorer.target(&later);
    explorer.work(&mut engine, None).unwrap();
    for level in [LEVEL + 1, LEVEL + 2] {
        let [samples, wrong] = compared(&mut explorer, &later, level);
        assert!(samples > 0 && wrong == 0, "level {level}: {wrong} of {samples}");
    }
    // A cell known only to a smaller budget is neither drawn nor computed again and again.
    let sent = engine.jobs.len();
    for refinements in [0, 2, 1, 2] {
        explorer.target(&ViewTarget { refinements, ..later.clone() });
        explorer.work(&mut engine, None).unwrap();
    }
    assert_eq!(engine.jobs.len(), sent);
    assert_eq!(engine.mock.queue.len(), 0);
    engine.cancel();
}
