//! Automatic descents: a background thread goes deeper and deeper, and the window follows.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::SyncSender;

use super::action::{Action, Look};
use super::background_work::BackgroundWork;
use super::compute_service::Wake;
use super::dive::DivePace;
use super::film::Films;
use super::panels::descent::DescentAction;
use super::state::AppState;
use flipmap_engine::choice::{ChoiceError, EngineRequest, choose};
use flipmap_engine::{EngineError, EngineKind};
use flipmap_render::tiles::descent::{Descent, DescentStep};
use flipmap_render::tiles::view_target::ViewTarget;
use flipmap_scene::{Budget, Scene};
use flipmap_screen::camera::Camera;
use flipmap_screen::reach::Reach;

/// Number of views that a descent is ahead of the window, so that the window never waits for one.
const AHEAD: usize = 3;
/// Levels by which views that a dive passes are drawn coarser than in full: the first one, and at
/// most.
const FIRST_COARSER: u32 = 2;
const MOST_COARSER: u32 = 4;

/// A descent on a thread with an engine of its own. Dropping it stops the descent.
#[derive(Debug)]
pub struct BackgroundDescent(BackgroundWork<DescentNews>);

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
        // The descent waits for the window: it computes a few views ahead and no more.
        BackgroundDescent(BackgroundWork::start(AHEAD, move |sender, stop| {
            // The pictures are small: opening a graphics card would take longer.
            let engine = EngineRequest { kind: Some(EngineKind::Cpu), adapter: None, ..engine };
            let why = match descent(scene, towards, &engine, stop, (sender, &wake)) {
                Ok(()) => "There is no structure nearby, so the zoom ends here.".to_string(),
                Err(error) => format!("The descent ended: {error}."),
            };
            // Sending fails if the descent was stopped: its receiver is gone.
            let _ = sender.send(DescentNews::Over(why));
            wake();
        }))
    }

    /// Returns the next message of the descent, if there is one.
    pub(crate) fn news(&self) -> Option<DescentNews> {
        self.0.news()
    }
}

/// A descent and the views it has found, as a window keeps them.
#[derive(Debug, Default)]
pub struct DescentPath {
    /// Descent that is still running, if any.
    pub running: Option<BackgroundDescent>,
    /// Views found so far, starting with the one where the descent began.
    pub scenes: Vec<Scene>,
    /// Pace of the camera from one view to the next.
    pub pace: DivePace,
    /// Number of levels by which the view that is approached is drawn coarser than in full.
    coarser: u32,
}

impl DescentPath {
    /// Returns the target for a view. Views that a dive passes are drawn at half the resolution or
    /// less, so that they are complete in time; those where it rests, in full.
    pub fn passing(&self, target: ViewTarget) -> ViewTarget {
        let passes = self.running.is_some() && self.scenes.len() > 1 && !self.pace.is_paused;
        let levels = if passes { self.coarser } else { 0 };
        (0..levels).fold(target, |target, _| target.coarser())
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
        if self.descent.running.is_some() {
            self.stop_dive(state);
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
        self.descent.pace.is_paused = false;
        let request = EngineRequest { setting: state.integration.spec.setting, ..request.clone() };
        self.descent.running =
            Some(BackgroundDescent::start(scene, towards, request, Arc::clone(wake)));
    }

    /// Stops a running descent where the camera is, and offers its views as a film.
    pub(super) fn stop_dive(&mut self, state: &mut AppState) {
        if self.descent.running.take().is_some() {
            state.stay();
            if self.offer_film(state) {
                state.notices.tell("The Film panel now has the dive as a film.");
            }
        }
    }

    /// Makes a running dive faster or slower by a factor; returns false if there is none.
    pub(super) fn quicken_dive(&mut self, state: &mut AppState, factor: f64) -> bool {
        let dives = self.descent.running.is_some();
        if dives {
            self.descent.pace.quicken(factor);
            if let Some(moving) = state.moving {
                let pace = self.descent.pace.between(&state.camera, &moving.to, 1.0);
                state.glide(moving.to, pace);
            }
        }
        dives
    }

    /// Pauses a running dive or lets it go on; returns false if there is none.
    pub(super) fn pause_dive(&mut self, state: &mut AppState) -> bool {
        let dives = self.descent.running.is_some();
        if dives {
            self.descent.pace.is_paused ^= true;
            match self.descent.pace.is_paused {
                true => state.stay(),
                false => self.go_on(state),
            }
        }
        dives
    }

    /// Goes on to the view that a paused dive was approaching.
    fn go_on(&self, state: &mut AppState) {
        let Some(scene) = self.descent.scenes.last() else { return };
        let to = Camera::from_view(&scene.view, Reach::TORUS);
        if to.width_rad < state.camera.width_rad {
            state.glide(to, self.descent.pace.between(&state.camera, &to, 1.0));
        }
    }

    /// Glides to a view of the descent, while `share` of the view before is drawn: more coarsely than
    /// that one if it was not half drawn in time, more finely if it was complete.
    fn approach(&mut self, state: &mut AppState, to: Camera, share: f64) {
        let pace = self.descent.pace.between(&state.camera, &to, share);
        let before = self.descent.coarser;
        self.descent.coarser = match share {
            _ if self.descent.scenes.len() < 2 => FIRST_COARSER,
            share if share < 0.5 => (before + 1).min(MOST_COARSER),
            1.0 => (before - 1).max(1),
            _ => before,
        };
        state.glide(to, pace);
    }

    /// Follows the running descent: once its last view has been reached, the camera goes on to the
    /// next one, at a pace that depends on the `share` of the last view that is drawn. Returns true
    /// if the descent had news.
    pub(super) fn follow_descent(&mut self, state: &mut AppState, share: f64) -> bool {
        // The first view is drawn before it is left, and without moves each is.
        let waits = self.descent.scenes.len() < 2 || !state.look.animate;
        if state.moving.is_some() || self.descent.pace.is_paused || (waits && share < 0.5) {
            return false;
        }
        let Some(news) = self.descent.running.as_ref().and_then(BackgroundDescent::news) else {
            return false;
        };
        match news {
            DescentNews::To(scene) => {
                // The descent has settled it; on the way, the window settles none.
                let secs = scene.question.budget.secs.max(state.question.budget.secs);
                state.question.budget = Budget { secs, ..scene.question.budget };
                self.approach(state, Camera::from_view(&scene.view, Reach::TORUS), share);
                self.descent.scenes.push(*scene);
            }
            DescentNews::Over(why) => {
                self.descent.running = None;
                state.stay();
                let offers = self.offer_film(state);
                let offer = if offers { " The Film panel now has the dive as a film." } else { "" };
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
    fn offer_film(&mut self, state: &AppState) -> bool {
        let is_free = self.draft.keys.is_empty() || self.draft.of_descent;
        if self.descent.scenes.len() < 2 || !is_free {
            return false;
        }
        self.draft_descent(state);
        true
    }

    /// Makes the views of the descent, in the colours that are shown, the keys of a film.
    fn draft_descent(&mut self, state: &AppState) {
        let shown = state.document();
        let scenes = self.descent.scenes.iter().cloned();
        self.draft.take_descent(scenes.map(|scene| shown.clone().with_scene(scene)));
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
