//! Measurements compared with closed forms, and with the coverage of confidence intervals.

use super::*;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::drive::Cancel;
use rayweave_model::{Program, Region, Solid};
use rayweave_shape::primitive::{CentredBox, Cylinder, HalfSpace, Primitive, Sphere, Torus};
use rayweave_trace::Packets;
use std::f64::consts::PI;
use std::num::NonZeroUsize;
use std::sync::Arc;

fn sphere(radius: f64) -> Solid {
    Solid::from(Primitive::from(Sphere::new(radius).unwrap()))
}

fn cube(size: f64) -> Solid {
    Solid::from(Primitive::from(CentredBox::new(Vec3::splat(size)).unwrap()))
}

fn one(solid: &Solid, settings: &MeasureSettings) -> Measured {
    let program = Arc::new(Program::compile(solid).unwrap());
    measure(&Packets::new(program), settings, &mut |_| ()).unwrap().regions.remove(0)
}

fn quick() -> MeasureSettings {
    MeasureSettings { precision: 3e-3, ..MeasureSettings::default() }
}

#[test]
fn a_ball_far_from_the_origin() {
    let at = Vec3::new(100.0, -20.0, 3.0);
    let found = one(&sphere(2.0).translate(at), &quick());
    let (volume, area) = (32.0 / 3.0 * PI, 16.0 * PI);
    assert!(found.is_reached && found.volume.half_width < 3e-3 * volume, "{found:?}");
    assert!(found.volume.contains(volume) && found.area.contains(area), "{found:?}");
    assert!(found.area.half_width < 0.01 * area);
    let centre = found.centre.unwrap();
    assert!((0..3).all(|k| centre[k].contains(at[k]) && centre[k].half_width < 0.01), "{centre:?}");
    let longest = found.longest.unwrap();
    assert!(longest.length() > 3.99 && longest.length() <= 4.0 && (longest.from - at).length() < 2.0 + 1e-9);
    // 2/5 V r^2, and 0 off the diagonal
    let moment = 0.4 * volume * 4.0;
    for i in 0..3 {
        for j in 0..3 {
            let expected = if i == j { moment } else { 0.0 };
            assert!(found.inertia[i][j].contains(expected), "{i} {j} {:?}", found.inertia[i][j]);
        }
    }
}

/// Two cubes that have only a face in common.
#[test]
fn a_box_of_zero_width_has_no_volume() {
    let found = one(&(cube(2.0) & cube(2.0).translate(2.0 * Vec3::X)), &quick());
    assert_eq!((found.volume.value, found.volume.half_width), (0.0, 0.0), "{found:?}");
    assert!(found.is_reached && found.centre.is_none(), "{found:?}");
}

#[test]
fn flat_faces_are_exact() {
    let solid = cube(2.0).scale(Vec3::new(1.0, 2.0, 3.0)).rotate_z(90.0);
    let found = one(&solid, &quick());
    assert!((found.volume.value - 48.0).abs() < 1e-9 && found.volume.half_width < 1e-9, "{found:?}");
    assert!((found.area.value - 88.0).abs() < 1e-9, "{found:?}");
    let expected = 48.0 * (4.0 * 4.0 + 6.0 * 6.0) / 12.0;
    assert!(found.inertia[1][1].contains(expected), "{:?} {expected}", found.inertia[1][1]);
}

/// With a confidence of 90 %, each interval misses the value with probability 0.1; more than 35 of 200 do so
/// with probability 4e-4.
#[test]
fn confidence_is_kept() {
    let torus = Solid::from(Primitive::from(Torus::new(1.0, 0.4).unwrap())).rotate_x(35.0);
    let (volume, area) = (2.0 * PI * PI * 0.16, 4.0 * PI * PI * 0.4);
    let evaluator = Packets::new(Arc::new(Program::compile(&torus).unwrap()));
    let (mut volumes, mut areas) = (0, 0);
    for seed in 0..200 {
        let settings =
            MeasureSettings { seed, confidence: 0.9, precision: 1.0, ..MeasureSettings::default() };
        let found = &measure(&evaluator, &settings, &mut |_| ()).unwrap().regions[0];
        volumes += u32::from(!found.volume.contains(volume));
        areas += u32::from(!found.area.contains(area));
    }
    assert!(volumes <= 35 && areas <= 35, "{volumes} and {areas} of 200 intervals miss");
    assert!(volumes >= 5 && areas >= 5, "the intervals are too wide: {volumes} and {areas} of 200 miss");
}

/// Later regions cut earlier ones; a small region is found in its own box.
#[test]
fn regions_of_a_partition() {
    let region = |name: &str, solid: Solid, medium: u32| Region { name: name.to_owned(), solid, medium };
    let dot = Vec3::new(4.0, 4.0, 4.0);
    let regions = [
        region("block", cube(10.0), 1),
        region("bubble", sphere(3.0), 2),
        region("dot", sphere(0.01).translate(dot), 1),
    ];
    let program = Arc::new(Program::compile_regions(&one_medium_each(&regions)).unwrap());
    let found = measure(&Packets::new(program), &quick(), &mut |_| ()).unwrap();
    let (bubble, dot) = (36.0 * PI, 4e-6 / 3.0 * PI);
    let expected = [1000.0 - bubble - dot, bubble, dot];
    for (region, expected) in found.regions.iter().zip(expected) {
        assert!(region.is_reached && region.volume.contains(expected), "{region:?} {expected}");
    }
    assert_eq!(found.regions[2].name, "dot");
    assert!(found.volume().contains(1000.0));
    // the surface of the bubble also belongs to the block
    let areas = [600.0 + 36.0 * PI + 4e-4 * PI, 36.0 * PI, 4e-4 * PI];
    for (region, expected) in found.regions.iter().zip(areas) {
        assert!(region.area.contains(expected), "{region:?} {expected}");
    }
}

