//! A sample packed into one word, as the atlas holds it (counterpart: shaders/picture.wgsl).

use flipmap_engine::Trust;
use flipmap_pendulum::{Outcome, Status};
use flipmap_render::tiles::Samples;
use flipmap_scene::palette::{AnswerColours, TimeScale};

/// Offset of the stored logarithms: they count from 2^-32 s (counterpart in the shader).
pub(crate) const LOG_BIAS: f64 = 32.0;
/// Number of steps of the stored logarithms per octave.
pub(crate) const LOG_STEPS: f64 = (1 << 21) as f64;
/// Number of steps of the stored heights.
pub(crate) const HEIGHT_STEPS: f64 = ((1 << 27) - 1) as f64;

/// Content of the words of samples, apart from status and trust.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum WordKind {
    /// The logarithm of the time, which the card turns into a colour.
    Times,
    /// The height of a channel of times on the scale of its colours, for colours too fine for a
    /// table over all logarithms and for light from the side.
    Heights(usize, TimeScale),
    /// The colour, for answers that are not times.
    Colours(Box<AnswerColours>),
}

impl WordKind {
    /// Returns the words of samples in order.
    pub(crate) fn words(&self, samples: &Samples) -> Vec<u32> {
        let word = |place: usize| match self {
            WordKind::Times => word_of(&samples.get(place), samples.trust(place)),
            WordKind::Heights(channel, scale) => {
                let height = scale.height(samples.values(place)[*channel]);
                let status = samples.get(place).status;
                // A sample without a time has height 0.
                let height = if status == Status::Answered { height * HEIGHT_STEPS } else { 0.0 };
                packed(height, samples.trust(place), status)
            }
            WordKind::Colours(colours) => {
                let status = samples.get(place).status;
                let [r, g, b] = colours.colour(status, samples.values(place)).map(u32::from);
                packed(f64::from((r << 16) | (g << 8) | b), samples.trust(place), status)
            }
        };
        (0..samples.len()).map(word).collect()
    }
}

/// Packs the status into the lowest two bits, trust into the next three, and the logarithm of the
/// time into the rest, which is finer than any colour and spares the card computing it.
pub(crate) fn word_of(outcome: &Outcome, trust: Trust) -> u32 {
    // Outcomes without a time have a logarithm of −∞, which becomes 0.
    packed((outcome.time.log2() + LOG_BIAS) * LOG_STEPS, trust, outcome.status)
}

fn packed(value: f64, trust: Trust, status: Status) -> u32 {
    ((value.round() as u32) << 5) | ((trust as u32) << 2) | status as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::question::QuestionName;
    use flipmap_scene::{PictureTable, QuestionSettings, Scene};

    #[test]
    fn another_question_is_painted_before_the_card_sees_it() {
        let question = QuestionSettings { ask: QuestionName::State, ..QuestionSettings::default() };
        let scene = Scene { question, ..Scene::default() };
        let colours = AnswerColours::new(&scene, &PictureTable::default()).unwrap();
        let mut samples = Samples::unanswered(2, 6);
        samples.set_values(0, Status::Answered, &[0.5, -1.0, 2.0, 3.0, 0.0, 0.0]);
        samples.assure(0, Trust::Uncertain);
        let [r, g, b] = colours.colour(Status::Answered, samples.values(0)).map(u32::from);
        let words = WordKind::Colours(Box::new(colours)).words(&samples);
        assert_eq!(words[0] >> 5, (r << 16) | (g << 8) | b);
        assert_eq!((words[0] & 3, (words[0] >> 2) & 7), (1, Trust::Uncertain as u32));
        assert_eq!(words[1] & 3, Status::Unflipped as u32);
    }

    #[test]
    fn a_height_tells_times_apart_that_lie_close_together() {
        let times = vec![59.9, 59.900_001, 60.0];
        let picture = PictureTable { times, ..PictureTable::default() };
        let colours = AnswerColours::new(&Scene::default(), &picture).unwrap();
        let (channel, tones) = colours.times().unwrap();
        let mut samples = Samples::unflipped(4);
        for (place, secs) in [(0, 59.9), (1, 59.900_000_5), (2, 61.0)] {
            samples.set(place, Outcome::flipped(secs));
        }
        let words = WordKind::Heights(channel, tones.scale().clone()).words(&samples);
        let heights = words.iter().map(|word| f64::from(word >> 5) / HEIGHT_STEPS);
        for (height, expected) in heights.zip([0.0, 0.25, 1.0, 0.0]) {
            assert!((height - expected).abs() < 1e-6, "{height} {expected}");
        }
        assert_eq!((words[2] & 3, words[3] & 3), (1, 0), "statuses beside them");
    }

    #[test]
    fn a_word_holds_all_that_a_colour_needs() {
        for secs in [1e-6, 0.3, 29.999, 1e6] {
            let word = word_of(&Outcome::flipped(secs), Trust::Uncertain);
            assert_eq!((word & 3, (word >> 2) & 7), (1, 4));
            let back = (f64::from(word >> 5) / LOG_STEPS - LOG_BIAS).exp2();
            assert!((back / secs - 1.0).abs() < 3e-7, "{secs} {back}");
        }
        let forbidden = word_of(&Outcome::without_time(Status::Forbidden), Trust::Unchecked);
        assert_eq!(forbidden & 31, 2);
    }
}
