//! Coincidence of rays and surfaces: rays that lie in a surface, and pieces of rays that coincide with one.

use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::{Affine, Mat3, PERTURBATION_DIRECTION, Transform, UNIT_ROUNDOFF, Vec3};
use rayweave_shape::Ray;
use rayweave_shape::surface::{Surface, coincides_along, crossings_in, delta, lies_in};

fn turned(surface: &Surface, ray: &Ray, degrees: f64) -> (Surface, Ray) {
    let map = Affine::rotation(Vec3::new(0.3, -1.0, 0.7), degrees)
        .then(&Affine::translate(Vec3::new(30.0, -20.0, 10.0)));
    let to = Transform::from_affine(map).unwrap();
    (surface.transformed(&to), ray.transformed(&map))
}

/// Asserts whether the ray lies in the surface, by the definition, at any rotation.
fn check(surface: &Surface, ray: Ray, lies: bool) {
    for degrees in [0.0, 1e-6, 17.0, 90.0, 133.7] {
        let (surface, ray) = turned(surface, &ray, degrees);
        let answer = lies_in(&surface, surface.magnitude() + 40.0, &ray, (-3.0, 5.0));
        assert_eq!(answer, lies, "{surface:?}\n{ray:?}");
    }
}

#[test]
fn rays_in_planes_and_along_generators_lie_in_them() {
    let plane = Surface::plane(Vec3::new(1.0, 2.0, 2.0), 3.0);
    let foot = plane.anchor();
    check(&plane, Ray::new(foot, Vec3::new(2.0, -1.0, 0.0)), true);
    check(&plane, Ray::new(foot, Vec3::new(2.0, -1.0, 1e-9)), false);
    let cylinder = Surface::cylinder(Vec3::ZERO, Vec3::Z, 2.0);
    let on = Vec3::new(1.2, 1.6, 0.0);
    check(&cylinder, Ray::new(on, Vec3::Z), true);
    check(&cylinder, Ray::new(on, Vec3::new(-1.6, 1.2, 0.0)), false);
    check(&cylinder, Ray::new(on, Vec3::new(1e-9, 0.0, 1.0)), false);
    let cone = Surface::cone(Vec3::ZERO, Vec3::Z, 0.75);
    check(&cone, Ray::new(Vec3::ZERO, Vec3::new(3.0, 0.0, 4.0)), true);
    check(&cone, Ray::new(Vec3::new(-6.0, 0.0, -8.0), Vec3::new(3.0, 0.0, 4.0)), true);
    check(&cone, Ray::new(Vec3::new(0.0, 0.0, 1e-9), Vec3::new(3.0, 0.0, 4.0)), false);
    // x^2 + y^2 - z^2 = 1 contains the line x = 1, y = z
    let form = Mat3::from_diagonal(Vec3::new(1.0, 1.0, -1.0));
    let hyperboloid = Surface::quadric_about(Vec3::ZERO, form, Vec3::ZERO, -1.0);
    check(&hyperboloid, Ray::new(Vec3::X, Vec3::new(0.0, 1.0, 1.0)), true);
    check(&hyperboloid, Ray::new(Vec3::X, Vec3::new(0.0, 1.0, 1.0 + 1e-8)), false);
}

/// On the axis of a cylinder thinner than the tolerance the gradient is 0: the second-order term of the tolerance decides, as
/// it does for pieces of the ray.
#[test]
fn the_axis_of_a_hair_lies_in_it() {
    let (ray, ends) = (Ray::new(Vec3::new(40.0, 30.0, 0.0), Vec3::Z), (-3.0, 5.0));
    let thickness = delta(0.0, &ray, 1.0);
    for (radius, lies) in [(0.5 * thickness, true), (4.0 * thickness, false)] {
        let hair = Surface::cylinder(ray.origin, Vec3::Z, radius);
        assert_eq!(lies_in(&hair, 0.0, &ray, ends), lies, "{radius}");
        assert_eq!(coincides_along(&hair, 0.0, &ray, ends.0, ends.1), lies, "{radius}");
    }
}

