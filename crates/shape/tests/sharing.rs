//! Surface sharing: equal surfaces share one canonical form, and only they.

mod oracle;

use oracle::*;
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use rayweave_math::{Affine, Mat3, Transform, Vec3};
use rayweave_shape::surface::{Surface, WideClass, share};
use std::time::Instant;

const U: f64 = f64::EPSILON / 2.0;

fn with_magnitude(surfaces: &[Surface]) -> Vec<(Surface, f64)> {
    surfaces.iter().map(|s| (s.clone(), s.magnitude() + 1.0)).collect()
}

fn kinds(place: Vec3, axis: Vec3) -> Vec<Surface> {
    let form = Mat3::from_diagonal(Vec3::new(1.0, 0.5, -0.25));
    vec![
        Surface::plane(axis, axis.dot(place)),
        Surface::sphere(place, 1.0),
        Surface::cylinder(place, axis, 1.0),
        Surface::cone(place, axis, 0.5),
        Surface::quadric_about(place, form, Vec3::ZERO, -1.0),
        Surface::torus(place, axis, 1.0, 0.25),
    ]
}

/// The same surface under two different maps: the copies differ by rounding and share one canonical form.
#[test]
fn copies_that_differ_by_rounding_are_one() {
    let mut rng = rng(51);
    for _ in 0..200 {
        let (place, axis) = (unit_vector(&mut rng), unit_vector(&mut rng));
        let mut surfaces = Vec::new();
        for surface in kinds(place, axis) {
            let whole = rng.random_range(-180.0..180.0);
            let (turn_axis, by) = (unit_vector(&mut rng), 3.0 * unit_vector(&mut rng));
            let once = Affine::rotation(turn_axis, whole).then(&Affine::translate(by));
            let halves = Affine::rotation(turn_axis, 0.25 * whole)
                .then(&Affine::rotation(turn_axis, 0.75 * whole))
                .then(&Affine::translate(0.3 * by))
                .then(&Affine::translate(0.7 * by));
            surfaces.push(surface.transformed(&Transform::from_affine(once).unwrap()));
            surfaces.push(surface.transformed(&Transform::from_affine(halves).unwrap()));
        }
        let shared = share(&with_magnitude(&surfaces)).unwrap();
        for pair in shared.representative.chunks(2) {
            assert_eq!(pair[0], pair[1], "{surfaces:?}");
        }
        let mut distinct = shared.representative;
        distinct.sort_unstable();
        distinct.dedup();
        assert_eq!(distinct.len(), 6);
    }
}

#[test]
fn planes_and_axes_of_either_sense_are_one() {
    let mut rng = rng(52);
    for _ in 0..300 {
        // also perpendicular to the direction that distinguishes the senses, and along coordinate axes
        let axis = match rng.random_range(0..3) {
            0 => Vec3::AXES[rng.random_range(0..3)],
            1 => Vec3::new(0.617_340_218_6, 0.531_871_409_3, 0.579_913_306_7)
                .cross(unit_vector(&mut rng))
                .normalize(),
            _ => unit_vector(&mut rng),
        };
        let noise = |rng: &mut ChaCha8Rng| 8.0 * U * Vec3::ZERO.map(|_| rng.random_range(-1.0..1.0));
        let there = kinds(Vec3::X, axis);
        let back = kinds(Vec3::X, -axis + noise(&mut rng));
        let both: Vec<Surface> = there.into_iter().chain(back).collect();
        let shared = share(&with_magnitude(&both)).unwrap();
        for k in 0..6 {
            assert_eq!(shared.representative[k], shared.representative[k + 6], "{both:?}");
        }
        assert!(shared.flipped[0] ^ shared.flipped[6]);
        assert_eq!(shared.flipped.iter().filter(|&&f| f).count(), 1);
    }
}

/// `sum weights_k x_k^2 + slope z + constant < 0`, turned about an axis.
fn conic(weights: [f64; 3], slope: f64, constant: f64, axis: Vec3, degrees: f64) -> Surface {
    let matrix = Mat3::from_diagonal(weights.into());
    let turn = Transform::from_affine(Affine::rotation(axis, degrees)).unwrap();
    Surface::quadric_about(Vec3::ZERO, matrix, slope * Vec3::Z, constant).transformed(&turn)
}

