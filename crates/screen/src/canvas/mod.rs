//! The map on the screen: samples of tiles, drawn as quads through a colour table.
//!
//! [`mod@cover`] chooses what to draw for every cell in view, [`atlas`] assigns the samples a slot
//! on the card, and [`pipeline`] uploads and draws them. The card keeps flip times, not colours: a
//! change of colours uploads another table and computes nothing. The answers to other questions are
//! painted on the way to the card, and again when their colours change. New tiles appear gradually
//! ([`fading`]), and the range of times changes gradually ([`glide`]). The picture is kept, and a
//! frame draws only the cells that have changed ([`kept`]); once it rests, its grain is smoothed
//! ([`calm`]).

pub(crate) mod atlas;
pub(crate) mod calm;
pub mod colours;
pub mod copied;
pub(crate) mod cover;
pub mod fading;
pub mod glide;
pub(crate) mod kept;
pub mod pipeline;
pub(crate) mod sample;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use self::atlas::{Atlas, AtlasPlace};
use self::colours::CardColours;
use self::cover::{CoveredCell, Patch, cover};
use self::fading::Fading;
use self::glide::Glide;
use self::pipeline::{CellQuads, MapFrame, Quad, Upload};
use self::sample::WordKind;
use crate::camera::Screen;
use flipmap_render::tiles::Stride;
use flipmap_render::tiles::explorer::{Explorer, MAX_CELLS};
use flipmap_scene::lattice::SIDE;
use flipmap_scene::palette::Ground;

/// Number of layers of the atlas: enough for one tile per cell in view.
pub const LAYERS: u32 = MAX_CELLS.div_ceil(atlas::SLOTS_IN_LAYER as usize) as u32;

/// The map's state between frames.
#[derive(Debug)]
pub struct MapRenderer {
    atlas: Atlas,
    table: Vec<u8>,
    words: Arc<WordKind>,
    last: LastFrame,
    /// Appearance of new tiles.
    pub fading: Fading,
    /// Gradual change of the colours to other times.
    pub glide: Glide,
    /// True if the card draws so quickly that tiles can appear gradually.
    pub is_quick: bool,
    /// Number of finer levels whose samples are drawn where they are known.
    pub finer_levels: u32,
    /// The colours of pixels without an answer, if the picture is to be denoised: it rests and is
    /// complete.
    pub ground: Option<Ground>,
    /// True while the picture is to be denoised and is not; set by the card's part.
    is_grainy: Arc<AtomicBool>,
}

/// Data of the last frame for the card. The next frame carries them again if the last was thrown
/// away: egui may run a pass twice and draw only the second.
#[derive(Debug, Default)]
struct LastFrame {
    uploads: Vec<Upload>,
    has_table: bool,
    is_loaded: Arc<AtomicBool>,
}

impl Default for MapRenderer {
    fn default() -> Self {
        let words = Arc::new(WordKind::Times);
        MapRenderer {
            atlas: Atlas::new(LAYERS),
            table: Vec::new(),
            words,
            last: LastFrame::default(),
            fading: Fading::default(),
            glide: Glide::default(),
            is_quick: false,
            finer_levels: 0,
            ground: None,
            is_grainy: Arc::default(),
        }
    }
}

impl MapRenderer {
    /// Returns the frame that shows a screen in these colours.
    pub fn frame(
        &mut self,
        screen: &Screen,
        explorer: &mut Explorer,
        CardColours { mut uniforms, table, words }: CardColours,
    ) -> MapFrame {
        uniforms.toward[3] = (screen.size.x * screen.pixels_per_point) as f32;
        if *self.words != words {
            // The samples on the card are packed into other words.
            self.atlas = Atlas::new(LAYERS);
            self.words = Arc::new(words);
            self.last.uploads.clear();
        }
        self.atlas.begin_frame();
        let last = std::mem::take(&mut self.last);
        let mut uploads = last.uploads;
        if last.is_loaded.load(Ordering::Acquire) {
            uploads.clear();
        } else if last.has_table {
            self.table.clear();
        }
        let mut cells = Vec::new();
        for CoveredCell { patches, whole } in self.covered(screen, explorer) {
            let quad = |patch| self.quad(screen, explorer, &patch, &mut uploads);
            let quads: Vec<Quad> = patches.into_iter().filter_map(quad).collect();
            cells.push(CellQuads { quads, whole });
        }
        let table = (self.table != table).then(|| {
            self.table.clone_from(&table);
            table
        });
        let is_loaded = Arc::clone(&self.last.is_loaded);
        (self.last.uploads, self.last.has_table) = (uploads.clone(), table.is_some());
        let size_px = (screen.size * screen.pixels_per_point).round().as_uvec2().to_array();
        let (screen, words) = (*screen, Arc::clone(&self.words));
        let (mixes, ground) = (self.finer_levels > 0, self.ground);
        let is_grainy = Arc::clone(&self.is_grainy);
        MapFrame {
            screen,
            mixes,
            cells,
            uploads,
            words,
            uniforms,
            table,
            size_px,
            ground,
            is_loaded,
            is_grainy,
        }
    }

    /// Returns true if another frame is needed to show the picture without its grain.
    pub fn is_grainy(&self) -> bool {
        self.ground.is_some() && self.is_grainy.load(Ordering::Acquire)
    }

    /// Returns the patches of every cell; those of finer samples only if the atlas has room for
    /// them.
    fn covered(&mut self, screen: &Screen, explorer: &mut Explorer) -> Vec<CoveredCell> {
        let covered = cover(screen, explorer, &mut self.fading, self.finer_levels);
        let count: usize = covered.iter().map(|cell| cell.patches.len()).sum();
        if count <= (LAYERS * atlas::SLOTS_IN_LAYER) as usize {
            return covered;
        }
        cover(screen, explorer, &mut self.fading, 0)
    }

    /// Returns the quad of a patch, whose samples are added to the uploads if they are not on the
    /// card; none if the frame uses all slots.
    fn quad(
        &mut self,
        screen: &Screen,
        explorer: &mut Explorer,
        patch: &Patch,
        uploads: &mut Vec<Upload>,
    ) -> Option<Quad> {
        let (known, _) = patch.set.known(explorer, patch.source)?;
        let slot = match self.atlas.place(known.serial)? {
            AtlasPlace::There(slot) => slot,
            AtlasPlace::New(slot) => {
                uploads.retain(|other| other.slot != slot);
                let (samples, side) = (Arc::clone(&known.samples), known.stride.side(SIDE));
                uploads.push(Upload { slot, samples, side });
                slot
            }
        };
        Some(quad(screen, patch, known.stride, slot))
    }
}

/// Returns the quad of a patch whose samples are in a slot at a stride.
fn quad(screen: &Screen, patch: &Patch, stride: Stride, slot: u32) -> Quad {
    // The middle of a sample lies half a place from the borders of its own place.
    let texel = (patch.texel - 0.5 - f64::from(stride.first())) / f64::from(stride.places()) + 0.5;
    let span = patch.span / f64::from(stride.places());
    let clip = 2.0 / screen.size;
    let clip = |point: glam::DVec2| [(point.x * clip.x) as f32, (-point.y * clip.y) as f32];
    Quad {
        corner: clip(patch.corner),
        right: clip(patch.right),
        down: clip(patch.down),
        texel: texel.as_vec2().to_array(),
        span: span.as_vec2().to_array(),
        side: stride.side(SIDE) as f32,
        slot,
        alpha: patch.alpha,
    }
}
