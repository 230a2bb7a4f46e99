//! The classes of answers.

use flipmap_engine::Trust;
use flipmap_pendulum::Status;
use flipmap_render::tiles::Samples;
use flipmap_scene::question::QuestionName;

/// Returns true if the answers to a question are of a few classes.
pub(crate) fn has_basins(ask: QuestionName) -> bool {
    !names(ask).is_empty()
}

/// The names of the classes of a question; energy is counted separately.
pub(crate) fn names(ask: QuestionName) -> &'static [&'static str] {
    match ask {
        QuestionName::Flip => &["flips", "does not flip"],
        QuestionName::First => &["first bob", "second bob", "neither"],
        QuestionName::Flips
        | QuestionName::State
        | QuestionName::Growth
        | QuestionName::Return
        | QuestionName::Speed => &[],
    }
}

/// Returns the class of a sample: its index among the names. What is forbidden belongs to the last one.
pub(crate) fn class(ask: QuestionName, samples: &Samples, index: usize) -> usize {
    match (samples.get(index).status, ask) {
        (Status::Answered, QuestionName::First) => usize::from(samples.values(index)[0] > 1.5),
        (Status::Answered, _) => 0,
        (Status::Unflipped | Status::Forbidden | Status::Failed, _) => names(ask).len() - 1,
    }
}

/// Returns the moment of a flip in s, or `None` if there is none.
pub(crate) fn flip_secs(ask: QuestionName, samples: &Samples, index: usize) -> Option<f64> {
    let channel = usize::from(ask == QuestionName::First);
    let is_flip = samples.get(index).status == Status::Answered;
    is_flip.then(|| samples.values(index)[channel])
}

/// Returns true if a sample is known for sure.
pub(crate) fn is_sure(samples: &Samples, index: usize) -> bool {
    match samples.get(index).status {
        Status::Forbidden => true,
        Status::Failed => false,
        Status::Answered | Status::Unflipped => match samples.trust(index) {
            Trust::Agreed | Trust::Confirmed | Trust::Settled => true,
            Trust::Unchecked | Trust::Uncertain => false,
        },
    }
}