/// Pairs of descriptions of one surface, and whether the equations have opposite signs.
fn one_surface_two_ways() -> Vec<(Surface, Surface, bool)> {
    let [x, y, z] = Vec3::AXES;
    let plain = |weights, slope, constant| conic(weights, slope, constant, z, 0.0);
    vec![
        // ellipsoids with three, two and no different half axes, thin and flat ones
        (plain([1.0, 0.5, 0.25], 0.0, -1.0), conic([0.5, 1.0, 0.25], 0.0, -1.0, z, 90.0), false),
        (plain([1.0, 0.5, 0.25], 0.0, -1.0), conic([0.5, 0.25, 1.0], 0.0, -1.0, Vec3::ONE, 120.0), false),
        (plain([1.0, 0.5, 0.25], 0.0, -1.0), conic([1.0, 0.5, 0.25], 0.0, -1.0, y, 180.0), false),
        (plain([1.0, 1.0, 0.25], 0.0, -1.0), conic([1.0, 1.0, 0.25], 0.0, -1.0, z, 33.0), false),
        (plain([1e-12, 1e-12, 1.0], 0.0, -1.0), conic([1e-12, 1e-12, 1.0], 0.0, -1.0, z, 33.0), false),
        (plain([1.0, 1.0, 1e-12], 0.0, -1.0), conic([1.0, 1.0, 1e-12], 0.0, -1.0, z, 33.0), false),
        (Surface::sphere(Vec3::ZERO, 0.5), conic([1.0, 1.0, 1.0], 0.0, -0.25, Vec3::ONE, 33.0), false),
        (Surface::sphere(Vec3::ZERO, 0.5), plain([-4.0, -4.0, -4.0], 0.0, 1.0), true),
        // hyperboloids, cones, pairs of planes, saddles: also with the negative equation
        (plain([1.0, 1.0, -0.5], 0.0, -1.0), conic([1.0, 1.0, -0.5], 0.0, -1.0, z, 33.0), false),
        (plain([1.0, 1.0, -0.5], 0.0, -1.0), plain([-2.0, -2.0, 1.0], 0.0, 2.0), true),
        (plain([1.0, 1.0, -1.0], 0.0, 0.0), conic([-1.0, -1.0, 1.0], 0.0, 0.0, z, 33.0), true),
        (Surface::cone(Vec3::ZERO, -z, 0.5), conic([1.0, 1.0, -0.25], 0.0, 0.0, z, 33.0), false),
        (Surface::cone(Vec3::ZERO, z, 2.0), conic([-0.25, -0.25, 1.0], 0.0, 0.0, z, 33.0), true),
        (Surface::cone(Vec3::ZERO, z, 2f64.sqrt()), conic([0.5, 0.5, -1.0], 0.0, 0.0, z, 33.0), false),
        (plain([1.0, -1.0, 0.0], 0.0, 0.0), conic([1.0, -1.0, 0.0], 0.0, 0.0, z, 90.0), true),
        (plain([1.0, -1.0, 0.0], 0.0, 0.0), conic([-1.0, 1.0, 0.0], 0.0, 0.0, z, 90.0), false),
        (plain([1.0, -1.0, 0.0], 1.0, 0.0), conic([1.0, -1.0, 0.0], 1.0, 0.0, z, 180.0), false),
        (plain([1.0, -1.0, 0.0], 1.0, 0.0), conic([1.0, -1.0, 0.0], 1.0, 0.0, x + y, 180.0), true),
        // cylinders and paraboloids
        (Surface::cylinder(Vec3::ZERO, z, 0.5), conic([1.0, 1.0, 0.0], 0.0, -0.25, z, 33.0), false),
        (plain([1.0, 0.5, 0.0], 0.0, -1.0), conic([0.5, 1.0, 0.0], 0.0, -1.0, z, 90.0), false),
        (plain([1.0, 1.0, 0.0], -0.5, 0.0), conic([1.0, 1.0, 0.0], -0.5, 0.0, z, 33.0), false),
        (plain([1.0, 0.0, 0.0], 0.0, -1.0), conic([1.0, 0.0, 0.0], 0.0, -1.0, x, 33.0), false),
        (plain([1.0, 0.0, 0.0], -0.5, 0.0), conic([1.0, 0.0, 0.0], -0.5, 0.0, z, 180.0), false),
    ]
}

