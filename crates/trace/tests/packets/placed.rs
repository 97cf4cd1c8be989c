//! Copies of solids, placed by maps of all kinds, that touch or nearly touch.

use crate::aim::{Target, aimed};
use crate::arrange::gap;
use crate::crowd::member;
use crate::oracle::{Oracle, Setting, levels};
use crate::{bundles, frame};
use rayweave_conformance::Random;
use rayweave_conformance::rays::batch;
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Evaluator, FirstHits, Program, Region, Solid, Window};
use rayweave_shape::Ray;
use rayweave_trace::Packets;
use std::sync::Arc;

/// A map onto or next to a grid point: identity, rotation, reflection, scaling or shear, then a translation.
fn map(rng: &mut Random) -> Affine {
    let at = Vec3::new(rng.below(4) as f64 - 1.5, rng.below(4) as f64 - 1.5, rng.below(3) as f64 - 1.0);
    let shear = |by: f64| {
        let rows = [[1.0, by, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
        Affine::from_rows(&rows).expect("an affine map")
    };
    let turn = match rng.below(8) {
        0..3 => Affine::IDENTITY,
        3 => Affine::rotation(rng.pick(&Vec3::AXES), rng.pick(&[90.0, 180.0, 270.0])),
        4 => Affine::rotation(rng.direction(), rng.between(-180.0, 180.0)),
        5 => Affine::mirror(rng.pick(&Vec3::AXES)),
        6 => Affine::scale(Vec3::new(1.0, rng.pick(&[0.5, 1.0 + 1e-9]), -1.0)),
        _ => shear(rng.pick(&[0.5, -1.0, 1e-9])),
    };
    turn.then(&Affine::translate(at + gap(rng) * rng.pick(&Vec3::AXES)))
}

fn maps(rng: &mut Random, count: usize) -> Vec<Affine> {
    (0..count).map(|_| map(rng)).collect()
}

/// Copies of one solid, or of a group of copies, by translations or by arbitrary maps.
fn copies(rng: &mut Random) -> Solid {
    let parts = (0..1 + rng.below(3)).map(|_| member(rng)).collect::<Vec<_>>();
    let part = Solid::union(parts);
    let count = 2 + rng.below(12);
    match rng.below(4) {
        0 => {
            let some = maps(rng, 2);
            let inner = part.place(some) | member(rng).translate([0.0, 0.0, 1.0]);
            inner.apply(map(rng)).place(maps(rng, 4))
        }
        1 => {
            part.place((0..count).map(|k| Affine::translate(Vec3::X * (k as f64 - 3.0))).collect::<Vec<_>>())
        }
        _ => part.apply(map(rng)).place(maps(rng, count)),
    }
}

/// One or two regions of copies, some of them beside solids that are not placed, with targets.
fn placed(rng: &mut Random, frame: &Affine) -> (Vec<Region>, Vec<Target>) {
    let regions = (0..1 + rng.below(2)).map(|k| {
        let all = (0..1 + rng.below(2)).map(|_| copies(rng)).collect::<Vec<_>>();
        let beside = (0..rng.below(3)).map(|_| member(rng).apply(map(rng))).collect::<Vec<_>>();
        let solid = Solid::union(all.into_iter().chain(beside).collect::<Vec<_>>());
        Region { name: format!("copies {k}"), solid: solid.apply(*frame), medium: 1 + k as u32 % 2 }
    });
    let regions = regions.collect();
    let target = |rng: &mut Random| {
        let axis = rng.below(3);
        let (normal, along) = (Vec3::AXES[axis], Vec3::AXES[(axis + 1) % 3]);
        let point = map(rng).point(0.5 * normal + rng.pick(&[0.0, 0.5, 0.1]) * along);
        Target::new(point, normal, along)
    };
    (regions, (0..8).map(|_| target(rng)).collect())
}

/// Compares all queries on placed solids, with bundles and with single rays.
fn check(models: u64, least: u64) {
    let mut oracle = Oracle::new("placed solids");
    for seed in 0..models {
        let rng = &mut Random::new(8 << 40 | seed);
        let frame = frame(rng);
        let (regions, targets) = placed(rng, &frame);
        let mut rays = bundles(rng, &targets, 48);
        rays.extend((0..16).map(|_| aimed(rng, &targets)));
        let rays = rays.into_iter().map(|ray| ray.transformed(&frame)).collect();
        let Some(setting) = Setting::new(regions, rays, format!("placed {seed}")) else { continue };
        oracle.everything(&setting, rng, &levels());
    }
    oracle.finish(models * least);
}

#[test]
fn placed_solids() {
    check(150, 60);
}

#[test]
#[ignore = "long"]
fn long_placed_solids() {
    check(20_000, 60);
}

/// Number of leaves that the weave intersects for the first hits of rays.
fn fallback_leaf_count(solid: Solid, rays: &[Ray]) -> u64 {
    let program = Arc::new(Program::compile(&solid).expect("a legal model"));
    let packets = Packets::new(program);
    let mut scratch = packets.scratch();
    let n = rays.len();
    let (mut t, mut face) = (vec![0.0; n], vec![0; n]);
    let [mut placement, mut before, mut after] = [vec![0; n], vec![0; n], vec![0; n]];
    let mut hits = FirstHits {
        t: &mut t,
        face: &mut face,
        placement: &mut placement,
        before: &mut before,
        after: &mut after,
        normal: None,
    };
    packets.nearest(batch(rays).rays(), Window::ALL, &mut scratch, &mut hits);
    assert!(face.iter().filter(|&&face| face >= 0).count() > n / 4);
    scratch.fallback_leaf_count()
}

/// Rays in general position through placed solids are traced in lanes, whether they are close to each other
/// or not.
#[test]
fn lanes_answer_for_placed_solids() {
    let rng = &mut Random::new(3);
    let part = member(rng).scale([0.4, 0.4, 0.4]);
    let grid: Vec<Affine> = (0..125)
        .map(|k| Affine::translate(Vec3::new((k % 5) as f64, (k / 5 % 5) as f64, (k / 25) as f64) - 2.0))
        .collect();
    let nested = part.place([Affine::IDENTITY, Affine::rotation(Vec3::ONE, 50.0)]).place(grid.clone());
    let rays: Vec<Ray> = (0..2000)
        .map(|_| {
            let from = 9.0 * rng.direction();
            Ray::new(from, rng.point(2.0) - from)
        })
        .collect();
    for solid in [part.place(grid), nested] {
        let leaves = fallback_leaf_count(solid, &rays);
        assert!(leaves < 500, "{leaves} leaves were intersected one by one");
    }
}
