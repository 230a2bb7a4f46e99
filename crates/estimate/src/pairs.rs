//! The uncertainty exponent of a boundary.
//!
//! Of pairs of points ε apart, the share f(ε) whose classes differ falls as ε^α; the boundary has the
//! dimension D = 2 − α (McDonald, Grebogi, Ott and Yorke 1985, Physica D 17, 125).

use serde::{Deserialize, Serialize};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::estimate::NORMAL;
use crate::line::FittedLine;
use crate::{Estimate, EstimateError, scatter};

/// Independent pairs of points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PairCounts {
    /// Number of pairs whose classes surely differ.
    pub differing: u64,
    /// Number of pairs of which nobody is sure.
    pub unsure: u64,
    /// Number of unsure pairs whose classes seem to differ.
    pub seeming: u64,
    /// Number of all pairs.
    pub total: u64,
}

/// The pairs at one distance, in groups that are independent of each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PairScale {
    /// Distance of the points of each pair.
    pub epsilon: f64,
    /// The pairs.
    pub groups: Vec<PairCounts>,
}

/// What the pairs at all distances say.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Exponent {
    /// The exponent α over the window.
    pub alpha: Estimate,
    /// The dimension of the boundary, D = 2 − α.
    pub dimension: Estimate,
    /// Greatest and least ε of the window, the longest stretch whose points lie on a straight line.
    pub window: [f64; 2],
    /// α between each distance and the next smaller one.
    pub local: Vec<Estimate>,
    /// Distance below which α holds 1 although it is smaller above: what is left of the boundary there
    /// is smooth.
    pub smooth_below: Option<f64>,
}

/// How unsure pairs are counted.
type Reading = fn(&PairCounts) -> u64;

const READINGS: [Reading; 3] = [
    |pairs| pairs.differing + pairs.seeming,
    |pairs| pairs.differing,
    |pairs| pairs.differing + pairs.unsure,
];

/// Smallest number of differing pairs at a distance that takes part in a fit.
const FEWEST: u64 = 20;
/// Smallest number of distances of a window.
const SHORTEST: usize = 3;
/// Chance of a misfit as large as the window's by accident, below which it is not straight.
const STRAIGHT: f64 = 1e-3;
/// Number of resamplings of a bootstrap.
const RESAMPLES: usize = 1000;

impl PairScale {
    fn sum(&self, part: Reading) -> u64 {
        self.groups.iter().map(part).sum()
    }

    /// The share of pairs whose classes differ.
    pub fn share(&self) -> Estimate {
        let [differing, unsure] = [self.sum(|p| p.differing), self.sum(|p| p.unsure)];
        Estimate::of_trials(differing, unsure, self.sum(|p| p.seeming), self.sum(|p| p.total))
    }

    /// Returns ln ε, ln f and the weight of ln f, for one way of counting; `picked` are the groups.
    fn point(&self, reading: Reading, picked: &[usize]) -> [f64; 3] {
        let sum = |part: Reading| picked.iter().map(|k| part(&self.groups[*k])).sum::<u64>() as f64;
        let total = sum(|pairs| pairs.total);
        // Half a pair more keeps a resampling without differing pairs finite.
        let share = (sum(reading)).max(0.5) / total;
        [self.epsilon.ln(), share.ln(), total * share / (1.0 - share).max(0.5 / total)]
    }

    fn whole(&self, reading: Reading) -> [f64; 3] {
        let all: Vec<usize> = (0..self.groups.len()).collect();
        self.point(reading, &all)
    }
}

/// Estimates the exponent from pairs at several distances, the greatest first. Distances above
/// `coarsest` take no part in the fit: they feel the shape of the whole region.
pub fn exponent(scales: &[PairScale], coarsest: f64, seed: u64) -> Result<Exponent, EstimateError> {
    let local: Vec<Estimate> = scales.windows(2).map(|two| slope(&two[0], &two[1])).collect();
    let window = window(scales, coarsest)?;
    let alpha = bootstrapped(&scales[window.clone()], seed);
    let smooth_below = smooth_below(scales, &local, &alpha);
    Ok(Exponent {
        alpha,
        dimension: alpha.mapped(-1.0, 2.0),
        window: [scales[window.start].epsilon, scales[window.end - 1].epsilon],
        local,
        smooth_below,
    })
}

