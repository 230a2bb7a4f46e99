//! The adapters of a build without the feature `gpu`: none.

use super::{AdapterFinding, GpuTuning};
use crate::choice::{Chosen, EngineRequest};
use crate::{Engine, EngineError, IntegratorConfig};

/// A graphics adapter, of which this build has none.
pub enum Adapter {}

impl Adapter {
    /// Returns an empty list.
    pub fn all() -> Vec<Adapter> {
        Vec::new()
    }

    /// Returns false: no adapter has kernels for any configuration.
    pub(crate) fn has_kernels(_: &IntegratorConfig) -> bool {
        false
    }

    /// Returns the adapter's name.
    pub fn name(&self) -> String {
        match *self {}
    }

    pub(crate) fn is_software(&self) -> bool {
        match *self {}
    }

    pub(crate) fn is_one_device_with(&self, _: &Adapter) -> bool {
        match *self {}
    }

    /// Returns the adapter's features, limits and verdict.
    pub fn finding(&self) -> AdapterFinding {
        match *self {}
    }

    /// Opens an engine on the adapter.
    pub fn open(
        &self,
        _: GpuTuning,
        _: &[IntegratorConfig],
    ) -> Result<Box<dyn Engine>, EngineError> {
        match *self {}
    }

    pub(crate) fn serve(
        &self,
        _: &EngineRequest,
        _: Vec<IntegratorConfig>,
    ) -> Result<Result<Chosen, String>, EngineError> {
        match *self {}
    }
}
