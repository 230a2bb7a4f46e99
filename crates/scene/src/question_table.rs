//! The `[question]` table of a scene file: the question asked about every start.

use serde::{Deserialize, Serialize};

use super::allowed::in_a_row;
use super::{Budget, SceneError, Setting};
use crate::question::{Needs, QuestionName, Watches};
use flipmap_pendulum::Rule;

/// The question asked about every start. Keys added after the first release are written only where
/// they differ from their defaults.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct QuestionSettings {
    /// The question's name.
    #[serde(skip_serializing_if = "is_default")]
    pub ask: QuestionName,
    /// The rule: which bob is watched.
    pub rule: Rule,
    /// Simulated seconds that a pixel may use.
    pub budget: Budget,
    /// Time of the answer in s, for questions about a moment; `None` means the end of the budget.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<f64>,
    /// Number of the flip whose time is asked for, from 1.
    #[serde(skip_serializing_if = "is_one")]
    pub count: u32,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "what serde calls")]
fn is_one(count: &u32) -> bool {
    *count == 1
}

impl Default for QuestionSettings {
    fn default() -> Self {
        let (ask, rule, budget) = (QuestionName::Flip, Rule::Second, Budget::default());
        QuestionSettings { ask, rule, budget, at: None, count: 1 }
    }
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl QuestionSettings {
    /// Largest allowed `count`.
    pub const MAX_COUNT: u32 = 1_000_000;

    /// Error text for a rule given to a question that has none.
    pub(super) const RULE_IS_FOR: &str = "only the question flip has a rule: omit it, or ask flip";

    /// Returns true if the question watches the bobs chosen by the rule.
    pub(super) fn has_rule(&self) -> bool {
        self.ask.kind().watches == Watches::TheRule
    }

    /// The bobs that are watched.
    pub fn watched(&self) -> Rule {
        self.ask.watched(self.rule)
    }

    /// Returns true if deep views can be answered by following cells of starts.
    pub(crate) fn follows_cells(&self) -> bool {
        self.ask.kind().follows_cells && self.passes() == 1
    }

    /// Returns the indices of the bobs whose passes over the top the answer reports or counts.
    pub(crate) fn reported_bobs(&self) -> &'static [usize] {
        match self.watched() {
            Rule::Neither if self.ask.kind().needs == Needs::End => Rule::Either.watched(),
            rule => rule.watched(),
        }
    }

    /// Returns the number of passes over the top that ends a simulation, or [`u32::MAX`] if none
    /// does.
    pub fn passes(&self) -> u32 {
        if self.ask.kind().has_count { self.count } else { self.ask.kind().passes }
    }

    /// Returns the simulated time in seconds at which integration stops.
    pub fn end_secs(&self) -> f64 {
        match self.at {
            Some(at) if self.ask.kind().at_a_time => at,
            _ => self.budget.secs,
        }
    }

    /// Checks the settings of this question; the budget must have been checked before.
    pub(super) fn check(&self) -> Result<(), SceneError> {
        let refuse = |setting: Setting, value: String, allowed: String| {
            Err(SceneError::new(setting.name(), value, allowed))
        };
        Setting::Count.require((1..=Self::MAX_COUNT).contains(&self.count), &self.count)?;
        if self.rule != Rule::default() && !self.has_rule() {
            let value = format!("'{}'", self.rule);
            return refuse(Setting::Rule, value, Self::RULE_IS_FOR.to_string());
        }
        if self.count > 1 && !self.ask.kind().has_count {
            let allowed = "only the question flip counts".to_string();
            return refuse(Setting::Count, self.count.to_string(), allowed);
        }
        let Some(at) = self.at else { return Ok(()) };
        if !self.ask.kind().at_a_time {
            let names = in_a_row(&QuestionName::at_a_time(), "and");
            let allowed = format!("only the questions {names} last until a given time");
            return refuse(Setting::At, at.to_string(), allowed);
        }
        let budget = self.budget.secs;
        if at == 0.0 && self.ask.kind().needs == Needs::Growth {
            let allowed =
                format!("growth takes time: it must lie above 0 and within the budget, {budget} s");
            return refuse(Setting::At, format!("{at} s"), allowed);
        }
        if !(at >= 0.0 && at <= budget) {
            let allowed = format!("it must lie within the budget, between 0 and {budget} s");
            return refuse(Setting::At, format!("{at} s"), allowed);
        }
        Ok(())
    }
}
