//! The engines that a report measures.

use super::{Refusal, ReportError, StopTest};
use flipmap_engine::choice::{ChoiceError, INSTALL_HINT, open_checked};
use flipmap_engine::cpu::CpuEngine;
use flipmap_engine::gpu::GpuEngine;
use flipmap_engine::gpu::device::{adapters, describe};
use flipmap_engine::level::FAST_TO_COMPILE;
use flipmap_engine::{Engine, EngineError, EngineKind};

/// An engine that a report measures.
pub enum Backend {
    /// The processor, with its number of threads.
    Cpu(Box<CpuEngine>, usize),
    /// A graphics adapter.
    Gpu(Box<GpuEngine>),
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
    /// Returns the backend as an engine.
    pub(crate) fn engine(&mut self) -> &mut dyn Engine {
        match self {
            Backend::Cpu(engine, _) => engine.as_mut(),
            Backend::Gpu(engine) => engine.as_mut(),
        }
    }

    /// The kind of engine.
    pub(crate) fn kind(&self) -> EngineKind {
        match self {
            Backend::Cpu(..) => EngineKind::Cpu,
            Backend::Gpu(_) => EngineKind::Gpu,
        }
    }

    /// The adapter, or the processor's threads and SIMD width.
    pub(crate) fn adapter(&self) -> String {
        match self {
            Backend::Cpu(engine, _) => engine.adapter(),
            Backend::Gpu(engine) => engine.adapter(),
        }
    }

    /// Number of threads if the processor computes, `None` for an adapter.
    pub(crate) fn threads(&self) -> Option<usize> {
        match self {
            Backend::Cpu(_, threads) => Some(*threads),
            Backend::Gpu(_) => None,
        }
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
        match open_checked(adapter.clone(), &FAST_TO_COMPILE) {
            Ok(engine) => backends.push(Backend::Gpu(Box::new(engine))),
            Err(error) => refusals.push(Refusal {
                engine: format!("gpu: {}", describe(&adapter)),
                what: "anything".to_string(),
                reason: error.to_string(),
            }),
        }
    }
    if !field.only_gpu {
        backends.push(processor(field.threads)?);
    }
    if backends.is_empty() {
        let reasons: Vec<&str> = refusals.iter().map(|refusal| refusal.reason.as_str()).collect();
        return Err(ChoiceError::NoAdapter(reasons.join("; ")).into());
    }
    Ok((backends, refusals))
}

/// Returns the requested adapters; requesting one that is not present is an error.
fn fitting(field: &BackendFilter) -> Result<Vec<wgpu::Adapter>, ChoiceError> {
    if field.only_cpu {
        return Ok(Vec::new());
    }
    let found = adapters();
    if found.is_empty() && (field.only_gpu || field.adapter.is_some()) {
        return Err(ChoiceError::NoAdapter(format!("{INSTALL_HINT}; or use `engine` cpu")));
    }
    let Some(wanted) = &field.adapter else { return Ok(found) };
    let fits =
        |adapter: &wgpu::Adapter| describe(adapter).to_lowercase().contains(&wanted.to_lowercase());
    let (fitting, others): (Vec<_>, Vec<_>) = found.into_iter().partition(fits);
    if fitting.is_empty() {
        let found = others.iter().map(describe).collect::<Vec<_>>().join(", ");
        return Err(ChoiceError::UnknownAdapter { wanted: wanted.clone(), found });
    }
    Ok(fitting)
}

fn processor(threads: Option<usize>) -> Result<Backend, EngineError> {
    let engine = CpuEngine::new(threads)?;
    let threads = threads.unwrap_or_else(rayon::current_num_threads);
    Ok(Backend::Cpu(Box::new(engine), threads))
}
