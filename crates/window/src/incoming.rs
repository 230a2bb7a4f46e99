//! Incoming scenes: from files, bookmarks and pasted locations.

use super::auto_budget::following;
use super::state::AppState;
use flipmap_engine::run_settings::RunSpec;
use flipmap_scene::{Document, PictureTable, RunTable, Scene, location};
use flipmap_screen::camera::Camera;
use flipmap_screen::reach::Reach;

impl AppState {
    /// Shows a document's pendulum, view and colours, with the accuracy that it states, if any.
    /// Returns true if another engine has to be opened.
    pub(super) fn show(&mut self, document: &Document) -> bool {
        let scene = document.scene();
        self.ask(&Scene { question: following(&scene), ..scene.clone() });
        self.picture = document.picture.clone();
        self.given = document.picture.clone();
        self.layers.curve = document.picture.curve;
        self.go(Camera::from_view(&scene.view.fitted(self.canvas.to_array()), self.camera.reach));
        self.compute_as(&document.run)
    }

    /// Shows a built-in place as a document, in the colours that the user has chosen, if any.
    pub(super) fn visit(&mut self, mut place: Document) -> bool {
        let given = place.picture;
        place.picture = self.in_own_colours(&given);
        let reopens = self.show(&place);
        self.given = given;
        reopens
    }

    /// Returns a picture of a place in the colours that the user has chosen since the last document
    /// was shown; the place's own if there are none.
    fn in_own_colours(&self, place: &PictureTable) -> PictureTable {
        let colours = |picture: &PictureTable| {
            let mut colours = PictureTable { offset: 0.0, ..place.with_colours_of(picture) };
            colours.forget_view_times();
            colours
        };
        let own = colours(&self.picture);
        if own == colours(&self.given) { place.clone() } else { own }
    }

    /// Changes the pendulum, the question and the plane. A plane of another kind gets its home
    /// view; otherwise the view shows the same starts, whatever the reach of the lattice.
    pub(super) fn ask(&mut self, scene: &Scene) {
        let (was, is_same_kind) = (self.plane.clone(), self.plane.kind == scene.plane.kind);
        if self.question.ask != scene.question.ask {
            // Another question has other channels.
            self.picture.channel = None;
        }
        (self.build, self.question, self.plane) =
            (scene.build, scene.question, scene.plane.clone());
        let reach = Reach::of(scene);
        if self.plane != was || reach != self.camera.reach {
            self.pins.leave_plane();
        }
        if is_same_kind && reach == self.camera.reach {
            return;
        }
        let view = self.target().view();
        self.moving = None;
        self.camera = if is_same_kind {
            Camera::from_view(&view, reach)
        } else {
            Camera::home(reach, self.canvas)
        };
    }

    /// Applies a run table to everything computed from now on; an empty table changes nothing.
    /// Returns true if the integration setting or the checking has changed.
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

    /// Shows a pasted location. Returns true if another engine has to be opened.
    pub(super) fn paste(&mut self, text: &str) -> bool {
        match location::parse(text) {
            Ok(scene) => {
                let picture = self.document().picture;
                self.show(&Document { picture, ..Document::default() }.with_scene(scene))
            }
            Err(error) => {
                self.notices.fail(format!("What was pasted is not a location: {error}."));
                false
            }
        }
    }
}
