//! `render`: the samples of a map.

use std::time::Instant;

use flipmap::{
    Channel, ChoiceError, EngineError, EngineKind, EngineRequest, PictureTable, Renderer, RunSpec,
    RunTable, Samples,
};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::clock::Clock;
use crate::scene::{document, value_error};

/// Run settings as Python gives them; `None` leaves a choice to the program.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Run {
    accuracy: Option<String>,
    method: Option<String>,
    step: Option<String>,
    tolerance: Option<String>,
    precision: Option<String>,
    verify: bool,
    engine: Option<String>,
    adapter: Option<String>,
    threads: Option<usize>,
}

impl Run {
    fn words(&self, size: [u32; 2]) -> RunTable {
        RunTable {
            size: Some(size),
            accuracy: self.accuracy.clone(),
            method: self.method.clone(),
            step: self.step.clone(),
            tolerance: self.tolerance.clone(),
            precision: self.precision.clone(),
            verify: self.verify,
        }
    }

    fn kind(&self) -> PyResult<Option<EngineKind>> {
        match self.engine.as_deref() {
            None => Ok(None),
            Some("cpu") => Ok(Some(EngineKind::Cpu)),
            Some("gpu") => Ok(Some(EngineKind::Gpu)),
            Some(other) => Err(value_error(format!("engine is '{other}'; it must be cpu or gpu"))),
        }
    }
}

/// Renders a map. Returns a dictionary with bytes: `values` (f64, the channels of each sample),
/// `statuses` and `trusts` (u8), by rows from the top; and `channels` (names and units), `seconds`,
/// `engine` and `scene`.
#[pyfunction]
pub(crate) fn render<'py>(
    py: Python<'py>,
    scene: Option<&str>,
    words: Vec<(String, String)>,
    size: [u32; 2],
    run: Run,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let mut document = document(scene, &words)?;
    if size.iter().any(|side| !(1..=PictureTable::MAX_SIDE).contains(side)) {
        let range = "each side must be between 1 and 1000000 pixels";
        return Err(value_error(format!("size is {}x{}; {range}", size[0], size[1])));
    }
    let spec = RunSpec::resolve(document.run.overlaid(run.words(size))).map_err(value_error)?;
    document.run = spec.table.clone();
    document.view = document.view.fitted(size.map(f64::from));
    let document = document.settled();
    let request = EngineRequest {
        kind: run.kind()?,
        adapter: run.adapter.clone(),
        threads: run.threads,
        setting: spec.setting,
        verify: spec.verify,
        ..EngineRequest::default()
    };
    let request = request.answering(&document.question);

    let clock = Clock::new(progress, u64::from(size[0]) * u64::from(size[1]));
    let begun = Instant::now();
    let rendered = py.detach(|| {
        let mut renderer = Renderer::new(&request).map_err(choice_error)?;
        let (config, engine) = (renderer.config(), renderer.engine());
        let about = format!(
            "{} ({}): {} in {}",
            engine.kind(),
            engine.adapter(),
            config.method.name(),
            config.precision
        );
        let rendered = renderer.render_while(&document.scene(), size, &clock);
        let samples = rendered.map_err(failed)?;
        Ok::<_, PyErr>((samples, about))
    });
    let seconds = begun.elapsed().as_secs_f64();
    let (samples, engine) = rendered?;
    clock.finish(py)?;
    let samples = samples.ok_or_else(|| PyRuntimeError::new_err("stopped"))?;
    let channels = document.question.ask.kind().channels;

    let map = PyDict::new(py);
    map.set_item("channels", names(channels))?;
    map.set_item("values", PyBytes::new(py, &values(&samples)))?;
    map.set_item("statuses", PyBytes::new(py, &codes(&samples, |k| samples.get(k).status as u8)))?;
    map.set_item("trusts", PyBytes::new(py, &codes(&samples, |k| samples.trust(k) as u8)))?;
    map.set_item("seconds", seconds)?;
    map.set_item("engine", engine)?;
    map.set_item("scene", document.text())?;
    Ok(map)
}

fn names(channels: &[Channel]) -> Vec<(&'static str, &'static str)> {
    channels.iter().map(|channel| (channel.name, channel.unit)).collect()
}

/// Returns the bytes of the numbers that `flipmap render --raw` would write.
fn values(samples: &Samples) -> Vec<u8> {
    (0..samples.len()).flat_map(|k| samples.numbers(k)).flat_map(f64::to_ne_bytes).collect()
}

fn codes(samples: &Samples, code: impl Fn(usize) -> u8) -> Vec<u8> {
    (0..samples.len()).map(code).collect()
}

fn choice_error(error: ChoiceError) -> PyErr {
    match error {
        ChoiceError::Engine(error) => failed(error),
        other => value_error(other),
    }
}

fn failed(error: EngineError) -> PyErr {
    match error {
        EngineError::Unsupported(why) => value_error(why),
        other => PyRuntimeError::new_err(other.to_string()),
    }
}
