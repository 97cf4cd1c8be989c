//! Meshes combined with other leaves: coincident faces with exact shapes and with each other, and volumes of
//! booleans against a mesh boolean kernel.

#[path = "../everyone/mod.rs"]
mod everyone;
mod oracle;
#[path = "../../../mesh/tests/shapes/mod.rs"]
mod shapes;

use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Program, Solid};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Primitive, Value, build};
use shapes::{cuboid, potato, torus};
use std::sync::Arc;

fn solid(mesh: &rayweave_mesh::Mesh) -> Solid {
    Primitive::from(rayweave_shape::primitive::Mesh::new(mesh).unwrap()).into()
}

fn block(lo: Vec3, hi: Vec3) -> Solid {
    let corners = [("lo", Value::from(lo)), ("hi", Value::from(hi))];
    build("box_from_corners", &corners).unwrap().into()
}

fn times(solid: &Solid, ray: Ray) -> Vec<f64> {
    let program = Arc::new(Program::compile(solid).unwrap());
    everyone::trace(&program, ray).crossings.iter().map(|c| c.t).collect()
}

fn vector(rng: &mut ChaCha8Rng) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)))
}

/// Rays through the half-integer grid, so that many pass through corners and edges, in faces and along edges
/// of the unit cube at the origin.
fn hostile_ray(rng: &mut ChaCha8Rng) -> Ray {
    let mut round =
        || Vec3::from_array(std::array::from_fn(|_| f64::from(rng.random_range(-2..=4i32)) * 0.5));
    let (from, to) = (round(), round());
    let direction = if from == to { Vec3::X } else { to - from };
    Ray::new(from - 2.0 * direction, direction)
}

fn placed(solid: &Solid, rng: &mut ChaCha8Rng, round: u32) -> (Solid, Affine) {
    let map = match round % 3 {
        0 => Affine::IDENTITY,
        1 => Affine::rotation(vector(rng), rng.random_range(0.0..180.0)),
        _ => Affine::scale(Vec3::new(1.0, 2.0, 0.5))
            .then(&Affine::rotation(vector(rng), 40.0))
            .then(&Affine::translate(30.0 * vector(rng))),
    };
    (solid.apply(map), map)
}

/// A box of triangles equals the exact box, also on rays in a face, along an edge or through a corner.
#[test]
fn a_box_of_triangles_is_the_box() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let (mesh, exact) = (solid(&cuboid(Vec3::ZERO, Vec3::ONE)), block(Vec3::ZERO, Vec3::ONE));
    let mut met = 0;
    for round in 0..12 {
        let (differ, map) = placed(&(&mesh ^ &exact), &mut rng, round);
        let both = [&mesh, &exact].map(|solid| Program::compile(&solid.apply(map)).unwrap()).map(Arc::new);
        let differ = Arc::new(Program::compile(&differ).unwrap());
        for _ in 0..60 {
            let ray = hostile_ray(&mut rng).transformed(&map);
            let found = everyone::trace(&differ, ray);
            assert!(found.crossings.is_empty(), "{round} {ray:?} {:?}", found.crossings);
            let [a, b] = both.each_ref().map(|program| everyone::trace(program, ray).crossings);
            assert_eq!(a.len(), b.len(), "{round} {ray:?}");
            for (a, b) in a.iter().zip(&b) {
                assert!((a.t - b.t).abs() < 1e-12 * (1.0 + a.t.abs()), "{ray:?}");
                met += 1;
            }
        }
    }
    assert!(met > 100, "{met}");
}

/// A mesh and an exact box side by side are one solid, and their intersection is empty.
#[test]
fn a_mesh_and_a_box_that_touch_are_one() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let left = solid(&cuboid(Vec3::ZERO, Vec3::ONE));
    let (right, whole) =
        (block(Vec3::X, Vec3::new(2.0, 1.0, 1.0)), block(Vec3::ZERO, Vec3::new(2.0, 1.0, 1.0)));
    let parts =
        [(&left | &right) ^ &whole, &left & &right, (&left - &right) ^ &left, (&whole - &right) ^ &left];
    for round in 0..9 {
        let (_, map) = placed(&left, &mut rng, round);
        for part in &parts {
            let program = Arc::new(Program::compile(&part.apply(map)).unwrap());
            for _ in 0..40 {
                let ray = hostile_ray(&mut rng).transformed(&map);
                let found = everyone::trace(&program, ray);
                assert!(found.crossings.is_empty(), "{round} {ray:?} {:?}", found.crossings);
            }
        }
    }
}

