//! Photons on a graphics card beside the CPU on all cores, in the same run.
//!
//! ```text
//! cargo bench -p rayweave-photon --features gpu --bench gpu_photons -- [--photons N] [--adapter K]
//! ```
//!
//! The detector is a tank of liquid argon of five nested boxes, the source isotropic light of 128 nm. Hits and counts of both must be
//! equal, else the exit status is 1.

use rayweave_formats::{Format, Options};
use rayweave_gpu::Gpu;
use rayweave_math::Vec3;
use rayweave_model::drive::thread_count;
use rayweave_photon::{
    Detector, PhotonDevice, PhotonDeviceReport, PhotonError, PhotonRun, RunSettings, Source, Torch, simulate,
};
use rayweave_trace::Packets;
use std::process::ExitCode;
use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<ExitCode, Failure> {
    let (mut photons, mut adapter) = (1 << 20, 0);
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    while let Some(name) = arguments.next() {
        let value = arguments.next().ok_or_else(|| format!("{name} needs a value"))?;
        match name.as_str() {
            "--photons" => photons = value.parse()?,
            "--adapter" => adapter = value.parse()?,
            _ => return Err(format!("unknown option {name}").into()),
        }
    }
    let imported =
        rayweave_formats::parse(include_str!("argon.gdml"), Format::Gdml, &[], &Options::default())?;
    let detector = Detector::new(&imported.scene, &imported.document())?;
    let evaluator = Packets::new(detector.program().clone());
    let source = Source::Torch(Torch::point(Vec3::new(300.0, 20.0, -10.0), 128.0)?);
    let settings = RunSettings { seed: 1, ..RunSettings::new(0..photons) };
    let gpu = Gpu::new();
    let adapter = gpu.adapter(adapter)?;
    let device = PhotonDevice::new(adapter, &detector)?;
    let run = || -> Result<_, PhotonError> {
        let (mut total, mut report) = (PhotonRun::default(), PhotonDeviceReport::default());
        let begin = Instant::now();
        device.simulate_parts(&detector, &evaluator, &source, &settings, &mut report, |part| {
            total.append(part.run);
            Ok::<(), PhotonError>(())
        })?;
        Ok((total, report, begin.elapsed().as_secs_f64()))
    };
    // the first run allocates memory
    run()?;
    let (own, report, seconds) = run()?;
    let begin = Instant::now();
    let cpu = simulate(&detector, &evaluator, &source, &settings)?;
    let cpu_seconds = begin.elapsed().as_secs_f64();
    if let Some(problem) = &report.problem {
        println!("{problem}");
    }
    println!("five boxes of liquid argon, {photons} photons, {} steps, {} hits", cpu.steps, cpu.hits.len());
    let row = |name: &str, seconds: f64| {
        let rates = [photons, cpu.steps].map(|count| count as f64 / seconds);
        println!("{name}: {seconds:.3} s, {:.3e} photons/s, {:.3e} steps/s", rates[0], rates[1]);
    };
    row(&format!("{} ({})", adapter.name(), adapter.driver()), seconds);
    row(&format!("CPU, {} threads", thread_count(None)), cpu_seconds);
    println!("finished by the CPU: {} photons; equal: {}", report.handed_back, own == cpu);
    Ok(if own == cpu && report.problem.is_none() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
