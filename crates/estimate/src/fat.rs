//! The exponent of a fat fractal: how fast the share of finely mixed boxes falls to what never unmixes.
//!
//! μ(ε) = μ₀ + K ε^β (Farmer 1985, Phys. Rev. Lett. 55, 351; Umberger and Farmer 1985, ibid. 661). With
//! μ₀ = 0 the boundary has no area, and β is its uncertainty exponent.
//!
//! A box counts as mixed if its samples, some twenty-five, find two classes. A class whose density falls to
//! nothing within smaller boxes is not mixed in this sense, although it may touch every one of them.

use serde::{Deserialize, Serialize};

use crate::entropy::Boxes;
use crate::estimate::mean_and_error;
use crate::line::FittedLine;
use crate::{Estimate, EstimateError, scatter};

/// What the shares of mixed boxes say.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FatFractal {
    /// The exponent β.
    pub beta: Estimate,
    /// The share μ₀ that stays mixed however small the boxes.
    pub rest: Estimate,
    /// True if some share surely stays mixed.
    pub is_fat: bool,
    /// Side of the boxes, and the share that is mixed.
    pub shares: Vec<(f64, Estimate)>,
}

/// Number of resamplings of a bootstrap.
const RESAMPLES: usize = 200;
/// Number of exponents that are tried.
const TRIED: usize = 750;
/// Smallest number of sizes.
const FEWEST: usize = 4;

/// Estimates the exponent from boxes of several sizes.
pub fn fat_fractal(sizes: &[Boxes], seed: u64) -> Result<FatFractal, EstimateError> {
    if sizes.len() < FEWEST {
        let have = sizes.len();
        return Err(EstimateError::TooFew { what: "sizes of boxes", have, need: FEWEST });
    }
    let readings: Vec<Vec<[f64; 3]>> =
        sizes.iter().map(|boxes| boxes.groups.iter().map(|group| mixed(group)).collect()).collect();
    let shares = readings.iter().map(|groups| Estimate::of_replicates(groups));
    let shares = shares.map(|share| Ok(share?.within(0.0, 1.0)));
    let shares: Vec<Estimate> = shares.collect::<Result<_, _>>()?;
    if shares.iter().all(|share| share.value == 0.0) {
        return Err(EstimateError::OneClass);
    }
    let fitted = |picked: &dyn Fn(usize) -> Vec<usize>, reading: usize| {
        let point = |(k, groups): (usize, &Vec<[f64; 3]>)| {
            let values: Vec<f64> = picked(k).iter().map(|g| groups[*g][reading]).collect();
            let (mean, _) = mean_and_error(&values);
            let all: Vec<f64> = groups.iter().map(|group| group[1]).collect();
            // Few mixed boxes may be as many in every group, and none is no proof that there are none.
            let count = sizes[k].groups.iter().map(Vec::len).sum::<usize>() as f64;
            let error = mean_and_error(&all).1.max((mean.max(1.0 / count) / count).sqrt());
            [sizes[k].side, mean, error.powi(-2)]
        };
        fit(&readings.iter().enumerate().map(point).collect::<Vec<_>>())
    };
    let every = |k: usize| (0..readings[k].len()).collect::<Vec<usize>>();
    let value = fitted(&every, 1);
    let rng = std::cell::RefCell::new(scatter::random(seed, 0xfa7));
    let resampled = |k: usize| {
        let count = readings[k].len();
        (0..count).map(|_| rng.borrow_mut().usize(..count)).collect::<Vec<usize>>()
    };
    let mut ends = [Estimate::exact(value[0]), Estimate::exact(value[1])];
    for reading in 0..3 {
        let fits: Vec<[f64; 2]> = (0..RESAMPLES).map(|_| fitted(&resampled, reading)).collect();
        for (part, end) in ends.iter_mut().enumerate() {
            let mut values: Vec<f64> = fits.iter().map(|fit| fit[part]).collect();
            values.sort_by(f64::total_cmp);
            let at = |share: f64| values[(share * RESAMPLES as f64) as usize];
            *end = end.and(Estimate { value: end.value, low: at(0.025), high: at(0.975) });
        }
    }
    let shares = sizes.iter().map(|boxes| boxes.side).zip(shares).collect();
    Ok(FatFractal { beta: ends[0], rest: ends[1], is_fat: ends[1].low > 0.0, shares })
}

/// Returns the share of boxes that are mixed: surely, as it seems, and possibly.
fn mixed(group: &[crate::shares::ClassCounts]) -> [f64; 3] {
    let classes = |counts: &[u64]| counts.iter().filter(|count| **count > 0).count();
    let mut sums = [0.0; 3];
    for counts in group {
        let unsure = counts.unsure.iter().sum::<u64>();
        let seeming: Vec<u64> =
            counts.sure.iter().zip(&counts.unsure).map(|(a, b)| a + b).collect();
        let may_be = classes(&counts.sure) > 1 || unsure > 0 && counts.sure.len() > 1;
        let readings = [classes(&counts.sure) > 1, classes(&seeming) > 1, may_be];
        (0..3).for_each(|k| sums[k] += f64::from(readings[k]));
    }
    sums.map(|sum| sum / group.len().max(1) as f64)
}

/// Fits μ₀ + K ε^β to points (ε, μ, weight) and returns β and μ₀, which is not negative.
fn fit(points: &[[f64; 3]]) -> [f64; 2] {
    let with_beta = |beta: f64| {
        let bent: Vec<[f64; 3]> = points.iter().map(|p| [p[0].powf(beta), p[1], p[2]]).collect();
        let line = FittedLine::fit(&bent)?;
        if line.offset >= 0.0 {
            return Some((line.misfit, [beta, line.offset]));
        }
        let sum = |k: usize| bent.iter().map(|p| p[2] * p[0] * p[k]).sum::<f64>();
        let slope = sum(1) / sum(0);
        let misfit = bent.iter().map(|p| p[2] * (p[1] - slope * p[0]).powi(2)).sum();
        Some((misfit, [beta, 0.0]))
    };
    let tried = (1..=TRIED).filter_map(|k| with_beta(1.5 * k as f64 / TRIED as f64));
    tried.min_by(|a, b| a.0.total_cmp(&b.0)).map_or([f64::NAN; 2], |best| best.1)
}
