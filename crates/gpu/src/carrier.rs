//! Particles that a kernel moves step by step: their state goes to the device, and what ends there with a result comes back.

use crate::adapter::{Adapter, Device};
use crate::error::GpuError;
use crate::trial::rounds_like_the_cpu;
use std::sync::mpsc;
use wgpu::BufferUsages as Usage;

/// Workgroups of a row of a dispatch; the limit of every implementation is 65535.
const ROW: u32 = 32768;

/// Threads of a workgroup.
const WORKGROUP: u32 = 64;

/// Sizes of the data that a kernel of this kind reads and writes.
#[derive(Clone, Copy, Debug)]
pub struct CarrierForm {
    /// Numbers and words of the state of a particle.
    pub state: [usize; 2],
    /// Numbers and words of a row that comes back.
    pub row: [usize; 2],
    /// Counts: the first is the number of rows that come back, the second that of particles in flight.
    pub counts: usize,
    /// Words of the parameters behind the first two: 0, and the number of particles.
    pub params: usize,
}

/// A kernel that moves particles, with its tables.
#[derive(Debug)]
pub struct Carrier {
    device: Device,
    pipeline: wgpu::ComputePipeline,
    tables: [wgpu::Buffer; 2],
    form: CarrierForm,
    room: usize,
}

/// Buffers for a batch of particles. Batches in different slots can be on the device at the same time.
#[derive(Debug)]
pub struct CarrierSlot {
    group: wgpu::BindGroup,
    states: [wgpu::Buffer; 2],
    rows: [wgpu::Buffer; 2],
    counts: wgpu::Buffer,
    params: wgpu::Buffer,
    back: wgpu::Buffer,
}

/// The results of a batch of particles.
#[derive(Clone, Debug, Default)]
pub struct Carried {
    /// The rows of numbers, one after the other.
    pub numbers: Vec<f64>,
    /// The rows of words.
    pub words: Vec<u32>,
    /// The counts behind the second, summed over all passes.
    pub counts: Vec<u64>,
    /// The number of passes.
    pub passes: u32,
    /// Bytes that moved to the device and back.
    pub bytes: u64,
}