#[test]
fn within_a_box() {
    let below = Solid::from(Primitive::from(HalfSpace::new(Vec3::Z, 0.0).unwrap()));
    let within = Bounds::new(Vec3::new(0.0, 0.0, -1.0), Vec3::new(2.0, 3.0, 5.0));
    let found = one(&below, &MeasureSettings { within: Some(within), ..quick() });
    assert!((found.volume.value - 6.0).abs() < 1e-12 && (found.area.value - 6.0).abs() < 1e-12, "{found:?}");
}

/// After the first round, no region gets more than `most_rays` rays.
#[test]
fn no_more_rays_than_requested() {
    let first = 6 * super::run::FIRST_ACROSS * super::run::FIRST_ACROSS;
    for most_rays in [0, 1, 6, 1000, 50_000, 123_456] {
        let found =
            one(&sphere(2.0), &MeasureSettings { most_rays, precision: 1e-9, ..MeasureSettings::default() });
        assert!(found.rays <= most_rays + first, "{most_rays}: {}", found.rays);
        assert!(most_rays < 1000 || found.rays > most_rays * 99 / 100, "{most_rays}: {}", found.rays);
        assert!(!found.is_reached && found.volume.contains(32.0 * PI / 3.0), "{most_rays}: {found:?}");
    }
}

#[test]
fn empty_regions() {
    let apart = cube(1.0) & cube(1.0).translate(Vec3::new(0.5, 0.5, 2.0));
    let found = one(&apart, &quick());
    assert_eq!((found.volume.value, found.volume.half_width, found.centre), (0.0, 0.0, None));
    // the boxes intersect, but not their contents
    let corner = Vec3::splat(0.99 / 3f64.sqrt() * 2.0);
    let spheres = sphere(1.0) & sphere(1.0).translate(corner * 1.1);
    let found = one(&spheres, &quick());
    // which rays alone cannot prove
    assert_eq!((found.volume.value, found.is_reached), (0.0, false), "{found:?}");
    assert!(found.volume.half_width > 0.0 && found.volume.half_width < 1e-3, "{found:?}");
}

/// A region that is small in its box: cut from a huge plate and subtracted from it again.
#[test]
fn a_region_that_no_ray_crosses_may_exist() {
    let plate = cube(1.0).scale(Vec3::new(1e6, 1e6, 1.0));
    let solid = &plate - &(&plate - &cube(1.0).scale(Vec3::new(10.0, 10.0, 1.0)));
    let found = one(&solid, &quick());
    assert!(found.longest.is_none() && !found.is_reached, "{found:?}");
    assert!(found.volume.contains(100.0) && found.area.contains(240.0), "{found:?}");
}

#[test]
fn the_same_for_any_number_of_threads() {
    let solid = sphere(1.0) - cube(1.0).rotate_x(30.0);
    let on =
        |threads: usize| one(&solid, &MeasureSettings { threads: NonZeroUsize::new(threads), ..quick() });
    assert_eq!(on(1), on(3));
    assert_ne!(on(1).volume, one(&solid, &MeasureSettings { seed: 1, ..quick() }).volume);
}

#[test]
fn formulas() {
    let rod = Solid::from(Primitive::from(Cylinder::new(1.0, 2.0).unwrap()));
    let moved = rod.scale(Vec3::new(1.0, 2.0, -3.0)).named("rod").rotate_x(10.0);
    assert!((exact_volume(&moved).unwrap() - 12.0 * PI).abs() < 1e-12);
    assert_eq!(exact_volume(&(&moved | &rod)), None);
    assert_eq!(exact_volume(&Solid::empty()), Some(0.0));
    assert_eq!(exact_volume(&Solid::universe()), Some(f64::INFINITY));
}

#[test]
fn refusals() {
    let message = |solid: &Solid, settings: MeasureSettings| {
        let program = Arc::new(Program::compile(solid).unwrap());
        measure(&Packets::new(program), &settings, &mut |_| ()).unwrap_err().to_string()
    };
    let rod = Solid::from(Primitive::from(Cylinder::new(1.0, f64::INFINITY).unwrap()));
    assert_eq!(
        message(&rod.named("rod"), quick()),
        "rod is unbounded in z: it has no volume. Intersect it with a box, or measure it within one."
    );
    assert!(message(&sphere(1e40), quick()).contains(" extends to 1e40: "));
    assert!(
        message(&sphere(1.0), MeasureSettings { precision: 0.0, ..quick() })
            .starts_with("the precision is 0")
    );
    assert!(
        message(&sphere(1.0), MeasureSettings { precision: f64::NAN, ..quick() })
            .starts_with("the precision is NaN")
    );
    assert!(
        message(&sphere(1.0), MeasureSettings { confidence: 1.0, ..quick() })
            .starts_with("the confidence is 1")
    );
    let swapped = Bounds::new(Vec3::ONE, Vec3::ZERO);
    assert!(
        message(&sphere(1.0), MeasureSettings { within: Some(swapped), ..quick() })
            .starts_with("the box extends")
    );
    let cancel = Cancel::new();
    cancel.cancel();
    assert_eq!(message(&sphere(1.0), MeasureSettings { cancel, ..quick() }), "cancelled");
}
