//! `trace`: follows one pendulum with the gold standard in double-double.
use flipmap::{Advance, Dd, Scalar, Trace, launch_from_text};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::clock::Clock;
use crate::scene::{document, value_error};

/// Maximum number of rows in a table.
const MAX_ROWS: f64 = 1e8;

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
    let launch = launch_from_text(start).ok_or_else(|| {
        value_error(format!(
            "start is '{start}'; it must be two angles between -1e6 and 1e6 rad, or these and two \
             speeds between -1e6 and 1e6 rad/s"
        ))
    })?;
    let (until, every) = (seconds("until", until)?, seconds("every", every)?);
    let count = (until / every).hi;
    if count > MAX_ROWS {
        let text =
            format!("every {every} s gives {count:.0e} rows in {until} s; at most 1e8 are allowed");
        return Err(value_error(text));
    }
    let mut trace = Trace::new(&scene, launch, [until, every]);
    let clock = Clock::new(None, 0);
    let rows = py.detach(|| rows(&mut trace, &clock));
    clock.finish(py)?;
    let table = PyDict::new(py);
    table.set_item("columns", trace.columns())?;
    table.set_item("rows", PyBytes::new(py, &rows?))?;
    let passes = trace.passes().iter().map(|pass| (pass.bob, pass.time.hi, pass.anticlockwise));
    table.set_item("passes", passes.collect::<Vec<_>>())?;
    Ok(table)
}

/// Returns the bytes of all rows, or of the rows before the clock stopped the work.
fn rows(trace: &mut Trace, clock: &Clock) -> PyResult<Vec<u8>> {
    let mut bytes = Vec::new();
    while clock.keep_going(0) {
        match trace.advance().map_err(|error| PyRuntimeError::new_err(error.to_string()))? {
            Advance::Row(row) => bytes.extend(row.iter().flat_map(|number| number.to_ne_bytes())),
            Advance::Step => {}
            Advance::End => break,
        }
    }
    Ok(bytes)
}

fn seconds(name: &str, text: &str) -> PyResult<Dd> {
    Dd::parse(text).filter(|time| (1e-9..=1e6).contains(&time.hi)).ok_or_else(|| {
        value_error(format!(
            "{name} is '{text}'; it must be a number of seconds between 1e-9 and 1e6"
        ))
    })
}
