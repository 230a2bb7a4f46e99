//! Automatic descents: a background thread goes deeper and deeper, and the window follows.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use super::action::{Action, Look};
use super::camera::Camera;
use super::compute_service::{Wake, lower_priority};
use super::film::Films;
use super::panels::descent::DescentAction;
use super::reach::Reach;
use super::state::AppState;
use flipmap_engine::choice::{ChoiceError, EngineRequest, choose};
use flipmap_engine::{EngineError, EngineKind};
use flipmap_render::tiles::descent::{Descent, DescentStep};
use flipmap_render::tiles::view_target::ViewTarget;
use flipmap_scene::Scene;

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

impl Films {
    /// Starts a descent towards the pointer, or towards the middle without one; stops a running
    /// descent.
    pub(super) fn toggle_descent(
        &mut self,
        state: &mut AppState,
        request: &EngineRequest,
        wake: &Wake,
    ) {
        if self.descent.running.take().is_some() {
            return;
        }
        if let Err(error) = state.scene().require_flip_from_rest() {
            state.notices.fail(format!("Nothing leads deeper here: {error}."));
            return;
        }
        let screen = state.screen();
        let pointer = state.pointer.unwrap_or_default();
        let towards = (screen.offset_at(pointer) / screen.camera.width_rad).to_array();
        // Deep places show nothing unless the budget grows with the depth.
        state.question.budget.auto = true;
        let scene = state.document().scene();
        self.descent.scenes = vec![scene.clone()];
        let request = EngineRequest { setting: state.integration.spec.setting, ..request.clone() };
        self.descent.running =
            Some(BackgroundDescent::start(scene, towards, request, Arc::clone(wake)));
    }

    /// Follows the running descent once its last view has been reached and half of it is drawn:
    /// `share` says how much is. Returns true if the descent had news.
    pub(super) fn follow_descent(&mut self, state: &mut AppState, share: f64) -> bool {
        if state.moving.is_some() || share < 0.5 {
            return false;
        }
        let Some(news) = self.descent.running.as_ref().and_then(BackgroundDescent::news) else {
            return false;
        };
        match news {
            DescentNews::To(scene) => {
                state.glide(Camera::from_view(&scene.view, Reach::TORUS));
                self.descent.scenes.push(*scene);
            }
            DescentNews::Over(why) => {
                self.descent.running = None;
                let offers = self.offer_film(state);
                let offer =
                    if offers { " The Film panel now has the descent as a film." } else { "" };
                state.notices.tell(format!("{why}{offer}"));
            }
        }
        true
    }

    /// Carries out an action of the panel of descents; returns the action for the map, if any.
    pub(super) fn deeper(&mut self, action: DescentAction, state: &AppState) -> Option<Action> {
        match action {
            DescentAction::Toggle => Some(Action::GoDeeper),
            DescentAction::Open(k) => {
                let scene = self.descent.scenes.get(k)?;
                Some(Action::Look(Look::To(Camera::from_view(&scene.view, Reach::TORUS))))
            }
            DescentAction::Film => {
                self.draft_descent(state);
                Some(Action::Panel("Film"))
            }
        }
    }

    /// Offers the views of a descent as a film, unless the user has begun another film. Returns
    /// true if it did.
    fn offer_film(&mut self, state: &mut AppState) -> bool {
        let is_free = self.draft.keys.is_empty() || self.draft.of_descent;
        if self.descent.scenes.len() < 2 || !is_free {
            return false;
        }
        self.draft_descent(state);
        state.open_panel("Film");
        true
    }

    /// Makes the views of the descent, in the colours that are shown, the keys of a film.
    fn draft_descent(&mut self, state: &AppState) {
        let shown = state.document();
        let scenes = self.descent.scenes.iter().cloned();
        self.draft.take_descent(scenes.map(|scene| shown.clone().with_scene(scene)));
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
