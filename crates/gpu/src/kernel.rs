//! The compiled kernel of a program with its tables, and batches of rays that pass through it.

use crate::adapter::Device;
use crate::double::Doubles;
use crate::error::GpuError;
use crate::frame::DeviceRay;
use crate::layout::Layout;
use crate::shader::{self, Entry};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, mpsc};

/// Bytes of a ray on its way to the device, and of its answer.
const RAY_BYTES: usize = 32;

const ANSWER_BYTES: usize = 16;

/// Bytes of the parameters.
const PARAMS_BYTES: u64 = 64;

/// Workgroups of a row of a dispatch; the limit of every implementation is 65535.
const ROW: u32 = 32768;

/// The tables of a program on a device.
#[derive(Clone, Debug)]
pub(crate) struct Tables {
    pub device: Arc<Device>,
    data: wgpu::Buffer,
    tables: wgpu::Buffer,
    starts: [u32; 8],
    children: u32,
    bounded: bool,
    /// The tables for times in double precision, with their buffers.
    doubles: Option<(Arc<Doubles>, [wgpu::Buffer; 2])>,
}

/// A kernel with the tables of its program.
#[derive(Debug)]
pub(crate) struct Kernel {
    pub tables: Tables,
    pipeline: wgpu::ComputePipeline,
    /// A number of its own: the buffers of a slot are bound to one kernel.
    id: u64,
    /// Rows of an answer.
    pub rows: usize,
    entry: Entry,
}

/// Buffers for batches of up to a number of rays.
#[derive(Debug)]
pub(crate) struct Slot {
    /// Mapped between batches.
    up: wgpu::Buffer,
    rays: wgpu::Buffer,
    answers: wgpu::Buffer,
    times: Option<wgpu::Buffer>,
    back: wgpu::Buffer,
    params: wgpu::Buffer,
    group: wgpu::BindGroup,
    /// The number of rays that fit.
    most: usize,
    /// The number of the kernel.
    kernel: u64,
    /// The number of rays in the parameters.
    count: Option<usize>,
    /// Bytes of the rays.
    ray_bytes: u64,
}

/// An answer of the device: see `answer` in the shader.
pub(crate) type Answer = [u32; 4];

impl Tables {
    /// Uploads the tables of a program.
    pub fn new(
        device: Device,
        layout: &Layout,
        bounded: bool,
        doubles: Option<Doubles>,
    ) -> Result<Tables, GpuError> {
        let storage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
        let upload = |what: &'static str, bytes: Vec<u8>| -> Result<wgpu::Buffer, GpuError> {
            let buffer = device.buffer(what, bytes.len() as u64, storage)?;
            device.queue.write_buffer(&buffer, 0, &bytes);
            Ok(buffer)
        };
        let numbers = layout.data.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let data = upload("surfaces and boxes", numbers)?;
        let words = layout.tables.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let tables = upload("leaves and gates", words)?;
        let doubles = match doubles {
            Some(doubles) => {
                let exact = doubles.exact.iter().flat_map(|x| x.to_le_bytes()).collect();
                let lookup = doubles.lookup.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
                let buffers = [upload("exact surfaces", exact)?, upload("faces", lookup)?];
                Some((Arc::new(doubles), buffers))
            }
            None => None,
        };
        device.wait()?;
        let s = layout.starts;
        let starts = [s.facets, s.atoms, s.gates, s.outputs, s.groups, s.items, s.media, s.nodes];
        Ok(Tables { device: Arc::new(device), data, tables, starts, children: s.children, bounded, doubles })
    }
}

impl Kernel {
    /// The kernel with an entry point.
    pub fn new(tables: Tables, layout: &Layout, entry: Entry) -> Result<Kernel, GpuError> {
        let device = &tables.device;
        let doubles = tables.doubles.as_ref().map(|(doubles, _)| &**doubles);
        let pipeline = device.pipeline("crossings", shader::source(layout, entry, doubles))?;
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let id = NEXT.fetch_add(1, Ordering::Relaxed);
        Ok(Kernel { tables, pipeline, id, rows: entry.rows(), entry })
    }

    /// The device.
    pub fn device(&self) -> &Device {
        &self.tables.device
    }

    /// True if the kernel has rays in double precision and returns times in it.
    pub fn completes(&self) -> bool {
        self.entry.completes()
    }

    /// The most bytes of a ray on its way to the device.
    pub fn ray_bytes(&self) -> usize {
        match self.entry {
            Entry::Pixels => 4,
            Entry::Completed => 48,
            _ => RAY_BYTES,
        }
    }

    /// Bytes of an answer.
    pub fn answer_bytes(&self) -> usize {
        ANSWER_BYTES * self.rows + if self.completes() { 8 } else { 0 }
    }

    /// Buffers for batches of up to `most` rays.
    pub fn slot(&self, most: usize) -> Result<Slot, GpuError> {
        use wgpu::BufferUsages as Usage;
        let device = self.device();
        let header = if self.entry == Entry::Pixels { 4 * shader::PIXELS } else { 0 };
        // a range of rays may begin and end within a pixel
        let ray = (header + self.ray_bytes() * (most + 2)) as u64;
        let rows = (ANSWER_BYTES * self.rows * most) as u64;
        let up = device.mapped_buffer("rays", ray)?;
        let rays = device.buffer("rays", ray, Usage::STORAGE | Usage::COPY_DST)?;
        let answers = device.buffer("answers", rows, Usage::STORAGE | Usage::COPY_SRC)?;
        let back = (self.answer_bytes() * most) as u64;
        let back = device.buffer("answers", back, Usage::MAP_READ | Usage::COPY_DST)?;
        let params = device.buffer("parameters", PARAMS_BYTES, Usage::UNIFORM | Usage::COPY_DST)?;
        let Tables { data, tables, doubles, .. } = &self.tables;
        let mut buffers = vec![(0, data), (1, tables), (2, &rays), (3, &answers), (4, &params)];
        let mut times = None;
        if let (true, Some((_, [exact, lookup]))) = (self.completes(), doubles) {
            let column =
                times.insert(device.buffer("times", 8 * most as u64, Usage::STORAGE | Usage::COPY_SRC)?);
            buffers.extend([(5, exact), (6, lookup), (7, &*column)]);
        }
        let group = device.group(&self.pipeline, &buffers)?;
        let (kernel, ray_bytes) = (self.id, 0);
        Ok(Slot { up, rays, answers, times, back, params, group, most, kernel, count: None, ray_bytes })
    }

