//! The watch of the command line over long work: shows progress as the user asked, and stops on
//! signals.

use std::sync::{Mutex, PoisonError};

use flipmap_engine::depth::Following;
use flipmap_engine::trust::Opinion;
use flipmap_render::Watch;

use super::progress::{Mode, Progress};
use super::stop;

/// A display of progress, which begins with the work.
pub(super) struct CommandLine {
    mode: Mode,
    unit: &'static str,
    following: Option<Following>,
    progress: Mutex<Option<Progress>>,
}

impl CommandLine {
    /// Shows work that is counted in `unit`, with the words of a deep zoom's `following`.
    pub(super) fn new(mode: Mode, unit: &'static str, following: Option<Following>) -> Self {
        CommandLine { mode, unit, following, progress: Mutex::default() }
    }
}

impl Watch for CommandLine {
    fn keep_going(&self, done: u64, total: u64) -> bool {
        // The lock guards only a display, which is still usable if a thread panicked.
        let mut progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        let progress = progress.get_or_insert_with(|| Progress::new(self.mode, total, self.unit));
        progress.set(done, self.following.as_ref().and_then(Following::words));
        !stop::asked()
    }

    fn hear(&self, opinion: &Opinion) {
        if let Some(warning) = opinion.warning() {
            super::tell(&format!("flipmap: {warning}"));
        }
    }
}
