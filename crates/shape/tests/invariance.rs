//! Invariance: changes of a ray and its surface that do not change the answer.

mod oracle;

use oracle::*;
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use rayweave_math::{Affine, Mat3, Transform, Vec3};
use rayweave_shape::Ray;
use rayweave_shape::surface::Surface;

fn surfaces(rng: &mut ChaCha8Rng) -> Vec<Surface> {
    let place = unit_vector(rng);
    let axis = unit_vector(rng);
    let form = Mat3::from_diagonal(Vec3::new(1.0, 0.25, -0.5));
    let scaling = Affine::scale(Vec3::new(1.0, 0.5, 0.25)).then(&Affine::rotation(axis, 40.0));
    let scaling = Transform::from_affine(scaling.then(&Affine::translate(place))).unwrap();
    let torus = Surface::torus(place, axis, 1.0, 0.3);
    vec![
        Surface::plane(axis, 0.3),
        Surface::sphere(place, 1.0),
        Surface::cylinder(place, axis, 1.0),
        Surface::cone(place, axis, 0.7),
        Surface::quadric_about(place, form, 0.1 * axis, -0.3),
        Surface::sphere(place, 1.0).transformed(&scaling),
        Surface::torus(place, axis, 0.4, 0.5),
        torus.transformed(&scaling),
        torus,
    ]
}

/// The surface with all its lengths multiplied by a factor.
fn scaled(surface: &Surface, by: f64) -> Surface {
    let mut scaled = surface.clone();
    match &mut scaled {
        Surface::Plane(s) => s.offset *= by,
        Surface::Sphere(s) => (s.centre, s.radius) = (by * s.centre, by * s.radius),
        Surface::Cylinder(s) => (s.point, s.radius) = (by * s.point, by * s.radius),
        Surface::Cone(s) => s.apex *= by,
        Surface::Quadric(s) => {
            (s.centre, s.linear, s.constant) = (by * s.centre, by * s.linear, by * by * s.constant);
        }
        Surface::Torus(s) => {
            (s.centre, s.major, s.minor) = (by * s.centre, by * s.major, by * s.minor);
        }
        Surface::AffineTorus(s) => {
            (s.centre, s.torus.major, s.torus.minor) =
                (by * s.centre, by * s.torus.major, by * s.torus.minor);
        }
        Surface::Object(_) => unreachable!("none is drawn"),
    }
    scaled
}

fn random_rays(count: usize, seed: u64, mut check: impl FnMut(&Surface, Ray, &mut ChaCha8Rng)) {
    let mut rng = rng(seed);
    for _ in 0..count * effort() {
        for surface in surfaces(&mut rng) {
            let target = surface.anchor() + rng.random_range(0.0..1.2) * unit_vector(&mut rng);
            let ray = ray_through(target, 1.0, &mut rng);
            check(&surface, ray, &mut rng);
        }
    }
}

#[test]
fn powers_of_two_scale_to_the_bit() {
    random_rays(300, 21, |surface, ray, _| {
        let want = surface.crossings(&ray);
        for by in [-60, -3, 1, 50] {
            let by = libm::ldexp(1.0, by);
            let surface = scaled(surface, by);
            let all = Ray::new(by * ray.origin, by * ray.direction);
            assert_eq!(surface.crossings(&all), want, "{surface:?} times {by}");
            let slower = Ray::new(by * ray.origin, ray.direction);
            let times: Vec<f64> = want.times().iter().map(|t| t * by).collect();
            assert_eq!(surface.crossings(&slower).times(), times, "{surface:?} times {by}");
        }
    });
}

/// Asserts that both rays have the same crossings in order; `map` converts times of the second ray to those of the first.
fn same_places(surface: &Surface, a: &Ray, b: &Ray, map: impl Fn(f64) -> f64) {
    let (left, right) = (surface.crossings(a), surface.crossings(b));
    let mut mapped: Vec<f64> = right.times().iter().map(|&t| map(t)).collect();
    mapped.sort_by(f64::total_cmp);
    let label = format!("{surface:?}\n{a:?}\n{b:?}\n{left:?}\n{right:?}");
    if left.times().len() != mapped.len() {
        let grazing = left.times().windows(2).chain(mapped.windows(2));
        let gaps: Vec<f64> = grazing.map(|w| w[1] - w[0]).collect();
        assert!(gaps.iter().any(|&gap| gap < 1e-6), "{label}");
        return;
    }
    for (&t, &s) in left.times().iter().zip(&mapped) {
        // an error e across the surface shifts a root by e divided by the cosine of the angle of incidence
        let gradient = surface.value_and_gradient(a.at(t)).1;
        let speed = (gradient.dot(a.direction) / gradient.length()).abs();
        let bound = 64.0 * (rounding(surface, a, t) + rounding(surface, b, t));
        assert!(
            (t - s).abs() * speed <= 2.0 * bound || (t - s).abs() * a.direction.length() < 1e-7,
            "{label}"
        );
    }
}

#[test]
fn moving_the_origin_along_the_ray_moves_the_times() {
    random_rays(300, 22, |surface, ray, rng| {
        let by = rng.random_range(-2.0..2.0) / ray.direction.length();
        let moved = Ray::new(ray.at(by), ray.direction);
        same_places(surface, &ray, &moved, |t| t + by);
    });
}

#[test]
fn a_reversed_ray_is_mirrored() {
    random_rays(300, 23, |surface, ray, _| {
        let reversed = Ray::new(ray.origin, -ray.direction);
        let (there, back) = (surface.crossings(&ray), surface.crossings(&reversed));
        same_places(surface, &ray, &reversed, |t| -t);
        let far = there.starts_negative() ^ (there.times().len() % 2 == 1);
        assert_eq!(far, back.starts_negative());
    });
}

#[test]
fn a_moved_scene_gives_the_same_places() {
    random_rays(200, 24, |surface, ray, rng| {
        let motion = Affine::rotation(unit_vector(rng), rng.random_range(0.0..360.0))
            .then(&Affine::translate(3.0 * unit_vector(rng)));
        let to = Transform::from_affine(motion).unwrap();
        let (there, moved) = (surface.transformed(&to), ray.transformed(&motion));
        assert_eq!(std::mem::discriminant(&there), std::mem::discriminant(surface));
        let (a, b) = (surface.crossings(&ray), there.crossings(&moved));
        if a.times().len() == b.times().len() {
            for (&t, &s) in a.times().iter().zip(b.times()) {
                let gradient = surface.value_and_gradient(ray.at(t)).1;
                let speed = (gradient.dot(ray.direction) / gradient.length()).abs();
                let bound = 64.0 * rounding(&there, &moved, s) + 64.0 * rounding(surface, &ray, t);
                assert!(
                    (t - s).abs() * speed <= 2.0 * bound || (t - s).abs() * ray.direction.length() < 1e-7,
                    "{t} {s} {surface:?}\n{there:?}\n{ray:?}"
                );
            }
        } else {
            let gap = a.times().windows(2).chain(b.times().windows(2)).any(|w| w[1] - w[0] < 1e-6);
            assert!(
                gap || a.times().len().max(b.times().len()) == 1,
                "{surface:?}\n{there:?}\n{ray:?}\n{a:?}\n{b:?}"
            );
        }
    });
}
