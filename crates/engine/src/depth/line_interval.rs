//! Intervals of a line, and the answers that the samples of an interval give to the starts between
//! them.

use crate::FinalState;
use flipmap_pendulum::flip::right_secs;
use flipmap_pendulum::flow_patch::CurvePoint;
use flipmap_pendulum::{Outcome, Status};

/// Level of the longest intervals; an interval of level n is 2^−n half patches long.
pub(super) const COARSEST: i32 = 1;
/// Level of the shortest intervals, at which a jump is narrowed down to a hundredth of a pixel.
pub(super) const FINEST: i32 = 9;
/// Level from which on intervals with several jumps are not halved: they are a sixteenth of a pixel
/// long.
const UNRESOLVED: i32 = 6;
/// Least number of jumps between samples that counts as several.
const SEVERAL: usize = 2;
/// Level at which sampling the whole line of a patch as large as a leaf would take an eighth as
/// many samples as the patch has pixels.
const DEEPEST_IN_LEAF: i32 = 6;
/// Number of samples of an interval, both ends included.
pub(super) const SAMPLES: usize = 5;
/// Largest error of interpolation, and also that of the residual, as a share of the largest error
/// of a right answer.
const SHARE: f64 = 0.2;
/// Least ratio of the distance that a bob has kept from the top to the second differences of the
/// samples' ends at which no start between the samples can have flipped. The height at which a bob
/// turns round bends less along the line than the ends, which come later, and only by bending could
/// it reach the top and return between two samples.
const CLEAR: f64 = 4.0;
/// Largest distance between neighbouring ends that still belong together.
const MAX_END_DISTANCE: f64 = 0.3;

/// An interval of s, from `place` · 2^−`level` to (`place` + 1) · 2^−`level`, with starts in it.
pub(super) struct Interval {
    pub level: i32,
    pub place: i32,
    /// The starts by their indices in the job.
    pub starts: Vec<(usize, CurvePoint)>,
}

/// The end of a pendulum on the line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    pub outcome: Outcome,
    pub end: FinalState,
}

/// The result of judging an interval by its samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum IntervalVerdict {
    /// All starts flip, at times (s) given by the polynomial with these values at the five samples.
    Flips([f64; SAMPLES]),
    /// No start flips.
    Unflipped,
    /// Something happens in between. The value is the number of neighbouring pairs that do not
    /// belong together.
    Rough(usize),
}

impl Interval {
    /// Creates the interval of a level in which the point `s` lies, without starts.
    pub(super) fn around(level: i32, s: f64) -> Self {
        Interval { level, place: (s * 2f64.powi(level)).floor() as i32, starts: Vec::new() }
    }

    /// Returns true if halving a rough interval with `jumps` jumps is expected to help, in a patch
    /// whose area in leaves has the binary logarithm `area`.
    pub(super) fn can_be_halved(&self, jumps: usize, area: i32) -> bool {
        let deepest = if jumps < SEVERAL { FINEST } else { UNRESOLVED };
        self.level < deepest.min(DEEPEST_IN_LEAF + area)
    }

    /// The places of its samples, in units of 2^−`places`.
    pub(super) fn places(&self, places: i32) -> [i32; SAMPLES] {
        let quarter = 1 << (places - self.level - 2);
        std::array::from_fn(|k| (4 * self.place + k as i32) * quarter)
    }

    /// Returns those of its halves that have starts.
    pub(super) fn halves(self) -> impl Iterator<Item = Interval> {
        let (level, place) = (self.level + 1, 2 * self.place);
        let middle = f64::from(place + 1) * 0.5f64.powi(level);
        let (lower, upper): (Vec<_>, Vec<_>) =
            self.starts.into_iter().partition(|(_, point)| point.s < middle);
        let halves = [
            Interval { level, place, starts: lower },
            Interval { level, place: place + 1, starts: upper },
        ];
        halves.into_iter().filter(|half| !half.starts.is_empty())
    }

    /// Finds the outcomes of the starts in a smooth interval of a line that begins at `since_secs`.
    /// Starts whose residual may matter are added to `alone`, to be integrated one by one.
    pub(super) fn settle(
        &self,
        verdict: &IntervalVerdict,
        [since_secs, unit_secs]: [f64; 2],
        known: &mut Vec<(usize, Outcome)>,
        alone: &mut Vec<usize>,
    ) {
        for (index, point) in &self.starts {
            let IntervalVerdict::Flips(secs) = verdict else {
                known.push((*index, Outcome::without_time(Status::Unflipped)));
                continue;
            };
            // Runs from −2 to 2, with the samples at integers.
            let x = 4.0 * (point.s * 2f64.powi(self.level) - f64::from(self.place)) - 2.0;
            let (time, rate) = quartic(secs, x);
            let per_s = rate * 4.0 * 2f64.powi(self.level);
            let flips = time - point.ahead * unit_secs;
            let is_told = point.aside * per_s.abs() <= SHARE * right_secs(unit_secs);
            if is_told && flips >= since_secs {
                known.push((*index, Outcome::flipped(flips)));
            } else {
                alone.push(*index);
            }
        }
    }
}

/// Value and derivative at `x` of the polynomial of degree 4 with given values at −2, −1, 0, 1, 2
/// (Newton's form of divided differences).
fn quartic(values: &[f64; SAMPLES], x: f64) -> (f64, f64) {
    let mut c = *values;
    for order in 1..SAMPLES {
        for k in (order..SAMPLES).rev() {
            c[k] = (c[k] - c[k - 1]) / order as f64;
        }
    }
    let (mut value, mut rate) = (0.0, 0.0);
    for (k, c) in c.iter().enumerate().rev() {
        let from = x - (k as f64 - 2.0);
        (value, rate) = (value * from + c, rate * from + value);
    }
    (value, rate)
}

