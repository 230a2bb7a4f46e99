//! When a window keeps its settings and the keys of its film.

use std::time::{Duration, Instant};

use super::film_draft::FilmForm;
use super::model::AppModel;
use super::settings::{Appearance, Settings};
use super::state::AppState;

/// The settings that were last saved, and when.
pub(super) struct LastSave {
    settings: Option<Settings>,
    at: Instant,
}

impl LastSave {
    /// Returns the state of a window that has saved nothing yet.
    pub(super) fn none() -> Self {
        LastSave { settings: None, at: Instant::now() }
    }
}

/// Time between saves of the settings while the window moves, since writing can disturb a frame.
const SAVE_EVERY: Duration = Duration::from_secs(20);
/// Time between saves while the window is at rest.
const SAVE_AT_REST_EVERY: Duration = Duration::from_secs(1);

impl AppModel {
    /// Saves the settings, including how the window was left, and the keys of its film. Returns a
    /// sentence if that fails for the first time.
    pub fn save(&mut self) -> Option<String> {
        self.gather_settings();
        self.saved.at = Instant::now();
        let kept_film = self.kept_keys.save(&self.films.draft);
        let kept = match self.saved.settings.as_ref() == Some(&self.settings) {
            true => Ok(()),
            false => self.store.save(&self.settings),
        };
        self.saved.settings = Some(self.settings.clone());
        match kept.and(kept_film) {
            Ok(told) => {
                told.into_iter().for_each(|told| self.state.notices.tell(told));
                None
            }
            Err(error) => self
                .store
                .complains_first()
                .then(|| format!("Settings and the keys of films cannot be kept: {error}.")),
        }
    }

    /// Takes into the settings how the window looks now.
    fn gather_settings(&mut self) {
        let AppState { look, layers, shown, .. } = &self.state;
        let Appearance { animate, theme, ui_scale, edges } = *look;
        let greeted = self.settings.greeted || !shown.greeting;
        let film = FilmForm::of(&self.films.draft);
        let (layers, settings) = (*layers, self.settings.clone());
        self.settings =
            Settings { animate, theme, ui_scale, edges, layers, greeted, film, ..settings };
        self.settings.last_scene = Some(self.state.document());
    }

    /// Saves while the window moves, if the last save is some time ago, so that a crash loses little.
    pub(crate) fn save_sometimes(&mut self) {
        if self.saved.at.elapsed() > SAVE_EVERY {
            self.save_and_tell();
        }
    }

    /// Saves at rest what has changed. Returns the moment at which it is to be called again, if
    /// the last save is too recent.
    pub(crate) fn save_at_rest(&mut self) -> Option<Instant> {
        self.gather_settings();
        let is_saved = self.saved.settings.as_ref() == Some(&self.settings)
            && self.kept_keys.holds(&self.films.draft);
        if is_saved || !self.store.keeps() {
            return None;
        }
        let next = self.saved.at + SAVE_AT_REST_EVERY;
        if next > Instant::now() {
            return Some(next);
        }
        self.save_and_tell();
        None
    }

    fn save_and_tell(&mut self) {
        if let Some(problem) = self.save() {
            self.state.notices.fail(problem);
        }
    }
}
