//! Copies of solids, placed by maps of all kinds, that touch or nearly touch.

use crate::aim::{Target, aimed};
use crate::arrange::gap;
use crate::crowd::member;
use crate::oracle::{Oracle, Setting, levels};
use crate::{bundles, frame};
use rayweave_conformance::rays::batch;
use rayweave_conformance::{Random, scale};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Evaluator, FirstHits, Program, Query, RayAnswer, Region, Solid, Window};
use rayweave_shape::Ray;
use rayweave_trace::{Packets, Reference, Weave};
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
    (regions, targets(rng))
}

/// Points on faces of copies, and in their edges.
fn targets(rng: &mut Random) -> Vec<Target> {
    let target = |rng: &mut Random| {
        let axis = rng.below(3);
        let (normal, along) = (Vec3::AXES[axis], Vec3::AXES[(axis + 1) % 3]);
        let point = map(rng).point(0.5 * normal + rng.pick(&[0.0, 0.5, 0.1]) * along);
        Target::new(point, normal, along)
    };
    (0..8).map(|_| target(rng)).collect()
}

/// Compares all queries on named regions, with so many rays in bundles and with single rays, aimed at targets before the frame.
fn examine(
    oracle: &mut Oracle,
    rng: &mut Random,
    (regions, name): (Vec<Region>, String),
    (targets, frame): (&[Target], &Affine),
    count: usize,
) {
    let mut rays = bundles(rng, targets, count);
    rays.extend((0..16).map(|_| aimed(rng, targets)));
    let rays = rays.into_iter().map(|ray| ray.transformed(frame)).collect();
    if let Some(setting) = Setting::new(regions, rays, name) {
        oracle.everything(&setting, rng, &levels());
    }
}

/// Compares all queries on placed solids, with bundles and with single rays.
fn check(models: u64, least: u64) {
    let mut oracle = Oracle::new("placed solids");
    for seed in 0..models {
        let rng = &mut Random::new(8 << 40 | seed);
        let frame = frame(rng);
        let (regions, targets) = placed(rng, &frame);
        examine(&mut oracle, rng, (regions, format!("placed {seed}")), (&targets, &frame), 48);
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

/// Compares all queries on unions of single solids, all of them placed, whose crossings are found in lanes where they are apart.
fn check_copies(models: u64, least: u64) {
    let mut oracle = Oracle::new("copies of single solids");
    for seed in 0..models {
        let rng = &mut Random::new(9 << 40 | seed);
        let frame = frame(rng);
        let kinds = 1 + rng.below(2);
        let placed = |rng: &mut Random| {
            let (solid, count) = (member(rng).apply(map(rng)), 1 + rng.below(30));
            // apart along one axis in half of the models
            let step = rng.pick(&[0.0, 2.0, 3.0]);
            let maps = (0..count).map(|k| map(rng).then(&Affine::translate(step * k as f64 * Vec3::Y)));
            solid.place(maps.collect::<Vec<_>>())
        };
        let solid = Solid::union((0..kinds).map(|_| placed(rng)).collect::<Vec<_>>()).apply(frame);
        let region = Region { name: "copies".into(), solid, medium: 1 };
        let targets = targets(rng);
        examine(&mut oracle, rng, (vec![region], format!("copies {seed}")), (&targets, &frame), 32);
    }
    oracle.finish(models * least);
}

#[test]
fn copies_of_single_solids() {
    check_copies(100, 60);
}

#[test]
#[ignore = "long"]
fn long_copies_of_single_solids() {
    check_copies(20_000, 60);
}

/// All crossings of rays with a lattice of separate dice, from outside and from within, are found without the weave.
#[test]
fn crossings_with_separate_copies_are_found_in_lanes() {
    let program = Arc::new(Program::compile(&scale::lattice(216)).expect("a legal model"));
    let packets = Packets::new(program.clone());
    let rng = &mut Random::new(3);
    let ray = |rng: &mut Random, from: f64| {
        let (from, to) = (from * rng.direction(), rng.point(1.0));
        Ray::new(from, (to - from).normalize())
    };
    let rays: Vec<Ray> = (0..400).map(|k| ray(rng, [3.0, 0.5][k % 2])).collect();
    let (mut scratch, mut count) = (packets.scratch(), 0);
    let mut most = 0;
    let query = Query { window: Window::new(0.0, 5.0).expect("a window"), ..Query::default() };
    packets.crossings(batch(&rays).rays(), &query, &mut scratch, &mut |answer: RayAnswer<'_>| {
        count += answer.crossings.len();
        most = most.max(answer.crossings.len());
    });
    assert!(count > 10 * rays.len() / 2 && most > 20, "{count}, {most}");
    let expected = Reference::new(program);
    let mut other = 0;
    expected.crossings(batch(&rays).rays(), &query, &mut expected.scratch(), &mut |answer: RayAnswer<'_>| {
        other += answer.crossings.len();
    });
    assert_eq!(count, other);
    if packets.uses_lanes() {
        // one ray would intersect ten dice of five leaves
        assert!(scratch.fallback_leaf_count() < 200, "{}", scratch.fallback_leaf_count());
    }
}

/// The lists of more copies than are traced in lanes for first hits are those of the weave.
#[test]
fn lists_of_many_copies() {
    let program = Arc::new(Program::compile(&scale::lattice(66_000)).expect("a legal model"));
    let (packets, weave, rng) = (Packets::new(program.clone()), Weave::new(program), &mut Random::new(4));
    let ray = |rng: &mut Random| {
        let from = 3.0 * rng.direction();
        Ray::new(from, rng.point(1.0) - from)
    };
    let rays: Vec<Ray> = (0..60).map(|_| ray(rng)).collect();
    let (mut lists, mut expected) = (Vec::new(), Vec::new());
    let (rays, query) = (batch(&rays), Query::default());
    let mut scratch = packets.scratch();
    packets.crossings(rays.rays(), &query, &mut scratch, &mut |answer: RayAnswer<'_>| {
        lists.push(answer.crossings.to_vec());
    });
    weave.crossings(rays.rays(), &query, &mut weave.scratch(), &mut |answer: RayAnswer<'_>| {
        expected.push(answer.crossings.to_vec());
    });
    assert_eq!(lists, expected);
    assert!(lists.iter().map(Vec::len).sum::<usize>() > 20 * lists.len());
    // one ray would intersect 25 dice of five leaves
    assert!(
        !packets.uses_lanes() || scratch.fallback_leaf_count() < 500,
        "{}",
        scratch.fallback_leaf_count()
    );
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
