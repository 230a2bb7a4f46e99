//! The share without an event against time, and the law of its tail.

use serde::{Deserialize, Serialize};

use crate::estimate::{NORMAL, mean_and_error, quantile_t};
use crate::shares::{ClassCounts, share};
use crate::{Estimate, EstimateError};

/// The lives of one replicate.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Lives {
    /// Times of sure events.
    pub sure: Vec<f64>,
    /// Times at which unsure events seem to happen.
    pub seeming: Vec<f64>,
    /// Number of sure survivors of the budget.
    pub survivors: u64,
    /// Number of those that seem to survive it, of which nobody is sure.
    pub seeming_survivors: u64,
}

/// A point of a survival curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurvivalPoint {
    /// The time.
    pub time: f64,
    /// The share without an event until then.
    pub share: Estimate,
}

/// The law that a tail seems to follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Law {
    /// Exponential, with a rate.
    Exponential,
    /// A power of time.
    Power,
    /// Neither is better by 95 %.
    Undecided,
}

/// The tail of a survival curve. Both laws are fitted to the events between `since` and the budget
/// alone, so that starts that never have one distort neither.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tail {
    /// Time from which on the laws are fitted.
    pub since: f64,
    /// Number of events since then.
    pub events: usize,
    /// Rate of the exponential law, per unit of time.
    pub rate: Estimate,
    /// Exponent of the power law, S ∝ t^−exponent.
    pub exponent: Estimate,
    /// Vuong's statistic (1989, Econometrica 57, 307), positive where the exponential law fits better.
    pub vuong: f64,
    /// The law that fits better.
    pub law: Law,
}

impl Lives {
    fn total(&self) -> f64 {
        let events = self.sure.len() + self.seeming.len();
        events as f64 + (self.survivors + self.seeming_survivors) as f64
    }

    /// Counts the lives that last longer than `time`, and the others.
    fn counts(&self, time: f64) -> ClassCounts {
        let split = |times: &[f64], survivors: u64| {
            let later = times.iter().filter(|t| **t > time).count() as u64;
            vec![survivors + later, times.len() as u64 - later]
        };
        ClassCounts {
            sure: split(&self.sure, self.survivors),
            unsure: split(&self.seeming, self.seeming_survivors),
        }
    }
}

/// Smallest number of lives of a curve.
const LEAST_LIVES: usize = 100;

/// Returns the survival curve at some times.
pub fn survival(replicates: &[Lives], times: &[f64]) -> Result<Vec<SurvivalPoint>, EstimateError> {
    let have = replicates.iter().map(Lives::total).sum::<f64>() as usize;
    if have < LEAST_LIVES {
        return Err(EstimateError::TooFew { what: "lives", have, need: LEAST_LIVES });
    }
    let point = |time: &f64| {
        let counts: Vec<ClassCounts> = replicates.iter().map(|lives| lives.counts(*time)).collect();
        Ok(SurvivalPoint { time: *time, share: share(&counts, 0)? })
    };
    times.iter().map(point).collect()
}

/// Smallest number of events of a tail.
const FEWEST: usize = 1000;
/// Number of beginnings of the tail that are tried.
const BEGINNINGS: usize = 24;

/// Fits the tail up to `budget`. It begins where the better law fits best, by the distance of
/// Kolmogorov and Smirnov (Clauset, Shalizi and Newman 2009, SIAM Rev. 51, 661).
pub fn tail(replicates: &[Lives], budget: f64) -> Result<Tail, EstimateError> {
    let times =
        |lives: &Lives| lives.sure.iter().chain(&lives.seeming).copied().collect::<Vec<_>>();
    let each: Vec<Vec<f64>> = replicates.iter().map(times).collect();
    let mut all: Vec<f64> = each.concat();
    all.sort_by(f64::total_cmp);
    if all.len() < FEWEST {
        let (have, need) = (all.len(), FEWEST);
        return Err(EstimateError::TooFew { what: "events", have, need });
    }
    let latest = all[all.len() - FEWEST];
    let earliest = all[all.len() / 10].max(1e-9);
    let begin = |k: usize| earliest * (latest / earliest).powf(k as f64 / (BEGINNINGS - 1) as f64);
    let misfit = |since: &f64| {
        let events = &all[all.partition_point(|t| t <= since)..];
        LAWS.iter().map(|law| distance(law, events, *since, budget)).fold(f64::INFINITY, f64::min)
    };
    let tried = (0..BEGINNINGS).map(begin).map(|since| (misfit(&since), since));
    let since = tried.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(latest, |(_, since)| since);
    let events = &all[all.partition_point(|t| *t <= since)..];
    let [rate, exponent] = LAWS.map(|law| {
        let of = |times: &[f64]| {
            let late: Vec<f64> = times.iter().copied().filter(|t| *t > since).collect();
            decay(&law, &late, since, budget)
        };
        let each: Vec<f64> = each.iter().map(|times| of(times)).filter(|k| k.is_finite()).collect();
        let value = of(events);
        let by = match each.len() {
            0..4 => f64::INFINITY,
            n => quantile_t(n - 1) * mean_and_error(&each).1,
        };
        Estimate { value, low: value - by, high: value + by }
    });
    let likelier = |t: &f64| {
        LAWS[0].log_density(*t, rate.value, since, budget)
            - LAWS[1].log_density(*t, exponent.value, since, budget)
    };
    let differences: Vec<f64> = events.iter().map(likelier).collect();
    let (mean, error) = mean_and_error(&differences);
    let vuong = mean / error;
    let law = match vuong {
        z if z > NORMAL => Law::Exponential,
        z if z < -NORMAL => Law::Power,
        _ => Law::Undecided,
    };
    Ok(Tail { since, events: events.len(), rate, exponent, vuong, law })
}

