//! The boundary process against closed forms and quadratures.

use super::{AtBoundary, Boundary, BoundaryEvent, LaneBoundaries, LaneSurface, Reflection};
use crate::philox::{Purpose, Stream};
use crate::property::{PropertyTable, wavelength_nm};
use crate::surface::{Coating, MeasuredTable, OpticalSurface, SurfaceFinish, SurfaceModel, SurfaceType};
use crate::tables::{DavisTable, DichroicTable, LutTable};
use num_complex::Complex64;
use rayweave_math::Affine;
use rayweave_math::Vec3;
use rayweave_model::{Evaluator, PlacementId, Program, Query, RayBatch, Region, Solid, attributes};
use rayweave_optics::interface::fresnel;
use rayweave_optics::start_surfaces::{ExitSide, StartSurfaces};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Value, build};
use rayweave_shape::surface::Surface;
use rayweave_trace::Reference;
use std::collections::BTreeMap;
use std::sync::Arc;

const COUNT: u64 = 50_000;
const ENERGY: f64 = 3e-6;

/// One photon after the process.
#[derive(Clone, Copy, Debug)]
struct Outcome {
    event: BoundaryEvent,
    direction: Vec3,
    polarisation: Vec3,
    is_behind: bool,
}

/// A photon towards -z at an angle of incidence in degrees, in the plane of x and z; the normal is z.
fn incident(degrees: f64, is_s: bool) -> (Vec3, Vec3) {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    (Vec3::new(sine, 0.0, -cosine), if is_s { Vec3::Y } else { Vec3::new(cosine, 0.0, sine) })
}

/// Photons of one direction and polarisation between two indices.
fn outcomes(surface: &OpticalSurface, indices: [f64; 2], degrees: f64, is_s: bool) -> Vec<Outcome> {
    scattered(surface, indices, incident(degrees, is_s))
}

/// Photons of a direction and a polarisation between two indices.
fn scattered(
    surface: &OpticalSurface,
    indices: [f64; 2],
    (direction, polarisation): (Vec3, Vec3),
) -> Vec<Outcome> {
    let one = |number: u64| {
        let mut photon = Boundary {
            direction,
            polarisation,
            normal: Vec3::Z,
            energy: ENERGY,
            index: indices[0],
            index_behind: Some(indices[1]),
            is_same_material: false,
            surface: Some(surface),
        };
        let (event, is_behind) = photon.apply(&mut Stream::new(1, number, 1, Purpose::Boundary));
        Outcome { event, direction: photon.direction, polarisation: photon.polarisation, is_behind }
    };
    let found: Vec<Outcome> = (0..COUNT).map(one).collect();
    for outcome in &found {
        assert!(outcome.direction.dot(outcome.polarisation).abs() < 1e-9, "{outcome:?}");
        assert!((outcome.direction.length() - 1.0).abs() < 1e-12, "{outcome:?}");
        assert!((outcome.polarisation.length() - 1.0).abs() < 1e-12, "{outcome:?}");
    }
    found
}

fn counts(found: &[Outcome]) -> BTreeMap<BoundaryEvent, u64> {
    let mut counts = BTreeMap::new();
    found.iter().for_each(|outcome| *counts.entry(outcome.event).or_default() += 1);
    counts
}

/// Asserts that the share of an event agrees with a probability within five standard deviations.
fn assert_share(found: &[Outcome], event: BoundaryEvent, probability: f64) {
    let count = counts(found).get(&event).copied().unwrap_or(0) as f64;
    let total = found.len() as f64;
    let deviation = (total * probability * (1.0 - probability)).sqrt().max(1e-6);
    let z = (count - total * probability) / deviation;
    assert!(z.abs() < 5.0, "{event:?}: {count} of {total}, expected {:.1}, z {z:.1}", total * probability);
}

/// Asserts that values follow a density, by chi squared over 25 bins between 0 and `end`.
fn assert_density(values: &[f64], end: f64, density: impl Fn(f64) -> f64) {
    const BINS: usize = 25;
    const FINE: usize = 200;
    let width = end / BINS as f64;
    // the midpoint rule within each bin
    let integral = |bin: usize| {
        let step = width / FINE as f64;
        (0..FINE).map(|k| density(bin as f64 * width + (k as f64 + 0.5) * step) * step).sum::<f64>()
    };
    let expected: Vec<f64> = (0..BINS).map(integral).collect();
    let sum: f64 = expected.iter().sum();
    let mut found = [0u32; BINS];
    for value in values {
        assert!((0.0..end).contains(value), "{value}");
        found[((value / width) as usize).min(BINS - 1)] += 1;
    }
    let (mut chi2, mut bins) = (0.0, 0);
    for (found, expected) in found.iter().zip(expected) {
        let expected = expected / sum * values.len() as f64;
        if expected > 10.0 {
            chi2 += (f64::from(*found) - expected).powi(2) / expected;
            bins += 1;
        }
    }
    let freedom = f64::from(bins - 1);
    assert!(bins > 8 && chi2 < freedom + 5.0 * (2.0 * freedom).sqrt(), "chi2 {chi2} of {freedom}");
}

fn constant(value: f64) -> Option<PropertyTable> {
    Some(PropertyTable::constant(value))
}