impl Carrier {
    /// Compiles a kernel for an adapter, for batches of up to `room` particles. The source defines `main` with workgroups of 64 threads; its buffers are numbered in the
    /// order exact, words, numbers and words of the state, numbers and words of the rows, counts, parameters.
    ///
    /// # Errors
    ///
    /// [`GpuError::NoDouble`] and [`GpuError::Rounding`] for a device whose arithmetic is not that of the CPU,
    /// [`GpuError::TooLarge`], [`GpuError::Open`] and [`GpuError::Lost`].
    pub fn new(
        adapter: &Adapter,
        source: String,
        (exact, words): (&[f64], &[u32]),
        form: CarrierForm,
        room: usize,
    ) -> Result<Carrier, GpuError> {
        let name = || adapter.name().to_owned();
        if !adapter.has_f64() {
            return Err(GpuError::NoDouble { adapter: name() });
        }
        let device = adapter.open()?;
        if !rounds_like_the_cpu(adapter, &device)? {
            return Err(GpuError::Rounding { adapter: name() });
        }
        let pipeline = device.pipeline("steps", source)?;
        let upload = |what: &'static str, bytes: Vec<u8>| -> Result<wgpu::Buffer, GpuError> {
            let buffer = device.buffer(what, bytes.len() as u64, Usage::STORAGE | Usage::COPY_DST)?;
            device.queue.write_buffer(&buffer, 0, &bytes);
            Ok(buffer)
        };
        let exact = upload("numbers", exact.iter().flat_map(|x| x.to_le_bytes()).collect())?;
        let words = upload("words", words.iter().flat_map(|x| x.to_le_bytes()).collect())?;
        device.wait()?;
        Ok(Carrier { device, pipeline, tables: [exact, words], form, room })
    }

    /// Buffers for a batch.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] and [`GpuError::Lost`].
    pub fn slot(&self) -> Result<CarrierSlot, GpuError> {
        let Carrier { device, pipeline, form, room, .. } = self;
        let both = |what: &'static str, [numbers, words]: [usize; 2], usage: Usage| {
            let buffer = |size: usize| device.buffer(what, (room * size) as u64, Usage::STORAGE | usage);
            Ok::<_, GpuError>([buffer(8 * numbers)?, buffer(4 * words)?])
        };
        let states = both("states", form.state, Usage::COPY_DST)?;
        let rows = both("rows", form.row, Usage::COPY_SRC)?;
        let count_bytes = 4 * form.counts as u64;
        let counts =
            device.buffer("counts", count_bytes, Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST)?;
        // the size of a structure in a uniform buffer is a multiple of 16
        let params_bytes = (4 * (2 + form.params) as u64).next_multiple_of(16);
        let params = device.buffer("parameters", params_bytes, Usage::UNIFORM | Usage::COPY_DST)?;
        let back_bytes = count_bytes.next_multiple_of(16) + *room as u64 * bytes_of(form.row);
        let back = device.buffer("results", back_bytes, Usage::MAP_READ | Usage::COPY_DST)?;
        let [exact, table] = &self.tables;
        let [numbers_in, words_in] = &states;
        let [numbers_out, words_out] = &rows;
        let group = device.group(
            pipeline,
            &[
                (0, exact),
                (1, table),
                (2, numbers_in),
                (3, words_in),
                (4, numbers_out),
                (5, words_out),
                (6, &counts),
                (7, &params),
            ],
        )?;
        Ok(CarrierSlot { group, states, rows, counts, params, back })
    }

    /// The number of particles for which there is room.
    pub fn room(&self) -> usize {
        self.room
    }

    /// Uploads the states of some particles of a batch from number `first` on: the bytes of their numbers, particle by particle, and
    /// of their words.
    pub fn load(&self, slot: &CarrierSlot, first: usize, numbers: &[u8], words: &[u8]) {
        let [number_bytes, word_bytes] = [8 * self.form.state[0], 4 * self.form.state[1]];
        let most = self.room.saturating_sub(first);
        for (buffer, bytes, size) in
            [(&slot.states[0], numbers, number_bytes), (&slot.states[1], words, word_bytes)]
        {
            let bytes = &bytes[..bytes.len().min(most * size)];
            self.device.queue.write_buffer(buffer, (first * size) as u64, bytes);
        }
    }

    /// Moves the first particles of a batch until none of them is in flight. `params` are the parameters behind the first two.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`].
    pub fn run(
        &self,
        slot: &CarrierSlot,
        count: usize,
        params: &[u32],
        cancelled: impl Fn() -> bool,
    ) -> Result<Carried, GpuError> {
        let count = count.min(self.room);
        let mut all = vec![0, count as u32];
        all.extend(params);
        let bytes: Vec<u8> = all.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.device.queue.write_buffer(&slot.params, 0, &bytes);
        let mut carried = Carried { counts: vec![0; self.form.counts - 2], ..Carried::default() };
        let mut rows = 0;
        loop {
            let counts = self.pass(slot, count, rows)?;
            carried.passes += 1;
            rows = counts[0];
            carried.counts.iter_mut().zip(&counts[2..]).for_each(|(sum, &own)| *sum += u64::from(own));
            if counts[1] == 0 || cancelled() {
                break;
            }
        }
        self.fetch(slot, rows as usize, &mut carried)?;
        let each_pass = 8 * self.form.counts as u64;
        carried.bytes = count as u64 * bytes_of(self.form.state)
            + u64::from(carried.passes) * each_pass
            + u64::from(rows) * bytes_of(self.form.row);
        Ok(carried)
    }

    /// One pass over all particles, after which `rows` rows have come back so far; returns the counts.
    fn pass(&self, slot: &CarrierSlot, count: usize, rows: u32) -> Result<Vec<u32>, GpuError> {
        let Device { device, queue, .. } = &self.device;
        let mut counts = vec![0; self.form.counts];
        counts[0] = rows;
        let bytes: Vec<u8> = counts.iter().flat_map(|x: &u32| x.to_le_bytes()).collect();
        queue.write_buffer(&slot.counts, 0, &bytes);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &slot.group, &[]);
            let groups = (count as u32).div_ceil(WORKGROUP).max(1);
            pass.dispatch_workgroups(groups.min(ROW), groups.div_ceil(ROW), 1);
        }
        encoder.copy_buffer_to_buffer(&slot.counts, 0, &slot.back, 0, 4 * self.form.counts as u64);
        let submitted = queue.submit([encoder.finish()]);
        let mut found = Vec::new();
        self.read(slot, submitted, 4 * self.form.counts as u64, |bytes| {
            found = bytes.chunks_exact(4).map(word).collect();
        })?;
        Ok(found)
    }

    /// Copies the rows that came back.
    fn fetch(&self, slot: &CarrierSlot, rows: usize, carried: &mut Carried) -> Result<(), GpuError> {
        if rows == 0 {
            return Ok(());
        }
        let [numbers, words] = self.form.row.map(|size| size * rows);
        let mut encoder =
            self.device.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let split = 8 * numbers as u64;
        encoder.copy_buffer_to_buffer(&slot.rows[0], 0, &slot.back, 0, split);
        encoder.copy_buffer_to_buffer(&slot.rows[1], 0, &slot.back, split, 4 * words as u64);
        let submitted = self.device.queue.submit([encoder.finish()]);
        self.read(slot, submitted, split + 4 * words as u64, |bytes| {
            let (numbers, words) = bytes.split_at(split as usize);
            carried.numbers = numbers
                .chunks_exact(8)
                .map(|x| f64::from_le_bytes(x.try_into().unwrap_or_default()))
                .collect();
            carried.words = words.chunks_exact(4).map(word).collect();
        })
    }

    /// Reads bytes that a submission copies.
    fn read(
        &self,
        slot: &CarrierSlot,
        submitted: wgpu::SubmissionIndex,
        size: u64,
        mut take: impl FnMut(&[u8]),
    ) -> Result<(), GpuError> {
        let device = &self.device;
        let (send, done) = mpsc::channel();
        // only an error drops the receiver
        slot.back.map_async(wgpu::MapMode::Read, ..size, move |result| _ = send.send(result));
        device.wait_for(submitted)?;
        done.recv().map_err(|error| device.lost(&error))?.map_err(|error| device.lost(&error))?;
        let view = slot.back.get_mapped_range(..size).map_err(|error| device.lost(&error))?;
        take(&view);
        drop(view);
        slot.back.unmap();
        Ok(())
    }
}

/// Bytes of a particle with numbers and words.
fn bytes_of([numbers, words]: [usize; 2]) -> u64 {
    (8 * numbers + 4 * words) as u64
}

fn word(bytes: &[u8]) -> u32 {
    u32::from_le_bytes(bytes.try_into().unwrap_or_default())
}
