//! Absorption, scattering and wavelength shifting in a material.

use crate::history::record;
use crate::{CLEAR, SlabDetector, assert_binomial, assert_distribution, beam, count, run, settings, uniform};
use rayweave_math::Vec3;
use rayweave_photon::property::LIGHT_SPEED;
use rayweave_photon::{End, Process, RunSettings, Source, StepRow, TimeProfile, Torch};
use std::f64::consts::PI;

const COUNT: usize = 20_000;

/// The law of Beer and Lambert: 1 - exp(-100 / 50) of the photons end in a slab of 100 mm.
#[test]
fn absorption_is_exponential() {
    let slab = SlabDetector {
        matrices: r#"<matrix name="LENGTH" coldim="2" values="1*eV 50 10*eV 50"/>"#,
        inner: r#"<property name="RINDEX" ref="ONE"/><property name="ABSLENGTH" ref="LENGTH"/>"#,
        ..CLEAR
    };
    let run = run(&slab.build(), &beam(COUNT, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), &settings(COUNT));
    assert_binomial(count(&run, End::Absorbed), COUNT as u64, 1.0 - (-2f64).exp(), "absorbed");
    assert_eq!(count(&run, End::Absorbed) + count(&run, End::Escaped), COUNT as u64);
}

/// Photons that are scattered at least once leave the axis; those that are not escape straight ahead, with the
/// probability exp(-100 / 80) for a mean free path of 80 mm.
#[test]
fn scattering_has_its_mean_free_path() {
    for name in ["RAYLEIGH", "MIEHG"] {
        let inner = format!(
            r#"<property name="RINDEX" ref="ONE"/><property name="{name}" ref="LENGTH"/>
            <property name="MIEHG_FORWARD_RATIO" ref="R"/>"#
        );
        let slab = SlabDetector {
            matrices: r#"<matrix name="LENGTH" coldim="2" values="1*eV 80 10*eV 80"/><matrix name="R" coldim="1" values="1"/>"#,
            inner: &inner,
            auxiliary: "",
            ..CLEAR
        };
        let run = run(&slab.build(), &beam(COUNT, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), &settings(COUNT));
        // three steps without scattering: to the slab, through it, and out of the world
        let straight = 3 * COUNT as u64;
        assert!(run.steps > straight, "{name}");
        assert_eq!(count(&run, End::Escaped), COUNT as u64);
        // each scattering adds a step; a first-order check of the number of photons that scatter at all is the step count
        // of a slab so thin that none scatters twice
        let thin = SlabDetector {
            matrices: r#"<matrix name="LENGTH" coldim="2" values="1*eV 1e4 10*eV 1e4"/><matrix name="R" coldim="1" values="1"/>"#,
            ..slab
        };
        let run = crate::run(&thin.build(), &beam(COUNT, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), &settings(COUNT));
        // 1 % scatter once within 100 mm of a free path of 10 m; of those a few scatter again on longer ways
        assert_binomial(run.steps - straight, COUNT as u64, 0.01, name);
    }
}

/// The re-emission probability of Opticks as two absorption lengths, L/(1-p) and L/p: photons of a source go the mean distance L,
/// and each is re-emitted n times with the probability (1-p) p^n, p/(1-p) times on average with the variance p/(1-p)^2.
#[test]
fn a_probability_of_reemission_is_two_lengths() {
    let (length, probability) = (4.0, 0.6);
    let matrices = format!(
        r#"<matrix name="ABSORBED" coldim="2" values="1*eV {0} 10*eV {0}"/><matrix name="SHIFTED" coldim="2" values="1*eV {1} 10*eV {1}"/>
<matrix name="EMITTED" coldim="2" values="2*eV 1 2.5*eV 1"/>"#,
        length / (1.0 - probability),
        length / probability
    );
    let inner = r#"<property name="RINDEX" ref="ONE"/><property name="ABSLENGTH" ref="ABSORBED"/>
<property name="WLSABSLENGTH" ref="SHIFTED"/><property name="WLSCOMPONENT" ref="EMITTED"/>"#;
    let slab = SlabDetector { matrices: &matrices, inner, ..CLEAR };
    let middle = Vec3::new(0.0, 0.0, 50.0);
    let source = Source::Torch(Torch::point(middle, 420.0).unwrap());
    let (run, histories) = record(&slab.build(), &source, &settings(COUNT));
    assert!(count(&run, End::Absorbed) + 5 > COUNT as u64);
    let mean = histories.processes[&Process::Reemission] as f64 / COUNT as f64;
    let expected = probability / (1.0 - probability);
    let deviation = (probability / COUNT as f64).sqrt() / (1.0 - probability);
    assert!((mean - expected).abs() < 5.0 * deviation, "{mean}, expected {expected}");
    let first = histories.steps.iter().filter(|row| row.track == row.photon && row.step == 1);
    let paths = first.map(|row| (row.position - middle).length()).collect();
    assert_distribution(paths, |path| 1.0 - (-path / length).exp(), "path");
}

