//! Distances compared with closed forms, and bounds at little effort.

use super::*;
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_model::Solid;
use rayweave_shape::primitive::{
    CentredBox, Cone, Cylinder, Ellipsoid, HalfSpace, Primitive, Sphere, Torus, Wedge,
};

fn solid(primitive: impl Into<Primitive>) -> Solid {
    Solid::from(primitive.into())
}

fn ball(radius: f64) -> Solid {
    solid(Sphere::new(radius).unwrap())
}

fn cube(x: f64, y: f64, z: f64) -> Solid {
    solid(CentredBox::new(Vec3::new(x, y, z)).unwrap())
}

fn rod(radius: f64, height: f64) -> Solid {
    solid(Cylinder::new(radius, height).unwrap())
}

fn field(solid: &Solid) -> DistanceField {
    DistanceField::new(&Program::compile(solid).unwrap(), DistanceSettings::default()).unwrap()
}

fn points(seed: u64, count: usize, half: f64) -> Vec<Vec3> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut side = || rng.random_range(-half..half);
    (0..count).map(|_| Vec3::new(side(), side(), side())).collect()
}

/// Asserts exact answers equal to a closed form, and consistent nearest points.
fn check(solid: &Solid, expected: impl Fn(Vec3) -> f64, points: &[Vec3]) {
    let field = field(solid);
    for &point in points {
        let (found, expected) = (field.distance(point), expected(point));
        let tolerance = 3e-9 * expected.abs() + 1e-11;
        assert!(found.is_exact, "{point}: {found:?}, expected {expected}");
        assert!((found.signed() - expected).abs() <= tolerance, "{point}: {found:?}, expected {expected}");
        assert!(
            found.lower <= expected.abs() + 1e-12 && expected.abs() <= found.upper + 1e-12,
            "{point}: {found:?}"
        );
        let nearest = found.nearest.unwrap();
        assert!(((nearest - point).length() - expected.abs()).abs() <= tolerance, "{point}: {found:?}");
    }
}

/// The distance from a box with these half sides, negative inside.
fn box_distance(point: Vec3, half: Vec3) -> f64 {
    let q = point.abs() - half;
    q.max(Vec3::ZERO).length() + q.max_element().min(0.0)
}

/// The distance from a region of the half-plane, given by segments of its boundary.
fn profile_distance(point: Vec3, is_inside: bool, segments: &[[(f64, f64); 2]]) -> f64 {
    let at = (point.truncate().length(), point.z);
    let from = |&[a, b]: &[(f64, f64); 2]| {
        let (ux, uy) = (b.0 - a.0, b.1 - a.1);
        let t = (((at.0 - a.0) * ux + (at.1 - a.1) * uy) / (ux * ux + uy * uy)).clamp(0.0, 1.0);
        (at.0 - a.0 - t * ux).hypot(at.1 - a.1 - t * uy)
    };
    let distance = segments.iter().map(from).fold(f64::INFINITY, f64::min);
    if is_inside { -distance } else { distance }
}

#[test]
fn shapes_with_closed_forms() {
    let far = points(1, 60, 4.0);
    check(&ball(1.5), |p| p.length() - 1.5, &far);
    check(&cube(2.0, 3.0, 1.0), |p| box_distance(p, Vec3::new(1.0, 1.5, 0.5)), &far);
    check(
        &solid(HalfSpace::new(Vec3::new(0.0, 0.6, 0.8), 0.5).unwrap()),
        |p| 0.6 * p.y + 0.8 * p.z - 0.5,
        &far,
    );
    let ring = |p: Vec3| (p.truncate().length() - 2.0).hypot(p.z) - 0.5;
    check(&solid(Torus::new(2.0, 0.5).unwrap()), ring, &far);
    let rim = [[(0.0, -1.0), (1.0, -1.0)], [(1.0, -1.0), (1.0, 1.0)], [(1.0, 1.0), (0.0, 1.0)]];
    let in_rod = |p: Vec3| p.truncate().length() < 1.0 && p.z.abs() < 1.0;
    check(&rod(1.0, 2.0), |p| profile_distance(p, in_rod(p), &rim), &far);
}

