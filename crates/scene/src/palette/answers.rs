//! The colours of answers, from one channel of a question or from several.

use std::f64::consts::{PI, TAU};

use super::oklab::from_oklab;
use super::steps::WholeNumbers;
use super::{FAILED, Ground, Palette, Rgb, Tint, Tones, rounded, tint_of};
use crate::question::{ChannelScale, Painted};
use crate::{PictureTable, Scene, SceneError, Shown};
use flipmap_pendulum::{Pendulum, State, Status};

/// A map from answers to colours.
#[derive(Clone, Debug, PartialEq)]
pub struct AnswerColours {
    pub(super) way: Way,
    ground: Ground,
}

/// Passes of the top per natural unit of time at which the palette ends.
const MAX_PASSES_PER_UNIT: f64 = 0.4;

/// The way in which the channels become a colour.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Way {
    /// A channel of times.
    Times(usize, Tones),
    /// An angle, which runs once through a cyclic palette.
    Angle(usize, Palette),
    /// A channel between two values.
    Between(usize, [f64; 2], Palette),
    /// Two angles at once.
    Torus,
    /// A channel of whole numbers, with the numbers at the ends of the palette.
    Whole(usize, [f64; 2], WholeNumbers, Palette),
    /// The sum of all channels, from 0 to this number.
    Counts(f64, Palette),
    /// The kinetic share of this pendulum's energy, measured from hanging at rest.
    EnergySplit(Pendulum<f64>, Palette),
}

impl AnswerColours {
    /// Returns the colours of a checked scene's answers: those of the picture's channel if it has
    /// one, or else those natural to the question.
    pub fn new(scene: &Scene, picture: &PictureTable) -> Result<Self, SceneError> {
        let ask = scene.question.ask;
        let painted = match picture.shown(ask)? {
            Shown::Channel(channel) => return AnswerColours::of_channel(scene, picture, channel),
            Shown::Tint(painted) => painted,
            Shown::Natural => ask.kind().painted,
        };
        let way = match painted {
            Painted::First => return AnswerColours::of_channel(scene, picture, 0),
            Painted::TwoAngles => Way::Torus,
            Painted::Sum => {
                let units = scene.question.end_secs() / scene.build.unit_secs();
                Way::Counts(MAX_PASSES_PER_UNIT * units, Palette::named(&picture.palette)?)
            }
            Painted::EnergySplit => {
                let palette = palette_or(picture, Palette::DARK_TO_BRIGHT)?;
                Way::EnergySplit(scene.build.pendulum(), palette)
            }
        };
        Ok(AnswerColours { way, ground: Ground::of(picture)? })
    }

    /// Returns the colours of one channel.
    fn of_channel(
        scene: &Scene,
        picture: &PictureTable,
        channel: usize,
    ) -> Result<Self, SceneError> {
        let ask = scene.question.ask;
        let up_to = |most: f64| -> Result<Way, SceneError> {
            let palette = palette_or(picture, Palette::DARK_TO_BRIGHT)?;
            Ok(Way::Between(channel, [0.0, most], palette))
        };
        let way = match ask.kind().channels[channel].scale {
            ChannelScale::Times => {
                let (unit, budget) = (scene.build.unit_secs(), scene.question.budget.secs);
                Way::Times(channel, Tones::new(picture, unit, budget)?)
            }
            ChannelScale::Cyclic => Way::Angle(channel, palette_or(picture, Palette::OF_ANGLES)?),
            ChannelScale::Rates(most) => up_to(most / scene.build.unit_secs())?,
            ChannelScale::Speeds(most) => {
                up_to(most * scene.build.lengths_m()[1] / scene.build.unit_secs())?
            }
            ChannelScale::Between(from, to) => {
                Way::Between(channel, [from, to], Palette::named(&picture.palette)?)
            }
            ChannelScale::Counts(from, to) => {
                let ends = [from, to].map(f64::from);
                Way::Whole(
                    channel,
                    ends,
                    WholeNumbers::counts(i64::from(from), i64::from(to)),
                    Palette::named(&picture.palette)?,
                )
            }
            ChannelScale::Bobs => {
                let palette = Palette::named(&picture.palette)?;
                Way::Whole(channel, [0.0, 3.0], WholeNumbers::BOBS, palette)
            }
        };
        Ok(AnswerColours { way, ground: Ground::of(picture)? })
    }

    /// Returns the colours of pixels without an answer and of the energy curve.
    pub fn ground(&self) -> Ground {
        self.ground
    }

    /// Returns the channel and the tones of times, if the colours show times.
    pub fn times(&self) -> Option<(usize, &Tones)> {
        match &self.way {
            Way::Times(channel, tones) => Some((*channel, tones)),
            _ => None,
        }
    }

    /// Returns the colour of a sample, rounded to eight bits per channel.
    pub fn colour(&self, status: Status, values: &[f64]) -> Rgb {
        rounded(self.tint(status, values))
    }

    /// Returns the colour of a sample, not rounded.
    pub fn tint(&self, status: Status, values: &[f64]) -> Tint {
        match status {
            Status::Answered => self.of_values(values),
            Status::Unflipped => tint_of(self.ground.unflipped),
            Status::Forbidden => tint_of(self.ground.forbidden),
            Status::Failed => tint_of(FAILED),
        }
    }

