//! The trial of a device's arithmetic in double precision.

use crate::adapter::{Adapter, Device};
use crate::error::GpuError;
use crate::shader;

/// Numbers per thread of the trial, results per thread, and threads.
const NUMBERS: usize = 3;
const RESULTS: usize = 6;
const TRIALS: usize = 4096;

/// True if an open device of an adapter rounds operations in double precision as the CPU does. The adapter keeps the result of the
/// first trial.
pub(crate) fn rounds_like_the_cpu(adapter: &Adapter, device: &Device) -> Result<bool, GpuError> {
    if !device.has_f64 {
        return Ok(false);
    }
    if let Some(&known) = adapter.trial.get() {
        return Ok(known);
    }
    let result = try_arithmetic(device, shader::ARITHMETIC)?;
    Ok(*adapter.trial.get_or_init(|| result))
}

/// True if a device rounds the operations of a shader as the CPU does, for pseudo-random numbers of magnitudes from 2^-8 to
/// 2^8: nothing else can be concluded from documentation, since WGSL has no double precision.
fn try_arithmetic(device: &Device, arithmetic: &str) -> Result<bool, GpuError> {
    let mut state = 1u64;
    let mut next = || {
        // constants of Knuth's MMIX generator
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mantissa = f64::from_bits(state >> 12 | 1023 << 52) - 1.5;
        libm::ldexp(mantissa, (state >> 8 & 15) as i32 - 7)
    };
    let numbers: Vec<f64> = (0..NUMBERS * TRIALS).map(|_| next()).collect();
    let source = include_str!("shader/trial.wgsl").replace("@ARITHMETIC@", arithmetic);
    let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    let found = compute(device, source, &bytes, 8 * RESULTS * TRIALS, TRIALS / 64)?;
    let results = found.chunks_exact(8).map(|bytes| u64::from_le_bytes(bytes.try_into().unwrap_or_default()));
    let expected = numbers.chunks_exact(NUMBERS).flat_map(|numbers| {
        let [a, b, c] = [numbers[0], numbers[1], numbers[2]];
        [a * b + c, (a + b) - a, a / b, a.abs().sqrt(), a * c + b * c, a * a - b * b].map(f64::to_bits)
    });
    Ok(results.eq(expected))
}

/// The results of a kernel that reads a buffer (0), writes one of a number of bytes (1), and has parameters of four words (2), which are 0.
pub(crate) fn compute(
    device: &Device,
    source: String,
    input: &[u8],
    results: usize,
    groups: usize,
) -> Result<Vec<u8>, GpuError> {
    use wgpu::BufferUsages as Usage;
    let numbers = device.buffer("trial", input.len() as u64, Usage::STORAGE | Usage::COPY_DST)?;
    let size = results as u64;
    let output = device.buffer("trial", size, Usage::STORAGE | Usage::COPY_SRC)?;
    let back = device.buffer("trial", size, Usage::MAP_READ | Usage::COPY_DST)?;
    let params = device.buffer("parameters", 16, Usage::UNIFORM | Usage::COPY_DST)?;
    device.queue.write_buffer(&numbers, 0, input);
    device.queue.write_buffer(&params, 0, &[0; 16]);
    let pipeline = device.pipeline("trial", source)?;
    let group = device.group(&pipeline, &[(0, &numbers), (1, &output), (2, &params)])?;
    let mut encoder = device.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(groups as u32, 1, 1);
    }
    encoder.copy_buffer_to_buffer(&output, 0, &back, 0, size);
    let submitted = device.queue.submit([encoder.finish()]);
    let (send, done) = std::sync::mpsc::channel();
    // only an error drops the receiver
    back.map_async(wgpu::MapMode::Read, .., move |result| _ = send.send(result));
    device.wait_for(submitted)?;
    done.recv().map_err(|error| device.lost(&error))?.map_err(|error| device.lost(&error))?;
    let view = back.get_mapped_range(..).map_err(|error| device.lost(&error))?;
    Ok(view.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapter::Gpu;

    #[test]
    fn the_trial_finds_sums_that_a_compiler_reassociates() {
        let gpu = Gpu::new();
        let Ok(adapter) = gpu.adapter(0) else {
            rayweave_conformance::skipped("there is no adapter");
            return;
        };
        let device = adapter.open().unwrap();
        if !device.has_f64 {
            rayweave_conformance::skipped(format!("{} has no double precision", adapter.name()));
            return;
        }
        let arithmetic = shader::ARITHMETIC;
        assert_eq!(try_arithmetic(&device, arithmetic), Ok(true));
        // lavapipe and the driver of NVIDIA replace (a + b) - a by b; others may not
        let open = arithmetic.replace(
            "bitcast<f64>(bitcast<u64>(x) ^ u64(params.zero))",
            "select(x, 0.0lf, params.zero == 1u)",
        );
        assert_ne!(open, arithmetic);
        let result = try_arithmetic(&device, &open).unwrap();
        println!("without the mask, {} rounds like the CPU: {result}", adapter.name());
        // an error of one unit in the last place is found
        let off = arithmetic.replace("^ u64(params.zero)", "^ u64(params.zero + 1u)");
        assert_ne!(off, arithmetic);
        assert_eq!(try_arithmetic(&device, &off), Ok(false));
    }
}