/// A law of decay, in a measure of time in which it is exponential.
#[derive(Clone, Copy)]
struct Decay {
    /// Returns the measure of the time from the beginning of the tail.
    measure: fn(f64, f64) -> f64,
    /// Returns the logarithm of the measure's derivative by time.
    log_slope: fn(f64) -> f64,
}

const LAWS: [Decay; 2] = [
    Decay { measure: |t, since| t - since, log_slope: |_| 0.0 },
    Decay { measure: |t, since| (t / since).ln(), log_slope: |t| -t.ln() },
];

impl Decay {
    /// Logarithm of the density of an event at `time` between the beginning of the tail and its end.
    fn log_density(&self, time: f64, k: f64, since: f64, end: f64) -> f64 {
        let (u, whole) = ((self.measure)(time, since), (self.measure)(end, since));
        let norm = if (k * whole).abs() < 1e-9 { whole } else { -(-k * whole).exp_m1() / k };
        -k * u - norm.ln() + (self.log_slope)(time)
    }

    /// The share of the tail's events until `time`.
    fn cdf(&self, time: f64, k: f64, since: f64, end: f64) -> f64 {
        let (u, whole) = ((self.measure)(time, since), (self.measure)(end, since));
        match (k * whole).abs() < 1e-9 {
            true => u / whole,
            false => (-k * u).exp_m1() / (-k * whole).exp_m1(),
        }
    }
}

/// Returns the likeliest decay of events that are known to happen before `end`: the solution k of
/// 1/k − U/(e^{kU} − 1) = mean, with the measure U of the end.
fn decay(law: &Decay, events: &[f64], since: f64, end: f64) -> f64 {
    let whole = (law.measure)(end, since);
    let mean = events.iter().map(|t| (law.measure)(*t, since)).sum::<f64>() / events.len() as f64;
    let expected = |k: f64| match (k * whole).abs() < 1e-6 {
        true => 0.5 * whole - k * whole * whole / 12.0,
        false => 1.0 / k - whole / (k * whole).exp_m1(),
    };
    // The expected measure falls with k.
    let (mut low, mut high) = (-500.0 / whole, 500.0 / whole);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if expected(middle) > mean { low = middle } else { high = middle }
    }
    if mean.is_finite() { 0.5 * (low + high) } else { f64::NAN }
}

/// The distance of Kolmogorov and Smirnov between sorted events and the law that fits them best.
fn distance(law: &Decay, events: &[f64], since: f64, end: f64) -> f64 {
    let k = decay(law, events, since, end);
    let n = events.len() as f64;
    let apart = |(place, time): (usize, &f64)| {
        let share = law.cdf(*time, k, since, end);
        (share - place as f64 / n).abs().max((share - (place + 1) as f64 / n).abs())
    };
    events.iter().enumerate().map(apart).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scatter::random;

    const BUDGET: f64 = 30.0;

    /// Lives whose events begin at 1, of which a fifth never has one.
    fn lives(seed: u64, event: impl Fn(f64) -> f64) -> Vec<Lives> {
        let one = |k| {
            let mut rng = random(seed, k);
            let mut lives = Lives::default();
            for _ in 0..600 {
                let (is_immortal, time) = (rng.f64() < 0.2, event(rng.f64()));
                match is_immortal || time > BUDGET {
                    true => lives.survivors += 1,
                    false => lives.sure.push(time),
                }
            }
            lives
        };
        (0..16).map(one).collect()
    }

    #[test]
    fn the_law_and_its_number_are_found_although_a_fifth_never_has_an_event() {
        let exponential = tail(&lives(1, |u| 1.0 - (1.0 - u).ln() / 0.3), BUDGET).unwrap();
        assert_eq!(exponential.law, Law::Exponential);
        assert!(exponential.rate.contains(0.3), "{exponential:?}");
        let power = tail(&lives(2, |u| (1.0 - u).powf(-1.0 / 1.5)), BUDGET).unwrap();
        assert_eq!(power.law, Law::Power);
        assert!(power.exponent.contains(1.5), "{power:?}");
    }

    #[test]
    fn the_rates_interval_holds_in_95_of_100_seeds() {
        let holds = |seed: &u64| {
            let lives = lives(*seed, |u| 1.0 - (1.0 - u).ln() / 0.3);
            tail(&lives, BUDGET).unwrap().rate.contains(0.3)
        };
        let held = (10..110).filter(holds).count();
        assert!((90..=99).contains(&held), "{held} of 100");
    }

    #[test]
    fn a_curve_holds_the_true_share_and_unsure_lives_widen_it() {
        let mut all = lives(3, |u| 1.0 - (1.0 - u).ln() / 0.3);
        let truth = 0.2 + 0.8 * (-0.3 * 4.0f64).exp();
        let sure = survival(&all, &[0.5, 5.0]).unwrap();
        assert!(sure[0].share.value == 1.0 && sure[1].share.contains(truth), "{sure:?}");
        for lives in &mut all {
            let moved = lives.sure.split_off(lives.sure.len() - 60);
            lives.seeming.extend(moved);
        }
        let unsure = survival(&all, &[0.5, 5.0]).unwrap();
        assert!(unsure[1].share.value == sure[1].share.value);
        let wider = 2.0 * (unsure[1].share.half_width() - sure[1].share.half_width());
        assert!((wider - 0.1).abs() < 0.02, "{wider}");
    }

    #[test]
    fn few_events_are_refused() {
        let few = vec![Lives { sure: vec![2.0; 10], ..Lives::default() }; 16];
        let error = EstimateError::TooFew { what: "events", have: 160, need: FEWEST };
        assert_eq!(tail(&few, BUDGET), Err(error));
    }
}