fn surface(kind: SurfaceType, model: SurfaceModel, finish: SurfaceFinish, value: f64) -> OpticalSurface {
    OpticalSurface { kind, model, finish, value, ..OpticalSurface::default() }
}

fn rough_mirror(model: SurfaceModel, value: f64) -> OpticalSurface {
    let mirror = surface(SurfaceType::DielectricMetal, model, SurfaceFinish::Ground, value);
    OpticalSurface { lobe: constant(1.0), ..mirror }
}

/// Angles of the facets that reflected light at normal incidence: half the angle of the reflected direction.
fn facet_angles(found: &[Outcome]) -> Vec<f64> {
    found.iter().map(|outcome| 0.5 * outcome.direction.z.clamp(-1.0, 1.0).acos()).collect()
}

/// Facets of the unified model: the density exp(-alpha^2 / (2 sigma^2)) sin alpha.
#[test]
fn facets_of_the_unified_model_are_gaussian() {
    const SIGMA: f64 = 0.1;
    let found = outcomes(&rough_mirror(SurfaceModel::Unified, SIGMA), [1.0, 1.0], 0.0, true);
    assert_share(&found, BoundaryEvent::LobeReflection, 1.0);
    let density =
        |alpha: f64| (-0.5 * (alpha / SIGMA).powi(2)).exp() * (alpha.sin() / (4.0 * SIGMA)).min(1.0);
    assert_density(&facet_angles(&found), 0.7, density);
}

/// Facets of GLISUR: directions of points of a ball of radius 1 - polish about the tip of the normal. A cone of angle a
/// holds the part of the ball's slice at height z that is within z tan a.
#[test]
fn facets_of_glisur_point_into_a_ball() {
    const RADIUS: f64 = 0.3;
    let found = outcomes(&rough_mirror(SurfaceModel::Glisur, 1.0 - RADIUS), [1.0, 1.0], 0.0, true);
    assert_share(&found, BoundaryEvent::LobeReflection, 1.0);
    let within = |angle: f64| {
        const STEPS: usize = 4000;
        let slice = |k: usize| {
            let t = (2.0 * (k as f64 + 0.5) / STEPS as f64 - 1.0) * RADIUS;
            ((1.0 + t) * angle.tan()).powi(2).min(RADIUS * RADIUS - t * t)
        };
        (0..STEPS).map(slice).sum::<f64>()
    };
    let density = |angle: f64| within(angle + 5e-4) - within((angle - 5e-4).max(0.0));
    assert_density(&facet_angles(&found), RADIUS.asin() + 1e-9, density);
}

/// Light at an interface with equal amplitudes across the plane of incidence and in it: the polarisation of refracted and of
/// reflected photons by the amplitudes of Fresnel's equations (Jackson, 7.39 and 7.41).
#[test]
fn interfaces_polarise_by_fresnels_amplitudes() {
    let bare = OpticalSurface { value: 1.0, ..OpticalSurface::default() };
    for ([n1, n2], degrees) in [
        ([1.0, 1.5], 40.0),
        ([1.0, 1.5], 75.0),
        ([1.5, 1.0], 30.0),
        ([1.5, 1.0], 41.3),
        ([1.0, 1.5], 0.0),
        ([1.5, 1.0], 0.0),
    ] {
        let (direction, _) = incident(degrees, true);
        let across = -Vec3::Y;
        let polarisation = 0.5f64.sqrt() * (across + direction.cross(across));
        let (sin1, c1) = f64::to_radians(degrees).sin_cos();
        let sin2 = sin1 * n1 / n2;
        let c2 = (1.0 - sin2 * sin2).sqrt();
        let wave = |k: Vec3, [s, p]: [f64; 2]| (s * across + p * k.cross(across)).normalize();
        let refracted = Vec3::new(sin2, 0.0, -c2);
        let transmitted = [2.0 * n1 * c1 / (n1 * c1 + n2 * c2), 2.0 * n1 * c1 / (n2 * c1 + n1 * c2)];
        let reflected =
            [(n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2), (n2 * c1 - n1 * c2) / (n2 * c1 + n1 * c2)];
        let back = Vec3::new(sin1, 0.0, c1);
        let found = scattered(&bare, [n1, n2], (direction, polarisation));
        let power = 0.5 * (reflected[0].powi(2) + reflected[1].powi(2));
        assert_share(&found, BoundaryEvent::FresnelReflection, power);
        for outcome in &found {
            let (k, expected) = match outcome.is_behind {
                true => (refracted, wave(refracted, transmitted)),
                false => (back, wave(back, reflected)),
            };
            assert!((outcome.direction - k).length() < 1e-9, "{n1} {n2} {degrees}: {outcome:?}");
            assert!((outcome.polarisation - expected).length() < 1e-9, "{n1} {n2} {degrees}: {outcome:?}");
        }
    }
}

