//! Faces of different placements that lie in one surface, up to rounding.

use super::{adapter, check, chords, shape};
use rayweave_conformance::Random;
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Program, RayBatch, Region, Solid};
use rayweave_shape::Ray;
use std::sync::Arc;

fn block(size: [f64; 3], at: [f64; 3]) -> Solid {
    let solid = shape("box", &[("size", Vec3::from_array(size).into())]);
    solid.apply(Affine::translate(Vec3::from_array(at)))
}

fn rod(radius: f64, height: f64) -> Solid {
    shape("cylinder", &[("radius", radius.into()), ("height", height.into())])
}

/// Rays between random points, and rays along the z axis of a turned frame, which cross its faces perpendicularly.
fn rays(rng: &mut Random, turn: &Affine) -> RayBatch {
    let across = (0..6000).map(|k| {
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        let start = rng.point(1.2);
        Ray::new(turn.point(Vec3::new(start.x, start.y, -3.0 * sign)), turn.vector(Vec3::Z * sign))
    });
    let mut all: RayBatch = across.collect();
    let oblique = chords(rng, 0.8, 14_000);
    all.extend(oblique.rays(), 0..oblique.len());
    all
}

/// A gear: the faces of the teeth lie in those of the disc and of the rim. Bearings: copies share flat and curved faces.
#[test]
fn faces_of_placed_solids_in_one_surface() {
    let Some(adapter) = adapter() else { return };
    let mut rng = Random::new(23);
    let oblique =
        Affine::rotation(Vec3::new(0.48, 0.6, 0.64), 37.0).then(&Affine::translate(Vec3::splat(0.1)));
    for turn in [Affine::IDENTITY, oblique] {
        let tooth = block([0.5, 0.1, 0.4], [0.8, 0.0, 0.0]);
        let maps = |count: usize| -> Vec<Affine> {
            (0..count)
                .map(|k| Affine::rotation(Vec3::Z, 360.0 * k as f64 / count as f64).then(&turn))
                .collect()
        };
        let (disc, rim) = (rod(0.6, 0.4).apply(turn), rod(1.0, 0.4).apply(turn));
        // teeth overlap within the disc; the keyways and the bore end outside, in common planes
        let keyway = block([0.4, 0.06, 1.0], [0.2, 0.0, 0.0]).place(maps(3));
        let bore = rod(0.25, 1.0).apply(turn);
        let gear = (disc | tooth.place(maps(8)) & rim) - (keyway | bore);
        // three placements of one cylinder, each with another half removed, and two of a longer hole
        let half = block([2.0, 2.0, 2.0], [1.0, 0.0, 0.0]);
        let bearings = (rod(0.7, 0.5) - half).place(maps(3)) - rod(0.3, 0.8).place(maps(2));
        for (name, solid) in [("gear", &gear), ("bearings", &bearings)] {
            let program = Arc::new(Program::compile(solid).unwrap());
            let report = check(&adapter, &program, &rays(&mut rng, &turn), name).unwrap();
            println!("{name}: {report:?}, share of the CPU {:.4}", report.cpu_share());
            assert!(report.cpu_share() < 0.01, "{name}: {report:?}");
        }
    }
}

/// Plates of two regions, placed beside each other: where one ends and the other begins, the order of the faces matters, and the CPU
/// decides.
#[test]
fn touching_regions() {
    let Some(adapter) = adapter() else { return };
    let mut rng = Random::new(29);
    let turn = Affine::rotation(Vec3::new(0.48, 0.6, 0.64), 37.0);
    let plate = block([1.0, 1.0, 0.2], [0.0, 0.0, 0.0]);
    let stack = |from: usize| -> Vec<Affine> {
        let up = |k: usize| Affine::translate(Vec3::new(0.0, 0.0, 0.2 * (k as f64 - 2.0)));
        (from..5).step_by(2).map(|k| up(k).then(&turn)).collect()
    };
    for media in [[1, 2], [1, 1]] {
        let region = |name: &str, from: usize, medium: u32| Region {
            name: name.to_owned(),
            solid: plate.place(stack(from)),
            medium,
        };
        let regions = [region("even", 0, media[0]), region("odd", 1, media[1])];
        let program = Arc::new(Program::compile_regions(&regions).unwrap());
        let report = check(&adapter, &program, &rays(&mut rng, &turn), "plates").unwrap();
        println!("{media:?}: {report:?}");
        // the first crossing is that of an outer face, except of rays that start inside
        assert!(report.uncertain > 0 && report.cpu_share() < 0.3, "{media:?}: {report:?}");
    }
}
