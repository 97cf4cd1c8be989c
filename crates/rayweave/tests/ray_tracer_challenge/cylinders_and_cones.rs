//! Cylinders and cones: chapter 13.

use crate::ask::*;
use rayweave::shapes::{cone, cylinder, quadric, slab};
use rayweave::{Solid, Vec3};

/// The infinite cylinder of radius 1 along y.
fn pole() -> Solid {
    upright(&cylinder(1.0, f64::INFINITY).unwrap(), 0.0)
}

/// The cylinder of radius 1 from y = 1 to y = 2, with caps.
fn drum() -> Solid {
    upright(&cylinder(1.0, 1.0).unwrap(), 1.5)
}

/// Both halves of the cone x^2 + z^2 < y^2.
fn double_cone() -> Solid {
    let diagonal = [1.0, -1.0, 1.0, 0.0];
    let row = |i: usize| std::array::from_fn(|j| if i == j { diagonal[i] } else { 0.0 });
    quadric(std::array::from_fn(row)).unwrap()
}

#[test]
fn rays_that_miss_a_cylinder() {
    for (origin, direction) in [
        // in the surface; along the axis; outside
        ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ([0.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ([0.0, 0.0, -5.0], [1.0, 1.0, 1.0]),
    ] {
        assert_misses(&pole(), unit_ray(origin, direction));
    }
}

#[test]
fn rays_that_hit_a_cylinder() {
    assert_times(&times(&pole(), ray([0.0, 0.0, -5.0], [0.0, 0.0, 1.0])), &[4.0, 6.0], 1e-14);
    let slanted = unit_ray([0.5, 0.0, -5.0], [0.1, 1.0, 1.0]);
    assert_times(&times(&pole(), slanted), &[6.80798, 7.08872], EPSILON);
    // the book: 5 and 5
    assert_misses(&pole(), ray([1.0, 0.0, -5.0], [0.0, 0.0, 1.0]));
}

#[test]
fn normals_of_a_cylinder() {
    for (point, expected) in [
        ([1.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ([0.0, 5.0, -1.0], [0.0, 0.0, -1.0]),
        ([0.0, -2.0, 1.0], [0.0, 0.0, 1.0]),
        ([-1.0, 1.0, 0.0], [-1.0, 0.0, 0.0]),
    ] {
        assert_near(normal(&pole(), point, expected), expected, 1e-14);
    }
}

/// The number of intersections with an open tube: those with the side of the closed cylinder.
fn through_the_side(ray: rayweave::Ray) -> usize {
    hits(&drum(), ray).iter().filter(|(_, face)| face.ends_with(".side")).count()
}

#[test]
fn a_cylinder_that_is_cut() {
    let z = [0.0, 0.0, 1.0];
    for (origin, direction, expected) in [
        ([0.0, 1.5, 0.0], [0.1, 1.0, 0.0], 0),
        ([0.0, 3.0, -5.0], z, 0),
        ([0.0, 0.0, -5.0], z, 0),
        ([0.0, 2.0, -5.0], z, 0),
        // in the lower cap: 0 in the book
        ([0.0, 1.0, -5.0], z, 2),
        ([0.0, 1.5, -2.0], z, 2),
    ] {
        assert_eq!(through_the_side(unit_ray(origin, direction)), expected, "{origin:?}");
    }
}

#[test]
fn a_cylinder_with_caps() {
    for (origin, direction, cap) in [
        ([0.0, 3.0, 0.0], [0.0, -1.0, 0.0], "top"),
        ([0.0, 3.0, -2.0], [0.0, -1.0, 2.0], "side"),
        // through the edge of the other cap
        ([0.0, 4.0, -2.0], [0.0, -1.0, 1.0], "top"),
        ([0.0, 0.0, -2.0], [0.0, 1.0, 2.0], "side"),
        ([0.0, -1.0, -2.0], [0.0, 1.0, 1.0], "bottom"),
    ] {
        let found = hits(&drum(), unit_ray(origin, direction));
        assert_eq!(found.len(), 2, "{origin:?}: {found:?}");
        let faces = found.iter().map(|hit| hit.1.rsplit('.').next().unwrap()).collect::<Vec<_>>();
        assert!(faces.contains(&cap), "{origin:?}: {faces:?}");
    }
}

#[test]
fn normals_of_caps() {
    for [x, z] in [[0.0, 0.0], [0.5, 0.0], [0.0, 0.5]] {
        assert_near(normal(&drum(), [x, 1.0, z], [0.0, -1.0, 0.0]), [0.0, -1.0, 0.0], 1e-15);
        assert_near(normal(&drum(), [x, 2.0, z], [0.0, 1.0, 0.0]), [0.0, 1.0, 0.0], 1e-15);
    }
}

#[test]
fn rays_and_a_cone() {
    // through the apex, and touching the cone: 5 and 5, 8.66025 twice in the book
    assert_misses(&double_cone(), ray([0.0, 0.0, -5.0], [0.0, 0.0, 1.0]));
    assert_misses(&double_cone(), ray([0.0, 0.0, -5.0], [1.0, 1.0, 1.0]));
    let slanted = unit_ray([1.0, 1.0, -5.0], [-0.5, -1.0, 1.0]);
    assert_times(&times(&double_cone(), slanted), &[4.55006, 49.44994], EPSILON);
}

#[test]
fn a_ray_parallel_to_one_half_of_a_cone() {
    let parallel = unit_ray([0.0, 0.0, -1.0], [0.0, 1.0, 1.0]);
    let found = times(&double_cone(), parallel);
    // the book: 0.35355; see the top of main.rs
    assert_times(&found, &[0.70711], EPSILON);
    let on_the_cone = |t: f64| {
        let p = parallel.at(t);
        (p.x * p.x + p.z * p.z - p.y * p.y).abs() < 1e-5
    };
    assert!(on_the_cone(found[0]) && !on_the_cone(0.35355));
}

/// Both halves from y = -0.5 to 0.5 with caps: as a truncated quadric, and as two cones that touch at their
/// apexes.
fn hourglasses() -> [Solid; 2] {
    let half = |radius1, radius2| cone(radius1, radius2, 0.5).unwrap();
    let two = upright(&half(0.0, 0.5), 0.25) | upright(&half(0.5, 0.0), -0.25);
    [double_cone() & slab(Vec3::Y, -0.5, 0.5).unwrap(), two]
}

#[test]
fn cones_with_caps() {
    for hourglass in hourglasses() {
        for (origin, direction, expected) in [
            ([0.0, 0.0, -5.0], [0.0, 1.0, 0.0], 0),
            ([0.0, 0.0, -0.25], [0.0, 1.0, 1.0], 2),
            ([0.0, 0.0, -0.25], [0.0, 1.0, 0.0], 4),
        ] {
            assert_eq!(
                times(&hourglass, unit_ray(origin, direction)).len(),
                expected,
                "{origin:?} {direction:?}"
            );
        }
    }
}

#[test]
fn normals_of_a_cone() {
    let root = 2f64.sqrt();
    for (point, expected) in [([1.0, root, 1.0], [1.0, -root, 1.0]), ([-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0])] {
        let unit = Vec3::from(expected).normalize().to_array();
        assert_near(normal(&double_cone(), point, expected), unit, 1e-14);
    }
}
