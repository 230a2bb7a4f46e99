//! The samples of a patch as linear light.

use super::WAITING;
use super::mip::Light;
use crate::physics::{Outcome, Status};
use crate::scene::film::Shot;
use crate::scene::palette::{Rgb, Tones, light_table};
use crate::tiles::Samples;

/// The flips that a frame shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlipWindow {
    secs: f64,
    /// True if the others are still waiting for theirs.
    waits: bool,
}

impl FlipWindow {
    /// The flips that a shot shows: all within its budget, or those within its clock.
    pub fn of(shot: &Shot) -> Self {
        match shot.clock_secs {
            Some(secs) => FlipWindow { secs, waits: true },
            None => FlipWindow { secs: shot.scene.question.budget.secs, waits: false },
        }
    }
}

/// The colours of a whole film: a time has the same colour in every frame.
pub struct Colours {
    tones: Tones,
    light: [u16; 256],
}

impl Colours {
    /// The colours of a film with these tones.
    pub fn new(tones: Tones) -> Self {
        Colours { tones, light: light_table() }
    }

    /// The light of a patch's samples.
    pub fn light(&self, samples: &Samples, shown: &FlipWindow) -> Light {
        let colours = samples.iter().map(|outcome| self.colour(&outcome, shown));
        colours.flat_map(|rgb| rgb.map(|channel| self.light[usize::from(channel)])).collect()
    }

    fn colour(&self, outcome: &Outcome, shown: &FlipWindow) -> Rgb {
        let others = if shown.waits { WAITING } else { self.tones.ground().unflipped };
        match outcome.status {
            Status::Flipped if outcome.time > shown.secs => others,
            Status::Unflipped => others,
            _ => self.tones.colour(outcome),
        }
    }
}
