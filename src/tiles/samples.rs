//! Samples: what is known of each pixel, and how many of which kind there are.

use serde::{Deserialize, Serialize};

use crate::engine::{Effort, Trust};
use crate::physics::{Outcome, Status};

/// Outcomes, stored tightly.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Samples {
    statuses: Vec<Status>,
    times: Vec<f64>,
    trusts: Vec<Trust>,
}

impl Samples {
    /// `count` unflipped samples.
    pub fn unflipped(count: usize) -> Self {
        Samples {
            statuses: vec![Status::Unflipped; count],
            times: vec![0.0; count],
            trusts: vec![Trust::Unchecked; count],
        }
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.statuses.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.statuses.is_empty()
    }

    /// Sample `index`.
    pub fn get(&self, index: usize) -> Outcome {
        Outcome { status: self.statuses[index], time: self.times[index] }
    }

    /// Replaces sample `index`.
    pub fn set(&mut self, index: usize, outcome: Outcome) {
        self.statuses[index] = outcome.status;
        self.times[index] = outcome.time;
    }

    /// How sure sample `index` is.
    pub fn trust(&self, index: usize) -> Trust {
        self.trusts[index]
    }

    /// Says how sure sample `index` is.
    pub fn set_trust(&mut self, index: usize, trust: Trust) {
        self.trusts[index] = trust;
    }

    /// The first `count` samples.
    pub fn truncated(mut self, count: usize) -> Self {
        self.statuses.truncate(count);
        self.times.truncate(count);
        self.trusts.truncate(count);
        self
    }

    /// Some of the samples.
    pub fn part(&self, places: std::ops::Range<usize>) -> Self {
        Samples {
            statuses: self.statuses[places.clone()].to_vec(),
            times: self.times[places.clone()].to_vec(),
            trusts: self.trusts[places].to_vec(),
        }
    }

    /// Adds others at the end.
    pub fn append(&mut self, other: Samples) {
        self.statuses.extend(other.statuses);
        self.times.extend(other.times);
        self.trusts.extend(other.trusts);
    }

    /// The samples in opposite order: of a tile, its mirror image.
    pub fn reversed(mut self) -> Self {
        self.statuses.reverse();
        self.times.reverse();
        self.trusts.reverse();
        self
    }

    /// All outcomes in order.
    pub fn iter(&self) -> impl Iterator<Item = Outcome> + '_ {
        (0..self.len()).map(|index| self.get(index))
    }

    /// Bytes a sample takes.
    pub const BYTES: usize = size_of::<Status>() + size_of::<f64>() + size_of::<Trust>();
}

/// What has been done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// Pixels answered, mirror images included.
    pub pixels: u64,
    /// Starts that an engine integrated.
    pub simulated: u64,
    /// Pixels that flipped.
    pub flipped: u64,
    /// Pixels that did not within the budget.
    pub unflipped: u64,
    /// Pixels that energy forbids to.
    pub forbidden: u64,
    /// Pixels whose integration failed.
    pub failed: u64,
    /// Pixels by how sure they are, in the order of [`Trust::ALL`]; forbidden ones are proved and
    /// not among them.
    pub trusts: [u64; 5],
    /// What it took, the last deep pixels' facts among it.
    pub effort: Effort,
}

impl Counts {
    /// Counts finished samples.
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

    /// Pixels whose checks disagree.
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
