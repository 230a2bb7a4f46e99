//! The colours of times. They run between fixed times, so that a colour means the same in every
//! tile of a picture.

use super::time_scale::TimeScale;
use super::{FAILED, Ground, Palette, Rgb, Tint, rounded};
use crate::{PictureTable, SceneError};
use flipmap_pendulum::{Outcome, Status};

/// A map from times to places in a palette.
#[derive(Clone, Debug, PartialEq)]
pub struct Tones {
    palette: Palette,
    ground: Ground,
    reverse: bool,
    /// True if every second run through the palette goes backwards.
    mirror: bool,
    cycles: f64,
    /// Number of runs through the palette that precede the first time.
    shift: f64,
    /// Index of the last run.
    last_run: f64,
    scale: TimeScale,
}

/// Colours at equal steps of the logarithm of time, for use where a table replaces the arithmetic.
#[derive(Clone, Debug, PartialEq)]
pub struct Lookup {
    /// Time of the first colour in s.
    pub first_secs: f64,
    /// Time of the last colour in s.
    pub last_secs: f64,
    /// Entry `k` of `n` is the colour at `first_secs · (last_secs / first_secs)^(k / (n − 1))`.
    pub colours: Vec<Rgb>,
    /// Largest distance in the palette between neighbouring entries, as a share of its length.
    pub max_gap: f64,
}

impl Tones {
    /// Returns the tones of a picture, for a pendulum with this natural unit of time and this
    /// budget. A picture without times of its own has [`budget_range_secs`].
    pub fn new(
        picture: &PictureTable,
        unit_secs: f64,
        budget_secs: f64,
    ) -> Result<Self, SceneError> {
        picture.check()?;
        let mut times = picture.times.clone();
        if times.is_empty() {
            times = budget_range_secs(unit_secs, budget_secs).to_vec();
        }
        let cycles = picture.cycles;
        let shift = picture.offset * if picture.mirror { 2.0 } else { 1.0 };
        Ok(Tones {
            palette: Palette::named(&picture.palette)?,
            ground: Ground::of(picture)?,
            reverse: picture.reverse,
            mirror: picture.mirror,
            cycles,
            shift,
            last_run: (cycles + shift).ceil() - 1.0,
            scale: TimeScale::new(picture.scale, times),
        })
    }

    /// Returns the scale of the times.
    pub fn scale(&self) -> &TimeScale {
        &self.scale
    }

    /// Returns the first and the last time with a colour of its own, in s.
    pub fn range_secs(&self) -> [f64; 2] {
        self.scale.range_secs()
    }

    /// Returns the position of a time in the palette, in [0, 1].
    pub fn position(&self, secs: f64) -> f64 {
        self.position_at(self.scale.height(secs))
    }

    /// Returns the position in the palette of a height on the scale of the times.
    fn position_at(&self, height: f64) -> f64 {
        let along = self.scale.coloured(height) * self.cycles + self.shift;
        // The last time is the end of the last run, not the beginning of another. The conversion
        // rounds down, because `floor` is a function call on most machines.
        let run = f64::from(along as u32).min(self.last_run);
        let within = along - run;
        let backwards = self.reverse != (self.mirror && run % 2.0 == 1.0);
        if backwards { 1.0 - within } else { within }
    }

    /// Returns the time at a share of the range in s, as a legend writes it beside its colours.
    pub(crate) fn secs_at(&self, share: f64) -> f64 {
        self.scale.secs_at(share)
    }

    /// Returns the colours of pixels without an answer and of the energy curve.
    pub fn ground(&self) -> Ground {
        self.ground
    }

    /// Returns the colour of a time in s, not rounded.
    pub(crate) fn tint_at(&self, secs: f64) -> Tint {
        self.palette.tint(self.position(secs))
    }

    /// Returns the colour of a time in s.
    pub(crate) fn colour_at(&self, secs: f64) -> Rgb {
        rounded(self.tint_at(secs))
    }

