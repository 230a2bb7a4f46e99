//! The window's scheduler without a window: what is computed in which order, that nothing is lost
//! or done twice whatever a person does, and that what comes out is what the engine answered.

#[path = "explorer/ledger.rs"]
mod ledger;

use std::time::{Duration, Instant};

use flipmap::engine::mock::MockEngine;
use flipmap::engine::{Engine, Method, Precision, Question, Recipe};
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

/// One frame of a window, with time enough to fill the engine's slots.
fn frame(explorer: &mut Explorer, engine: &mut Ledger) {
    explorer.work(engine, Some(Instant::now() + Duration::from_secs(60))).unwrap();
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
        5 => (1..12usize).prop_map(Action::Frames),
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
        let mock = MockEngine { backwards, job_size, ..MockEngine::default() };
        let engine = Ledger::over(mock);
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
            Action::Frames(count) => (0..count).for_each(|_| self.work(Some(Instant::now()))),
            Action::Finish => self.work(None),
            Action::RefuseJob => {
                self.engine.mock.fail_at = Some(self.engine.mock.submitted);
                self.work(Some(Instant::now()));
                self.engine.mock.fail_at = None;
            }
            Action::LoseDevice => {
                self.engine.fail_poll = true;
                self.work(Some(Instant::now()));
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

/// The cells of the jobs sent from rest, in their order.
fn sent_cells(engine: &Ledger, levels: &[u32]) -> Vec<Cell> {
    let starts = engine.jobs.iter().filter_map(Ledger::first_start);
    starts.map(|angle| cell_of(angle, levels).canonical().0).collect()
}

#[test]
fn coarse_levels_come_first_then_what_is_near_then_the_ring() {
    let level = 6;
    let levels = [level - 4, level - 2, level];
    let pointer = [0.5 * side_rad(level).hi, 0.4 * side_rad(level).hi];
    let half = 2.2 * side_rad(level).hi;
    let region = Region { half_rad: [half; 2], ..lively(level).region };
    let aim = Aim { region, pointer: Some(pointer), ..lively(level) };
    let mut engine = Ledger::default();
    explored(aim, &mut engine);
    let cells = sent_cells(&engine, &levels);
    assert!(cells.is_sorted_by_key(|cell| cell.level), "coarse first");
    let fine: Vec<Cell> = cells.into_iter().filter(|cell| cell.level == level).collect();
    let seen: Vec<Cell> = in_view(&aim).into_iter().map(|cell| cell.canonical().0).collect();
    let inside = |cell: &Cell| seen.contains(cell);
    assert_eq!(fine.iter().filter(|cell| inside(cell)).count(), seen.len());
    assert!(fine.is_sorted_by_key(|cell| !inside(cell)), "the ring comes last");
    assert!(fine.len() > seen.len(), "there is a ring");
    let distance = |cell: &Cell| {
        let placed = region.cells(level, MOST_CELLS).into_iter();
        let far =
            |offset: [f64; 2], from: [f64; 2]| (offset[0] - from[0]).hypot(offset[1] - from[1]);
        placed
            .filter(|placed| placed.cell.canonical().0 == *cell)
            .map(|placed| far(placed.offset, [0.0; 2]).min(far(placed.offset, pointer)))
            .fold(f64::INFINITY, f64::min)
    };
    let near: Vec<f64> = fine.iter().filter(|cell| inside(cell)).map(distance).collect();
    assert!(near.is_sorted_by(|a, b| *a <= *b + 1e-12), "{near:?}");
}

#[test]
fn what_was_seen_before_is_not_computed_again() {
    let mut engine = Ledger::default();
    let here = lively(5);
    let mut explorer = explored(here, &mut engine);
    let there =
        Aim { region: Region { center: [Dd::new(-1.0), Dd::new(2.0)], ..here.region }, ..here };
    explorer.aim(there);
    explorer.work(&mut engine, None).unwrap();
    let simulated = explorer.counts().simulated;
    for aim in [here, there, Aim { level: 4, ..here }, here] {
        explorer.aim(aim);
        explorer.work(&mut engine, None).unwrap();
        if aim.level == 5 {
            assert_eq!(explorer.progress().done, explorer.progress().wanted);
        }
    }
    let more = explorer.counts().simulated - simulated;
    // Of the coarser view alone something was new.
    explorer.aim(Aim { level: 4, ..here });
    explorer.work(&mut engine, None).unwrap();
    assert_eq!(explorer.counts().simulated, simulated + more);
    assert_eq!(engine.again, 0);
}

#[test]
fn a_raised_budget_continues_and_a_lowered_one_computes_nothing() {
    let mut engine = Ledger::default();
    let short = Aim { budget_secs: 12.0, ..lively(4) };
    let mut explorer = explored(short, &mut engine);
    let [from_rest, continued] = engine.sent;
    assert!(from_rest > 0 && continued == 0);
    let long = Aim { budget_secs: 60.0, ..short };
    explorer.aim(long);
    explorer.work(&mut engine, None).unwrap();
    assert_eq!(engine.sent[0], from_rest, "nothing begins anew");
    assert!(engine.sent[1] > 0 && engine.sent[1] < from_rest, "only what had not flipped");
    for cell in in_view(&long) {
        assert_eq!(wrong(&mut explorer, &long, cell), Some(0));
    }
    let jobs = engine.jobs.len();
    explorer.aim(short);
    explorer.work(&mut engine, None).unwrap();
    assert_eq!(engine.jobs.len(), jobs);
}

#[test]
fn an_image_is_computed_with_its_cell() {
    let mut engine = Ledger::default();
    let here = lively(5);
    let mut explorer = explored(here, &mut engine);
    let jobs = engine.jobs.len();
    let image = Region { center: here.region.center.map(|theta| -theta), ..here.region };
    let there = Aim { region: image, ..here };
    explorer.aim(there);
    explorer.work(&mut engine, None).unwrap();
    assert_eq!(engine.jobs.len(), jobs, "it is there already");
    for cell in in_view(&there) {
        assert_eq!(wrong(&mut explorer, &there, cell), Some(0));
    }
}

#[test]
fn views_across_the_seam_are_whole() {
    let mut engine = Ledger::default();
    let seam = aim([std::f64::consts::PI, -std::f64::consts::PI], 4);
    let mut explorer = explored(seam, &mut engine);
    let cells = in_view(&seam);
    assert!(cells.iter().any(|cell| cell.x == 0) && cells.iter().any(|cell| cell.x == 15));
    for cell in cells {
        assert_eq!(wrong(&mut explorer, &seam, cell), Some(0));
    }
}

#[test]
fn stale_work_is_dropped_and_what_is_still_wanted_is_not() {
    let (mut engine, mut explorer) = (Ledger::default(), Explorer::new(ROOMY));
    explorer.aim(lively(6));
    frame(&mut explorer, &mut engine);
    assert!(!engine.mock.queue.is_empty());
    let nudged = Aim { pointer: Some([1e-3, 0.0]), ..lively(6) };
    explorer.aim(nudged);
    frame(&mut explorer, &mut engine);
    assert_eq!(engine.cancels, 0, "the same cells are wanted");
    explorer.aim(aim([-0.4, -2.5], 9));
    frame(&mut explorer, &mut engine);
    assert_eq!(engine.cancels, 1);
    let level = |job: &flipmap::engine::Job| {
        Ledger::first_start(job).map(|angle| cell_of(angle, &[5, 7, 9, 2, 4, 6]).level)
    };
    let newest = engine.mock.queue.iter().filter_map(level).collect::<Vec<_>>();
    assert!(
        !newest.is_empty() && newest.iter().all(|level| [5, 7, 9].contains(level)),
        "{newest:?}"
    );
}

#[test]
fn a_changed_pendulum_leaves_the_old_map_until_there_is_a_new_one() {
    let mut engine = Ledger::default();
    let here = lively(4);
    let mut explorer = explored(here, &mut engine);
    explorer.aim(Aim { physics: physics(1.62), ..here });
    let cell = in_view(&here)[0];
    assert!(explorer.known(cell).is_none() && explorer.known_before(cell).is_some());
}
