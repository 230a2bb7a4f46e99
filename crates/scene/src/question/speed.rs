//! `speed`: how fast the second bob gets, and when.

use super::{
    Channel, ChannelScale, Followed, Judgement, MAX_CHANNELS, Needs, Painted, QuestionDef,
    QuestionInput, TraceColumns, Watches,
};
use flipmap_pendulum::Rule;
use flipmap_pendulum::extremum::{Extremum, Measure};

pub(super) const QUESTION: QuestionDef = QuestionDef {
    name: "speed",
    asks: "How fast does it get?",
    about: "Each pixel is a pendulum, coloured by the greatest speed that its second bob reaches \
            within the budget. Bright filaments are whips: the first rod stops and hands its energy on.",
    channels: &[
        Channel { name: "speed", unit: "m/s", right: 1e-3, scale: ChannelScale::Speeds(3.5) },
        Channel { name: "time", unit: "s", right: 1e-2, scale: ChannelScale::Times },
    ],
    counted: ["answered", "unanswered"],
    watches: Watches::Always(Rule::Neither),
    passes: 1,
    has_count: false,
    at_a_time: true,
    is_even: true,
    painted: Painted::First,
    tint: None,
    follows_cells: false,
    needs: Needs::Extremum(Extremum::GreatestSpeed),
    read,
    columns: TraceColumns { from: 0, read: columns },
    judged: Judgement { budget_secs: 5.0, error: apart, max_error: 1e-3, words: "0.1 %" },
};

fn read(ending: &QuestionInput) -> [f64; MAX_CHANNELS] {
    let QuestionInput { pendulum, unit_secs, phase, secs, gathered, .. } = ending;
    let measure = Measure::new(Extremum::GreatestSpeed, **pendulum, *phase);
    let extremum = measure.ended(gathered.extremum, (phase, secs / unit_secs));
    let [speed, time] = measure.extremum.in_si(extremum, *unit_secs);
    [speed, time, 0.0, 0.0, 0.0, 0.0]
}

fn columns(followed: &mut dyn Followed) -> Vec<f64> {
    followed.extremum().to_vec()
}

/// Returns the error of the speed as a share of the true one.
fn apart(answer: &[f64], truth: &[f64]) -> f64 {
    let apart = (answer[0] - truth[0]).abs();
    if apart > 0.0 { apart / truth[0].abs() } else { 0.0 }
}
