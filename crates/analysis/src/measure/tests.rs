//! Tests of measurements against closed forms, and of the coverage of their confidence intervals.

use super::*;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::drive::Cancel;
use rayweave_model::{Program, Region, Solid};
use rayweave_shape::primitive::{BoxFromCorners, CentredBox, Cylinder, HalfSpace, Primitive, Sphere, Torus};
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
    // the inertia of a ball: 2/5 V r^2 on the diagonal, 0 off it
    let moment = 0.4 * volume * 4.0;
    for i in 0..3 {
        for j in 0..3 {
            let expected = if i == j { moment } else { 0.0 };
            assert!(found.inertia[i][j].contains(expected), "{i} {j} {:?}", found.inertia[i][j]);
        }
    }
}

/// The intersection of two cubes that have only a face in common.
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

/// With a confidence of 90 %, each interval misses the value with probability 0.1. Of 200 intervals, more than 35
/// miss with probability 4e-4, and fewer than 5 with probability 8e-6.
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

/// Measures a large and a small ball with many seeds, to a precision that the first round reaches for about a fourth of the seeds, at a
/// confidence of 90 %; returns for each ball the number of intervals that miss its volume, and the mean error in units of its
/// standard deviation.
fn misses_and_bias(seeds: u64) -> [(u64, f64); 2] {
    let region = |name: &str, solid: Solid, medium: u32| Region { name: name.to_owned(), solid, medium };
    let small = sphere(0.08).translate(3.0 * Vec3::X);
    let program = Program::compile_regions(&[region("large", sphere(1.0), 1), region("small", small, 2)]);
    let evaluator = Packets::new(Arc::new(program.unwrap()));
    let exact = [4.0 / 3.0 * PI, 4.0 / 3.0 * PI * 0.08f64.powi(3)];
    let (mut misses, mut errors) = ([0, 0], [vec![], vec![]]);
    let (mut rays, mut is_reached) = (0, true);
    for seed in 0..seeds {
        let settings =
            MeasureSettings { seed, confidence: 0.9, precision: 0.116, ..MeasureSettings::default() };
        let found = measure(&evaluator, &settings, &mut |_| ()).unwrap();
        rays += found.rays;
        for (k, own) in found.regions.iter().enumerate() {
            is_reached &= own.is_reached;
            misses[k] += u64::from(!own.volume.contains(exact[k]));
            errors[k].push(own.volume.value / exact[k] - 1.0);
        }
    }
    // a pilot in two boxes and the two rounds that are reported
    assert!(is_reached && rays < 75_000 * seeds, "{rays}");
    let bias = |errors: &[f64]| {
        let count = errors.len() as f64;
        let mean = errors.iter().sum::<f64>() / count;
        let squares: f64 = errors.iter().map(|error| (error - mean).powi(2)).sum();
        mean / (squares / (count - 1.0) / count).sqrt()
    };
    [0, 1].map(|k| (misses[k], bias(&errors[k])))
}

/// Of 300 intervals, more than 49 miss the volume with a probability of 2e-4, and a mean beyond four standard deviations has one of 6e-5.
#[test]
fn the_number_of_rays_does_not_bias_volumes() {
    for (misses, bias) in misses_and_bias(300) {
        assert!(
            misses <= 49 && bias.abs() < 4.0,
            "{misses} of 300 intervals miss, mean error {bias} deviations"
        );
    }
}

/// Of 5,000 intervals, more than 585 miss with a probability of 3e-5.
#[test]
#[ignore = "long"]
fn long_the_number_of_rays_does_not_bias_volumes() {
    for (misses, bias) in misses_and_bias(5_000) {
        assert!(
            misses <= 585 && bias.abs() < 4.0,
            "{misses} of 5000 intervals miss, mean error {bias} deviations"
        );
    }
}

/// Later regions are cut out of earlier ones; rays through its own box find a small region.
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