/// However the axes of a quadric are chosen, it is one surface; the representative does not depend on the order.
#[test]
fn quadrics_with_other_axes_are_one() {
    let mut rng = rng(54);
    for (k, (first, second, is_negative)) in one_surface_two_ways().into_iter().enumerate() {
        for _ in 0..50 {
            let (axis, degrees) = (unit_vector(&mut rng), rng.random_range(-180.0..180.0));
            let turn = Affine::rotation(axis, degrees).then(&Affine::translate(3.0 * unit_vector(&mut rng)));
            let turn = Transform::from_affine(turn).unwrap();
            let both = [first.transformed(&turn), second.transformed(&turn)];
            let shared = share(&with_magnitude(&both)).unwrap();
            let chosen = shared.representative[0];
            assert_eq!(chosen, shared.representative[1], "pair {k}: {both:?}");
            assert_eq!(shared.flipped[0] ^ shared.flipped[1], is_negative, "pair {k}: {both:?}");
            assert!(!shared.flipped[chosen as usize]);
            let [a, b] = both;
            let again = share(&with_magnitude(&[b, a])).unwrap();
            assert_eq!(again.representative, [1 - chosen; 2]);
            // the values of f have the same sign, or the opposite one
            for _ in 0..20 {
                let point = 3.0 * unit_vector(&mut rng);
                let [a, b] = [&first, &second].map(|surface| surface.value_and_gradient(point).0);
                assert!(a.abs() < 1e-12 || ((a < 0.0) != (b < 0.0)) == is_negative, "pair {k} at {point}");
            }
        }
    }
}

/// Far from the origin the radii of equal spheres may differ by the tolerance of a length there, also if one of them is a quadric.
#[test]
fn a_sphere_as_a_quadric_has_the_tolerance_of_spheres() {
    let at = |surface: Surface| {
        surface.transformed(&Transform::from_affine(Affine::translate(1e3 * Vec3::X)).unwrap())
    };
    let ball = |radius: f64| at(Surface::sphere(Vec3::ZERO, radius));
    let matrix = Mat3::from_diagonal(Vec3::ONE);
    let quadric = at(Surface::quadric_about(Vec3::ZERO, matrix, Vec3::ZERO, -1e-6));
    let balls = [ball(1e-3), ball(1e-3 + 6e-12), ball(1e-3 + 12e-12)];
    assert_eq!(share(&with_magnitude(&balls)).unwrap().representative, [0, 0, 0]);
    let all = [quadric, ball(1e-3), ball(1e-3 + 6e-12), ball(1e-3 + 12e-12)];
    assert_eq!(share(&with_magnitude(&all)).unwrap().representative, [1, 1, 1, 1]);
}

#[test]
fn quadrics_that_differ_in_one_axis_or_weight_stay_apart() {
    let [x, _, z] = Vec3::AXES;
    let pairs = [
        ([1.0, 0.5, 0.25], [1.0, 0.5, 0.25], z, 90.0),
        ([1.0, 0.5, 0.25], [1.0, 0.5, 0.25], z, 1e-10),
        ([1.0, 0.5, 0.25], [1.0, 0.5 + 1e-13, 0.25], z, 0.0),
        // the matrices are equal to 1e-20
        ([1e-20, 2e-20, 1.0], [1e-20, 2e-20, 1.0], z, 90.0),
        ([1e-20, 2e-20, 1.0], [1e-20, 2.0001e-20, 1.0], z, 0.0),
        ([1.0, 1.0, 1e-20], [1.0, 1.0, 2e-20], z, 0.0),
        ([1.0, 1.0, 1e-20], [1.0, 1.0, 1e-20], x, 1e-10),
        ([1.0, 1.0, 0.0], [1.0, 1.0, 1e-20], z, 0.0),
        ([1.0, -1.0, 0.0], [1.0, -1.0, 0.0], z, 45.0),
    ];
    for (weights, others, axis, degrees) in pairs {
        let both = [conic(weights, 0.0, -1.0, axis, 0.0), conic(others, 0.0, -1.0, axis, degrees)];
        let shared = share(&with_magnitude(&both)).unwrap();
        assert_eq!(shared.representative, [0, 1], "{both:?}");
    }
}

#[test]
fn what_differs_by_more_than_the_tolerance_stays_apart() {
    let base = kinds(Vec3::X, Vec3::new(0.6, 0.0, 0.8));
    let moved = kinds(Vec3::X + Vec3::new(0.0, 0.0, 1e-12), Vec3::new(0.6, 0.0, 0.8));
    let turned = kinds(Vec3::X, Vec3::new(0.6, 1e-12, 0.8));
    let all: Vec<Surface> = base.into_iter().chain(moved).chain(turned).collect();
    let shared = share(&with_magnitude(&all)).unwrap();
    for (k, &representative) in shared.representative.iter().enumerate() {
        // the sphere and the quadric have no axis to reverse
        let (kind, copy) = (k % 6, k / 6);
        let same_as_first = copy == 2 && (kind == 1 || kind == 4);
        assert_eq!(representative as usize == k, !same_as_first || representative as usize == k);
        assert_eq!(shared.representative[kind] == representative, copy == 0 || same_as_first);
    }
    assert_eq!(share::<Surface>(&[]).unwrap().representative.len(), 0);
}

