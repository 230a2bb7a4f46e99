//! Incoming scenes: from files, bookmarks and pasted locations.

use super::camera::Camera;
use super::state::{AppState, Effect, following};
use crate::engine::run_settings::RunSpec;
use crate::scene::{Document, RunTable, location};

impl AppState {
    /// Shows a document's pendulum, view and colours, with the accuracy that it states, if any.
    pub(super) fn show(&mut self, document: &Document) -> Option<Effect> {
        let scene = document.scene();
        if let Err(error) = scene.require_flip_from_rest() {
            self.notices.fail(format!("{error}."));
            return None;
        }
        let question = following(&scene);
        let same = (scene.build, question) == (self.build, self.question);
        (self.build, self.question) = (scene.build, question);
        self.picture = document.picture.clone();
        self.layers.curve = document.picture.curve;
        self.go(Camera::from_view(&scene.view));
        if self.compute_as(&document.run) {
            return Some(Effect::Reopen);
        }
        (!same).then_some(Effect::Relaunch)
    }

    /// Computes as a run table says from now on; an empty table changes nothing. Returns true if
    /// the integration setting or the checking has changed.
    fn compute_as(&mut self, run: &RunTable) -> bool {
        let words = RunTable { size: None, ..run.clone() };
        if words == RunTable::default() {
            return false;
        }
        match RunSpec::resolve(words) {
            Ok(spec) => {
                let (setting, verify) = (spec.setting, spec.verify);
                let earlier = std::mem::replace(&mut self.integration.spec, spec);
                (setting, verify) != (earlier.setting, earlier.verify)
            }
            Err(error) => {
                self.notices
                    .fail(format!("The scene is shown, but not computed as it asks: {error}."));
                false
            }
        }
    }

    pub(super) fn paste(&mut self, text: &str) -> Option<Effect> {
        match location::parse(text) {
            Ok(scene) => {
                let picture = self.document().picture;
                self.show(&Document { picture, ..Document::default() }.with_scene(scene))
            }
            Err(error) => {
                self.notices.fail(format!("What was pasted is not a location: {error}."));
                None
            }
        }
    }
}
