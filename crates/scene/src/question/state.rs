//! `state`: where the pendulum is, and how fast it moves, at a given time.

use std::f64::consts::PI;

use super::{
    Channel, ChannelScale, Followed, Judgement, MAX_CHANNELS, Needs, Painted, QuestionDef,
    QuestionInput, TraceColumns, Watches,
};
use flipmap_numbers::Dd;
use flipmap_pendulum::Rule;

pub(super) const QUESTION: QuestionDef = QuestionDef {
    name: "state",
    asks: "Where is it at time t?",
    about: "Each pixel is a pendulum, coloured by where its rods point at the time `at`. Neighbours \
            of one colour still swing together.",
    channels: &[
        angle("theta1"),
        angle("theta2"),
        speed("omega1"),
        speed("omega2"),
        turns("turns1"),
        turns("turns2"),
    ],
    counted: ["answered", "unanswered"],
    watches: Watches::Always(Rule::Neither),
    passes: 1,
    has_count: false,
    at_a_time: true,
    is_even: false,
    painted: Painted::TwoAngles,
    tint: Some(("energy", Painted::EnergySplit)),
    follows_cells: true,
    needs: Needs::End,
    read,
    columns: TraceColumns { from: 4, read: columns },
    judged: Judgement { budget_secs: 12.0, error: apart, max_error: 1e-3, words: "1e-3 rad" },
};

const fn angle(name: &'static str) -> Channel {
    Channel { name, unit: "rad", right: 1e-3, scale: ChannelScale::Cyclic }
}

const fn speed(name: &'static str) -> Channel {
    Channel { name, unit: "rad/s", right: 1e-2, scale: ChannelScale::Between(-10.0, 10.0) }
}

const fn turns(name: &'static str) -> Channel {
    Channel { name, unit: "", right: 0.0, scale: ChannelScale::Counts(-5, 5) }
}

fn read(ending: &QuestionInput) -> [f64; MAX_CHANNELS] {
    let [x1, y1, x2, y2, ..] = ending.phase;
    let [theta1, theta2] = [y1.atan2(x1), y2.atan2(x2)].map(|a| if a == -PI { PI } else { a });
    let [omega1, omega2] = ending.pendulum.speeds(&ending.phase).map(|w| w / ending.unit_secs);
    let [turns1, turns2] = ending.gathered.turns.map(f64::from);
    [theta1, theta2, omega1, omega2, turns1, turns2]
}

fn columns(followed: &mut dyn Followed) -> Vec<f64> {
    followed.turns().map(f64::from).to_vec()
}

/// Returns the larger error of the two angles, in rad.
fn apart(answer: &[f64], truth: &[f64]) -> f64 {
    let turned = |k: usize| Dd::new(answer[k] - truth[k]).wrapped().hi.abs();
    turned(0).max(turned(1))
}