/// The faces of the box do not count as boundary.
#[test]
fn within_a_box() {
    let below = Solid::from(Primitive::from(HalfSpace::new(Vec3::Z, 0.0).unwrap()));
    let within = Bounds::new(Vec3::new(0.0, 0.0, -1.0), Vec3::new(2.0, 3.0, 5.0));
    let found = one(&below, &MeasureSettings { within: Some(within), ..quick() });
    assert!((found.volume.value - 6.0).abs() < 1e-12 && (found.area.value - 6.0).abs() < 1e-12, "{found:?}");
}

/// The first round does not count towards `most_rays`.
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
    // the bounding boxes intersect, but the spheres do not
    let corner = Vec3::splat(0.99 / 3f64.sqrt() * 2.0);
    let spheres = sphere(1.0) & sphere(1.0).translate(corner * 1.1);
    let found = one(&spheres, &quick());
    // rays alone cannot prove that the volume is 0
    assert_eq!((found.volume.value, found.is_reached), (0.0, false), "{found:?}");
    assert!(found.volume.half_width > 0.0 && found.volume.half_width < 1e-3, "{found:?}");
}

/// A region much smaller than its bounding box: a block, written as a plate minus the rest of the plate. The box is
/// that of the plate.
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
fn exact_volumes() {
    let rod = Solid::from(Primitive::from(Cylinder::new(1.0, 2.0).unwrap()));
    let moved = rod.scale(Vec3::new(1.0, 2.0, -3.0)).named("rod").rotate_x(10.0);
    assert!((exact_volume(&moved).unwrap() - 12.0 * PI).abs() < 1e-12);
    assert_eq!(exact_volume(&(&moved | &rod)), None);
    assert_eq!(exact_volume(&Solid::empty()), Some(0.0));
    assert_eq!(exact_volume(&Solid::universe()), Some(f64::INFINITY));
}

