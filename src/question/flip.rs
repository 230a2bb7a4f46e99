//! `flip`: the moment at which a watched bob first goes over the top.

use super::{Channel, ChannelScale, Ending, MOST_CHANNELS, Needs, Painted, QuestionKind, Watches};

pub(super) const QUESTION: QuestionKind = QuestionKind {
    name: "flip",
    about: "Each pixel is a pendulum, coloured by the time at which the watched bob goes over \
            the top. Where energy forbids that, nothing is simulated.",
    channels: &[TIME],
    counted: ["flipped", "unflipped"],
    channel_names: "the question flip has time",
    watches: Watches::TheRule,
    passes: 1,
    at_a_time: false,
    is_even: true,
    painted: Painted::First,
    tint: None,
    follows_cells: true,
    needs: Needs::Outcome,
    read,
};

/// The time of an event.
pub(super) const TIME: Channel =
    Channel { name: "time", unit: "s", right: 1e-3, scale: ChannelScale::Times };

fn read(ending: &Ending) -> [f64; MOST_CHANNELS] {
    [ending.outcome.time, 0.0, 0.0, 0.0, 0.0, 0.0]
}
