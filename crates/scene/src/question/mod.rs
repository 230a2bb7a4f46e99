//! Questions: what is asked of every pendulum, and how its answer is read.
//!
//! An engine follows a pendulum until a watched bob passes the top or the budget is used up; it
//! knows no question by name. A question says which bobs are watched and for how long, and reads
//! its *channels* from the outcome and the end of the integration. A channel is a named number with
//! a unit, a natural scale of colours, and the error within which it counts as right.
//!
//! Each question has a file here and an entry in [`QuestionName::ALL`].

mod first;
mod flip;
mod flips;
mod growth;
mod recurrence;
mod speed;
mod state;

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::allowed::{did_you_mean, in_a_row, named};
use flipmap_numbers::Dd;
use flipmap_pendulum::extremum::Extremum;
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
    /// The greatest speed of the second bob.
    Speed,
}

/// The definition of a question.
pub struct QuestionDef {
    /// Name in options and files.
    pub name: &'static str,
    /// What the question asks of each start, as a user would ask it.
    pub asks: &'static str,
    /// Two sentences on what its map shows.
    pub about: &'static str,
    /// The numbers of an answer, in order; at most [`MAX_CHANNELS`].
    pub channels: &'static [Channel],
    /// Words for pixels with an answer and for those without one at the end of the budget.
    pub counted: [&'static str; 2],
    /// The bobs that it watches.
    pub watches: Watches,
    /// Number of passes over the top that ends a simulation; [`u32::MAX`] if none does. The scene's
    /// count replaces it if `has_count` is true.
    pub passes: u32,
    /// True if the question asks for the scene's count-th pass.
    pub has_count: bool,
    /// True if the answer is read at the time `at`, not at an event.
    pub at_a_time: bool,
    /// True if mirror images, with all angles and speeds negated, have equal answers.
    pub is_even: bool,
    /// Channels that its colours show.
    pub painted: Painted,
    /// An alternative way to paint the channels, with its name.
    pub tint: Option<(&'static str, Painted)>,
    /// True if deep views can be answered by following cells of starts.
    pub follows_cells: bool,
    /// Results that an engine has to return.
    pub needs: Needs,
    /// Returns the values of the channels.
    pub read: fn(&QuestionInput) -> [f64; MAX_CHANNELS],
    /// Columns that it adds to a trace.
    pub columns: TraceColumns,
    /// Criteria by which the report judges answers against true ones.
    pub judged: Judgement,
}

/// Criteria by which the report judges the answers to a question against true ones.
pub struct Judgement {
    /// Budget in s of the map that is judged.
    pub budget_secs: f64,
    /// Returns the error of an answer's channels, given those of the true orbit.
    pub error: fn(&[f64], &[f64]) -> f64,
    /// Largest error of a right answer.
    pub max_error: f64,
    /// The largest error of a right answer in words.
    pub words: &'static str,
}

/// The columns that a question adds to a trace: its channels as of the time of each row.
pub struct TraceColumns {
    /// Index of the first channel that is a column; a trace already has the channels before it.
    pub from: usize,
    /// Returns the values of the columns, NaN where there is none yet.
    pub read: fn(&mut dyn Followed) -> Vec<f64>,
}

/// A pendulum that is followed from row to row of a trace.
pub trait Followed {
    /// Returns the passes over the top so far.
    fn passes(&self) -> &[Pass];
    /// Returns the passes so far by watched bobs.
    fn watched_passes(&self) -> Vec<Pass>;
    /// Returns the scene's count.
    fn count(&self) -> u32;
    /// Returns the whole turns of both rods.
    fn turns(&self) -> [i32; 2];
    /// Returns the exponent of the growth so far, in 1/s.
    fn exponent(&mut self) -> f64;
    /// Returns the extreme so far of the quantity that the question needs, and its time in s; NaN if
    /// there is none yet.
    fn extremum(&mut self) -> [f64; 2];
}

/// The bobs that a question watches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watches {
    /// The bobs of the scene's rule.
    TheRule,
    /// The same bobs in every scene.
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
    /// The kinetic share of the energy, measured from hanging at rest; it uses both angles and both
    /// speeds.
    EnergySplit,
}

/// Results of an integration that a question reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Needs {
    /// The outcome alone.
    #[default]
    Outcome,
    /// The outcome and the state at the end.
    End,
    /// The growth of nudges, with the outcome and the state at the end.
    Growth,
    /// The extreme of a quantity along the motion, with the outcome and the state at the end.
    Extremum(Extremum),
}

impl Needs {
    /// Returns true if pendulums carry numbers along for these results, from the release to the end
    /// of the budget.
    pub fn are_carried(self) -> bool {
        matches!(self, Needs::Growth | Needs::Extremum(_))
    }

