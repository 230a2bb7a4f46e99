//! Ctrl-C and SIGTERM: asked for once, work stops at the next slice; twice, at once.

use std::sync::atomic::{AtomicBool, Ordering};

use super::exit::Exit;

static STOP: AtomicBool = AtomicBool::new(false);

/// From now on signals are remembered instead of ending the program.
pub fn listen() -> anyhow::Result<()> {
    ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    })?;
    Ok(())
}

/// An error once the user has asked to stop.
pub fn check() -> Result<(), Exit> {
    if STOP.load(Ordering::Relaxed) { Err(Exit::Interrupted) } else { Ok(()) }
}