/// A spike of a metal with a complex index: of the parts a and b of the reflected power across the plane of incidence and in it,
/// each photon keeps both with the weight a b, the first one with a^2 and the second one with b^2, as in Geant4.
#[test]
fn metals_select_a_polarisation() {
    let mirror = surface(SurfaceType::DielectricMetal, SurfaceModel::Unified, SurfaceFinish::Ground, 0.0);
    let index = Some((PropertyTable::constant(0.4), PropertyTable::constant(2.0)));
    let mirror = OpticalSurface { metal_index: index, spike: constant(1.0), ..mirror };
    let (direction, _) = incident(60.0, true);
    // a quarter of the power across the plane of incidence
    let polarisation = 0.5 * Vec3::Y + 0.75f64.sqrt() * direction.cross(Vec3::Y);
    let [s, p] = fresnel(1.0, Complex64::new(0.4, 2.0), 0.5).reflected.map(|r| r.norm_sqr());
    let (s, p) = (0.25 * s, 0.75 * p);
    let found = scattered(&mirror, [1.0, 1.0], (direction, polarisation));
    assert_share(&found, BoundaryEvent::SpikeReflection, s + p);
    let reflected: Vec<&Outcome> =
        found.iter().filter(|outcome| outcome.event == BoundaryEvent::SpikeReflection).collect();
    let [a, b] = [s / (s + p), p / (s + p)];
    let total = a * a + a * b + b * b;
    for (lowest, highest, part) in [(0.999, 1.1, a * a / total), (-0.1, 0.001, b * b / total)] {
        let is_within = |outcome: &&&Outcome| (lowest..highest).contains(&outcome.polarisation.y.abs());
        let count = reflected.iter().filter(is_within).count() as f64;
        let expected = part * reflected.len() as f64;
        let z = (count - expected) / (expected * (1.0 - part)).sqrt();
        assert!(z.abs() < 5.0, "{lowest}: {count}, expected {expected:.0}");
    }
}

/// Of a rough metal with a complex index the mean of Fresnel's reflectance over the facets.
#[test]
fn rough_metals_reflect_by_the_mean_over_their_facets() {
    const SIGMA: f64 = 0.1;
    let metal = Complex64::new(1.5, 1.2);
    let mirror = OpticalSurface {
        metal_index: constant(metal.re).zip(constant(metal.im)),
        ..rough_mirror(SurfaceModel::Unified, SIGMA)
    };
    // at 60 degrees, of s light; facets at (alpha, azimuth), 0.05 degrees apart
    let (direction, polarisation) = incident(60.0, true);
    let (mut sum, mut weights) = (0.0, 0.0);
    for i in 0..600 {
        let alpha = (f64::from(i) + 0.5) * 1e-3;
        for k in 0..90 {
            let azimuth = (f64::from(k) + 0.5) / 90.0 * std::f64::consts::TAU;
            let facet = Vec3::new(alpha.sin() * azimuth.cos(), alpha.sin() * azimuth.sin(), alpha.cos());
            let cosine = -direction.dot(facet);
            if cosine <= 0.0 {
                continue;
            }
            let weight = (-0.5 * (alpha / SIGMA).powi(2)).exp() * alpha.sin();
            let [s, p] = fresnel(1.0, metal, cosine).reflected.map(|amplitude| amplitude.norm_sqr());
            let across = direction.cross(facet).normalize().dot(polarisation).powi(2);
            sum += weight * (s * across + p * (1.0 - across));
            weights += weight;
        }
    }
    let found = outcomes(&mirror, [1.0, 1.0], 60.0, true);
    // photons that meet a second facet may be absorbed there: fewer than 1 in 1000
    let absorbed = counts(&found).get(&BoundaryEvent::Absorption).copied().unwrap_or(0) as f64 / COUNT as f64;
    let expected = 1.0 - sum / weights;
    let error = 5.0 * (expected * (1.0 - expected) / COUNT as f64).sqrt() + 1e-3;
    assert!((absorbed - expected).abs() < error, "{absorbed} {expected}");
}

#[test]
fn lobes_have_their_constants() {
    let mirror = OpticalSurface {
        lobe: constant(0.2),
        spike: constant(0.1),
        backscatter: constant(0.3),
        ..rough_mirror(SurfaceModel::Unified, 0.1)
    };
    let found = outcomes(&mirror, [1.0, 1.0], 20.0, false);
    assert_share(&found, BoundaryEvent::SpikeReflection, 0.1);
    assert_share(&found, BoundaryEvent::LobeReflection, 0.2);
    assert_share(&found, BoundaryEvent::BackScattering, 0.3);
    assert_share(&found, BoundaryEvent::LambertianReflection, 0.4);
    let (direction, _) = incident(20.0, false);
    let spike = direction - 2.0 * direction.dot(Vec3::Z) * Vec3::Z;
    for outcome in found {
        match outcome.event {
            BoundaryEvent::SpikeReflection => assert!((outcome.direction - spike).length() < 1e-12),
            BoundaryEvent::BackScattering => assert!((outcome.direction + direction).length() < 1e-12),
            _ => assert!(outcome.direction.z >= 0.0),
        }
    }
}

