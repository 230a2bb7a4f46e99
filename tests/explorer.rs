//! The window's scheduler without a window: what is computed in which order, that nothing is lost
//! or done twice whatever a person does, and that what comes out is what the engine answered.

#[path = "explorer/ledger.rs"]
mod ledger;

use std::collections::{HashMap, HashSet};
use std::time::{Duration, Instant};

use flipmap::engine::mock::MockEngine;
use flipmap::engine::{Engine, Job, Method, Precision, Question, Recipe};
use flipmap::physics::{Dd, Outcome, Rule, Status};
use flipmap::scene::{Build, Fate, Question as Asked, Scene};
use flipmap::tiles::cache::TILE_BYTES;
use flipmap::tiles::explorer::{Aim, Explorer, MOST_CELLS, Physics};
use flipmap::tiles::lattice::{Cell, Region, SIDE, side_rad};
use ledger::Ledger;
use proptest::prelude::*;

const ROOMY: usize = 4000 * TILE_BYTES;

fn physics(gravity: f64) -> Physics {
    Physics {
        build: Build { gravity, ..Build::default() },
        rule: Rule::Second,
        recipe: Recipe { method: Method::LESSON, precision: Precision::F32 },
        verified: false,
    }
}

/// A view two or three cells wide.
fn aim(center: [f64; 2], level: u32) -> Aim {
    let half = 0.7 * side_rad(level).hi;
    Aim {
        physics: physics(9.81),
        budget_secs: 30.0,
        region: Region { center: center.map(Dd::new), half_rad: [half, 0.8 * half] },
        level,
        pointer: None,
    }
}

/// A view in which most pendulums flip and some do so late.
fn lively(level: u32) -> Aim {
    aim([2.0, 1.0], level)
}

fn scene(aim: &Aim) -> Scene {
    let question = Asked { rule: aim.physics.rule, budget: aim.budget_secs };
    Scene { build: aim.physics.build, question, ..Scene::default() }
}

fn explored(aim: Aim, engine: &mut Ledger) -> Explorer {
    let mut explorer = Explorer::new(ROOMY);
    explorer.aim(aim);
    explorer.work(engine, None).unwrap();
    explorer
}

/// The deadline of a frame in which there is time for everything but to wait.
fn in_time() -> Option<Instant> {
    Some(Instant::now() + Duration::from_secs(60))
}

/// One frame of a window; jobs are still flying when it ends.
fn frame(explorer: &mut Explorer, engine: &mut Ledger) {
    explorer.work(engine, in_time()).unwrap();
}

/// The jobs that were sent while a window drew so many frames.
fn jobs_of_frames(explorer: &mut Explorer, engine: &mut Ledger, frames: usize) -> Vec<Job> {
    let sent = engine.jobs.len();
    (0..frames).for_each(|_| frame(explorer, engine));
    engine.jobs[sent..].to_vec()
}

/// The canonical cells that were computed from rest, in the order in which they were begun.
fn cells_of(jobs: &[Job], levels: &[u32]) -> Vec<Cell> {
    jobs.iter().filter_map(Ledger::first_start).map(|angle| cell_of(angle, levels)).collect()
}

fn in_view(aim: &Aim) -> Vec<Cell> {
    aim.region.cells(aim.level, MOST_CELLS).into_iter().map(|placed| placed.cell).collect()
}

/// What a window with this budget shows of an outcome.
fn shown(outcome: Outcome, budget_secs: f64) -> Outcome {
    if outcome.status == Status::Flipped && outcome.time > budget_secs {
        return Outcome::without_time(Status::Unflipped);
    }
    outcome
}

/// Holds a cell's samples against the mock's formula; how many of them differ, if it is known.
fn wrong(explorer: &mut Explorer, aim: &Aim, cell: Cell) -> Option<usize> {
    let (known, mirrored) = explorer.known(cell)?;
    let (scene, question) = (scene(aim), Question::from(&scene(aim)));
    let grid = cell.grid(&scene);
    let truth = (0..SIDE * SIDE).map(|place| match grid.fate(place % SIDE, place / SIDE) {
        Fate::Forbidden => Outcome::without_time(Status::Forbidden),
        Fate::Balanced => Outcome::without_time(Status::Unflipped),
        Fate::Open(angle) => MockEngine::answer(&question, angle),
    });
    let mut samples: Vec<Outcome> = known.samples.iter().collect();
    if mirrored {
        samples.reverse();
    }
    let drawn = samples.into_iter().map(|outcome| shown(outcome, aim.budget_secs));
    Some(drawn.zip(truth).filter(|(drawn, truth)| drawn != truth).count())
}

