//! Samples: the answer of each pixel with its trust, and counts of each kind of pixel.

use serde::{Deserialize, Serialize};

use crate::engine::{Effort, Trust};
use crate::physics::{Outcome, Status};

/// Answers and their trust, stored compactly.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Samples {
    statuses: Vec<Status>,
    /// Values of the question's channels, sample after sample.
    values: Vec<f64>,
    trusts: Vec<Trust>,
}

impl Samples {
    /// Creates `count` unflipped samples of a question with one channel.
    pub fn unflipped(count: usize) -> Self {
        Samples::unanswered(count, 1)
    }

    /// Creates `count` samples without an answer, of a question with this many channels.
    pub fn unanswered(count: usize, channels: usize) -> Self {
        Samples {
            statuses: vec![Status::Unflipped; count],
            values: vec![0.0; count * channels],
            trusts: vec![Trust::Unchecked; count],
        }
    }

    /// Number of channels of each sample.
    pub fn channels(&self) -> usize {
        // Nearly always, and without a division.
        if self.values.len() == self.len() { 1 } else { self.values.len() / self.len().max(1) }
    }

    /// Returns true if every sample has `channels` values and a trust; those read from a file may not.
    pub fn are_whole(&self, channels: usize) -> bool {
        let count = self.len();
        self.trusts.len() == count && self.values.len() == count * channels
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.statuses.len()
    }

    /// Returns true if there are no samples.
    pub fn is_empty(&self) -> bool {
        self.statuses.is_empty()
    }

    /// Returns the status of sample `index`, and its first channel as a time.
    pub fn get(&self, index: usize) -> Outcome {
        Outcome { status: self.statuses[index], time: self.values(index)[0] }
    }

    /// Returns the values of the channels of sample `index`; they mean nothing unless it has an
    /// answer, which the status `Flipped` says.
    pub fn values(&self, index: usize) -> &[f64] {
        let channels = self.channels();
        &self.values[index * channels..(index + 1) * channels]
    }

    /// Replaces the outcome of sample `index`, whose time is the first channel.
    pub fn set(&mut self, index: usize, outcome: Outcome) {
        self.set_values(index, outcome.status, &[outcome.time]);
    }

    /// Replaces the outcomes of the samples at `places`, whose only channel is a time.
    pub fn set_all(&mut self, places: &[u32], outcomes: &[Outcome]) {
        let (statuses, times) = (&mut self.statuses[..], &mut self.values[..]);
        for (&place, outcome) in places.iter().zip(outcomes) {
            statuses[place as usize] = outcome.status;
            times[place as usize] = outcome.time;
        }
    }

    /// Replaces the status and the first values of sample `index`.
    pub fn set_values(&mut self, index: usize, status: Status, values: &[f64]) {
        let first = index * self.channels();
        self.statuses[index] = status;
        self.values[first..first + values.len()].copy_from_slice(values);
    }

    /// Says of some samples that energy forbids a flip.
    pub fn forbid(&mut self, places: std::ops::Range<usize>) {
        self.statuses[places].fill(Status::Forbidden);
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
        self.values.truncate(count * self.channels());
        self.statuses.truncate(count);
        self.trusts.truncate(count);
        self
    }

    /// Returns a copy of the samples at `places`.
    pub fn part(&self, places: std::ops::Range<usize>) -> Self {
        let channels = self.channels();
        Samples {
            statuses: self.statuses[places.clone()].to_vec(),
            values: self.values[places.start * channels..places.end * channels].to_vec(),
            trusts: self.trusts[places].to_vec(),
        }
    }

    /// Appends other samples.
    pub fn append(&mut self, other: Samples) {
        self.statuses.extend(other.statuses);
        self.values.extend(other.values);
        self.trusts.extend(other.trusts);
    }

    /// Reverses the order of the samples: those of a tile become those of its mirror image.
    pub fn reversed(mut self) -> Self {
        // Backwards number by number, then forwards within each sample.
        let channels = self.channels();
        self.values.reverse();
        self.values.chunks_mut(channels).for_each(<[f64]>::reverse);
        self.statuses.reverse();
        self.trusts.reverse();
        self
    }

    /// Iterates over all outcomes in order.
    pub fn iter(&self) -> impl Iterator<Item = Outcome> + '_ {
        (0..self.len()).map(|index| self.get(index))
    }

    /// Size in bytes of a sample with this many channels.
    pub const fn bytes(channels: usize) -> usize {
        size_of::<Status>() + channels * size_of::<f64>() + size_of::<Trust>()
    }
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
        let mut statuses = [0; 4];
        for (status, trust) in samples.statuses.iter().zip(&samples.trusts) {
            statuses[*status as usize] += 1;
            self.trusts[*trust as usize] += u64::from(*status != Status::Forbidden);
        }
        let count = |status: Status| statuses[status as usize];
        self.pixels += samples.len() as u64;
        self.flipped += count(Status::Flipped);
        self.unflipped += count(Status::Unflipped);
        self.forbidden += count(Status::Forbidden);
        self.failed += count(Status::Failed);
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
