//! `render`: the samples of a map.

use std::time::Instant;

use flipmap::{
    Channel, ChoiceError, Document, EngineError, EngineKind, EngineRequest, Renderer, RunSpec,
    RunTable, Samples,
};
use pyo3::exceptions::{PyMemoryError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyDict};

use crate::clock::Clock;
use crate::fork::refuse_after_fork;
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
    pub(crate) fn words(&self, size: [u32; 2]) -> RunTable {
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

    pub(crate) fn request(&self, spec: &RunSpec) -> PyResult<EngineRequest> {
        Ok(EngineRequest {
            kind: self.kind()?,
            adapter: self.adapter.clone(),
            threads: self.threads,
            setting: spec.setting,
            verify: spec.verify,
            ..EngineRequest::default()
        })
    }

    fn kind(&self) -> PyResult<Option<EngineKind>> {
        match self.engine.as_deref() {
            None => Ok(None),
            Some("cpu") => Ok(Some(EngineKind::Cpu)),
            Some("gpu") => Ok(Some(EngineKind::Gpu)),
            Some(other) => {
                Err(value_error(format!("`engine` is '{other}'; it must be cpu or gpu")))
            }
        }
    }
}

/// Renders a map. Returns a dictionary with the bytes of its `records`, by rows from the top, and
/// their `fields` (names and kinds); and `channels` (names and units), `seconds`, `engine` and
/// `scene`. Refuses a map that needs more than `room` bytes, and a
/// process that was forked after its parent had rendered one.
#[pyfunction]
pub(crate) fn render<'py>(
    py: Python<'py>,
    scene: Option<&str>,
    words: Vec<(String, String)>,
    size: [u32; 2],
    run: Run,
    room: Option<u64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (document, spec) = settled(scene, &words, size, &run)?;
    let channels = document.question.ask.kind().channels;
    let fields = fields(&document);
    check_room(size, record_bytes(&fields), room)?;
    let request = run.request(&spec)?.answering(&document.question);
    refuse_after_fork()?;

    let clock = Clock::new(progress, u64::from(size[0]) * u64::from(size[1]));
    let begun = Instant::now();
    let computed = py.detach(|| computed(&request, &document, size, &clock));
    let seconds = begun.elapsed().as_secs_f64();
    let (samples, engine) = computed?;
    clock.finish(py)?;
    let samples = samples.ok_or_else(|| PyRuntimeError::new_err("stopped"))?;

    let map = PyDict::new(py);
    map.set_item("channels", names(channels))?;
    map.set_item("records", records(py, &samples, &fields)?)?;
    map.set_item("fields", fields)?;
    map.set_item("seconds", seconds)?;
    map.set_item("engine", engine)?;
    map.set_item("scene", document.text())?;
    Ok(map)
}

/// Returns the scene as it is computed in `size` pixels, and the settings of its run.
pub(crate) fn settled(
    scene: Option<&str>,
    words: &[(String, String)],
    size: [u32; 2],
    run: &Run,
) -> PyResult<(Document, RunSpec)> {
    let mut document = document(scene, words)?;
    let spec = RunSpec::resolve(document.run.overlaid(run.words(size))).map_err(value_error)?;
    document.run = spec.table.clone();
    document.view = document.view.fitted(size.map(f64::from));
    Ok((document.settled(), spec))
}

/// Refuses a map that needs more memory than there is, or has more pixels than can be numbered.
fn check_room([width, height]: [u32; 2], record: usize, room: Option<u64>) -> PyResult<()> {
    let pixels = u64::from(width) * u64::from(height);
    // Samples, and the records made of them.
    let needed = pixels.saturating_mul(2 * record as u64);
    if let Some(room) = room.filter(|room| needed > *room) {
        return Err(PyMemoryError::new_err(format!(
            "`size` is {width}x{height}; the map needs {needed} bytes of memory, and {room} are \
             available"
        )));
    }
    if u32::try_from(pixels).is_err() {
        let most = u32::MAX;
        return Err(value_error(format!(
            "`size` is {width}x{height}; a map must have at most {most} pixels"
        )));
    }
    Ok(())
}

/// Returns the samples, or `None` if the clock stopped them, and what computed them.
fn computed(
    request: &EngineRequest,
    document: &Document,
    size: [u32; 2],
    clock: &Clock,
) -> PyResult<(Option<Samples>, String)> {
    let mut renderer = Renderer::new(request).map_err(choice_error)?;
    let about = about(&mut renderer);
    let samples = renderer.render_while(&document.scene(), size, clock).map_err(failed)?;
    Ok((samples, about))
}

/// Says what computes.
pub(crate) fn about(renderer: &mut Renderer) -> String {
    let (config, engine) = (renderer.config(), renderer.engine());
    format!(
        "{} ({}): {} in {}",
        engine.kind(),
        engine.adapter(),
        config.method.name(),
        config.precision
    )
}

fn names(channels: &[Channel]) -> Vec<(&'static str, &'static str)> {
    channels.iter().map(|channel| (channel.name, channel.unit)).collect()
}

/// A field of a record: its name, and its kind in NumPy's words.
type Field = (&'static str, &'static str);

/// Returns the fields of the records of a document's question: the channels, the status, the trust,
/// and the estimated error if flips are timed.
fn fields(document: &Document) -> Vec<Field> {
    let ask = document.question.ask;
    let channels = ask.kind().channels.iter().map(|channel| (channel.name, "f8"));
    let error = ask.times_flips().then_some(("error", "f4"));
    channels.chain([("status", "u1"), ("trust", "u1")]).chain(error).collect()
}

/// Number of bytes of a record with these fields, whose kinds end in their sizes.
fn record_bytes(fields: &[Field]) -> usize {
    let bytes = |kind: &str| usize::from(kind.as_bytes()[1] - b'0');
    fields.iter().map(|(_, kind)| bytes(kind)).sum()
}

/// Returns the records of the samples: the numbers that `flipmap render --raw` would write in these
/// fields.
fn records<'py>(
    py: Python<'py>,
    samples: &Samples,
    fields: &[Field],
) -> PyResult<Bound<'py, PyByteArray>> {
    let length = record_bytes(fields);
    PyByteArray::new_with(py, samples.len() * length, |bytes| {
        for (k, record) in bytes.chunks_exact_mut(length).enumerate() {
            let (values, rest) = record.split_at_mut(samples.channels() * size_of::<f64>());
            let places = values.chunks_exact_mut(size_of::<f64>());
            places.zip(samples.numbers(k)).for_each(|(place, number)| {
                place.copy_from_slice(&number.to_ne_bytes());
            });
            let (codes, error) = rest.split_at_mut(2);
            codes.copy_from_slice(&[samples.get(k).status as u8, samples.trust(k) as u8]);
            if !error.is_empty() {
                error.copy_from_slice(&samples.error_secs(k).to_ne_bytes());
            }
        }
        Ok(())
    })
}

pub(crate) fn choice_error(error: ChoiceError) -> PyErr {
    match error {
        ChoiceError::Engine(error) => failed(error),
        other => value_error(other),
    }
}

pub(crate) fn failed(error: EngineError) -> PyErr {
    match error {
        EngineError::Unsupported(why) => value_error(why),
        EngineError::Setting(error) => value_error(error),
        other => PyRuntimeError::new_err(other.to_string()),
    }
}
