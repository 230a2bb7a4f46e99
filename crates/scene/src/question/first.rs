//! `first`: the bob that first goes over the top, and when.

use super::flip::TIME;
use super::{
    Channel, ChannelScale, Followed, Judgement, MAX_CHANNELS, Needs, Painted, QuestionDef,
    QuestionInput, TraceColumns, Watches,
};
use flipmap_pendulum::Rule;
use flipmap_pendulum::crossing::bob_at_top;
use flipmap_pendulum::passes::Pass;

pub(super) const QUESTION: QuestionDef = QuestionDef {
    name: "first",
    asks: "Which bob flips first?",
    about: "Each pixel is a pendulum, coloured by the bob that goes over the top before the other. \
            The channel `time` tells when.",
    channels: &[Channel { name: "bob", unit: "", right: 0.0, scale: ChannelScale::Bobs }, TIME],
    counted: ["flipped", "unflipped"],
    watches: Watches::Always(Rule::Either),
    passes: 1,
    has_count: false,
    at_a_time: false,
    is_even: true,
    painted: Painted::First,
    tint: None,
    follows_cells: true,
    needs: Needs::End,
    read,
    columns: TraceColumns { from: 0, read: columns },
    judged: Judgement {
        budget_secs: 12.0,
        error: apart,
        max_error: 1e-3,
        words: "the bob, and 1 ms",
    },
};

fn read(ending: &QuestionInput) -> [f64; MAX_CHANNELS] {
    let bob = 1 + bob_at_top(&ending.phase);
    [bob as f64, ending.outcome.time, 0.0, 0.0, 0.0, 0.0]
}

fn columns(followed: &mut dyn Followed) -> Vec<f64> {
    match followed.passes().first() {
        Some(Pass { bob, time, .. }) => vec![*bob as f64, time.hi],
        None => vec![f64::NAN; 2],
    }
}

/// Returns the error of the time in s, infinite for the wrong bob.
fn apart(answer: &[f64], truth: &[f64]) -> f64 {
    if answer[0] == truth[0] { (answer[1] - truth[1]).abs() } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::{Accumulators, Outcome, Pendulum};

    #[test]
    fn the_bob_at_the_top_is_the_one_whose_sine_vanishes() {
        let pendulum = Pendulum::points([1.0; 2], [1.0; 2], 1.0);
        let bob = |phase| {
            let outcome = Outcome::flipped(2.5);
            let ending = QuestionInput {
                pendulum: &pendulum,
                unit_secs: 1.0,
                outcome,
                phase,
                secs: 2.5,
                gathered: Accumulators::NONE,
            };
            let [bob, secs, ..] = read(&ending);
            (bob, secs)
        };
        assert_eq!(bob([-1.0, 1e-17, -0.6, 0.8, 0.0, 0.0]), (1.0, 2.5));
        assert_eq!(bob([-0.6, 0.8, -1.0, -1e-17, 0.0, 0.0]), (2.0, 2.5));
        assert_eq!(bob([1.0, 0.0, -1.0, 1e-9, 0.0, 0.0]), (2.0, 2.5), "the first one hangs");
    }
}
