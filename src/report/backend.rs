//! The engines that are measured.

use super::{Refusal, ReportError, StopTest};
use crate::engine::choice::{ChoiceError, INSTALL_HINT, open_checked};
use crate::engine::cpu::CpuEngine;
use crate::engine::gpu::GpuEngine;
use crate::engine::gpu::device::{adapters, describe};
use crate::engine::{Engine, EngineError};

/// An engine that takes part.
pub enum Backend {
    /// The processor, on so many threads.
    Cpu(Box<CpuEngine>, usize),
    /// An adapter.
    Gpu(Box<GpuEngine>),
}

/// Which engines are wanted.
#[derive(Clone, Debug, Default)]
pub struct BackendFilter {
    /// Without the processor.
    pub only_gpu: bool,
    /// Without adapters.
    pub only_cpu: bool,
    /// Part of the names of the adapters wanted.
    pub adapter: Option<String>,
    /// Threads of the CPU engine.
    pub threads: Option<usize>,
}

impl Backend {
    /// As the engine that it is.
    pub fn engine(&mut self) -> &mut dyn Engine {
        match self {
            Backend::Cpu(engine, _) => engine.as_mut(),
            Backend::Gpu(engine) => engine.as_mut(),
        }
    }

    /// `cpu` or `gpu`.
    pub fn name(&self) -> &'static str {
        match self {
            Backend::Cpu(engine, _) => engine.name(),
            Backend::Gpu(engine) => engine.name(),
        }
    }

    /// The adapter, or the processor's threads and SIMD width.
    pub fn adapter(&self) -> String {
        match self {
            Backend::Cpu(engine, _) => engine.adapter(),
            Backend::Gpu(engine) => engine.adapter(),
        }
    }

    /// Threads of the processor that it computes on, if that is what computes.
    pub fn threads(&self) -> Option<usize> {
        match self {
            Backend::Cpu(_, threads) => Some(*threads),
            Backend::Gpu(_) => None,
        }
    }

    /// Its full name.
    pub fn full_name(&self) -> String {
        format!("{}: {}", self.name(), self.adapter())
    }

    /// See [`short_name`].
    pub fn short_name(&self) -> String {
        short_name(self.name(), &self.adapter())
    }
}

/// `cpu`, or `gpu` with the adapter's name but without its driver.
pub fn short_name(engine: &str, adapter: &str) -> String {
    match (engine, adapter.split_once(" (")) {
        ("gpu", Some((name, _))) => format!("gpu {name}"),
        _ => engine.to_string(),
    }
}

/// Starts every engine wanted that is here; those that do not start are refusals.
pub fn discover(
    field: &BackendFilter,
    stop: StopTest,
) -> Result<(Vec<Backend>, Vec<Refusal>), ReportError> {
    let (mut backends, mut refusals) = (Vec::new(), Vec::new());
    for adapter in fitting(field)? {
        if stop() {
            return Err(ReportError::Stopped);
        }
        match open_checked(adapter.clone()) {
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

/// The adapters that are wanted; to ask for one that is not there is an error.
fn fitting(field: &BackendFilter) -> Result<Vec<wgpu::Adapter>, ChoiceError> {
    if field.only_cpu {
        return Ok(Vec::new());
    }
    let found = adapters();
    if found.is_empty() && (field.only_gpu || field.adapter.is_some()) {
        return Err(ChoiceError::NoAdapter(format!("{INSTALL_HINT}; or use --engine cpu")));
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