    /// Writes a number of rays to the buffer from which [`Kernel::submit`] uploads them.
    pub fn fill(&self, slot: &mut Slot, count: usize, rays: &[u8]) -> Result<(), GpuError> {
        slot.ray_bytes = rays.len() as u64;
        let mut view =
            slot.up.get_mapped_range_mut(..rays.len() as u64).map_err(|error| self.device().lost(&error))?;
        view.copy_from_slice(rays);
        drop(view);
        slot.up.unmap();
        if slot.count.replace(count) != Some(count) {
            let mut params = self.tables.starts.to_vec();
            let row = ROW * shader::WORKGROUP;
            params.extend([count as u32, row, u32::from(self.tables.bounded), self.tables.children]);
            let items = self.tables.doubles.as_ref().and_then(|(doubles, _)| doubles.items);
            params.extend([0, u32::from(items.is_some()), items.unwrap_or(0), 0]);
            let params: Vec<u8> = params.into_iter().flat_map(u32::to_le_bytes).collect();
            self.device().queue.write_buffer(&slot.params, 0, &params);
        }
        Ok(())
    }

    /// Submits the upload of the rays of a filled slot, the kernel, `repeats` times, and the download of the answers.
    pub fn submit(&self, slot: &Slot, repeats: usize) -> wgpu::SubmissionIndex {
        let count = slot.count.unwrap_or(0);
        let rows = (ANSWER_BYTES * self.rows * count) as u64;
        let mut encoder =
            self.device().device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(&slot.up, 0, &slot.rays, 0, slot.ray_bytes);
        for _ in 0..repeats {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &slot.group, &[]);
            let groups = (count as u32).div_ceil(shader::WORKGROUP);
            pass.dispatch_workgroups(groups.min(ROW), groups.div_ceil(ROW), 1);
        }
        encoder.copy_buffer_to_buffer(&slot.answers, 0, &slot.back, 0, rows);
        if let Some(times) = &slot.times {
            encoder.copy_buffer_to_buffer(times, 0, &slot.back, rows, 8 * count as u64);
        }
        self.device().queue.submit([encoder.finish()])
    }

    /// Uploads rays, traces them and returns the rows of their answers and, if the kernel completes answers, the bits of the times or
    /// tied events. After an
    /// error the slot must not be used again.
    pub fn trace(
        &self,
        slot: &mut Slot,
        (count, rays): (usize, &[u8]),
        answers: &mut Vec<Answer>,
        times: &mut Vec<u64>,
    ) -> Result<(), GpuError> {
        self.fill(slot, count, rays)?;
        let submitted = self.submit(slot, 1);
        let bytes = (self.answer_bytes() * count) as u64;
        let (send, done) = mpsc::channel();
        let filled = send.clone();
        // the receiver is gone only after an error
        slot.back.map_async(wgpu::MapMode::Read, ..bytes, move |result| _ = send.send(result));
        slot.up.map_async(wgpu::MapMode::Write, .., move |result| _ = filled.send(result));
        let device = self.device();
        device.wait_for(submitted)?;
        for _ in 0..2 {
            // another thread that waits for the device may make the calls
            done.recv().map_err(|error| device.lost(&error))?.map_err(|error| device.lost(&error))?;
        }
        let view = slot.back.get_mapped_range(..bytes).map_err(|error| device.lost(&error))?;
        let (rows, columns) = view.split_at(ANSWER_BYTES * self.rows * count);
        let word = |bytes: &[u8]| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        answers.clear();
        answers.extend(
            rows.chunks_exact(ANSWER_BYTES).map(|bytes| {
                [word(&bytes[..4]), word(&bytes[4..8]), word(&bytes[8..12]), word(&bytes[12..])]
            }),
        );
        times.clear();
        times.extend(
            columns.chunks_exact(8).map(|bytes| u64::from_le_bytes(bytes.try_into().unwrap_or_default())),
        );
        drop(view);
        slot.back.unmap();
        Ok(())
    }
}

impl Slot {
    /// True if the buffers are bound to a kernel.
    pub fn is_of(&self, kernel: &Kernel) -> bool {
        kernel.id == self.kernel
    }

    /// True if the buffers hold a number of rays.
    pub fn holds(&self, rays: usize) -> bool {
        rays <= self.most
    }
}

impl DeviceRay {
    /// The ray as the kernel reads it.
    pub fn bytes(&self) -> [u8; RAY_BYTES] {
        let [ox, oy, oz] = self.origin;
        let [dx, dy, dz] = self.direction;
        let mut bytes = [0; RAY_BYTES];
        let numbers = [ox, oy, oz, self.start, dx, dy, dz, self.error];
        bytes.chunks_exact_mut(4).zip(numbers).for_each(|(place, x)| place.copy_from_slice(&x.to_le_bytes()));
        bytes
    }
}
