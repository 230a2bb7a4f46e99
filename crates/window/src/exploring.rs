//! The section for exploring: where the view is, views seen before, and places worth a look.

use std::f64::consts::TAU;

use egui::load::SizedTexture;
use egui::{TextureHandle, Ui, vec2};

use super::action::{Action, Look};
use super::finds::{Find, finds};
use super::last_views::LastViews;
use super::model::AppModel;
use super::panels::tiles::{PlaceTile, place_tiles};
use super::panels::whereabouts::whereabouts;
use super::small_pictures::{ASPECT, SmallPictures};
use flipmap_numbers::number_text::fixed;
use flipmap_scene::question::QuestionName;
use flipmap_scene::{Budget, Document, Scene, View};
use flipmap_screen::camera::Camera;
use flipmap_screen::reach::Reach;

/// Number of finds in a row of tiles.
const FINDS_IN_ROW: usize = 3;

/// What the section for exploring has found out about the view.
#[derive(Default)]
pub(crate) struct Exploring {
    /// The view whose finds are known, and what is asked there.
    of: Option<(Camera, Scene)>,
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
    /// Takes the view, which is complete, among those seen if it is at rest.
    pub(super) fn see_view(&mut self) {
        if self.state.rests() {
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
        let views = &mut self.exploring.last_views;
        let (tiles, documents): (Vec<_>, Vec<_>) = (1..)
            .zip(views.before())
            .map(|(steps, seen)| {
                let picture = Some(SizedTexture::from_handle(seen.texture(&ctx)));
                let name = format!("View {steps} before");
                (PlaceTile { name, captions: Vec::new(), picture }, &seen.document)
            })
            .unzip();
        let clicked = place_tiles(ui, &tiles, LastViews::BEFORE);
        actions.extend(clicked.map(|k| Action::Show(Box::new(documents[k].clone()))));
        actions
    }

    /// Returns the document of the whole torus, as wide as a small picture shows it in full height. A
    /// budget that follows the view is the whole map's own, so that dives leave the picture alone.
    fn whole_map(&self) -> Document {
        let width = format!("{:?}", TAU / f64::from(ASPECT));
        let view = View { width, fit: false, ..View::default() };
        let mut document = self.state.document_at(view);
        document.picture.forget_view_times();
        if document.question.budget.auto {
            document.question.budget = Budget::default();
        }
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
            let picture = find_pictures.texture(&ctx, place).map(SizedTexture::from_handle);
            PlaceTile { name: find.name.to_string(), captions, picture }
        };
        let tiles: Vec<_> = finds.iter().enumerate().map(tile).collect();
        let clicked = place_tiles(ui, &tiles, FINDS_IN_ROW)?;
        Some(Action::Look(Look::To(finds[clicked].camera)))
    }

    /// Looks for finds in a view that is complete and at rest, once.
    fn find(&mut self) {
        self.exploring.find_pictures.begin(&self.wake);
        if !self.progress().is_complete() || !self.state.rests() {
            return;
        }
        let of = (self.state.camera, self.state.scene());
        if self.exploring.of.as_ref() == Some(&of) {
            return;
        }
        let found = finds(&self.state.screen(), &mut self.compute.explorer);
        let documents = found.iter().map(|find| {
            let mut document = self.state.document_at(find.camera.view());
            document.picture.forget_view_times();
            document
        });
        self.exploring.find_pictures.of(documents.collect(), &self.wake);
        (self.exploring.finds, self.exploring.of) = (found, Some(of));
    }
}
