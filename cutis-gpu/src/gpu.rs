//! The device: which adapter, with which limits.

use crate::GpuError;
use crate::faults::Faults;
use bytemuck::Pod;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Which adapters will do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Adapters {
    /// Graphics processors only.
    Hardware,
    /// Programs that stand in for one (llvmpipe, SwiftShader, WARP) as well.
    Any,
}

/// A device and its queue.
#[derive(Debug, Clone)]
pub struct Gpu {
    /// Makes buffers, textures and pipelines.
    pub device: wgpu::Device,
    /// Takes the work.
    pub queue: wgpu::Queue,
    /// What it runs on.
    pub info: wgpu::AdapterInfo,
    faults: Faults,
    asked_bytes: Arc<AtomicU64>,
}

impl Gpu {
    /// Finds the best adapter of a kind and opens it with the default limits of WebGPU.
    ///
    /// # Errors
    /// If there is none, or it gives no device.
    pub fn find(adapters: Adapters) -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let mut found = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
        found.sort_by_key(|adapter| preference(adapter.get_info().device_type));
        let software: Vec<_> = found.iter().filter(|a| is_software(a)).map(|a| a.get_info().name).collect();
        let best = found.into_iter().find(|a| adapters == Adapters::Any || !is_software(a));
        let adapter = best.ok_or_else(|| no_adapter(adapters, &software))?;
        Self::open(&adapter)
    }

    /// A device that somebody else has made, with the default limits of WebGPU at least.
    pub fn from_device(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let info = device.adapter_info();
        Self { faults: Faults::of(&device), asked_bytes: Arc::default(), device, queue, info }
    }

    fn open(adapter: &wgpu::Adapter) -> Result<Self, GpuError> {
        let info = adapter.get_info();
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("cutis"),
            // Times of passes are told where the adapter can measure them.
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|e| GpuError::NoDevice { adapter: info.name.clone(), reason: e.to_string() })?;
        Ok(Self::from_device(device, queue))
    }

    /// The same device with a count of its own of what is asked of it from now on.
    pub fn counting(&self) -> Self {
        Self { asked_bytes: Arc::default(), ..self.clone() }
    }

    /// Bytes of all textures and buffers that were asked for through this.
    pub fn asked_bytes(&self) -> u64 {
        self.asked_bytes.load(Ordering::Relaxed)
    }

    /// Notes that a texture or a buffer was asked for.
    pub(crate) fn count(&self, bytes: u64) {
        self.asked_bytes.fetch_add(bytes, Ordering::Relaxed);
    }

    /// What the device has refused since this was last asked.
    ///
    /// # Errors
    /// The first refusal, if there was one.
    pub fn check(&self) -> Result<(), GpuError> {
        // The loss of a device is told to those who ask; the answer counts, not what asking gives.
        let _ = self.device.poll(wgpu::PollType::Poll);
        self.faults.check().map_err(|error| match error {
            GpuError::OutOfMemory { .. } => GpuError::OutOfMemory { asked_bytes: self.asked_bytes() },
            other => other,
        })
    }

    /// Name of the adapter and of what drives it, for reports.
    pub fn name(&self) -> String {
        let wgpu::AdapterInfo { name, driver, backend, .. } = &self.info;
        if driver.is_empty() {
            format!("{name} ({backend})")
        } else {
            format!("{name} ({driver}, {backend})")
        }
    }

    /// A buffer of one uniform struct.
    pub fn uniform<T: Pod>(&self, label: &str, value: &T) -> wgpu::Buffer {
        self.buffer(label, bytemuck::bytes_of(value), wgpu::BufferUsages::UNIFORM)
    }

    /// A buffer that shaders read as an array. Empty arrays have one element of zeros, for none may be empty.
    pub fn storage<T: Pod>(&self, label: &str, values: &[T]) -> wgpu::Buffer {
        let zero = [T::zeroed()];
        let bytes = bytemuck::cast_slice(if values.is_empty() { &zero } else { values });
        self.buffer(label, bytes, wgpu::BufferUsages::STORAGE)
    }

    /// A buffer of the numbers of vertices.
    pub fn indices(&self, label: &str, values: &[u32]) -> wgpu::Buffer {
        self.buffer(label, bytemuck::cast_slice(values), wgpu::BufferUsages::INDEX)
    }

    fn buffer(&self, label: &str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let size = contents.len() as u64;
        self.count(size);
        let usage = usage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let descriptor =
            wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
        let buffer = self.device.create_buffer(&descriptor);
        // Not by mapping it: what a device without room or a lost one gives cannot be mapped.
        self.queue.write_buffer(&buffer, 0, contents);
        buffer
    }

    /// Waits until all work is done.
    ///
    /// # Errors
    /// If the device is lost, or has refused something.
    pub fn wait(&self) -> Result<(), GpuError> {
        let waited = self.device.poll(wgpu::PollType::wait_indefinitely());
        waited.map_err(|e| GpuError::Lost { reason: e.to_string() })?;
        self.check()
    }

    /// Whether passes can be timed by the device itself.
    pub fn has_timestamps(&self) -> bool {
        self.device.features().contains(wgpu::Features::TIMESTAMP_QUERY)
    }
}

/// Lower is better.
fn preference(kind: wgpu::DeviceType) -> u32 {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

fn is_software(adapter: &wgpu::Adapter) -> bool {
    adapter.get_info().device_type == wgpu::DeviceType::Cpu
}

fn no_adapter(adapters: Adapters, software: &[String]) -> GpuError {
    let among = if adapters == Adapters::Hardware { " but software ones" } else { "" };
    let reason = match software {
        [] => "no Vulkan, Metal or Direct3D 12 driver offers one".to_owned(),
        names => format!("found only {}", names.join(", ")),
    };
    GpuError::NoAdapter { among, reason }
}
