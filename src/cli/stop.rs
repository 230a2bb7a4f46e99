//! Ctrl-C and SIGTERM: work stops at the next slice, unfinished files are removed, windows close.

use std::sync::atomic::{AtomicBool, Ordering};

use super::exit::Exit;

static STOP: AtomicBool = AtomicBool::new(false);

/// From now on signals are remembered instead of ending the program.
pub fn listen() -> anyhow::Result<()> {
    listen_and(|| ())
}

/// Likewise, and whoever sleeps is woken.
pub fn listen_and(wake: impl Fn() + Send + 'static) -> anyhow::Result<()> {
    ctrlc::set_handler(move || {
        STOP.store(true, Ordering::Relaxed);
        wake();
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
