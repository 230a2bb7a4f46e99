//! Automatic budgets of the window's views, settled in the background: a deep one takes seconds.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use super::camera::Camera;
use super::compute_service::Wake;
use super::model::AppModel;
use crate::scene::{Budget, Build, Scene};

/// The automatic budget of the newest view.
#[derive(Default)]
pub(super) struct AutoBudget {
    asked: Option<(Build, Camera)>,
    settling: Option<Receiver<Budget>>,
}

impl AutoBudget {
    /// Asks for the budget of a view, unless it is the one last asked for or another is being
    /// settled; `scene` is its scene.
    fn ask(&mut self, view: (Build, Camera), scene: impl FnOnce() -> Scene, wake: &Wake) {
        if self.asked == Some(view) || self.settling.is_some() {
            return;
        }
        self.asked = Some(view);
        let (sender, settling) = channel();
        self.settling = Some(settling);
        let (scene, wake) = (scene(), Arc::clone(wake));
        std::thread::spawn(move || {
            super::compute_service::step_back();
            // The receiver is gone once the budget has been fixed by hand.
            let _ = sender.send(scene.settled().question.budget);
            wake();
        });
    }

    /// Takes a budget that has been settled.
    fn listen(&mut self) -> Option<Budget> {
        let heard = self.settling.as_ref()?.try_recv();
        if heard != Err(TryRecvError::Empty) {
            self.settling = None;
        }
        heard.ok()
    }
}

impl AppModel {
    /// Fits an automatic budget to the view, or to that at the end of a move. Returns true if the budget has changed.
    pub(super) fn settle_budget(&mut self) -> bool {
        let state = &self.state;
        if !state.question.budget.auto {
            self.estimates.auto_budget = AutoBudget::default();
            return false;
        }
        if !state.dragging {
            let view = (state.build, state.target());
            self.estimates.auto_budget.ask(view, || state.document().scene(), &self.wake);
        }
        let Some(budget) = self.estimates.auto_budget.listen() else { return false };
        let news = budget != state.question.budget;
        self.state.question.budget = budget;
        news
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::View;
    use std::time::Duration;

    #[test]
    fn one_view_is_settled_at_a_time_and_none_twice() {
        let (sender, woken) = channel();
        let wake: Wake = Arc::new(move || {
            let _ = sender.send(());
        });
        let mut budget = AutoBudget::default();
        let center = ["1.1867310027236805013017550390625", "2.0440255543056208421702266796875"];
        let view = |width: &str| View {
            center: center.map(str::to_string),
            width: width.to_string(),
            ..View::default()
        };
        let ask = |budget: &mut AutoBudget, width: &str| {
            let mut scene = Scene { view: view(width), ..Scene::default() };
            scene.question.budget.auto = true;
            let camera = Camera::from_view(&scene.view);
            budget.ask((scene.build, camera), || scene, &wake);
        };
        ask(&mut budget, "2e-22");
        ask(&mut budget, "2e-18");
        woken.recv_timeout(Duration::from_secs(60)).unwrap();
        assert_eq!(budget.listen().unwrap().secs, 65.0, "the first one that was asked for");
        ask(&mut budget, "2e-22");
        assert!(budget.listen().is_none(), "asked twice, settled once");
        ask(&mut budget, "2e-18");
        woken.recv_timeout(Duration::from_secs(60)).unwrap();
        assert_eq!(budget.listen().unwrap().secs, 55.0);
    }
}
