//! `flip`: the moment at which a watched bob first goes over the top.

use super::{
    Channel, ChannelScale, Followed, Judgement, MAX_CHANNELS, Needs, Painted, QuestionDef,
    QuestionInput, TraceColumns, Watches,
};

pub(super) const QUESTION: QuestionDef = QuestionDef {
    name: "flip",
    asks: "When does it flip?",
    about: "Each pixel is a pendulum, coloured by the time at which the watched bob goes over \
            the top. Where energy forbids that, nothing is simulated.",
    channels: &[TIME],
    counted: ["flipped", "unflipped"],
    watches: Watches::TheRule,
    passes: 1,
    has_count: true,
    at_a_time: false,
    is_even: true,
    painted: Painted::First,
    tint: None,
    follows_cells: true,
    needs: Needs::Outcome,
    read,
    columns: TraceColumns { from: 0, read: column },
    judged: Judgement { budget_secs: 12.0, error: apart, max_error: 1e-3, words: "1 ms" },
};

/// A channel with the time of an event.
pub(super) const TIME: Channel =
    Channel { name: "time", unit: "s", right: 1e-3, scale: ChannelScale::Times };

fn read(ending: &QuestionInput) -> [f64; MAX_CHANNELS] {
    [ending.outcome.time, 0.0, 0.0, 0.0, 0.0, 0.0]
}

/// Returns the time of the flip asked for, or NaN if it has not happened yet.
fn column(followed: &mut dyn Followed) -> Vec<f64> {
    let flips = followed.watched_passes();
    vec![flips.get(followed.count() as usize - 1).map_or(f64::NAN, |flip| flip.time.hi)]
}

/// Returns the error of a time, in s.
fn apart(answer: &[f64], truth: &[f64]) -> f64 {
    (answer[0] - truth[0]).abs()
}
