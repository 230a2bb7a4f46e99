//! The home map, computed for figure 7 where there is no explorer.

use egui::{ColorImage, Context, TextureHandle, TextureOptions};

use super::flips::Seen;
use flipmap_engine::choice::{ChoiceError, EngineRequest, IntegrationSetting};
use flipmap_engine::{Accuracy, EngineKind};
use flipmap_pendulum::Status;
use flipmap_render::output::RowPainter;
use flipmap_render::tiles::{Renderer, Samples};
use flipmap_scene::{BuiltIn, Document, Grid, Scene};

/// A small picture of the whole torus.
pub struct HomeMap {
    /// The picture in colours, with the energy curve.
    pub image: ColorImage,
    /// Counts of the picture's pixels.
    pub seen: Seen,
    /// The scene and the colours of the picture.
    pub document: Document,
    scene: Scene,
    samples: Samples,
}

/// Computes the map that the window opens with, in `side` × `side` pixels, at the accuracy level
/// `fast`.
pub fn home_map(side: u32) -> Result<HomeMap, ChoiceError> {
    let document = BuiltIn::home().document();
    let (scene, size) = (document.scene(), [side; 2]);
    let setting = IntegrationSetting::Accuracy(Accuracy::Fast);
    let kind = Some(EngineKind::Cpu);
    let mut renderer = Renderer::new(&EngineRequest { kind, setting, ..EngineRequest::default() })?;
    let samples = renderer.render(&scene, size)?;
    let counts = renderer.counts();
    let seen = Seen {
        name: "pixels",
        pixels: counts.pixels,
        forbidden: counts.forbidden,
        simulated: Some(counts.simulated),
    };
    let painter = RowPainter::new(&scene, size, &document.picture);
    let rgb = painter.map(|mut painter| painter.paint(&samples)).unwrap_or_default();
    let image = ColorImage::from_rgb(size.map(|side| side as usize), &rgb);
    Ok(HomeMap { image, seen, document, scene, samples })
}

impl HomeMap {
    /// Returns the picture as an egui texture, which is freed when its handle is dropped.
    pub fn texture(&self, ctx: &Context) -> TextureHandle {
        ctx.load_texture("map", self.image.clone(), TextureOptions::LINEAR)
    }

    /// Returns each pixel's start in rad, status and flip time in s as CSV.
    pub fn csv(&self) -> String {
        let side = self.image.size[0] as u32;
        let grid = Grid::new(&self.scene, [side; 2]);
        let mut text = "theta1,theta2,status,t\n".to_string();
        for (k, outcome) in (0..).zip(self.samples.iter()) {
            let [theta1, theta2] = grid.angle_from_pixel(k % side, k / side).map(|theta| theta.hi);
            let (status, secs) = match outcome.status {
                Status::Answered => ("flipped", outcome.time.to_string()),
                Status::Unflipped => ("unflipped", String::new()),
                Status::Forbidden => ("forbidden", String::new()),
                Status::Failed => ("failed", String::new()),
            };
            text.push_str(&format!("{theta1},{theta2},{status},{secs}\n"));
        }
        text
    }
}
