//! Samples: the answer of each pixel with its trust, and counts of each kind of pixel.

use std::ops::Range;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use flipmap_engine::{Assurance, Effort, Trust};
use flipmap_pendulum::{Outcome, Status};

/// Answers and their trust, stored compactly.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Samples {
    statuses: Vec<Status>,
    /// Values of the question's channels, sample after sample.
    values: Vec<f64>,
    assurances: Vec<Assurance>,
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
            assurances: vec![Assurance::default(); count],
        }
    }

    /// Number of channels of each sample.
    pub fn channels(&self) -> usize {
        // The usual case, without a division.
        if self.values.len() == self.len() { 1 } else { self.values.len() / self.len().max(1) }
    }

    /// Returns true if every sample has `channels` values and a trust; samples read from a file may
    /// not.
    pub(crate) fn are_whole(&self, channels: usize) -> bool {
        let count = self.len();
        self.assurances.len() == count && self.values.len() == count * channels
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

    /// Returns the values of the channels of sample `index`; they are meaningless unless its status
    /// is `Answered`.
    pub fn values(&self, index: usize) -> &[f64] {
        let channels = self.channels();
        &self.values[index * channels..(index + 1) * channels]
    }

    /// Returns the channels of sample `index` as they stand in arrays: their values, `+inf` for
    /// unflipped and failed, NaN for forbidden.
    pub fn numbers(&self, index: usize) -> impl Iterator<Item = f64> {
        let status = self.statuses[index];
        self.values(index).iter().map(move |value| number_of(status, *value))
    }

    /// Replaces the outcome of sample `index`, whose time is the first channel.
    pub fn set(&mut self, index: usize, outcome: Outcome) {
        self.set_values(index, outcome.status, &[outcome.time]);
    }

    /// Replaces the outcomes of the samples at `places`, whose only channel is a time.
    pub(crate) fn set_all(&mut self, places: &[u32], outcomes: &[Outcome]) {
        // Shares of sorted places do not overlap, so each thread has samples of its own.
        let share = if places.is_sorted() { SHARE } else { places.len().max(1) };
        let (mut statuses, mut times) = (&mut self.statuses[..], &mut self.values[..]);
        let (mut parts, mut first) = (Vec::new(), 0);
        for (places, outcomes) in places.chunks(share).zip(outcomes.chunks(share)) {
            let end = places.iter().max().map_or(first, |last| *last as usize + 1);
            let (own, later) = statuses.split_at_mut(end - first);
            let (own_times, later_times) = times.split_at_mut(end - first);
            parts.push((first, places, outcomes, own, own_times));
            (statuses, times, first) = (later, later_times, end);
        }
        parts.into_par_iter().for_each(|(first, places, outcomes, statuses, times)| {
            for (&place, outcome) in places.iter().zip(outcomes) {
                let place = place as usize - first;
                (statuses[place], times[place]) = (outcome.status, outcome.time);
            }
        });
    }

    /// Replaces the status and the first values of sample `index`.
    pub fn set_values(&mut self, index: usize, status: Status, values: &[f64]) {
        let first = index * self.channels();
        self.statuses[index] = status;
        self.values[first..first + values.len()].copy_from_slice(values);
    }

    /// Returns rows of `width` samples with one channel, to be filled on all cores.
    pub(super) fn rows_mut(
        &mut self,
        width: usize,
    ) -> impl IndexedParallelIterator<Item = RowMut<'_>> {
        let Samples { statuses, values, assurances } = self;
        let rows = statuses.par_chunks_mut(width).zip(values.par_chunks_mut(width));
        let rows = rows.zip(assurances.par_chunks_mut(width));
        rows.map(|((statuses, times), assurances)| RowMut { statuses, times, assurances })
    }

    /// Returns the trust of sample `index`.
    pub fn trust(&self, index: usize) -> Trust {
        self.assurances[index].trust()
    }

    /// Returns the trust of sample `index` with the estimate of its error.
    pub fn assurance(&self, index: usize) -> Assurance {
        self.assurances[index]
    }

    /// Returns the bound of the estimated error of sample `index` in s as it stands in arrays: NaN
    /// where nothing was estimated.
    pub fn error_secs(&self, index: usize) -> f32 {
        self.assurances[index].error_secs().map_or(f32::NAN, |secs| secs as f32)
    }

    /// Replaces the trust of sample `index` and the estimate of its error.
    pub fn assure(&mut self, index: usize, assurance: impl Into<Assurance>) {
        self.assurances[index] = assurance.into();
    }

    /// Marks every checked sample as uncertain.
    pub(crate) fn distrust(&mut self) {
        for assurance in &mut self.assurances {
            if assurance.trust() != Trust::Unchecked {
                *assurance = assurance.with_trust(Trust::Uncertain);
            }
        }
    }

    /// Returns a copy of the samples at `places`.
    pub(crate) fn part(&self, places: Range<usize>) -> Self {
        let channels = self.channels();
        Samples {
            statuses: self.statuses[places.clone()].to_vec(),
            values: self.values[places.start * channels..places.end * channels].to_vec(),
            assurances: self.assurances[places].to_vec(),
        }
    }

    /// Appends other samples.
    pub fn append(&mut self, other: Samples) {
        self.statuses.extend(other.statuses);
        self.values.extend(other.values);
        self.assurances.extend(other.assurances);
    }

    /// Replaces the samples from index `first` on by those at `places` in `other`, which must
    /// answer the same question.
    pub(super) fn copy(&mut self, first: usize, other: &Samples, places: Range<usize>) {
        let own = first..first + places.len();
        let channels = self.channels();
        let wide = |range: Range<usize>| range.start * channels..range.end * channels;
        self.values[wide(own.clone())].copy_from_slice(&other.values[wide(places.clone())]);
        self.statuses[own.clone()].copy_from_slice(&other.statuses[places.clone()]);
        self.assurances[own].copy_from_slice(&other.assurances[places]);
    }

    /// Returns the first `count` samples in reverse, which turns a tile into its mirror image.
    pub fn image(&self, count: usize) -> Self {
        let channels = self.channels();
        let values = self.values[..count * channels].par_chunks(SHARE * channels).rev();
        let backwards = |values: &[f64]| {
            // Backwards number by number, then forwards within each sample.
            let mut values: Vec<f64> = values.iter().rev().copied().collect();
            values.chunks_mut(channels).for_each(<[f64]>::reverse);
            values
        };
        Samples {
            statuses: self.statuses[..count].par_iter().rev().copied().collect(),
            values: values.map(backwards).collect::<Vec<_>>().concat(),
            assurances: self.assurances[..count].par_iter().rev().copied().collect(),
        }
    }

    /// Iterates over all outcomes in order.
    pub fn iter(&self) -> impl Iterator<Item = Outcome> + '_ {
        (0..self.len()).map(|index| self.get(index))
    }

    /// Size in bytes of a sample with this many channels.
    pub const fn bytes(channels: usize) -> usize {
        size_of::<Status>() + channels * size_of::<f64>() + size_of::<Assurance>()
    }
}