#[test]
fn cones_tubes_and_the_axis() {
    let mut far = points(2, 40, 3.0);
    far.extend((-6..7).map(|k| Vec3::new(0.0, 0.0, 0.5 * f64::from(k) + 0.1)));
    let frustum = solid(Cone::new(1.5, 0.5, 2.0).unwrap());
    let sides = [[(0.0, -1.0), (1.5, -1.0)], [(1.5, -1.0), (0.5, 1.0)], [(0.5, 1.0), (0.0, 1.0)]];
    let in_cone = |p: Vec3| p.z.abs() < 1.0 && p.truncate().length() < 1.0 - 0.5 * p.z;
    check(&frustum, |p| profile_distance(p, in_cone(p), &sides), &far);
    let tube = rod(2.0, 1.0) - rod(1.0, 3.0);
    let sides = [
        [(1.0, -0.5), (2.0, -0.5)],
        [(2.0, -0.5), (2.0, 0.5)],
        [(2.0, 0.5), (1.0, 0.5)],
        [(1.0, 0.5), (1.0, -0.5)],
    ];
    let in_tube = |p: Vec3| p.z.abs() < 0.5 && (1.0..2.0).contains(&p.truncate().length());
    check(&tube, |p| profile_distance(p, in_tube(p), &sides), &far);
}

/// Wedges on both sides of 180 degrees, whose wide ones are complements of two half-spaces, alone, cut to a rod, complemented,
/// and placed: the nearest boundary point lies on one of the two half-planes, or on the rod outside them.
#[test]
fn wedges_of_any_sweep() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let sweeps = [30.0, 90.0, 180.0, 181.0, 200.0, 270.0, 330.0];
    for (k, sweep) in sweeps.into_iter().enumerate() {
        let start = 90.0 * f64::from(rng.random_range(-4..4)) + if k % 2 == 0 { 0.0 } else { 17.0 };
        let sector = solid(Wedge::new(start, sweep).unwrap());
        let angle = |p: Vec3| (libm::atan2(p.y, p.x).to_degrees() - start).rem_euclid(360.0);
        // the angles of a point from both faces; beyond a right angle the edge is nearest
        let from_face = |p: Vec3, away: f64| {
            let (rho, away) = (p.truncate().length(), away.rem_euclid(360.0));
            let away = away.min(360.0 - away);
            if away < 90.0 { rho * libm::sin(away.to_radians()) } else { rho }
        };
        let distance = |p: Vec3| {
            let least = from_face(p, angle(p)).min(from_face(p, angle(p) - sweep));
            if angle(p) < sweep { -least } else { least }
        };
        let some = points(20 + k as u64, 30, 1.9);
        check(&sector, distance, &some);
        check(&!&sector, |p| -distance(p), &some[..10]);
        let placed = sector.place([rayweave_math::Affine::translate(Vec3::X)]);
        check(&placed, |p| distance(p - Vec3::X), &some[..10]);
        // inside, the rod's boundary may be nearer
        let cut = &sector & &rod(2.0, 2.0);
        let inside: Vec<Vec3> = some
            .iter()
            .copied()
            .filter(|p| angle(*p) < sweep && p.truncate().length() < 2.0 && p.z.abs() < 1.0)
            .collect();
        let in_rod = |p: Vec3| (p.truncate().length() - 2.0).max(p.z.abs() - 1.0);
        let side_is_within = |p: Vec3| distance(p).max(in_rod(p));
        check(&cut, side_is_within, &inside);
    }
}

