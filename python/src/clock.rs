//! Lets Python handle Ctrl-C and progress during long work.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use flipmap::Watch;
use pyo3::prelude::*;

/// Time between two turns.
const PERIOD: Duration = Duration::from_millis(50);

/// A clock that gives Python a turn now and then, and keeps the exception that Python raises.
pub(crate) struct Clock {
    progress: Option<Py<PyAny>>,
    total: u64,
    state: Mutex<State>,
}

struct State {
    last: Instant,
    raised: Option<PyErr>,
}

impl Clock {
    /// Makes a clock that calls `progress(done, total)`, if given.
    pub(crate) fn new(progress: Option<Py<PyAny>>, total: u64) -> Self {
        let state = Mutex::new(State { last: Instant::now(), raised: None });
        Clock { progress, total, state }
    }

    /// Returns the exception that Python raised during the work.
    pub(crate) fn into_raised(self) -> Option<PyErr> {
        self.state.into_inner().unwrap_or_else(PoisonError::into_inner).raised
    }

    /// Reports the end of the work, or returns the exception that Python raised during it.
    pub(crate) fn finish(self, py: Python<'_>) -> PyResult<()> {
        let state = self.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        match (state.raised, self.progress) {
            (Some(error), _) => Err(error),
            (None, Some(progress)) => progress.call1(py, (self.total, self.total)).map(drop),
            (None, None) => Ok(()),
        }
    }

    fn turn(&self, py: Python<'_>, [done, total]: [u64; 2]) -> PyResult<()> {
        py.check_signals()?;
        match &self.progress {
            Some(progress) => progress.call1(py, (done, total)).map(drop),
            None => Ok(()),
        }
    }
}

/// Gives Python its turn and stops once it raised an exception. Call without the interpreter's lock.
impl Watch for Clock {
    fn keep_going(&self, done: u64, total: u64) -> bool {
        // If another thread holds the lock, that thread gives Python its turn.
        let Ok(mut state) = self.state.try_lock() else { return true };
        if state.raised.is_none() && state.last.elapsed() >= PERIOD {
            state.raised = Python::attach(|py| self.turn(py, [done, total])).err();
            state.last = Instant::now();
        }
        state.raised.is_none()
    }
}
