//! Automatic descents: a background thread goes deeper and deeper, and the window follows.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use super::action::{Action, Look};
use super::camera::Camera;
use super::compute_service::{Wake, lower_priority};
use super::model::AppModel;
use super::panels::descent::DescentAction;
use super::reach::Reach;
use flipmap_engine::choice::{ChoiceError, EngineRequest, choose};
use flipmap_engine::{EngineError, EngineKind};
use flipmap_render::tiles::descent::{Descent, DescentStep};
use flipmap_render::tiles::explorer::ViewProgress;
use flipmap_render::tiles::view_target::ViewTarget;
use flipmap_scene::{Document, Scene};

/// A descent on a thread with an engine of its own. Dropping it stops the descent.
#[derive(Debug)]
pub struct BackgroundDescent {
    news: Receiver<DescentNews>,
    stopped: Arc<AtomicBool>,
}

/// A message from a descent.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum DescentNews {
    /// The next view.
    To(Box<Scene>),
    /// The end of the descent, with its reason.
    Over(String),
}

#[derive(Debug, thiserror::Error)]
enum DescentError {
    #[error(transparent)]
    Choice(#[from] ChoiceError),
    #[error(transparent)]
    Engine(#[from] EngineError),
}

impl BackgroundDescent {
    /// Descends from a scene, at first towards a point `towards` widths from its middle.
    pub(crate) fn start(
        scene: Scene,
        towards: [f64; 2],
        engine: EngineRequest,
        wake: Wake,
    ) -> Self {
        // The descent waits for the window: it computes one view ahead and no more.
        let (sender, news) = sync_channel(1);
        let stopped = Arc::new(AtomicBool::new(false));
        let stop = Arc::clone(&stopped);
        std::thread::spawn(move || {
            lower_priority();
            // The pictures are small: opening a graphics card would take longer.
            let engine = EngineRequest { kind: Some(EngineKind::Cpu), adapter: None, ..engine };
            let why = match descent(scene, towards, &engine, &stop, (&sender, &wake)) {
                Ok(()) => "There is no structure nearby, so the zoom ends here.".to_string(),
                Err(error) => format!("The descent ended: {error}."),
            };
            // Sending fails if the descent was stopped: its receiver is gone.
            let _ = sender.send(DescentNews::Over(why));
            wake();
        });
        BackgroundDescent { news, stopped }
    }

    /// Returns the next message of the descent, if there is one.
    pub(crate) fn news(&self) -> Option<DescentNews> {
        self.news.try_recv().ok()
    }
}

/// A descent and the views it has found, as a window keeps them.
#[derive(Debug, Default)]
pub struct DescentPath {
    /// Descent that is still running, if any.
    pub running: Option<BackgroundDescent>,
    /// Views found so far, starting with the one where the descent began.
    pub scenes: Vec<Scene>,
}

impl DescentPath {
    /// Returns the target for a view. Views that a descent passes are drawn at half the resolution,
    /// because it waits until each is half drawn.
    pub fn passing(&self, target: ViewTarget) -> ViewTarget {
        let passes = self.running.is_some() && self.scenes.len() > 1;
        if passes { target.coarser() } else { target }
    }
}

impl AppModel {
    /// Starts a descent towards the pointer, or towards the middle without one; stops a running
    /// descent.
    pub(super) fn toggle_descent(&mut self) {
        if self.films.descent.running.take().is_some() {
            return;
        }
        if let Err(error) = self.state.scene().require_flip_from_rest() {
            self.state.notices.fail(format!("Nothing leads deeper here: {error}."));
            return;
        }
        let screen = self.state.screen();
        let pointer = self.state.pointer.unwrap_or_default();
        let towards = (screen.offset_at(pointer) / screen.camera.width_rad).to_array();
        // Deep places show nothing unless the budget grows with the depth.
        self.state.question.budget.auto = true;
        let scene = self.state.document().scene();
        self.films.descent.scenes = vec![scene.clone()];
        let request =
            EngineRequest { setting: self.state.integration.spec.setting, ..self.request.clone() };
        self.films.descent.running =
            Some(BackgroundDescent::start(scene, towards, request, Arc::clone(&self.wake)));
    }

    /// Follows the running descent once its last view has been reached and is half drawn. Returns
    /// true if the descent had news.
    pub(super) fn follow_descent(&mut self) -> bool {
        let ViewProgress { share, .. } = self.progress();
        if self.state.moving.is_some() || share < 0.5 {
            return false;
        }
        let Some(news) = self.films.descent.running.as_ref().and_then(BackgroundDescent::news)
        else {
            return false;
        };
        match news {
            DescentNews::To(scene) => {
                self.state.glide(Camera::from_view(&scene.view, Reach::TORUS));
                self.films.descent.scenes.push(*scene);
            }
            DescentNews::Over(why) => {
                self.films.descent.running = None;
                let offers = self.offer_film();
                let offer =
                    if offers { " The Film panel now has the descent as a film." } else { "" };
                self.state.notices.tell(format!("{why}{offer}"));
            }
        }
        true
    }

    /// Stops the descent if the user moves the view, changes the scene or closes something.
    pub(super) fn stop_descent_for(&mut self, action: &Action) {
        let moves = matches!(action, Action::Look(look) if *look != Look::Release);
        if moves || matches!(action, Action::Escape | Action::Show(_) | Action::Scene(_)) {
            self.films.descent.running = None;
        }
    }

    pub(super) fn deeper(&mut self, action: DescentAction) -> Option<Action> {
        match action {
            DescentAction::Toggle => Some(Action::GoDeeper),
            DescentAction::Open(k) => {
                let scene = self.films.descent.scenes.get(k)?;
                Some(Action::Look(Look::To(Camera::from_view(&scene.view, Reach::TORUS))))
            }
            DescentAction::Film => {
                self.films.draft.take_descent(self.descent_documents().into_iter());
                Some(Action::Panel("Film"))
            }
        }
    }

    /// Offers the views of a descent as a film, unless the user has begun another film. Returns
    /// true if it did.
    fn offer_film(&mut self) -> bool {
        let is_free = self.films.draft.keys.is_empty() || self.films.draft.of_descent;
        if self.films.descent.scenes.len() < 2 || !is_free {
            return false;
        }
        self.films.draft.take_descent(self.descent_documents().into_iter());
        (self.state.shown.side, self.state.shown.panel) = (true, Some("Film"));
        true
    }

    /// Returns the views of the descent in the colours that are shown.
    fn descent_documents(&self) -> Vec<Document> {
        let shown = self.state.document();
        let scenes = self.films.descent.scenes.iter().cloned();
        scenes.map(|scene| shown.clone().with_scene(scene)).collect()
    }
}

impl Drop for BackgroundDescent {
    fn drop(&mut self) {
        self.stopped.store(true, Ordering::Relaxed);
    }
}

fn descent(
    scene: Scene,
    towards: [f64; 2],
    engine: &EngineRequest,
    stop: &AtomicBool,
    (sender, wake): (&SyncSender<DescentNews>, &Wake),
) -> Result<(), DescentError> {
    let mut chosen = choose(engine, &|_| ())?;
    let mut descent = Descent::new(scene, chosen.config, towards);
    let keep_going = || !stop.load(Ordering::Relaxed);
    while let DescentStep::Scene(scene) = descent.next(chosen.engine.as_mut(), &keep_going)? {
        if sender.send(DescentNews::To(scene)).is_err() {
            break;
        }
        wake();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute_service::woken;
    use flipmap_scene::BuiltIn;
    use std::time::Duration;

    #[test]
    fn a_dive_goes_deeper_until_nobody_listens() {
        let scene = BuiltIn::named("filigree").unwrap().document().scene();
        let (wake, woken) = woken();
        let descent =
            BackgroundDescent::start(scene.clone(), [0.1, 0.0], EngineRequest::default(), wake);
        let mut widths = vec![scene.view.width_rad().hi];
        while widths.len() < 4 {
            woken.recv_timeout(Duration::from_secs(60)).unwrap();
            while let Some(DescentNews::To(scene)) = descent.news() {
                widths.push(scene.view.width_rad().hi);
            }
        }
        assert!(widths.windows(2).all(|pair| pair[1] < 0.4 * pair[0]), "{widths:?}");
        drop(descent);
        // Its thread drops the sender when it ends.
        while woken.recv_timeout(Duration::from_secs(60)).is_ok() {}
    }
}