    /// Returns true if an extreme is looked for.
    pub fn is_extreme(self) -> bool {
        matches!(self, Needs::Extremum(_))
    }
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
    /// Largest error of a right value, in its unit; for rates and speeds, as a share of the true
    /// value.
    pub right: f64,
    /// Natural scale of its colours.
    pub scale: ChannelScale,
}

impl Channel {
    /// Returns true if a value's error is at most `share` times the allowed error. The allowed
    /// errors of times and speeds depend on the pendulum's natural unit of time, `unit_secs`.
    pub fn is_right(&self, value: f64, truth: f64, share: f64, unit_secs: f64) -> bool {
        let apart = (value - truth).abs();
        let allowed = match self.scale {
            ChannelScale::Times if self.right <= right_secs(f64::INFINITY) => right_secs(unit_secs),
            ChannelScale::Rates(_) | ChannelScale::Speeds(_) => self.right * truth.abs(),
            _ if self.unit == "rad/s" => {
                // A fast pendulum has larger speeds, which are allowed the same relative error.
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
    /// Whole numbers from the first to the second; numbers beyond them have the colours of these
    /// ends.
    Counts(i32, i32),
    /// The number of a bob, 1 or 2.
    Bobs,
    /// Rates, from 0 to this many per natural unit of time of the pendulum.
    Rates(f64),
    /// Speeds, from 0 to this many lengths of the second rod per natural unit of time.
    Speeds(f64),
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
    /// State at the event, or else at the end of the budget, in reduced units.
    pub phase: Phase<f64>,
    /// Simulated seconds until that state.
    pub secs: f64,
    /// Quantities gathered until that state.
    pub gathered: Accumulators,
}

impl QuestionDef {
    /// Returns a phrase with the names of the channels, for a `typed` name that is none of them.
    pub(crate) fn has_no_channel(&self, typed: &str) -> String {
        let mut names: Vec<&str> = self.channels.iter().map(|channel| channel.name).collect();
        let mut phrase = format!("the question {} has {}", self.name, in_a_row(&names, "and"));
        if let Some((tint, _)) = self.tint {
            phrase += &format!(", and the colours of {tint}");
            names.push(tint);
        }
        phrase + &did_you_mean(&names, typed)
    }
}

impl QuestionName {
    /// Every question.
    pub const ALL: [QuestionName; 7] = [
        QuestionName::Flip,
        QuestionName::First,
        QuestionName::Flips,
        QuestionName::State,
        QuestionName::Growth,
        QuestionName::Return,
        QuestionName::Speed,
    ];

    /// Returns the definition of the question.
    pub fn kind(self) -> &'static QuestionDef {
        match self {
            QuestionName::Flip => &flip::QUESTION,
            QuestionName::First => &first::QUESTION,
            QuestionName::Flips => &flips::QUESTION,
            QuestionName::State => &state::QUESTION,
            QuestionName::Growth => &growth::QUESTION,
            QuestionName::Return => &recurrence::QUESTION,
            QuestionName::Speed => &speed::QUESTION,
        }
    }

    /// Returns the bobs that are watched in a scene with this rule.
    pub(crate) fn watched(self, rule: Rule) -> Rule {
        match self.kind().watches {
            Watches::TheRule => rule,
            Watches::Always(rule) => rule,
        }
    }

    /// Returns the names of the channels of all questions, and of their tints.
    pub fn channel_names() -> Vec<&'static str> {
        let named = |ask: QuestionName| {
            let kind = ask.kind();
            let channels = kind.channels.iter().map(|channel| channel.name);
            channels.chain(kind.tint.map(|(tint, _)| tint))
        };
        let mut names: Vec<&str> = QuestionName::ALL.into_iter().flat_map(named).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Returns the index of the channel with this name.
    pub(crate) fn channel(self, name: &str) -> Option<usize> {
        self.kind().channels.iter().position(|channel| channel.name == name)
    }

    /// Returns true if the answer is only the outcome, with the time of a flip.
    pub fn is_time(self) -> bool {
        self.kind().needs == Needs::Outcome
    }

    /// Returns true if the moment of a flip is among the answers, so that checks estimate its error.
    pub fn times_flips(self) -> bool {
        match self {
            QuestionName::Flip | QuestionName::First => true,
            QuestionName::Flips
            | QuestionName::State
            | QuestionName::Growth
            | QuestionName::Return
            | QuestionName::Speed => false,
        }
    }

    /// Returns the names of all questions.
    pub fn names() -> Vec<&'static str> {
        QuestionName::ALL.map(|ask| ask.kind().name).to_vec()
    }

    /// Returns the questions whose answers are read at the time `at`.
    pub(crate) fn at_a_time() -> Vec<QuestionName> {
        QuestionName::ALL.into_iter().filter(|ask| ask.kind().at_a_time).collect()
    }
}

impl fmt::Display for QuestionName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.kind().name)
    }
}

impl FromStr for QuestionName {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        named("questions", &QuestionName::ALL.map(|ask| (ask.kind().name, ask)), word)
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
