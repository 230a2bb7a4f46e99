//! Samples: the outcome of each pixel with its trust, and counts of each kind of pixel.

use serde::{Deserialize, Serialize};

use crate::engine::{Effort, Trust};
use crate::physics::{Outcome, Status};

/// Outcomes and their trust, stored compactly.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Samples {
    statuses: Vec<Status>,
    times: Vec<f64>,
    trusts: Vec<Trust>,
}

impl Samples {
    /// Creates `count` unflipped samples.
    pub fn unflipped(count: usize) -> Self {
        Samples {
            statuses: vec![Status::Unflipped; count],
            times: vec![0.0; count],
            trusts: vec![Trust::Unchecked; count],
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.statuses.len()
    }

    /// Returns true if there are no samples.
    pub fn is_empty(&self) -> bool {
        self.statuses.is_empty()
    }

    /// Returns the outcome of sample `index`.
    pub fn get(&self, index: usize) -> Outcome {
        Outcome { status: self.statuses[index], time: self.times[index] }
    }

    /// Replaces the outcome of sample `index`.
    pub fn set(&mut self, index: usize, outcome: Outcome) {
        self.statuses[index] = outcome.status;
        self.times[index] = outcome.time;
    }

    /// Returns the trust of sample `index`.
    pub fn trust(&self, index: usize) -> Trust {
        self.trusts[index]
    }

    /// Replaces the trust of sample `index`.
    pub fn set_trust(&mut self, index: usize, trust: Trust) {
        self.trusts[index] = trust;
    }

    /// Keeps only the first `count` samples.
    pub fn truncated(mut self, count: usize) -> Self {
        self.statuses.truncate(count);
        self.times.truncate(count);
        self.trusts.truncate(count);
        self
    }

    /// Returns a copy of the samples at `places`.
    pub fn part(&self, places: std::ops::Range<usize>) -> Self {
        Samples {
            statuses: self.statuses[places.clone()].to_vec(),
            times: self.times[places.clone()].to_vec(),
            trusts: self.trusts[places].to_vec(),
        }
    }

    /// Appends other samples.
    pub fn append(&mut self, other: Samples) {
        self.statuses.extend(other.statuses);
        self.times.extend(other.times);
        self.trusts.extend(other.trusts);
    }

    /// Reverses the order of the samples: those of a tile become those of its mirror image.
    pub fn reversed(mut self) -> Self {
        self.statuses.reverse();
        self.times.reverse();
        self.trusts.reverse();
        self
    }

    /// Iterates over all outcomes in order.
    pub fn iter(&self) -> impl Iterator<Item = Outcome> + '_ {
        (0..self.len()).map(|index| self.get(index))
    }

    /// Size of a sample in bytes.
    pub const BYTES: usize = size_of::<Status>() + size_of::<f64>() + size_of::<Trust>();
}

/// Counts of the pixels answered and of the work done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// Number of pixels answered, mirror images included.
    pub pixels: u64,
    /// Number of starts that an engine computed.
    pub simulated: u64,
    /// Number of pixels that flipped.
    pub flipped: u64,
    /// Number of pixels that did not flip within the budget.
    pub unflipped: u64,
    /// Number of pixels that energy forbids to flip.
    pub forbidden: u64,
    /// Number of pixels whose integration failed.
    pub failed: u64,
    /// Numbers of pixels by trust, in the order of [`Trust::ALL`]; forbidden ones are proved and
    /// not counted here.
    pub trusts: [u64; 5],
    /// Work done, including the statistics of deep pixels.
    pub effort: Effort,
}

impl Counts {
    /// Adds finished samples to the counts.
    pub fn add(&mut self, samples: &Samples) {
        self.pixels += samples.len() as u64;
        for (status, trust) in samples.statuses.iter().zip(&samples.trusts) {
            *match status {
                Status::Flipped => &mut self.flipped,
                Status::Unflipped => &mut self.unflipped,
                Status::Forbidden => &mut self.forbidden,
                Status::Failed => &mut self.failed,
            } += 1;
            if *status != Status::Forbidden {
                self.trusts[*trust as usize] += 1;
            }
        }
    }

    /// Number of pixels whose checks disagree.
    pub fn uncertain(&self) -> u64 {
        self.trusts[Trust::Uncertain as usize]
    }
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Counts) {
        self.pixels += other.pixels;
        self.simulated += other.simulated;
        self.flipped += other.flipped;
        self.unflipped += other.unflipped;
        self.forbidden += other.forbidden;
        self.failed += other.failed;
        for (sum, count) in self.trusts.iter_mut().zip(other.trusts) {
            *sum += count;
        }
        self.effort += other.effort;
    }
}
