//! Python's own turn during long work: Ctrl-C and progress.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use pyo3::prelude::*;

/// Time between two turns.
const PERIOD: Duration = Duration::from_millis(50);

/// Gives Python a turn now and then, and remembers the exception that it raised.
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
    /// A clock that calls `progress(done, total)`, if there is one.
    pub(crate) fn new(progress: Option<Py<PyAny>>, total: u64) -> Self {
        let state = Mutex::new(State { last: Instant::now(), raised: None });
        Clock { progress, total, state }
    }

    /// Returns false once Python raised an exception. Call without the interpreter's lock.
    pub(crate) fn keep_going(&self, done: u64) -> bool {
        // Whoever finds another thread at it leaves it to that one.
        let Ok(mut state) = self.state.try_lock() else { return true };
        if state.raised.is_none() && state.last.elapsed() >= PERIOD {
            state.raised = Python::attach(|py| self.turn(py, done)).err();
            state.last = Instant::now();
        }
        state.raised.is_none()
    }

    /// Tells the end, and returns an exception that Python raised on the way.
    pub(crate) fn finish(self, py: Python<'_>) -> PyResult<()> {
        let state = self.state.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        match (state.raised, self.progress) {
            (Some(error), _) => Err(error),
            (None, Some(progress)) => progress.call1(py, (self.total, self.total)).map(drop),
            (None, None) => Ok(()),
        }
    }

    fn turn(&self, py: Python<'_>, done: u64) -> PyResult<()> {
        py.check_signals()?;
        match &self.progress {
            Some(progress) => progress.call1(py, (done, self.total)).map(drop),
            None => Ok(()),
        }
    }
}
