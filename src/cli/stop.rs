//! Ctrl-C and SIGTERM: work stops at the next slice, unfinished files are removed, windows close.
//!
//! Commands listen as soon as there is something to stop or to remove. Until then, while engines
//! are measured and films are planned, a signal ends the program at once.

use std::sync::atomic::{AtomicBool, Ordering};

use flipmap_render::output::stop_writing_when;

static STOP: AtomicBool = AtomicBool::new(false);

/// Installs a handler that remembers signals instead of letting them end the program.
pub(super) fn listen() -> anyhow::Result<()> {
    listen_and(|| ())
}

/// Installs the same handler, which also calls `wake` so that a sleeping thread notices.
pub(super) fn listen_and(wake: impl Fn() + Send + 'static) -> anyhow::Result<()> {
    stop_writing_when(asked);
    ctrlc::set_handler(move || {
        STOP.store(true, Ordering::Relaxed);
        wake();
    })?;
    Ok(())
}

/// Returns true if the user has asked to stop.
pub(super) fn asked() -> bool {
    STOP.load(Ordering::Relaxed)
}
