//! The history of what was shown, kept as a browser keeps pages.

use super::pin_marks::PinMark;
use super::state::AppState;
use flipmap_scene::{Budget, PendulumSpec, PictureTable, Plane, QuestionSettings, Scene};
use flipmap_screen::camera::Camera;

/// What is shown, as far as the history brings it back.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Snapshot {
    camera: Camera,
    build: PendulumSpec,
    /// The question; an automatic budget has no seconds, because it follows from the rest.
    question: QuestionSettings,
    plane: Plane,
    /// The colours, without times that follow from the view.
    picture: PictureTable,
    pins: Vec<PinMark>,
}

/// Visited snapshots, or whatever else, and the index of the one shown.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct History<T> {
    visited: Vec<T>,
    current: usize,
}

/// Largest number of snapshots remembered.
const MAX_VISITED: usize = 200;
/// Time in s within which changes that leave the view are one step of the history.
const ONE_STEP_SECS: f64 = 1.0;

impl<T: Clone + PartialEq> History<T> {
    /// Creates a history that begins here.
    pub(crate) fn new(first: T) -> Self {
        History { visited: vec![first], current: 0 }
    }

    /// Returns what is shown.
    pub(crate) fn current(&self) -> &T {
        &self.visited[self.current]
    }

    /// Returns the number of steps that lie behind.
    pub(crate) fn step(&self) -> usize {
        self.current
    }

    /// Records what is shown now, which erases what is ahead; with `merges`, in place of what was
    /// shown. A change that is taken back by the one that merges with it is no step.
    pub(crate) fn visit(&mut self, now: T, merges: bool) {
        if *self.current() == now {
            return;
        }
        self.visited.truncate(self.current + usize::from(!merges));
        if self.visited.last() != Some(&now) {
            self.visited.push(now);
        }
        if self.visited.len() > MAX_VISITED {
            self.visited.remove(0);
        }
        self.current = self.visited.len() - 1;
    }

    /// Goes one step back and returns what was shown there, if there is any.
    pub(crate) fn back(&mut self) -> Option<T> {
        self.current = self.current.checked_sub(1)?;
        Some(self.current().clone())
    }

    /// Goes forward to what was left by going back and returns it, if there is any.
    pub(crate) fn forward(&mut self) -> Option<T> {
        let ahead = self.visited.get(self.current + 1)?.clone();
        self.current += 1;
        Some(ahead)
    }

    /// Returns true if there is anything to go back to.
    pub(crate) fn has_back(&self) -> bool {
        self.current > 0
    }

    /// Returns true if there is anything left by going back.
    pub(crate) fn has_forward(&self) -> bool {
        self.current + 1 < self.visited.len()
    }
}

impl Snapshot {
    /// Returns the snapshot of a scene as a camera sees it, without pins.
    pub(crate) fn new(scene: &Scene, camera: Camera, mut picture: PictureTable) -> Self {
        let budget = scene.question.budget;
        let secs = if budget.auto { 0.0 } else { budget.secs };
        let question = QuestionSettings { budget: Budget { secs, ..budget }, ..scene.question };
        picture.forget_view_times();
        let (build, plane, pins) = (scene.build, scene.plane.clone(), Vec::new());
        Snapshot { camera, build, question, plane, picture, pins }
    }
}

impl History<Snapshot> {
    /// Replaces one view by another wherever it was visited.
    pub(crate) fn replace(&mut self, view: Camera, by: Camera) {
        let visited = self.visited.iter_mut().filter(|visited| visited.camera == view);
        visited.for_each(|visited| visited.camera = by);
    }
}

impl AppState {
    /// Returns what is shown.
    pub(super) fn snapshot(&self) -> Snapshot {
        let offset = if self.shown.cycle.runs { 0.0 } else { self.picture.offset };
        let picture = PictureTable { offset, ..self.picture.clone() };
        let pins = self.pins.marks();
        Snapshot { pins, ..Snapshot::new(&self.scene(), self.camera, picture) }
    }

    /// Records what is shown at rest. Changes in quick succession that leave the view, as while a
    /// slider is dragged, are one step.
    pub(super) fn record(&mut self) {
        let now = self.snapshot();
        let before = self.history.current();
        if now == *before {
            return;
        }
        let stays = now.camera == before.camera;
        let is_recent = |secs| self.now_secs - secs < ONE_STEP_SECS;
        let merges = stays && self.changed_secs.is_some_and(is_recent);
        self.changed_secs = stays.then_some(self.now_secs);
        self.history.visit(now, merges);
    }

