//! Questions: what is asked of every pendulum, and how its answer is read.
//!
//! An engine follows a pendulum until a watched bob passes the top, or until the budget is used up,
//! and knows no question by name. A question says what is watched and for how long, and reads its
//! *channels* from the outcome and the end of the integration: named numbers with a unit, a natural
//! scale of colours, and the error within which they count as right.
//!
//! One question is one file here, with a line in [`QuestionName::ALL`].

mod first;
mod flip;
mod flips;
mod growth;
mod recurrence;
mod state;

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use flipmap_numbers::Dd;
use flipmap_pendulum::flip::right_secs;
use flipmap_pendulum::passes::Pass;
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::{Accumulators, Outcome, Pendulum, Rule};

/// The name of a question.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum QuestionName {
    /// The moment at which a watched bob first goes over the top.
    #[default]
    Flip,
    /// The bob that first goes over the top, and when.
    First,
    /// The number of times that each bob goes over the top.
    Flips,
    /// The state at a given time.
    State,
    /// The finite-time Lyapunov exponent over the budget.
    Growth,
    /// The nearest return to the start.
    Return,
}

/// All that a question decides.
pub struct QuestionDef {
    /// Name in options and files.
    pub name: &'static str,
    /// Two sentences on what its map shows.
    pub about: &'static str,
    /// The numbers of an answer, in order; at most [`MAX_CHANNELS`].
    pub channels: &'static [Channel],
    /// Words for pixels with an answer and for those without one at the end of the budget.
    pub counted: [&'static str; 2],
    /// A phrase with the names of the channels.
    pub channel_names: &'static str,
    /// The bobs that it watches.
    pub watches: Watches,
    /// Number of passes of the top after which a pendulum is done; [`u32::MAX`] for none. A question
    /// that has a count takes the scene's instead.
    pub passes: u32,
    /// True if it asks for the scene's count-th pass.
    pub has_count: bool,
    /// True if the answer lies at the time `at`, not at an event.
    pub at_a_time: bool,
    /// True if mirror images, with all angles and speeds negated, have equal answers.
    pub is_even: bool,
    /// Channels that its colours show.
    pub painted: Painted,
    /// Another way to paint them, with its name.
    pub tint: Option<(&'static str, Painted)>,
    /// True if deep views are answered, by following cells of starts.
    pub follows_cells: bool,
    /// All that an engine has to return.
    pub needs: Needs,
    /// Returns the values of the channels.
    pub read: fn(&QuestionInput) -> [f64; MAX_CHANNELS],
    /// Columns that it adds to a trace.
    pub columns: TraceColumns,
    /// Judgement of its answers by true ones.
    pub judged: Judgement,
}

/// The way in which the report judges answers against true ones.
pub struct Judgement {
    /// Budget of the map that is judged, in s.
    pub budget_secs: f64,
    /// Returns the error of an answer's channels, given those of the true orbit.
    pub error: fn(&[f64], &[f64]) -> f64,
    /// Largest error of a right answer.
    pub most_error: f64,
    /// The same in words.
    pub words: &'static str,
}

/// The columns that a question adds to a trace: channels so far, at the time of each row.
pub struct TraceColumns {
    /// The first channel that is a column; a trace has those before it already.
    pub from: usize,
    /// Returns the values of the columns; NaN for those that are not there yet.
    pub read: fn(&mut dyn Followed) -> Vec<f64>,
}

/// A pendulum that is followed from row to row of a trace.
pub trait Followed {
    /// The passes of the top so far.
    fn passes(&self) -> &[Pass];
    /// The passes so far by watched bobs.
    fn watched_passes(&self) -> Vec<Pass>;
    /// The scene's count.
    fn count(&self) -> u32;
    /// Whole turns of both rods.
    fn turns(&self) -> [i32; 2];
    /// The exponent of the growth so far, 1/s.
    fn exponent(&mut self) -> f64;
    /// The least distance from the start since it was left, and its time in s.
    fn nearest(&mut self) -> [f64; 2];
}

/// The bobs that a question watches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watches {
    /// The bobs of the scene's rule.
    TheRule,
    /// The same ones in every scene.
    Always(Rule),
}

/// Channels that the colours of a question show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Painted {
    /// The first channel.
    First,
    /// The first two channels, both angles.
    TwoAngles,
    /// The sum of all channels, which are counts.
    Sum,
    /// The kinetic share of the energy above hanging, from both angles and both speeds.
    EnergySplit,
}

/// Results of an integration that a question reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// The outcome alone.
    Outcome,
    /// The state at the end, too.
    End,
    /// The growth of nudges, too.
    Growth,
    /// The nearest return to the start, too.
    Return,
}

/// Largest number of channels of any question.
pub const MAX_CHANNELS: usize = 6;

/// One number of an answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channel {
    /// Name in files and on the command line.
    pub name: &'static str,
    /// Unit; empty for a count.
    pub unit: &'static str,
    /// Greatest error of a right value, in its unit.
    pub right: f64,
    /// Natural scale of its colours.
    pub scale: ChannelScale,
}

