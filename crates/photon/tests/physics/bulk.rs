//! Absorption, scattering and wavelength shifting in a material.

use crate::{CLEAR, SlabDetector, assert_binomial, beam, count, run, settings};
use rayweave_photon::End;
use rayweave_photon::property::LIGHT_SPEED;

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