    /// Shows again what the history holds, except its pins, whose flights need a waker.
    pub(super) fn restore(&mut self, then: Option<Snapshot>) {
        let Some(then) = then else { return };
        let Snapshot { camera, build, mut question, plane, picture, pins: _ } = then;
        if question.budget.auto {
            let budget = self.question.budget;
            question.budget.secs = budget.secs;
        }
        self.ask(&Scene { build, question, plane, ..Scene::default() });
        let offset = if self.shown.cycle.runs { self.picture.offset } else { picture.offset };
        self.picture = PictureTable { offset, ..picture };
        self.changed_secs = None;
        self.go(camera);
    }

    /// Removes the pin that the last click made, and its step.
    pub(super) fn take_back_pin(&mut self) {
        self.pins.remove_clicked();
        let now = self.snapshot();
        self.history.visit(now, true);
    }

    /// Brings back the pins that belong to what the history shows.
    pub(super) fn restore_pins(&mut self, wake: impl Fn() + Clone + Send + 'static) {
        self.pins.restore(&self.history.current().pins, wake);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::tests::state;
    use flipmap_scene::question::QuestionName;
    use proptest::prelude::*;

    proptest! {
        /// Compares the history with the plainest model: two stacks.
        #[test]
        fn it_is_two_stacks(steps in prop::collection::vec(0u8..4, 0..120)) {
            let mut history = History::new(0.0);
            let (mut behind, mut here, mut ahead) = (vec![], 0.0, vec![]);
            for (k, step) in steps.into_iter().enumerate() {
                match step {
                    0 => match behind.pop() {
                        Some(width) => {
                            ahead.push(std::mem::replace(&mut here, width));
                            prop_assert_eq!(history.back(), Some(here));
                        }
                        None => prop_assert_eq!(history.back(), None),
                    },
                    1 => match ahead.pop() {
                        Some(width) => {
                            behind.push(std::mem::replace(&mut here, width));
                            prop_assert_eq!(history.forward(), Some(here));
                        }
                        None => prop_assert_eq!(history.forward(), None),
                    },
                    2 => history.visit(here, false),
                    _ => {
                        behind.push(std::mem::replace(&mut here, k as f64 + 1.0));
                        ahead.clear();
                        history.visit(here, false);
                    }
                }
                prop_assert_eq!(history.has_back(), !behind.is_empty());
                prop_assert_eq!(history.has_forward(), !ahead.is_empty());
            }
        }
    }

    #[test]
    fn the_oldest_are_forgotten() {
        let mut history = History::new(1);
        (2..1000).for_each(|k| history.visit(k, false));
        assert_eq!(std::iter::from_fn(|| history.back()).count(), MAX_VISITED - 1);
    }

    #[test]
    fn colours_questions_and_planes_come_back() {
        let mut state = state();
        state.look.animate = false;
        let mut secs = 0.0;
        let mut wait = |state: &mut AppState, pause_secs: f64| {
            secs += pause_secs;
            state.tick(secs);
        };
        wait(&mut state, 5.0);
        let home = state.snapshot();
        // A slider that is dragged is one step.
        for relief in [0.1, 0.2, 0.3] {
            state.paint(PictureTable { relief, ..state.picture.clone() });
            wait(&mut state, 0.1);
        }
        let relief = state.snapshot();
        wait(&mut state, 5.0);
        let mut scene = state.scene();
        scene.question.ask = QuestionName::Growth;
        state.ask(&scene);
        wait(&mut state, 5.0);
        scene.plane.kind = "speeds".parse().unwrap();
        state.ask(&scene);
        wait(&mut state, 5.0);
        let mut back = |state: &mut AppState| {
            let then = state.history.back();
            state.restore(then);
            wait(state, 5.0);
        };
        back(&mut state);
        assert_eq!((state.question.ask, state.plane.is_at_rest()), (QuestionName::Growth, true));
        back(&mut state);
        assert_eq!(state.snapshot(), relief);
        back(&mut state);
        assert_eq!(state.snapshot(), home);
        assert!(!state.history.has_back());
        for _ in 0..3 {
            let then = state.history.forward();
            state.restore(then);
        }
        assert!(!state.plane.is_at_rest() && state.picture.relief == 0.3);
    }
}