/// A shell, a lens, and a drilled ball: surfaces that meet in circles, inner boundaries, and faces inside a union.
#[test]
fn combinations() {
    let far = points(3, 40, 3.0);
    let shell = |p: Vec3| (p.length() - 2.0).max(1.0 - p.length());
    check(&(ball(2.0) - ball(1.0)), shell, &far);
    // two boxes that touch: the common face is no boundary
    let pair = cube(1.0, 2.0, 2.0).translate(Vec3::new(-0.5, 0.0, 0.0))
        | cube(1.0, 2.0, 2.0).translate(Vec3::new(0.5, 0.0, 0.0));
    check(&pair, |p| box_distance(p, Vec3::ONE), &far);
    // a corner taken from a cube: inside, the nearest point may be on the notch
    let notched = cube(2.0, 2.0, 2.0) - cube(2.0, 2.0, 2.0).translate(Vec3::ONE);
    let octant = |p: Vec3| {
        let inside_big = box_distance(p, Vec3::ONE);
        let notch = box_distance(p - Vec3::splat(0.5), Vec3::splat(0.5));
        // the part of the notch's boundary in the closed cube: its three inner faces
        let corner = |axis: usize| {
            let mut q = p.clamp(Vec3::ZERO, Vec3::ONE);
            q[axis] = 0.0;
            (q - p).length()
        };
        let inner = corner(0).min(corner(1)).min(corner(2));
        if inside_big < 0.0 && notch > 0.0 {
            // faces of the cube without the notch: clip each away from the quadrant x, y > 0 of the faces at +1
            let face = |axis: usize, sign: f64| {
                let mut q = p.clamp(-Vec3::ONE, Vec3::ONE);
                q[axis] = sign;
                let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
                if sign > 0.0 && q[a] > 0.0 && q[b] > 0.0 {
                    if q[a] < q[b] { q[a] = 0.0 } else { q[b] = 0.0 }
                }
                (q - p).length()
            };
            let faces = (0..3).flat_map(|axis| [face(axis, 1.0), face(axis, -1.0)]);
            return -faces.fold(inner, f64::min);
        }
        f64::NAN
    };
    let inside: Vec<Vec3> = points(4, 200, 1.0).into_iter().filter(|&p| octant(p) < 0.0).take(60).collect();
    assert!(inside.len() == 60);
    check(&notched, octant, &inside);
}

/// An ellipsoid, whose distance has no closed form: bisection of Lagrange's equation (D. Eberly, "Distance from a point to an
/// ellipse, an ellipsoid, or a hyperellipsoid", 2013).
#[test]
fn ellipsoids() {
    let radii = Vec3::new(2.0, 1.0, 0.6);
    let expected = |p: Vec3| {
        let q = p.abs();
        let g = |t: f64| {
            let x = radii * q / (radii * radii + Vec3::splat(t));
            x.dot(x) - 1.0
        };
        let is_inside = (q / radii).length() < 1.0;
        let (mut lo, mut hi) = (-radii.z * radii.z + radii.z * q.z, 100.0);
        for _ in 0..200 {
            let middle = 0.5 * (lo + hi);
            if g(middle) > 0.0 { lo = middle } else { hi = middle }
        }
        let foot = radii * radii * q / (radii * radii + Vec3::splat(lo));
        let distance = (foot - q).length();
        if is_inside { -distance } else { distance }
    };
    check(&solid(Ellipsoid::new(radii).unwrap()), expected, &points(5, 60, 3.0));
}

/// Points that are far away in units of the radii, whose feet Newton's method does not reach in a few steps, and thin tori: the
/// closed form of one face. The search is not needed, so that few boxes suffice, and the bounds hold without any slack.
#[test]
fn far_points_and_thin_shapes() {
    let quick = |solid: &Solid| {
        let settings = DistanceSettings { most_cells: 0, ..DistanceSettings::default() };
        DistanceField::new(&Program::compile(solid).unwrap(), settings).unwrap()
    };
    type Expected = Box<dyn Fn(Vec3) -> f64>;
    let shapes: Vec<(Solid, Expected)> = vec![
        (ball(1.0), Box::new(|p| p.length() - 1.0)),
        (solid(Cylinder::new(1.0, f64::INFINITY).unwrap()), Box::new(|p| p.x.hypot(p.y) - 1.0)),
        (solid(Torus::new(5.0, 1.0).unwrap()), Box::new(|p| (p.x.hypot(p.y) - 5.0).hypot(p.z) - 1.0)),
        (solid(Torus::new(9.5, 0.7).unwrap()), Box::new(|p| (p.x.hypot(p.y) - 9.5).hypot(p.z) - 0.7)),
        (solid(Torus::new(9.5, 0.01).unwrap()), Box::new(|p| (p.x.hypot(p.y) - 9.5).hypot(p.z) - 0.01)),
        (
            solid(HalfSpace::new(Vec3::new(0.0, 0.6, 0.8), 0.5).unwrap()),
            Box::new(|p| 0.6 * p.y + 0.8 * p.z - 0.5),
        ),
    ];
    for (half, seed) in [(20.0, 31), (1e3, 32), (1e8, 33)] {
        for (solid, expected) in &shapes {
            let field = quick(solid);
            for point in points(seed, 50, half) {
                let (found, expected) = (field.distance(point), expected(point));
                let rounding = 4.0 * f64::EPSILON * (point.length() + 10.0);
                assert!(found.is_exact, "{point}: {found:?}, expected {expected}");
                assert!((found.signed() - expected).abs() <= rounding, "{point}: {found:?}, {expected}");
                assert!(found.lower <= expected.abs() && expected.abs() <= found.upper, "{point}: {found:?}");
            }
        }
    }
    let ring = quick(&solid(Torus::new(9.5, 0.7).unwrap()));
    let point = Vec3::new(-8.16410028119773, -4.361557833364126, 13.327296333344108);
    let (found, expected) = (ring.distance(point), (point.x.hypot(point.y) - 9.5).hypot(point.z) - 0.7);
    assert!(found.lower <= expected && expected <= found.upper, "{found:?}, expected {expected}");
    // on the axis and at the centre all directions are equal
    assert_eq!(quick(&ball(1.0)).distance(Vec3::ZERO).signed(), -1.0);
    assert_eq!(quick(&solid(Torus::new(4.0, 1.0).unwrap())).distance(Vec3::new(0.0, 0.0, 3.0)).signed(), 4.0);
}