/// Paint of reflectivity R behind a parallel layer whose interface reflects F: F + (1 - F)^2 R / (1 - F R) returns.
#[test]
fn polished_back_paint_sums_the_reflections_in_its_layer() {
    const R: f64 = 0.8;
    let painted = OpticalSurface {
        index: constant(1.8),
        // without it the unified model makes the reflections of the interface diffuse
        spike: constant(1.0),
        reflectivity: constant(R),
        transmittance: constant(0.05),
        ..surface(
            SurfaceType::DielectricDielectric,
            SurfaceModel::Unified,
            SurfaceFinish::PolishedBackPainted,
            0.0,
        )
    };
    for (degrees, is_s) in [(0.0, true), (50.0, true), (70.0, false)] {
        let cosine = f64::to_radians(degrees).cos();
        let reflected = fresnel(1.2, Complex64::from(1.8), cosine).reflected;
        let f = reflected[usize::from(!is_s)].norm_sqr();
        let found = outcomes(&painted, [1.2, 1.0], degrees, is_s);
        let reached = (1.0 - f) / (1.0 - f * R);
        assert_share(&found, BoundaryEvent::Absorption, reached * 0.15);
        assert_share(&found, BoundaryEvent::Transmission, reached * 0.05);
        assert_share(&found, BoundaryEvent::SpikeReflection, f);
        let back = found.iter().filter(|outcome| !outcome.is_behind).count() as f64 / COUNT as f64;
        let expected = f + (1.0 - f) * R * reached;
        assert!((back - expected).abs() < 5.0 * (0.25 / COUNT as f64).sqrt(), "{degrees}: {back} {expected}");
    }
}

/// Diffuse paint of reflectivity R in a layer of index n in vacuum: a fraction e of what the paint reflects leaves the layer,
/// e = the mean of 1 - F over the cosine distribution of angles in it, and the rest returns to the paint.
#[test]
fn ground_back_paint_is_diffuse_behind_its_layer() {
    const R: f64 = 0.2;
    const N: f64 = 1.5;
    let painted = OpticalSurface {
        index: constant(N),
        spike: constant(1.0),
        reflectivity: constant(R),
        ..surface(
            SurfaceType::DielectricDielectric,
            SurfaceModel::Unified,
            SurfaceFinish::GroundBackPainted,
            0.0,
        )
    };
    let f = ((N - 1.0) / (N + 1.0)).powi(2);
    const STEPS: usize = 20_000;
    let transmitted = |k: usize| {
        let cosine = (k as f64 + 0.5) / STEPS as f64;
        let amplitudes = fresnel(N, Complex64::ONE, cosine);
        2.0 * cosine * (1.0 - amplitudes.reflectance()) / STEPS as f64
    };
    let e: f64 = (0..STEPS).map(transmitted).sum();
    let found = outcomes(&painted, [1.0, 1.0], 0.0, true);
    // the polarisation after diffuse reflection is isotropic in the mean, here for the first reflection, which dominates
    assert_share(&found, BoundaryEvent::Absorption, (1.0 - f) * (1.0 - R) / (1.0 - R * (1.0 - e)));
    assert_share(&found, BoundaryEvent::SpikeReflection, f);
}

/// The reflectance of a film by the closed form of Airy (Born & Wolf, *Principles of Optics*, section 1.6.4), for s and p.
fn airy([n1, n, n2]: [f64; 3], thickness: f64, degrees: f64) -> [f64; 2] {
    let sine = n1 * f64::to_radians(degrees).sin();
    let cosine = |n: f64| (Complex64::ONE - (sine / n).powi(2)).sqrt();
    let [c1, c, c2] = [n1, n, n2].map(cosine);
    let phase =
        (2.0 * Complex64::I * std::f64::consts::TAU / wavelength_nm(ENERGY) * n * thickness * c).exp();
    let total = |r12: Complex64, r23: Complex64| ((r12 + r23 * phase) / (1.0 + r12 * r23 * phase)).norm_sqr();
    let ratio = |a: Complex64, b: Complex64| (a - b) / (a + b);
    [total(ratio(n1 * c1, n * c), ratio(n * c, n2 * c2)), total(ratio(n * c1, n1 * c), ratio(n2 * c, n * c2))]
}

fn coated(index: f64, thickness_nm: f64, has_frustrated_transmission: bool) -> OpticalSurface {
    let thickness = thickness_nm * 1e-6;
    OpticalSurface {
        coating: Some(Coating {
            index: PropertyTable::constant(index),
            thickness,
            has_frustrated_transmission,
        }),
        ..surface(SurfaceType::Coated, SurfaceModel::Unified, SurfaceFinish::Polished, 0.0)
    }
}

#[test]
fn films_reflect_by_airys_formula() {
    for (index, thickness) in [(1.38, 75.0), (2.3, 40.0)] {
        for degrees in [0.0, 35.0, 70.0] {
            for (k, is_s) in [true, false].into_iter().enumerate() {
                let found = outcomes(&coated(index, thickness, true), [1.0, 1.52], degrees, is_s);
                let expected = airy([1.0, index, 1.52], thickness, degrees)[k];
                assert_share(&found, BoundaryEvent::CoatedReflection, expected);
                assert_share(&found, BoundaryEvent::CoatedRefraction, 1.0 - expected);
                let bent = (f64::to_radians(degrees).sin() / 1.52).asin().cos();
                let refracted = found.iter().find(|outcome| outcome.is_behind).unwrap();
                assert!((refracted.direction.z + bent).abs() < 1e-12, "Snell's law");
            }
        }
    }
}