impl Channel {
    /// Returns true if a value is within `share` of what is right; `unit_secs` is the pendulum's natural
    /// unit of time, by which times and speeds are judged.
    pub fn is_right(&self, value: f64, truth: f64, share: f64, unit_secs: f64) -> bool {
        let apart = (value - truth).abs();
        let allowed = match self.scale {
            ChannelScale::Times if self.right <= right_secs(f64::INFINITY) => right_secs(unit_secs),
            ChannelScale::Rates(_) => self.right * truth.abs(),
            _ if self.unit == "rad/s" => {
                // Speeds of a fast pendulum are known to the same share of them.
                self.right * right_secs(f64::INFINITY) / right_secs(unit_secs)
            }
            _ => self.right,
        };
        let apart = match self.scale {
            ChannelScale::Cyclic => Dd::new(value - truth).wrapped().hi.abs(),
            _ => apart,
        };
        apart <= share * allowed
    }
}

/// The natural scale of a channel's colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChannelScale {
    /// Times, from the pendulum's natural unit of time to the budget.
    Times,
    /// An angle: −π and π are one colour.
    Cyclic,
    /// Values from the first to the second.
    Between(f64, f64),
    /// Whole numbers from the first to the second; larger and smaller ones have the colours of these.
    Counts(i32, i32),
    /// The number of a bob, 1 or 2.
    Bobs,
    /// Rates, from 0 to this many per natural unit of time of the pendulum.
    Rates(f64),
}

/// The outcome and the end of an integration, as a question reads them.
#[derive(Clone, Copy, Debug)]
pub struct QuestionInput<'a> {
    /// The pendulum in reduced units.
    pub pendulum: &'a Pendulum<f64>,
    /// The pendulum's unit of time in s.
    pub unit_secs: f64,
    /// The outcome.
    pub outcome: Outcome,
    /// State at the event, or else at the end of the budget; reduced units.
    pub phase: Phase<f64>,
    /// Simulated seconds until then.
    pub secs: f64,
    /// Quantities gathered until then.
    pub gathered: Accumulators,
}

impl QuestionName {
    /// Every question.
    pub const ALL: [QuestionName; 6] = [
        QuestionName::Flip,
        QuestionName::First,
        QuestionName::Flips,
        QuestionName::State,
        QuestionName::Growth,
        QuestionName::Return,
    ];

    /// All that the question decides.
    pub fn kind(self) -> &'static QuestionDef {
        match self {
            QuestionName::Flip => &flip::QUESTION,
            QuestionName::First => &first::QUESTION,
            QuestionName::Flips => &flips::QUESTION,
            QuestionName::State => &state::QUESTION,
            QuestionName::Growth => &growth::QUESTION,
            QuestionName::Return => &recurrence::QUESTION,
        }
    }

    /// The bobs that are watched in a scene with this rule.
    pub(crate) fn watched(self, rule: Rule) -> Rule {
        match self.kind().watches {
            Watches::TheRule => rule,
            Watches::Always(rule) => rule,
        }
    }

    /// The channel of this name.
    pub(crate) fn channel(self, name: &str) -> Option<usize> {
        self.kind().channels.iter().position(|channel| channel.name == name)
    }

    /// Returns true if the answer is the outcome alone, with the time of a flip.
    pub fn is_time(self) -> bool {
        self.kind().needs == Needs::Outcome
    }

    /// A phrase with the names of all questions.
    pub(crate) const NAMES: &str = "the questions are flip, first, flips, state, growth and return";
}

impl fmt::Display for QuestionName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.kind().name)
    }
}

impl FromStr for QuestionName {
    type Err = &'static str;

    fn from_str(word: &str) -> Result<Self, &'static str> {
        let named = QuestionName::ALL.into_iter().find(|ask| ask.kind().name == word);
        named.ok_or(QuestionName::NAMES)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_those_of_the_channels() {
        let of = |ask: QuestionName, answer: &[f64], truth: &[f64]| {
            (ask.kind().judged.error)(answer, truth)
        };
        assert!(
            (of(QuestionName::State, &[3.1, 0.0], &[-3.1, 0.02]) - 0.0832).abs() < 1e-3,
            "over the top"
        );
        assert!((of(QuestionName::Growth, &[1.1], &[1.0]) - 0.1).abs() < 1e-12);
        assert_eq!(of(QuestionName::First, &[1.0, 2.5], &[1.0, 2.0]), 0.5);
        assert_eq!(of(QuestionName::First, &[2.0, 2.0], &[1.0, 2.0]), f64::INFINITY);
        assert_eq!(of(QuestionName::Flips, &[1.0, 0.0, 2.0, 0.0], &[0.0, 0.0, 4.0, 0.0]), 3.0);
        assert_eq!(of(QuestionName::Return, &[0.5, 1.0], &[0.25, 9.0]), 0.25);
        assert_eq!(of(QuestionName::Flip, &[1.5], &[1.0]), 0.5);
    }
}
