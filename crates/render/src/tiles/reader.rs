//! Reads a question's channels from the results of jobs.

use rayon::prelude::*;

use super::Samples;
use flipmap_engine::{EventSpec, FinalState, JobResult};
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::transport::{transported, turns_between};
use flipmap_pendulum::{Outcome, Pendulum, Status};
use flipmap_scene::question::Needs;
use flipmap_scene::question::{MAX_CHANNELS, QuestionInput, QuestionName};

/// A reader of the answers to one question about one pendulum.
#[derive(Clone, Copy, Debug)]
pub struct Reader {
    ask: QuestionName,
    /// The pendulum in reduced units, and its unit of time in s.
    pendulum: Pendulum<f64>,
    unit_secs: f64,
    /// Moment, in reduced time, that answers about a moment describe.
    at: f64,
}

impl Reader {
    /// Creates a reader of the answers to `ask` in results of jobs with this question.
    pub fn new(ask: QuestionName, question: &EventSpec) -> Self {
        let (pendulum, unit_secs) = question.reduced();
        Reader { ask, pendulum, unit_secs, at: question.budget_secs / unit_secs }
    }

    /// Returns the ends that jobs must return.
    pub fn ends(&self) -> Needs {
        self.ask.kind().needs
    }

    /// Writes the answers of a job into the samples at `places`.
    pub(super) fn fill(&self, result: &JobResult, places: &[u32], samples: &mut Samples) {
        if self.ask.is_time() {
            return samples.set_all(places, &result.outcomes);
        }
        let answers = result.outcomes.par_iter().zip(&result.ends);
        let answers: Vec<_> = answers.map(|(outcome, end)| self.read(outcome, end)).collect();
        let channels = self.ask.kind().channels.len();
        for (&place, (status, values)) in places.iter().zip(answers) {
            samples.set_values(place as usize, status, &values[..channels]);
        }
    }

    /// Returns the same reader for answers at the end of another budget.
    pub(super) fn at(self, question: &EventSpec) -> Self {
        Reader { at: question.budget_secs / self.unit_secs, ..self }
    }

    /// Returns the status of an answer and its channels.
    pub fn read(&self, outcome: &Outcome, end: &FinalState) -> (Status, [f64; MAX_CHANNELS]) {
        let ends_at_a_time = self.ask.kind().at_a_time && outcome.status == Status::Unflipped;
        let (mut phase, mut gathered) = (end.phase, end.gathered);
        if ends_at_a_time {
            phase = transported(&self.pendulum, &end.phase, self.at - end.time);
            let since = turns_between(&phase, &end.phase);
            gathered.turns = [0, 1].map(|bob| gathered.turns[bob] - since[bob]);
        }
        let never = self.ends().is_extreme() && gathered.extremum[0].is_infinite();
        let status = if ends_at_a_time && !never { Status::Answered } else { outcome.status };
        let Reader { pendulum, unit_secs, .. } = self;
        let secs = if ends_at_a_time { self.at } else { end.time } * unit_secs;
        let ending = QuestionInput {
            pendulum,
            unit_secs: *unit_secs,
            outcome: *outcome,
            phase,
            secs,
            gathered,
        };
        (status, (self.ask.kind().read)(&ending))
    }

    /// Fills in all channels of samples that were known beforehand. If a sample passes the top in
    /// its first moments, `phase` returns its unit vectors and momenta at that pass.
    pub(super) fn complete(
        &self,
        samples: Samples,
        phase: impl Fn(usize) -> Option<Phase<f64>>,
    ) -> Samples {
        if self.ask.is_time() {
            return samples;
        }
        let channels = self.ask.kind().channels.len();
        let mut all = Samples::unanswered(samples.len(), channels);
        for (index, outcome) in samples.iter().enumerate() {
            all.assure(index, samples.assurance(index));
            if outcome.status != Status::Answered {
                all.set_values(index, outcome.status, &[]);
                continue;
            }
            let phase = phase(index).unwrap_or(FinalState::NOWHERE.phase);
            let end = FinalState { phase, ..FinalState::NOWHERE };
            let (status, values) = self.read(&outcome, &end);
            all.set_values(index, status, &values[..channels]);
        }
        all
    }
}
