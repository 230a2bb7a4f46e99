//! Films: frames painted from the samples that their patches hold.
//!
//! A film is computed before it is painted. Its patches (see [`crate::tiles::patches`]) hold every
//! sample once, whatever frames show it; [`Mip`] keeps their colours and those of everything coarser,
//! and [`paint`](paint::paint) takes each frame out of it. So other colours and other times compute
//! nothing, and no pixel changes its mind between two frames.

mod colours;
pub mod ffmpeg;
mod frames;
mod mip;
mod paint;

pub use colours::{Colours, Shown};
pub use frames::{FrameError, Frames};
pub use mip::{Light, Mip};
pub use paint::{Painter, WAITING};

use crate::scene::Scene;
use crate::scene::film::{Film, Shot};
use crate::scene::lattice::Cell;
use crate::tiles::patches::{Sight, patches};

/// The frames of one pendulum, and the patches they are painted from.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// The pendulum and the question, its budget that of the whole film; the view does not matter.
    pub scene: Scene,
    /// The first frame, and the one after the last.
    pub frames: std::ops::Range<u32>,
    /// In the order of the quarters of quarters.
    pub patches: Vec<Cell>,
}

/// The sheets of a film: one, or where the pendulum changes one for every frame.
pub fn sheets(film: &Film) -> Vec<Sheet> {
    let samples = film.keys[0].scene.picture.samples;
    let shots: Vec<Shot> = (0..film.frames).map(|frame| film.shot(frame)).collect();
    let mut sheets = Vec::new();
    let mut first = 0;
    for same in shots.chunk_by(|a, b| a.scene.build == b.scene.build) {
        let sights: Vec<Sight> =
            different_views(same).map(|shot| Sight::new(&shot.scene, film.size, samples)).collect();
        let mut scene = Scene { view: Default::default(), ..same[0].scene.clone() };
        scene.question.budget.secs = film.budget_secs();
        let frames = first..first + same.len() as u32;
        first = frames.end;
        sheets.push(Sheet { scene, frames, patches: patches(&sights) });
    }
    sheets
}

/// Shots without those that look where the one before did.
fn different_views(shots: &[Shot]) -> impl Iterator<Item = &Shot> {
    let first = shots.first().into_iter();
    first.chain(
        shots.windows(2).filter(|two| two[0].scene.view != two[1].scene.view).map(|two| &two[1]),
    )
}
