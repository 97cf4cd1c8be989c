//! The nearest crossings of rays through a model on a graphics card and on the CPU.

use crate::Failure;
use crate::models::{Numbers, Scene};
use rayweave_gpu::{Adapter, GpuProgram, GpuReport};
use rayweave_model::drive::{Cancel, drive, thread_count};
use rayweave_model::{Evaluator, FirstHits, RayBatch, Rays, Window};
use rayweave_shape::Ray;
use rayweave_trace::Packets;
use std::time::Instant;

/// A row of the table.
pub struct Row {
    name: &'static str,
    faces: usize,
    report: GpuReport,
    compared: usize,
    differing: usize,
    table_bytes: u64,
    compile: f64,
    kernel: f64,
    whole: f64,
    cpu: f64,
}

impl Row {
    /// True if no answer differs.
    pub fn is_right(&self) -> bool {
        self.differing == 0
    }
}

/// The head of the table.
pub const HEAD: &str = "
## Nearest crossings

Mrays/s: millions of rays per second. Kernel: with rays and answers on the device. Whole: from f64 rays to f64 answers, with upload, \
download, the f64 kernel of each face and the CPU's rays. CPU: Packets.

| model | faces | kernel, Mrays/s | whole, Mrays/s | CPU, Mrays/s | uncertain, % | contradicted | differing rays | bytes per ray | \
tables, MB | compile, s | timed, % | prepare, wait, complete: ns per ray and thread |
|---|---|---|---|---|---|---|---|---|---|---|---|---|
";

/// Answers in columns.
struct Columns {
    t: Vec<f64>,
    face: Vec<i32>,
    placement: Vec<u32>,
    before: Vec<u32>,
    after: Vec<u32>,
}

impl Columns {
    fn new(count: usize) -> Columns {
        let numbers = || vec![0; count];
        Columns {
            t: vec![0.0; count],
            face: vec![0; count],
            placement: numbers(),
            before: numbers(),
            after: numbers(),
        }
    }

    fn hits(&mut self) -> FirstHits<'_> {
        FirstHits {
            t: &mut self.t,
            face: &mut self.face,
            placement: &mut self.placement,
            before: &mut self.before,
            after: &mut self.after,
            normal: None,
        }
    }

    fn bits(&self, i: usize) -> (u64, i32, u32, u32, u32) {
        (self.t[i].to_bits(), self.face[i], self.placement[i], self.before[i], self.after[i])
    }
}

/// Rays from a sphere about the model to random points in it.
fn rays(scene: &Scene, count: usize) -> RayBatch {
    let mut numbers = Numbers(1);
    let centre = scene.program.bounds().centre();
    (0..count)
        .map(|_| {
            let target = centre + numbers.point(scene.half);
            let origin = centre + 3.0 * scene.half * numbers.point(1.0).normalize_or(rayweave_math::Vec3::X);
            Ray::new(origin, (target - origin).normalize())
        })
        .collect()
}

/// Traces rays twice on the device, since the first query allocates memory, and on the CPU.
pub fn measure(scene: &Scene, adapter: &Adapter, count: usize) -> Result<Row, Failure> {
    let clock = Instant::now();
    let gpu = GpuProgram::new(adapter, scene.program.clone())?;
    let compile = clock.elapsed().as_secs_f64();
    let rays = rays(scene, count);
    let mut ours = Columns::new(rays.len());
    // the first query allocates the memory of the program, and the pages of the columns
    gpu.nearest(rays.rays(), &mut ours.hits())?;
    let clock = Instant::now();
    let report = gpu.nearest(rays.rays(), &mut ours.hits())?;
    let whole = rays.len() as f64 / clock.elapsed().as_secs_f64();
    let (one, count) = gpu.kernel_seconds(rays.rays(), 1)?;
    let repeats = (0.3 / one).clamp(1.0, 100.0) as usize;
    let (seconds, count) = if repeats > 1 { gpu.kernel_seconds(rays.rays(), repeats)? } else { (one, count) };
    let kernel = count as f64 / seconds;
    let mut theirs = Columns::new(rays.len());
    let (compared, cpu) = on_the_cpu(scene, rays.rays(), &mut theirs);
    let differing = (0..compared).filter(|&i| ours.bits(i) != theirs.bits(i)).count();
    Ok(Row {
        name: scene.name,
        faces: scene.program.facets().len(),
        report,
        compared,
        differing,
        table_bytes: gpu.table_bytes(),
        compile,
        kernel,
        whole,
        cpu,
    })
}

