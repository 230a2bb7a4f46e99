//! Films: frames painted from the samples that their patches hold.
//!
//! A film is computed before it is painted. Its patches (see [`crate::tiles::patches`]) hold every
//! sample once, whatever frames show it; [`Mip`] keeps their colours and those of everything coarser,
//! and a [`Painter`] takes each frame out of it. So other colours and other times compute
//! nothing, and no pixel changes its mind between two frames.

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

use crate::scene::film::{Film, Shot};
use crate::scene::lattice::Cell;
use crate::scene::{Scene, View};
use crate::tiles::patches::{Sight, patches};

/// The frames of one pendulum, and the patches they are painted from.
#[derive(Clone, Debug)]
pub struct FrameGroup {
    /// The pendulum and the question, its budget that of the whole film; the view does not matter.
    pub scene: Scene,
    /// The first frame, and the one after the last.
    pub frames: std::ops::Range<u32>,
    /// In the order of the quarters of quarters; shared by groups that are looked at alike.
    pub patches: Arc<[Cell]>,
}

/// The groups of a film: one, or where the pendulum changes one for every frame.
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

/// Shots without those that look where the one before did.
fn different_views(shots: &[Shot]) -> Vec<&Shot> {
    let moved = |two: &&[Shot]| two[0].scene.view != two[1].scene.view;
    shots.first().into_iter().chain(shots.windows(2).filter(moved).map(|two| &two[1])).collect()
}