/// Through a gap of 60 nm between two prisms light tunnels beyond the critical angle, unless that is switched off; an
/// efficiency detects what passes.
#[test]
fn thin_gaps_transmit_beyond_the_critical_angle() {
    let expected = airy([1.5, 1.0, 1.5], 60.0, 55.0)[0];
    let found = outcomes(&coated(1.0, 60.0, true), [1.5, 1.5], 55.0, true);
    assert_share(&found, BoundaryEvent::TotalInternalReflection, expected);
    assert_share(&found, BoundaryEvent::CoatedFrustratedTransmission, 1.0 - expected);
    let closed = outcomes(&coated(1.0, 60.0, false), [1.5, 1.5], 55.0, true);
    assert_share(&closed, BoundaryEvent::TotalInternalReflection, 1.0);
    // a film of an index between: total reflection by the medium behind
    let outer = outcomes(&coated(1.4, 60.0, true), [1.5, 1.0], 55.0, true);
    assert_share(&outer, BoundaryEvent::TotalInternalReflection, 1.0);
    let sensor = OpticalSurface { efficiency: constant(0.25), ..coated(1.0, 60.0, true) };
    let found = outcomes(&sensor, [1.5, 1.5], 55.0, true);
    assert_share(&found, BoundaryEvent::Detection, 0.25 * (1.0 - expected));
    assert_share(&found, BoundaryEvent::Absorption, 0.75 * (1.0 - expected));
}

#[test]
fn dichroic_filters_transmit_by_their_table() {
    // 3 eV is 413.28 nm
    let table =
        DichroicTable::new(vec![400.0, 420.0], vec![0.0, 90.0], vec![10.0, 30.0, 40.0, 90.0]).unwrap();
    let filter = OpticalSurface {
        table: Some(MeasuredTable::Dichroic(Arc::new(table))),
        ..surface(SurfaceType::DielectricDichroic, SurfaceModel::Unified, SurfaceFinish::Polished, 0.0)
    };
    let x = (wavelength_nm(ENERGY) - 400.0) / 20.0;
    for degrees in [0.0, 30.0, 75.0] {
        let y = degrees / 90.0;
        let expected = (0.1 + 0.2 * x) * (1.0 - y) + (0.4 + 0.5 * x) * y;
        let found = outcomes(&filter, [1.0, 1.5], degrees, true);
        assert_share(&found, BoundaryEvent::Dichroic, expected);
        assert_share(&found, BoundaryEvent::SpikeReflection, 1.0 - expected);
        let (direction, _) = incident(degrees, true);
        for outcome in found.iter().filter(|outcome| outcome.is_behind) {
            assert!((outcome.direction - direction).length() < 1e-12, "undeviated");
        }
    }
}

/// A table with two bins at 30 degrees: the mirror direction (theta -30, phi 0), and one out of the plane of incidence. The
/// losses are those of REFLECTIVITY and TRANSMITTANCE.
#[test]
fn measured_reflectors_follow_their_table() {
    let mut values = vec![0.0; LutTable::INCIDENCES * LutTable::THETAS * LutTable::PHIS];
    let at = |theta: usize, phi: usize| 30 + LutTable::INCIDENCES * (theta + LutTable::THETAS * phi);
    values[at(15, 18)] = 0.6;
    // theta 10, phi 40: out of the plane
    values[at(25, 26)] = 0.2;
    let reflector = OpticalSurface {
        reflectivity: constant(0.8),
        transmittance: constant(0.05),
        table: Some(MeasuredTable::Lut(Arc::new(LutTable::new(&values).unwrap()))),
        ..surface(SurfaceType::DielectricLut, SurfaceModel::Lut, SurfaceFinish::Ground, 0.0)
    };
    let found = outcomes(&reflector, [1.5, 1.0], 30.0, true);
    assert_share(&found, BoundaryEvent::LutReflection, 0.8);
    assert_share(&found, BoundaryEvent::Transmission, 0.05);
    assert_share(&found, BoundaryEvent::Absorption, 0.15);
    let (direction, _) = incident(30.0, true);
    let mirror = Vec3::new(direction.x, 0.0, -direction.z);
    let reflected = || found.iter().filter(|outcome| outcome.event == BoundaryEvent::LutReflection);
    let (specular, other): (Vec<&Outcome>, Vec<&Outcome>) =
        reflected().partition(|outcome| (outcome.direction - mirror).length() < 1e-9);
    let share = specular.len() as f64 / reflected().count() as f64;
    assert!((share - 0.75).abs() < 5.0 * (0.1875 / reflected().count() as f64).sqrt(), "{share}");
    for outcome in other {
        // 10 degrees from the normal in the plane, on the side of the source, then 40 degrees out of the plane
        let (theta, phi) = (10f64.to_radians(), 40f64.to_radians());
        let in_plane = Vec3::new(-theta.sin(), 0.0, theta.cos()) * phi.cos();
        assert!((outcome.direction.y.abs() - phi.sin()).abs() < 1e-9);
        assert!(
            (outcome.direction.x - in_plane.x).abs() < 1e-9
                && (outcome.direction.z - in_plane.z).abs() < 1e-9
        );
    }
}

