//! A figure's set-up as one line, to be copied and pasted:
//! `flipmap:lab=double;start=2.2,2.5;masses=1,2`.

use std::ops::RangeInclusive;

use super::{Figure, Lab};
use flipmap_numbers::number_text::brief;
use flipmap_scene::{did_you_mean, not_among};

/// Prefix of every set-up.
pub const PREFIX: &str = "flipmap:lab=";

/// One word of a set-up with its value.
#[derive(Clone, Debug, PartialEq)]
pub struct SetUpWord {
    /// The word.
    pub name: &'static str,
    /// The value.
    pub value: SetUpValue,
}

/// The value of a word.
#[derive(Clone, Debug, PartialEq)]
pub enum SetUpValue {
    /// Numbers, each within a range.
    Numbers {
        /// The numbers.
        numbers: Vec<f64>,
        /// The range.
        range: RangeInclusive<f64>,
    },
    /// One of some names.
    Name {
        /// Index of the name.
        index: usize,
        /// All names.
        names: &'static [&'static str],
    },
}

/// Reasons why a text is no set-up.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SetUpError {
    /// A text of some other kind.
    #[error("this is no figure's set-up: it must begin with '{PREFIX}', as in {PREFIX}double")]
    Foreign,
    /// A figure that does not exist.
    #[error("there is no figure called '{name}'; {allowed}")]
    NoFigure {
        /// What was named.
        name: String,
        /// The figures.
        allowed: String,
    },
    /// A part without a word.
    #[error("the set-up has '{0}' where a word, '=' and a value should be")]
    NoWord(String),
    /// A word that the figure does not have.
    #[error("the set-up has the unknown word '{word}'; the words are {known}{meant}")]
    Unknown {
        /// The word.
        word: String,
        /// The words of the figure.
        known: String,
        /// A question after the word that may be meant; empty if none is similar.
        meant: String,
    },
    /// A word that appears twice.
    #[error("the set-up says {0} twice; leave one of them out")]
    Twice(&'static str),
    /// Words for the map, whose set-up is a location.
    #[error("the map has no words here: its place is a location, as in flipmap:center=0,0;width=6")]
    Map,
    /// A value that cannot be used.
    #[error("the set-up's {name} is '{text}'; it must be {allowed}")]
    Value {
        /// The word.
        name: &'static str,
        /// What was given.
        text: String,
        /// What is allowed.
        allowed: String,
    },
}

impl SetUpWord {
    /// Creates a word whose value is numbers within a range.
    pub(crate) fn numbers(
        name: &'static str,
        numbers: impl Into<Vec<f64>>,
        range: RangeInclusive<f64>,
    ) -> Self {
        SetUpWord { name, value: SetUpValue::Numbers { numbers: numbers.into(), range } }
    }

    /// Creates a word whose value is one of some names.
    pub(crate) fn name(name: &'static str, index: usize, names: &'static [&'static str]) -> Self {
        SetUpWord { name, value: SetUpValue::Name { index, names } }
    }

    /// Returns the value as it is written.
    fn text(&self) -> String {
        match &self.value {
            SetUpValue::Numbers { numbers, .. } => {
                numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
            }
            SetUpValue::Name { index, names } => names[*index].to_string(),
        }
    }

    /// Takes a value that was written.
    fn read(&mut self, text: &str) -> Result<(), SetUpError> {
        let (name, text) = (self.name, text.to_string());
        match &mut self.value {
            SetUpValue::Numbers { numbers, range } => {
                let read: Result<Vec<f64>, _> = text.split(',').map(|x| x.trim().parse()).collect();
                let fits = |read: &Vec<f64>| {
                    read.len() == numbers.len() && read.iter().all(|x| range.contains(x))
                };
                let count = ["one number", "two numbers"][usize::from(numbers.len() == 2)];
                let [from, to] = [range.start(), range.end()].map(|end| brief(*end));
                let allowed = format!("{count} between {from} and {to}");
                let read = read.ok().filter(fits);
                *numbers = read.ok_or(SetUpError::Value { name, text, allowed })?;
            }
            SetUpValue::Name { index, names } => {
                let found = names.iter().position(|known| *known == text);
                let allowed = names.join(" or ");
                *index = found.ok_or(SetUpError::Value { name, text, allowed })?;
            }
        }
        Ok(())
    }
}

/// Returns the numbers of all words, in order.
pub(crate) fn numbers(words: &[SetUpWord]) -> Vec<f64> {
    let number = |word: &SetUpWord| match &word.value {
        SetUpValue::Numbers { numbers, .. } => numbers.clone(),
        SetUpValue::Name { index, .. } => vec![*index as f64],
    };
    words.iter().flat_map(number).collect()
}

impl Lab {
    /// Returns the set-up of the figure that is shown, which [`Lab::open_set_up`] opens again.
    pub fn set_up_text(&mut self) -> String {
        let name = self.figure.name();
        let words = self.live().map_or(Vec::new(), |live| live.set_up());
        let parts = words.iter().map(|word| format!(";{}={}", word.name, word.text()));
        format!("{PREFIX}{name}{}", parts.collect::<String>())
    }

