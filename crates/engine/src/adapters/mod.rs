//! Graphics adapters as the rest of the program sees them: their names, what their arithmetic is
//! trusted with, and engines on them.
//!
//! With the feature `gpu`, an [`Adapter`] is one that wgpu finds. Without it there are none, and the
//! processor computes everything; nothing else in the program differs.

mod pairs;
mod stats;
mod tuning;
mod verdict;

#[cfg(not(feature = "gpu"))]
mod absent;
#[cfg(not(feature = "gpu"))]
pub use absent::Adapter;

pub use pairs::Pairs;
pub(crate) use stats::GpuStats;
pub use tuning::GpuTuning;
#[cfg(feature = "gpu")]
pub(crate) use tuning::MAX_SLICES;
#[cfg(feature = "gpu")]
pub(crate) use verdict::BY_SERIES;
pub use verdict::{Check, Verdict};

use flipmap_scene::SceneError;

use crate::choice::ChoiceError;
#[cfg(feature = "gpu")]
pub use crate::gpu::Adapter;

/// Advice for a machine or a build without adapters.
pub const INSTALL_HINT: &str = if cfg!(feature = "gpu") {
    "no Vulkan adapter was found; on Debian or Ubuntu install one with: \
     apt-get install libvulkan1 mesa-vulkan-drivers"
} else {
    "this flipmap computes on the processor alone: it was built without the feature for graphics adapters"
};

/// An adapter's features and limits, and the verdict of the self-check on it.
pub struct AdapterFinding {
    /// The adapter's name with its kind and driver.
    pub name: String,
    /// True if shaders can compute in f64.
    pub has_f64: bool,
    /// True if invocations of a subgroup can exchange values.
    pub has_subgroups: bool,
    /// True if the device's own clock can time submissions.
    pub has_timestamps: bool,
    /// Largest size of a buffer in bytes.
    pub max_buffer_bytes: u64,
    /// Largest part of a buffer that a kernel can see, in bytes.
    pub max_binding_bytes: u64,
    /// Largest number of workgroups along one side of a dispatch.
    pub max_workgroups: u32,
    /// The verdict on the adapter's arithmetic, or why the adapter cannot be used.
    pub verdict: Result<Verdict, String>,
}

/// Returns the adapters whose names contain `wanted` in any case; all for `None`. A name that matches
/// none of several adapters is an error.
pub fn matching(wanted: Option<&str>) -> Result<Vec<Adapter>, ChoiceError> {
    let all = Adapter::all();
    let Some(wanted) = wanted.filter(|_| !all.is_empty()) else { return Ok(all) };
    let fits = |adapter: &Adapter| adapter.name().to_lowercase().contains(&wanted.to_lowercase());
    let (fitting, others): (Vec<_>, Vec<_>) = all.into_iter().partition(fits);
    if fitting.is_empty() {
        let found = others.iter().map(Adapter::name).collect::<Vec<_>>().join(", ");
        let allowed = format!("it matches none of: {found}");
        let error = SceneError::new("adapter", format!("'{wanted}'"), allowed);
        return Err(ChoiceError::UnknownAdapter(error));
    }
    Ok(fitting)
}
