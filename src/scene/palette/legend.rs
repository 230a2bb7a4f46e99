//! What the colours of answers mean: a bar of one quantity, or a square of two angles.

use std::f64::consts::{PI, TAU};

use super::Rgb;
use super::answers::{AnswerColours, Way, torus};
use crate::question::Ask;

/// The name of a bar's quantity, and its unit, which may be empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LegendTitle {
    /// The name.
    pub name: &'static str,
    /// The unit.
    pub unit: &'static str,
}

impl AnswerColours {
    /// Returns true if two angles make a colour, so that a square shows them all: θ1 across and θ2
    /// up, from −π to π.
    pub fn is_square(&self) -> bool {
        self.way == Way::Torus
    }

    /// The colour at a place of the square, each from 0 to 1.
    pub fn colour_in_square(&self, place: [f64; 2]) -> Rgb {
        torus(place.map(|share| TAU * share - PI))
    }

    /// The colour at a share of the bar, from 0 to 1.
    pub fn colour_along(&self, share: f64) -> Rgb {
        match &self.way {
            Way::Times(_, tones) => tones.colour_at(tones.secs_at(share)),
            Way::Angle(_, palette)
            | Way::Between(_, _, palette)
            | Way::Counts(_, palette)
            | Way::EnergySplit(_, palette) => palette.colour(share),
            Way::Torus => self.colour_in_square([share, 0.5]),
        }
    }

    /// The value at a share of the bar, from 0 to 1, in the unit of [`AnswerColours::title`].
    pub fn value_along(&self, share: f64) -> f64 {
        match &self.way {
            Way::Times(_, tones) => tones.secs_at(share),
            Way::Angle(..) | Way::Torus => TAU * share - PI,
            Way::Between(_, [from, to], _) => from + share * (to - from),
            Way::Counts(most, _) => share * most,
            Way::EnergySplit(..) => share,
        }
    }

    /// The quantity along the bar in the answers to a question.
    pub fn title(&self, ask: Ask) -> LegendTitle {
        let channels = ask.kind().channels;
        match self.way {
            Way::Times(channel, _) | Way::Angle(channel, _) | Way::Between(channel, ..) => {
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
    use crate::physics::Status;
    use crate::scene::{PictureTable, QuestionTable, Scene};

    #[test]
    fn the_bar_has_the_colours_of_its_values() {
        for (ask, channel) in
            [(Ask::Flip, 0), (Ask::State, 1), (Ask::State, 2), (Ask::Growth, 0), (Ask::Return, 0)]
        {
            let question = QuestionTable { ask, ..QuestionTable::default() };
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
                let painted = colours.colour(Status::Flipped, &values);
                let near = |(a, b): (u8, u8)| a.abs_diff(b) <= 4;
                let along = colours.colour_along(share);
                assert!(painted.into_iter().zip(along).all(near), "{name} {share}");
            }
        }
    }

    #[test]
    fn two_angles_have_a_square() {
        let question = QuestionTable { ask: Ask::State, ..QuestionTable::default() };
        let scene = Scene { question, ..Scene::default() };
        let colours = AnswerColours::new(&scene, &PictureTable::default()).unwrap();
        assert!(colours.is_square());
        let painted = colours.colour(Status::Flipped, &[PI / 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(colours.colour_in_square([0.75, 0.5]), painted);
    }
}
