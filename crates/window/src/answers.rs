//! The answers that the map shows, for the pointer and for pins.

use super::state::AppState;
use flipmap_engine::Assurance;
use flipmap_numbers::Exact;
use flipmap_pendulum::Outcome;
use flipmap_render::tiles::explorer::Explorer;
use flipmap_screen::hover::{self, Answer};

impl AppState {
    /// Returns the answer that the map shows for the sample at a place.
    pub(super) fn answer_at(&self, explorer: &mut Explorer, place: [Exact; 2]) -> Option<Answer> {
        let (level, question) = (self.screen().level(), self.question);
        let until_secs = question.ask.is_time().then_some(question.budget.secs);
        hover::answer_at(explorer, place, level, until_secs)
    }

    /// Returns the first flip that the map shows for the sample at a place.
    pub(super) fn told_at(
        &self,
        explorer: &mut Explorer,
        place: [Exact; 2],
    ) -> Option<(Outcome, Assurance)> {
        let question = &self.question;
        if !question.ask.is_time() || question.count > 1 {
            return None;
        }
        self.answer_at(explorer, place).map(|answer| (answer.outcome(), answer.assurance))
    }

    /// Passes to the pins the outcomes that the map now shows for their pixels.
    pub(super) fn tell_pins(&mut self, explorer: &mut Explorer) {
        let level = self.screen().level();
        let silent = self.pins.iter().filter(|pin| pin.told.is_none());
        let silent: Vec<_> =
            silent.filter_map(|pin| pin.start.place.map(|place| (pin.id, place))).collect();
        for (id, place) in silent {
            // A place that is not a sample of this level has no outcome here.
            if hover::sample_at(place, level)[0] == place
                && let Some(told) = self.told_at(explorer, place)
            {
                self.pins.tell(id, told);
            }
        }
    }
}
