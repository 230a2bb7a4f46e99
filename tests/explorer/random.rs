//! Random sequences of user actions and engine failures.

use std::time::Instant;

use flipmap_engine::Engine;
use flipmap_engine::mock::MockEngine;
use flipmap_numbers::{Exact, Scalar};
use flipmap_render::tiles::cache::TILE_BYTES;
use flipmap_render::tiles::explorer::Explorer;
use flipmap_render::tiles::view_target::ViewTarget;
use flipmap_scene::lattice::side_rad;
use proptest::prelude::*;

use super::common::*;
use super::ledger::Ledger;

/// An action of the user, or an event of the engine.
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

/// An explorer, its engine, and its current view target.
struct Session {
    explorer: Explorer,
    engine: Ledger,
    target: ViewTarget,
}

impl Session {
    fn new(cache_bytes: usize, backwards: bool, job_size: usize) -> Self {
        let engine = Ledger::over(MockEngine { backwards, job_size, ..MockEngine::default() });
        Session { explorer: Explorer::new(cache_bytes), engine, target: lively(3) }
    }

    fn look(&mut self, change: impl FnOnce(&mut ViewTarget)) {
        change(&mut self.target);
        let half = 0.7 * side_rad(self.target.level);
        self.target.region.half_rad = [half, 0.8 * half];
        self.explorer.target(&self.target);
    }

    /// Lets the explorer work; a failed engine is replaced, as the window does.
    fn work(&mut self, deadline: Option<Instant>) {
        if self.explorer.work(&mut self.engine, deadline).is_err() {
            self.engine.cancel();
            self.engine.mock.fail_at = None;
            self.explorer.ground();
        }
    }

    fn act(&mut self, action: &Action) {
        let side = side_rad(self.target.level);
        match *action {
            Action::Pan(by) => self.look(|target| {
                let center = target.region.center;
                target.region.center =
                    [0, 1].map(|i| (center[i] + Exact::from_f64(by[i] * side)).wrapped());
            }),
            Action::Zoom(by) => {
                // Deeper views are followed as cells, which keep no integrator states.
                self.look(|target| target.level = target.level.saturating_add_signed(by).min(16));
            }
            Action::Jump(to, level) => self.look(|target| {
                (target.region.center, target.level) = (to.map(Exact::from_f64), level);
            }),
            Action::Gravity(gravity) => self.look(|target| target.physics = physics(gravity)),
            Action::Budget(secs) => self.look(|target| target.budget_secs = secs),
            Action::Point(at) => self.look(|target| target.pointer = Some(at.map(|by| by * side))),
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

    /// Checks that every cell in view is known and right.
    fn check_view(&mut self) -> Result<(), TestCaseError> {
        let progress = self.explorer.progress();
        prop_assert!(progress.idle && progress.covered, "{progress:?}");
        prop_assert_eq!(progress.done, progress.wanted);
        for cell in in_view(&self.target) {
            prop_assert_eq!(wrong(&mut self.explorer, &self.target, cell), Some(0), "{:?}", cell);
        }
        Ok(())
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    #[test]
    fn nothing_is_lost_or_done_twice(actions in actions(), backwards: bool, large: bool) {
        let mut session = Session::new(ROOMY, backwards, if large { 1 << 18 } else { 64 });
        session.explorer.target(&session.target);
        for action in &actions {
            session.act(action);
        }
        session.work(None);
        session.check_view()?;
        let Session { explorer, engine, .. } = session;
        prop_assert_eq!((engine.again, engine.doubled), (0, 0));
        prop_assert_eq!(explorer.counts().simulated, engine.mock.answered as u64);
        prop_assert!(engine.mock.max_in_flight <= engine.slots());
    }

    #[test]
    fn the_cache_stays_within_its_bytes(
        actions in actions(), room in 0usize..60, then in 0usize..60, backwards: bool,
    ) {
        let mut session = Session::new(room * TILE_BYTES, backwards, 64);
        session.explorer.target(&session.target);
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
        // At most 4 cells that reach beyond the view, and 3 × 3 in it.
        if then >= 13 && room >= 13 {
            session.check_view()?;
        }
        for cell in in_view(&session.target) {
            let wrong = wrong(&mut session.explorer, &session.target, cell);
            prop_assert!(wrong.is_none_or(|wrong| wrong == 0), "{cell:?} {wrong:?}");
        }
    }
}

/// A cell has one budget, so that a pass never mixes states of 45 s with those of 20 s.
#[test]
fn a_budget_that_is_lowered_between_two_passes_and_raised_again_completes_the_view() {
    use Action::{Budget, Frames};
    for (backwards, job_size) in [(false, 1 << 18), (true, 1 << 18), (false, 64)] {
        let mut session = Session::new(ROOMY, backwards, job_size);
        session.explorer.target(&session.target);
        for action in [Budget(45.0), Frames(1), Budget(20.0), Frames(2), Budget(45.0)] {
            session.act(&action);
        }
        session.work(None);
        session.check_view().unwrap();
    }
}
