//! The order in which batches are complete. Skipped with a message where there is no adapter.

use super::*;
use crate::adapter::Gpu;
use rayweave_math::Vec3;
use rayweave_model::{FirstHitColumns, Solid};
use rayweave_shape::primitive::build;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Of each pair of batches the second is complete before the first: the answers are those of the CPU.
#[test]
fn the_order_in_which_batches_are_complete_changes_nothing() {
    const RAYS: usize = 4 * FEWEST_RAYS - 100;
    static SIZE: AtomicUsize = AtomicUsize::new(0);
    static COMPLETE: Mutex<Vec<usize>> = Mutex::new(Vec::new());
    fn after_the_next(first: usize) {
        let (begin, size) = (Instant::now(), SIZE.load(Ordering::Relaxed));
        let (batch, has_next) = (first / size, first + size < RAYS);
        let next_is_complete = || COMPLETE.lock().unwrap().contains(&(batch + 1));
        while batch % 2 == 0 && has_next && !next_is_complete() && begin.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(1));
        }
        COMPLETE.lock().unwrap().push(batch);
    }
    let gpu = Gpu::new();
    let Ok(adapter) = gpu.adapter(0) else {
        rayweave_conformance::skipped("there is no adapter");
        return;
    };
    let solid: Solid = build("sphere", &[("radius", 1.0.into())]).unwrap().into();
    let program = Arc::new(Program::compile(&solid).unwrap());
    let mut device = GpuProgram::new(adapter, program.clone()).unwrap();
    device.completed = after_the_next;
    // the last batch is not full
    SIZE.store(device.batch(RAYS, &device.kernel), Ordering::Relaxed);
    let at = |k: usize, n: usize| (k % n) as f64 / (n / 2) as f64 - 1.0;
    let rays: RayBatch =
        (0..RAYS).map(|k| Ray::new(Vec3::new(-3.0, at(k, 257), at(k, 263)), Vec3::X)).collect();
    let (mut ours, mut theirs) = (FirstHitColumns::new(RAYS), FirstHitColumns::new(RAYS));
    device.nearest(rays.rays(), &mut ours.hits()).unwrap();
    let cpu = Packets::new(program);
    let window = Window::new(0.0, f64::INFINITY).unwrap();
    cpu.nearest(rays.rays(), window, &mut cpu.scratch(), &mut theirs.hits());
    let bits = |t: &[f64]| t.iter().map(|t| t.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&ours.t), bits(&theirs.t));
    assert_eq!((&ours.face, &ours.before, &ours.after), (&theirs.face, &theirs.before, &theirs.after));
    let order = COMPLETE.lock().unwrap();
    let place = |batch: usize| order.iter().position(|&own| own == batch);
    assert_eq!(order.len(), RAYS.div_ceil(SIZE.load(Ordering::Relaxed)));
    assert!(order.len() > 1 && (0..order.len() / 2).all(|k| place(2 * k + 1) < place(2 * k)), "{order:?}");
}