/// A table with one sample each of reflection and transmission at 40 degrees.
#[test]
fn davis_surfaces_follow_their_table() {
    let mut directions = vec![0f32; 7_240_000];
    // row 40 of reflection is block 39: 25 degrees from the normal, straight ahead
    directions[39 * 40_000 + 1] = 25f32.to_radians();
    // transmission: 150 degrees from the normal at an azimuth of 90 degrees
    directions[(91 + 40) * 40_000] = 90f32.to_radians();
    directions[(91 + 40) * 40_000 + 1] = 150f32.to_radians();
    let table = Arc::new(DavisTable::new(vec![0.7; 90], &directions).unwrap());
    let reflector = OpticalSurface {
        table: Some(MeasuredTable::Davis(table)),
        ..surface(SurfaceType::DielectricLutDavis, SurfaceModel::Davis, SurfaceFinish::Ground, 0.0)
    };
    let found = outcomes(&reflector, [1.5, 1.0], 40.5, true);
    assert_share(&found, BoundaryEvent::LobeReflection, 0.7);
    assert_share(&found, BoundaryEvent::Transmission, 0.3);
    for outcome in &found {
        let expected = match outcome.event {
            BoundaryEvent::LobeReflection => [25f64.to_radians().sin(), 0.0, 25f64.to_radians().cos()],
            _ => [0.0, 0.5, -(0.75f64.sqrt())],
        };
        let [x, y, z] = outcome.direction.to_array();
        assert!((Vec3::new(x, y.abs(), z) - Vec3::from_array(expected)).length() < 1e-6, "{outcome:?}");
    }
    // near the normal: back or straight on
    let near = outcomes(&reflector, [1.5, 1.0], 0.5, true);
    let (direction, _) = incident(0.5, true);
    assert!(near.iter().all(|outcome| (outcome.direction.dot(direction).abs() - 1.0).abs() < 1e-12));
    // with an efficiency, what is not reflected is detected or absorbed
    let sensor = OpticalSurface { efficiency: constant(0.5), ..reflector };
    let found = outcomes(&sensor, [1.5, 1.0], 40.5, true);
    assert_share(&found, BoundaryEvent::Detection, 0.15);
    assert_share(&found, BoundaryEvent::Absorption, 0.15);
}

/// Photons in lanes have the bits of the scalar process, for all kinds of events: oblique, nearly normal, normal, close to the
/// critical angle and at grazing incidence.
#[test]
fn bare_interfaces_in_lanes_equal_the_scalar_process() {
    let mut lanes = LaneBoundaries::bare();
    let (mut photons, mut expected) = (Vec::new(), Vec::new());
    for number in 0..4001u64 {
        let mut stream = Stream::new(5, number, 0, Purpose::Emission);
        let normal = stream.direction();
        // the last groups are totally reflected as a whole
        let [index, behind] = match number {
            ..3900 => [1.0 + stream.uniform(), 1.0 + stream.uniform()],
            _ => [1.9, 1.1],
        };
        let critical = (1.0 - (behind / index).min(1.0).powi(2)).sqrt();
        let cosine = match number % 8 {
            _ if number >= 3900 => 0.7 * stream.uniform(),
            0 => 1.0,
            1 => 1.0 - 1e-10 * stream.uniform(),
            2 => 1e-8 * stream.uniform(),
            3 => (critical * (1.0 + 1e-9 * (stream.uniform() - 0.5))).clamp(0.0, 1.0),
            _ => stream.uniform(),
        };
        let direction = if cosine == 1.0 { -normal } else { -stream.around(normal, cosine) };
        let polarisation = stream.polarisation(direction);
        let mut photon = Boundary {
            direction,
            polarisation,
            normal,
            energy: ENERGY,
            index,
            index_behind: Some(behind),
            is_same_material: false,
            surface: None,
        };
        let mut numbers = Stream::new(7, number, 1, Purpose::Boundary);
        let at = AtBoundary {
            direction,
            polarisation,
            normal,
            surface: LaneSurface::Bare([index, behind]),
            counter: [0, number as u32, 1],
            position: Vec3::ZERO,
            t: 1.0,
            contact: None,
        };
        photons.extend(lanes.push(&at));
        let (event, is_behind) = photon.apply(&mut numbers);
        expected.push((event, is_behind, photon.direction, photon.polarisation));
    }
    lanes.apply(7, &StartSurfaces::default());
    let mut events = BTreeMap::new();
    let mut count = 0;
    for (number, expected) in photons.into_iter().zip(expected) {
        let Some(found) = lanes.get(number) else { continue };
        assert!(found.contact.is_none());
        let bits = |vector: Vec3| vector.to_array().map(f64::to_bits);
        assert_eq!((found.event, found.is_behind), (expected.0, expected.1), "photon {number}");
        assert_eq!(bits(found.direction), bits(expected.2), "photon {number}");
        assert_eq!(bits(found.polarisation), bits(expected.3), "photon {number}");
        *events.entry(found.event).or_insert(0) += 1;
        count += 1;
    }
    if rayweave_shape::lanes::WideLevel::widest().is_some() {
        assert!(count > 3900, "{count}");
        assert!(events.len() == 3 && events.values().all(|&n| n > 100), "{events:?}");
    }
}

