//! Hashes of light: segments of optical models, and data of lens prescriptions.

use crate::files::{listed, stem};
use crate::hash::Hash;
use crate::{Answers, root};
use rayweave::Packets;
use rayweave::lens::analysis::{Spot, Study, hexapolar};
use rayweave::lens::prescription::{Prescription, read_zmx};
use rayweave::optics::file::optics_of;
use rayweave::optics::{Branches, Emitter, Segments, System, TraceSettings, Tracer};
use rayweave::scene::load;
use std::fs;
use std::path::PathBuf;

pub fn record(answers: &mut Answers) {
    let mut models: Vec<PathBuf> = listed(&root().join("models/optics"), "toml");
    models.push(root().join("models/doublet.toml"));
    for path in models {
        let (document, scene) = load(&path, &[]).unwrap();
        let optics = optics_of(&document, &scene).unwrap();
        let system = optics.assembly.compile().unwrap();
        for polarised in [false, true] {
            for (branches, name) in
                [(Branches::Both, "both"), (Branches::Random, "random"), (Branches::Ideal, "ideal")]
            {
                let settings = TraceSettings {
                    branches,
                    polarised,
                    seed: 5,
                    threshold: 1e-4,
                    ..optics.settings.clone()
                };
                let hash = traced(&system, &optics.sources, &settings);
                answers.add(&format!("light/{}/{name}/{polarised}", stem(&path)), hash);
            }
        }
    }
    for path in listed(&root().join("models/optics"), "zmx") {
        let lens = read_zmx(&fs::read(&path).unwrap()).unwrap().prescription;
        answers.add(&format!("light/lens/{}", stem(&path)), prescribed(&lens));
    }
}

fn traced(system: &System, light: &impl Emitter, settings: &TraceSettings) -> Hash {
    let mut hash = Hash::new();
    let trace = Tracer::new(system, Packets::new).trace(light, settings).unwrap();
    segments(&mut hash, &trace.segments);
    let balance = &trace.balance;
    hash.numbers([&balance.emitted, &balance.absorbed_in_media, &balance.escaped, &balance.dropped]);
    hash.numbers(&balance.absorbed);
    hash
}

fn segments(hash: &mut Hash, segments: &Segments) {
    let whole = segments.id.iter().chain(&segments.parent);
    whole.for_each(|value| hash.bytes(&value.to_le_bytes()));
    let columns = [&segments.wavelength_nm, &segments.intensity, &segments.index, &segments.path];
    columns.into_iter().for_each(|column| hash.numbers(column));
    let vectors = segments.start.iter().chain(&segments.end).chain(&segments.direction);
    vectors.for_each(|column| hash.numbers(column));
    segments.generation.iter().chain(&segments.source).for_each(|value| hash.count(u64::from(*value)));
    segments.element.iter().chain(&segments.surface).for_each(|value| hash.bytes(&value.to_le_bytes()));
    hash.bytes(&segments.event);
}

/// First-order data, Seidel sums, spots and segments of all fields.
fn prescribed(lens: &Prescription) -> Hash {
    let mut hash = Hash::new();
    let first = lens.first_order(lens.primary_nm()).unwrap();
    hash.number(first.focal_length);
    for parts in lens.seidel().iter().flatten() {
        hash.numbers([&parts.spherical, &parts.coma, &parts.astigmatism, &parts.petzval, &parts.distortion]);
    }
    let layout = lens.assembly().unwrap();
    let system = layout.assembly.compile().unwrap();
    let tracer = Tracer::new(&system, Packets::new);
    let study = Study::new(lens, &layout, &tracer);
    for field in 0..lens.fields.len() {
        let spot = study.polychromatic(field, &hexapolar(4)).ok().and_then(|arrivals| Spot::of(&arrivals));
        match spot {
            Some(spot) => hash.numbers(spot.centroid.iter().chain([&spot.rms, &spot.geometric])),
            None => hash.bytes(b"no ray arrives"),
        }
        let beam = lens.beam(field, lens.primary_nm(), &hexapolar(3)).unwrap();
        let trace =
            tracer.trace(&beam, &TraceSettings { threshold: 1e-3, ..TraceSettings::default() }).unwrap();
        segments(&mut hash, &trace.segments);
        if let Ok(wavefront) = study.wavefront(field, lens.primary_nm(), &hexapolar(3)) {
            hash.numbers([&wavefront.rms_about_chief_ray(), &wavefront.peak_to_valley()]);
        }
    }
    hash
}
