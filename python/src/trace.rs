//! `trace`: follows one pendulum with the gold standard in double-double.
use flipmap::{Trace, TraceError};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::clock::Clock;
use crate::scene::{document, value_error};

/// Traces one pendulum. Returns a dictionary: `columns` (names), `rows` (f64 bytes) and `passes`
/// (number of the bob, time in s, true if anticlockwise).
#[pyfunction]
pub(crate) fn trace<'py>(
    py: Python<'py>,
    start: &str,
    until: &str,
    every: &str,
    scene: Option<&str>,
    words: Vec<(String, String)>,
) -> PyResult<Bound<'py, PyDict>> {
    let scene = document(scene, &words)?.scene();
    let mut trace = Trace::from_text(&scene, start, until, every).map_err(value_error)?;
    let clock = Clock::new(None, 0);
    let rows = py.detach(|| rows(&mut trace, &clock));
    clock.finish(py)?;
    let rows = rows.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    let table = PyDict::new(py);
    table.set_item("columns", trace.columns())?;
    table.set_item("rows", PyBytes::new(py, &rows))?;
    let passes = trace.passes().iter().map(|pass| (pass.bob, pass.time.hi, pass.anticlockwise));
    table.set_item("passes", passes.collect::<Vec<_>>())?;
    Ok(table)
}

/// Returns the bytes of all rows.
fn rows(trace: &mut Trace, clock: &Clock) -> Result<Vec<u8>, TraceError> {
    let mut bytes = Vec::new();
    trace.follow(clock, &mut |row| {
        bytes.extend(row.iter().flat_map(|number| number.to_ne_bytes()));
        Ok(())
    })?;
    Ok(bytes)
}