#[test]
fn no_ray_lies_in_a_curved_surface() {
    let sphere = Surface::sphere(Vec3::ZERO, 2.0);
    let torus = Surface::torus(Vec3::ZERO, Vec3::Z, 3.0, 1.0);
    // tangent, but apart from the surface at the ends of the chord
    check(&sphere, Ray::new(2.0 * Vec3::X, Vec3::Y), false);
    check(&torus, Ray::new(Vec3::new(3.0, 0.0, 1.0), Vec3::Y), false);
    let ellipsoid =
        Surface::quadric_about(Vec3::ZERO, Mat3::from_diagonal(Vec3::new(1.0, 0.1, 0.01)), Vec3::ZERO, -1.0);
    assert!(!ellipsoid.is_ruled() && !sphere.is_ruled() && !torus.is_ruled());
}

#[test]
fn the_side_of_a_ray_in_a_face_is_that_of_the_fixed_direction() {
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    let side = |normal: Vec3| {
        let crossings = crossings_in(&Surface::plane(normal, 0.0), 1.0, &ray, (-1.0, 1.0)).unwrap();
        assert!(crossings.times().is_empty());
        crossings.starts_negative()
    };
    assert!(!side(Vec3::Z));
    assert!(side(-Vec3::Z));
    assert!(!side(Vec3::new(0.0, 1.0, -1.0)));
    assert!(side(Vec3::new(0.0, -1.0, 1.0)));
}

/// Along a ruling the side is that of a ray moved by a small length: it changes at the apex of a cone, and once on a
/// hyperboloid and on a hyperbolic paraboloid, wherever the chord is.
#[test]
fn the_side_along_a_ruling_is_that_of_the_moved_ray() {
    let form = |x: f64, y: f64, z: f64| Mat3::from_diagonal(Vec3::new(x, y, z));
    let cone = Surface::cone(Vec3::ZERO, Vec3::Z, 0.75);
    let hyperboloid = Surface::quadric_about(Vec3::ZERO, form(1.0, 1.0, -1.0), Vec3::ZERO, -1.0);
    // x y = z
    let saddle = Surface::quadric(&[
        [0.0, 0.5, 0.0, 0.0],
        [0.5, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, -0.5],
        [0.0, 0.0, -0.5, 0.0],
    ])
    .unwrap();
    let rulings = [
        (&cone, Ray::new(Vec3::new(3.0, 0.0, 4.0), Vec3::new(-3.0, 0.0, -4.0))),
        (&cone, Ray::new(Vec3::new(0.0, 6.0, 8.0), Vec3::new(0.0, 3.0, 4.0))),
        (&hyperboloid, Ray::new(Vec3::X, Vec3::new(0.0, 1.0, 1.0))),
        (&hyperboloid, Ray::new(Vec3::new(0.0, 1.0, 0.0), Vec3::new(-1.0, 0.0, 1.0))),
        (&saddle, Ray::new(Vec3::new(0.5, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.5))),
    ];
    for (surface, ray) in rulings {
        for degrees in [0.0, 17.0, 133.7] {
            let (surface, ray) = turned(surface, &ray, degrees);
            let magnitude = surface.magnitude() + 40.0;
            let moved = Ray::new(ray.origin + 1e-6 * PERTURBATION_DIRECTION, ray.direction);
            for ends in [(-3.0, 5.0), (2.0, 9.0), (-40.0, -30.0)] {
                let crossings = crossings_in(&surface, magnitude, &ray, ends).unwrap();
                assert_eq!(crossings.times().len(), 1, "{surface:?} {ray:?}");
                let turn = crossings.times()[0];
                for t in (-80..80).map(|k| 0.5 * f64::from(k) + 0.1234) {
                    let inside = surface.value_and_gradient(moved.at(t)).0 < 0.0;
                    let expected = crossings.starts_negative() ^ (t > turn);
                    assert!(inside == expected || (t - turn).abs() < 1e-4, "{surface:?} {ray:?} {t} {turn}");
                }
            }
        }
    }
}

