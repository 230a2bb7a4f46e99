//! Graphics devices: which adapters there are, how one is opened, and what it reports.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use super::waiting::now;
use crate::EngineError;

/// An open device and the adapter it came from. Lives as long as the process, or until lost.
#[derive(Clone)]
pub struct Gpu {
    /// The adapter, to open the device again.
    pub adapter: wgpu::Adapter,
    /// The open device.
    pub device: wgpu::Device,
    /// The only queue of the device.
    pub queue: wgpu::Queue,
    lost: Arc<AtomicBool>,
    complaint: Arc<Mutex<Option<String>>>,
    /// Bytes written to the device and read back, including those of devices that it has replaced.
    traffic: Arc<[AtomicU64; 2]>,
}

/// Every adapter of the backends compiled in, best first: real devices before software.
pub fn adapters() -> Vec<wgpu::Adapter> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::PRIMARY;
    let instance = wgpu::Instance::new(descriptor);
    let mut adapters =
        now(instance.enumerate_adapters(wgpu::Backends::PRIMARY)).unwrap_or_default();
    adapters.sort_by_key(|adapter| rank(&adapter.get_info()));
    adapters
}

/// Place of an adapter among others: by its type, and by the back-end through which it is seen.
fn rank(info: &wgpu::AdapterInfo) -> [u8; 2] {
    let by_type = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    };
    [by_type, u8::from(info.backend != wgpu::Backend::Vulkan)]
}

/// Returns true if two adapters are one device, seen through two back-ends. Not every back-end
/// reports where on the bus a device is.
pub(crate) fn is_one_device(one: &wgpu::AdapterInfo, other: &wgpu::AdapterInfo) -> bool {
    let [one_bus, other_bus] = [one, other].map(|info| info.device_pci_bus_id.as_str());
    one.backend != other.backend
        && (one.vendor, one.device) == (other.vendor, other.device)
        && one.device_type == other.device_type
        && (one_bus == other_bus || one_bus.is_empty() || other_bus.is_empty())
}

/// The adapter's name with its kind and driver.
pub fn describe(adapter: &wgpu::Adapter) -> String {
    let info = adapter.get_info();
    let driver = [info.driver.as_str(), info.driver_info.as_str()]
        .into_iter()
        .filter(|text| !text.is_empty())
        .collect::<Vec<_>>()
        .join(" ");
    format!("{} ({:?}, {:?}, {driver})", info.name, info.device_type, info.backend)
}

/// Returns true if the adapter is a program on the processor.
pub fn is_software(adapter: &wgpu::Adapter) -> bool {
    adapter.get_info().device_type == wgpu::DeviceType::Cpu
}

impl Gpu {
    /// Opens a device with f64 where the adapter has it and with the adapter's own limits.
    pub fn open(adapter: wgpu::Adapter) -> Result<Self, EngineError> {
        let opened = now(Gpu::opening(adapter));
        opened.unwrap_or_else(|| {
            Err(EngineError::DeviceLost("it can only be opened by a new start".to_string()))
        })
    }