/// Photons at paint and metal in lanes have the bits of the scalar process, which remains for those that the surface may transmit.
#[test]
fn paint_in_lanes_equals_the_scalar_process() {
    use SurfaceFinish::{Ground, GroundFrontPainted, Polished, PolishedFrontPainted};
    use SurfaceType::{DielectricDielectric, DielectricMetal};
    let rules = [
        (DielectricDielectric, PolishedFrontPainted, Reflection::Mirror),
        (DielectricDielectric, GroundFrontPainted, Reflection::Paint),
        (DielectricMetal, Polished, Reflection::Mirror),
        (DielectricMetal, Ground, Reflection::Metal),
    ];
    let surfaces = rules.map(|(kind, finish, rule)| {
        let own = OpticalSurface {
            model: SurfaceModel::Unified,
            kind,
            finish,
            value: 0.1,
            reflectivity: constant(0.8),
            efficiency: constant(0.3),
            ..OpticalSurface::default()
        };
        assert_eq!(Reflection::of(&own), Some(rule));
        // rules that do not hold for all photons
        let dark = OpticalSurface { reflectivity: constant(0.1), ..own.clone() };
        assert_eq!(Reflection::of(&dark), Some(rule));
        assert_eq!(Reflection::of(&OpticalSurface { transmittance: constant(0.1), ..dark }), None);
        let lobes = OpticalSurface { lobe: constant(0.5), ..own.clone() };
        assert_eq!(Reflection::of(&lobes), Some(rule).filter(|rule| *rule != Reflection::Metal));
        own
    });
    let open = surfaces.each_ref().map(|own| OpticalSurface { transmittance: constant(0.1), ..own.clone() });
    let mut lanes = LaneBoundaries::painted();
    let (mut photons, mut expected) = (Vec::new(), Vec::new());
    for number in 0..4003u64 {
        let mut stream = Stream::new(9, number, 0, Purpose::Emission);
        let normal = if number % 16 == 0 { Vec3::NEG_Z } else { stream.direction() };
        let cosine = [1.0, 1e-8, stream.uniform(), stream.uniform()][(number / 4 % 4) as usize];
        let direction = if cosine == 1.0 { -normal } else { -stream.around(normal, cosine) };
        let polarisation = stream.polarisation(direction);
        let k = (number % 4) as usize;
        let own = if number.is_multiple_of(5) { &open[k] } else { &surfaces[k] };
        let mut photon = Boundary {
            direction,
            polarisation,
            normal,
            energy: ENERGY,
            index: 1.4,
            index_behind: None,
            is_same_material: number % 3 == 0,
            surface: Some(own),
        };
        let at = AtBoundary {
            direction,
            polarisation,
            normal,
            surface: LaneSurface::Painted(rules[k].2.values(own, ENERGY)),
            counter: [0, number as u32, 1],
            position: Vec3::ZERO,
            t: 1.0,
            contact: None,
        };
        photons.extend(lanes.push(&at));
        let (event, is_behind) = photon.apply(&mut Stream::new(7, number, 1, Purpose::Boundary));
        expected.push((event, is_behind, photon.direction, photon.polarisation));
    }
    lanes.apply(7, &StartSurfaces::default());
    let mut events = BTreeMap::new();
    for (number, expected) in photons.into_iter().zip(expected) {
        let bits = |vector: Vec3| vector.to_array().map(f64::to_bits);
        let Some(found) = lanes.get(number) else { continue };
        assert_eq!(found.event, expected.0, "photon {number}");
        *events.entry(found.event).or_insert(0) += 1;
        if !matches!(found.event, BoundaryEvent::Absorption | BoundaryEvent::Detection) {
            assert_eq!(found.is_behind, expected.1, "photon {number}");
            assert_eq!(bits(found.direction), bits(expected.2), "photon {number}");
            assert_eq!(bits(found.polarisation), bits(expected.3), "photon {number}");
        }
    }
    if rayweave_shape::lanes::WideLevel::widest().is_some() {
        // a fifth of the photons is lost, of which three tenths are detected
        let least = [
            (BoundaryEvent::SpikeReflection, 1500),
            (BoundaryEvent::LambertianReflection, 1500),
            (BoundaryEvent::Absorption, 400),
            (BoundaryEvent::Detection, 150),
        ];
        assert!(least.iter().all(|(event, least)| events.get(event) > Some(least)), "{events:?}");
    }
}