impl IntervalVerdict {
    /// Judges an interval by its samples, from one end to the other.
    pub(super) fn on(samples: [&Sample; SAMPLES], unit_secs: f64) -> Self {
        let jumps = samples.windows(2).filter(|pair| !pair[0].belongs_to(pair[1])).count();
        let status = samples[0].outcome.status;
        if !matches!(status, Status::Answered | Status::Unflipped) {
            return IntervalVerdict::Rough(SAMPLES);
        }
        if jumps > 0 {
            return IntervalVerdict::Rough(jumps);
        }
        let ends = samples.map(Sample::place);
        let bent = |e: &[[f64; 5]]| size(|i| e[0][i] - 2.0 * e[1][i] + e[2][i]);
        let bend = ends.windows(3).map(bent).fold(0.0, f64::max);
        let clearance = samples.iter().map(|sample| sample.end.clearance).fold(f64::MAX, f64::min);
        if clearance < CLEAR * bend {
            return IntervalVerdict::Rough(jumps);
        }
        if status == Status::Unflipped {
            return IntervalVerdict::Unflipped;
        }
        let secs = samples.map(|sample| sample.outcome.time);
        // Distance of the middle sample from the cubic through the other four.
        let off = (secs[0] - 4.0 * secs[1] + 6.0 * secs[2] - 4.0 * secs[3] + secs[4]) / 6.0;
        if off.abs() <= SHARE * right_secs(unit_secs) {
            IntervalVerdict::Flips(secs)
        } else {
            IntervalVerdict::Rough(jumps)
        }
    }
}

impl Sample {
    /// Returns true if the sample ends as its neighbour does and near it; false for NaN.
    fn belongs_to(&self, neighbour: &Sample) -> bool {
        self.distance(neighbour) <= MAX_END_DISTANCE
    }

    /// Returns the distance between two ends; infinite if only one of the two has flipped.
    pub(super) fn distance(&self, other: &Sample) -> f64 {
        let (a, b) = (self.place(), other.place());
        let alike = self.outcome.status == other.outcome.status;
        if alike { size(|i| b[i] - a[i]) } else { f64::INFINITY }
    }

    /// The end: unit vectors, and reduced time.
    fn place(&self) -> [f64; 5] {
        let [x1, y1, x2, y2, ..] = self.end.phase;
        [x1, y1, x2, y2, self.end.time]
    }
}

/// Length of a difference of ends.
fn size(difference: impl Fn(usize) -> f64) -> f64 {
    (0..5).map(|i| difference(i).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::crossing::FAR;

    fn samples(time: impl Fn(f64) -> f64, clearance: f64) -> [Sample; SAMPLES] {
        std::array::from_fn(|k| {
            let time = time(k as f64 - 2.0);
            let end = FinalState { time, phase: [1.0; 6], clearance, ..FinalState::NOWHERE };
            Sample { outcome: Outcome::flipped(time), end }
        })
    }

    #[test]
    fn smooth_times_are_interpolated_and_others_are_not() {
        let smooth = |x: f64| 7.0 + 0.1 * x - 0.02 * x * x + 0.003 * x.powi(3);
        let verdict = IntervalVerdict::on(samples(smooth, FAR).each_ref(), 1.0);
        let IntervalVerdict::Flips(secs) = verdict else { panic!("{verdict:?}") };
        let (value, rate) = quartic(&secs, 0.7);
        assert!((value - smooth(0.7)).abs() < 1e-12);
        assert!((rate - (0.1 - 0.04 * 0.7 + 0.009 * 0.49)).abs() < 1e-12);
        let rough = |x: f64| if x < 0.5 { 7.0 } else { 7.1 };
        assert_eq!(
            IntervalVerdict::on(samples(rough, FAR).each_ref(), 1.0),
            IntervalVerdict::Rough(0)
        );
        // A bob came so near the top that a start in between may have flipped there.
        assert_eq!(
            IntervalVerdict::on(samples(smooth, 0.01).each_ref(), 1.0),
            IntervalVerdict::Rough(0)
        );
        let mut mixed = samples(smooth, FAR);
        mixed[3].outcome = Outcome::without_time(Status::Unflipped);
        assert_eq!(IntervalVerdict::on(mixed.each_ref(), 1.0), IntervalVerdict::Rough(2));
    }

    #[test]
    fn starts_go_to_their_half() {
        let point = |s: f64| (0, CurvePoint { s, ahead: 0.0, aside: 0.0 });
        let interval = Interval { level: 1, place: -3, starts: vec![point(-1.4), point(-1.1)] };
        assert_eq!(interval.places(7), [-192, -176, -160, -144, -128]);
        let halves: Vec<_> = interval.halves().map(|half| (half.level, half.place)).collect();
        assert_eq!(halves, [(2, -6), (2, -5)]);
    }

    #[test]
    fn a_residual_that_counts_sends_a_start_off_alone() {
        let (mut known, mut alone) = (Vec::new(), Vec::new());
        let start = |index, aside| (index, CurvePoint { s: 0.25, ahead: 0.5, aside });
        let interval =
            Interval { level: 0, place: 0, starts: vec![start(0, 1e-6), start(1, 1e-2)] };
        let verdict = IntervalVerdict::Flips([5.0, 5.1, 5.2, 5.3, 5.4]);
        interval.settle(&verdict, [0.0, 0.32], &mut known, &mut alone);
        assert!(known.len() == 1 && known[0].0 == 0 && alone == [1]);
        assert!((known[0].1.time - (5.1 - 0.16)).abs() < 1e-12);
    }
}
