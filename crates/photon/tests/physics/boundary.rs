//! The boundary process.

use crate::{CLEAR, SlabDetector, assert_binomial, beam, count, run, settings};
use num_complex::Complex64;
use rayweave_optics::interface::fresnel;
use rayweave_photon::{BoundaryEvent, DetectionRule, End, PhotonRun, RunSettings, property};

const COUNT: usize = 20_000;

/// The first boundary events of a beam that hits the slab: the photons stop after two steps.
fn first_events(slab: &SlabDetector<'_>, direction: [f64; 3], polarisation: [f64; 3]) -> PhotonRun {
    let settings = RunSettings { max_steps: 1, ..settings(COUNT) };
    run(&slab.build(), &beam(COUNT, direction, polarisation), &settings)
}

fn events(run: &PhotonRun, event: BoundaryEvent) -> u64 {
    run.boundary_events.get(&event).copied().unwrap_or(0)
}

/// Reflectances of polarised light are those of Fresnel's equations, at several angles.
#[test]
fn interfaces_reflect_by_fresnels_equations() {
    for degrees in [0f64, 30.0, 56.309_932_474_020_215, 80.0] {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let expected =
            fresnel(1.0, Complex64::from(1.5), cosine).reflected.map(|amplitude| amplitude.norm_sqr());
        let direction = [sine, 0.0, cosine];
        for (k, polarisation) in [[0.0, 1.0, 0.0], [cosine, 0.0, -sine]].into_iter().enumerate() {
            let run = first_events(&CLEAR, direction, polarisation);
            let what = format!("{degrees} degrees, {}", ["s", "p"][k]);
            let reflected = events(&run, BoundaryEvent::FresnelReflection);
            assert_binomial(reflected, COUNT as u64, expected[k], &what);
            assert_eq!(reflected + events(&run, BoundaryEvent::FresnelRefraction), COUNT as u64);
        }
    }
}

/// A surface of the slab for light from outside.
fn with_surface<'a>(surface: &'a str, matrices: &'a str) -> SlabDetector<'a> {
    SlabDetector {
        matrices,
        surfaces: surface,
        links: r#"<skinsurface name="skin" surfaceproperty="S"><volumeref ref="Slab"/></skinsurface>"#,
        ..CLEAR
    }
}

/// The reflectance of aluminium at 3 eV and 60 degrees, by Fresnel's equations with the complex index 0.4 + 4.5 i.
#[test]
fn metals_reflect_by_their_complex_index() {
    let slab = with_surface(
        r#"<opticalsurface name="S" model="unified" finish="polished" type="dielectric_metal" value="0">
<property name="REALRINDEX" ref="RE"/><property name="IMAGINARYRINDEX" ref="IM"/></opticalsurface>"#,
        r#"<matrix name="RE" coldim="2" values="1*eV 0.4 10*eV 0.4"/><matrix name="IM" coldim="2" values="1*eV 4.5 10*eV 4.5"/>"#,
    );
    let (sine, cosine) = 60f64.to_radians().sin_cos();
    let expected =
        fresnel(1.0, Complex64::new(0.4, 4.5), cosine).reflected.map(|amplitude| amplitude.norm_sqr());
    for (k, polarisation) in [[0.0, 1.0, 0.0], [cosine, 0.0, -sine]].into_iter().enumerate() {
        let run = first_events(&slab, [sine, 0.0, cosine], polarisation);
        assert_binomial(
            events(&run, BoundaryEvent::SpikeReflection),
            COUNT as u64,
            expected[k],
            ["s", "p"][k],
        );
    }
}

