//! Correctness and speed of nearest crossings on a GPU, beside the CPU on all cores, as a table.
//!
//! ```text
//! gpu_bench [--rays N] [--models die,lens,...] [--adapter K] [--out FOLDER]
//! ```
//!
//! It writes `gpu.md` and `gpu.json` to the folder, and the table to standard output. Every row compares the answers of the GPU
//! with those of the CPU bit for bit. The exit status is 1 if any bit differs.

mod models;

use models::{Numbers, SCENES, Scene};
use rayweave_gpu::{Adapter, Gpu, GpuProgram, GpuReport};
use rayweave_model::drive::{Cancel, drive, thread_count};
use rayweave_model::{Evaluator, FirstHits, RayBatch, Rays, Window};
use rayweave_shape::Ray;
use rayweave_trace::Packets;
use std::fmt::Write as _;
use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

struct Options {
    rays: usize,
    models: Vec<String>,
    adapter: usize,
    out: std::path::PathBuf,
}

/// A row of the table.
struct Row {
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

fn main() -> Result<std::process::ExitCode, Failure> {
    let options = options()?;
    let gpu = Gpu::new();
    let adapter = gpu.adapter(options.adapter)?;
    let threads = thread_count(None);
    let mut rows = Vec::new();
    let mut refused = String::new();
    for (name, make) in SCENES {
        if !options.models.is_empty() && !options.models.iter().any(|wanted| wanted == name) {
            continue;
        }
        let scene = make()?;
        match measure(&scene, adapter, &options) {
            Ok(row) => {
                eprintln!("{}", line(&row));
                rows.push(row);
            }
            Err(problem) => writeln!(refused, "{name}: {problem}")?,
        }
        // complete after every row, so that a run that is cut off leaves what it measured
        let text = page(adapter, threads.get(), &rows, &refused);
        std::fs::write(options.out.join("gpu.md"), &text)?;
        std::fs::write(options.out.join("gpu.json"), json(adapter, threads.get(), &rows))?;
    }
    println!("{}", page(adapter, threads.get(), &rows, &refused));
    let is_equal = rows.iter().all(|row| row.differing == 0) && refused.is_empty();
    Ok(if is_equal { std::process::ExitCode::SUCCESS } else { std::process::ExitCode::FAILURE })
}

fn options() -> Result<Options, Failure> {
    let mut options = Options { rays: 1 << 22, models: Vec::new(), adapter: 0, out: ".".into() };
    let mut arguments = std::env::args().skip(1);
    while let Some(name) = arguments.next() {
        let value = arguments.next().ok_or_else(|| format!("{name} needs a value"))?;
        match name.as_str() {
            "--rays" => options.rays = value.parse()?,
            "--models" => options.models = value.split(',').map(str::to_owned).collect(),
            "--adapter" => options.adapter = value.parse()?,
            "--out" => options.out = value.into(),
            _ => return Err(format!("unknown option {name}").into()),
        }
    }
    std::fs::create_dir_all(&options.out)?;
    Ok(options)
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

fn measure(scene: &Scene, adapter: &Adapter, options: &Options) -> Result<Row, Failure> {
    let clock = Instant::now();
    let gpu = GpuProgram::new(adapter, scene.program.clone())?;
    let compile = clock.elapsed().as_secs_f64();
    let rays = rays(scene, options.rays);
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

fn line(row: &Row) -> String {
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

fn page(adapter: &Adapter, threads: usize, rows: &[Row], refused: &str) -> String {
    let mut text = format!(
        "# Nearest crossings on a GPU\n\nadapter `{}` ({:?}), driver `{}`; CPU: {threads} threads, Packets\n\n\
         Mrays/s: millions of rays per second. Kernel: with rays and answers on the device. Whole: from f64 rays to f64 answers, \
         with upload, download, the f64 kernel of each face and the CPU's rays.\n\n\
         | model | faces | kernel, Mrays/s | whole, Mrays/s | CPU, Mrays/s | uncertain, % | contradicted | differing rays | \
         bytes per ray | tables, MB | compile, s | timed, % | prepare, wait, complete: ns per ray and thread |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
        adapter.name(),
        adapter.kind(),
        adapter.driver(),
    );
    rows.iter().for_each(|row| text += &(line(row) + "\n"));
    if !refused.is_empty() {
        text += &format!("\nNot measured:\n\n{refused}");
    }
    text
}

fn json(adapter: &Adapter, threads: usize, rows: &[Row]) -> String {
    let row = |row: &Row| {
        format!(
            "{{\"model\": {:?}, \"faces\": {}, \"rays\": {}, \"uncertain\": {}, \"timed\": {}, \"distant\": {}, \"contradicted\": {}, \
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
    };
    let rows: Vec<String> = rows.iter().map(row).collect();
    format!(
        "{{\"adapter\": {:?}, \"driver\": {:?}, \"threads\": {threads}, \"rows\": [\n  {}\n]}}\n",
        adapter.name(),
        adapter.driver(),
        rows.join(",\n  ")
    )
}
