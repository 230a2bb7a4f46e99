//! The views seen last, as small pictures to return to.

use std::collections::VecDeque;

use egui::{Context, TextureHandle};

use super::state::AppState;
use super::thumbs::loaded;
use super::view_samples;
use flipmap_render::output::Picture;
use flipmap_render::tiles::explorer::Explorer;
use flipmap_scene::{Document, Scene};
use flipmap_screen::camera::Camera;

/// A view seen before.
pub(crate) struct SeenView {
    /// What was shown.
    pub document: Document,
    camera: Camera,
    /// What was asked, without the view.
    asked: Scene,
    picture: Picture,
    texture: Option<TextureHandle>,
}

/// The views seen last, the latest first.
#[derive(Default)]
pub(crate) struct LastViews(VecDeque<SeenView>);

impl LastViews {
    /// Number of views that are kept beside the latest.
    pub(crate) const BEFORE: usize = 4;

    /// Takes the view that is shown, which must be complete and at rest, unless it is the latest. A
    /// view that is seen again moves to the front.
    pub(crate) fn see(&mut self, state: &AppState, explorer: &mut Explorer) {
        let (asked, camera) = (state.scene(), state.camera);
        let is_same = |seen: &SeenView| seen.asked == asked && seen.camera.is_near(&camera);
        if self.0.front().is_some_and(is_same) {
            return;
        }
        self.0.retain(|seen| !is_same(seen));
        let picture = view_samples::picture(state, explorer);
        let document = picture.document.clone();
        self.0.push_front(SeenView { document, camera, asked, picture, texture: None });
        self.0.truncate(1 + Self::BEFORE);
    }

    /// Returns the views that were seen before the one that is shown.
    pub(crate) fn before(&mut self) -> impl Iterator<Item = &mut SeenView> {
        self.0.iter_mut().skip(1)
    }

    /// Forgets what was on a lost graphics device.
    pub(crate) fn forget_card(&mut self) {
        self.0.iter_mut().for_each(|seen| seen.texture = None);
    }
}

impl SeenView {
    /// Returns the picture of the view.
    pub(crate) fn texture(&mut self, ctx: &Context) -> &TextureHandle {
        let Picture { size, rgb, .. } = &self.picture;
        self.texture.get_or_insert_with(|| loaded(ctx, "view seen before", *size, rgb))
    }
}
