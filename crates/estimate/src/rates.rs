//! The distribution of the rates at which nudges grow.

use serde::{Deserialize, Serialize};

use crate::shares::{ClassCounts, share};
use crate::{Estimate, EstimateError};

/// The rates of one replicate.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReplicateRates {
    /// Rates of which one can be sure.
    pub sure: Vec<f64>,
    /// Rates of which nobody is sure.
    pub unsure: Vec<f64>,
}

/// The distribution of rates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RateDistribution {
    /// Rate up to which a start counts as regular.
    pub bound: f64,
    /// The share of regular starts.
    pub regular: Estimate,
    /// The mean rate of the others, if there are any.
    pub mean: Option<Estimate>,
    /// Shares, and the rates that they do not exceed.
    pub quantiles: Vec<(f64, Estimate)>,
    /// Upper ends of intervals of rates, and the share of starts in each.
    pub histogram: Vec<(f64, f64)>,
}

/// Shares whose quantiles are taken.
const QUANTILES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];
/// Number of intervals of the histogram.
const STEPS: usize = 60;

/// Returns the rate up to which motion over `secs` counts as regular: nudges in regular motion grow as
/// a power of time, in chaotic motion exponentially. It lies at the growth by (t/τ)², where τ is the
/// natural unit of time.
pub fn regular_bound(secs: f64, unit_secs: f64) -> f64 {
    2.0 * (secs / unit_secs).ln() / secs
}

/// Estimates the distribution; rates up to `bound` count as regular.
pub fn distribution(
    replicates: &[ReplicateRates],
    bound: f64,
) -> Result<RateDistribution, EstimateError> {
    let regular = regular_share(replicates, bound)?;
    let all = |rates: &ReplicateRates| {
        let mut all: Vec<f64> = rates.sure.iter().chain(&rates.unsure).copied().collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let each: Vec<Vec<f64>> = replicates.iter().map(all).filter(|all| !all.is_empty()).collect();
    let over = |value: &dyn Fn(&[f64]) -> f64| {
        let readings: Vec<[f64; 3]> = each.iter().map(|all| [value(all); 3]).collect();
        Estimate::of_replicates(&readings)
    };
    let quantile = |p: f64| over(&|all| all[((p * all.len() as f64) as usize).min(all.len() - 1)]);
    let quantiles: Vec<(f64, Estimate)> =
        QUANTILES.iter().map(|p| Ok((*p, quantile(*p)?))).collect::<Result<_, _>>()?;
    let chaotic = |all: &Vec<f64>| {
        let chaotic = || all.iter().copied().filter(|rate| *rate > bound);
        [[chaotic().sum::<f64>(), chaotic().count() as f64]; 3]
    };
    let mean = Estimate::of_ratios(&each.iter().map(chaotic).collect::<Vec<_>>())?;
    let mean = mean.value.is_finite().then_some(mean);
    Ok(RateDistribution { bound, regular, mean, quantiles, histogram: histogram(&each.concat()) })
}

/// Returns the share of rates up to `bound`.
pub fn regular_share(replicates: &[ReplicateRates], bound: f64) -> Result<Estimate, EstimateError> {
    let counts = |rates: &ReplicateRates| {
        let regular = |rates: &[f64]| rates.iter().filter(|rate| **rate <= bound).count() as u64;
        let split = |all: &[f64]| vec![regular(all), all.len() as u64 - regular(all)];
        ClassCounts { sure: split(&rates.sure), unsure: split(&rates.unsure) }
    };
    let counts: Vec<ClassCounts> = replicates.iter().map(counts).collect();
    share(&counts, 0)
}

fn histogram(rates: &[f64]) -> Vec<(f64, f64)> {
    let most = rates.iter().copied().fold(0.0, f64::max);
    let step = most / STEPS as f64;
    let end = |k: usize| (k + 1) as f64 * step;
    let is_in = |rate: f64, k: usize| ((rate / step).max(0.0) as usize).min(STEPS - 1) == k;
    let share = |k: usize| {
        rates.iter().filter(|rate| is_in(**rate, k)).count() as f64 / rates.len().max(1) as f64
    };
    (0..STEPS).map(|k| (end(k), share(k))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scatter::random;

    #[test]
    fn two_heaps_are_told_apart() {
        let one = |k| {
            let mut rng = random(4, k);
            let mut rates = ReplicateRates::default();
            for _ in 0..500 {
                let rate = if rng.f64() < 0.3 { 0.1 * rng.f64() } else { 1.0 + 0.2 * rng.f64() };
                rates.sure.push(rate);
            }
            rates
        };
        let all: Vec<ReplicateRates> = (0..16).map(one).collect();
        let found = distribution(&all, regular_bound(30.0, 0.3)).unwrap();
        assert!((found.bound - 0.307).abs() < 1e-3);
        assert!(found.regular.contains(0.3) && found.mean.unwrap().contains(1.1), "{found:?}");
        assert!((found.histogram.iter().map(|bin| bin.1).sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