/// The nearest point of a quadric lies on it, its normal leads to the point, and a search of the surface by random points finds
/// none that is nearer: ellipsoids, cylinders, paraboloids and hyperboloids, and points on planes of symmetry, where the nearest
/// points are a pair.
#[test]
fn nearest_points_of_quadrics() {
    use rayweave_shape::surface::Quadric;
    let (x, tilt) = (Vec3::new(2.0, 3.0, 6.0) / 7.0, Vec3::new(6.0, 2.0, -3.0) / 7.0);
    let axes = [x, tilt, x.cross(tilt)];
    let forms = [
        (Vec3::new(1.0, 0.25, 0.04), Vec3::ZERO, -1.0),
        (Vec3::new(1.0, 1e-4, 0.3), Vec3::ZERO, -1e-2),
        (Vec3::new(1.0, 0.3, 0.0), Vec3::ZERO, -1.0),
        (Vec3::new(1.0, 0.5, 0.0), Vec3::new(0.0, 0.0, -1.0), 0.3),
        (Vec3::new(1.0, 0.5, -0.7), Vec3::ZERO, -1.0),
        (Vec3::new(1.0, 0.5, -0.7), Vec3::ZERO, 1.0),
        (Vec3::new(-1.0, -0.5, 0.7), Vec3::new(0.1, 0.0, 0.2), -0.5),
        (Vec3::new(1.0, -1.0, 0.0), Vec3::new(0.0, 0.0, 0.5), 0.0),
    ];
    let mut rng = ChaCha8Rng::seed_from_u64(34);
    for (k, &(weights, linear, constant)) in forms.iter().enumerate() {
        let centre = Vec3::new(0.3, -2.0, 1.0);
        let form = Quadric { centre, axes, weights, linear, constant };
        let surface = Surface::Quadric(Box::new(form));
        let mut places = points(40 + k as u64, 40, 4.0);
        places.extend(points(60 + k as u64, 10, 1e4));
        places.extend((0..6).map(|j| centre + 0.4 * (j / 3) as f64 * axes[j % 3]));
        for place in places {
            let (feet, bound) = quadric_foot::quadric_foot(&form, place).unwrap();
            for foot in feet {
                let (value, gradient) = surface.value_and_gradient(foot);
                let lengths = foot.length() + 3.0;
                assert!(value.abs() <= 1e-13 * lengths * gradient.length(), "{k} {place} {foot}: {value}");
                let distance = (foot - place).length();
                let across = gradient.cross(foot - place).length();
                assert!(across <= 1e-6 * gradient.length() * (distance + 1e-3), "{k} {place} {foot}");
                let slack = 1e-13 * (place.length() + lengths);
                assert!((distance - bound).abs() <= slack, "{k} {place} {foot}: {distance} {bound}");
            }
            // crossings of random lines through places near the point
            for _ in 0..100 {
                let mut side = || rng.random_range(-1.0..1.0);
                let direction = Vec3::new(side(), side(), side());
                let start = place + Vec3::new(side(), side(), side()) * bound;
                let ray = rayweave_shape::Ray { origin: start, direction };
                for &time in form.crossings(&ray).times() {
                    let nearer = (ray.origin + time * direction - place).length();
                    assert!(nearer >= bound * (1.0 - 1e-12) - 1e-12, "{k} {place}: {nearer} {bound}");
                }
            }
        }
    }
}