/// Returns α between two distances.
fn slope(coarse: &PairScale, fine: &PairScale) -> Estimate {
    let along = (coarse.epsilon / fine.epsilon).ln();
    let slopes = READINGS.map(|reading| {
        let [[_, above, _], [_, below, _]] = [coarse.whole(reading), fine.whole(reading)];
        (above - below) / along
    });
    let error = [coarse, fine].map(|scale| 1.0 / scale.whole(READINGS[0])[2]);
    let by = NORMAL * (error[0] + error[1]).sqrt() / along;
    let [value, a, b] = slopes;
    Estimate { value, low: value.min(a).min(b) - by, high: value.max(a).max(b) + by }
}

/// Returns the longest stretch of distances on a straight line, the finest of equally long ones.
fn window(scales: &[PairScale], coarsest: f64) -> Result<std::ops::Range<usize>, EstimateError> {
    let counts = |scale: &PairScale| scale.sum(READINGS[0]);
    let is_usable = |scale: &PairScale| counts(scale) >= FEWEST && scale.epsilon <= coarsest;
    if scales.iter().all(|scale| counts(scale) == 0) {
        return Err(EstimateError::OneClass);
    }
    let first = scales.iter().position(is_usable).unwrap_or(scales.len());
    let usable = scales[first..].iter().take_while(|scale| is_usable(scale)).count();
    let is_straight = |range: &std::ops::Range<usize>| {
        let points: Vec<[f64; 3]> =
            scales[range.clone()].iter().map(|scale| scale.whole(READINGS[0])).collect();
        let freedom = (points.len() - 2) as f64;
        let chance = |line: FittedLine| {
            ChiSquared::new(freedom).map_or(0.0, |chi| 1.0 - chi.cdf(line.misfit))
        };
        FittedLine::fit(&points).map_or(0.0, chance) >= STRAIGHT
    };
    let ranges = (SHORTEST..=usable).rev().flat_map(|length| {
        (0..=usable - length).rev().map(move |from| first + from..first + from + length)
    });
    if usable < SHORTEST {
        let what = "distances with enough pairs that differ";
        return Err(EstimateError::TooFew { what, have: usable, need: SHORTEST });
    }
    ranges.into_iter().find(is_straight).ok_or(EstimateError::NotStraight)
}

/// Returns the slope of the scales with a bootstrapped interval.
fn bootstrapped(scales: &[PairScale], seed: u64) -> Estimate {
    let groups = scales.iter().map(|scale| scale.groups.len()).min().unwrap_or(0);
    let mut rng = scatter::random(seed, 0x70a1);
    let mut fitted = |reading: Reading, is_resampled: bool| {
        let point = |scale: &PairScale| {
            let pick = |k: usize| if is_resampled { rng.usize(..groups) } else { k };
            let picked: Vec<usize> = (0..groups).map(pick).collect();
            scale.point(reading, &picked)
        };
        let points: Vec<[f64; 3]> = scales.iter().map(point).collect();
        FittedLine::fit(&points).map_or(f64::NAN, |line| line.slope)
    };
    let value = fitted(READINGS[0], false);
    let mut all = Estimate::exact(value);
    for reading in READINGS {
        let middle = fitted(reading, false);
        let mut slopes: Vec<f64> = (0..RESAMPLES).map(|_| fitted(reading, true)).collect();
        slopes.sort_by(f64::total_cmp);
        // Groups are few: their spread is too small by this much.
        let wider = (groups as f64 / (groups as f64 - 1.0)).sqrt();
        let end =
            |share: f64| middle + wider * (slopes[(share * RESAMPLES as f64) as usize] - middle);
        all = all.and(Estimate { value, low: end(0.025), high: end(0.975) });
    }
    all
}

/// Returns the distance from which on every local slope holds 1, if the boundary is rougher above.
fn smooth_below(scales: &[PairScale], local: &[Estimate], alpha: &Estimate) -> Option<f64> {
    let is_known = |k: &usize| scales[k + 1].sum(READINGS[0]) >= FEWEST;
    let smooth = |k: &usize| local[*k].contains(1.0) || local[*k].low > 1.0;
    let known: Vec<usize> = (0..local.len()).filter(is_known).collect();
    let first = known.iter().rev().take_while(|k| smooth(k)).last()?;
    (alpha.high < 1.0).then_some(scales[*first].epsilon)
}
