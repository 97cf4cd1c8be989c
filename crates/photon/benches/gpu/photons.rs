//! Photons in a detector on a graphics card and on the CPU.

use crate::Failure;
use crate::detectors::Case;
use rayweave_formats::{Format, Options};
use rayweave_gpu::Adapter;
use rayweave_math::Vec3;
use rayweave_photon::{
    Detector, PhotonDevice, PhotonDeviceReport, PhotonError, PhotonRun, RunSettings, Source, Torch, simulate,
};
use rayweave_trace::Packets;
use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

/// A row of the table.
pub struct Row {
    name: String,
    report: PhotonDeviceReport,
    steps: u64,
    hits: usize,
    is_equal: bool,
    compile: f64,
    seconds: f64,
    cpu_seconds: f64,
}

impl Row {
    /// True if the device simulated all photons, with the results of the CPU.
    pub fn is_right(&self) -> bool {
        self.is_equal && self.report.problem.is_none()
    }
}

/// The head of the table.
pub const HEAD: &str = "
## Photons

From the source to hits and counts, with emission, transfers and what the CPU finishes. Steps/s counts the steps of the CPU. Emit, \
wait and complete: milliseconds, summed over the batches.

| detector | photons | steps | hits | photons/s | steps/s | CPU, photons/s | CPU, steps/s | ratio | uncertain, % | bytes per photon | \
equal | compile, s | emit, wait, complete |
|---|---|---|---|---|---|---|---|---|---|---|---|---|---|
";

/// Simulates the photons of a detector twice on the device, since the first run allocates memory, and on the CPU.
pub fn measure(
    case: &Case,
    adapter: &Adapter,
    (photons, in_flight): (u64, NonZeroUsize),
) -> Result<Row, Failure> {
    let photons = (photons / case.share).max(1);
    let imported = rayweave_formats::parse(&case.gdml, Format::Gdml, &[], &Options::default())?;
    let detector = Detector::new(&imported.scene, &imported.document())?;
    let evaluator = Packets::new(detector.program().clone());
    let source = Source::Torch(Torch::point(Vec3::from_array(case.at), case.wavelength_nm)?);
    let settings = RunSettings { seed: 1, ..RunSettings::new(0..photons) };
    let clock = Instant::now();
    let device = PhotonDevice::new(adapter, &detector)?.with_batches_in_flight(in_flight);
    let compile = clock.elapsed().as_secs_f64();
    let run = || -> Result<_, PhotonError> {
        let (mut total, mut report) = (PhotonRun::default(), PhotonDeviceReport::default());
        let clock = Instant::now();
        device.simulate_parts(&detector, &evaluator, &source, &settings, &mut report, |part| {
            total.append(part.run);
            Ok::<(), PhotonError>(())
        })?;
        Ok((total, report, clock.elapsed().as_secs_f64()))
    };
    run()?;
    let (own, report, seconds) = run()?;
    let clock = Instant::now();
    let cpu = simulate(&detector, &evaluator, &source, &settings)?;
    let cpu_seconds = clock.elapsed().as_secs_f64();
    if let Some(problem) = &report.problem {
        eprintln!("{}: {problem}", case.name);
    }
    Ok(Row {
        name: case.name.clone(),
        report,
        steps: cpu.steps,
        hits: cpu.hits.len(),
        is_equal: own == cpu,
        compile,
        seconds,
        cpu_seconds,
    })
}

/// A line of the table.
pub fn line(row: &Row) -> String {
    let Row { name, report, steps, hits, is_equal, compile, seconds, cpu_seconds } = row;
    let photons = report.photons.max(1) as f64;
    let milliseconds = |time: Duration| 1e3 * time.as_secs_f64();
    format!(
        "| {name} | {} | {steps} | {hits} | {:.3e} | {:.3e} | {:.3e} | {:.3e} | {:.2} | {:.3} | {:.0} | {is_equal} | {compile:.2} | {:.0}, {:.0}, {:.0} |",
        report.photons,
        photons / seconds,
        *steps as f64 / seconds,
        photons / cpu_seconds,
        *steps as f64 / cpu_seconds,
        cpu_seconds / seconds,
        100.0 * report.handed_back as f64 / photons,
        report.bytes as f64 / photons,
        milliseconds(report.emit),
        milliseconds(report.device),
        milliseconds(report.complete),
    )
}

/// A row as JSON.
pub fn json(row: &Row) -> String {
    let Row { name, report, steps, hits, is_equal, compile, seconds, cpu_seconds } = row;
    let PhotonDeviceReport { photons, handed_back, steps: own, bytes, .. } = report;
    format!(
        "  {{\"detector\": {name:?}, \"photons\": {photons}, \"steps\": {steps}, \"device_steps\": {own}, \"hits\": {hits}, \
         \"handed_back\": {handed_back}, \"bytes\": {bytes}, \"equal\": {is_equal}, \"compile_seconds\": {compile:.4}, \
         \"seconds\": {seconds:.4}, \"cpu_seconds\": {cpu_seconds:.4}}}"
    )
}
