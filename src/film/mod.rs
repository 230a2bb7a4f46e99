//! Films: frames painted from samples that were computed beforehand.
//!
//! Frames are not computed one by one. The camera's path determines how closely the frames look at
//! each place, and it is sampled once, as finely as the nearest look needs: in patches, cells of
//! the lattice with 32 × 32 samples each ([`crate::tiles::patches`]). Along one axis of a zoom:
//!
//! ```text
//! frames    ├─────────────────────────────┤
//!                           ├─────┤
//!                               ├─┤
//! patches  ├───────┼───────┼───┼─┼─┼───────┤    fine where some frame comes near
//!
//! keys ─▶ shots ─▶ patches ─▶ samples ─▶ Mip ─▶ FramePainter ─▶ Frames, or ffmpeg's Encoder
//! ```
//!
//! The [`Mip`] holds the colours of the patches and, averaged over 2 × 2 samples a level, those of
//! every cell above them up to the whole torus; the [`FramePainter`] takes each frame out of it.
//!
//! - A zoom costs as many samples as a few frames per octave, however many frames it has.
//! - A place has the same samples in every frame, so no pixel flickers between two frames.
//! - Other colours, and other times to show ([`FlipWindow`]), compute nothing. Another pendulum is
//!   another [`FrameGroup`] with samples of its own.
//! - All samples have the largest budget of the keys; a frame with a smaller one hides later flips.
//!   Levels with budgets of their own would show: a frame's middle is painted from finer levels.
//! - Only one of a patch and its mirror image is computed.

mod colours;
pub mod ffmpeg;
mod frames;
mod lit_frame;
mod mip;
mod paint;

pub use colours::{Colours, FlipWindow};
pub use frames::{FrameError, Frames};
pub use mip::{Light, Mip};
pub use paint::{FramePainter, WAITING};

use std::sync::Arc;

use crate::scene::film::{Film, Shot};
use crate::scene::lattice::Cell;
use crate::scene::{Scene, View};
use crate::tiles::patches::{Sight, patches};

/// The frames of one pendulum, and the patches from which they are painted.
#[derive(Clone, Debug)]
pub struct FrameGroup {
    /// The pendulum and the question, with the budget of the whole film; the view does not matter.
    pub scene: Scene,
    /// The range from the first frame to the one after the last.
    pub frames: std::ops::Range<u32>,
    /// Patches in depth-first order of quarters of quarters; shared by groups with equal views.
    pub patches: Arc<[Cell]>,
}

/// The groups of a film: one for each run of frames with the same pendulum.
pub fn frame_groups(film: &Film) -> Vec<FrameGroup> {
    let samples = film.keys[0].scene.picture.samples;
    let shots: Vec<Shot> = (0..film.frames).map(|frame| film.shot(frame)).collect();
    let mut groups: Vec<FrameGroup> = Vec::new();
    let mut looked: Vec<&View> = Vec::new();
    for same in shots.chunk_by(|a, b| a.scene.build == b.scene.build) {
        let shots = different_views(same);
        let views: Vec<&View> = shots.iter().map(|shot| &shot.scene.view).collect();
        let found = match groups.last() {
            Some(before) if looked == views => before.patches.clone(),
            _ => {
                let sight = |shot: &&Shot| Sight::new(&shot.scene, film.size, samples);
                patches(&shots.iter().map(sight).collect::<Vec<_>>()).into()
            }
        };
        looked = views;
        let mut scene = Scene { view: View::default(), ..same[0].scene.clone() };
        scene.question.budget.secs = film.budget_secs();
        let first = groups.last().map_or(0, |before| before.frames.end);
        let frames = first..first + same.len() as u32;
        groups.push(FrameGroup { scene, frames, patches: found });
    }
    groups
}

/// Shots without those that have the view of the one before.
fn different_views(shots: &[Shot]) -> Vec<&Shot> {
    let moved = |two: &&[Shot]| two[0].scene.view != two[1].scene.view;
    shots.first().into_iter().chain(shots.windows(2).filter(moved).map(|two| &two[1])).collect()
}