    /// Shows a figure as a line of text sets it up; words that are not given keep their defaults.
    /// If the text is wrong, nothing changes.
    pub fn open_set_up(&mut self, text: &str) -> Result<(), SetUpError> {
        let (figure, words) = parse(text)?;
        self.show_figure(figure);
        if let Some(live) = self.live() {
            live.take_set_up(&numbers(&words));
        }
        Ok(())
    }
}

/// Reads a line of text; returns its figure and all words of the figure's set-up.
pub fn parse(text: &str) -> Result<(Figure, Vec<SetUpWord>), SetUpError> {
    let text = text.trim().strip_prefix(PREFIX).ok_or(SetUpError::Foreign)?;
    let mut parts = text.split(';').map(str::trim).filter(|part| !part.is_empty());
    let name = parts.next().unwrap_or_default();
    let figure = Figure::named(name).ok_or_else(|| SetUpError::NoFigure {
        name: name.to_string(),
        allowed: not_among("figures", &Figure::names(), name),
    })?;
    let fresh = (figure.entry().begin)();
    let mut words = fresh.map_or(Vec::new(), |live| live.set_up());
    let mut said: Vec<&str> = Vec::new();
    for part in parts {
        if words.is_empty() {
            return Err(SetUpError::Map);
        }
        let (key, value) =
            part.split_once('=').ok_or_else(|| SetUpError::NoWord(part.to_string()))?;
        let names: Vec<&str> = words.iter().map(|word| word.name).collect();
        let word = words.iter_mut().find(|word| word.name == key.trim());
        let word = word.ok_or_else(|| SetUpError::Unknown {
            word: key.to_string(),
            meant: did_you_mean(&names, key),
            known: names.join(", "),
        })?;
        if said.contains(&word.name) {
            return Err(SetUpError::Twice(word.name));
        }
        said.push(word.name);
        word.read(value.trim())?;
    }
    Ok((figure, words))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::State;

    #[test]
    fn every_set_up_opens_again_and_every_word_counts() {
        for figure in Figure::all() {
            let mut lab = Lab::new(figure);
            let count = lab.live().map_or(0, |live| live.set_up().len());
            for k in 0..count {
                // Another value of one word at a time.
                let mut word = lab.live().unwrap().set_up()[k].clone();
                match &mut word.value {
                    SetUpValue::Numbers { numbers, range } => {
                        let away =
                            |x: f64| 0.9 * x + 0.1 * (0.5 * range.end() + 0.5 * range.start());
                        numbers.iter_mut().for_each(|x| *x = away(*x).round().max(*range.start()));
                        numbers[0] = 2.0f64.clamp(*range.start(), *range.end());
                    }
                    SetUpValue::Name { index, names } => *index = names.len() - 1,
                }
                let line = format!("{PREFIX}{};{}={}", figure.name(), word.name, word.text());
                lab.open_set_up(&line).unwrap_or_else(|error| panic!("{line}: {error}"));
                assert_eq!(lab.live().unwrap().set_up()[k], word, "{line}");
                let (text, set) = (lab.set_up_text(), lab.set());
                let mut other = Lab::new(Figure::Ghost);
                other.open_set_up(&text).unwrap_or_else(|error| panic!("{text}: {error}"));
                assert_eq!((other.figure, other.set()), (figure, set), "{text}");
            }
        }
    }

    #[test]
    fn a_mistake_is_told_and_changes_nothing() {
        let mut lab = Lab::new(Figure::Double);
        lab.live().unwrap().open(State::rest([1.0, 2.0]));
        let before = lab.set();
        for (line, told) in [
            ("flipmap:center=0,0;width=1", "it must begin with 'flipmap:lab='"),
            ("flipmap:lab=triple", "no figure called 'triple'; the figures are single"),
            ("flipmap:lab=double;start", "has 'start' where a word"),
            ("flipmap:lab=double;mass=1,1", "unknown word 'mass'; the words are start, masses"),
            ("flipmap:lab=double;masses=1", "masses is '1'; it must be two numbers between"),
            ("flipmap:lab=double;masses=1,1e9", "masses is '1,1e9'; it must be two numbers"),
            ("flipmap:lab=double;kind=bars", "kind is 'bars'; it must be points or rods"),
            ("flipmap:lab=map;start=1,1", "the map has no words here"),
            ("flipmap:lab=double;start=1,1;start=2,2", "says start twice"),
            ("flipmap:lab=twenty;count=NaN", "count is 'NaN'; it must be one number between"),
        ] {
            let error = lab.open_set_up(line).unwrap_err().to_string();
            assert!(error.contains(told), "{line}: {error}");
            assert_eq!(lab.set(), before);
        }
    }
}