    fn of_values(&self, values: &[f64]) -> Tint {
        match &self.way {
            Way::Times(channel, tones) => tones.tint_at(values[*channel]),
            Way::Angle(channel, palette) => palette.tint((values[*channel] + PI) / TAU),
            Way::Between(channel, [from, to], palette)
            | Way::Whole(channel, [from, to], _, palette) => {
                palette.tint((values[*channel] - from) / (to - from))
            }
            Way::Torus => torus([values[0], values[1]]),
            Way::Counts(most, palette) => palette.tint(values.iter().sum::<f64>() / most),
            Way::EnergySplit(pendulum, palette) => palette.tint(kinetic_share(pendulum, values)),
        }
    }
}

/// Returns the kinetic share, from 0 to 1, of the energy above hanging at rest. Values are angles
/// in rad and speeds in rad/s.
fn kinetic_share(pendulum: &Pendulum<f64>, values: &[f64]) -> f64 {
    let (angle, speed) = ([values[0], values[1]], [values[2], values[3]]);
    let potential = pendulum.energy(&State::rest(angle));
    let all = pendulum.energy(&State { angle, speed });
    (all - potential) / (all + pendulum.p + pendulum.q).max(f64::MIN_POSITIVE)
}

/// Returns the picture's palette, or the palette `other` if nobody has chosen one.
fn palette_or(picture: &PictureTable, other: &str) -> Result<Palette, SceneError> {
    let is_unchosen = Palette::is_unchosen(&picture.palette);
    Palette::named(if is_unchosen { other } else { &picture.palette })
}

/// Returns the colour of two angles. In Oklab, θ1 goes once around the hues, and θ2 once around a
/// circle of lightness and chroma. Every pair has a colour of its own, without a seam at ±π.
/// Lightness alone shows |θ2|, even to colour-blind people.
pub(super) fn torus([theta1, theta2]: [f64; 2]) -> Tint {
    let (sin2, cos2) = theta2.sin_cos();
    let lightness = 0.63 - 0.2 * cos2;
    let chroma = 0.105 + 0.035 * sin2;
    let (sin1, cos1) = theta1.sin_cos();
    from_oklab([lightness, chroma * cos1, chroma * sin1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::QuestionSettings;
    use crate::question::QuestionName;

    fn colours(ask: QuestionName, channel: Option<&str>) -> Result<AnswerColours, SceneError> {
        let question = QuestionSettings { ask, ..QuestionSettings::default() };
        let scene = Scene { question, ..Scene::default() };
        let channel = channel.map(str::to_string);
        AnswerColours::new(&scene, &PictureTable { channel, ..PictureTable::default() })
    }

    fn near(a: Rgb, b: Rgb) -> bool {
        a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 3)
    }

    #[test]
    fn two_angles_are_one_colour_without_a_seam() {
        let torus = |angles| rounded(torus(angles));
        for k in 0..60 {
            let angle = -PI + TAU * f64::from(k) / 60.0;
            assert!(near(torus([PI, angle]), torus([-PI, angle])));
            assert!(near(torus([angle, PI]), torus([angle, -PI])));
            assert!(near(torus([angle, 1.0]), torus([angle + 0.005, 1.005])), "smooth");
            assert!(!near(torus([angle, 1.0]), torus([angle, -1.0])), "signs differ");
            assert!(!near(torus([angle, 1.0]), torus([angle + 0.5, 1.0])));
        }
    }

    #[test]
    fn a_channel_has_colours_of_its_own_scale() {
        let state = colours(QuestionName::State, Some("theta2")).unwrap();
        let colour = |angle| state.colour(Status::Answered, &[0.3, angle, 0.0, 0.0, 0.0, 0.0]);
        assert!(near(colour(PI), colour(-PI)));
        assert_ne!(colour(0.0), colour(1.0));
        let speed = colours(QuestionName::State, Some("omega1")).unwrap();
        let fast = |w| speed.colour(Status::Answered, &[0.0, 0.0, w, 0.0, 0.0, 0.0]);
        assert_eq!(fast(99.0), fast(10.0), "beyond its scale");
        assert_eq!(speed.colour(Status::Forbidden, &[0.0; 6]), Ground::DARK.forbidden);
        let refused = colours(QuestionName::Flip, Some("theta2")).unwrap_err().to_string();
        assert_eq!(refused, "`channel` is 'theta2'; the question flip has time");
        assert!(colours(QuestionName::Growth, Some("energy")).is_err());
    }

    #[test]
    fn energy_is_split_as_it_is() {
        let pendulum = Scene::default().build.pendulum();
        assert_eq!(kinetic_share(&pendulum, &[1.0, 2.0, 0.0, 0.0, 0.0, 0.0]), 0.0);
        let hanging = kinetic_share(&pendulum, &[0.0, 0.0, 3.0, 1.0, 0.0, 0.0]);
        assert!((hanging - 1.0).abs() < 1e-12);
        assert_eq!(kinetic_share(&pendulum, &[0.0; 6]), 0.0);
        let state = colours(QuestionName::State, Some("energy")).unwrap();
        let colour = |w: f64| state.colour(Status::Answered, &[1.0, 2.0, w, 0.0, 0.0, 0.0]);
        assert!(colour(0.0) != colour(2.0) && colour(2.0) != colour(9.0));
        assert_eq!(colour(2.0), colour(-2.0), "both directions are one energy here");
    }
}
