//! Bounding boxes: bonus chapter.

use crate::ask::*;
use rayweave::shapes::{box_, box_from_corners, cone, cylinder, half_space, quadric, sphere};
use rayweave::{Affine, Bounds, Solid, Vec3};

const INF: f64 = f64::INFINITY;

fn between(lo: [f64; 3], hi: [f64; 3]) -> Bounds {
    Bounds::new(lo.into(), hi.into())
}

fn assert_bounds(solid: &Solid, lo: [f64; 3], hi: [f64; 3]) {
    let found = compiled(solid).bounds();
    let is_near =
        |a: Vec3, b: [f64; 3]| a.to_array().iter().zip(b).all(|(&a, b)| a == b || (a - b).abs() < 1e-12);
    assert!(is_near(found.lo, lo) && is_near(found.hi, hi), "{found:?} for {lo:?} {hi:?}");
}

#[test]
fn boxes() {
    assert!(Bounds::EMPTY.is_empty());
    assert_eq!((Bounds::EMPTY.lo, Bounds::EMPTY.hi), (Vec3::INFINITY, Vec3::NEG_INFINITY));
    let points = [Vec3::new(-5.0, 2.0, 0.0), Vec3::new(7.0, 0.0, -3.0)];
    let grown = points.iter().fold(Bounds::EMPTY, |bounds, &p| bounds.union(&Bounds::new(p, p)));
    assert_eq!(grown, between([-5.0, 0.0, -3.0], [7.0, 2.0, 0.0]));
    let (first, second) =
        (between([-5.0, -2.0, 0.0], [7.0, 4.0, 4.0]), between([8.0, -7.0, -2.0], [14.0, 2.0, 8.0]));
    assert_eq!(first.union(&second), between([-5.0, -7.0, -2.0], [14.0, 4.0, 8.0]));
}

/// The box of the containment scenarios.
fn chest() -> Bounds {
    between([5.0, -2.0, 0.0], [11.0, 4.0, 7.0])
}

#[test]
fn points_in_boxes() {
    for (point, expected) in [
        ([5.0, -2.0, 0.0], true),
        ([11.0, 4.0, 7.0], true),
        ([8.0, 1.0, 3.0], true),
        ([3.0, 0.0, 3.0], false),
        ([8.0, -4.0, 3.0], false),
        ([8.0, 1.0, -1.0], false),
        ([13.0, 1.0, 3.0], false),
        ([8.0, 5.0, 3.0], false),
        ([8.0, 1.0, 8.0], false),
    ] {
        assert_eq!(chest().contains(point.into()), expected, "{point:?}");
    }
}

#[test]
fn boxes_in_boxes() {
    for (lo, hi, expected) in [
        ([5.0, -2.0, 0.0], [11.0, 4.0, 7.0], true),
        ([6.0, -1.0, 1.0], [10.0, 3.0, 6.0], true),
        ([4.0, -3.0, -1.0], [10.0, 3.0, 6.0], false),
        ([6.0, -1.0, 1.0], [12.0, 5.0, 8.0], false),
    ] {
        let inner = between(lo, hi);
        assert_eq!(chest().union(&inner) == chest(), expected, "{lo:?}");
        assert_eq!(chest().intersection(&inner) == inner, expected, "{lo:?}");
    }
}

#[test]
fn turned_boxes() {
    let map = Affine::rotation(Vec3::Y, 45.0).then(&Affine::rotation(Vec3::X, 45.0));
    let turned = between([-1.0; 3], [1.0; 3]).transformed(&map);
    assert_near(turned.lo, [-1.4142, -1.7071, -1.7071], 1e-4);
    assert_near(turned.hi, [1.4142, 1.7071, 1.7071], 1e-4);
}

#[test]
fn bounds_of_shapes() {
    assert_bounds(&sphere(1.0).unwrap(), [-1.0; 3], [1.0; 3]);
    // in the book the bounds of a plane are [0, 0] in y
    assert_bounds(&half_space(Vec3::Y, 0.0).unwrap(), [-INF; 3], [INF, 0.0, INF]);
    assert_bounds(&box_(Vec3::splat(2.0)).unwrap(), [-1.0; 3], [1.0; 3]);
    let pole = cylinder(1.0, INF).unwrap();
    assert_bounds(&upright(&pole, 0.0), [-1.0, -INF, -1.0], [1.0, INF, 1.0]);
    let cut = cylinder(1.0, 8.0).unwrap();
    assert_bounds(&upright(&cut, -1.0), [-1.0, -5.0, -1.0], [1.0, 3.0, 1.0]);
    let diagonal = [1.0, -1.0, 1.0, 0.0];
    let row = |i: usize| std::array::from_fn(|j| if i == j { diagonal[i] } else { 0.0 });
    assert_bounds(&quadric(std::array::from_fn(row)).unwrap(), [-INF; 3], [INF; 3]);
    // truncated at -5 and 3
    let (lower, upper) = (cone(5.0, 0.0, 5.0).unwrap(), cone(0.0, 3.0, 3.0).unwrap());
    assert_bounds(&(upright(&lower, -2.5) | upright(&upper, 1.5)), [-5.0; 3], [5.0, 3.0, 5.0]);
}