/// REFLECTIVITY is 1 minus the loss, EFFICIENCY the fraction of the loss that is detected, TRANSMITTANCE what passes.
#[test]
fn losses_are_shared_as_the_surface_says() {
    let slab = with_surface(
        r#"<opticalsurface name="S" model="unified" finish="polished" type="dielectric_metal" value="0">
<property name="REFLECTIVITY" ref="R"/><property name="TRANSMITTANCE" ref="T"/><property name="EFFICIENCY" ref="E"/>
</opticalsurface>"#,
        r#"<matrix name="R" coldim="2" values="1*eV 0.5 10*eV 0.5"/><matrix name="T" coldim="2" values="1*eV 0.2 10*eV 0.2"/>
<matrix name="E" coldim="2" values="1*eV 0.25 10*eV 0.25"/>"#,
    );
    let run = first_events(&slab, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    assert_binomial(events(&run, BoundaryEvent::SpikeReflection), COUNT as u64, 0.5, "reflected");
    assert_binomial(events(&run, BoundaryEvent::Transmission), COUNT as u64, 0.2, "transmitted");
    assert_binomial(events(&run, BoundaryEvent::Absorption), COUNT as u64, 0.3 * 0.75, "absorbed");
    assert_binomial(events(&run, BoundaryEvent::Detection), COUNT as u64, 0.3 * 0.25, "detected");
    assert_eq!(count(&run, End::Detected), run.hits.len() as u64);
    assert!(run.hits.position[2].iter().all(|z| z.abs() < 1e-12), "hits lie on the face of the slab");
}

/// Paint in front reflects like a mirror or diffusely; the mean cosine of diffuse reflection is 2/3.
#[test]
fn front_paint_reflects_as_named() {
    for (finish, event) in [
        ("polishedfrontpainted", BoundaryEvent::SpikeReflection),
        ("groundfrontpainted", BoundaryEvent::LambertianReflection),
    ] {
        let surface = format!(
            r#"<opticalsurface name="S" model="unified" finish="{finish}" type="dielectric_dielectric" value="0"/>
<opticalsurface name="W" model="unified" finish="polished" type="dielectric_metal" value="0">
<property name="REFLECTIVITY" ref="ZERO"/><property name="EFFICIENCY" ref="ONE"/></opticalsurface>"#
        );
        let slab = with_surface(&surface, "");
        let run = first_events(&slab, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
        assert_eq!(events(&run, event), COUNT as u64, "{finish}");
    }
}

/// A back-painted surface without an index of its layer absorbs, as does a material without an index.
#[test]
fn missing_indices_absorb() {
    let slab = with_surface(
        r#"<opticalsurface name="S" model="unified" finish="groundbackpainted" type="dielectric_dielectric" value="0.1"/>"#,
        "",
    );
    assert_eq!(count(&first_events(&slab, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), End::NoIndex), COUNT as u64);
    let slab = SlabDetector { inner: "", ..CLEAR };
    assert_eq!(count(&first_events(&slab, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), End::NoIndex), COUNT as u64);
}

/// In a box with an index of 1.5 in vacuum, light along the diagonal of a cube meets each face at 54.7 degrees, beyond the
/// critical angle of 41.8 degrees: 1,000 total reflections of each photon, none of which leaks. The first photon hits edges
/// and corners of the box exactly.
#[test]
fn total_reflection_keeps_every_photon() {
    let direction = [1.0, 1.0, 1.0];
    let mut light = beam(200, direction, [1.0, -1.0, 0.0]);
    if let rayweave_photon::Source::Photons(photons) = &mut light {
        photons.iter_mut().zip(0..).for_each(|(photon, k)| {
            photon.position.z = 10.0 + 0.37 * f64::from(k);
            photon.position.x = 0.1 * f64::from(k);
        });
    }
    let run = run(&CLEAR.build(), &light, &RunSettings { max_steps: 1000, ..settings(200) });
    assert_eq!(count(&run, End::StepLimit), 200);
    assert_eq!(events(&run, BoundaryEvent::TotalInternalReflection), 200 * 1000);
}

/// A rough interface makes the fraction 1 - exp(-(4 pi sigma n cos / lambda)^2) of the total reflections diffuse.
#[test]
fn roughness_makes_total_reflection_diffuse() {
    let slab = with_surface(
        r#"<opticalsurface name="S" model="glisur" finish="polished" type="dielectric_dielectric" value="1">
<property name="SURFACEROUGHNESS" ref="SIGMA"/></opticalsurface>"#,
        r#"<matrix name="SIGMA" coldim="1" values="20*nm"/>"#,
    );
    let mut light = beam(COUNT, [1.0, 1.0, 1.0], [1.0, -1.0, 0.0]);
    if let rayweave_photon::Source::Photons(photons) = &mut light {
        photons.iter_mut().for_each(|photon| photon.position.z = 50.0);
    }
    let run = run(&slab.build(), &light, &RunSettings { max_steps: 1, ..settings(COUNT) });
    let phase = 4.0 * std::f64::consts::PI * 20.0 * 1.5 * (1f64 / 3.0).sqrt() / property::wavelength_nm(3e-6);
    let diffuse = events(&run, BoundaryEvent::LambertianReflection);
    assert_binomial(diffuse, COUNT as u64, 1.0 - (-phase * phase).exp(), "diffuse");
    assert_eq!(diffuse + events(&run, BoundaryEvent::TotalInternalReflection), COUNT as u64);
}

/// A sensitive volume detects what enters it, without any surface; the rule decides whether that counts.
#[test]
fn the_rule_of_detection_is_respected() {
    let slab = SlabDetector {
        inner: r#"<property name="RINDEX" ref="ONE"/>"#,
        auxiliary: r#"<auxiliary auxtype="SensDet" auxvalue="Counter"/>"#,
        ..CLEAR
    };
    for (detection, expected) in
        [(DetectionRule::Volume, COUNT), (DetectionRule::Both, COUNT), (DetectionRule::Efficiency, 0)]
    {
        let settings = RunSettings { detection, ..settings(COUNT) };
        let run = run(&slab.build(), &beam(COUNT, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), &settings);
        assert_eq!(run.hits.len(), expected, "{detection:?}");
        assert!(run.hits.paths().iter().all(|path| **path == *"Slab"));
    }
}
