//! Automatic budgets of the window's views, settled in the background because a deep view's takes
//! seconds.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use super::compute_service::Wake;
use super::state::AppState;
use flipmap_scene::{Budget, PendulumSpec, QuestionSettings, Scene};
use flipmap_screen::camera::Camera;

/// Returns a scene's question. Its budget is made automatic if it equals the guess for the scene's
/// view.
pub(super) fn following(scene: &Scene) -> QuestionSettings {
    let budget = scene.question.budget;
    let guess = Budget { auto: true, ..budget }.guessed(&scene.build, &scene.view);
    let auto = budget.auto || guess.secs == budget.secs;
    QuestionSettings { budget: Budget { auto, ..budget }, ..scene.question }
}

/// The automatic budget of the newest view.
#[derive(Default)]
pub(super) struct AutoBudget {
    asked: Option<(PendulumSpec, Camera)>,
    settling: Option<Receiver<Budget>>,
    settled: Option<Budget>,
    /// The view whose budget was applied last, and its seconds.
    reached: Option<((PendulumSpec, Camera), f64)>,
}

impl AutoBudget {
    /// Fits an automatic budget to the view, or to the view at the end of a move. Returns true if
    /// the budget has changed.
    pub(super) fn fit(&mut self, state: &mut AppState, wake: &Wake) -> bool {
        // Only flips from rest get a longer budget where the view is deeper.
        if !state.question.budget.auto || !state.scene().is_flip_from_rest() {
            *self = AutoBudget::default();
            return false;
        }
        let view = (state.build, state.target());
        if !state.dragging {
            self.ask(view, || state.document().scene(), wake);
        }
        let heard = self.listen();
        let Some(budget) = heard.or(self.of(view)) else { return false };
        let budget = self.on_the_way_down(view, budget);
        let news = budget != state.question.budget;
        state.question.budget = budget;
        news
    }

    /// Returns the budget of a view, but at least that of the view before if this one lies in it:
    /// otherwise pixels seen on the way down would lose their flips and change their colours.
    fn on_the_way_down(&mut self, view: (PendulumSpec, Camera), budget: Budget) -> Budget {
        let (build, camera) = view;
        let lies_in = |before: &(PendulumSpec, Camera)| {
            let (of, outer) = before;
            let away = outer.offset_of(camera.center).length();
            *of == build && camera.width_rad <= outer.width_rad && away <= outer.width_rad
        };
        let least_secs = self.reached.filter(|(before, _)| lies_in(before)).map(|(_, secs)| secs);
        let secs = least_secs.map_or(budget.secs, |least| budget.secs.max(least));
        self.reached = Some((view, secs));
        Budget { secs, ..budget }
    }

    /// Starts to settle the budget of a view from its `scene`, unless the view was the last one
    /// asked for or another is being settled.
    fn ask(&mut self, view: (PendulumSpec, Camera), scene: impl FnOnce() -> Scene, wake: &Wake) {
        if self.asked == Some(view) || self.settling.is_some() {
            return;
        }
        (self.asked, self.settled) = (Some(view), None);
        let (sender, settling) = channel();
        self.settling = Some(settling);
        let (scene, wake) = (scene(), Arc::clone(wake));
        std::thread::spawn(move || {
            super::compute_service::lower_priority();
            // The receiver is gone once the budget has been fixed by hand.
            let _ = sender.send(scene.settled().question.budget);
            wake();
        });
    }

    /// Takes and returns a budget that has been settled since the last call.
    fn listen(&mut self) -> Option<Budget> {
        let heard = self.settling.as_ref()?.try_recv();
        if heard != Err(TryRecvError::Empty) {
            self.settling = None;
        }
        self.settled = heard.ok().or(self.settled);
        heard.ok()
    }

    /// Returns the settled budget of a view, if it is the one last asked for.
    fn of(&self, view: (PendulumSpec, Camera)) -> Option<Budget> {
        self.settled.filter(|_| self.asked == Some(view))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute_service::woken;
    use flipmap_scene::View;
    use flipmap_screen::reach::Reach;
    use std::time::Duration;

    #[test]
    fn a_budget_never_shrinks_on_the_way_down() {
        let mut budget = AutoBudget::default();
        let whole = Camera::whole(Reach::TORUS);
        let mut applied = |width_rad: f64, secs: f64| {
            let view = (PendulumSpec::default(), Camera { width_rad, ..whole });
            budget.on_the_way_down(view, Budget { secs, auto: true }).secs
        };
        let down = [(6.0, 30.0), (0.1, 50.0), (0.1, 50.0), (1e-3, 30.0), (1e-5, 35.0)];
        assert_eq!(down.map(|(width, secs)| applied(width, secs)), [30.0, 50.0, 50.0, 50.0, 50.0]);
        assert_eq!(applied(1e-7, 65.0), 65.0);
        assert_eq!(applied(1e-2, 40.0), 40.0, "wider again");
    }

    #[test]
    fn one_view_is_settled_at_a_time_and_none_twice() {
        let (wake, woken) = woken();
        let mut budget = AutoBudget::default();
        let center = ["1.1867310027236805013017550390625", "2.0440255543056208421702266796875"];
        let view = |width: &str| View {
            center: center.map(str::to_string),
            width: width.to_string(),
            ..View::default()
        };
        let key =
            |width: &str| (PendulumSpec::default(), Camera::from_view(&view(width), Reach::TORUS));
        let ask = |budget: &mut AutoBudget, width: &str| {
            let mut scene = Scene { view: view(width), ..Scene::default() };
            scene.question.budget.auto = true;
            budget.ask(key(width), || scene, &wake);
        };
        ask(&mut budget, "2e-22");
        ask(&mut budget, "2e-18");
        woken.recv_timeout(Duration::from_secs(60)).unwrap();
        assert_eq!(budget.listen().unwrap().secs, 65.0, "the first one that was asked for");
        ask(&mut budget, "2e-22");
        assert!(budget.listen().is_none(), "asked twice, settled once");
        assert_eq!(budget.of(key("2e-22")).unwrap().secs, 65.0, "it is not forgotten");
        assert!(budget.of(key("2e-18")).is_none());
        ask(&mut budget, "2e-18");
        woken.recv_timeout(Duration::from_secs(60)).unwrap();
        assert_eq!(budget.listen().unwrap().secs, 55.0);
    }
}
