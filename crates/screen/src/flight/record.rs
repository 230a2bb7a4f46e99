//! The record of a flight: two motions, their flips, and readings along the way.

use super::motion::Motion;
use flipmap_numbers::Dd;
use flipmap_pendulum::separation::Reading;

/// The moment at which the rule is first met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flip {
    /// Index of the bob that flips.
    pub bob: usize,
    /// Seconds from the release.
    pub secs: Dd,
}

/// The record of one pendulum of a flight.
#[derive(Clone, Debug, Default)]
pub struct Track {
    /// The pendulum's motion.
    pub motion: Motion,
    /// The pendulum's flip, once known, even if it comes after the budget.
    pub flip: Option<Flip>,
}

impl Track {
    fn append(&mut self, later: Track) {
        self.motion.append(later.motion);
        self.flip = self.flip.or(later.flip);
    }
}

/// The reason why a record grows no further.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlightEnding {
    /// The record reaches the requested time.
    Complete,
    /// The record has reached its greatest number of steps.
    Full,
    /// A value stopped being finite.
    NotFinite,
    /// The thread could not be started, or broke off.
    BrokenOff,
}

/// A whole flight, or a part of it that continues an earlier part.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// The pendulum of the pixel.
    pub own: Track,
    /// The pendulum one pixel away.
    pub ghost: Track,
    /// Readings at the release and at the end of each step of the pendulum.
    pub readings: Vec<Reading>,
    /// The reason for the end; set only in the last part.
    pub ending: Option<FlightEnding>,
}

impl Record {
    /// Appends a later part.
    pub fn append(&mut self, mut later: Record) {
        self.own.append(later.own);
        self.ghost.append(later.ghost);
        self.readings.append(&mut later.readings);
        self.ending = self.ending.or(later.ending);
    }

    /// Seconds up to which both motions are known.
    pub fn end_secs(&self) -> f64 {
        self.own.motion.end_secs().min(self.ghost.motion.end_secs())
    }
}
