//! The same photons have the same histories, however a run is divided.

use crate::{CLEAR, SlabDetector, run};
use rayweave_math::Vec3;
use rayweave_photon::{Hits, RunSettings, Source, Torch};
use std::num::NonZeroUsize;

fn scattering() -> SlabDetector<'static> {
    SlabDetector {
        matrices: r#"<matrix name="LENGTH" coldim="2" values="1*eV 60 10*eV 60"/>"#,
        inner: r#"<property name="RINDEX" ref="GLASS"/><property name="RAYLEIGH" ref="LENGTH"/>
<property name="ABSLENGTH" ref="LENGTH"/>"#,
        surfaces: r#"<opticalsurface name="S" model="unified" finish="ground" type="dielectric_dielectric" value="0.2">
<property name="REFLECTIVITY" ref="HALF"/><property name="EFFICIENCY" ref="HALF"/></opticalsurface>"#,
        links: r#"<skinsurface name="skin" surfaceproperty="S"><volumeref ref="Slab"/></skinsurface>"#,
        ..CLEAR
    }
}

#[test]
fn threads_and_ranges_change_nothing() {
    let detector = scattering().build();
    let source = Source::Torch(Torch::point(Vec3::new(1.0, 2.0, 30.0), 420.0).unwrap());
    let settings = |range, threads| RunSettings {
        seed: 5,
        threads: NonZeroUsize::new(threads),
        ..RunSettings::new(range)
    };
    let whole = run(&detector, &source, &settings(0..10_000, 1));
    assert!(whole.hits.len() > 300, "{}", whole.hits.len());
    assert_eq!(run(&detector, &source, &settings(0..10_000, 3)), whole);
    let (mut photons, mut steps, mut rows) = (0, 0, Vec::new());
    for range in [0..1, 1..4097, 4097..9000, 9000..10_000] {
        let part = run(&detector, &source, &settings(range, 2));
        photons += part.photons;
        steps += part.steps;
        rows.extend(lines(&part.hits));
    }
    assert_eq!((photons, steps), (whole.photons, whole.steps));
    assert_eq!(rows, lines(&whole.hits));
    let other = run(&detector, &source, &RunSettings { seed: 6, ..settings(0..10_000, 1) });
    assert_ne!(other.hits, whole.hits);
}

/// Photons that a shifter emits in addition keep their place next to the others of their number, however a run is divided.
#[test]
fn ranges_of_shifted_photons_are_parts_of_the_run() {
    let slab = SlabDetector {
        matrices: r#"<matrix name="SHORT" coldim="2" values="1*eV 1e12 2.9*eV 1e12 2.95*eV 0.1 10*eV 0.1"/>
<matrix name="BAND" coldim="2" values="2.0*eV 1 2.5*eV 1"/><matrix name="MEAN" coldim="1" values="3"/>"#,
        inner: r#"<property name="RINDEX" ref="GLASS"/><property name="WLSABSLENGTH" ref="SHORT"/>
<property name="WLSCOMPONENT" ref="BAND"/><property name="WLSMEANNUMBERPHOTONS" ref="MEAN"/>"#,
        ..scattering()
    };
    let detector = slab.build();
    let source = Source::Torch(Torch::point(Vec3::new(1.0, 2.0, 30.0), 400.0).unwrap());
    let whole = run(&detector, &source, &RunSettings::new(0..1000));
    // one photon for each with the probability exp(-3) of none
    assert!(whole.photons > 2500 && whole.photons < 3500, "{}", whole.photons);
    let parts = [0..300, 300..301, 301..1000].map(|range| run(&detector, &source, &RunSettings::new(range)));
    let rows: Vec<_> = parts.iter().flat_map(|part| lines(&part.hits)).collect();
    assert!(rows.len() > 200, "{}", rows.len());
    assert_eq!(rows, lines(&whole.hits));
    assert!(whole.hits.photon.iter().all(|number| (0..1000).contains(number)));
}

/// A shifter that emits four billion photons is refused before they are made, and so are numbers that secondaries use.
#[test]
#[cfg(target_os = "linux")]
fn photons_that_do_not_fit_into_memory_are_refused() {
    let slab = SlabDetector {
        matrices: r#"<matrix name="SHORT" coldim="2" values="1*eV 0.1 10*eV 0.1"/>
<matrix name="BAND" coldim="2" values="2.0*eV 1 2.5*eV 1"/><matrix name="MEAN" coldim="1" values="4e9"/>"#,
        inner: r#"<property name="RINDEX" ref="GLASS"/><property name="WLSABSLENGTH" ref="SHORT"/>
<property name="WLSCOMPONENT" ref="BAND"/><property name="WLSMEANNUMBERPHOTONS" ref="MEAN"/>"#,
        ..scattering()
    };
    let detector = slab.build();
    let source = Source::Torch(Torch::point(Vec3::new(1.0, 2.0, 30.0), 400.0).unwrap());
    let evaluator = rayweave_trace::Packets::new(detector.program().clone());
    let refused = |photons| {
        let settings = RunSettings { threads: NonZeroUsize::new(1), ..RunSettings::new(photons) };
        rayweave_photon::simulate(&detector, &evaluator, &source, &settings).unwrap_err().to_string()
    };
    let message = refused(0..1);
    assert!(message.starts_with("the photons and their hits cannot be kept: "), "{message}");
    assert!(message.ends_with(" Simulate parts of the range one after the other."), "{message}");
    let message = refused(u64::MAX - 5000..u64::MAX);
    assert!(message.contains("an event has at most 4294967296 photons"), "{message}");
}

/// The bits of each hit.
fn lines(hits: &Hits) -> Vec<(i64, [u64; 5], String)> {
    let bits = |row: usize| {
        let values = [
            hits.position[0][row],
            hits.position[2][row],
            hits.time[row],
            hits.direction[1][row],
            hits.polarisation[2][row],
        ];
        (hits.photon[row], values.map(f64::to_bits), hits.paths()[hits.sensor[row] as usize].to_string())
    };
    (0..hits.len()).map(bits).collect()
}