/// The level and cell from which a job's first start comes, among some levels.
fn cell_of(angle: [Dd; 2], levels: &[u32]) -> Cell {
    let fits = |level: &&u32| {
        let cell = Cell::around(angle, **level);
        let [column, row] = cell.sample_at(angle);
        cell.grid(&Scene::default()).angle_from_pixel(column, row) == angle
    };
    let level = levels.iter().find(fits).expect("a sample of one of the levels");
    Cell::around(angle, *level)
}

/// A person's doing, and the engine's.
#[derive(Clone, Debug)]
enum Action {
    Pan([f64; 2]),
    Zoom(i32),
    Jump([f64; 2], u32),
    Gravity(f64),
    Budget(f64),
    Point([f64; 2]),
    Frames(usize),
    Hurry(usize),
    Finish,
    RefuseJob,
    LoseDevice,
}

fn actions() -> impl Strategy<Value = Vec<Action>> {
    let step = prop_oneof![Just(-0.9), Just(-0.3), Just(0.0), Just(0.3), Just(0.9)];
    let theta = -3.1..3.1f64;
    let action = prop_oneof![
        3 => [step.clone(), step].prop_map(Action::Pan),
        3 => (-2..3i32).prop_map(Action::Zoom),
        1 => ([theta.clone(), theta], 0..12u32).prop_map(|(to, level)| Action::Jump(to, level)),
        1 => prop_oneof![Just(9.81), Just(1.62)].prop_map(Action::Gravity),
        3 => prop_oneof![Just(20.0), Just(45.0), Just(60.0)].prop_map(Action::Budget),
        1 => [-0.5..0.5f64, -0.5..0.5].prop_map(Action::Point),
        3 => (1..12usize).prop_map(Action::Frames),
        2 => (1..12usize).prop_map(Action::Hurry),
        2 => Just(Action::Finish),
        1 => Just(Action::RefuseJob),
        1 => Just(Action::LoseDevice),
    ];
    proptest::collection::vec(action, 1..12)
}

/// An explorer, its engine, and what it was aimed at.
struct Session {
    explorer: Explorer,
    engine: Ledger,
    aim: Aim,
}

impl Session {
    fn new(cache_bytes: usize, backwards: bool, job_size: usize) -> Self {
        let engine = Ledger::over(MockEngine { backwards, job_size, ..MockEngine::default() });
        Session { explorer: Explorer::new(cache_bytes), engine, aim: lively(3) }
    }

    fn look(&mut self, change: impl FnOnce(&mut Aim)) {
        change(&mut self.aim);
        let half = 0.7 * side_rad(self.aim.level).hi;
        self.aim.region.half_rad = [half, 0.8 * half];
        self.explorer.aim(self.aim);
    }

    /// Works on; an engine that fails is replaced as the window does.
    fn work(&mut self, deadline: Option<Instant>) {
        if self.explorer.work(&mut self.engine, deadline).is_err() {
            self.engine.cancel();
            self.engine.mock.fail_at = None;
            self.explorer.ground();
        }
    }

    fn act(&mut self, action: &Action) {
        let side = side_rad(self.aim.level).hi;
        match *action {
            Action::Pan(by) => self.look(|aim| {
                let center = aim.region.center;
                aim.region.center = [0, 1].map(|i| (center[i] + Dd::new(by[i] * side)).wrapped());
            }),
            Action::Zoom(by) => {
                self.look(|aim| aim.level = aim.level.saturating_add_signed(by).min(90));
            }
            Action::Jump(to, level) => self.look(|aim| {
                (aim.region.center, aim.level) = (to.map(Dd::new), level);
            }),
            Action::Gravity(gravity) => self.look(|aim| aim.physics = physics(gravity)),
            Action::Budget(secs) => self.look(|aim| aim.budget_secs = secs),
            Action::Point(at) => self.look(|aim| aim.pointer = Some(at.map(|by| by * side))),
            Action::Frames(count) => (0..count).for_each(|_| self.work(in_time())),
            Action::Hurry(count) => (0..count).for_each(|_| self.work(Some(Instant::now()))),
            Action::Finish => self.work(None),
            Action::RefuseJob => {
                self.engine.mock.fail_at = Some(self.engine.mock.submitted);
                self.work(in_time());
                self.engine.mock.fail_at = None;
            }
            Action::LoseDevice => {
                self.engine.fail_poll = true;
                self.work(in_time());
                self.engine.fail_poll = false;
            }
        }
    }

