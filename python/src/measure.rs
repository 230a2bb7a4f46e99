//! `measure`: numbers about a scene, with intervals.

use std::path::PathBuf;

use flipmap::{EngineRequest, Renderer, RunSpec};
use flipmap_measure::{MeasureError, Statistic, Survey, SurveyFolder, SurveyOrder};
use pyo3::exceptions::{PyOSError, PyRuntimeError};
use pyo3::prelude::*;

use crate::clock::Clock;
use crate::fork::refuse_after_fork;
use crate::map::{Run, choice_error, failed};
use crate::scene::{document, value_error};

/// What is to be measured, as Python gives it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Order {
    of: Vec<String>,
    samples: u32,
    seed: u64,
    apart: Option<f64>,
    folder: Option<PathBuf>,
}

/// Measures a scene. Returns the findings as JSON.
#[pyfunction]
pub(crate) fn measure(
    py: Python<'_>,
    scene: Option<&str>,
    words: Vec<(String, String)>,
    order: Order,
    run: Run,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let document = document(scene, &words)?.settled();
    let spec = RunSpec::resolve(run.words(RunSpec::DEFAULT_SIZE)).map_err(value_error)?;
    let request = run.request(&spec)?.answering(&document.question);
    let mut survey = survey(SurveyOrder::of(document.scene()), &order)?;
    refuse_after_fork()?;
    let clock = Clock::new(progress, survey.extent()[1]);
    let done = py.detach(|| measured(&mut survey, &request, &clock));
    clock.finish(py)?;
    done?;
    let findings = survey.findings();
    survey.write().map_err(measure_error)?;
    serde_json::to_string(&findings).map_err(|error| PyRuntimeError::new_err(error.to_string()))
}

fn survey(whole: SurveyOrder, order: &Order) -> PyResult<Survey> {
    let refusal = |(name, why)| value_error(format!("`of` has '{name}'; {why}"));
    let of = Statistic::named(&order.of).map_err(refusal)?;
    let (samples, most) = (order.samples, SurveyOrder::SAMPLES);
    if !most.contains(&samples) {
        let (least, most) = (most.start(), most.end());
        let why = format!("`samples` is {samples}; it must be {least} to {most}");
        return Err(value_error(why));
    }
    let of = if of.is_empty() { whole.of.clone() } else { of };
    let (seed, apart_secs) = (order.seed, order.apart);
    let complete = SurveyOrder { of, samples, seed, apart_secs, ..whole };
    match &order.folder {
        None => Survey::new(complete),
        Some(path) => {
            SurveyFolder::create(path).and_then(|folder| Survey::within(complete, folder))
        }
    }
    .map_err(measure_error)
}

fn measured(survey: &mut Survey, request: &EngineRequest, clock: &Clock) -> PyResult<()> {
    let mut renderer = Renderer::new(request).map_err(choice_error)?;
    match survey.run(&mut renderer, clock) {
        // The clock says why.
        Err(MeasureError::Stopped) => Ok(()),
        done => done.map_err(measure_error),
    }
}

fn measure_error(error: MeasureError) -> PyErr {
    match error {
        MeasureError::Engine(error) => failed(error),
        MeasureError::Setting(_) => value_error(error),
        MeasureError::Write { .. } => PyOSError::new_err(error.to_string()),
        MeasureError::Estimate { .. } | MeasureError::Stopped | MeasureError::Page(_) => {
            PyRuntimeError::new_err(error.to_string())
        }
    }
}
