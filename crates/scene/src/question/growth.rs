//! `growth`: the finite-time Lyapunov exponent over the budget.

use super::{
    Channel, ChannelScale, Followed, Judgement, MAX_CHANNELS, Needs, Painted, QuestionDef,
    QuestionInput, TraceColumns, Watches,
};
use flipmap_pendulum::Rule;

pub(super) const QUESTION: QuestionDef = QuestionDef {
    name: "growth",
    asks: "How chaotic is it?",
    about: "Each pixel is a pendulum, coloured by how fast the largest of all nudges to its start \
            grows over the budget. Islands of regular motion are dark and chaos is bright.",
    channels: &[Channel {
        name: "exponent",
        unit: "1/s",
        right: 1e-2,
        scale: ChannelScale::Rates(0.5),
    }],
    counted: ["answered", "unanswered"],
    watches: Watches::Always(Rule::Neither),
    passes: 1,
    has_count: false,
    at_a_time: true,
    is_even: true,
    painted: Painted::First,
    tint: None,
    follows_cells: true,
    needs: Needs::Growth,
    read,
    columns: TraceColumns { from: 0, read: column },
    judged: Judgement { budget_secs: 8.0, error: apart, max_error: 0.01, words: "1 %" },
};

fn read(ending: &QuestionInput) -> [f64; MAX_CHANNELS] {
    [ending.gathered.log_growth / ending.secs, 0.0, 0.0, 0.0, 0.0, 0.0]
}

fn column(followed: &mut dyn Followed) -> Vec<f64> {
    vec![followed.exponent()]
}

/// Returns the error of the exponent, as a share of the true one.
fn apart(answer: &[f64], truth: &[f64]) -> f64 {
    ((answer[0] - truth[0]) / truth[0]).abs()
}
