//! Spheres, planes, cubes: chapters 5, 6, 9 and 12; the media along a ray: chapter 11.

use crate::ask::*;
use rayweave::model::attributes;
use rayweave::shapes::{box_, half_space, sphere};
use rayweave::{Affine, Program, Solid, Vec3};
use std::f64::consts::FRAC_1_SQRT_2;
use std::sync::Arc;

fn ball() -> Solid {
    sphere(1.0).unwrap()
}

fn cube() -> Solid {
    box_(Vec3::splat(2.0)).unwrap()
}

/// The half-space below the plane y = 0.
fn below() -> Solid {
    half_space(Vec3::Y, 0.0).unwrap()
}

// chapter 5: rays and spheres
#[test]
fn spheres() {
    let along_z = |origin| ray(origin, [0.0, 0.0, 1.0]);
    assert_eq!(times(&ball(), along_z([0.0, 0.0, -5.0])), [4.0, 6.0]);
    assert_misses(&ball(), along_z([0.0, 2.0, -5.0]));
    assert_eq!(times(&ball(), along_z([0.0, 0.0, 0.0])), [-1.0, 1.0]);
    assert_eq!(times(&ball(), along_z([0.0, 0.0, 5.0])), [-6.0, -4.0]);
    // the book: 5 and 5
    assert_misses(&ball(), along_z([0.0, 1.0, -5.0]));
}

// chapter 5: transformed spheres
#[test]
fn scaled_and_moved_spheres() {
    let from_behind = ray([0.0, 0.0, -5.0], [0.0, 0.0, 1.0]);
    assert_eq!(times(&ball().scale(Vec3::splat(2.0)), from_behind), [3.0, 7.0]);
    assert_misses(&ball().translate([5.0, 0.0, 0.0]), from_behind);
    // chapter 9: the ray in the local coordinates of the shape
    let seen = |map: Affine| from_behind.transformed(&map.inverse().unwrap());
    assert_eq!(seen(Affine::scale(Vec3::splat(2.0))), ray([0.0, 0.0, -2.5], [0.0, 0.0, 0.5]));
    let moved = seen(Affine::translate(Vec3::new(5.0, 0.0, 0.0)));
    assert_eq!(moved, ray([-5.0, 0.0, -5.0], [0.0, 0.0, 1.0]));
}

// chapter 5: the visible intersection
#[test]
fn the_first_that_is_not_behind() {
    let from = |z: f64| nearest(&ball(), ray([0.0, 0.0, z], [0.0, 0.0, 1.0]));
    assert_eq!([from(-2.0), from(0.0), from(2.0)], [Some(1.0), Some(1.0), None]);
}

// chapter 6: normals of spheres
#[test]
fn normals_of_spheres() {
    let third = 3f64.sqrt() / 3.0;
    for n in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [third; 3]] {
        let found = normal(&ball(), n, n);
        assert_near(found, n, 1e-14);
        assert!((found.length() - 1.0).abs() < 1e-15);
    }
    let moved = ball().translate([0.0, 1.0, 0.0]);
    let expected = [0.0, 0.70711, -0.70711];
    assert_near(normal(&moved, [0.0, 1.70711, -0.70711], expected), expected, EPSILON);
}

// chapters 6 and 9: the normal of a scaled and rotated sphere; the book's point is off the surface, so the
// test compares the gradient of the sphere's equation
#[test]
fn the_gradient_of_a_transformed_sphere() {
    let solid = ball().rotate_z(36.0).scale([1.0, 0.5, 1.0]);
    let program = compiled(&solid);
    let through = ray([0.0, FRAC_1_SQRT_2, -FRAC_1_SQRT_2], [0.3, -1.0, 0.9]);
    let crossing = answer(&program, through).crossings[0];
    let gradient = attributes::world_gradient(&program, &through, crossing.face, 0.0);
    assert_near(gradient.normalize(), [0.0, 0.97014, -0.24254], EPSILON);
}

// chapter 7: data of a hit
#[test]
fn hits_from_outside_and_from_inside() {
    let program = compiled(&ball());
    let outside = ray([0.0, 0.0, -5.0], [0.0, 0.0, 1.0]);
    let first = answer(&program, outside).crossings[0];
    assert!(first.t == 4.0 && first.enters());
    assert_eq!(attributes::point(&outside, &first), Vec3::new(0.0, 0.0, -1.0));
    assert_eq!(attributes::normal(&program, &outside, &first), Vec3::new(0.0, 0.0, -1.0));
    let inside = ray([0.0; 3], [0.0, 0.0, 1.0]);
    let second = answer(&program, inside).crossings[1];
    assert!(second.t == 1.0 && !second.enters());
    assert_eq!(attributes::point(&inside, &second), Vec3::new(0.0, 0.0, 1.0));
    // the book turns it towards the eye: (0, 0, -1)
    assert_eq!(attributes::normal(&program, &inside, &second), Vec3::new(0.0, 0.0, 1.0));
}