/// Number of samples that a thread takes at a time.
const SHARE: usize = 1 << 14;

/// A row of samples with one channel.
pub(super) struct RowMut<'a> {
    statuses: &'a mut [Status],
    times: &'a mut [f64],
    assurances: &'a mut [Assurance],
}

impl RowMut<'_> {
    /// Marks samples whose energy forbids a flip.
    pub(super) fn forbid(&mut self, columns: Range<usize>) {
        self.statuses[columns].fill(Status::Forbidden);
    }

    /// Replaces the outcome of a sample, and its trust.
    pub(super) fn set(&mut self, column: usize, outcome: Outcome, assurance: Assurance) {
        self.statuses[column] = outcome.status;
        (self.times[column], self.assurances[column]) = (outcome.time, assurance);
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
    pub(crate) fn add(&mut self, samples: &Samples) {
        let shares = samples.statuses.par_chunks(SHARE).zip(samples.assurances.par_chunks(SHARE));
        let (statuses, trusts) = shares.map(counted).reduce(Default::default, |one, other| {
            let sum = |i: usize| one.0[i] + other.0[i];
            (std::array::from_fn(sum), std::array::from_fn(|i| one.1[i] + other.1[i]))
        });
        let count = |status: Status| statuses[status as usize];
        self.pixels += samples.len() as u64;
        self.flipped += count(Status::Answered);
        self.unflipped += count(Status::Unflipped);
        self.forbidden += count(Status::Forbidden);
        self.failed += count(Status::Failed);
        for (sum, count) in self.trusts.iter_mut().zip(trusts) {
            *sum += count;
        }
    }

    /// Number of pixels whose checks disagree.
    pub fn uncertain(&self) -> u64 {
        self.trusts[Trust::Uncertain as usize]
    }
}