/// Placed copies, and regions with priorities.
#[test]
fn placements_and_regions() {
    let maps: Vec<_> =
        (0..5).map(|k| rayweave_math::Affine::translate(Vec3::new(3.0 * f64::from(k), 0.0, 0.0))).collect();
    let row = ball(1.0).place(maps);
    let nearest_ball = |p: Vec3| {
        (0..5)
            .map(|k| (p - Vec3::new(3.0 * f64::from(k), 0.0, 0.0)).length() - 1.0)
            .fold(f64::INFINITY, f64::min)
    };
    check(&row, nearest_ball, &points(6, 60, 8.0));
    let region =
        |solid: Solid, medium: u32| rayweave_model::Region { name: medium.to_string(), solid, medium };
    let compile =
        |core: u32| Program::compile_regions(&[region(ball(2.0), 1), region(ball(1.0), core)]).unwrap();
    let settings = DistanceSettings::default();
    let (hollow, filled) = (compile(0), compile(2));
    let shell = DistanceField::new(&hollow, settings).unwrap();
    let first = DistanceField::of_regions(&filled, &|region| region.index() == 1, settings).unwrap();
    let second = DistanceField::of_regions(&filled, &|region| region.index() == 2, settings).unwrap();
    for point in points(7, 50, 3.0) {
        let radius = point.length();
        let around = (radius - 2.0).max(1.0 - radius);
        for (field, expected) in [(&shell, around), (&first, around), (&second, radius - 1.0)] {
            let found = field.distance(point);
            assert!(
                found.is_exact && (found.signed() - expected).abs() < 1e-9,
                "{point}: {found:?}, {expected}"
            );
        }
    }
}

#[test]
fn no_boundary_and_bad_settings() {
    for (solid, is_inside) in [(Solid::empty(), false), (Solid::universe(), true)] {
        let found = field(&solid).distance(Vec3::ONE);
        assert_eq!((found.is_inside, found.lower, found.nearest), (is_inside, f64::INFINITY, None));
    }
    let program = Program::compile(&ball(1.0)).unwrap();
    for precision in [0.0, -1.0, f64::NAN, 2.0] {
        let settings = DistanceSettings { precision, ..DistanceSettings::default() };
        assert!(DistanceField::new(&program, settings).is_err());
    }
}

/// Bounds hold for any effort, and threads do not change the answers.
#[test]
fn bounds_without_effort() {
    let lens = ball(2.0).translate(Vec3::X) & ball(2.0).translate(-Vec3::X) & rod(1.2, 4.0).rotate_x(37.0);
    let program = Program::compile(&lens).unwrap();
    let points = points(8, 200, 3.0);
    let full = DistanceField::new(&program, DistanceSettings::default()).unwrap();
    let hasty =
        DistanceField::new(&program, DistanceSettings { most_cells: 20, ..DistanceSettings::default() })
            .unwrap();
    let mut one = DistanceRun { threads: NonZeroUsize::new(1), ..DistanceRun::default() };
    let mut seen = Vec::new();
    let mut progress = |done: usize| seen.push(done);
    let mut three = DistanceRun {
        threads: NonZeroUsize::new(3),
        progress: Some(&mut progress),
        ..DistanceRun::default()
    };
    let found = full.distances(&points, &mut one).unwrap();
    assert_eq!(found, full.distances(&points, &mut three).unwrap());
    assert!(seen.is_sorted() && seen.last() == Some(&points.len()), "{seen:?}");
    let hasty = hasty.distances(&points, &mut one).unwrap();
    for (full, hasty) in found.iter().zip(&hasty) {
        // nearly tangent surfaces may leave a gap
        assert!(full.upper - full.lower <= 1e-6 * full.upper, "{full:?}");
        assert!(hasty.lower <= full.upper && full.lower <= hasty.upper, "{full:?} {hasty:?}");
    }
    assert!(found.iter().filter(|answer| answer.is_exact).count() >= 195);
    assert!(hasty.iter().any(|answer| !answer.is_exact));
    let cancel = Cancel::new();
    cancel.cancel();
    let cancelled =
        full.distances(&points, &mut DistanceRun { cancel, ..DistanceRun::default() }).unwrap_err();
    assert!(matches!(cancelled, AnalysisError::Cancelled(_)), "{cancelled}");
    let mut bad = points.clone();
    bad[3].y = f64::NAN;
    let error = full.distances(&bad, &mut one).unwrap_err().to_string();
    assert!(error.starts_with("point 3 is [") && error.contains("must be finite"), "{error}");
}
