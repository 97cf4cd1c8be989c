//! Times in double precision on devices that have it: the tables of surfaces and maps with the numbers of the CPU, and the trial
//! of a device's arithmetic.

use crate::adapter::Device;
use crate::error::GpuError;
use crate::frame::Sender;
use crate::layout::Layout;
use rayweave_model::{PlacementId, Program};
use rayweave_shape::surface::Surface;
use std::collections::HashMap;

/// Kinds of surfaces whose times the device computes; the number is the case in the shader. The CPU computes those of others.
const OTHER: u32 = 0;
const PLANE: u32 = 1;
const SPHERE: u32 = 2;
const CYLINDER: u32 = 3;

/// The tables for times in double precision.
#[derive(Clone, Debug, Default)]
pub(crate) struct Doubles {
    /// The centre and the scale of the frame and the magnitude of the model, then surfaces and maps.
    pub exact: Vec<f64>,
    /// A row per facet: kind, first number of the surface, first number of the maps, number of maps. Then a row per item: first
    /// number of the maps, number of maps.
    pub lookup: Vec<[u32; 4]>,
    /// The row of the first item, if items have maps.
    pub items: Option<u32>,
}

impl Doubles {
    /// The tables of a program.
    pub fn new(program: &Program, layout: &Layout, sender: &Sender) -> Doubles {
        let mut doubles = Doubles::default();
        let frame = sender.frame;
        doubles.exact.extend(frame.centre.to_array());
        doubles.exact.extend([frame.scale, sender.magnitude]);
        let surfaces: Vec<(u32, u32)> =
            program.surfaces().iter().map(|entry| doubles.surface(&entry.surface)).collect();
        let mut known = HashMap::new();
        for face in &layout.faces {
            let (kind, surface) = surfaces[face.surface.0 as usize];
            // the maps of a solid within a placed one depend on the item
            let kind = if layout.placed_items && face.placement.0 != 0 { OTHER } else { kind };
            let [maps, count] = doubles.maps(program, face.placement, &mut known);
            doubles.lookup.push([kind, surface, maps, count]);
        }
        if layout.placed_items {
            doubles.items = Some(doubles.lookup.len() as u32);
            for &placement in &layout.placements {
                let [maps, count] = doubles.maps(program, PlacementId(placement), &mut known);
                doubles.lookup.push([maps, count, 0, 0]);
            }
        }
        doubles
    }

    /// Adds the numbers of a surface; returns its kind and the first of them.
    fn surface(&mut self, surface: &Surface) -> (u32, u32) {
        let at = self.exact.len() as u32;
        let kind = match surface {
            Surface::Plane(s) => {
                self.exact.extend(s.normal.to_array());
                self.exact.push(s.offset);
                PLANE
            }
            Surface::Sphere(s) => {
                self.exact.extend(s.centre.to_array());
                self.exact.push(s.radius * s.radius);
                SPHERE
            }
            Surface::Cylinder(s) => {
                self.exact.extend(s.point.to_array());
                self.exact.extend(s.axis.to_array());
                self.exact.push(s.radius * s.radius);
                CYLINDER
            }
            _ => OTHER,
        };
        (kind, at)
    }

    /// The maps that lead into the frame of a placement, outermost first: the first number and how many there are.
    fn maps(
        &mut self,
        program: &Program,
        placement: PlacementId,
        known: &mut HashMap<u32, [u32; 2]>,
    ) -> [u32; 2] {
        if placement.0 == 0 {
            return [0, 0];
        }
        *known.entry(placement.0).or_insert_with(|| {
            let at = self.exact.len() as u32;
            for place in program.descend(placement) {
                let map = place.local_from_world;
                let columns = [map.linear.x_axis, map.linear.y_axis, map.linear.z_axis, map.translation];
                columns.iter().for_each(|column| self.exact.extend(column.to_array()));
            }
            [at, (self.exact.len() as u32 - at) / 12]
        })
    }
}

/// Numbers per thread of the trial, results per thread, and threads.
const NUMBERS: usize = 3;
const RESULTS: usize = 6;
const TRIALS: usize = 4096;

/// True if a device rounds operations in double precision as the CPU does, for pseudo-random numbers of magnitudes from 2^-8 to
/// 2^8: nothing else can be concluded from documentation, since WGSL has no double precision.
pub(crate) fn rounds_like_the_cpu(device: &Device, arithmetic: &str) -> Result<bool, GpuError> {
    use wgpu::BufferUsages as Usage;
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
    let input = device.buffer("trial", bytes.len() as u64, Usage::STORAGE | Usage::COPY_DST)?;
    let size = (8 * RESULTS * TRIALS) as u64;
    let output = device.buffer("trial", size, Usage::STORAGE | Usage::COPY_SRC)?;
    let back = device.buffer("trial", size, Usage::MAP_READ | Usage::COPY_DST)?;
    let params = device.buffer("parameters", 16, Usage::UNIFORM | Usage::COPY_DST)?;
    device.queue.write_buffer(&input, 0, &bytes);
    device.queue.write_buffer(&params, 0, &[0; 16]);
    let pipeline = device.pipeline("trial", source)?;
    let group = device.group(&pipeline, &[(0, &input), (1, &output), (2, &params)])?;
    let mut encoder = device.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups((TRIALS / 64) as u32, 1, 1);
    }
    encoder.copy_buffer_to_buffer(&output, 0, &back, 0, size);
    let submitted = device.queue.submit([encoder.finish()]);
    let (send, done) = std::sync::mpsc::channel();
    back.map_async(wgpu::MapMode::Read, .., move |result| _ = send.send(result));
    device.wait_for(submitted)?;
    done.recv().map_err(|error| device.lost(&error))?.map_err(|error| device.lost(&error))?;
    let view = back.get_mapped_range(..).map_err(|error| device.lost(&error))?;
    let results = view.chunks_exact(8).map(|bytes| u64::from_le_bytes(bytes.try_into().unwrap_or_default()));
    let expected = numbers.chunks_exact(NUMBERS).flat_map(|numbers| {
        let [a, b, c] = [numbers[0], numbers[1], numbers[2]];
        [a * b + c, (a + b) - a, a / b, a.abs().sqrt(), a * c + b * c, a * a - b * b].map(f64::to_bits)
    });
    Ok(results.eq(expected))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapter::Gpu;

    #[test]
    fn the_trial_finds_sums_that_a_compiler_reassociates() {
        let gpu = Gpu::new();
        let Ok(adapter) = gpu.adapter(0) else {
            println!("skipped: no adapter");
            return;
        };
        let device = adapter.open().unwrap();
        if !device.has_f64 {
            println!("skipped: {} has no double precision", adapter.name());
            return;
        }
        let arithmetic = crate::shader::ARITHMETIC;
        assert_eq!(rounds_like_the_cpu(&device, arithmetic), Ok(true));
        // lavapipe and the driver of NVIDIA replace (a + b) - a by b; others may not
        let open = arithmetic.replace(
            "bitcast<f64>(bitcast<u64>(x) ^ u64(params.zero))",
            "select(x, 0.0lf, params.zero == 1u)",
        );
        assert_ne!(open, arithmetic);
        let result = rounds_like_the_cpu(&device, &open).unwrap();
        println!("without the mask, {} rounds like the CPU: {result}", adapter.name());
        // an error of one unit in the last place is found
        let off = arithmetic.replace("^ u64(params.zero)", "^ u64(params.zero + 1u)");
        assert_ne!(off, arithmetic);
        assert_eq!(rounds_like_the_cpu(&device, &off), Ok(false));
    }
}