/// Wavelength shifting: absorption, and emission of one photon of a lower energy after the time constant.
#[test]
fn shifted_photons_have_the_emission_spectrum() {
    let slab = SlabDetector {
        matrices: r#"<matrix name="SHORT" coldim="2" values="1*eV 1 2.9*eV 1 2.95*eV 1e12 2.96*eV 1e-6 10*eV 1e-6"/>
<matrix name="BAND" coldim="2" values="2.0*eV 1 2.5*eV 1"/><matrix name="TIME" coldim="1" values="2.5"/>
<matrix name="LONG" coldim="2" values="1*eV 1e12 2.9*eV 1e12 2.95*eV 1e12 2.96*eV 1e-6 10*eV 1e-6"/>"#,
        outer: r#"<property name="RINDEX" ref="ONE"/>"#,
        inner: r#"<property name="RINDEX" ref="ONE"/><property name="WLSABSLENGTH" ref="LONG"/>
<property name="WLSCOMPONENT" ref="BAND"/><property name="WLSTIMECONSTANT" ref="TIME"/>"#,
        surfaces: r#"<opticalsurface name="Edge" model="unified" finish="polished" type="dielectric_metal" value="0">
<property name="REFLECTIVITY" ref="ZERO"/><property name="EFFICIENCY" ref="ONE"/></opticalsurface>
<opticalsurface name="Open" model="unified" finish="polished" type="dielectric_dielectric" value="0"/>"#,
        // out of the slab every photon is detected, into it none
        links: r#"<bordersurface name="in" surfaceproperty="Open"><physvolref ref="World"/><physvolref ref="slab"/></bordersurface>
<skinsurface name="out" surfaceproperty="Edge"><volumeref ref="World"/></skinsurface>"#,
        ..CLEAR
    };
    let mut light = beam(COUNT, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    if let rayweave_photon::Source::Photons(photons) = &mut light {
        // inside the slab, so that they are not detected on the way in
        photons.iter_mut().for_each(|photon| photon.position.z = 50.0);
    }
    let run = run(&slab.build(), &light, &settings(COUNT));
    let hits = &run.hits;
    assert_eq!(hits.len(), COUNT);
    let (least, most) = hits.wavelength_nm.iter().fold((f64::MAX, 0f64), |(a, b), &w| (a.min(w), b.max(w)));
    // from 2.5 eV to 2 eV
    assert!((495.93..496.1).contains(&least) && (619.7..619.93).contains(&most), "{least} {most}");
    // uniform between 2 and 2.5 eV: mean 2.25 eV
    let mean = hits.wavelength_nm.iter().map(|w| property_energy(*w)).sum::<f64>() / COUNT as f64;
    let error = 0.5 / 12f64.sqrt() / (COUNT as f64).sqrt();
    assert!((mean - 2.25).abs() < 5.0 * error, "{mean}");
    // delayed by 2.5 ns, then at least 50 mm of flight
    assert!(hits.time.iter().all(|time| *time > 2.5 + 49.9 / LIGHT_SPEED));
}

fn property_energy(wavelength_nm: f64) -> f64 {
    1e6 * rayweave_photon::property::HC_MEV_NM / wavelength_nm
}

/// The first process of each photon that starts at the lower face of a slab, along z with the polarisation along x.
fn first_rows(slab: &SlabDetector<'_>) -> Vec<StepRow> {
    first_rows_with(slab, TimeProfile::Delta)
}

fn first_rows_with(slab: &SlabDetector<'_>, wls_time_profile: TimeProfile) -> Vec<StepRow> {
    let mut light = beam(COUNT, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    if let rayweave_photon::Source::Photons(photons) = &mut light {
        photons.iter_mut().for_each(|photon| photon.position.z = 1e-9);
    }
    let settings = RunSettings { max_steps: 1, wls_time_profile, ..settings(COUNT) };
    let (_, histories) = record(&slab.build(), &light, &settings);
    let is_first = |row: &&StepRow| row.step == 1 && !matches!(row.process, Process::End(End::StepLimit));
    histories.steps.iter().filter(is_first).copied().collect()
}

/// A slab of one material property with a length, an index of 1, and constants of Mie scattering.
fn process(name: &str, length: f64, constants: [f64; 3]) -> Vec<StepRow> {
    let [forward, backward, ratio] = constants;
    let matrices = format!(
        r#"<matrix name="LENGTH" coldim="2" values="1*eV {length} 10*eV {length}"/>
<matrix name="BAND" coldim="2" values="2.0*eV 1 2.5*eV 1"/>
<matrix name="F" coldim="1" values="{forward}"/><matrix name="B" coldim="1" values="{backward}"/>
<matrix name="R" coldim="1" values="{ratio}"/>"#
    );
    let inner = format!(
        r#"<property name="RINDEX" ref="ONE"/><property name="{name}" ref="LENGTH"/>
<property name="WLSCOMPONENT" ref="BAND"/><property name="MIEHG_FORWARD" ref="F"/>
<property name="MIEHG_BACKWARD" ref="B"/><property name="MIEHG_FORWARD_RATIO" ref="R"/>"#
    );
    first_rows(&SlabDetector { matrices: &matrices, inner: &inner, ..CLEAR })
}

/// Each process acts after an exponential path: on 1 - exp(-100 / 80) of the photons in the slab, and at the depth of that
/// distribution.
#[test]
fn free_paths_are_exponential() {
    for (name, expected) in [
        ("ABSLENGTH", Process::End(End::Absorbed)),
        ("RAYLEIGH", Process::Rayleigh),
        ("MIEHG", Process::Mie),
        ("WLSABSLENGTH", Process::Reemission),
    ] {
        let rows = process(name, 80.0, [0.5, 0.0, 1.0]);
        let inside: Vec<f64> =
            rows.iter().filter(|row| row.process == expected).map(|row| row.position.z).collect();
        let part = 1.0 - (-100f64 / 80.0).exp();
        assert_binomial(inside.len() as u64, COUNT as u64, part, name);
        assert_distribution(inside, |z| (1.0 - (-z / 80.0).exp()) / part, name);
    }
}

/// Rayleigh scattering of polarised light is the radiation of a dipole: the density 3/8 (1 + c^2) of the cosine to the direction,
/// 3/4 (1 - x^2) of the cosine to the polarisation. The new polarisation is in the plane of the old one and the new direction.
#[test]
fn rayleigh_scattering_is_the_radiation_of_a_dipole() {
    let rows = process("RAYLEIGH", 1e-3, [0.0; 3]);
    let component = |axis: usize| rows.iter().map(|row| row.direction[axis]).collect::<Vec<f64>>();
    assert_distribution(component(2), |c| 0.375 * (c + c.powi(3) / 3.0) + 0.5, "cosine to the direction");
    assert_distribution(component(0), |x| 0.75 * (x - x.powi(3) / 3.0) + 0.5, "cosine to the polarisation");
    for row in &rows {
        assert!(row.polarisation.dot(row.direction).abs() < 1e-12);
        assert!(row.polarisation.dot(row.direction.cross(Vec3::X)).abs() < 1e-9, "{row:?}");
    }
    let same = rows.iter().filter(|row| row.polarisation.x > 0.0).count() as u64;
    assert_binomial(same, COUNT as u64, 0.5, "sign of the polarisation");
}

/// The phase function of Henyey and Greenstein: the part (1 - g^2) / (2 g) (1 / sqrt(1 + g^2 - 2 g c) - 1 / (1 + g)) below a cosine c,
/// and its mirror image for the backward lobe.
#[test]
fn mie_scattering_has_its_phase_function() {
    let below = |g: f64, c: f64| {
        (1.0 - g * g) / (2.0 * g) * (1.0 / (1.0 + g * g - 2.0 * g * c).sqrt() - 1.0 / (1.0 + g))
    };
    for [forward, backward, ratio] in [[0.9, 0.2, 1.0], [0.6, 0.3, 0.8], [0.6, 0.9, 0.0]] {
        let rows = process("MIEHG", 1e-3, [forward, backward, ratio]);
        let distribution = |c: f64| ratio * below(forward, c) + (1.0 - ratio) * (1.0 - below(backward, -c));
        let what = format!("{forward}, {backward}, {ratio}");
        assert_distribution(rows.iter().map(|row| row.direction.z).collect(), distribution, &what);
        let azimuth = rows.iter().map(|row| row.direction.y.atan2(row.direction.x)).collect();
        assert_distribution(azimuth, uniform(-PI, PI), "azimuth");
        for row in &rows {
            assert!(row.polarisation.dot(row.direction).abs() < 1e-12);
            assert!(row.polarisation.dot(row.direction.cross(Vec3::X)).abs() < 1e-9, "{row:?}");
        }
    }
}

/// Emission by a wavelength shifter: the spectrum up to the energy of the absorbed photon, random directions and polarisations, the
/// delay, and a number of photons of the Poisson distribution.
#[test]
fn shifters_emit_by_their_properties() {
    let matrices = r#"<matrix name="SHORT" coldim="2" values="1*eV 1e12 2.9*eV 1e12 2.95*eV 1e-6 10*eV 1e-6"/>
<matrix name="BAND" coldim="2" values="2.0*eV 0 4.0*eV 2"/><matrix name="TIME" coldim="1" values="2.5"/>
<matrix name="MEAN" coldim="1" values="1.5"/>"#;
    let inner = r#"<property name="RINDEX" ref="ONE"/><property name="WLSABSLENGTH" ref="SHORT"/>
<property name="WLSCOMPONENT" ref="BAND"/><property name="WLSTIMECONSTANT" ref="TIME"/>"#;
    let one = first_rows(&SlabDetector { matrices, inner, ..CLEAR });
    assert_eq!(one.len(), COUNT);
    // Geant4 is linear in the integral between the points: uniform from 2 to 4 eV, cut at 3 eV
    let energies = one.iter().map(|row| property_energy(row.wavelength_nm)).collect();
    assert_distribution(energies, uniform(2.0, 3.0), "energy");
    for (axis, what) in (0..3).zip(["x", "y", "z"]) {
        assert_distribution(one.iter().map(|row| row.direction[axis]).collect(), uniform(-1.0, 1.0), what);
        let across = one.iter().map(|row| row.polarisation[axis]).collect();
        assert_distribution(across, uniform(-1.0, 1.0), "polarisation");
    }
    assert!(
        one.iter()
            .all(|row| (row.time - 2.5).abs() < 1e-6 && row.polarisation.dot(row.direction).abs() < 1e-12)
    );
    let exponential = first_rows_with(&SlabDetector { matrices, inner, ..CLEAR }, TimeProfile::Exponential);
    assert_eq!(exponential.len(), COUNT);
    let times = exponential.iter().map(|row| row.time).collect();
    assert_distribution(times, |t| 1.0 - (-t / 2.5).exp(), "delay");
    let inner = format!(r#"{inner}<property name="WLSMEANNUMBERPHOTONS" ref="MEAN"/>"#);
    let several = first_rows(&SlabDetector { matrices, inner: &inner, ..CLEAR });
    let mut counts = vec![0u64; COUNT];
    let emitted = several.iter().filter(|row| row.process == Process::Reemission);
    emitted.for_each(|row| counts[row.photon as usize] += 1);
    let mut probability = (-1.5f64).exp();
    for number in 0..5 {
        let photons = counts.iter().filter(|count| **count == number).count() as u64;
        assert_binomial(photons, COUNT as u64, probability, &format!("{number} photons"));
        probability *= 1.5 / (number + 1) as f64;
    }
}
