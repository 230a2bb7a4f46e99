//! The engines that a report measures.

use super::{Refusal, ReportError, StopTest};
use flipmap_engine::adapters::{self, Adapter, INSTALL_HINT};
use flipmap_engine::choice::ChoiceError;
use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::level::FAST_TO_COMPILE;
use flipmap_engine::{Engine, EngineError, EngineKind, GpuTuning};

/// An engine that a report measures.
pub struct Backend {
    engine: Box<dyn Engine>,
    device: Device,
}

/// The hardware of an engine.
enum Device {
    /// The processor, with its number of threads.
    Processor(usize),
    /// A graphics adapter.
    Adapter(Adapter),
}

/// Selection of the engines to measure.
#[derive(Clone, Debug, Default)]
pub struct BackendFilter {
    /// True to leave out the processor.
    pub only_gpu: bool,
    /// True to leave out the adapters.
    pub only_cpu: bool,
    /// Case-insensitive part of the requested adapters' names.
    pub adapter: Option<String>,
    /// Threads of the CPU engine.
    pub threads: Option<usize>,
}

impl Backend {
    /// Starts the processor's engine; `None` for as many threads as it has.
    pub(crate) fn processor(threads: Option<usize>) -> Result<Self, EngineError> {
        let engine = Box::new(CpuEngine::new(threads)?);
        let threads = threads.unwrap_or_else(rayon::current_num_threads);
        Ok(Backend { engine, device: Device::Processor(threads) })
    }

    /// Returns the backend as an engine.
    pub(crate) fn engine(&mut self) -> &mut dyn Engine {
        self.engine.as_mut()
    }

    /// The kind of engine.
    pub(crate) fn kind(&self) -> EngineKind {
        self.engine.kind()
    }

    /// The adapter, or the processor's threads and SIMD width.
    pub(crate) fn adapter(&self) -> String {
        self.engine.adapter()
    }

    /// Number of threads if the processor computes, `None` for an adapter.
    pub(crate) fn threads(&self) -> Option<usize> {
        match self.device {
            Device::Processor(threads) => Some(threads),
            Device::Adapter(_) => None,
        }
    }

    /// Opens a second engine on the adapter, whose kernels read their scene as data; `None` for the
    /// processor.
    pub(crate) fn general(&self) -> Result<Option<Box<dyn Engine>>, EngineError> {
        let Device::Adapter(adapter) = &self.device else { return Ok(None) };
        let tuning = GpuTuning { general: true, ..GpuTuning::default() };
        adapter.open(tuning, &[]).map(Some)
    }

    /// The engine's full name: `cpu` or `gpu`, and the adapter.
    pub(crate) fn full_name(&self) -> String {
        format!("{}: {}", self.kind(), self.adapter())
    }

    /// The engine's short name, by [`short_name`].
    pub(crate) fn short_name(&self) -> String {
        short_name(self.kind(), &self.adapter())
    }
}

/// `cpu`, or `gpu` with the adapter's name but without its driver.
pub(crate) fn short_name(engine: EngineKind, adapter: &str) -> String {
    match (engine, adapter.split_once(" (")) {
        (EngineKind::Gpu, Some((name, _))) => format!("gpu {name}"),
        _ => engine.to_string(),
    }
}

/// Starts every requested engine of this machine; adapters that do not start become refusals.
pub(crate) fn discover(
    field: &BackendFilter,
    stop: StopTest,
) -> Result<(Vec<Backend>, Vec<Refusal>), ReportError> {
    let (mut backends, mut refusals) = (Vec::new(), Vec::new());
    for adapter in fitting(field)? {
        if stop() {
            return Err(ReportError::Stopped);
        }
        match adapter.open(GpuTuning::default(), &FAST_TO_COMPILE) {
            Ok(engine) => backends.push(Backend { engine, device: Device::Adapter(adapter) }),
            Err(error) => refusals.push(Refusal {
                engine: format!("gpu: {}", adapter.name()),
                what: "anything".to_string(),
                reason: error.to_string(),
            }),
        }
    }
    if !field.only_gpu {
        backends.push(Backend::processor(field.threads)?);
    }
    if backends.is_empty() {
        let reasons: Vec<&str> = refusals.iter().map(|refusal| refusal.reason.as_str()).collect();
        return Err(ChoiceError::NoAdapter(reasons.join("; ")).into());
    }
    Ok((backends, refusals))
}

/// Returns the requested adapters; requesting one that is not present is an error.
fn fitting(field: &BackendFilter) -> Result<Vec<Adapter>, ChoiceError> {
    if field.only_cpu {
        return Ok(Vec::new());
    }
    let found = adapters::matching(field.adapter.as_deref())?;
    if found.is_empty() && (field.only_gpu || field.adapter.is_some()) {
        return Err(ChoiceError::NoAdapter(format!("{INSTALL_HINT}; or use the cpu engine")));
    }
    Ok(found)
}
