//! The section for exploring: where the view is, views seen before, and places worth a look.

use egui::{TextureHandle, Ui, vec2};

use super::action::{Action, Look};
use super::camera::Camera;
use super::finds::{Find, finds};
use super::last_views::LastViews;
use super::model::AppModel;
use super::panels::tiles::{PlaceTile, place_tiles};
use super::panels::whereabouts::whereabouts;
use super::reach::Reach;
use super::small_pictures::SmallPictures;
use flipmap_lab::number_text::fixed;
use flipmap_scene::question::QuestionName;
use flipmap_scene::{Document, View};

/// Ratio of a small picture's width to its height.
const PICTURE_ASPECT: f64 = 96.0 / 60.0;

/// What the section for exploring has found out about the view.
#[derive(Default)]
pub(crate) struct Exploring {
    /// Camera and document of the view whose finds are known.
    of: Option<(Camera, Document)>,
    finds: Vec<Find>,
    find_pictures: SmallPictures,
    whole: SmallPictures,
    /// The view as each question would answer it.
    pub(super) questions: SmallPictures,
    pub(super) last_views: LastViews,
}

impl Exploring {
    /// Forgets what was on a lost graphics device.
    pub(super) fn forget_card(&mut self) {
        self.find_pictures = SmallPictures::default();
        self.whole = SmallPictures::default();
        self.questions = SmallPictures::default();
        self.of = None;
        self.last_views.forget_card();
    }
}

impl AppModel {
    /// Takes the view among those seen, once it is complete and at rest.
    pub(super) fn see_view(&mut self) {
        if self.progress().is_complete() && self.state.rests() {
            self.exploring.last_views.see(&self.state, &mut self.compute.explorer);
        }
    }

    /// Shows where the view is and the views seen before it.
    pub(super) fn whereabouts(&mut self, ui: &mut Ui) -> Vec<Action> {
        let mut actions = Vec::new();
        if self.state.camera.reach == Reach::TORUS {
            self.exploring.whole.of(vec![self.whole_map()], &self.wake);
            let picture = self.exploring.whole.texture(ui.ctx(), 0).map(TextureHandle::id);
            let size = vec2(self.state.canvas.x as f32, self.state.canvas.y as f32);
            actions.extend(whereabouts(ui, &self.state.target(), size, picture));
            ui.add_space(4.0);
        }
        let ctx = ui.ctx().clone();
        let (tiles, documents): (Vec<_>, Vec<_>) = self
            .exploring
            .last_views
            .before()
            .take(4)
            .enumerate()
            .map(|(place, seen)| {
                let picture = Some(seen.texture(&ctx).id());
                let name = format!("View {} before", place + 1);
                (PlaceTile { name, captions: Vec::new(), picture }, seen.document.clone())
            })
            .unzip();
        let clicked = place_tiles(ui, &tiles, 4);
        actions.extend(clicked.map(|k| Action::Show(Box::new(documents[k].clone()))));
        actions
    }

    /// Returns the document of the whole torus, as wide as a small picture shows it in full height.
    fn whole_map(&self) -> Document {
        let shown = self.state.document();
        let width = format!("{:?}", PICTURE_ASPECT * std::f64::consts::TAU);
        let view = View { width, fit: false, ..View::default() };
        let mut document = Document { view, ..shown };
        document.picture.forget_view_times();
        document
    }

    /// Shows what is worth a closer look in the view.
    pub(super) fn finds_panel(&mut self, ui: &mut Ui) -> Option<Action> {
        if self.state.question.ask != QuestionName::Flip {
            ui.weak("Filaments and islands are found on maps of flip times.");
            return None;
        }
        self.find();
        if self.exploring.finds.is_empty() {
            ui.weak(match self.progress().is_complete() {
                true => "Nothing stands out in this view.",
                false => "Shown once the view is complete.",
            });
            return None;
        }
        let Exploring { finds, find_pictures, .. } = &mut self.exploring;
        let ctx = ui.ctx().clone();
        let tile = |(place, find): (usize, &Find)| {
            let secs = find.secs.map(|secs| format!("{} s", fixed(secs, 2)));
            let captions = std::iter::once(find.name.to_string()).chain(secs).collect();
            let picture = find_pictures.texture(&ctx, place).map(TextureHandle::id);
            PlaceTile { name: find.name.to_string(), captions, picture }
        };
        let tiles: Vec<_> = finds.iter().enumerate().map(tile).collect();
        let clicked = place_tiles(ui, &tiles, 3)?;
        Some(Action::Look(Look::To(finds[clicked].camera)))
    }

    /// Looks for finds in a view that is complete and at rest, once.
    fn find(&mut self) {
        if !self.progress().is_complete() || !self.state.rests() {
            return;
        }
        let (camera, shown) = (self.state.camera, self.state.document());
        let is_known = |(of, document): &(Camera, Document)| {
            *of == camera && document.scene() == shown.scene()
        };
        if self.exploring.of.as_ref().is_some_and(is_known) {
            return;
        }
        let found = finds(&self.state.screen(), &mut self.compute.explorer);
        let documents = found.iter().map(|find| {
            let mut document = Document { view: find.camera.view(), ..shown.clone() };
            document.picture.forget_view_times();
            document
        });
        self.exploring.find_pictures.of(documents.collect(), &self.wake);
        (self.exploring.finds, self.exploring.of) = (found, Some((camera, shown)));
    }
}
