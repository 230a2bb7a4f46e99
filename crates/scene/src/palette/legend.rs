//! Legends of the colours of answers: a bar for one quantity, or a square for two angles.

use std::f64::consts::{PI, TAU};

use super::answers::{AnswerColours, Way, torus};
use super::steps::WholeNumbers;
use super::ticks::{BarLabels, edge_labels, round_labels};
use super::{Rgb, rounded};
use crate::question::QuestionName;

/// The name of a bar's quantity, and its unit, which may be empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LegendTitle {
    /// The name.
    pub name: &'static str,
    /// The unit.
    pub unit: &'static str,
}

impl AnswerColours {
    /// Returns true if each colour shows two angles. The legend is then a square with θ1 across and
    /// θ2 up, from −π to π.
    pub fn is_square(&self) -> bool {
        self.way == Way::Torus
    }

    /// Returns the colour at a place in the square, with both coordinates from 0 to 1.
    pub fn colour_in_square(&self, place: [f64; 2]) -> Rgb {
        rounded(torus(place.map(|share| TAU * share - PI)))
    }

    /// Returns the colour at a share of the bar, from 0 to 1.
    pub fn colour_along(&self, share: f64) -> Rgb {
        let value = self.value_along(share);
        match &self.way {
            Way::Times(_, tones) => tones.colour_at(value),
            Way::Angle(_, palette) | Way::Between(_, _, palette) | Way::EnergySplit(_, palette) => {
                palette.colour(share)
            }
            Way::Whole(_, [from, to], _, palette) => palette.colour((value - from) / (to - from)),
            Way::Counts(most, palette) => palette.colour(value / most),
            Way::Torus => self.colour_in_square([share, 0.5]),
        }
    }

    /// Returns the value at a share of the bar, from 0 to 1, in the unit of
    /// [`AnswerColours::title`].
    pub fn value_along(&self, share: f64) -> f64 {
        if let Some(numbers) = self.whole_numbers() {
            return numbers.at(share) as f64;
        }
        match &self.way {
            Way::Times(_, tones) => tones.secs_at(share),
            Way::Angle(..) | Way::Torus => TAU * share - PI,
            Way::Between(_, [from, to], _) | Way::Whole(_, [from, to], ..) => {
                from + share * (to - from)
            }
            Way::Counts(most, _) => share * most,
            Way::EnergySplit(..) => share,
        }
    }

    /// Returns the whole numbers along the bar, or `None` if its values are continuous.
    fn whole_numbers(&self) -> Option<WholeNumbers> {
        match self.way {
            Way::Whole(_, _, numbers, _) => Some(numbers),
            Way::Counts(most, _) => Some(WholeNumbers::counts(0, most.ceil() as i64)),
            _ => None,
        }
    }

    /// Returns the places (0 to 1) and labels of the steps of a bar `letters` letters long, or
    /// `None` if its colours are continuous.
    pub fn step_labels(&self, letters: f64) -> Option<Vec<(f64, String)>> {
        Some(self.whole_numbers()?.labels(letters))
    }

    /// Returns the labels of the bar, at round values; angles have theirs in parts of π, and colours
    /// with steps where they begin and end.
    pub fn bar_labels(&self) -> BarLabels {
        if let Way::Angle(..) = self.way {
            let ticks = [(0, "−π"), (250, "−π/2"), (500, "0"), (750, "π/2"), (1000, "π")];
            let ticks = ticks.map(|(place, label)| (place, label.to_string())).into();
            return BarLabels { from: None, ticks };
        }
        let steps = match &self.way {
            Way::Times(_, tones) => tones.scale().edges_secs(),
            _ => None,
        };
        match steps {
            Some(edges) => edge_labels(edges),
            None => round_labels(|share| self.value_along(share)),
        }
    }

