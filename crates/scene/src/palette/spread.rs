//! Colours that are spread over a view's own times. Over the whole budget, a palette would show a
//! view that is narrower than the home map in few colours, and a deep one in a single colour.

use super::{TimeScale, rise};
use crate::{PictureTable, Scale};

/// The width of views, in rad, from which on colours are spread over the whole budget.
const HOME_RAD: f64 = std::f64::consts::TAU;
/// Octaves of zoom over which colours change from the budget's to the view's own.
const OCTAVES: f64 = 4.0;
/// Number of equal steps of colour between the times.
const STEPS: usize = 32;
/// Share of each end of the times that is left out of their range.
const OUTLIERS: f64 = 0.01;
/// Weight of equal numbers of pixels beside that of equal ratios of time.
const EQUALISED: f64 = 0.5;
/// Range of a view's times in s below which all of it has practically one time.
const FLAT_SECS: f64 = 1e-3;
/// Longer side, in pixels, of the small picture of a view whose times are used.
const SIDE_PX: u32 = 64;

/// The times of a view, sorted.
#[derive(Clone, Debug)]
pub struct ViewTimes(Vec<f64>);

impl ViewTimes {
    /// Takes a view's times in s, those of a picture of [`ViewTimes::grid`] pixels; times that no
    /// colour can stand for are left out.
    pub fn new(times: impl Iterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = times.filter(|secs| PictureTable::SECS.contains(secs)).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        ViewTimes(sorted)
    }

    /// Returns the number of different times.
    pub fn distinct(&self) -> usize {
        self.0.chunk_by(|one, other| one == other).count()
    }

    /// Returns the size of the small picture of a view whose times are used. It has the shape of
    /// the whole picture, so that colours do not depend on the picture's size.
    pub fn grid(size: [u32; 2]) -> [u32; 2] {
        let longest = size[0].max(size[1]);
        if longest <= SIDE_PX {
            return size;
        }
        let small = |side: u32| u64::from(side) * u64::from(SIDE_PX) / u64::from(longest);
        size.map(|side| (small(side) as u32).max(1))
    }

    /// Returns the weight of a view's own times beside the budget's, by the view's width: from 0,
    /// for the home map and wider views, to 1.
    pub fn weight(width_rad: f64) -> f64 {
        ((HOME_RAD / width_rad).log2() / OCTAVES).clamp(0.0, 1.0)
    }

    /// Returns the largest difference of times in s, without outliers, if it is so small that the
    /// view has practically one time.
    pub fn flat_secs(&self) -> Option<f64> {
        let [first, last] = self.range()?;
        (last - first < FLAT_SECS).then_some(last - first)
    }

    /// Returns [`PictureTable::times`] of a view whose own times have this weight; otherwise its
    /// colours run over `budget_range_secs`. Empty if the weight is 0 or there are no two different
    /// times.
    pub fn spread(&self, weight: f64, budget_range_secs: [f64; 2]) -> Vec<f64> {
        let Some([first, last]) = self.range() else { return Vec::new() };
        if !rise(&[first, last]) || weight == 0.0 {
            return Vec::new();
        }
        let of_budget = TimeScale::new(Scale::Log, budget_range_secs.to_vec());
        let time = |step: usize| {
            let height = step as f64 / STEPS as f64;
            let own = self.secs_at(height, [first, last]);
            let common = of_budget.secs_at(height);
            common * (own / common).powf(weight)
        };
        let all: Vec<f64> = (0..=STEPS).map(time).collect();
        let decimals = decimals(all[STEPS] - all[0]);
        let mut times: Vec<f64> = Vec::new();
        for secs in all.into_iter().map(|secs| (secs * decimals).round() / decimals) {
            if times.last().is_none_or(|&before| rise(&[before, secs])) {
                times.push(secs);
            }
        }
        if times.len() < 2 { Vec::new() } else { times }
    }

    /// Returns the first and the last time without outliers.
    fn range(&self) -> Option<[f64; 2]> {
        let last = self.0.len().checked_sub(1)?;
        let outliers = (last as f64 * OUTLIERS) as usize;
        Some([self.0[outliers], self.0[last - outliers]])
    }

