//! Tori on an adapter, against the CPU.

use super::{adapter, check, chords, shape, sphere};
use rayweave_conformance::Random;
use rayweave_gpu::{GpuProgram, GpuReport};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Evaluator, Program, Query, RayBatch, Region, RegionId, Solid, Window};
use rayweave_shape::Ray;
use rayweave_trace::Packets;
use std::num::NonZeroUsize;
use std::sync::Arc;

fn torus(major: f64, minor: f64) -> Solid {
    shape("torus", &[("major", major.into()), ("minor", minor.into())])
}

fn turned(rng: &mut Random, solid: &Solid, size: f64) -> Solid {
    let turn = Affine::rotation(rng.direction(), rng.between(-180.0, 180.0));
    solid.clone().apply(turn.then(&Affine::translate(rng.point(size))))
}

fn compiled(solid: &Solid) -> Arc<Program> {
    Arc::new(Program::compile(solid).unwrap())
}

/// Ring, horn and spindle tori, also thin ones and ones under a map that is no similarity: random rays, also from far away, from
/// inside and nearly parallel to the axis.
#[test]
fn tori_of_all_kinds() {
    kinds(8_000);
}

#[test]
#[ignore = "long"]
fn long_tori_of_all_kinds() {
    kinds(2_000_000);
}

fn kinds(count: usize) {
    let Some(adapter) = adapter() else { return };
    let mut rng = Random::new(31);
    let squashed = |solid: Solid| solid.apply(Affine::scale(Vec3::new(1.0, 0.9, 0.7)));
    let kinds = [
        ("ring", torus(1.0, 0.3)),
        ("thick ring", torus(1.0, 0.9)),
        ("thin ring", torus(1.0, 0.02)),
        ("horn", torus(0.7, 0.7)),
        ("spindle", torus(0.5, 0.8)),
        ("squashed", squashed(torus(1.0, 0.4))),
    ];
    let mut total = GpuReport::default();
    for (name, solid) in &kinds {
        let program = compiled(&turned(&mut rng, solid, 3.0));
        let (centre, half) = (program.bounds().centre(), 0.5 * program.bounds().size().length());
        let ray = |rng: &mut Random| {
            let target = centre + rng.point(0.7 * half);
            let origin = match rng.below(8) {
                0 => target + rng.point(0.2 * half),
                1 => centre + 1e3 * half * rng.direction(),
                _ => centre + 2.0 * half * rng.direction(),
            };
            Ray::new(origin, rng.between(0.2, 3.0) * (target - origin))
        };
        let rays: RayBatch = (0..count).map(|_| ray(&mut rng)).collect();
        let report = check(&adapter, &program, &rays, name).unwrap();
        println!("{name}: {:.4} % of the rays uncertain", 100.0 * report.cpu_share());
        assert!(report.cpu_share() < 0.01, "{name}: {report:?}");
        total.add(report);
    }
    println!("all: {:.4} %", 100.0 * total.cpu_share());
    assert!(total.cpu_share() < 0.005, "{total:?}");
}

/// Rays at special places of a torus, each moved by zero or by a distance between 1e-12 and 1e-2: tangent at the equators, at the
/// top circle at two points at once, at the cross section of a meridional plane, at a Villarceau circle, along the axis and
/// through the centre.
fn planted(rng: &mut Random, major: f64, minor: f64) -> Ray {
    let turn = Affine::rotation(Vec3::Z, rng.between(0.0, 360.0));
    let slope = (minor / major).min(1.0);
    let tilted = Vec3::new((1.0 - slope * slope).sqrt(), 0.0, slope);
    let at = rng.between(-3.0, -1.5) * (major + minor);
    let (origin, along) = match rng.below(9) {
        0 => (Vec3::new(major + minor, 0.0, 0.0), Vec3::Y),
        1 => (Vec3::new((major - minor).abs(), 0.0, 0.0), Vec3::Y),
        2 => (Vec3::new(rng.between(0.0, major), 0.0, minor), Vec3::Y),
        3 => (Vec3::new(major, 0.0, minor), rng.direction() * Vec3::new(1.0, 1.0, 0.0)),
        4 => (Vec3::ZERO, tilted),
        5 => (Vec3::new(0.0, rng.between(-1.0, 1.0) * minor, 0.0), tilted),
        6 => (Vec3::new(rng.between(0.0, major + minor), 0.0, 0.0), Vec3::Z),
        7 => (Vec3::ZERO, rng.direction()),
        _ => (Vec3::new(major, 0.0, 0.0), rng.direction()),
    };
    let size = if rng.chance(0.3) { 0.0 } else { rng.magnitude(-12.0, -2.0) };
    let along = along + if rng.chance(0.5) { Vec3::ZERO } else { size * rng.direction() };
    let origin = origin + size * rng.direction() + if rng.chance(0.9) { at * along } else { Vec3::ZERO };
    Ray::new(turn.point(origin), turn.vector(along))
}

#[test]
fn planted_rays() {
    special(6_000);
}

#[test]
#[ignore = "long"]
fn long_planted_rays() {
    special(1_000_000);
}

