//! Refuses work in a process that was forked after its parent had used an engine.

use std::sync::atomic::{AtomicU32, Ordering};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// The process that first used an engine; 0 before.
static FIRST: AtomicU32 = AtomicU32::new(0);

/// Remembers the process that first uses an engine, and refuses one that was forked from it: the
/// threads of the engines and of the graphics driver are in the parent only, and a child would wait
/// for them for ever.
pub(crate) fn refuse_after_fork() -> PyResult<()> {
    let own = std::process::id();
    match FIRST.compare_exchange(0, own, Ordering::Relaxed, Ordering::Relaxed) {
        Err(first) if first != own => Err(PyRuntimeError::new_err(
            "flipmap was used before this process was forked, and its threads do not survive that: \
             use multiprocessing.get_context('spawn'), or call render in the workers only",
        )),
        _ => Ok(()),
    }
}