    /// Returns the time at a height from 0 to 1: the share of earlier times, mixed with the share
    /// of the range in logarithms, is that height.
    fn secs_at(&self, height: f64, [first, last]: [f64; 2]) -> f64 {
        let count = (self.0.len() - 1) as f64;
        let height_of = |at: usize| {
            let ratio = (self.0[at] / first).ln() / (last / first).ln();
            EQUALISED * at as f64 / count + (1.0 - EQUALISED) * ratio.clamp(0.0, 1.0)
        };
        // Both shares rise with the time.
        let (mut below, mut above) = (0, self.0.len() - 1);
        while above - below > 1 {
            let middle = usize::midpoint(below, above);
            *(if height_of(middle) <= height { &mut below } else { &mut above }) = middle;
        }
        let [from, to] = [below, above].map(height_of);
        let within = if to > from { ((height - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        let secs = self.0[below] * (self.0[above] / self.0[below]).powf(within);
        secs.clamp(first, last)
    }
}

/// Returns the power of ten to which times are rounded, so that steps of colour over a range of
/// this length in s move by less than what can be seen.
fn decimals(range_secs: f64) -> f64 {
    10f64.powi((ROUNDED_DIGITS - range_secs.log10()).ceil() as i32)
}

/// Digits of the range of times to which each of them is rounded.
const ROUNDED_DIGITS: f64 = 4.0;

#[cfg(test)]
mod tests {
    use super::*;

    const BUDGET: [f64; 2] = [0.3, 30.0];

    fn view(times: &[f64]) -> ViewTimes {
        ViewTimes::new(times.iter().copied())
    }

    fn even(from: f64, to: f64, count: u32) -> Vec<f64> {
        (0..count).map(|k| from + (to - from) * f64::from(k) / f64::from(count - 1)).collect()
    }

    #[test]
    fn wide_views_keep_the_budget_and_narrow_ones_have_their_own() {
        let times = view(&even(2.0, 2.4, 1000));
        assert!(times.spread(ViewTimes::weight(7.0), BUDGET).is_empty());
        let nearly = times.spread(ViewTimes::weight(6.2), BUDGET);
        assert!((nearly[0] / 0.3 - 1.0).abs() < 0.02 && nearly[STEPS] > 29.0, "{nearly:?}");
        let own = times.spread(ViewTimes::weight(0.3), BUDGET);
        assert!(own[0] >= 2.0 && own[STEPS] <= 2.4 && own.len() == STEPS + 1, "{own:?}");
        assert_eq!(
            times.spread(ViewTimes::weight(1e-9), BUDGET),
            own,
            "the same times have the same colours"
        );
    }

    #[test]
    fn equal_times_count_once() {
        assert_eq!(view(&[]).distinct(), 0);
        assert_eq!(view(&[2.0, 1.0, 2.0, 2.0, 3.0]).distinct(), 3);
    }

    #[test]
    fn colours_change_gradually_with_the_width() {
        let times = view(&even(2.0, 2.4, 1000));
        let mut before = times.spread(ViewTimes::weight(6.2), BUDGET);
        for step in 1..=400 {
            let after = times.spread(ViewTimes::weight(6.2 * 0.99f64.powi(step)), BUDGET);
            let moved = before.iter().zip(&after).map(|(a, b)| (b / a).ln().abs());
            assert!(moved.fold(0.0, f64::max) < 0.02, "{step}");
            before = after;
        }
    }

    #[test]
    fn half_of_the_colours_follow_the_number_of_pixels() {
        // Nine in ten flip early, one in ten late.
        let mut all = even(1.0, 1.1, 900);
        all.extend(even(1.1, 10.0, 100));
        let times = view(&all).spread(1.0, BUDGET);
        let early = times.iter().filter(|secs| **secs < 1.1).count();
        assert!((12..22).contains(&early), "{early} of {} steps", times.len());
    }

    #[test]
    fn a_few_other_answers_hardly_move_the_colours() {
        let all = even(1.0, 9.0, 2560);
        // Two engines differ in some chaotic pixels.
        let other = all
            .iter()
            .enumerate()
            .map(|(k, secs)| if k % 97 == 0 { 9.0 - secs / 2.0 } else { *secs });
        let [a, b] = [view(&all), ViewTimes::new(other)].map(|times| times.spread(1.0, BUDGET));
        let scales = [a, b].map(|times| TimeScale::new(Scale::Log, times));
        for secs in even(1.0, 9.0, 100) {
            let [a, b] = [0, 1].map(|k: usize| scales[k].height(secs));
            assert!((a - b).abs() < 3.0 / 255.0, "{secs}: {a} {b}");
        }
    }

    #[test]
    fn flat_views_say_so_and_views_without_flips_keep_their_colours() {
        assert!(view(&[]).spread(1.0, BUDGET).is_empty() && view(&[]).flat_secs().is_none());
        assert!(view(&[2.0; 50]).spread(1.0, BUDGET).is_empty());
        assert_eq!(view(&[2.0; 50]).flat_secs(), Some(0.0));
        let times = view(&even(2.0, 2.0 + 3e-9, 1000));
        assert!((times.flat_secs().unwrap() / 3e-9 - 1.0).abs() < 0.1);
        assert!(times.spread(ViewTimes::weight(1e-9), BUDGET).len() > STEPS / 2);
        assert!(view(&even(2.0, 2.1, 100)).flat_secs().is_none());
    }

    proptest::proptest! {
        #[test]
        fn spread_times_can_always_be_used(
            times in proptest::collection::vec(1e-9..1e6f64, 0..200),
            width in 1e-30..6.0f64,
        ) {
            let times = ViewTimes::new(times.into_iter()).spread(ViewTimes::weight(width), BUDGET);
            let picture = PictureTable { times, ..PictureTable::default() };
            proptest::prop_assert!(picture.check().is_ok(), "{:?}", picture.times);
        }
    }
}