/// Two tangent spheres: the ray through the point of contact crosses both there. Between the far crossings it coincides
/// with neither, although its middle lies on both.
#[test]
fn tangent_spheres_are_not_coincident_through_their_contact() {
    let left = Surface::sphere(-Vec3::X, 1.0);
    let right = Surface::sphere(Vec3::X, 1.0);
    let ray = Ray::new(-5.0 * Vec3::X, Vec3::X);
    let (a, b) = (left.crossings(&ray), right.crossings(&ray));
    assert_eq!((a.times(), b.times()), (&[3.0, 5.0][..], &[5.0, 7.0][..]));
    assert!(coincides_along(&left, left.magnitude(), &ray, 5.0, 5.0));
    for surface in [&left, &right] {
        assert!(!coincides_along(surface, surface.magnitude(), &ray, 3.0, 7.0), "ends far, middle near");
        let (value, _) = surface.value_and_gradient(ray.at(5.0));
        assert_eq!(value, 0.0);
    }
    // grazing: the chord of a ray slightly inside the tangent coincides if it is shallower than delta
    let shallow = |depth: f64| {
        let ray = Ray::new(Vec3::new(-5.0, 1.0 - depth, 0.0), Vec3::X);
        let ball = Surface::sphere(Vec3::ZERO, 1.0);
        let times = ball.crossings(&ray);
        let &[a, b] = times.times() else {
            panic!("{depth}: {times:?}");
        };
        assert!(delta(1.0, &ray, a) < 1e-13);
        coincides_along(&ball, 1.0, &ray, a, b)
    };
    assert!(shallow(1e-14) && !shallow(1e-12));
}

#[test]
fn a_quartic_is_sampled_at_its_quarter_points() {
    // four tangent points cannot all be at the ends and in the middle: from tube to tube across the hole
    let torus = Surface::torus(Vec3::ZERO, Vec3::Z, 2.0, 1.0);
    let ray = Ray::new(Vec3::new(-4.0, 0.0, 0.0), Vec3::X);
    assert!(!coincides_along(&torus, 3.0, &ray, 1.0, 7.0));
    assert!(coincides_along(&torus, 3.0, &ray, 1.0, 1.0 + 1e-15));
}

/// Along a cylinder over a conic the side is constant, also for a ray that drifts within the tolerance.
#[test]
fn sides_along_elliptic_cylinders_are_constant() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut number = |lo: f64, hi: f64| rng.random_range(lo..hi);
    let conic = Mat3::from_diagonal(Vec3::new(1.0, 0.25, 0.0));
    let ellipse = Surface::quadric_about(Vec3::ZERO, conic, Vec3::ZERO, -1.0);
    let mut found = 0;
    for _ in 0..5000 {
        let axis = Vec3::new(number(-1.0, 1.0), number(-1.0, 1.0), number(0.1, 1.0));
        let map = Affine::rotation(axis, number(0.0, 360.0));
        let surface = ellipse.transformed(&Transform::new(map, 0.0).unwrap());
        let (sin, cos) = number(0.0, std::f64::consts::TAU).sin_cos();
        let start = map.point(Vec3::new(cos, 2.0 * sin, 0.0));
        let drift = UNIT_ROUNDOFF * Vec3::new(number(-60.0, 60.0), number(-60.0, 60.0), 0.0);
        let ray = Ray::new(start, map.vector(Vec3::Z + drift));
        let length = number(1.0, 1000.0);
        if let Some(crossings) = crossings_in(&surface, surface.magnitude(), &ray, (-length, length)) {
            assert_eq!(crossings.times(), [], "{ray:?}");
            found += 1;
        }
    }
    assert!(found > 1000, "{found}");
}