/// Booleans of meshes with each other and with exact shapes, against winding numbers at points between
/// crossings.
#[test]
fn booleans_are_point_by_point_those_of_solid_angles() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let (a, b) = (potato(2), torus(1.0, 0.4, 16, 8));
    let ball: Solid = build("sphere", &[("radius", Value::Number(0.8))]).unwrap().into();
    let both = (solid(&a) - &ball) ^ &solid(&b);
    let program = Arc::new(Program::compile(&both).unwrap());
    let is_inside = |p: Vec3| {
        let [in_a, in_b] = [&a, &b].map(|mesh| shapes::winding(mesh, p) > 0.5);
        (in_a && p.length() > 0.8) != in_b
    };
    let (mut inside, mut outside) = (0, 0);
    for _ in 0..150 {
        let ray = Ray::new(1.5 * vector(&mut rng), vector(&mut rng));
        let found = everyone::trace(&program, ray).crossings;
        for (k, pair) in found.windows(2).enumerate() {
            let point = ray.at(0.5 * (pair[0].t + pair[1].t));
            assert_eq!(is_inside(point), k % 2 == 0, "{ray:?} {point}");
            if k % 2 == 0 { inside += 1 } else { outside += 1 }
        }
    }
    assert!(inside > 100 && outside > 50, "{inside} {outside}");
}

/// A placed mesh has the crossings of each copy.
#[test]
fn placed_meshes_are_intersected_in_their_own_frames() {
    let mesh = solid(&cuboid(Vec3::ZERO, Vec3::ONE));
    let tiles =
        mesh.place((0..10).map(|k| Affine::translate(Vec3::new(f64::from(k), 0.0, 0.0))).collect::<Vec<_>>());
    assert_eq!(times(&tiles, Ray::new(Vec3::new(-1.0, 0.3, 0.4), Vec3::X)), [1.0, 11.0]);
    assert_eq!(times(&tiles, Ray::new(Vec3::new(3.5, -1.0, 0.4), Vec3::Y)), [1.0, 2.0]);
    // along a face shared by two copies, and along faces of all copies
    assert_eq!(times(&tiles, Ray::new(Vec3::new(4.0, -1.0, 0.4), Vec3::Y)), [1.0, 2.0]);
    assert!(times(&tiles, Ray::new(Vec3::new(-1.0, 1.0, 0.4), Vec3::X)).is_empty());
    assert_eq!(times(&tiles, Ray::new(Vec3::new(-1.0, 0.0, 0.4), Vec3::X)), [1.0, 11.0]);
}

/// A mesh that touches a box, both moved far away, by a map of the model, by a placement, or by a map within a placement:
/// rays in the common face find the intersection empty and the union without a gap.
#[test]
fn touching_boxes_far_away_agree() {
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let mesh = solid(&cuboid(Vec3::ZERO, Vec3::ONE));
    let touching = block(Vec3::new(1.0, 0.0, 0.0), Vec3::new(2.0, 1.0, 1.0));
    for offset in [30.0, 1e3, 1e6] {
        for round in 0..40 {
            let turn = Affine::rotation(vector(&mut rng), rng.random_range(0.0..180.0));
            let map = turn.then(&Affine::translate(offset * vector(&mut rng)));
            let far = |solid: &Solid| match round % 3 {
                0 => solid.apply(map),
                1 => solid.place([map]),
                _ => solid.apply(turn).place([turn.inverse().unwrap().then(&map)]),
            };
            let both = far(&(&mesh & &touching));
            let either = far(&(&mesh | &touching));
            let parts = [&mesh, &touching].map(&far);
            let (apart, joined) = (&parts[0] & &parts[1], &parts[0] | &parts[1]);
            for _ in 0..10 {
                // in the plane x = 1, through both squares
                let mut inner = || Vec3::new(1.0, rng.random_range(0.1..0.9), rng.random_range(0.1..0.9));
                let (from, to) = (inner(), inner());
                let direction = (to - from).normalize();
                let ray = Ray::new(from - 3.0 * direction, direction).transformed(&map);
                for empty in [&both, &apart] {
                    assert_eq!(times(empty, ray), [0.0; 0], "{offset} {round} {ray:?}");
                }
                for whole in [&either, &joined] {
                    assert_eq!(times(whole, ray).len(), 2, "{offset} {round} {ray:?}");
                }
            }
        }
    }
}