fn special(count: usize) {
    let Some(adapter) = adapter() else { return };
    let mut rng = Random::new(37);
    for (major, minor, is_turned) in
        [(1.0, 0.3, false), (1.0, 0.3, true), (1.0, 0.001, true), (0.6, 0.6, false), (0.4, 0.9, true)]
    {
        let turn = Affine::rotation(rng.direction(), 77.0).then(&Affine::translate(rng.point(5.0)));
        let map = if is_turned { turn } else { Affine::IDENTITY };
        let program = compiled(&torus(major, minor).apply(map));
        let ray = |rng: &mut Random| {
            let ray = planted(rng, major, minor);
            Ray::new(map.point(ray.origin), map.vector(ray.direction))
        };
        let rays: RayBatch = (0..count).map(|_| ray(&mut rng)).collect();
        let what = format!("radii {major} and {minor}");
        let report = check(&adapter, &program, &rays, &what).unwrap();
        println!("{what}: {:.1} % of the rays uncertain", 100.0 * report.cpu_share());
        // a third of the rays are exactly tangent or start on the torus
        assert!(report.uncertain > 0 && report.cpu_share() < 0.8, "{what}: {report:?}");
    }
}

/// Booleans of tori with each other and with other solids, also with a surface in common, and copies in a hierarchy.
#[test]
fn booleans_and_copies_of_tori() {
    let Some(adapter) = adapter() else { return };
    let mut rng = Random::new(41);
    let half = shape("half_space", &[("normal", Vec3::X.into()), ("offset", 0.1.into())]);
    let ring = torus(1.0, 0.4);
    let other = turned(&mut rng, &torus(0.8, 0.3), 0.3);
    let groove = sphere(1.0, Vec3::ZERO) - torus(1.0, 0.2);
    let (inner, outer) = (ring.clone() & half.clone(), ring.clone() - half.clone());
    let region =
        |name: &str, solid: &Solid, medium| Region { name: name.to_owned(), solid: solid.clone(), medium };
    let models = [
        vec![region("half ring", &inner, 1)],
        vec![region("two halves", &inner, 1), region("other half", &outer, 2)],
        vec![region("groove", &groove, 1), region("gasket", &torus(1.0, 0.2), 2)],
        vec![region("difference", &(ring.clone() - other.clone()), 1)],
        vec![region("either", &(ring.clone() ^ other.clone()), 1), region("both", &(ring & other), 2)],
        vec![region("hollow", &(torus(1.0, 0.4) - torus(1.0, 0.3)), 1)],
    ];
    for regions in &models {
        let name = &regions[0].name;
        let program = Arc::new(Program::compile_regions(regions).unwrap());
        let report = check(&adapter, &program, &chords(&mut rng, 1.2, 6_000), name).unwrap();
        println!("{name}: {:.3} % of the rays uncertain", 100.0 * report.cpu_share());
        assert!(report.cpu_share() < 0.02, "{name}: {report:?}");
    }
    // a link of a chain, placed, and alone in a large union
    let link = torus(0.1, 0.03) | sphere(0.05, Vec3::new(0.1, 0.0, 0.0));
    let maps: Vec<Affine> = (0..150)
        .map(|_| {
            Affine::rotation(rng.direction(), rng.between(0.0, 360.0))
                .then(&Affine::translate(rng.point(1.0)))
        })
        .collect();
    let placed = link.place(maps);
    let many = Solid::union((0..150).map(|_| turned(&mut rng, &torus(0.1, 0.03), 1.0)).collect::<Vec<_>>());
    for (name, solid) in [("placed", placed), ("union", many)] {
        let report = check(&adapter, &compiled(&solid), &chords(&mut rng, 1.0, 10_000), name).unwrap();
        println!("{name}: {:.3} % of the rays uncertain", 100.0 * report.cpu_share());
        assert!(report.cpu_share() < 0.02, "{name}: {report:?}");
    }
}

/// All crossings, four at most, and regions of points.
#[test]
fn all_crossings_and_regions_of_tori() {
    let Some(adapter) = adapter() else { return };
    let mut rng = Random::new(43);
    let program = compiled(&turned(&mut rng, &torus(1.0, 0.4), 1.0));
    let gpu = GpuProgram::new(&adapter, program.clone()).unwrap();
    let cpu = Packets::new(program.clone());
    let (centre, window) = (program.bounds().centre(), Window::new(0.0, f64::INFINITY).unwrap());
    let ray = |rng: &mut Random| Ray::new(centre + rng.point(2.0), rng.direction());
    let rays: RayBatch = (0..10_000).map(|_| ray(&mut rng)).collect();
    let (ours, report) = gpu.crossings(rays.rays(), NonZeroUsize::new(4).unwrap()).unwrap();
    let theirs = cpu.collect(rays.rays(), &Query { window, ..Query::default() }).unwrap();
    assert_eq!(ours, theirs);
    assert!(report.cpu_share() < 0.01, "{report:?}");
    let most = ours.offsets.windows(2).map(|ends| ends[1] - ends[0]).max();
    assert_eq!(most, Some(4));
    let mut regions = vec![RegionId(7); rays.len()];
    gpu.regions_at(rays.rays().origins, &mut regions).unwrap();
    assert!(ours.starts.iter().zip(&regions).all(|(start, region)| start == region));
}
