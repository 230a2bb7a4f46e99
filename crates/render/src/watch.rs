//! Progress and cancellation of long computations.

use flipmap_engine::trust::Opinion;

/// The watch over a long computation: takes its progress, and can stop it. A closure that takes
/// `done` and `total` is a watch, too.
pub trait Watch: Sync {
    /// Takes the progress, `done` of `total` samples or frames, at least every few hundredths of a
    /// second; returns false to stop.
    fn keep_going(&self, done: u64, total: u64) -> bool;

    /// Takes the result of integrating some pixels of a frame directly.
    fn hear(&self, _opinion: &Opinion) {}
}

impl<F: Fn(u64, u64) -> bool + Sync> Watch for F {
    fn keep_going(&self, done: u64, total: u64) -> bool {
        self(done, total)
    }
}
