//! The views seen last, as small pictures to return to.

use std::collections::VecDeque;

use egui::{ColorImage, Context, TextureHandle, TextureOptions};

use super::camera::Camera;
use super::state::AppState;
use super::view_samples;
use flipmap_render::output::Picture;
use flipmap_render::tiles::explorer::Explorer;
use flipmap_scene::{Document, Scene, View};

/// Number of views that are kept.
const KEPT: usize = 8;

/// A view seen before.
pub(crate) struct SeenView {
    /// What was shown.
    pub document: Document,
    camera: Camera,
    picture: Picture,
    texture: Option<TextureHandle>,
}

/// The views seen last, the latest first.
#[derive(Default)]
pub(crate) struct LastViews(VecDeque<SeenView>);

impl LastViews {
    /// Takes the view that is shown, which must be complete and at rest, unless it is the latest. A
    /// view that is seen again moves to the front.
    pub(crate) fn see(&mut self, state: &AppState, explorer: &mut Explorer) {
        let (document, camera) = (state.document(), state.camera);
        let is_same = |seen: &SeenView| {
            let asked = |document: &Document| Scene { view: View::default(), ..document.scene() };
            asked(&seen.document) == asked(&document) && seen.camera.is_near(&camera)
        };
        if self.0.front().is_some_and(is_same) {
            return;
        }
        self.0.retain(|seen| !is_same(seen));
        let picture = view_samples::picture(state, explorer);
        self.0.push_front(SeenView { document, camera, picture, texture: None });
        self.0.truncate(KEPT);
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
        self.texture.get_or_insert_with(|| {
            let image = ColorImage::from_rgb(size.map(|side| side as usize), rgb);
            ctx.load_texture("view seen before", image, TextureOptions::LINEAR)
        })
    }
}
