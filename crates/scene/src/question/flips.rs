//! `flips`: the number of times that each bob goes over the top within the budget, by direction.

use super::{
    Channel, ChannelScale, Followed, Judgement, MAX_CHANNELS, Needs, Painted, QuestionDef,
    QuestionInput, TraceColumns, Watches,
};
use flipmap_pendulum::Rule;

pub(super) const QUESTION: QuestionDef = QuestionDef {
    name: "flips",
    asks: "How often does it flip?",
    about: "Each pixel is a pendulum, coloured by the number of times that its bobs go over the top \
            within the budget. Channels count each bob and direction.",
    channels: &[
        count("first_left"),
        count("first_right"),
        count("second_left"),
        count("second_right"),
    ],
    counted: ["answered", "unanswered"],
    watches: Watches::Always(Rule::Either),
    passes: u32::MAX,
    has_count: false,
    at_a_time: true,
    // A mirror image exchanges left and right.
    is_even: false,
    painted: Painted::Sum,
    tint: None,
    follows_cells: false,
    needs: Needs::End,
    read,
    columns: TraceColumns { from: 0, read: columns },
    judged: Judgement { budget_secs: 8.0, error: apart, max_error: 0.0, words: "every count" },
};

/// A channel that counts passes in one direction; anticlockwise passes go over the top towards the
/// left.
const fn count(name: &'static str) -> Channel {
    Channel { name, unit: "", right: 0.0, scale: ChannelScale::Counts(0, 10) }
}

fn read(ending: &QuestionInput) -> [f64; MAX_CHANNELS] {
    let [a, b, c, d] = ending.gathered.passes.map(f64::from);
    [a, b, c, d, 0.0, 0.0]
}

fn columns(followed: &mut dyn Followed) -> Vec<f64> {
    let count = |(bob, left)| {
        let all = followed.passes().iter();
        all.filter(|pass| pass.bob == bob && pass.anticlockwise == left).count() as f64
    };
    [(1, true), (1, false), (2, true), (2, false)].map(count).to_vec()
}

/// Returns the number of passes counted too many or too few.
fn apart(answer: &[f64], truth: &[f64]) -> f64 {
    answer.iter().zip(truth).map(|(a, b)| (a - b).abs()).sum()
}
