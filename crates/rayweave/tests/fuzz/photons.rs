//! Fuzz target: bytes as optical properties of a detector, as gensteps, photons, spectra, and tables of two runs.

use rayweave::Packets;
use rayweave::photon::{
    CompareOptions, Detector, Genstep, GenstepNumbers, Gensteps, LinearDensity, Origin, PhotonError,
    RunSettings, Source, Torch, WavelengthDistribution, compare, gensteps_from_array, photons_from_opticks,
    read_sample, simulate,
};
use rayweave::scene::parse;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;

/// A bar with a photodiode at its end, without optical properties.
const BAR: &str = "\
rayweave = 1
[solid.hall]
box = { size = [200, 200, 200] }
[solid.bar]
box = { size = [20, 20, 100] }
[solid.diode]
box = { size = [20, 20, 1] }
transform = [{ translate = [0, 0, 50.5] }]
[[region]]
solid = 'hall'
medium = 'opaque'
[[region]]
solid = 'bar'
medium = 'crystal'
[[region]]
solid = 'diode'
medium = 'opaque'
[medium.opaque]
[medium.crystal]
";

/// Properties for light and for gensteps.
const CRYSTAL: &str = "\
[photons.medium.crystal]
RINDEX = 1.79
SCINTILLATIONCOMPONENT1 = { eV = [2, 3], value = [1, 1] }
SCINTILLATIONYIELD1 = 1
SCINTILLATIONTIMECONSTANT1 = 5
[photons.sensor]
diode = 'photodiode'
";

/// The property: what is not rejected with a reason can be simulated, with finite hits; a run that is compared with itself has
/// no differences.
pub fn run(data: &[u8]) {
    let Some((&first, rest)) = data.split_first() else { return };
    let text = || String::from_utf8_lossy(rest);
    let doubles =
        || -> Vec<f64> { rest.as_chunks::<8>().0.iter().map(|&bits| f64::from_le_bytes(bits)).collect() };
    let singles =
        || -> Vec<f32> { rest.as_chunks::<4>().0.iter().map(|&bits| f32::from_le_bytes(bits)).collect() };
    match first % 6 {
        0 => properties(&text()),
        1 => {
            let numbers = singles();
            let numbers = &numbers[..numbers.len() / 24 * 24];
            gensteps(gensteps_from_array(&[numbers.len() / 24, 6, 4], GenstepNumbers::Single(numbers)));
        }
        2 => {
            let numbers = doubles();
            let numbers = &numbers[..numbers.len() / 16 * 16];
            gensteps(gensteps_from_array(&[numbers.len() / 16, 16], GenstepNumbers::Double(numbers)));
        }
        3 => photons(&singles()),
        4 => spectrum(&doubles()),
        _ => table(rest, if first % 12 < 6 { "csv" } else { "npy" }),
    }
}

fn refuse<T>(result: Result<T, PhotonError>) -> Option<T> {
    result.inspect_err(|error| assert!(!error.to_string().is_empty())).ok()
}

/// The detector whose properties are `text`.
fn detector(text: &str) -> Option<Detector> {
    let (document, scene) = parse(&format!("{BAR}{text}")).ok()?;
    refuse(Detector::new(&scene, &document))
}

fn traced(detector: &Detector, source: &Source) {
    let count = match source {
        Source::Gensteps(steps) => steps.photons(),
        Source::Photons(photons) => photons.len() as u64,
        Source::Torch(_) => u64::MAX,
    };
    let mut settings = RunSettings::new(0..count.min(20));
    settings.threads = NonZeroUsize::new(1);
    settings.max_steps = 100;
    let evaluator = Packets::new(detector.program().clone());
    let Some(run) = refuse(simulate(detector, &evaluator, source, &settings)) else { return };
    let hits = &run.hits;
    let vectors = [&hits.position, &hits.direction, &hits.polarisation];
    for column in vectors.into_iter().flatten().chain([&hits.time, &hits.wavelength_nm]) {
        assert!(column.iter().all(|number| number.is_finite()), "{hits:?}");
    }
}

fn properties(text: &str) {
    // no input that refers to other files
    if text.contains("file") {
        return;
    }
    let Some(detector) = detector(text) else { return };
    let torch = Torch::new(Origin::Point(rayweave::Vec3::ZERO), WavelengthDistribution::Single(420.0));
    traced(&detector, &Source::Torch(torch.expect("a point and a wavelength")));
}

fn gensteps(read: Result<Vec<Genstep>, PhotonError>) {
    let Some(steps) = refuse(read) else { return };
    let detector = detector(CRYSTAL).expect("a detector");
    let evaluator = Packets::new(detector.program().clone());
    if let Some(steps) = refuse(Gensteps::new(&detector, &evaluator, &steps, &BTreeMap::new())) {
        traced(&detector, &Source::Gensteps(steps));
    }
}

fn photons(numbers: &[f32]) {
    let complete = &numbers[..numbers.len() / 16 * 16];
    let numbers: Vec<f64> = complete.iter().map(|&number| f64::from(number)).collect();
    if let Some(photons) = refuse(photons_from_opticks(&[numbers.len() / 16, 4, 4], &numbers)) {
        traced(&detector(CRYSTAL).expect("a detector"), &Source::Photons(photons));
    }
}

fn spectrum(numbers: &[f64]) {
    let points =
        numbers.as_chunks::<2>().0.iter().map(|&[wavelength, density]| (wavelength, density)).collect();
    if let Ok(density) = LinearDensity::new(points) {
        let torch = Torch::new(Origin::Point(rayweave::Vec3::ZERO), WavelengthDistribution::Density(density));
        if let Some(torch) = refuse(torch) {
            traced(&detector(CRYSTAL).expect("a detector"), &Source::Torch(torch));
        }
    }
}

fn table(data: &[u8], ending: &str) {
    let thread = format!("{:?}", std::thread::current().id()).replace(|c: char| !c.is_ascii_digit(), "");
    let name = format!("rayweave-fuzz-photons-{}-{thread}.{ending}", std::process::id());
    let path = std::env::temp_dir().join(name);
    std::fs::write(&path, data).unwrap();
    let read = read_sample(&path);
    std::fs::remove_file(&path).unwrap();
    let Some(sample) = refuse(read) else { return };
    if let Some(same) = refuse(compare(&sample, &sample, &CompareOptions::default())) {
        assert!(same.quantities.iter().all(|quantity| quantity.z.abs() < 5.0), "{same:?}");
        assert!(same.pairs.is_none_or(|pairs| pairs.first_difference.is_none()));
    }
}
