//! The graphics cards of this machine.

use crate::error::GpuError;
use std::future::Future;
use std::pin::pin;
use std::sync::{Arc, Mutex, OnceLock};
use std::task::{Context, Poll, Waker};

/// The entry point: lists the adapters of this machine.
#[derive(Debug)]
pub struct Gpu {
    adapters: Vec<Adapter>,
}

/// A graphics card, or a program that acts as one, through its driver.
#[derive(Clone, Debug)]
pub struct Adapter {
    pub(crate) adapter: wgpu::Adapter,
    info: wgpu::AdapterInfo,
    /// The result of the trial of its arithmetic in double precision.
    pub(crate) trial: Arc<OnceLock<bool>>,
}

/// The features for double precision; integers of 64 bits hold the bits of its numbers.
const DOUBLE: wgpu::Features = wgpu::Features::SHADER_F64.union(wgpu::Features::SHADER_INT64);

/// The class of an adapter, best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AdapterKind {
    /// A card with its own memory.
    Discrete,
    /// A part of the processor.
    Integrated,
    /// A card of a virtual machine.
    Virtual,
    /// Unknown.
    Other,
    /// A program on the processor, such as lavapipe.
    Software,
}

impl AdapterKind {
    /// The class in words.
    pub fn name(self) -> &'static str {
        match self {
            AdapterKind::Discrete => "card",
            AdapterKind::Integrated => "in the processor",
            AdapterKind::Virtual => "virtual",
            AdapterKind::Other => "unknown",
            AdapterKind::Software => "software",
        }
    }
}

impl Gpu {
    /// Asks the Vulkan drivers of this machine for their adapters, best first.
    pub fn new() -> Gpu {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = wgpu::Backends::VULKAN;
        descriptor.flags = wgpu::InstanceFlags::empty();
        let instance = wgpu::Instance::new(descriptor);
        let found = block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN));
        let mut adapters: Vec<Adapter> = found
            .into_iter()
            .map(|adapter| {
                let info = adapter.get_info();
                Adapter { adapter, info, trial: Arc::default() }
            })
            .collect();
        adapters.sort_by_key(Adapter::kind);
        Gpu { adapters }
    }

    /// The adapters, best first.
    pub fn adapters(&self) -> &[Adapter] {
        &self.adapters
    }

    /// The adapter with a number in this list.
    ///
    /// # Errors
    ///
    /// [`GpuError::NoAdapter`] if there is none at all, [`GpuError::UnknownAdapter`] if the number is too large.
    pub fn adapter(&self, number: usize) -> Result<&Adapter, GpuError> {
        match (self.adapters.get(number), self.adapters.len()) {
            (Some(adapter), _) => Ok(adapter),
            (None, 0) => Err(GpuError::NoAdapter),
            (None, count) => Err(GpuError::UnknownAdapter { number, count }),
        }
    }
}

impl Default for Gpu {
    fn default() -> Self {
        Gpu::new()
    }
}

impl Adapter {
    /// The name that the driver gives.
    pub fn name(&self) -> &str {
        &self.info.name
    }

    /// The driver with its version.
    pub fn driver(&self) -> String {
        format!("{} {}", self.info.driver, self.info.driver_info).trim().to_owned()
    }

    /// The class.
    pub fn kind(&self) -> AdapterKind {
        match self.info.device_type {
            wgpu::DeviceType::DiscreteGpu => AdapterKind::Discrete,
            wgpu::DeviceType::IntegratedGpu => AdapterKind::Integrated,
            wgpu::DeviceType::VirtualGpu => AdapterKind::Virtual,
            wgpu::DeviceType::Cpu => AdapterKind::Software,
            wgpu::DeviceType::Other => AdapterKind::Other,
        }
    }

    /// The size of the largest table that a kernel can read, in bytes.
    pub fn largest_buffer(&self) -> u64 {
        let limits = self.adapter.limits();
        limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
    }

    /// True if kernels can compute in double precision: then the device computes the times of planes, spheres and cylinders, if a
    /// trial shows that it rounds like the CPU.
    pub fn has_f64(&self) -> bool {
        self.adapter.features().contains(DOUBLE)
    }

    /// Opens the device.
    pub(crate) fn open(&self) -> Result<Device, GpuError> {
        let adapter = self.name().to_owned();
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("rayweave"),
            required_limits: self.adapter.limits(),
            required_features: if self.has_f64() { DOUBLE } else { wgpu::Features::empty() },
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = block_on(self.adapter.request_device(&descriptor)).map_err(|error| {
            GpuError::Open { adapter: adapter.clone(), reason: one_line(&error.to_string()) }
        })?;
        let problem = Arc::new(Mutex::new(None));
        let (lost, failed) = (problem.clone(), problem.clone());
        device.set_device_lost_callback(move |_, reason| note(&lost, &reason));
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| note(&failed, &error.to_string())));
        let has_f64 = self.has_f64();
        Ok(Device { device, queue, adapter, problem, limit: self.largest_buffer(), has_f64 })
    }
}

