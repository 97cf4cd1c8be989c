//! Volumes of booleans of twenty pairs of meshes, computed with rays, against manifold3d 3.5.4 (2026-11-22).
//! `crates/bench/peers/mesh_booleans.py` prints the expected rows.

use super::shapes::{ball, cuboid, potato, torus};
use super::{solid, vector};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::{Affine, Vec3};
use rayweave_mesh::Mesh;
use rayweave_model::{Evaluator, Program, Query, Solid};
use rayweave_shape::Ray;
use rayweave_trace::Weave;
use std::sync::Arc;

/// Volumes of union, intersection and difference.
const VOLUMES: [(&str, [f64; 3]); 20] = [
    ("cubes shifted along the diagonal", [1.875, 0.125, 0.875]),
    ("cubes shifted along x: four faces in common planes", [1.5, 0.5, 0.5]),
    ("cubes side by side: a face in common", [2.0, 0.0, 1.0]),
    ("a cube in the corner of a cube: three faces in common", [1.0, 0.125, 0.875]),
    (
        "a cube turned about z: top and bottom in common planes",
        [1.17167388793, 0.828326112069, 0.171673887931],
    ),
    ("a cube and a ball about its middle", [1.46708215096, 0.957288662573, 0.0427113374266]),
    ("a cube and a ball about its corner", [2.24632446184, 0.178046351691, 0.821953648309]),
    ("a ring and a cube", [3.82046184358, 0.237523039123, 2.82046184358]),
    ("two rings as in a chain", [6.1159697654, 0.0, 3.0579848827]),
    ("two balls", [2.21963161202, 0.629110015039, 0.79526079849]),
    ("a ball and itself", [1.42437081353, 1.42437081353, 0.0]),
    ("a ball in a ring", [4.37059847928, 0.111757216946, 2.94622766576]),
    ("a potato and a cube", [4.98608961753, 0.439179698961, 3.98608961753]),
    ("a potato and a ring", [6.21975288381, 1.26350131538, 3.16176800111]),
    ("a cube within a cube", [1.0, 0.125, 0.875]),
    ("a ball and a cube that do not meet", [2.42437081353, 0.0, 1.42437081353]),
    ("an L and what fills it: two faces and two planes in common", [4.0, 0.0, 3.0]),
    ("an L and a cube across its edge", [3.625, 0.375, 2.625]),
    ("a potato turned against itself", [5.42131141323, 3.42922721975, 0.996042096739]),
    ("a cube on a plate: part of a face in common", [4.0, 0.0, 3.0]),
];

fn cube() -> Mesh {
    cuboid(Vec3::ZERO, Vec3::ONE)
}

fn moved(mesh: &Mesh, by: [f64; 3], about: Vec3, degrees: f64) -> Mesh {
    let map = Affine::rotation(about, degrees).then(&Affine::translate(Vec3::from_array(by)));
    mesh.mapped(|p| map.point(p)).unwrap()
}

fn shifted(mesh: &Mesh, by: [f64; 3]) -> Mesh {
    moved(mesh, by, Vec3::Z, 0.0)
}

/// An L: a block without one quarter.
fn angle() -> Mesh {
    let base = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    let corners = [0.0, 1.0].into_iter().flat_map(|z| base.map(|[x, y]| Vec3::new(x, y, z)));
    let lids = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]];
    let mut triangles: Vec<[u32; 3]> = lids.map(|[a, b, c]| [c, b, a]).to_vec();
    triangles.extend(lids.map(|lid| lid.map(|k| k + 6)));
    triangles.extend((0..6).flat_map(|k| {
        let next = (k + 1) % 6;
        [[k, next, next + 6], [k, next + 6, k + 6]]
    }));
    Mesh::new(corners.collect(), triangles).unwrap()
}

