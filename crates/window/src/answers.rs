//! The answers that the map shows, for the pointer and for pins.

use super::hover::{self, Answer};
use super::model::AppModel;
use flipmap_engine::Trust;
use flipmap_numbers::Exact;
use flipmap_pendulum::Outcome;

impl AppModel {
    /// Returns the answer that the map shows for the sample at a place.
    pub(super) fn answer_at(&mut self, place: [Exact; 2]) -> Option<Answer> {
        let (level, question) = (self.state.screen().level(), self.state.question);
        let until_secs = question.ask.is_time().then_some(question.budget.secs);
        hover::answer_at(&mut self.compute.explorer, place, level, until_secs)
    }

    /// Returns the first flip that the map shows for the sample at a place.
    pub(super) fn told_at(&mut self, place: [Exact; 2]) -> Option<(Outcome, Trust)> {
        let question = &self.state.question;
        if !question.ask.is_time() || question.count > 1 {
            return None;
        }
        self.answer_at(place).map(|answer| (answer.outcome(), answer.trust))
    }

    /// Passes to the pins the outcomes that the map now shows for their pixels.
    pub(super) fn show_pins(&mut self) {
        let level = self.state.screen().level();
        let silent = self.state.pins.iter().filter(|pin| pin.told.is_none());
        let silent: Vec<_> =
            silent.filter_map(|pin| pin.start.place.map(|place| (pin.id, place))).collect();
        for (id, place) in silent {
            // A place that is not a sample of this level has no outcome here.
            if hover::sample_at(place, level)[0] == place
                && let Some(told) = self.told_at(place)
            {
                self.state.pins.tell(id, told);
            }
        }
    }
}