/// An open device.
#[derive(Debug)]
pub(crate) struct Device {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub adapter: String,
    /// The largest buffer, in bytes.
    pub limit: u64,
    /// True if kernels can compute in double precision.
    pub has_f64: bool,
    problem: Arc<Mutex<Option<String>>>,
}

impl Device {
    /// The first problem that the driver reported.
    pub fn check(&self) -> Result<(), GpuError> {
        let problem = self.problem.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        match &*problem {
            None => Ok(()),
            Some(reason) => Err(GpuError::Lost { adapter: self.adapter.clone(), reason: reason.clone() }),
        }
    }

    /// Waits for all submitted work.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.poll(wgpu::PollType::wait_indefinitely())
    }

    /// Waits for a submission.
    pub fn wait_for(&self, submitted: wgpu::SubmissionIndex) -> Result<(), GpuError> {
        self.poll(wgpu::PollType::Wait { submission_index: Some(submitted), timeout: None })
    }

    fn poll(&self, until: wgpu::PollType) -> Result<(), GpuError> {
        self.check()?;
        self.device.poll(until).map_err(|error| self.lost(&error))?;
        self.check()
    }

    /// The first problem that the driver reported or, without one, an error as such a problem.
    pub fn lost(&self, error: &impl std::fmt::Display) -> GpuError {
        let lost = || GpuError::Lost { adapter: self.adapter.clone(), reason: one_line(&error.to_string()) };
        // a lost device is reported while the device is polled; without an error there
        let _ = self.device.poll(wgpu::PollType::Poll);
        self.check().err().unwrap_or_else(lost)
    }

    /// Compiles a kernel.
    pub fn pipeline(&self, what: &'static str, source: String) -> Result<wgpu::ComputePipeline, GpuError> {
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(what),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        self.check()?;
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(what),
            layout: None,
            module: &module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        self.check()?;
        Ok(pipeline)
    }

    /// Binds buffers to the numbers by which a kernel knows them.
    pub fn group(
        &self,
        pipeline: &wgpu::ComputePipeline,
        buffers: &[(u32, &wgpu::Buffer)],
    ) -> Result<wgpu::BindGroup, GpuError> {
        let entries: Vec<_> = buffers
            .iter()
            .map(|&(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        self.check()?;
        Ok(group)
    }

    /// A buffer of the device.
    pub fn buffer(
        &self,
        what: &'static str,
        bytes: u64,
        usage: wgpu::BufferUsages,
    ) -> Result<wgpu::Buffer, GpuError> {
        self.create(what, bytes, usage, false)
    }

    /// A buffer that the CPU writes and the device copies from, mapped.
    pub fn mapped_buffer(&self, what: &'static str, bytes: u64) -> Result<wgpu::Buffer, GpuError> {
        self.create(what, bytes, wgpu::BufferUsages::MAP_WRITE | wgpu::BufferUsages::COPY_SRC, true)
    }

    fn create(
        &self,
        what: &'static str,
        bytes: u64,
        usage: wgpu::BufferUsages,
        mapped: bool,
    ) -> Result<wgpu::Buffer, GpuError> {
        if bytes > self.limit {
            return Err(GpuError::TooLarge { what, bytes, limit: self.limit });
        }
        let descriptor = wgpu::BufferDescriptor {
            label: Some(what),
            size: bytes.max(16),
            usage,
            mapped_at_creation: mapped,
        };
        let buffer = self.device.create_buffer(&descriptor);
        self.check()?;
        Ok(buffer)
    }
}

fn note(place: &Mutex<Option<String>>, reason: &str) {
    let mut place = place.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    place.get_or_insert_with(|| one_line(reason));
}

/// A message of the driver as part of a sentence.
fn one_line(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.trim_end_matches('.') {
        "" => "the driver gives no reason".to_owned(),
        line => line.to_owned(),
    }
}

/// Runs a future that the native back-ends complete at once.
pub(crate) fn block_on<T>(future: impl Future<Output = T>) -> T {
    let mut future = pin!(future);
    let mut context = Context::from_waker(Waker::noop());
    loop {
        match future.as_mut().poll(&mut context) {
            Poll::Ready(value) => return value,
            Poll::Pending => std::thread::yield_now(),
        }
    }
}
