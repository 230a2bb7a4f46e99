//! Films in the window: planned view by view, previewed on the map, and made in the background.

use std::path::PathBuf;

use super::action::{Action, Look};
use super::descent::DescentPath;
use super::film_draft::FilmDraft;
use super::film_run::{FilmCommand, FilmRequest};
use super::state::AppState;
use flipmap_scene::{Scene, View};
use flipmap_screen::camera::Camera;
use flipmap_screen::reach::Reach;

/// Films in a window, and the descent that may become one.
#[derive(Debug, Default)]
pub struct Films {
    /// Film that is being planned.
    pub draft: FilmDraft,
    /// Command that makes films, if the window has one.
    pub(super) command: Option<FilmCommand>,
    /// Descent that is running, or the views of the last one.
    pub descent: DescentPath,
}

impl Films {
    /// Returns the request for the film that is planned, or a sentence that says why there is none.
    pub(super) fn request(&self) -> Result<FilmRequest, String> {
        let Some(command) = self.command else {
            return Err("This window cannot make films; save the keys for flipmap video.".into());
        };
        let draft = &self.draft;
        let (keys, path) = (draft.text(), PathBuf::from(&draft.path));
        Ok(FilmRequest { command, keys, size: draft.size, fps: draft.fps, path })
    }

    /// Advances the preview, if it plays; returns the action for the map, if any.
    pub(super) fn play(&mut self, ctx: &egui::Context, state: &mut AppState) -> Option<Action> {
        if !self.draft.clock.is_playing() {
            return None;
        }
        ctx.request_repaint();
        let elapsed_secs = f64::from(ctx.input(|input| input.stable_dt).min(MAX_FRAME_SECS));
        let end_secs = self.draft.secs();
        self.draft.clock.advance(elapsed_secs, end_secs, true);
        self.previewed(state)
    }

    /// Moves the camera to the preview's moment of the film. Returns an action if anything but the
    /// view differs.
    pub(super) fn previewed(&self, state: &mut AppState) -> Option<Action> {
        let scene = self.draft.scene()?;
        let asked = Scene { view: View::default(), ..scene.clone() };
        let differs = asked != state.scene();
        let reach = Reach::of(&scene);
        state.jump(Camera::from_view(&scene.view, reach), self.draft.clock.is_playing());
        differs.then(|| Action::Scene(Box::new(asked)))
    }

    /// Stops the descent where it is and pauses the preview if the user looks elsewhere.
    pub(super) fn give_way_to(&mut self, action: &Action, state: &mut AppState) {
        let leaves = match action {
            Action::Look(look) => *look != Look::Release,
            Action::Escape | Action::Show(_) | Action::Visit(_) | Action::FromLab(_) => true,
            _ => false,
        };
        if leaves || matches!(action, Action::Scene(_)) {
            self.stop_dive(state);
        }
        if leaves || matches!(action, Action::GoDeeper) {
            self.draft.clock.pause();
        }
    }
}

/// Longest time in s by which a frame advances the preview, so that a stalled window skips nothing.
const MAX_FRAME_SECS: f32 = 0.2;
