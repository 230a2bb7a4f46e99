//! The summary of a comparison: how many pixels differ, and by how much.

use super::compare::Difference;

/// The summary of a comparison.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Comparison {
    /// Number of pixels in each result.
    pub pixels: u64,
    /// Number of pixels that differ by more than was allowed, class changes included.
    pub differing: u64,
    /// Number of differing pixels that changed their class.
    pub classes: u64,
    /// The largest difference.
    pub largest: f64,
    histogram: Histogram,
}

/// Counts of differences by size, in a hundred bins per decade.
#[derive(Clone, Debug, PartialEq)]
struct Histogram {
    none: u64,
    counts: Vec<u64>,
}

const MIN_DECADE: f64 = -18.0;
const DECADES: usize = 24;
const BINS_A_DECADE: f64 = 100.0;

impl Comparison {
    /// Adds the difference of two pixels.
    pub(super) fn add(&mut self, difference: Difference, tolerance: f64) {
        self.pixels += 1;
        match difference {
            Difference::Class => {
                self.classes += 1;
                self.differing += 1;
            }
            Difference::By(by) => {
                self.differing += u64::from(by > tolerance);
                self.largest = self.largest.max(by);
                self.histogram.add(by);
            }
        }
    }

    /// Returns the share of pixels that differ by more than was allowed.
    pub fn share(&self) -> f64 {
        self.differing as f64 / (self.pixels as f64).max(1.0)
    }

    /// Returns the difference that this share of the pixels does not exceed, accurate to a fortieth
    /// of itself; pixels that changed their class are left out.
    pub fn quantile(&self, share: f64) -> f64 {
        self.histogram.quantile(share).min(self.largest)
    }
}

impl Default for Histogram {
    fn default() -> Self {
        Histogram { none: 0, counts: vec![0; DECADES * BINS_A_DECADE as usize] }
    }
}

impl Histogram {
    fn add(&mut self, by: f64) {
        if by == 0.0 {
            self.none += 1;
            return;
        }
        let bin = (by.log10() - MIN_DECADE) * BINS_A_DECADE;
        let last = self.counts.len() - 1;
        self.counts[(bin.max(0.0) as usize).min(last)] += 1;
    }

    fn quantile(&self, share: f64) -> f64 {
        let all = self.none + self.counts.iter().sum::<u64>();
        let mut left = (share * all as f64).ceil() as u64;
        if left <= self.none {
            return 0.0;
        }
        left -= self.none;
        for (bin, count) in self.counts.iter().enumerate() {
            if left <= *count {
                return 10f64.powf((bin + 1) as f64 / BINS_A_DECADE + MIN_DECADE);
            }
            left -= count;
        }
        f64::INFINITY
    }
}
