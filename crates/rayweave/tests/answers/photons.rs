//! Hashes of optical photons: hits, ways of ending and events at surfaces in small detectors.

use crate::files::{listed, stem};
use crate::hash::Hash;
use crate::{Answers, root};
use rayweave::formats::{Format, Options, parse};
use rayweave::photon::{Detector, PhotonRun, RunSettings, Source, Torch, simulate};
use rayweave::{Packets, Vec3};
use std::fs;

/// The point source in each detector: x and y in mm, the wavelength in nm and the number of photons.
fn source(name: &str) -> ([f64; 2], f64, u64) {
    match name {
        "argon" => ([0.0; 2], 128.0, 200),
        "crystals" => ([10.5; 2], 550.0, 1000),
        "phototubes" => ([0.0; 2], 420.0, 2000),
        _ => ([0.0; 2], 413.3, 2000),
    }
}

pub fn record(answers: &mut Answers) {
    for path in listed(&root().join("crates/rayweave/tests/answers/photons"), "gdml") {
        let name = stem(&path);
        let ([x, y], wavelength, count) = source(&name);
        let text = fs::read_to_string(&path).unwrap();
        let imported = parse(&text, Format::Gdml, &[], &Options::default()).unwrap();
        let detector = Detector::new(&imported.scene, &imported.document()).unwrap();
        let torch = Torch::point(Vec3::new(x, y, 0.0), wavelength).unwrap();
        let settings = RunSettings { max_steps: 1000, ..RunSettings::new(0..count) };
        let packets = Packets::new(detector.program().clone());
        let run = simulate(&detector, &packets, &Source::Torch(torch), &settings).unwrap();
        answers.add(&format!("photon/{name}"), hashed(&run));
    }
}

fn hashed(run: &PhotonRun) -> Hash {
    let (mut hash, hits) = (Hash::new(), &run.hits);
    [run.photons, run.steps].into_iter().for_each(|count| hash.count(count));
    for column in [&hits.event, &hits.photon, &hits.steps] {
        column.iter().for_each(|&value| hash.count(value as u64));
    }
    for columns in [&hits.position, &hits.direction, &hits.polarisation] {
        columns.iter().for_each(|column| hash.numbers(column));
    }
    hash.numbers(&hits.time);
    hash.numbers(&hits.wavelength_nm);
    for &sensor in &hits.sensor {
        hash.bytes(hits.paths()[sensor as usize].as_bytes());
    }
    run.ends.values().for_each(|&count| hash.count(count));
    run.boundary_events.values().for_each(|&count| hash.count(count));
    hash
}
