//! Numbers with a 95 % confidence interval.

use serde::{Deserialize, Serialize};
use statrs::distribution::{Beta, ContinuousCDF, StudentsT};

use crate::EstimateError;

/// A measured number and the interval that holds the true one with a probability of 95 %.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

/// Upper tail of a two-sided interval.
const TAIL: f64 = 0.025;

/// Quantile of the standard normal distribution that leaves [`TAIL`] above it.
pub(crate) const NORMAL: f64 = 1.959_963_984_540_054;

/// Smallest number of replicates from which a spread is taken.
pub(crate) const LEAST_REPLICATES: usize = 4;

impl Estimate {
    /// A number that is known exactly.
    pub fn exact(value: f64) -> Self {
        Estimate { value, low: value, high: value }
    }

    /// Returns the mean of independent replicates with Student's interval. Each replicate counts
    /// its unsure answers three ways: as the least, the likeliest and the greatest share.
    pub(crate) fn of_replicates(readings: &[[f64; 3]]) -> Result<Self, EstimateError> {
        let have = readings.len();
        if have < LEAST_REPLICATES {
            return Err(EstimateError::TooFew { what: "replicates", have, need: LEAST_REPLICATES });
        }
        let t = quantile_t(have - 1);
        let means = [0, 1, 2].map(|k| {
            let values: Vec<f64> = readings.iter().map(|reading| reading[k]).collect();
            let (mean, error) = mean_and_error(&values);
            [mean, t * error]
        });
        let low = means.iter().map(|[mean, by]| mean - by).fold(f64::INFINITY, f64::min);
        let high = means.iter().map(|[mean, by]| mean + by).fold(f64::NEG_INFINITY, f64::max);
        Ok(Estimate { value: means[1][0], low, high })
    }

    /// Returns the ratio of two sums over independent replicates with Student's interval of its
    /// linearised error; each replicate counts its unsure answers three ways.
    pub(crate) fn of_ratios(readings: &[[[f64; 2]; 3]]) -> Result<Self, EstimateError> {
        let ratios = [0, 1, 2].map(|k| {
            let sum = |part: usize| readings.iter().map(|reading| reading[k][part]).sum::<f64>();
            sum(0) / sum(1)
        });
        let count = readings.len() as f64;
        let around = |k: usize, reading: &[[f64; 2]; 3]| {
            let below = readings.iter().map(|other| other[k][1]).sum::<f64>() / count;
            ratios[k] + (reading[k][0] - ratios[k] * reading[k][1]) / below
        };
        let values: Vec<[f64; 3]> =
            readings.iter().map(|reading| [0, 1, 2].map(|k| around(k, reading))).collect();
        Estimate::of_replicates(&values)
    }

    /// Returns the share of `count` in `total` independent trials, `unsure` of which may belong to
    /// them as well or not, with the interval of Clopper and Pearson (1934). `guessed` of the unsure
    /// ones seem to belong to them.
    pub fn of_trials(count: u64, unsure: u64, guessed: u64, total: u64) -> Self {
        let share = |count: u64| count as f64 / total.max(1) as f64;
        let (most, total_f) = (count + unsure, total as f64);
        let beta = |a: f64, b: f64, p: f64| Beta::new(a, b).map_or(f64::NAN, |b| b.inverse_cdf(p));
        let low = match count {
            0 => 0.0,
            _ => beta(count as f64, total_f - count as f64 + 1.0, TAIL),
        };
        let high = match most >= total {
            true => 1.0,
            false => beta(most as f64 + 1.0, total_f - most as f64, 1.0 - TAIL),
        };
        Estimate { value: share(count + guessed), low, high }
    }

    /// Half the width of the interval.
    pub fn half_width(&self) -> f64 {
        0.5 * (self.high - self.low)
    }

    /// Returns true if the interval holds a value.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Returns true if two intervals have a value in common.
    pub fn overlaps(&self, other: &Estimate) -> bool {
        self.low <= other.high && other.low <= self.high
    }

    /// The interval of a number times `factor` plus `offset`.
    #[must_use]
    pub fn mapped(self, factor: f64, offset: f64) -> Self {
        let [value, a, b] = [self.value, self.low, self.high].map(|x| factor * x + offset);
        Estimate { value, low: a.min(b), high: a.max(b) }
    }

    /// The interval without values that are impossible.
    #[must_use]
    pub fn within(self, least: f64, most: f64) -> Self {
        let [value, low, high] = [self.value, self.low, self.high].map(|x| x.clamp(least, most));
        Estimate { value, low, high }
    }

    /// The interval that also holds every value of another.
    #[must_use]
    pub fn and(self, other: Estimate) -> Self {
        Estimate {
            value: self.value,
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }
}

/// Returns the upper quantile of Student's distribution.
pub(crate) fn quantile_t(freedom: usize) -> f64 {
    StudentsT::new(0.0, 1.0, freedom as f64).map_or(NORMAL, |t| t.inverse_cdf(1.0 - TAIL))
}

/// Returns the mean of values and its standard error.
pub(crate) fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (n - 1.0) / n).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trials_have_the_interval_of_the_tables() {
        // Clopper and Pearson: 5 of 20, and the rule of three for none of 100.
        let some = Estimate::of_trials(5, 0, 0, 20);
        assert!((some.low - 0.0866).abs() < 1e-4 && (some.high - 0.4910).abs() < 1e-4, "{some:?}");
        let none = Estimate::of_trials(0, 0, 0, 100);
        assert!(none.low == 0.0 && (none.high - 0.0362).abs() < 1e-4);
        let unsure = Estimate::of_trials(0, 2, 1, 100);
        assert!(unsure.value == 0.01 && unsure.high > Estimate::of_trials(1, 0, 0, 100).high);
    }

    #[test]
    fn replicates_have_students_interval_and_three_are_too_few() {
        let readings = [[1.0; 3], [2.0; 3], [3.0; 3], [4.0; 3]];
        let interval = Estimate::of_replicates(&readings).unwrap();
        // 3.1824 times the root of 5/3 over 4.
        assert!((interval.half_width() - 2.0543).abs() < 1e-3, "{interval:?}");
        let need = LEAST_REPLICATES;
        let error = EstimateError::TooFew { what: "replicates", have: 3, need };
        assert_eq!(Estimate::of_replicates(&readings[..3]), Err(error));
    }
}
