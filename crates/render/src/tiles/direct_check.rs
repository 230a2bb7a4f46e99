//! Compares answers of pixels with direct integration from their exact starts.

use rayon::prelude::*;

use super::reader::Reader;
use flipmap_engine::EventSpec;
use flipmap_engine::trust::{Opinion, direct};
use flipmap_pendulum::Status;
use flipmap_scene::question::Channel;
use flipmap_scene::{Grid, Scene};

/// An answer of a pixel, to be compared.
pub(super) struct AnsweredPixel {
    pub pixel: [u32; 2],
    pub status: Status,
    /// Values of the question's channels.
    pub values: Vec<f64>,
}

/// The comparison of a picture's answers with direct integration.
pub(super) struct DirectCheck<'a> {
    grid: &'a Grid,
    question: EventSpec,
    reader: Reader,
    channels: &'static [Channel],
    unit_secs: f64,
}

impl<'a> DirectCheck<'a> {
    /// Creates the check of a scene's pixels; `None` for a question that is not answered directly.
    pub(super) fn new(scene: &Scene, grid: &'a Grid) -> Option<Self> {
        let (ask, question) = (scene.question.ask, EventSpec::from(scene));
        let reader = Reader::new(ask, &question);
        let unit_secs = scene.build.unit_secs();
        let is_answered = !reader.ends().is_extreme() && question.passes == 1;
        let channels = ask.kind().channels;
        is_answered.then_some(DirectCheck { grid, question, reader, channels, unit_secs })
    }

    /// Returns true if integrating a pixel directly takes seconds.
    pub(super) fn takes_long(&self) -> bool {
        direct::takes_long(&self.question, self.grid.pixel_rad())
    }

    /// Integrates all these pixels directly; returns `None` once `keep_going` returns false.
    pub(super) fn opinion(
        &self,
        answers: &[AnsweredPixel],
        keep_going: &(dyn Fn() -> bool + Sync),
    ) -> Option<Opinion> {
        let contradicts = |answer: &&AnsweredPixel| keep_going() && self.contradicts(answer);
        let contradicted = answers.par_iter().filter(contradicts).count();
        keep_going().then_some(Opinion { asked: answers.len(), contradicted })
    }

    /// Returns true if the answer of a pixel differs from that of direct integration.
    fn contradicts(&self, answer: &AnsweredPixel) -> bool {
        let [column, row] = answer.pixel;
        let truth = self.grid.exact_start(column, row).map(|start| {
            let (ends, apart_rad) = (self.reader.ends(), self.grid.pixel_rad());
            let (outcome, end) = direct::answer(&self.question, ends, &start, apart_rad);
            self.reader.read(&outcome, &end)
        });
        let Some((status, values)) = truth else { return answer.status != Status::Forbidden };
        if status != answer.status {
            return true;
        }
        let pairs = answer.values.iter().zip(values);
        let mut channels = self.channels.iter().zip(pairs);
        let is_wrong = |(channel, (a, b)): (&Channel, (&f64, f64))| {
            !channel.is_right(*a, b, 1.0, self.unit_secs)
        };
        status == Status::Answered && channels.any(is_wrong)
    }
}
