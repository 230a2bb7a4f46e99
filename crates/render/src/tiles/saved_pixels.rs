//! Pixels that one run saves for a later one with a larger budget: the channels of those that are
//! done, and the integrator states of those that go on.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use flipmap_engine::IntegratorState;
use flipmap_pendulum::{Outcome, Status};

/// Pixels by their index in the picture, row by row from the top. Forbidden pixels and mirror
/// images are not among them, because they need no integration.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SavedPixels {
    /// Channels of the pixels that are done.
    over: BTreeMap<u64, Vec<f64>>,
    failed: Vec<u64>,
    paused: BTreeMap<u64, IntegratorState>,
}

/// The result of an earlier run for a pixel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SavedPixel {
    /// Final outcome of a pixel that is done.
    Over(Outcome),
    /// State of a pixel that had not flipped.
    Unfinished(IntegratorState),
}

impl SavedPixels {
    /// Returns what is known of pixel `index`.
    pub(crate) fn known(&self, index: u64) -> Option<SavedPixel> {
        // Further channels of a question are set later.
        let over = self.values(index).map(|values| Outcome::flipped(values[0]));
        let failed = || {
            let failed = self.failed.binary_search(&index).is_ok();
            failed.then(|| Outcome::without_time(Status::Failed))
        };
        let paused = || self.paused.get(&index).cloned().map(SavedPixel::Unfinished);
        over.or_else(failed).map(SavedPixel::Over).or_else(paused)
    }

    /// Returns the channels of pixel `index` if it is done.
    pub(crate) fn values(&self, index: u64) -> Option<&[f64]> {
        self.over.get(&index).map(Vec::as_slice)
    }

    /// Saves the status and the channels of pixel `index`, which is done.
    pub(crate) fn finish(&mut self, index: u64, status: Status, values: &[f64]) {
        self.paused.remove(&index);
        if status == Status::Answered {
            self.over.insert(index, values.to_vec());
        } else if let Err(place) = self.failed.binary_search(&index) {
            self.failed.insert(place, index);
        }
    }

    /// Saves the state of pixel `index`, which has not flipped.
    pub(crate) fn pause(&mut self, index: u64, state: IntegratorState) {
        self.paused.insert(index, state);
    }

    /// Returns true if no pixel is saved.
    pub fn is_empty(&self) -> bool {
        self.over.is_empty() && self.failed.is_empty() && self.paused.is_empty()
    }

    /// Number of pixels that can be resumed.
    pub fn paused(&self) -> usize {
        self.paused.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_engine::NUMBERS;

    #[test]
    fn what_was_kept_is_known_and_nothing_else() {
        let state = IntegratorState::new(7, [0.5; NUMBERS]);
        let mut kept = SavedPixels::default();
        kept.pause(3, state.clone());
        kept.finish(1, Status::Answered, &[2.5]);
        kept.finish(9, Status::Failed, &[]);
        kept.finish(4, Status::Failed, &[]);
        assert_eq!(kept.known(3), Some(SavedPixel::Unfinished(state)));
        assert_eq!(kept.known(1), Some(SavedPixel::Over(Outcome::flipped(2.5))));
        let failed = SavedPixel::Over(Outcome::without_time(Status::Failed));
        assert_eq!((kept.known(4), kept.known(9)), (Some(failed.clone()), Some(failed)));
        assert_eq!(kept.known(2), None);
        kept.finish(3, Status::Answered, &[40.0]);
        assert_eq!(
            (kept.paused(), kept.known(3)),
            (0, Some(SavedPixel::Over(Outcome::flipped(40.0))))
        );
    }
}