    /// Returns the colour of an outcome.
    pub fn colour(&self, outcome: &Outcome) -> Rgb {
        match outcome.status {
            Status::Answered => self.colour_at(outcome.time),
            Status::Unflipped => self.ground.unflipped,
            Status::Forbidden => self.ground.forbidden,
            Status::Failed => FAILED,
        }
    }

    /// Returns a table of `entries` colours, at least two, at equal steps of the logarithm of time.
    pub fn lookup(&self, entries: usize) -> Lookup {
        let [first_secs, last_secs] = self.range_secs();
        let last = entries.max(2) - 1;
        let secs = |k: usize| first_secs * (last_secs / first_secs).powf(k as f64 / last as f64);
        let colours = (0..=last).map(|k| self.colour_at(secs(k))).collect();
        let shares: Vec<f64> =
            (0..=last).map(|k| self.scale.coloured(self.scale.height(secs(k)))).collect();
        let most = shares.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        Lookup { first_secs, last_secs, colours, max_gap: most * self.cycles }
    }

    /// Returns a table of `entries` colours, at least two, at equal steps of height on `scale`,
    /// which may belong to other tones.
    pub fn over(&self, scale: &TimeScale, entries: usize) -> Vec<Rgb> {
        let last = (entries.max(2) - 1) as f64;
        let colour = |k: usize| {
            let height = k as f64 / last;
            let own = scale == &self.scale;
            let height = if own { height } else { self.scale.height(scale.secs_at(height)) };
            rounded(self.palette.tint(self.position_at(height)))
        };
        (0..entries.max(2)).map(colour).collect()
    }
}

/// Returns the range of times in s that colours run over unless a picture has times of its own. It
/// begins at the pendulum's natural unit of time, before which few flips come, and ends at the
/// budget. If the unit is at least half of the budget, it begins at a tenth of the budget.
pub fn budget_range_secs(unit_secs: f64, budget_secs: f64) -> [f64; 2] {
    let first_secs = if unit_secs < 0.5 * budget_secs { unit_secs } else { 0.1 * budget_secs };
    [first_secs, budget_secs]
}

/// Relative difference below which two times are the same.
const SAME: f64 = 1e-12;

/// Returns true if each time is later than the one before by more than rounding.
pub fn rise(times: &[f64]) -> bool {
    times.windows(2).all(|pair| pair[1] > pair[0] * (1.0 + SAME))
}