    /// Returns the name and unit of the quantity along the bar.
    pub fn title(&self, ask: QuestionName) -> LegendTitle {
        let channels = ask.kind().channels;
        match self.way {
            Way::Times(channel, _)
            | Way::Angle(channel, _)
            | Way::Between(channel, ..)
            | Way::Whole(channel, ..) => {
                LegendTitle { name: channels[channel].name, unit: channels[channel].unit }
            }
            Way::Torus => LegendTitle { name: "theta1, theta2", unit: "rad" },
            Way::Counts(..) => LegendTitle { name: "passes of both bobs", unit: "" },
            Way::EnergySplit(..) => LegendTitle { name: "kinetic share of the energy", unit: "" },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Budget, PictureTable, QuestionSettings, Scene};
    use flipmap_pendulum::Status;

    #[test]
    fn the_bar_has_the_colours_of_its_values() {
        for (ask, channel) in [
            (QuestionName::Flip, 0),
            (QuestionName::State, 1),
            (QuestionName::State, 2),
            (QuestionName::State, 4),
            (QuestionName::First, 0),
            (QuestionName::Flips, 3),
            (QuestionName::Growth, 0),
            (QuestionName::Return, 0),
            (QuestionName::Speed, 0),
        ] {
            let question = QuestionSettings { ask, ..QuestionSettings::default() };
            let name = ask.kind().channels[channel].name;
            let picture =
                PictureTable { channel: Some(name.to_string()), ..PictureTable::default() };
            let scene = Scene { question, ..Scene::default() };
            let colours = AnswerColours::new(&scene, &picture).unwrap();
            assert_eq!(colours.title(ask).name, name);
            assert!(!colours.is_square());
            for share in [0.01, 0.3, 0.77] {
                let mut values = [0.0; 6];
                values[channel] = colours.value_along(share);
                let painted = colours.colour(Status::Answered, &values);
                let near = |(a, b): (u8, u8)| a.abs_diff(b) <= 4;
                let along = colours.colour_along(share);
                assert!(painted.into_iter().zip(along).all(near), "{name} {share}");
            }
        }
    }

    #[test]
    fn counts_have_one_colour_each() {
        let colours = |ask, channel: Option<&str>, budget| {
            let question = QuestionSettings { ask, budget, ..QuestionSettings::default() };
            let scene = Scene { question, ..Scene::default() };
            let channel = channel.map(str::to_string);
            AnswerColours::new(&scene, &PictureTable { channel, ..PictureTable::default() })
                .unwrap()
        };
        let short = Budget::secs(2.0);
        for (ask, channel, count) in [
            (QuestionName::Flips, None, 4),
            (QuestionName::Flips, Some("first_left"), 11),
            (QuestionName::First, None, 2),
            (QuestionName::State, Some("turns2"), 11),
        ] {
            let colours = colours(ask, channel, short);
            let along = |k: u32| colours.colour_along(f64::from(k) / 500.0);
            let changes = (0..500).filter(|k| along(*k) != along(k + 1)).count();
            assert_eq!(changes + 1, count, "{ask} {channel:?}");
            assert_eq!(colours.step_labels(34.0).unwrap().len(), count, "{ask} {channel:?}");
        }
        let flips = colours(QuestionName::Flips, None, short);
        for sum in [0.0, 1.0, 2.0, 3.0] {
            let painted = flips.colour(Status::Answered, &[sum, 0.0, 0.0, 0.0]);
            assert_eq!(flips.colour_along((sum + 0.5) / 4.0), painted, "{sum}");
        }
        assert!(colours(QuestionName::Growth, None, short).step_labels(34.0).is_none());
    }

    #[test]
    fn two_angles_have_a_square() {
        let question = QuestionSettings { ask: QuestionName::State, ..QuestionSettings::default() };
        let scene = Scene { question, ..Scene::default() };
        let colours = AnswerColours::new(&scene, &PictureTable::default()).unwrap();
        assert!(colours.is_square());
        let painted = colours.colour(Status::Answered, &[PI / 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(colours.colour_in_square([0.75, 0.5]), painted);
    }
}
