//! Unions of many rings about one axis, as detailed solids of revolution are compiled: rays exclude the rings that they miss, and
//! the answers stay those of the reference evaluator.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rayweave_math::Vec3;
use rayweave_model::{Evaluator, Program, Query, RayBatch, Solid, Window};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{BoxFromCorners, Cylinder, HalfSpace, Primitive, ShapeError, Sphere};
use rayweave_trace::{Packets, Reference, Weave};
use std::sync::Arc;

fn solid<P: Into<Primitive>>(shape: Result<P, ShapeError>) -> Solid {
    Solid::from(shape.unwrap().into())
}

fn rod(radius: f64) -> Solid {
    solid(Cylinder::new(radius, f64::INFINITY))
}

/// The ring between two radii and two heights about the z axis, within a solid.
fn ring([inner, outer]: [f64; 2], [low, high]: [f64; 2], within: &Solid) -> Solid {
    let side = 1.25 * outer;
    let around = solid(BoxFromCorners::new(Vec3::new(-side, -side, low), Vec3::new(side, side, high)));
    within & &(&(&around & &rod(outer)) - &rod(inner))
}

/// A wall of `count` x `count` touching rings from radius 20 to 30 and height -5 to 5, each cut by a sphere or a plane of its own.
fn wall(count: u32) -> Solid {
    let at = |k: u32, from: f64| from + 10.0 * f64::from(k) / f64::from(count);
    let rings = (0..count * count).map(|k| {
        let (i, j) = (k % count, k / count);
        let cut = match k % 3 {
            0 => Solid::universe(),
            1 => solid(Sphere::new(at(i, 20.0) + 0.3 / f64::from(count))),
            _ => !solid(HalfSpace::new(Vec3::new(1.0, 0.3, 2.0), f64::from(j) - 10.0)),
        };
        ring([at(i, 20.0), at(i + 1, 20.0)], [at(j, -5.0), at(j + 1, -5.0)], &cut)
    });
    Solid::union(rings)
}

/// Random rays, rays parallel to the axis, some of them in the cylinders, and rays across it.
fn rays(count: usize) -> Vec<Ray> {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let mut rays = Vec::new();
    for k in 0..count {
        let mut point = |reach: f64| Vec3::from_array([0; 3].map(|_| rng.random_range(-reach..reach)));
        let (origin, towards) = (point(40.0), point(25.0));
        let on_cylinder = Vec3::new(20.0 + (k % 11) as f64, 0.0, -7.0);
        rays.extend([
            Ray::new(origin, towards - origin),
            Ray::new(origin, Vec3::Z),
            Ray::new(on_cylinder, -Vec3::Z),
            Ray::new(Vec3::new(0.6 * on_cylinder.x, 0.8 * on_cylinder.x, 9.0), Vec3::Z),
            Ray::new(Vec3::new(origin.x, origin.y, (k % 11) as f64 - 5.0), Vec3::X),
            Ray::new(on_cylinder, Vec3::Y + 1e-9 * towards),
            Ray::new(origin, Vec3::new(1e-12, 0.0, 3.0)),
            Ray::new(1e6 * towards, -towards),
        ]);
    }
    rays
}

#[test]
fn the_answers_are_those_of_the_reference() {
    for place in [Vec3::ZERO, Vec3::new(3.0, -4.0, 1e4)] {
        let program = Arc::new(Program::compile(&wall(12).translate(place)).unwrap());
        let rays: Vec<Ray> = rays(60).iter().map(|ray| Ray::new(ray.origin + place, ray.direction)).collect();
        let batch = RayBatch::from_iter(rays);
        for window in [Window::ALL, Window::new(0.0, 2.0).unwrap(), Window::new(0.3, f64::INFINITY).unwrap()]
        {
            let query = Query { window, ..Query::default() };
            let expected = Reference::new(program.clone()).collect(batch.rays(), &query).unwrap();
            assert!(expected.crossings.len() > 20);
            assert_eq!(Weave::new(program.clone()).collect(batch.rays(), &query).unwrap(), expected);
            assert_eq!(Packets::new(program.clone()).collect(batch.rays(), &query).unwrap(), expected);
        }
    }
}

/// A ray along the axis passes the boxes of most rings, and reaches one column of them.
#[test]
fn rays_along_the_axis_reach_few_leaves() {
    let weave = Weave::new(Arc::new(Program::compile(&wall(40)).unwrap()));
    let mut scratch = weave.scratch();
    let batch = RayBatch::from_iter(
        (0..50).map(|k| Ray::new(Vec3::new(20.1 + 0.19 * f64::from(k), 0.0, 9.0), -Vec3::Z)),
    );
    let mut crossings = 0;
    weave.crossings(
        batch.rays(),
        &Query::default(),
        &mut scratch,
        &mut |answer: rayweave_model::RayAnswer<'_>| {
            crossings += answer.crossings.len();
        },
    );
    assert!(crossings > 50);
    let each = scratch.intersected_leaves() / 50;
    // 40 rings of up to four leaves, and those beside them
    assert!(each < 400, "{each} leaves for each ray");
}