#[test]
fn errors() {
    let message = |solid: &Solid, settings: MeasureSettings| {
        let program = Arc::new(Program::compile(solid).unwrap());
        measure(&Packets::new(program), &settings, &mut |_| ()).unwrap_err().to_string()
    };
    let rod = Solid::from(Primitive::from(Cylinder::new(1.0, f64::INFINITY).unwrap()));
    assert_eq!(
        message(&rod.named("rod"), quick()),
        "rod is unbounded in z: it has no volume. Intersect it with a box, or measure the part within one: --within LO HI, in Python within=(lo, hi)."
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

/// Balls on a lattice, each a region, in a box that is a region too: rays are shared, `most_rays` bounds all of them, and the
/// intervals hold the closed forms.
#[test]
fn many_regions_share_their_rays() {
    let places = (0..5 * 5 * 4).map(|k| Vec3::new((k % 5) as f64, (k / 5 % 5) as f64, (k / 25) as f64));
    let ball = |k: usize, at: Vec3| Region {
        name: format!("ball {k}"),
        solid: sphere(0.2 + 0.002 * k as f64).translate(at),
        medium: k as u32 + 2,
    };
    let world = Region { name: "world".to_owned(), solid: cube(12.0), medium: 1 };
    let mut regions = vec![world];
    regions.extend(places.enumerate().map(|(k, at)| ball(k, at)));
    let program = Arc::new(Program::compile_regions(&regions).unwrap());
    let balls: f64 = (0..100).map(|k| 4.0 / 3.0 * PI * (0.2 + 0.002 * k as f64).powi(3)).sum();
    let first = 6 * super::run::FIRST_ACROSS * super::run::FIRST_ACROSS;
    for most_rays in [0, 1000, 200_000] {
        let settings = MeasureSettings { most_rays, precision: 1e-3, ..MeasureSettings::default() };
        let found = measure(&Packets::new(program.clone()), &settings, &mut |_| ()).unwrap();
        assert!(found.rays <= first + most_rays && found.rays >= most_rays * 99 / 100, "{}", found.rays);
        // 99 % intervals of the volumes and the areas of 100 balls: more than six misses have a probability of 1e-4, for each
        // quantity; a ball that few rays hit has no meaningful interval
        if most_rays == 200_000 {
            let radius = |k: usize| 0.2 + 0.002 * k as f64;
            let missed =
                |k: &usize| !found.regions[k + 1].volume.contains(4.0 / 3.0 * PI * radius(*k).powi(3));
            assert!((0..100).filter(missed).count() <= 6, "{found:?}");
            let missed = |k: &usize| !found.regions[k + 1].area.contains(4.0 * PI * radius(*k).powi(2));
            assert!((0..100).filter(missed).count() <= 6, "{found:?}");
            assert!(
                found.regions[1..].iter().all(|own| own.volume.half_width < 0.12 * own.volume.value),
                "{found:?}"
            );
        }
        let world = &found.regions[0];
        assert!(world.volume.contains(12f64.powi(3) - balls) && world.is_reached, "{world:?}");
    }
}

/// Small regions far apart: each is sampled in its own box, and all of them reach the precision.
#[test]
fn many_regions_far_apart_have_rounds_of_their_own() {
    let place =
        |k: usize| Vec3::new((k * k) as f64, (37 * k % 41) as f64 * 30.0, (k * 53 % 43) as f64 * 30.0);
    let ball = |k: usize| Region {
        name: format!("ball {k}"),
        solid: sphere(0.5).translate(place(k)),
        medium: k as u32 + 1,
    };
    let regions: Vec<Region> = (0..40).map(ball).collect();
    let program = Arc::new(Program::compile_regions(&regions).unwrap());
    let settings = MeasureSettings { precision: 1e-2, ..MeasureSettings::default() };
    let found = measure(&Packets::new(program), &settings, &mut |_| ()).unwrap();
    let missed = found.regions.iter().filter(|own| !own.volume.contains(PI / 6.0)).count();
    assert!(found.regions.iter().all(|own| own.is_reached) && missed <= 4, "{missed}: {found:?}");
}

/// The relative half width of shells does not depend on their thickness, down to a thousandth of a rounding error of squares.
#[test]
fn shares_of_thin_shells_have_intervals() {
    let settings = MeasureSettings::default();
    let relative = |thickness: f64| {
        let shell = &sphere(1000.0) - &sphere(1000.0 - thickness);
        let evaluator = Packets::new(Arc::new(Program::compile(&shell).unwrap()));
        let cells = 0..cell_count(6000);
        let share = MeasureShare::trace(&evaluator, &settings, 6000, cells, &mut |_| ()).unwrap();
        let volume = share.report(&evaluator, &settings).unwrap().regions[0].volume;
        assert!(volume.contains(4e6 * PI * thickness), "{thickness}: {volume:?}");
        volume.half_width / volume.value
    };
    let thick = relative(1e-2);
    for thickness in [1e-5, 1e-8] {
        let ratio = relative(thickness) / thick;
        assert!((0.5..2.0).contains(&ratio), "{thickness}: {ratio}");
    }
}

/// A given number of rays holds where many shapes overlap; the automatic number shrinks with the number of shapes that a ray reaches.
#[test]
fn given_numbers_of_rays_hold_where_shapes_overlap() {
    let balls = Solid::union((0..64).map(|k| sphere(1.0).translate(1e-3 * k as f64 * Vec3::X)));
    let first = 6 * super::run::FIRST_ACROSS * super::run::FIRST_ACROSS;
    let limited = MeasureSettings {
        precision: 1e-9,
        most_rays: 40_000,
        most_reached: Some(640_000),
        ..MeasureSettings::default()
    };
    let rays = |settings: &MeasureSettings| one(&balls, settings).rays;
    // those of the first round count as well
    let few = rays(&limited);
    assert!((9_000..=10_600).contains(&few), "{few}");
    let all = rays(&limited.with_most_rays(Some(40_000))) - first;
    assert!((39_000..=40_000).contains(&all), "{all}");
}

/// Rays along a row of fins, which have equal chords, are few; all rays together reach no more shapes than allowed.
#[test]
fn few_rays_pass_along_a_row_of_fins() {
    let fin = |k: usize| {
        let lo = Vec3::new(2.0 * k as f64, 0.0, 0.0);
        Solid::from(Primitive::from(BoxFromCorners::new(lo, lo + Vec3::new(1.0, 30.0, 30.0)).unwrap()))
    };
    let program = Arc::new(Program::compile(&Solid::union((0..1500).map(fin))).unwrap());
    let counted = crate::counted::Counted::new(program);
    let settings = MeasureSettings { most_reached: Some(1 << 21), ..MeasureSettings::default() };
    let found = measure(&counted, &settings, &mut |_| ()).unwrap();
    assert!(found.regions[0].volume.contains(1500.0 * 900.0), "{:?}", found.regions[0].volume);
    assert!(
        found.regions[0].area.contains(1500.0 * (2.0 * 900.0 + 4.0 * 30.0)),
        "{:?}",
        found.regions[0].area
    );
    let [rays, _] = counted.take();
    // the rays along x reach 1,500 fins each, the others one or none
    assert!(rays == found.rays && counted.take_crossings() <= 2 << 21, "{rays}");
    assert!(rays > 14_000, "{rays}");
}

/// All rays of a measurement reach no more shapes than allowed: those of the first round, those through the box of a region in which
/// rays reach many more shapes than elsewhere, and those of all regions together.
#[test]
fn the_work_of_a_measurement_is_limited() {
    // a stack of 300 plates in each of some places of a large world
    let plate = |place: usize, k: usize| {
        let lo = 1e3 * Vec3::new((place % 8) as f64, (place / 8) as f64, 0.0) + 2.0 * k as f64 * Vec3::Z;
        let size = Vec3::new(600.0, 600.0, 1.0);
        Solid::from(Primitive::from(BoxFromCorners::new(lo, lo + size).unwrap())).rotate_x(1e-4)
    };
    let stack = |place: usize| Region {
        name: place.to_string(),
        solid: Solid::union((0..300).map(|k| plate(place, k))),
        medium: place as u32 + 1,
    };
    let ball = Region { name: "ball".to_owned(), solid: sphere(1e5), medium: 100 };
    for count in [1, 8, 40] {
        let regions: Vec<Region> = std::iter::once(ball.clone()).chain((0..count).map(stack)).collect();
        let counted = crate::counted::Counted::new(Arc::new(Program::compile_regions(&regions).unwrap()));
        for most in [1 << 16, 1 << 20] {
            let settings =
                MeasureSettings { precision: 1e-9, most_reached: Some(most), ..MeasureSettings::default() };
            let found = measure(&counted, &settings, &mut |_| ()).unwrap();
            // each shape that a ray reaches is crossed twice at most, and the last round may end a little beyond the limit
            let (crossings, [rays, _]) = (counted.take_crossings(), counted.take());
            assert!(crossings <= 5 * most / 2 && rays <= most + 10_000, "{count} {most}: {crossings} {rays}");
            let exact = 300.0 * 360_000.0;
            let missed = found.regions[1..].iter().filter(|own| !own.volume.contains(exact)).count();
            // more than three misses of 40 have a probability of 6e-4
            assert!(missed <= 3, "{count} {most} {missed}: {found:?}");
        }
    }
}

#[test]
fn the_part_of_a_measurement_that_is_done() {
    let now = |precision: f64| MeasureProgress { rays: 1, precision };
    assert_eq!((now(f64::INFINITY).part_done(1e-3), now(1e-4).part_done(1e-3)), (0.0, 1.0));
    // eight times the precision needs 16 times the rays
    assert!((now(8e-3).part_done(1e-3) - 1.0 / 16.0).abs() < 1e-15);
}
