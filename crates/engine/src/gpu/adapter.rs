//! An adapter that wgpu finds, and the engines that are opened on it.

use super::device::{Gpu, adapters, describe, is_one_device, is_software};
use super::waiting::Waiting;
use super::{GpuEngine, selfcheck};
use crate::adapters::{AdapterFinding, GpuTuning};
use crate::background::on_its_own_thread;
use crate::choice::{Chosen, EngineRequest};
use crate::depth::Following;
use crate::level::{FAST_TO_COMPILE, FINEST};
use crate::{Engine, EngineError, IntegratorConfig, Precision};

/// A graphics adapter.
pub struct Adapter(wgpu::Adapter);

impl Adapter {
    /// Returns every adapter, best first: real devices before software.
    pub fn all() -> Vec<Adapter> {
        adapters().into_iter().map(Adapter).collect()
    }

    /// Returns true if there are kernels for the configuration on any adapter.
    pub(crate) fn has_kernels(config: &IntegratorConfig) -> bool {
        GpuEngine::has(config)
    }

    /// Returns the adapter's name with its kind and driver.
    pub fn name(&self) -> String {
        describe(&self.0)
    }

    /// Returns true if the adapter is a program on the processor.
    pub(crate) fn is_software(&self) -> bool {
        is_software(&self.0)
    }

    /// Returns true if both are one device, seen through two back-ends.
    pub(crate) fn is_one_device_with(&self, other: &Adapter) -> bool {
        is_one_device(&self.0.get_info(), &other.0.get_info())
    }

    /// Returns the adapter's features and limits, and the self-check's verdict on it.
    pub fn finding(&self) -> AdapterFinding {
        let verdict = open_checked(self.0.clone(), &FAST_TO_COMPILE)
            .map(|engine| engine.verdict().clone())
            .map_err(|error| error.to_string());
        let (features, limits) = (self.0.features(), self.0.limits());
        AdapterFinding {
            name: self.name(),
            has_f64: features.contains(wgpu::Features::SHADER_F64),
            has_subgroups: features.contains(wgpu::Features::SUBGROUP),
            has_timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
            max_buffer_bytes: limits.max_buffer_size,
            max_binding_bytes: limits.max_storage_buffer_binding_size,
            max_workgroups: limits.max_compute_workgroups_per_dimension,
            verdict,
        }
    }

    /// Opens an engine and checks its arithmetic, by single operations and by orbits in each of
    /// `configs`.
    pub fn open(
        &self,
        tuning: GpuTuning,
        configs: &[IntegratorConfig],
    ) -> Result<Box<dyn Engine>, EngineError> {
        let mut engine = open_checked(self.0.clone(), configs)?;
        engine.tune(tuning);
        Ok(Box::new(engine))
    }

    /// Opens an engine as a request wants it, with the first of `configs` that the adapter is trusted
    /// with; if it is trusted with none, returns the reasons.
    pub(crate) fn serve(
        &self,
        request: &EngineRequest,
        configs: Vec<IntegratorConfig>,
    ) -> Result<Result<Chosen, String>, EngineError> {
        let (mut engine, config) = match self.trusted(request, configs) {
            Ok(trusted) => trusted,
            Err(why) => return Ok(Err(why)),
        };
        if request.verifies() && engine.checks_by(&FINEST) {
            engine.check_orbits(&FINEST)?;
        }
        let why = format!("{} passed the self-check", engine.adapter());
        let engine = boxed(engine, request, config, &why)?;
        let following = Following::default();
        Ok(Ok(Chosen { engine, config, why, following, request: request.clone() }))
    }

    /// Opens an engine with the first configuration that it is trusted with.
    fn trusted(
        &self,
        request: &EngineRequest,
        configs: Vec<IntegratorConfig>,
    ) -> Result<(GpuEngine, IntegratorConfig), String> {
        let mut engine = open_checked(self.0.clone(), &[]).map_err(|error| error.to_string())?;
        engine.tune(request.tuning);
        let mut refusals = Vec::new();
        for config in configs {
            // Checks only the orbits that are needed: some kernels take long to compile.
            let checked = GpuEngine::require_ends(&config, request.ends)
                .and_then(|()| engine.require(&config))
                .and_then(|()| engine.check_orbits(&config));
            match checked.and_then(|()| engine.require(&config)) {
                Ok(()) => return Ok((engine, config)),
                Err(why) => refusals.push(why.to_string()),
            }
        }
        Err(refusals.join("; "))
    }
}

/// Moves an engine to a thread of its own if the request asks for one.
fn boxed(
    engine: GpuEngine,
    request: &EngineRequest,
    config: IntegratorConfig,
    why: &str,
) -> Result<Box<dyn Engine>, EngineError> {
    if !request.own_thread {
        return Ok(Box::new(engine));
    }
    let offered = engine.checks();
    let served = on_its_own_thread(engine, config, why, offered)
        .map_err(|error| EngineError::Unsupported(format!("cannot start a thread: {error}")))?;
    Ok(Box::new(served))
}

/// Opens an engine on an adapter and checks its arithmetic, by single operations and by orbits in
/// each of `configs`.
pub fn open_checked(
    adapter: wgpu::Adapter,
    configs: &[IntegratorConfig],
) -> Result<GpuEngine, EngineError> {
    let gpu = Gpu::open(adapter)?;
    let verdict = selfcheck::run(&gpu)?;
    let mut engine = GpuEngine::new(gpu, verdict);
    configs.iter().try_for_each(|config| engine.check_orbits(config))?;
    Ok(engine)
}

/// Returns an engine on an open device like [`open_checked`], where nothing may wait. Only the number
/// types in `precisions` are checked, by single operations; the others are not trusted. Before a
/// configuration is used, [`GpuEngine::check_orbits_by`] has to check its orbits.
pub async fn judged(
    gpu: Gpu,
    precisions: &[Precision],
    waiting: Waiting<'_>,
) -> Result<GpuEngine, EngineError> {
    let verdict = selfcheck::checked(&gpu, precisions, &|text| text, waiting).await?;
    Ok(GpuEngine::new(gpu, verdict))
}
