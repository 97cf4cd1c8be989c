//! Rays through pixels on an adapter, which computes them, against the CPU with the same rays as arrays, bit for bit. Skipped with a
//! message where there is no adapter.

use rayweave_gpu::{Gpu, GpuDevice, GpuProgram};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{
    Evaluator, FirstHitColumns, PixelCamera, PixelRays, Program, Query, Rays, Solid, Window,
};
use rayweave_shape::primitive::build;
use rayweave_trace::{AnyEvaluator, Packets};
use std::sync::Arc;

fn program() -> Arc<Program> {
    let size = Vec3::new(2.0, 2.0, 2.0);
    let block: Solid = build("box", &[("size", size.into())]).unwrap().into();
    let rod: Solid = build("cylinder", &[("radius", 0.3.into()), ("height", 4.0.into())]).unwrap().into();
    let ball: Solid = build("sphere", &[("radius", 0.6.into())]).unwrap().into();
    let ball = ball.apply(Affine::translate(Vec3::new(1.0, 1.0, 0.8)));
    Arc::new(Program::compile(&((block - rod) - ball)).unwrap())
}

fn camera(is_perspective: bool) -> PixelCamera {
    let forward = Vec3::new(-0.48, -0.64, -0.6);
    let right = forward.cross(Vec3::Z).normalize();
    PixelCamera {
        position: -6.0 * forward,
        forward,
        right,
        up: right.cross(forward),
        half_height: if is_perspective { 0.3 } else { 1.8 },
        is_perspective,
        size: [301, 203],
    }
}

/// All columns as bits.
fn bits(hits: &FirstHitColumns, i: usize) -> (u64, i32, [u32; 3], [u64; 3]) {
    let normal = [0, 1, 2].map(|k| hits.normal[k][i].to_bits());
    (hits.t[i].to_bits(), hits.face[i], [hits.placement[i], hits.before[i], hits.after[i]], normal)
}

fn on_the_cpu(cpu: &Packets, rays: Rays<'_>, window: Window) -> FirstHitColumns {
    let mut hits = FirstHitColumns::new(rays.len());
    cpu.nearest(rays, window, &mut cpu.scratch(), &mut hits.hits());
    hits
}

/// Several batches, which begin within a pixel where there are nine rays in each.
#[test]
fn pictures_have_the_bits_of_the_cpu() {
    let gpu = Gpu::new();
    let adapter = match gpu.adapter(0) {
        Ok(adapter) => adapter,
        Err(problem) => return rayweave_conformance::skipped(problem),
    };
    let program = program();
    let (device, cpu) = (GpuProgram::new(adapter, program.clone()).unwrap(), Packets::new(program));
    let all: Vec<u32> = (0..301 * 203).collect();
    let some: Vec<u32> = (0..7001).map(|k| k * 6007 % (301 * 203)).collect();
    for is_perspective in [true, false] {
        for (per_side, pixels) in [(1, &all), (3, &some)] {
            let rays = PixelRays { camera: camera(is_perspective), per_side, pixels };
            let count = rays.len();
            let arrays = rays.batch(0..count);
            let (mut ours, mut from_arrays) = (FirstHitColumns::new(count), FirstHitColumns::new(count));
            let report = device.nearest(rays, &mut ours.hits()).unwrap();
            let other = device.nearest(arrays.rays(), &mut from_arrays.hits()).unwrap();
            let theirs = on_the_cpu(&cpu, arrays.rays(), Query::nearest().window);
            for i in 0..count {
                assert_eq!(bits(&ours, i), bits(&theirs, i), "ray {i} of {per_side}: {:?}", rays.get(i));
                assert_eq!(bits(&from_arrays, i), bits(&theirs, i), "ray {i}");
            }
            let hits = theirs.face.iter().filter(|&&face| face >= 0).count();
            println!(
                "{is_perspective}, {per_side}: {report:?}, {hits} hits, with arrays {} bytes",
                other.bytes
            );
            assert!(hits > count / 4 && hits < count);
            assert_eq!((report.rays, report.contradicted), (count as u64, 0));
            // the same rays: the same answers of the device
            assert_eq!((report.uncertain, report.timed), (other.uncertain, other.timed));
            assert!(report.cpu_share() < 0.005, "{report:?}");
            if adapter.has_f64() {
                assert!(report.bytes < other.bytes * 2 / 5 + 1000, "{report:?}, {other:?}");
            }
        }
    }
}

/// Through the evaluator, in any window, and rays that are too far away.
#[test]
fn the_evaluator_passes_pixels_on() {
    let gpu = Gpu::new();
    let adapter = match gpu.adapter(0) {
        Ok(adapter) => adapter,
        Err(problem) => return rayweave_conformance::skipped(problem),
    };
    let program = program();
    let device = Arc::new(GpuDevice::new(GpuProgram::new(adapter, program.clone()).unwrap()));
    let evaluator = AnyEvaluator::with_device(program.clone(), device.clone());
    let cpu = Packets::new(program);
    let pixels: Vec<u32> = (0..2000).map(|k| 30 * k).collect();
    let rays = PixelRays { camera: camera(true), per_side: 1, pixels: &pixels };
    let arrays = rays.batch(0..rays.len());
    for (n, window) in [Query::nearest().window, Window::new(5.5, 7.0).unwrap()].into_iter().enumerate() {
        let mut ours = FirstHitColumns::new(rays.len());
        let both = (&rays, arrays.rays());
        evaluator.nearest_through(both, window, &mut evaluator.scratch(), &mut ours.hits());
        let theirs = on_the_cpu(&cpu, arrays.rays(), window);
        assert!((0..rays.len()).all(|i| bits(&ours, i).0 == bits(&theirs, i).0), "{window:?}");
        assert_eq!(device.report().rays, (n + 1) as u64 * 2000);
    }
    // the ray through the middle
    let mut distant = PixelRays { pixels: &[101 * 301 + 150], ..rays };
    distant.camera.position *= 1e15;
    let problem = device.program().nearest(distant, &mut FirstHitColumns::new(1).hits()).unwrap_err();
    assert!(problem.to_string().contains("ray 0"), "{problem}");
}