/// Returns times that divide `times` into at most `steps` steps of about equally many. As
/// [`PictureTable::times`], they make every colour about equally frequent. The result is empty if
/// there are fewer than two different times.
pub fn equalised(times: impl Iterator<Item = f64>, steps: usize) -> Vec<f64> {
    let steps = steps.clamp(1, PictureTable::MAX_TIMES - 1);
    let mut sorted: Vec<f64> = times.filter(|secs| PictureTable::SECS.contains(secs)).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let mut quantiles: Vec<f64> = Vec::new();
    let Some(last) = sorted.len().checked_sub(1) else { return quantiles };
    for step in 0..=steps {
        let secs = sorted[(step as f64 * last as f64 / steps as f64).round() as usize];
        if quantiles.last().is_none_or(|&before| rise(&[before, secs])) {
            quantiles.push(secs);
        }
    }
    if quantiles.len() < 2 { Vec::new() } else { quantiles }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scale;
    use proptest::prelude::*;

    fn tones(change: impl FnOnce(&mut PictureTable)) -> Tones {
        let mut picture = PictureTable::default();
        change(&mut picture);
        Tones::new(&picture, 0.3, 30.0).unwrap()
    }

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    #[test]
    fn times_run_from_the_first_colour_to_the_last() {
        let tones = tones(|_| {});
        let palette = Palette::named(Palette::DEFAULT).unwrap();
        let colour = |time| tones.colour(&Outcome::flipped(time));
        assert_eq!(tones.range_secs(), [0.3, 30.0]);
        assert_eq!(colour(0.1), palette.colour(0.0));
        assert_eq!(colour(30.0), palette.colour(1.0));
        assert_eq!(colour(3.0), palette.colour(0.5));
        assert_eq!(tones.colour(&Outcome::without_time(Status::Unflipped)), tones.ground.unflipped);
    }

    #[test]
    fn a_budget_of_less_than_two_units_still_has_a_range() {
        let tones = Tones::new(&PictureTable::default(), 0.3, 0.5).unwrap();
        assert_eq!(tones.range_secs(), [0.05, 0.5]);
    }

    #[test]
    fn equal_steps_lie_at_the_times_given() {
        let tones = tones(|picture| picture.times = vec![1.0, 2.0, 16.0, 20.0]);
        for (secs, share) in [(0.5, 0.0), (1.0, 0.0), (2.0, 1.0 / 3.0), (16.0, 2.0 / 3.0)] {
            assert!(near(tones.position(secs), share), "{secs}");
        }
        assert!(near(tones.position(4.0), 1.0 / 3.0 + 1.0 / 9.0), "a third of the way in ratios");
        assert!(near(tones.position(99.0), 1.0));
    }

    #[test]
    fn a_linear_scale_has_equal_differences() {
        let tones = tones(|picture| {
            picture.scale = Scale::Linear;
            picture.times = vec![10.0, 20.0];
        });
        assert!(near(tones.position(12.5), 0.25) && near(tones.secs_at(0.25), 12.5));
    }

    #[test]
    fn steps_have_one_colour_each() {
        let tones = tones(|picture| {
            picture.scale = Scale::Steps;
            picture.times = vec![1.0, 10.0, 100.0, 1000.0];
        });
        let position = |secs| tones.position(secs);
        assert!(near(position(1.5), 1.0 / 6.0) && near(position(9.9), 1.0 / 6.0));
        assert!(near(position(10.1), 0.5) && near(position(999.0), 5.0 / 6.0));
        assert!(near(position(0.1), 1.0 / 6.0) && near(position(1e5), 5.0 / 6.0), "clamped");
        assert!(near(tones.secs_at(1.0 / 3.0), 10.0), "the legend has the limits");
    }

    #[test]
    fn a_palette_repeats_and_ends_at_its_end() {
        let cycled = |cycles| {
            tones(|picture| {
                picture.cycles = cycles;
                picture.scale = Scale::Linear;
                picture.times = vec![10.0, 20.0];
            })
        };
        let two = cycled(2.0);
        assert!(near(two.position(12.5), 0.5) && near(two.position(17.5), 0.5));
        assert!(near(two.position(15.0), 0.0) && near(two.position(20.0), 1.0));
        assert!(near(cycled(2.5).position(20.0), 0.5));
    }

    #[test]
    fn a_mirrored_palette_has_no_seam_and_an_offset_comes_round() {
        let with = |mirror, offset| {
            tones(|picture| {
                (picture.mirror, picture.offset, picture.cycles) = (mirror, offset, 3.5);
                (picture.scale, picture.times) = (Scale::Linear, vec![10.0, 20.0]);
            })
        };
        let positions = |tones: &Tones| -> Vec<f64> {
            (0..=1000).map(|k| tones.position(10.0 + f64::from(k) * 0.01)).collect()
        };
        let largest_step = |positions: &[f64]| {
            positions.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max)
        };
        let [plain, mirrored] = [false, true].map(|mirror| positions(&with(mirror, 0.0)));
        assert!(largest_step(&plain) > 0.9 && largest_step(&mirrored) < 0.004);
        assert!(near(mirrored[0], 0.0) && near(mirrored[1000], 0.5));
        for mirror in [false, true] {
            let [none, whole] = [0.0, 1.0].map(|offset| positions(&with(mirror, offset)));
            assert!(none.iter().zip(whole).all(|(a, b)| (a - b).abs() < 1e-9), "{mirror}");
            let quarter = positions(&with(mirror, 0.25));
            assert!(near(quarter[0], if mirror { 0.5 } else { 0.25 }));
        }
    }

    #[test]
    fn reversed_tones_run_backwards_in_every_cycle() {
        let picture = PictureTable { cycles: 3.0, ..PictureTable::default() };
        let forth = Tones::new(&picture, 0.3, 30.0).unwrap();
        let back = Tones { reverse: true, ..forth.clone() };
        for secs in [0.1, 0.4, 1.0, 7.7, 30.0] {
            assert!(near(forth.position(secs) + back.position(secs), 1.0));
        }
    }

    #[test]
    fn the_lookup_has_the_colours_of_its_times() {
        let tones = tones(|picture| {
            picture.times = vec![0.5, 3.0, 4.0, 40.0];
            picture.reverse = true;
        });
        let lookup = tones.lookup(1000);
        assert_eq!((lookup.first_secs, lookup.last_secs, lookup.colours.len()), (0.5, 40.0, 1000));
        for k in [0, 1, 400, 998, 999] {
            let secs = 0.5 * 80f64.powf(k as f64 / 999.0);
            assert_eq!(lookup.colours[k], tones.colour(&Outcome::flipped(secs)), "{k}");
        }
    }

    #[test]
    fn an_equalised_view_shows_every_colour_equally_often() {
        let times: Vec<f64> =
            (0..4000).map(|k| 1.0 + (f64::from(k) / 4000.0).powi(6) * 20.0).collect();
        let tones = tones(|picture| picture.times = equalised(times.iter().copied(), 16));
        for tenth in 0..10 {
            let from = f64::from(tenth) / 10.0;
            let inside =
                times.iter().filter(|t| (from..from + 0.1).contains(&tones.position(**t))).count();
            assert!((300..500).contains(&inside), "{tenth}: {inside}");
        }
    }

    #[test]
    fn few_and_equal_times_are_spread_as_far_as_they_go() {
        assert!(equalised([].into_iter(), 16).is_empty());
        assert!(equalised([2.0; 9].into_iter(), 16).is_empty());
        assert!(equalised([f64::NAN, f64::INFINITY, -1.0, 2.0].into_iter(), 16).is_empty());
        assert_eq!(equalised([5.0, 2.0].into_iter(), 16), [2.0, 5.0]);
        assert_eq!(equalised([1.0, 1.0, 1.0, 1.0, 2.0, 3.0].into_iter(), 5), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn a_table_over_another_scale_has_the_colours_of_its_times() {
        let [from, to] = [vec![1.0, 2.0, 9.0], vec![0.5, 4.0, 30.0]]
            .map(|times| tones(|picture| picture.times = times));
        assert_eq!(from.over(from.scale(), 50)[49], from.colour_at(9.0));
        for (k, colour) in from.over(to.scale(), 101).into_iter().enumerate() {
            assert_eq!(colour, from.colour_at(to.secs_at(k as f64 / 100.0)), "{k}");
        }
    }

    proptest! {
        #[test]
        fn equalised_times_can_always_be_used(
            times in proptest::collection::vec(1e-9..1e6f64, 0..200),
            steps in 0usize..2000,
        ) {
            let times = equalised(times.into_iter(), steps);
            let picture = PictureTable { times, ..PictureTable::default() };
            prop_assert!(picture.check().is_ok());
        }

        #[test]
        fn a_share_and_its_time_belong_together(share in 0.0..1.0f64, linear: bool) {
            let scale = if linear { Scale::Linear } else { Scale::Log };
            let tones = tones(|picture| {
                picture.scale = scale;
                picture.times = vec![0.5, 3.0, 4.0, 40.0];
            });
            prop_assert!((tones.position(tones.secs_at(share)) - share).abs() < 1e-9);
        }
    }
}
