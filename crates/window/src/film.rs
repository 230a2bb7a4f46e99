//! Films in the window: planned view by view, previewed on the map, and made in the background.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::action::{Action, Look};
use super::camera::Camera;
use super::dialog::FileDialog;
use super::export::Export;
use super::film_run::FilmRequest;
use super::model::{AppModel, Asking};
use super::panels::film::FilmAction;
use super::reach::Reach;
use flipmap_scene::{Scene, View};

impl AppModel {
    /// Carries out an action of the film panel; returns the action for the map, if any.
    pub(super) fn film(&mut self, action: FilmAction) -> Option<Action> {
        let done = match action {
            FilmAction::Add => {
                self.films.draft.add(self.state.document());
                Ok(())
            }
            FilmAction::Change(draft) => {
                self.films.draft = *draft;
                Ok(())
            }
            FilmAction::Preview(clock) => {
                self.films.draft.clock = clock;
                return self.previewed();
            }
            FilmAction::Go(place) => {
                let document = self.films.draft.keys.get(place)?.scene.clone();
                return Some(Action::Show(Box::new(document)));
            }
            FilmAction::OpenKeys => self.films.draft.open_keys(),
            FilmAction::SaveKeys => self.films.draft.save_keys().map(|()| {
                self.state.notices.tell(format!("The keys are in {}.", self.films.draft.keys_path));
            }),
            FilmAction::Browse => {
                let wake = Arc::clone(&self.wake);
                let path: &Path = self.films.draft.path.as_ref();
                self.asking = Some(Asking::Film(FileDialog::save("mp4", path, move || wake())));
                Ok(())
            }
            FilmAction::Start => self.start_film(),
            FilmAction::Export(action) => {
                self.export(action);
                Ok(())
            }
        };
        if let Err(problem) = done {
            self.state.notices.fail(problem);
        }
        None
    }

    fn start_film(&mut self) -> Result<(), String> {
        let Some(command) = self.films.command else {
            return Err("This window cannot make films; save the keys for flipmap video.".into());
        };
        let path = PathBuf::from(&self.films.draft.path);
        if self.is_busy(&path) {
            return Ok(());
        }
        let draft = &self.films.draft;
        let (keys, size, fps) = (draft.text(), draft.size, draft.fps);
        let request = FilmRequest { command, keys, size, fps, path };
        let wake = Arc::clone(&self.wake);
        self.exports.push(Export::start_film(request, self.engine_request(), move || wake()));
        Ok(())
    }

    /// Advances the preview, if it plays; returns the action for the map, if any.
    pub(super) fn play_film(&mut self, ctx: &egui::Context) -> Option<Action> {
        if !self.films.draft.clock.is_playing() {
            return None;
        }
        ctx.request_repaint();
        let elapsed_secs = f64::from(ctx.input(|input| input.stable_dt).min(MAX_FRAME_SECS));
        let end_secs = self.films.draft.secs();
        self.films.draft.clock.advance(elapsed_secs, end_secs, true);
        self.previewed()
    }

    /// Moves the camera to the preview's moment of the film. Returns an action if anything but the
    /// view differs.
    fn previewed(&mut self) -> Option<Action> {
        let scene = self.films.draft.scene()?;
        let asked = Scene { view: View::default(), ..scene.clone() };
        let differs = asked != self.state.scene();
        let reach = Reach::of(&scene);
        self.state.jump(Camera::from_view(&scene.view, reach), self.films.draft.clock.is_playing());
        differs.then(|| Action::Scene(Box::new(asked)))
    }

    /// Pauses the preview if the user moves the view or shows something else.
    pub(super) fn pause_film_for(&mut self, action: &Action) {
        let moves = matches!(action, Action::Look(look) if *look != Look::Release);
        if moves || matches!(action, Action::Escape | Action::Show(_) | Action::GoDeeper) {
            self.films.draft.clock.pause();
        }
    }
}

/// Longest time in s by which a frame advances the preview, so that a stalled window skips nothing.
const MAX_FRAME_SECS: f32 = 0.2;