    /// Everything in view is there, and right.
    fn check_view(&mut self) -> Result<(), TestCaseError> {
        let progress = self.explorer.progress();
        prop_assert!(progress.idle && progress.covered, "{progress:?}");
        prop_assert_eq!(progress.done, progress.wanted);
        for cell in in_view(&self.aim) {
            prop_assert_eq!(wrong(&mut self.explorer, &self.aim, cell), Some(0), "{:?}", cell);
        }
        Ok(())
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    #[test]
    fn nothing_is_lost_or_done_twice(actions in actions(), backwards: bool, large: bool) {
        let mut session = Session::new(ROOMY, backwards, if large { 1 << 18 } else { 64 });
        session.explorer.aim(session.aim);
        for action in &actions {
            session.act(action);
        }
        session.work(None);
        session.check_view()?;
        let Session { explorer, engine, .. } = session;
        prop_assert_eq!((engine.again, engine.doubled), (0, 0));
        prop_assert_eq!(explorer.counts().simulated, engine.mock.answered as u64);
        prop_assert!(engine.mock.most_in_flight <= engine.slots());
    }

    #[test]
    fn the_cache_stays_within_its_bytes(
        actions in actions(), room in 0usize..60, then in 0usize..60, backwards: bool,
    ) {
        let mut session = Session::new(room * TILE_BYTES, backwards, 64);
        session.explorer.aim(session.aim);
        for (index, action) in actions.iter().enumerate() {
            if index == actions.len() / 2 {
                session.explorer.set_cache_bytes(then * TILE_BYTES);
            }
            session.act(action);
            let budget = if index < actions.len() / 2 { room } else { then } * TILE_BYTES;
            prop_assert!(session.explorer.bytes() <= budget, "{action:?}");
        }
        session.work(None);
        prop_assert!(session.explorer.bytes() <= then.max(room) * TILE_BYTES);
        prop_assert!(session.explorer.progress().idle, "what does not fit is not tried for ever");
        // Two coarse passes of 4 cells and 3 × 3 in view.
        if then >= 17 && room >= 17 {
            session.check_view()?;
        }
        for cell in in_view(&session.aim) {
            let wrong = wrong(&mut session.explorer, &session.aim, cell);
            prop_assert!(wrong.is_none_or(|wrong| wrong == 0), "{cell:?} {wrong:?}");
        }
    }
}

/// How far a canonical cell is from what is looked at, wherever it or its image appears.
fn distances(aim: &Aim, region: &Region, level: u32) -> HashMap<Cell, f64> {
    let mut nearest = HashMap::new();
    for placed in region.cells(level, MOST_CELLS) {
        let from = |at: [f64; 2]| (placed.offset[0] - at[0]).hypot(placed.offset[1] - at[1]);
        let distance = aim.pointer.map_or(f64::INFINITY, from).min(from([0.0; 2]));
        let least = nearest.entry(placed.cell.canonical().0).or_insert(distance);
        *least = distance.min(*least);
    }
    nearest
}

#[test]
fn coarse_comes_first_then_what_is_near_then_the_ring() {
    // Five by three cells, whose neighbours are less than half a cell away.
    let (middle, side) = (Cell::around([Dd::new(2.0), Dd::new(1.0)], 9), side_rad(9).hi);
    let [x, y] = [2.3 * side, 1.2 * side];
    let region = Region { center: middle.center(), half_rad: [x, y] };
    let wide = Aim { region, ..lively(9) };
    for pointer in [None, Some([0.8 * x, -0.6 * y]), Some([-x, y])] {
        let aim = Aim { pointer, ..wide };
        let mut engine = Ledger::default();
        explored(aim, &mut engine);
        let cells = cells_of(&engine.jobs, &[5, 7, 9]);
        let view: Vec<_> = [5, 7, 9].map(|level| distances(&aim, &aim.region, level)).into();
        let pass = |cell: &Cell| match cell.level {
            9 if !view[2].contains_key(cell) => 3,
            level => (level - 5) / 2,
        };
        assert!(cells.is_sorted_by_key(pass), "{cells:?}");
        for (level, distances) in [5, 7, 9].into_iter().zip(&view) {
            let begun: Vec<_> = cells.iter().filter(|c| c.level == level && pass(c) < 3).collect();
            assert!(begun.is_sorted_by(|a, b| distances[a] <= distances[b]), "{pointer:?}");
            assert_eq!(begun.len(), distances.len(), "all of level {level} in view");
        }
        let ring = cells.iter().filter(|cell| pass(cell) == 3).count();
        assert_eq!(ring, 7 * 5 - 5 * 3, "cells around the view");
    }
}

#[test]
fn the_newest_view_wins() {
    let (here, there) = (lively(12), aim([-1.5, 2.0], 12));
    let mut engine = Ledger::default();
    let mut explorer = Explorer::new(ROOMY);
    explorer.aim(here);
    frame(&mut explorer, &mut engine);
    assert!(!engine.mock.queue.is_empty());
    explorer.aim(there);
    let sent = jobs_of_frames(&mut explorer, &mut engine, 200);
    assert_eq!(engine.cancels, 1, "what flew for the old view is dropped");
    let wanted: HashSet<Cell> = [8, 10, 12]
        .into_iter()
        .flat_map(|level| there.region.scaled(2.5).cells(level, MOST_CELLS))
        .map(|placed| placed.cell.canonical().0)
        .collect();
    let cells = cells_of(&sent, &[8, 10, 12]);
    assert!(cells.iter().all(|cell| wanted.contains(cell)));
    let progress = explorer.progress();
    assert!(progress.idle && progress.done == progress.wanted, "{progress:?}");
}

#[test]
fn what_is_still_useful_flies_on() {
    let mut engine = Ledger::default();
    let mut explorer = Explorer::new(ROOMY);
    let mut aim = lively(12);
    explorer.aim(aim);
    for _ in 0..20 {
        frame(&mut explorer, &mut engine);
        aim.region.center[0] = aim.region.center[0] + Dd::new(0.02 * side_rad(12).hi);
        explorer.aim(aim);
    }
    explorer.work(&mut engine, None).unwrap();
    assert_eq!((engine.cancels, engine.again, engine.doubled), (0, 0, 0));
    assert!(in_view(&aim).into_iter().all(|cell| wrong(&mut explorer, &aim, cell) == Some(0)));
}

#[test]
fn a_view_seen_before_is_not_computed_again() {
    let mut engine = Ledger::default();
    let mut explorer = explored(lively(6), &mut engine);
    let side = side_rad(6).hi;
    let path: Vec<Aim> = (1..6)
        .map(|step| aim([2.0 + 0.9 * side * f64::from(step), 1.0], 6))
        .chain((1..4).map(|zoom| aim([2.0, 1.0], 6 + zoom)))
        .chain((1..4).map(|zoom| aim([2.0, 1.0], 6 - zoom)))
        .collect();
    for aim in &path {
        explorer.aim(*aim);
        explorer.work(&mut engine, None).unwrap();
    }
    let (simulated, jobs) = (explorer.counts().simulated, engine.jobs.len());
    assert!(simulated > 0);
    for aim in path.iter().rev() {
        explorer.aim(*aim);
        let progress = explorer.progress();
        assert!(progress.idle && progress.done == progress.wanted, "at once: {progress:?}");
        explorer.work(&mut engine, None).unwrap();
    }
    assert_eq!((explorer.counts().simulated, engine.jobs.len()), (simulated, jobs));
}

/// The unflipped samples of the view and its ring: everything of its own level that is known.
fn unflipped(explorer: &mut Explorer, aim: &Aim) -> usize {
    let cells = aim.region.scaled(3.0).cells(aim.level, MOST_CELLS);
    let cells: HashSet<Cell> = cells.into_iter().map(|placed| placed.cell.canonical().0).collect();
    let known = cells.into_iter().filter_map(|cell| Some(explorer.known(cell)?.0.samples.clone()));
    let unflipped = |outcome: &Outcome| outcome.status == Status::Unflipped;
    known.map(|samples| samples.iter().filter(unflipped).count()).sum()
}

#[test]
fn a_larger_budget_continues_what_did_not_flip() {
    for verified in [false, true] {
        let physics = Physics { verified, ..physics(9.81) };
        let small = Aim { physics, ..lively(5) };
        let mut engine = Ledger::default();
        let mut explorer = explored(small, &mut engine);
        assert!(engine.jobs.iter().all(|job| job.keep_unfinished != verified));
        let left = unflipped(&mut explorer, &small);
        assert!(left > 10_000, "{left}");
        let (simulated, sent) = (explorer.counts().simulated, engine.sent);
        let large = Aim { budget_secs: 50.0, ..small };
        explorer.aim(large);
        explorer.work(&mut engine, None).unwrap();
        assert_eq!(explorer.counts().simulated - simulated, left as u64);
        // A check begins at the release, so checked pendulums begin anew.
        let [rest, continued] = if verified { [left, 0] } else { [0, left] };
        assert_eq!(engine.sent, [sent[0] + rest, sent[1] + continued]);
        assert!(unflipped(&mut explorer, &large) < left, "some flip before 50 s");
        assert!(
            in_view(&large).into_iter().all(|cell| wrong(&mut explorer, &large, cell) == Some(0))
        );
    }
}

#[test]
fn a_smaller_budget_computes_nothing() {
    let large = Aim { budget_secs: 50.0, ..lively(5) };
    let mut engine = Ledger::default();
    let mut explorer = explored(large, &mut engine);
    let simulated = explorer.counts().simulated;
    for budget_secs in [30.0, 10.5, 45.0] {
        let aim = Aim { budget_secs, ..large };
        explorer.aim(aim);
        assert!(explorer.progress().idle);
        explorer.work(&mut engine, None).unwrap();
        assert_eq!(explorer.counts().simulated, simulated, "{budget_secs} s");
        assert!(in_view(&aim).into_iter().all(|cell| wrong(&mut explorer, &aim, cell) == Some(0)));
    }
}

#[test]
fn a_budget_raised_in_flight_waits_for_what_flies() {
    let mut engine = Ledger::default();
    let mut explorer = Explorer::new(ROOMY);
    explorer.aim(lively(5));
    for budget_secs in [41.0, 43.0, 45.0] {
        frame(&mut explorer, &mut engine);
        explorer.aim(Aim { budget_secs, ..lively(5) });
    }
    explorer.work(&mut engine, None).unwrap();
    assert_eq!((engine.cancels, engine.again, engine.doubled), (0, 0, 0));
    let aim = Aim { budget_secs: 45.0, ..lively(5) };
    assert!(in_view(&aim).into_iter().all(|cell| wrong(&mut explorer, &aim, cell) == Some(0)));
}

#[test]
fn mirror_images_are_computed_once() {
    let mut engine = Ledger::default();
    let mut explorer = explored(lively(6), &mut engine);
    let simulated = explorer.counts().simulated;
    let image = aim([-2.0, -1.0], 6);
    explorer.aim(image);
    explorer.work(&mut engine, None).unwrap();
    assert_eq!(explorer.counts().simulated, simulated);
    assert!(in_view(&image).into_iter().all(|cell| wrong(&mut explorer, &image, cell) == Some(0)));
    // A view that holds the images of its own cells: half of them is enough.
    let middle = Aim { region: Region { half_rad: [2.5; 2], ..image.region }, ..aim([0.0; 2], 4) };
    let middle = Aim { region: Region { center: [Dd::new(0.0); 2], ..middle.region }, ..middle };
    let mut engine = Ledger::default();
    explored(middle, &mut engine);
    let cells = cells_of(&engine.jobs, &[0, 2, 4]);
    let distinct: HashSet<Cell> = cells.iter().map(|cell| cell.canonical().0).collect();
    assert_eq!(distinct.len(), cells.len(), "a cell and its image");
}

#[test]
fn the_plane_wraps_around() {
    let pi = std::f64::consts::PI;
    let mut engine = Ledger::default();
    let east = aim([pi, -2.9], 4);
    let mut explorer = explored(east, &mut engine);
    let sides: HashSet<bool> = in_view(&east).iter().map(|cell| cell.x < 8).collect();
    assert_eq!(sides.len(), 2, "cells from both ends");
    assert!(in_view(&east).into_iter().all(|cell| wrong(&mut explorer, &east, cell) == Some(0)));
    let simulated = explorer.counts().simulated;
    for west in [aim([-pi, -2.9], 4), aim([pi, 2.0 * pi - 2.9], 4)] {
        explorer.aim(west);
        explorer.work(&mut engine, None).unwrap();
        assert_eq!(explorer.counts().simulated, simulated, "{:?}", west.region.center);
    }
}

#[test]
fn several_turns_in_view_are_computed_once() {
    let mut aim = aim([0.4, 0.2], 2);
    aim.region.half_rad = [10.0, 8.0];
    let mut engine = Ledger::default();
    let mut explorer = explored(aim, &mut engine);
    let placed = aim.region.cells(2, MOST_CELLS).len();
    assert!(placed > 60, "{placed}");
    // 16 cells of level 2, of which energy forbids none whole; one of level 0.
    assert_eq!(cells_of(&engine.jobs, &[0, 2]).len(), 8 + 1);
    assert_eq!((engine.again, engine.doubled), (0, 0));
    assert!(in_view(&aim).into_iter().all(|cell| wrong(&mut explorer, &aim, cell) == Some(0)));
}

#[test]
fn late_answers_of_a_grounded_engine_are_nobodys() {
    let mut engine = Ledger::default();
    let mut explorer = Explorer::new(ROOMY);
    explorer.aim(lively(7));
    frame(&mut explorer, &mut engine);
    // Its old jobs are still in it, and come out first.
    explorer.aim(aim([-1.0, 2.5], 7));
    explorer.ground();
    engine.deaf = true;
    explorer.work(&mut engine, None).unwrap();
    let aim = aim([-1.0, 2.5], 7);
    assert!(in_view(&aim).into_iter().all(|cell| wrong(&mut explorer, &aim, cell) == Some(0)));
    let known = |explorer: &mut Explorer, cell: &Cell| explorer.known(*cell).is_some();
    assert!(!in_view(&lively(7)).iter().any(|cell| known(&mut explorer, cell)));
}

#[test]
fn a_frame_without_time_prepares_one_job() {
    let mut engine = Ledger::default();
    let mut explorer = Explorer::new(ROOMY);
    explorer.aim(lively(7));
    for jobs in 1..4 {
        explorer.work(&mut engine, Some(Instant::now())).unwrap();
        assert_eq!(engine.jobs.len(), jobs);
    }
    frame(&mut explorer, &mut engine);
    assert_eq!(engine.jobs.len(), 3 + engine.slots() + 1, "with time, every slot twice filled");
    assert_eq!(engine.mock.queue.len(), engine.slots());
}

#[test]
fn a_changed_pendulum_shows_the_one_before_until_it_is_known() {
    let mut engine = Ledger::default();
    let home = lively(5);
    let mut explorer = explored(home, &mut engine);
    let cells = in_view(&home);
    let before = |explorer: &mut Explorer, cell: &Cell| {
        explorer.known_before(*cell).map(|(known, _)| known.serial)
    };
    assert!(cells.iter().all(|cell| before(&mut explorer, cell).is_none()));
    let of_home: Vec<u64> =
        cells.iter().map(|cell| explorer.known(*cell).expect("computed").0.serial).collect();
    // A slider passes several on its way, and of those little or nothing becomes known.
    for gravity in [9.0, 8.0, 7.0, 6.0] {
        explorer.aim(Aim { physics: physics(gravity), ..home });
        for (cell, serial) in cells.iter().zip(&of_home) {
            assert!(explorer.known(*cell).is_none());
            assert_eq!(before(&mut explorer, cell), Some(*serial));
        }
    }
    explorer.work(&mut engine, None).unwrap();
    assert!(cells.iter().all(|cell| explorer.known(*cell).is_some()));
    let simulated = explorer.counts().simulated;
    explorer.aim(home);
    let progress = explorer.progress();
    assert!(progress.idle && progress.done == progress.wanted, "{progress:?}");
    assert_eq!(explorer.counts().simulated, simulated);
    assert!(cells.iter().all(|cell| before(&mut explorer, cell).is_some()), "of the last slider");
}

#[test]
fn the_comparison_can_fail() {
    let mut engine = Ledger::default();
    let mut explorer = explored(lively(5), &mut engine);
    let cell = in_view(&lively(5))[0];
    assert_eq!(wrong(&mut explorer, &lively(5), cell), Some(0));
    let other = Aim { physics: physics(5.0), ..lively(5) };
    assert!(wrong(&mut explorer, &other, cell).is_some_and(|wrong| wrong > 1000));
    let larger = Aim { budget_secs: 60.0, ..lively(5) };
    let late = in_view(&larger).into_iter().filter_map(|c| wrong(&mut explorer, &larger, c));
    assert!(late.sum::<usize>() > 1000);
}
