//! Counts of what a device did for a run.

use serde::Serialize;

/// Counts of what a device did, since the engine was opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct GpuStats {
    /// Number of slices that have run.
    pub slices: u64,
    /// Number of submissions, several slices each.
    pub submissions: u64,
    /// Seconds that slices took, by the device's own clock where it has one.
    pub gpu_secs: f64,
    /// Seconds spent on compiling kernels.
    pub compile_secs: f64,
    /// Seconds that the host waited for the device.
    pub host_wait_secs: f64,
    /// Bytes written to the device.
    pub upload_bytes: u64,
    /// Bytes read back from the device.
    pub download_bytes: u64,
}
