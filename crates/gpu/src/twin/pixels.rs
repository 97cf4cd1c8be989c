//! Rays through pixels that a device computes, against those of the CPU, bit by bit. Skipped with a message where there is no adapter
//! with double precision.

use crate::adapter::{Adapter, Device, Gpu};
use crate::program::put_pixels;
use crate::shader;
use crate::trial::{compute, rounds_like_the_cpu};
use rayweave_math::Vec3;
use rayweave_model::{PixelCamera, PixelRays};
use std::ops::Range;

/// The functions of the shader, and a kernel that returns rays.
fn source() -> String {
    let lines = include_str!("../shader/pixels.wgsl")
        .replace("@PIXELS@", &shader::PIXELS.to_string())
        .replace("@binding(2)", "@binding(0)");
    let main = "
struct Params { zero: u32, unused: u32 }
@group(0) @binding(1) var<storage, read_write> results: array<f64>;
@group(0) @binding(2) var<uniform> params: Params;
var<private> exact: array<f64, 1>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let line = line_of(id.x);
    for (var k = 0u; k < 3u; k++) {
        results[6u * id.x + k] = line.o[k];
        results[6u * id.x + 3u + k] = line.d[k];
    }
}
";
    [shader::ARITHMETIC, shader::VECTORS, &lines, main].concat()
}

/// The bits of rays, computed on a device by a kernel.
fn on_device(device: &Device, rays: &PixelRays<'_>, range: Range<usize>, source: String) -> Vec<u64> {
    let mut bytes = Vec::new();
    let count = range.len();
    put_pixels(rays, range, &mut bytes);
    let groups = count.div_ceil(64);
    let found = compute(device, source, &bytes, 48 * 64 * groups, groups).unwrap();
    let bits = found.chunks_exact(8).map(|bytes| u64::from_le_bytes(bytes.try_into().unwrap()));
    bits.take(6 * count).collect()
}

fn on_the_cpu(rays: &PixelRays<'_>, range: Range<usize>) -> Vec<u64> {
    let numbers = |i: usize| {
        let ray = rays.get(i);
        [ray.origin.to_array(), ray.direction.to_array()].concat()
    };
    range.flat_map(numbers).map(f64::to_bits).collect()
}

fn camera(is_perspective: bool) -> PixelCamera {
    let forward = Vec3::new(0.48, -0.6, 0.64);
    let right = forward.cross(Vec3::Z).normalize();
    PixelCamera {
        position: Vec3::new(-31.7, 40.1, -0.3),
        forward,
        right,
        up: right.cross(forward),
        half_height: if is_perspective { 0.3017 } else { 21.3 },
        is_perspective,
        size: [641, 479],
    }
}

fn with_doubles(test: impl FnOnce(&Adapter, &Device)) {
    let gpu = Gpu::new();
    let adapter = match gpu.adapter(0) {
        Ok(adapter) => adapter,
        Err(problem) => return rayweave_conformance::skipped(problem),
    };
    let device = adapter.open().unwrap();
    match rounds_like_the_cpu(adapter, &device) {
        Ok(true) => test(adapter, &device),
        _ => rayweave_conformance::skipped(format!("{} does not round like the CPU", adapter.name())),
    }
}

/// All bits are those of the CPU, also for ranges that begin within a pixel; an error of one unit in the last place is noticed.
#[test]
fn rays_through_pixels_have_the_bits_of_the_cpu() {
    with_doubles(|_, device| {
        let pixels: Vec<u32> = (0..4096).map(|k| k * 7919 % (641 * 479)).collect();
        for is_perspective in [true, false] {
            for (per_side, range) in [(1, 0..4096), (3, 0..4096), (3, 5005..9100), (16, 1000..5000)] {
                let rays = PixelRays { camera: camera(is_perspective), per_side, pixels: &pixels };
                let found = on_device(device, &rays, range.clone(), source());
                assert!(found == on_the_cpu(&rays, range), "{is_perspective}, {per_side}");
            }
        }
        let steps = [
            ("plus(f64(whole), over(plus(f64(part), 0.5lf), f64(per_side)))", true),
            ("minus(times_(2.0lf, x), w)", true),
            ("over(minus(h, times_(2.0lf, y)), h)", true),
            ("times_(over(minus(times_(2.0lf, x), w), h), half)", true),
            ("dot64(d, d)", true),
            ("over(1.0lf, root(dot64(d, d)))", true),
        ];
        for (step, is_perspective) in steps {
            let off = "fn off(x: f64) -> f64 { return bitcast<f64>(bitcast<u64>(x) + 1lu); }\n";
            let text = source();
            assert!(text.contains(step), "{step}");
            let changed = off.to_owned() + &text.replace(step, &format!("off({step})"));
            let rays = PixelRays { camera: camera(is_perspective), per_side: 3, pixels: &pixels };
            let (found, own) = (on_device(device, &rays, 0..4096, changed), on_the_cpu(&rays, 0..4096));
            let differing = found.iter().zip(&own).filter(|(a, b)| a != b).count();
            println!("{step}: {differing} of {} numbers", own.len());
            assert!(differing > own.len() / 20, "{step}: {differing}");
        }
    });
}
