//! Statistics of the answers' errors: shares and quantiles, overall and by flip time.

use serde::Serialize;

use flipmap_pendulum::{Outcome, Status};

/// Largest error of a flip time that counts as right, s.
pub(crate) const RIGHT_SECS: f64 = 1e-3;

/// Bounds of the bands of true flip times, s; the unflipped starts are a band of their own.
const BAND_BOUNDS: [f64; 6] = [0.0, 2.0, 5.0, 10.0, 20.0, 30.0];

/// Errors of the answers to some starts, against the truth.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Number of starts compared.
    pub compared: usize,
    /// Share of answers with the right status and, if flipped, within [`RIGHT_SECS`].
    pub right_1ms: Option<f64>,
    /// Share of answers whose status is not the true one.
    pub wrong_class: Option<f64>,
    /// Median of |Δt| in s over the starts that flip in both.
    pub median: Option<f64>,
    /// 90th percentile of that |Δt|, s.
    pub p90: Option<f64>,
    /// 99th percentile of that |Δt|, s.
    pub p99: Option<f64>,
    /// Largest |Δt| of those, s.
    pub max: Option<f64>,
}

/// The errors of the starts whose true flip time lies in a band.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Band {
    /// Name of the band: `2–5 s`, or `unflipped`.
    pub name: String,
    /// Errors of the starts in the band.
    #[serde(flatten)]
    pub errors: Errors,
}

/// An answer and the true outcome.
pub(crate) type OutcomePair = (Outcome, Outcome);

impl Errors {
    /// Computes the errors of some answers.
    pub(crate) fn of(pairs: &[OutcomePair]) -> Self {
        let share = |fits: fn(&OutcomePair) -> bool| {
            let count = pairs.iter().filter(|pair| fits(pair)).count();
            (!pairs.is_empty()).then(|| count as f64 / pairs.len() as f64)
        };
        let mut distances: Vec<f64> =
            pairs.iter().filter(|pair| both_flipped(pair)).map(distance).collect();
        distances.sort_by(f64::total_cmp);
        Errors {
            compared: pairs.len(),
            right_1ms: share(is_right),
            wrong_class: share(|(answer, truth)| answer.status != truth.status),
            median: quantile(&distances, 0.5),
            p90: quantile(&distances, 0.9),
            p99: quantile(&distances, 0.99),
            max: distances.last().copied(),
        }
    }
}

fn both_flipped((answer, truth): &OutcomePair) -> bool {
    answer.status == Status::Answered && truth.status == Status::Answered
}

fn distance((answer, truth): &OutcomePair) -> f64 {
    (answer.time - truth.time).abs()
}

/// Returns true if the status and, for a flip, the time (within [`RIGHT_SECS`]) match the truth.
pub(crate) fn is_right(pair: &OutcomePair) -> bool {
    let same = pair.0.status == pair.1.status;
    // Written so that a NaN is wrong.
    same && (pair.1.status != Status::Answered || distance(pair) <= RIGHT_SECS)
}

/// Computes the errors for each band of true flip times, including empty bands.
pub(crate) fn bands(pairs: &[OutcomePair]) -> Vec<Band> {
    let band = |name: String, fits: &dyn Fn(&Outcome) -> bool| {
        let inside: Vec<OutcomePair> = pairs.iter().filter(|pair| fits(&pair.1)).copied().collect();
        Band { name, errors: Errors::of(&inside) }
    };
    let timed = BAND_BOUNDS.windows(2).map(|bounds| {
        let (from, to) = (bounds[0], bounds[1]);
        // A flip at the end of the budget belongs to the last band.
        let last = to == BAND_BOUNDS[BAND_BOUNDS.len() - 1];
        band(format!("{from}–{to} s"), &|truth| {
            truth.status == Status::Answered
                && truth.time >= from
                && (truth.time < to || (last && truth.time <= to))
        })
    });
    let unflipped = band("unflipped".to_string(), &|truth| truth.status == Status::Unflipped);
    timed.chain([unflipped]).collect()
}

/// Returns the smallest member of `sorted` that at least a share `q` of the members do not exceed.
pub(crate) fn quantile(sorted: &[f64], q: f64) -> Option<f64> {
    let rank = (q * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.saturating_sub(1)).copied()
}

/// The median of numbers in any order.
pub(crate) fn median(numbers: &[f64]) -> Option<f64> {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    quantile(&sorted, 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flip(time: f64) -> Outcome {
        Outcome::flipped(time)
    }

    fn still() -> Outcome {
        Outcome::without_time(Status::Unflipped)
    }

    #[test]
    fn quantiles_are_members_and_count_from_the_least() {
        let hundred: Vec<f64> = (1..=100).map(f64::from).collect();
        let found = [0.0, 0.5, 0.9, 0.99, 1.0].map(|q| quantile(&hundred, q));
        assert_eq!(found, [1.0, 50.0, 90.0, 99.0, 100.0].map(Some));
        assert_eq!(quantile(&[], 0.5), None);
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
    }

    #[test]
    fn right_is_the_class_and_the_millisecond() {
        let right = |answer, truth| Errors::of(&[(answer, truth)]).right_1ms;
        assert_eq!(right(flip(2.0009), flip(2.0)), Some(1.0));
        assert_eq!(right(flip(2.0011), flip(2.0)), Some(0.0));
        assert_eq!(right(flip(f64::NAN), flip(2.0)), Some(0.0));
        assert_eq!(right(still(), still()), Some(1.0));
        assert_eq!(right(flip(2.0), still()), Some(0.0));
    }

    #[test]
    fn a_wrong_class_is_counted_and_has_no_distance() {
        let failed = Outcome::without_time(Status::Failed);
        let pairs =
            [(flip(1.0), still()), (failed, still()), (still(), still()), (still(), flip(1.0))];
        let errors = Errors::of(&pairs);
        assert_eq!((errors.wrong_class, errors.max), (Some(0.75), None));
        assert_eq!(Errors::of(&pairs[2..3]).wrong_class, Some(0.0));
    }

    #[test]
    fn the_worst_is_not_hidden_by_the_many() {
        let mut pairs = vec![(flip(3.0), flip(3.0)); 99];
        pairs.push((flip(4.0), flip(3.0)));
        let errors = Errors::of(&pairs);
        assert_eq!((errors.p99, errors.max), (Some(0.0), Some(1.0)));
        assert_eq!(errors.right_1ms, Some(0.99));
    }

    #[test]
    fn bands_go_by_the_true_time() {
        let pairs = [
            (flip(7.0), flip(1.0)),
            (flip(2.0), flip(2.0)),
            (flip(30.0), flip(30.0)),
            (still(), still()),
        ];
        let counts: Vec<usize> = bands(&pairs).iter().map(|band| band.errors.compared).collect();
        assert_eq!(counts, [1, 1, 0, 0, 1, 1]);
        let first = &bands(&pairs)[0];
        assert_eq!((first.name.as_str(), first.errors.max), ("0–2 s", Some(6.0)));
        assert_eq!(bands(&pairs)[2].errors, Errors::default());
    }
}
