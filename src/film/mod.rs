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
//! - A place has the same samples in every frame, so no pixel changes its mind between two frames.
//! - Other colours, and other times to show ([`FlipWindow`]), compute nothing. Another pendulum is
//!   another [`FrameGroup`] with samples of its own.
//! - All samples have the largest budget of the keys; a frame with a smaller one hides later flips.
//!   Where all budgets follow the depth, those of a level's samples follow that of the frames which
//!   look at it most closely.
//! - Only one of a patch and its mirror image is computed.

mod colours;
pub mod ffmpeg;
mod frames;
mod mip;
mod paint;

pub use colours::{Colours, FlipWindow};
pub use frames::{FrameError, Frames};
pub use mip::{Light, Mip};
pub use paint::{FramePainter, WAITING};

use std::sync::Arc;

use crate::physics::Scalar;
use crate::scene::budget::settled_by_width;
use crate::scene::film::{Film, Shot};
use crate::scene::keys::Key;
use crate::scene::lattice::{Cell, side_rad};
use crate::scene::{Scene, View};
use crate::tiles::patches::{PATCH_SIDE, Sight, patches};

/// The frames of one pendulum, and the patches from which they are painted.
#[derive(Clone, Debug)]
pub struct FrameGroup {
    /// The pendulum and the question, with the budget of the whole film; the view does not matter.
    pub scene: Scene,
    /// The range from the first frame to the one after the last.
    pub frames: std::ops::Range<u32>,
    /// Budgets of the samples by the level of their patch, s; none if the question's serves all.
    pub level_budgets: Arc<[f64]>,
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
        groups.push(FrameGroup { scene, frames, level_budgets: Arc::default(), patches: found });
    }
    if let [group] = &mut groups[..] {
        group.level_budgets = level_budgets(film, group).into();
    }
    groups
}

/// The budgets of the levels of a film that zooms with budgets that follow the depth, s.
fn level_budgets(film: &Film, group: &FrameGroup) -> Vec<f64> {
    let follows = |key: &Key| key.scene.question.budget.auto && key.clock.is_none();
    let width = |key: &Key| key.scene.view.width_rad().to_f64();
    let deepest = film.keys.iter().min_by(|a, b| width(a).total_cmp(&width(b)));
    let (Some(deepest), true) = (deepest, film.keys.iter().all(follows)) else { return Vec::new() };
    let finest = group.patches.iter().map(|cell| cell.level).max().unwrap_or(0);
    let across = f64::from(film.size[0] * film.keys[0].scene.picture.samples);
    let sample_rad = |level: u32| side_rad(level) / f64::from(PATCH_SIDE);
    let widths: Vec<f64> = (0..=finest).map(|level| across * sample_rad(level)).collect();
    let center = deepest.scene.view.center_rad();
    let settled = settled_by_width(&group.scene.build, center, &widths);
    settled.into_iter().map(|secs| secs.min(film.budget_secs())).collect()
}

/// Shots without those that have the view of the one before.
fn different_views(shots: &[Shot]) -> Vec<&Shot> {
    let moved = |two: &&[Shot]| two[0].scene.view != two[1].scene.view;
    shots.first().into_iter().chain(shots.windows(2).filter(moved).map(|two| &two[1])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Document;
    use crate::scene::keys::Easing;

    /// A zoom from home onto a filament.
    fn zoom(auto: bool) -> Film {
        let key = |secs, view| {
            let mut scene = Document { view, ..Document::default() };
            scene.question.budget.auto = auto;
            Key { secs, easing: Easing::Linear, clock: None, scene: scene.settled() }
        };
        let center = ["1.186731002723680501301171875", "2.044025554305620842132421875"];
        let center = center.map(str::to_string);
        let deep = View { center, width: "2e-18".to_string(), ..View::default() };
        let keys = vec![key(0.0, View::default()), key(1.0, deep)];
        Film { size: [64, 64], frames: 60, fps: 60.0, keys }
    }

    #[test]
    fn the_levels_of_a_zoom_have_budgets_of_their_own() {
        let groups = frame_groups(&zoom(true));
        let budgets = &groups[0].level_budgets;
        assert_eq!((budgets[0], budgets[budgets.len() - 1]), (30.0, 55.0));
        assert!(budgets.is_sorted());
        assert!(frame_groups(&zoom(false))[0].level_budgets.is_empty(), "30 s were asked for");
    }
}
