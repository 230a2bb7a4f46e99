//! A sample packed into one word, as the atlas holds it (counterpart: shaders/picture.wgsl).

use crate::engine::Trust;
use crate::physics::{Outcome, Status};
use crate::scene::palette::AnswerColours;
use crate::tiles::Samples;

/// Offset of the stored logarithms: they count from 2^-32 s (counterpart in the shader).
pub const LOG_BIAS: f64 = 32.0;
/// Number of steps of the stored logarithms per octave.
pub const LOG_STEPS: f64 = (1 << 21) as f64;

/// Content of the words of samples beside status and trust.
#[derive(Clone, Debug, PartialEq)]
pub enum WordKind {
    /// The time, which the card turns into a colour.
    Times,
    /// The colour, of answers that are no flip times or need finer colours than the card's table has.
    Colours {
        /// Colours of all answers.
        colours: Box<AnswerColours>,
        /// Time in s after which an answer is none yet.
        until_secs: f64,
    },
}

impl WordKind {
    /// The words of samples in order.
    pub fn words(&self, samples: &Samples) -> Vec<u32> {
        let word = |place: usize| match self {
            WordKind::Times => word_of(&samples.get(place), samples.trust(place)),
            WordKind::Colours { colours, until_secs } => {
                let Outcome { status, time } = samples.get(place);
                let is_late = status == Status::Flipped && time > *until_secs;
                let status = if is_late { Status::Unflipped } else { status };
                let [r, g, b] = colours.colour(status, samples.values(place)).map(u32::from);
                let trust = samples.trust(place) as u32;
                (((r << 16) | (g << 8) | b) << 5) | (trust << 2) | status as u32
            }
        };
        (0..samples.len()).map(word).collect()
    }
}

/// Packs the status into the lowest two bits, trust into the next three, and the logarithm of the
/// time into the rest: finer than any colour, and nothing for the card to work out.
pub fn word_of(outcome: &Outcome, trust: Trust) -> u32 {
    let steps = (outcome.time.log2() + LOG_BIAS) * LOG_STEPS;
    // Outcomes without a time have a logarithm of −∞, which becomes 0.
    ((steps.round() as u32) << 5) | ((trust as u32) << 2) | outcome.status as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::question::Ask;
    use crate::scene::{PictureTable, QuestionTable, Scene};

    #[test]
    fn another_question_is_painted_before_the_card_sees_it() {
        let question = QuestionTable { ask: Ask::State, ..QuestionTable::default() };
        let scene = Scene { question, ..Scene::default() };
        let colours = AnswerColours::new(&scene, &PictureTable::default()).unwrap();
        let mut samples = Samples::unanswered(2, 6);
        samples.set_values(0, Status::Flipped, &[0.5, -1.0, 2.0, 3.0, 0.0, 0.0]);
        samples.set_trust(0, Trust::Uncertain);
        let [r, g, b] = colours.colour(Status::Flipped, samples.values(0)).map(u32::from);
        let colours = Box::new(colours);
        let words = WordKind::Colours { colours, until_secs: f64::INFINITY }.words(&samples);
        assert_eq!(words[0] >> 5, (r << 16) | (g << 8) | b);
        assert_eq!((words[0] & 3, (words[0] >> 2) & 7), (1, Trust::Uncertain as u32));
        assert_eq!(words[1] & 3, Status::Unflipped as u32);
    }

    #[test]
    fn a_flip_after_the_budget_is_none() {
        let colours = AnswerColours::new(&Scene::default(), &PictureTable::default()).unwrap();
        let mut samples = Samples::unflipped(2);
        samples.set(0, Outcome::flipped(9.0));
        samples.set(1, Outcome::flipped(11.0));
        let words = WordKind::Colours { colours: Box::new(colours), until_secs: 10.0 };
        let statuses = words.words(&samples).into_iter().map(|word| word & 3);
        let expected = [Status::Flipped, Status::Unflipped].map(|status| status as u32);
        assert_eq!(statuses.collect::<Vec<_>>(), expected);
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