fn pairs() -> [(Mesh, Mesh); 20] {
    let (small, ball) = (cuboid(Vec3::ZERO, Vec3::splat(0.5)), ball(3, |_| 0.7));
    let (ring, potato) = (torus(1.0, 0.4, 32, 16), potato(3));
    [
        (cube(), shifted(&cube(), [0.5, 0.5, 0.5])),
        (cube(), shifted(&cube(), [0.5, 0.0, 0.0])),
        (cube(), shifted(&cube(), [1.0, 0.0, 0.0])),
        (cube(), small.clone()),
        (cube(), moved(&cube(), [0.5, -0.2, 0.0], Vec3::Z, 45.0)),
        (cube(), shifted(&ball, [0.5, 0.5, 0.5])),
        (cube(), ball.clone()),
        (ring.clone(), cube()),
        (ring.clone(), moved(&ring, [1.0, 0.0, 0.0], Vec3::X, 90.0)),
        (ball.clone(), shifted(&ball, [0.5, 0.1, 0.2])),
        (ball.clone(), ball.clone()),
        (ring.clone(), ball.clone()),
        (potato.clone(), cube()),
        (potato.clone(), ring.clone()),
        (cube(), shifted(&small, [0.25, 0.25, 0.25])),
        (ball, shifted(&cube(), [3.0, 0.0, 0.0])),
        (angle(), shifted(&cube(), [1.0, 1.0, 0.0])),
        (angle(), shifted(&cube(), [0.5, 0.5, 0.5])),
        (potato.clone(), moved(&potato, [0.1, 0.0, 0.0], Vec3::Z, 30.0)),
        (cuboid(Vec3::ZERO, Vec3::new(3.0, 2.0, 0.5)), shifted(&cube(), [1.0, 0.5, 0.5])),
    ]
}

/// The volume from one jittered ray along z per cell of an n x n grid, after a random rotation of the solid.
fn volume(solid: &Solid, n: u32, seed: u64) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let turn = Affine::rotation(vector(&mut rng), rng.random_range(0.0..180.0));
    let program = Arc::new(Program::compile(&solid.apply(turn)).unwrap());
    let bounds = program.bounds();
    if bounds.is_empty() {
        return 0.0;
    }
    let (lo, cell) = (bounds.lo, bounds.size() / f64::from(n));
    let weave = Weave::new(program);
    let rays: Vec<Ray> = (0..n * n)
        .map(|k| {
            let (i, j) = (f64::from(k % n), f64::from(k / n));
            let x = lo.x + cell.x * (i + rng.random_range(0.0..1.0));
            let y = lo.y + cell.y * (j + rng.random_range(0.0..1.0));
            Ray::new(Vec3::new(x, y, lo.z - 1.0), Vec3::Z)
        })
        .collect();
    let inside = |ray: &Ray| {
        let found = weave.one(*ray, &Query::default()).unwrap();
        found.crossings.iter().map(|c| if c.enters() { -c.t } else { c.t }).sum::<f64>()
    };
    let length: f64 = rays.iter().map(inside).sum();
    length * cell.x * cell.y
}

/// Compares with n x n rays per solid; `tolerance` is relative to the volume of the union.
fn check(n: u32, tolerance: f64) {
    for (k, ((name, volumes), (a, b))) in VOLUMES.iter().zip(pairs()).enumerate() {
        assert!((a.volume() - volumes[1] - volumes[2]).abs() < 1e-9, "{name}: another mesh");
        let (a, b) = (solid(&a), solid(&b));
        for (found, truth) in [&a | &b, &a & &b, &a - &b].iter().zip(volumes) {
            let found = volume(found, n, k as u64);
            assert!((found - truth).abs() < tolerance * volumes[0], "{name}: {found} instead of {truth}");
        }
    }
}

#[test]
fn volumes_of_booleans_are_those_of_a_kernel_for_meshes() {
    // five standard deviations of this number of rays
    check(64, 1.5e-2);
}

#[test]
#[ignore = "long"]
fn long_volumes_of_booleans_are_those_of_a_kernel_for_meshes() {
    check(500, 1e-3);
}
