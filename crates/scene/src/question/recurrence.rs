//! `return`: how near the pendulum comes back to its start, and when.

use super::{
    Channel, ChannelScale, Followed, Judgement, MAX_CHANNELS, Needs, Painted, QuestionDef,
    QuestionInput, TraceColumns, Watches,
};
use flipmap_pendulum::Rule;
use flipmap_pendulum::extremum::Extremum;

pub(super) const QUESTION: QuestionDef = QuestionDef {
    name: "return",
    asks: "Does it come back?",
    about: "Each pixel is a pendulum, coloured by how near it comes back to its start within the \
            budget. Dark threads are periodic orbits.",
    channels: &[
        Channel { name: "distance", unit: "", right: 1e-3, scale: ChannelScale::Between(0.0, 1.0) },
        Channel { name: "time", unit: "s", right: 1e-2, scale: ChannelScale::Times },
    ],
    counted: ["returned", "not returned"],
    watches: Watches::Always(Rule::Neither),
    passes: 1,
    has_count: false,
    at_a_time: true,
    is_even: true,
    painted: Painted::First,
    tint: None,
    follows_cells: false,
    needs: Needs::Extremum(Extremum::NearestReturn),
    read,
    columns: TraceColumns { from: 0, read: columns },
    judged: Judgement { budget_secs: 5.0, error: apart, max_error: 1e-3, words: "1e-3" },
};

fn read(ending: &QuestionInput) -> [f64; MAX_CHANNELS] {
    let extremum = ending.gathered.extremum;
    let [distance, time] = Extremum::NearestReturn.in_si(extremum, ending.unit_secs);
    [distance, time, 0.0, 0.0, 0.0, 0.0]
}

fn columns(followed: &mut dyn Followed) -> Vec<f64> {
    followed.extremum().to_vec()
}

/// Returns the error of the distance.
fn apart(answer: &[f64], truth: &[f64]) -> f64 {
    (answer[0] - truth[0]).abs()
}