#[test]
fn bounds_of_groups_and_csg() {
    let ball = || sphere(1.0).unwrap();
    let placed = ball().scale([0.5, 2.0, 4.0]).translate([1.0, -3.0, 5.0]);
    assert_bounds(&placed, [0.5, -5.0, 1.0], [1.5, -1.0, 9.0]);
    let first = ball().scale(Vec3::splat(2.0)).translate([2.0, 5.0, -3.0]);
    let second =
        upright(&cylinder(1.0, 4.0).unwrap(), 0.0).scale([0.5, 1.0, 0.5]).translate([-4.0, -1.0, 4.0]);
    assert_bounds(&(first | second), [-4.5, -3.0, -5.0], [4.0, 7.0, 4.5]);
    let moved = ball().translate([2.0, 3.0, 4.0]);
    assert_bounds(&(ball() | &moved), [-1.0; 3], [3.0, 4.0, 5.0]);
    // in the book the difference has the bounds of the union
    assert_bounds(&(ball() - &moved), [-1.0; 3], [1.0; 3]);
}

#[test]
fn rays_and_a_box_at_the_origin() {
    let cube = box_(Vec3::splat(2.0)).unwrap();
    for (origin, direction, expected) in [
        ([5.0, 0.5, 0.0], [-1.0, 0.0, 0.0], true),
        ([-5.0, 0.5, 0.0], [1.0, 0.0, 0.0], true),
        ([0.5, 5.0, 0.0], [0.0, -1.0, 0.0], true),
        ([0.5, -5.0, 0.0], [0.0, 1.0, 0.0], true),
        ([0.5, 0.0, 5.0], [0.0, 0.0, -1.0], true),
        ([0.5, 0.0, -5.0], [0.0, 0.0, 1.0], true),
        ([0.0, 0.5, 0.0], [0.0, 0.0, 1.0], true),
        ([-2.0, 0.0, 0.0], [2.0, 4.0, 6.0], false),
        ([0.0, -2.0, 0.0], [6.0, 2.0, 4.0], false),
        ([0.0, 0.0, -2.0], [4.0, 6.0, 2.0], false),
        ([2.0, 0.0, 2.0], [0.0, 0.0, -1.0], false),
        ([0.0, 2.0, 2.0], [0.0, -1.0, 0.0], false),
        ([2.0, 2.0, 0.0], [-1.0, 0.0, 0.0], false),
    ] {
        assert_eq!(times(&cube, unit_ray(origin, direction)).len() == 2, expected, "{origin:?}");
    }
}

#[test]
fn rays_and_a_box_elsewhere() {
    let solid = box_from_corners(chest().lo, chest().hi).unwrap();
    for (origin, direction, expected) in [
        ([15.0, 1.0, 2.0], [-1.0, 0.0, 0.0], true),
        ([-5.0, -1.0, 4.0], [1.0, 0.0, 0.0], true),
        ([7.0, 6.0, 5.0], [0.0, -1.0, 0.0], true),
        ([9.0, -5.0, 6.0], [0.0, 1.0, 0.0], true),
        ([8.0, 2.0, 12.0], [0.0, 0.0, -1.0], true),
        ([6.0, 0.0, -5.0], [0.0, 0.0, 1.0], true),
        ([8.0, 1.0, 3.5], [0.0, 0.0, 1.0], true),
        ([9.0, -1.0, -8.0], [2.0, 4.0, 6.0], false),
        ([8.0, 3.0, -4.0], [6.0, 2.0, 4.0], false),
        ([9.0, -1.0, -2.0], [4.0, 6.0, 2.0], false),
        ([4.0, 0.0, 9.0], [0.0, 0.0, -1.0], false),
        ([8.0, 6.0, -1.0], [0.0, -1.0, 0.0], false),
        ([12.0, 5.0, 4.0], [-1.0, 0.0, 0.0], false),
    ] {
        assert_eq!(times(&solid, unit_ray(origin, direction)).len() == 2, expected, "{origin:?}");
    }
}
