//! Ctrl-C and SIGTERM: work stops at the next slice, and unfinished files are removed.

use std::sync::atomic::{AtomicBool, Ordering};

use super::exit::Exit;

static STOP: AtomicBool = AtomicBool::new(false);

/// From now on signals are remembered instead of ending the program.
pub fn listen() -> anyhow::Result<()> {
    ctrlc::set_handler(|| {
        STOP.store(true, Ordering::Relaxed);
    })?;
    Ok(())
}

/// Whether the user has asked to stop.
pub fn asked() -> bool {
    STOP.load(Ordering::Relaxed)
}

/// An error once the user has asked to stop.
pub fn check() -> Result<(), Exit> {
    if asked() { Err(Exit::Interrupted) } else { Ok(()) }
}