/// Contacts with planes and spheres in lanes have the bits of [`StartSurfaces::contact`], in the world and in moved copies.
#[test]
fn contacts_in_lanes_equal_those_of_start_surfaces() {
    let cube = |size: f64| Solid::from(build("box", &[("size", Value::Number(size))]).unwrap());
    let ball = |radius: f64| Solid::from(build("sphere", &[("radius", Value::Number(radius))]).unwrap());
    let maps = [Vec3::new(0.3, 0.1, -0.2), Vec3::new(4.0, 0.0, 0.7)].map(Affine::translate);
    let others = [Vec3::new(1.0, 4.0, 1.0), Vec3::new(4.1, 3.9, -0.3)].map(Affine::translate);
    let here = Affine::translate(Vec3::new(2.0, 2.0, 4.0));
    let solids = [cube(40.0), cube(2.0).place(maps), ball(1.1).place(others), ball(0.9).apply(here)];
    let region = |(medium, solid): (u32, Solid)| Region { name: medium.to_string(), solid, medium };
    let program = Program::compile_regions(&(1..).zip(solids).map(region).collect::<Vec<_>>()).unwrap();
    let (starts, mut lanes) = (StartSurfaces::new(&program), LaneBoundaries::bare());
    let evaluator = Reference::new(Arc::new(program.clone()));
    let (mut pushed, mut moved, mut alone, mut round) = (Vec::new(), 0, 0, [0; 2]);
    for number in 0..1600u64 {
        let mut stream = Stream::new(6, number, 0, Purpose::Emission);
        let origin = Vec3::from_array([(); 3].map(|()| 8.0 * stream.uniform() - 2.0));
        // some of them along an axis
        let direction = if number % 5 == 0 { Vec3::NEG_X } else { stream.direction() };
        let ray = Ray::new(origin, direction);
        let mut batch = RayBatch::default();
        batch.replace([ray].into_iter());
        let found = evaluator.collect(batch.rays(), &Query::nearest()).unwrap();
        let Some(&crossing) = found.of(0).first() else { continue };
        let normal = attributes::normal(&program, &ray, &crossing);
        let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
        let contact = starts.lane_contact(crossing.face.surface, crossing.face.placement);
        assert!(contact.is_some());
        if matches!(program.surface(crossing.face.surface).surface, Surface::Sphere(_)) {
            round[usize::from(crossing.face.placement != PlacementId(0))] += 1;
        }
        moved += usize::from(crossing.face.placement != PlacementId(0));
        let at = AtBoundary {
            direction,
            polarisation: stream.polarisation(direction),
            normal,
            surface: LaneSurface::Bare([1.0, 1.3]),
            counter: [0, number as u32, 1],
            position: origin,
            t: crossing.t,
            contact,
        };
        pushed.extend(lanes.push(&at).map(|number| (number, ray, crossing, normal)));
    }
    lanes.apply(7, &starts);
    for (number, ray, crossing, normal) in &pushed {
        let Some(point) = lanes.get(*number).and_then(|found| found.contact) else { continue };
        alone += usize::from(point.is_alone);
        let contact = starts.contact(&program, ray, crossing);
        let bits = |vector: Vec3| vector.to_array().map(f64::to_bits);
        assert_eq!(bits(point.position), bits(contact.project(*normal)), "{ray:?}");
        for (side, inside) in
            [(ExitSide::Incident, point.is_rising), (ExitSide::Transmitted, point.is_falling)]
        {
            let mut list = Vec::new();
            starts.append_at(&contact, side, &[], &mut list);
            assert_eq!(list[0].inside, inside, "{ray:?}");
            assert!(list.len() == 1 || !point.is_alone, "{ray:?}");
        }
    }
    if rayweave_shape::lanes::WideLevel::widest().is_some() {
        assert!(pushed.len() > 1400 && moved > 120 && alone > 1200, "{} {moved} {alone}", pushed.len());
        assert!(round.iter().all(|&count| count > 40), "{round:?}");
    }
}

/// `is_opaque` against trials: of every surface that it calls opaque no photon passes, and of the others some do.
#[test]
fn opaque_surfaces_let_nothing_through() {
    use SurfaceFinish::{
        Ground, GroundBackPainted, GroundFrontPainted, Polished, PolishedBackPainted, PolishedFrontPainted,
    };
    let table = |value: f64| PropertyTable::new(vec![(1e-6, value), (10e-6, value)]).unwrap();
    let passes = |surface: &OpticalSurface, is_same: bool| {
        (0..600u64).any(|number| {
            let (direction, polarisation) = incident([5.0, 35.0, 60.0][number as usize % 3], number % 2 == 0);
            let mut photon = Boundary {
                direction,
                polarisation,
                normal: Vec3::Z,
                energy: ENERGY,
                index: 1.3,
                index_behind: Some(if is_same { 1.3 } else { 1.5 }),
                is_same_material: is_same,
                surface: Some(surface),
            };
            let (event, is_behind) = photon.apply(&mut Stream::new(1, number, 1, Purpose::Boundary));
            is_behind && !matches!(event, BoundaryEvent::Absorption | BoundaryEvent::Detection)
        })
    };
    let mut opaque = 0;
    for finish in
        [Polished, PolishedFrontPainted, PolishedBackPainted, Ground, GroundFrontPainted, GroundBackPainted]
    {
        for kind in [SurfaceType::DielectricDielectric, SurfaceType::DielectricMetal] {
            for reflectivity in [None, Some(0.0), Some(0.5), Some(1.0)] {
                for transmittance in [None, Some(0.0), Some(0.3)] {
                    for is_same in [false, true] {
                        let surface = OpticalSurface {
                            model: SurfaceModel::Unified,
                            finish,
                            kind,
                            value: 0.1,
                            reflectivity: reflectivity.map(table),
                            transmittance: transmittance.map(table),
                            index: Some(table(1.2)),
                            ..OpticalSurface::default()
                        };
                        let is_opaque = surface.is_opaque(is_same);
                        opaque += u32::from(is_opaque);
                        assert_eq!(is_opaque, !passes(&surface, is_same), "{is_same}: {surface:?}");
                    }
                }
            }
        }
    }
    // metals: all but the 2 of 12 with losses and TRANSMITTANCE
    assert!(opaque >= 6 * 2 * 10, "{opaque}");
}