// chapter 9: planes
#[test]
fn planes() {
    assert_misses(&below(), ray([0.0, 10.0, 0.0], [0.0, 0.0, 1.0]));
    assert_misses(&below(), ray([0.0; 3], [0.0, 0.0, 1.0]));
    assert_eq!(times(&below(), ray([0.0, 1.0, 0.0], [0.0, -1.0, 0.0])), [1.0]);
    assert_eq!(times(&below(), ray([0.0, -1.0, 0.0], [0.0, 1.0, 0.0])), [1.0]);
    for point in [[0.0; 3], [10.0, 0.0, -10.0], [-5.0, 0.0, 150.0]] {
        assert_eq!(normal(&below(), point, [0.0, 1.0, 0.0]), Vec3::Y);
    }
    // chapter 11, for the vector of reflection: a plane from above, at 45 degrees
    let slanted = ray([0.0, 1.0, -1.0], [0.0, -FRAC_1_SQRT_2, FRAC_1_SQRT_2]);
    assert_times(&times(&below(), slanted), &[2f64.sqrt()], 1e-15);
}

// chapter 12: cubes
#[test]
fn rays_that_hit_a_cube() {
    let cases = [
        ([5.0, 0.5, 0.0], [-1.0, 0.0, 0.0], [4.0, 6.0]),
        ([-5.0, 0.5, 0.0], [1.0, 0.0, 0.0], [4.0, 6.0]),
        ([0.5, 5.0, 0.0], [0.0, -1.0, 0.0], [4.0, 6.0]),
        ([0.5, -5.0, 0.0], [0.0, 1.0, 0.0], [4.0, 6.0]),
        ([0.5, 0.0, 5.0], [0.0, 0.0, -1.0], [4.0, 6.0]),
        ([0.5, 0.0, -5.0], [0.0, 0.0, 1.0], [4.0, 6.0]),
        ([0.0, 0.5, 0.0], [0.0, 0.0, 1.0], [-1.0, 1.0]),
    ];
    for (origin, direction, expected) in cases {
        assert_eq!(times(&cube(), ray(origin, direction)), expected);
    }
}

// chapter 12
#[test]
fn rays_that_miss_a_cube() {
    let cases = [
        ([-2.0, 0.0, 0.0], [0.2673, 0.5345, 0.8018]),
        ([0.0, -2.0, 0.0], [0.8018, 0.2673, 0.5345]),
        ([0.0, 0.0, -2.0], [0.5345, 0.8018, 0.2673]),
        ([2.0, 0.0, 2.0], [0.0, 0.0, -1.0]),
        ([0.0, 2.0, 2.0], [0.0, -1.0, 0.0]),
        ([2.0, 2.0, 0.0], [-1.0, 0.0, 0.0]),
    ];
    for (origin, direction) in cases {
        assert_misses(&cube(), ray(origin, direction));
    }
}

// chapter 12
#[test]
fn normals_of_a_cube() {
    let cases = [
        ([1.0, 0.5, -0.8], [1.0, 0.0, 0.0]),
        ([-1.0, -0.2, 0.9], [-1.0, 0.0, 0.0]),
        ([-0.4, 1.0, -0.1], [0.0, 1.0, 0.0]),
        ([0.3, -1.0, -0.7], [0.0, -1.0, 0.0]),
        ([-0.6, 0.3, 1.0], [0.0, 0.0, 1.0]),
        ([0.4, 0.4, -1.0], [0.0, 0.0, -1.0]),
    ];
    for (point, expected) in cases {
        assert_eq!(normal(&cube(), point, expected), Vec3::from(expected));
    }
}

// chapter 11: the indices of refraction on both sides of each intersection with three spheres; inside two of
// them the medium is that of the one entered last
#[test]
fn media_along_a_ray() {
    let index = [1.0, 1.5, 2.0, 2.5];
    let regions = [
        region("a", 1, ball().scale(Vec3::splat(2.0))),
        region("b", 2, ball().translate([0.0, 0.0, -0.25])),
        region("c", 3, ball().translate([0.0, 0.0, 0.25])),
    ];
    let program = Arc::new(Program::compile_regions(&regions).unwrap());
    let found = answer(&program, ray([0.0, 0.0, -4.0], [0.0, 0.0, 1.0]));
    let indices: Vec<_> = found
        .crossings
        .iter()
        .map(|c| {
            (c.t, index[program.medium_of(c.before) as usize], index[program.medium_of(c.after) as usize])
        })
        .collect();
    // the book has one more, at 4.75, from 2.5 to 2.5
    let expected = [(2.0, 1.0, 1.5), (2.75, 1.5, 2.0), (3.25, 2.0, 2.5), (5.25, 2.5, 1.5), (6.0, 1.5, 1.0)];
    assert_eq!(indices, expected);
}