/// Counts samples by status, and by trust where a flip is possible.
fn counted((statuses, assurances): (&[Status], &[Assurance])) -> ([u64; 4], [u64; 5]) {
    let (mut by_status, mut by_trust) = ([0; 4], [0; 5]);
    for (status, assurance) in statuses.iter().zip(assurances) {
        by_status[*status as usize] += 1;
        by_trust[assurance.trust() as usize] += u64::from(*status != Status::Forbidden);
    }
    (by_status, by_trust)
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

/// Returns the number that stands in an array for a channel of a sample with this status: its
/// value, `+inf` for unflipped and failed, NaN for forbidden.
pub(crate) fn number_of(status: Status, value: f64) -> f64 {
    match status {
        Status::Answered => value,
        Status::Unflipped | Status::Failed => f64::INFINITY,
        Status::Forbidden => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outcomes_reach_their_places_in_whatever_order() {
        let rising: Vec<u32> = (0..3 * SHARE as u32).map(|k| 2 * k + 1).collect();
        let falling: Vec<u32> = rising.iter().rev().copied().collect();
        for places in [rising, falling, vec![5, 1, 9], Vec::new()] {
            let mut samples = Samples::unflipped(6 * SHARE + 1);
            let outcomes: Vec<Outcome> =
                places.iter().map(|&place| Outcome::flipped(f64::from(place))).collect();
            samples.set_all(&places, &outcomes);
            let mut is_named = vec![false; samples.len()];
            places.iter().for_each(|place| is_named[*place as usize] = true);
            for (place, is_named) in is_named.into_iter().enumerate() {
                let outcome = samples.get(place);
                if is_named {
                    assert_eq!(outcome, Outcome::flipped(place as f64));
                } else {
                    assert_eq!(outcome.status, Status::Unflipped, "{place}");
                }
            }
        }
    }

    #[test]
    fn an_image_is_the_samples_backwards_with_their_channels_in_order() {
        for (channels, count) in [(1, 3 * SHARE + 7), (3, 2 * SHARE + 5), (4, 9)] {
            let mut samples = Samples::unanswered(count + 4, channels);
            for k in 0..count {
                let values: Vec<f64> = (0..channels).map(|c| (10 * k + c) as f64).collect();
                samples.set_values(k, Status::Answered, &values);
                samples.assure(k, if k % 3 == 0 { Trust::Agreed } else { Trust::Unchecked });
            }
            let image = samples.image(count);
            assert_eq!((image.len(), image.channels()), (count, channels));
            for k in 0..count {
                let other = count - 1 - k;
                assert_eq!(image.values(k), samples.values(other));
                assert_eq!(image.trust(k), samples.trust(other));
            }
            assert!(samples.image(count).image(count) == samples.part(0..count));
        }
    }

    #[test]
    fn all_shares_of_samples_are_counted() {
        let mut samples = Samples::unflipped(2 * SHARE + 3);
        for place in (0..samples.len()).step_by(5) {
            samples.set(place, Outcome::without_time(Status::Forbidden));
        }
        samples.set(1, Outcome::flipped(2.0));
        samples.assure(1, Trust::Agreed);
        let mut counts = Counts::default();
        counts.add(&samples);
        let forbidden = samples.len().div_ceil(5) as u64;
        assert_eq!([counts.forbidden, counts.flipped, counts.failed], [forbidden, 1, 0]);
        assert_eq!(counts.unflipped + counts.forbidden + 1, counts.pixels);
        assert_eq!(counts.trusts.iter().sum::<u64>(), counts.pixels - forbidden);
        assert_eq!(counts.trusts[Trust::Agreed as usize], 1);
    }
}