/// Traces rays on all cores until all are done or ten seconds have passed; returns their number and the rays per second.
fn on_the_cpu(scene: &Scene, rays: Rays<'_>, columns: &mut Columns) -> (usize, f64) {
    const CHUNK: usize = 1 << 13;
    let cpu = Packets::new(scene.program.clone());
    let window = Window::new(0.0, f64::INFINITY).unwrap_or_default();
    let clock = Instant::now();
    let chunks = (0..rays.len()).step_by(CHUNK).map(|first| first..(first + CHUNK).min(rays.len()));
    let chunks = chunks.take_while(|_| clock.elapsed().as_secs_f64() < 10.0);
    let mut done = 0;
    let work = |scratch: &mut _, range: std::ops::Range<usize>| {
        let mut part = Columns::new(range.len());
        cpu.nearest(rays.slice(range.clone()), window, scratch, &mut part.hits());
        (range, part)
    };
    let merged = drive(
        thread_count(None),
        &Cancel::new(),
        chunks,
        || cpu.scratch(),
        work,
        |(range, part)| {
            done = range.end;
            columns.t[range.clone()].copy_from_slice(&part.t);
            columns.face[range.clone()].copy_from_slice(&part.face);
            columns.placement[range.clone()].copy_from_slice(&part.placement);
            columns.before[range.clone()].copy_from_slice(&part.before);
            columns.after[range].copy_from_slice(&part.after);
            Ok::<(), std::convert::Infallible>(())
        },
    );
    debug_assert!(merged.is_ok());
    (done, done as f64 / clock.elapsed().as_secs_f64())
}

/// A line of the table.
pub fn line(row: &Row) -> String {
    let Row { name, faces, report, compared, differing, table_bytes, compile, kernel, whole, cpu } = row;
    let share = 100.0 * report.uncertain as f64 / report.rays.max(1) as f64;
    let per_ray = |time: std::time::Duration| 1e9 * time.as_secs_f64() / report.rays.max(1) as f64;
    format!(
        "| {name} | {faces} | {:.3} | {:.3} | {:.3} | {share:.4} | {} | {differing} of {compared} | {} | {:.1} | {compile:.2} | {:.1} | {:.0}, {:.0}, {:.0} |",
        kernel / 1e6,
        whole / 1e6,
        cpu / 1e6,
        report.contradicted,
        report.bytes / report.rays.max(1),
        *table_bytes as f64 / 1e6,
        100.0 * report.timed as f64 / report.rays.max(1) as f64,
        per_ray(report.prepare),
        per_ray(report.device),
        per_ray(report.complete),
    )
}

/// A row as JSON.
pub fn json(row: &Row) -> String {
    format!(
        "  {{\"model\": {:?}, \"faces\": {}, \"rays\": {}, \"uncertain\": {}, \"timed\": {}, \"distant\": {}, \"contradicted\": {}, \
         \"bytes\": {}, \"table_bytes\": {}, \"compared\": {}, \"differing\": {}, \"compile_seconds\": {:.4}, \
         \"kernel_rays_per_second\": {:.0}, \"whole_rays_per_second\": {:.0}, \"cpu_rays_per_second\": {:.0}}}",
        row.name,
        row.faces,
        row.report.rays,
        row.report.uncertain,
        row.report.timed,
        row.report.distant,
        row.report.contradicted,
        row.report.bytes,
        row.table_bytes,
        row.compared,
        row.differing,
        row.compile,
        row.kernel,
        row.whole,
        row.cpu,
    )
}