    /// Opens a device like [`Gpu::open`], where nothing may wait.
    pub async fn opening(adapter: wgpu::Adapter) -> Result<Self, EngineError> {
        let wanted =
            wgpu::Features::SHADER_F64 | wgpu::Features::SUBGROUP | wgpu::Features::TIMESTAMP_QUERY;
        let own = adapter.limits();
        let limits = wgpu::Limits {
            max_buffer_size: own.max_buffer_size,
            max_storage_buffer_binding_size: own.max_storage_buffer_binding_size,
            ..wgpu::Limits::default()
        };
        let opened = adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("flipmap"),
            required_features: adapter.features() & wanted,
            required_limits: limits.or_worse_values_from(&own),
            ..Default::default()
        });
        let (device, queue) =
            opened.await.map_err(|error| EngineError::DeviceLost(error.to_string()))?;
        let lost = Arc::new(AtomicBool::new(false));
        let complaint = Arc::new(Mutex::new(None));
        device.set_device_lost_callback({
            let lost = lost.clone();
            move |_, why| {
                log::warn!("the graphics device is gone: {why}");
                lost.store(true, Ordering::Release);
            }
        });
        device.on_uncaptured_error(Arc::new({
            let complaint = complaint.clone();
            move |error: wgpu::Error| {
                let mut first = complaint.lock().expect("no panic while held");
                first.get_or_insert_with(|| error.to_string());
            }
        }));
        Ok(Gpu { adapter, device, queue, lost, complaint, traffic: Arc::default() })
    }

    /// Opens a fresh device on the same adapter.
    pub(crate) fn reopen(&self) -> Result<Self, EngineError> {
        Ok(Gpu { traffic: self.traffic.clone(), ..Gpu::open(self.adapter.clone())? })
    }

    /// Writes `bytes` to a buffer from `offset` on.
    pub(crate) fn write(&self, buffer: &wgpu::Buffer, offset: u64, bytes: &[u8]) {
        self.traffic[0].fetch_add(bytes.len() as u64, Ordering::Relaxed);
        self.queue.write_buffer(buffer, offset, bytes);
    }

    /// Counts bytes that are read back.
    pub(crate) fn count_download(&self, bytes: u64) {
        self.traffic[1].fetch_add(bytes, Ordering::Relaxed);
    }

    /// Bytes written to the device and bytes read back.
    pub(crate) fn traffic(&self) -> [u64; 2] {
        [0, 1].map(|way| self.traffic[way].load(Ordering::Relaxed))
    }

    /// Returns the seconds per tick of the device's clock, or `None` if it cannot time submissions.
    pub(crate) fn tick_secs(&self) -> Option<f64> {
        let has = self.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        has.then(|| f64::from(self.queue.get_timestamp_period()) * 1e-9)
    }

    /// Marks the device as lost.
    pub(crate) fn give_up(&self) {
        self.lost.store(true, Ordering::Release);
    }

    /// Returns true if the device can do nothing more.
    pub fn is_lost(&self) -> bool {
        self.lost.load(Ordering::Acquire)
    }

    /// Returns the first error of the driver or wgpu since the last call, unless the device is
    /// lost, which explains everything.
    pub fn check(&self) -> Result<(), EngineError> {
        let complaint = self.complaint.lock().expect("no panic while held").take();
        match complaint {
            Some(what) if !self.is_lost() => Err(EngineError::Driver(what)),
            _ => Ok(()),
        }
    }

    /// Returns true if the device has f64 at all; the self-check decides whether its f64 arithmetic
    /// is right.
    pub fn has_f64(&self) -> bool {
        self.device.features().contains(wgpu::Features::SHADER_F64)
    }

    /// Returns true if invocations of a subgroup can exchange values.
    pub(crate) fn has_subgroups(&self) -> bool {
        self.device.features().contains(wgpu::Features::SUBGROUP)
    }

    /// Creates a buffer of `bytes`; returns an error if it is too large or memory has run out.
    pub fn buffer(
        &self,
        label: &'static str,
        bytes: u64,
        usage: wgpu::BufferUsages,
    ) -> Result<wgpu::Buffer, EngineError> {
        let limits = self.device.limits();
        let storage = usage.contains(wgpu::BufferUsages::STORAGE);
        let binding = limits.max_storage_buffer_binding_size;
        let allowed =
            if storage { binding.min(limits.max_buffer_size) } else { limits.max_buffer_size };
        if bytes > allowed {
            return Err(EngineError::LimitExceeded { what: label, needed: bytes, allowed });
        }
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.max(32),
            usage,
            mapped_at_creation: false,
        });
        // Where nothing may wait, a missing buffer is reported with what is then done with it.
        match now(scope.pop()).flatten() {
            Some(_) => Err(EngineError::OutOfMemory { mib: bytes.div_ceil(1 << 20) }),
            None => Ok(buffer),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn info(backend: wgpu::Backend, bus: &str) -> wgpu::AdapterInfo {
        let mut info = wgpu::AdapterInfo::new(wgpu::DeviceType::DiscreteGpu, backend);
        (info.vendor, info.device) = (0x10de, 0x2684);
        info.device_pci_bus_id = bus.to_string();
        info
    }

    #[test]
    fn a_card_behind_two_back_ends_is_one_and_two_alike_are_two() {
        let [first, second] = ["0000:01:00.0", "0000:02:00.0"]
            .map(|bus| (info(wgpu::Backend::Vulkan, bus), info(wgpu::Backend::Dx12, bus)));
        assert!(is_one_device(&first.0, &first.1));
        assert!(!is_one_device(&first.0, &second.0) && !is_one_device(&first.0, &second.1));
        assert!(is_one_device(&first.0, &info(wgpu::Backend::Dx12, "")));
        assert!(rank(&first.0) < rank(&first.1), "Vulkan comes first");
    }
}
