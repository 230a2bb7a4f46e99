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
//! - Samples have the budget of the frames that look at their level ([`level_budgets`]), so that a
//!   zoom does not pay for its last view's budget on its way. A frame's middle, painted from finer
//!   levels, has more time; a frame of a camera that stays hides what flips after its budget.
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
    /// The pendulum and the question; neither the view nor the budget matters.
    scene: Scene,
    /// Budgets of patches by level, in s; finer ones have the last.
    budgets: Arc<[f64]>,
    /// The range from the first frame to the one after the last.
    pub frames: std::ops::Range<u32>,
    /// Patches in depth-first order of quarters of quarters; shared by groups with equal views.
    pub patches: Arc<[Cell]>,
}

/// Number of different budgets that the levels of a film may have.
const BUDGETS: f64 = 64.0;

impl FrameGroup {
    /// The scene to compute a patch of; its view does not matter.
    pub fn scene_of(&self, cell: &Cell) -> Scene {
        let mut scene = self.scene.clone();
        let last = self.budgets.len() - 1;
        scene.question.budget.secs = self.budgets[(cell.level as usize).min(last)];
        scene
    }
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
        let sight = |shot: &&Shot| Sight::new(&shot.scene, film.size, samples);
        let sights: Vec<Sight> = shots.iter().map(sight).collect();
        let found = match groups.last() {
            Some(before) if looked == views => before.patches.clone(),
            _ => patches(&sights).into(),
        };
        looked = views;
        let budgets = level_budgets(film, &shots, &sights).into();
        let scene = Scene { view: View::default(), ..same[0].scene.clone() };
        let first = groups.last().map_or(0, |before| before.frames.end);
        let frames = first..first + same.len() as u32;
        groups.push(FrameGroup { scene, budgets, frames, patches: found });
    }
    groups
}

/// The budgets of patches by level, in s: the largest of the frames that look at this level or a
/// coarser one, in steps of a 64th of the film's largest.
fn level_budgets(film: &Film, shots: &[&Shot], sights: &[Sight]) -> Vec<f64> {
    let most = film.budget_secs();
    if film.stays() {
        return vec![most];
    }
    let step = most / BUDGETS;
    let mut budgets: Vec<f64> = Vec::new();
    for (shot, sight) in shots.iter().zip(sights) {
        let level = sight.level() as usize;
        budgets.resize(budgets.len().max(level + 1), 0.0);
        let secs = (shot.scene.question.budget.secs / step).ceil() * step;
        budgets[level] = budgets[level].max(secs.min(most));
    }
    let mut so_far = 0.0;
    budgets.iter_mut().for_each(|secs| {
        so_far = secs.max(so_far);
        *secs = so_far;
    });
    budgets
}

/// Shots without those that have the view of the one before.
fn different_views(shots: &[Shot]) -> Vec<&Shot> {
    let moved = |two: &&[Shot]| two[0].scene.view != two[1].scene.view;
    shots.first().into_iter().chain(shots.windows(2).filter(moved).map(|two| &two[1])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::keys::{Easing, Key};
    use crate::scene::{Budget, Document};

    fn key(secs: f64, width: &str, budget: f64) -> Key {
        let mut scene = Document::default();
        scene.view.width = width.to_string();
        scene.question.budget = Budget::secs(budget);
        Key { secs, easing: Easing::Linear, clock: None, scene }
    }

    fn budgets(keys: Vec<Key>) -> Vec<f64> {
        let film = Film { size: [64, 48], frames: 21, fps: 10.0, keys };
        let [group] = &frame_groups(&film)[..] else { panic!("one pendulum") };
        let of = |cell: &Cell| group.scene_of(cell).question.budget.secs;
        let mut all: Vec<(u32, f64)> = group.patches.iter().map(|c| (c.level, of(c))).collect();
        all.sort_by(|a, b| a.partial_cmp(b).unwrap());
        all.dedup();
        all.into_iter().map(|(_, secs)| secs).collect()
    }

    #[test]
    fn finer_levels_have_longer_budgets_whichever_way_the_camera_goes() {
        let there = vec![key(0.0, "6", 30.0), key(1.0, "1e-6", 60.0)];
        let back = vec![key(0.0, "1e-6", 60.0), key(1.0, "6", 30.0)];
        for keys in [there, back] {
            let secs = budgets(keys);
            assert!(secs.is_sorted() && secs.len() > 15, "{secs:?}");
            assert!(secs[0] < 33.0 && secs.last() == Some(&60.0), "{secs:?}");
        }
        let far = budgets(vec![key(0.0, "1e-6", 30.0), key(1.0, "6", 60.0)]);
        assert!(far.iter().all(|secs| *secs == 60.0), "a wide view's time is never cut: {far:?}");
        let stays = budgets(vec![key(0.0, "6", 10.0), key(1.0, "6", 30.0)]);
        assert_eq!(stays, [30.0]);
    }
}