#[test]
fn the_answer_does_not_depend_on_the_order() {
    let mut rng = rng(53);
    let mut surfaces = Vec::new();
    for k in 0..60 {
        let offset = f64::from(k / 6) + 4.0 * U * rng.random_range(-1.0..1.0);
        surfaces.push(Surface::plane(Vec3::new(0.6, 0.0, 0.8), offset));
    }
    let chosen = |surfaces: &[Surface]| {
        let shared = share(&with_magnitude(surfaces)).unwrap();
        let mut pairs: Vec<(String, String)> = shared
            .representative
            .iter()
            .enumerate()
            .map(|(k, &r)| (format!("{:?}", surfaces[k]), format!("{:?}", surfaces[r as usize])))
            .collect();
        pairs.sort();
        pairs
    };
    let want = chosen(&surfaces);
    for _ in 0..10 {
        for k in (1..surfaces.len()).rev() {
            surfaces.swap(k, rng.random_range(0..=k));
        }
        assert_eq!(chosen(&surfaces), want);
    }
}

#[test]
fn a_chain_wider_than_four_tolerances_is_rejected() {
    let step = 50.0 * U;
    let chain = |count: usize| -> Vec<(Surface, f64)> {
        (0..count).map(|k| (Surface::plane(Vec3::Z, 1.0 + step * k as f64), 1.0)).collect()
    };
    assert!(share(&chain(5)).unwrap().representative.iter().all(|&r| r == 0));
    let refused = share(&chain(8)).unwrap_err();
    assert_eq!(refused, WideClass { first: 0, second: 7 });
    assert!(refused.to_string().starts_with("surfaces 0 and 7 are neither equal nor distinct"));
    // a part of a large solid within the tolerance of two faces of a small one
    let faces = [(0.0, 1e-3), (200.0, 1e-3), (100.0, 10.0)];
    let faces = faces.map(|(k, magnitude)| (Surface::plane(Vec3::Z, 1e-3 + k * 1e-3 * U), magnitude));
    assert_eq!(share(&faces[..2]).unwrap().representative, [0, 1]);
    assert_eq!(share(&faces).unwrap().representative, [0, 0, 0]);
    // near in each parameter alone, but not chained: two of them differ in both
    let sphere = |x: f64, y: f64| (Surface::sphere(Vec3::new(1.0 + x * U, y * U, 0.0), 1.0), 1.0);
    let corners = [sphere(0.0, 0.0), sphere(60.0, 100.0), sphere(120.0, 0.0), sphere(0.0, 200.0)];
    let shared = share(&corners).unwrap();
    assert_eq!(shared.representative, [0, 1, 2, 3]);
}

/// 100 x 100 touching tiles, each with its own six planes: 202 planes remain.
#[test]
fn a_field_of_tiles_shares_its_faces_quickly() {
    let mut surfaces = Vec::new();
    let turn = Affine::rotation(Vec3::new(1.0, 2.0, 3.0), 20.0);
    for tile in 0..10_000 {
        let by = Vec3::new(f64::from(tile % 100), f64::from(tile / 100), 0.0);
        let to = Transform::from_affine(Affine::translate(by).then(&turn)).unwrap();
        for k in 0..3 {
            surfaces.push(Surface::plane(Vec3::AXES[k], 0.5).transformed(&to));
            surfaces.push(Surface::plane(-Vec3::AXES[k], 0.5).transformed(&to));
        }
    }
    let entries: Vec<(Surface, f64)> = surfaces.into_iter().map(|s| (s, 200.0)).collect();
    let start = Instant::now();
    let shared = share(&entries).unwrap();
    let seconds = start.elapsed().as_secs_f64();
    let mut distinct = shared.representative.clone();
    distinct.sort_unstable();
    distinct.dedup();
    assert_eq!(distinct.len(), 101 + 101 + 2);
    assert!(seconds < 5.0, "{seconds} s for 60,000 planes");
    for (k, &r) in shared.representative.iter().enumerate() {
        let (Surface::Plane(a), Surface::Plane(b)) = (&entries[k].0, &entries[r as usize].0) else {
            panic!("planes");
        };
        assert_eq!(shared.flipped[k], a.normal.dot(b.normal) < 0.0);
    }
}
