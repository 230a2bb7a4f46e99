//! The engines that are measured.

use super::{Refusal, ReportError, StopTest};
use crate::engine::choice::open_checked;
use crate::engine::cpu::CpuEngine;
use crate::engine::gpu::GpuEngine;
use crate::engine::gpu::device::{adapters, describe};
use crate::engine::{Engine, EngineError};

/// An engine that takes part.
pub enum Contender {
    /// The processor, on so many threads.
    Cpu(Box<CpuEngine>, usize),
    /// An adapter.
    Gpu(Box<GpuEngine>),
}

/// Which engines are wanted.
#[derive(Clone, Debug, Default)]
pub struct Field {
    /// Without the processor.
    pub only_gpu: bool,
    /// Without adapters.
    pub only_cpu: bool,
    /// Part of the names of the adapters wanted.
    pub adapter: Option<String>,
    /// Threads of the CPU engine.
    pub threads: Option<usize>,
}

impl Contender {
    /// As the engine that it is.
    pub fn engine(&mut self) -> &mut dyn Engine {
        match self {
            Contender::Cpu(engine, _) => engine.as_mut(),
            Contender::Gpu(engine) => engine.as_mut(),
        }
    }

    /// `cpu` or `gpu`.
    pub fn name(&self) -> &'static str {
        match self {
            Contender::Cpu(engine, _) => engine.name(),
            Contender::Gpu(engine) => engine.name(),
        }
    }

    /// The adapter, or the processor's threads and SIMD width.
    pub fn adapter(&self) -> String {
        match self {
            Contender::Cpu(engine, _) => engine.adapter(),
            Contender::Gpu(engine) => engine.adapter(),
        }
    }

    /// Threads of the processor that it computes on, if that is what computes.
    pub fn threads(&self) -> Option<usize> {
        match self {
            Contender::Cpu(_, threads) => Some(*threads),
            Contender::Gpu(_) => None,
        }
    }

    /// `gpu (…)`.
    pub fn label(&self) -> String {
        format!("{} ({})", self.name(), self.adapter())
    }
}

/// Starts every engine wanted that is here; those that do not start are refusals.
pub fn muster(
    field: &Field,
    stop: StopTest,
) -> Result<(Vec<Contender>, Vec<Refusal>), ReportError> {
    let (mut contenders, mut refusals) = (Vec::new(), Vec::new());
    let wanted = field.adapter.as_ref().map(|name| name.to_lowercase());
    let fits = |adapter: &wgpu::Adapter| {
        let described = describe(adapter).to_lowercase();
        wanted.as_ref().is_none_or(|name| described.contains(name))
    };
    let found = if field.only_cpu { Vec::new() } else { adapters() };
    for adapter in found.into_iter().filter(fits) {
        if stop() {
            return Err(ReportError::Stopped);
        }
        match open_checked(adapter.clone()) {
            Ok(engine) => contenders.push(Contender::Gpu(Box::new(engine))),
            Err(error) => refusals.push(Refusal {
                engine: format!("gpu ({})", describe(&adapter)),
                what: "anything".to_string(),
                reason: error.to_string(),
            }),
        }
    }
    if !field.only_gpu {
        contenders.push(processor(field.threads)?);
    }
    Ok((contenders, refusals))
}

fn processor(threads: Option<usize>) -> Result<Contender, EngineError> {
    let engine = CpuEngine::new(threads)?;
    let threads = threads.unwrap_or_else(rayon::current_num_threads);
    Ok(Contender::Cpu(Box::new(engine), threads))
}
