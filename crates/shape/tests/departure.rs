//! Rays that start on a surface, with one root at the start divided out.

mod oracle;

use oracle::*;
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use rayweave_math::{Affine, Mat3, Transform, Vec3};
use rayweave_shape::Ray;
use rayweave_shape::surface::Surface;

fn surfaces(scale: f64, rng: &mut ChaCha8Rng) -> Vec<Surface> {
    let place = scale * unit_vector(rng);
    let axis = unit_vector(rng);
    let form = Mat3::from_diagonal(Vec3::new(1.0, 0.5, -0.5));
    let scaling = Affine::scale(Vec3::new(1.0, 0.5, 0.25)).then(&Affine::rotation(axis, 40.0));
    let scaling = Transform::from_affine(scaling).unwrap();
    let torus = Surface::torus(place, axis, scale, 0.3 * scale);
    vec![
        Surface::sphere(place, scale),
        Surface::cylinder(place, axis, scale),
        Surface::cone(place, axis, 0.7),
        Surface::quadric_about(place, form, scale * axis, -0.3 * scale * scale),
        Surface::sphere(place, scale).transformed(&scaling),
        torus.transformed(&scaling),
        torus,
        Surface::torus(place, axis, scale, 1e-4 * scale),
        Surface::torus(place, axis, 0.4 * scale, 0.5 * scale),
    ]
}

/// A point on the surface with its outward unit normal.
fn start(surface: &Surface, scale: f64, rng: &mut ChaCha8Rng) -> Option<(Vec3, Vec3)> {
    let towards = match surface {
        Surface::Torus(s) => s.centre + s.major * s.axis.cross(unit_vector(rng)).normalize(),
        _ => surface.anchor() + 0.3 * scale * unit_vector(rng),
    };
    let ray = Ray::new(towards, unit_vector(rng));
    let &t = surface.crossings(&ray).times().first()?;
    let point = ray.at(t);
    let (value, gradient) = surface.value_and_gradient(point);
    let point = point - value / gradient.length_squared() * gradient;
    (t.abs() < 10.0 * scale).then(|| (point, gradient.normalize()))
}

fn departures(seed: u64, mut check: impl FnMut(&Surface, Ray, Vec3, &mut ChaCha8Rng)) {
    let mut rng = rng(seed);
    for _ in 0..300 * effort() {
        let scale = size(&mut rng, 1e-8, 1e8);
        for surface in surfaces(scale, &mut rng) {
            if let Some((point, normal)) = start(&surface, scale, &mut rng) {
                // the normal of a tube of 1e-4 is only accurate to 1e4 u
                let grazing = size(&mut rng, 1e-10, 1.0);
                let along = normal.cross(unit_vector(&mut rng)).normalize();
                let side = if rng.random() { 1.0 } else { -1.0 };
                let way = along + side * grazing * normal;
                check(&surface, Ray::new(point, scale * way), normal, &mut rng);
            }
        }
    }
}

/// The exact polynomial along the ray without its constant term, divided by t.
fn divided(surface: &Surface, ray: &Ray) -> Vec<dashu::rational::RBig> {
    let degree = usize::from(surface.degree());
    coefficients(surface, 0.0, ray, degree).split_off(1)
}

#[test]
fn sides_follow_the_direction_and_remaining_roots_are_those_of_the_quotient() {
    let mut found = [0; 4];
    departures(31, |surface, ray, normal, _| {
        let leads_inside = normal.dot(ray.direction) < 0.0;
        let got = surface.crossings_from(&ray, leads_inside);
        let label = format!("{surface:?}\n{ray:?}\n{got:?}");
        assert_eq!(got.starts_negative(), leads_inside);
        assert!(got.times().iter().all(|&t| t > 0.0), "{label}");
        found[got.times().len()] += 1;
        // sign changes of the exact quotient at t > 0, by Sturm's theorem on both sides of 0
        let quotient = divided(surface, &ray);
        let spindle = matches!(surface, Surface::Torus(s) if s.major < s.minor);
        if normal.dot(ray.direction).abs() > 1e-3 * ray.direction.length() && !spindle {
            assert_eq!(got.times().len(), count_positive_roots(&quotient), "{label}");
        }
        for &t in got.times() {
            assert!(distance(surface, &ray, t) <= 16.0 * rounding(surface, &ray, t), "{label}");
        }
    });
    assert!(found[0] > 300 && found[1] > 300 && found[2] > 50, "{found:?}");
}

/// Number of roots > 0 of p: half of the nonzero roots of p(s^2).
fn count_positive_roots(p: &[dashu::rational::RBig]) -> usize {
    let mut doubled = Vec::new();
    for c in p {
        doubled.extend([c.clone(), exact(0.0)]);
    }
    count_real_roots(&doubled) / 2
}

#[test]
fn where_list_and_direction_disagree_the_surface_is_crossed_at_once() {
    departures(32, |surface, ray, normal, _| {
        let leads_inside = normal.dot(ray.direction) < 0.0;
        let agreed = surface.crossings_from(&ray, leads_inside);
        let crossed = surface.crossings_from(&ray, !leads_inside);
        assert_eq!(crossed.starts_negative(), !leads_inside);
        assert_eq!(crossed.times()[0], 0.0);
        assert_eq!(&crossed.times()[1..], agreed.times());
    });
}

/// A thousand bounces in a bowl, each from the end of the previous one, without a leak and without a hit of the start.
#[test]
fn grazing_bounces_inside_do_not_leak() {
    let mut rng = rng(33);
    for scale in [1e-8, 1.0, 1e8] {
        for surface in surfaces(scale, &mut rng) {
            let bounded = !matches!(surface, Surface::Cylinder(_) | Surface::Cone(_)) && !surface.is_ruled();
            if bounded {
                bounce(&surface, scale, &mut rng);
            }
        }
    }
}

fn bounce(surface: &Surface, scale: f64, rng: &mut ChaCha8Rng) {
    let (mut point, normal) = loop {
        if let Some(start) = start(surface, scale, rng) {
            break start;
        }
    };
    let grazing = size(rng, 1e-6, 1.0);
    let mut way = normal.cross(unit_vector(rng)).normalize() - grazing * normal;
    for _ in 0..1000 {
        let ray = Ray::new(point, way.normalize());
        let got = surface.crossings_from(&ray, true);
        let first = if got.times()[0] == 0.0 { 1 } else { 0 };
        assert_eq!(first, 0, "{surface:?}\n{ray:?}\n{got:?}");
        let t = got.times()[0];
        assert_eq!(got.times().len() % 2, 1, "a bounded solid is left: {surface:?}\n{ray:?}");
        let hit = ray.at(t);
        let (value, gradient) = surface.value_and_gradient(hit);
        point = hit - value / gradient.length_squared() * gradient;
        let n = surface.value_and_gradient(point).1.normalize();
        let inwards = ray.direction.dot(n);
        way = ray.direction - 2.0 * inwards.abs() * n;
        if way.dot(n) >= 0.0 {
            return; // grazing within rounding: the direction of the reflection is undefined
        }
    }
}

#[test]
fn tangent_starts_and_rays_in_the_surface() {
    let sphere = Surface::sphere(Vec3::ZERO, 1.0);
    let tangent = Ray::new(Vec3::X, Vec3::Y);
    // no part of a tangent is inside, so a ray that is listed as inside leaves at once
    assert_eq!(sphere.crossings_from(&tangent, true).times(), [0.0]);
    assert!(sphere.crossings_from(&tangent, false).times().is_empty());
    let diameter = Ray::new(Vec3::X, -2.0 * Vec3::X);
    assert_eq!(sphere.crossings_from(&diameter, true).times(), [1.0]);
    assert_eq!(sphere.crossings_from(&diameter, false).times(), [0.0, 1.0]);

    let plane = Surface::plane(Vec3::Z, 2.0);
    let up = Ray::new(2.0 * Vec3::Z, Vec3::new(1.0, 0.0, 1.0));
    assert!(plane.crossings_from(&up, false).times().is_empty());
    assert_eq!(plane.crossings_from(&up, true).times(), [0.0]);
    // in the plane: the perturbation direction leads upwards, out of it
    let within = Ray::new(2.0 * Vec3::Z, Vec3::X);
    assert!(plane.crossings_from(&within, false).times().is_empty());
    assert_eq!(plane.crossings_from(&within, true).times(), [0.0]);

    let cylinder = Surface::cylinder(Vec3::ZERO, Vec3::Z, 1.0);
    let generator = Ray::new(-Vec3::X, Vec3::Z);
    assert!(cylinder.crossings_from(&generator, true).times().is_empty(), "w leads inwards at -x");
    assert_eq!(cylinder.crossings_from(&generator, false).times(), [0.0]);

    let torus = Surface::torus(Vec3::ZERO, Vec3::Z, 2.0, 0.5);
    let outside = Ray::new(2.5 * Vec3::X, -Vec3::X);
    let times = torus.crossings_from(&outside, true);
    let error = times.times().iter().zip([1.0, 4.0, 5.0]).map(|(t, want)| (t - want).abs());
    assert!(times.times().len() == 3 && error.fold(0.0, f64::max) < 2e-15, "{times:?}");
    assert_eq!(torus.crossings_from(&outside, false).times()[0], 0.0);
    // across the top, where the tube curves away on both sides
    let top = Ray::new(Vec3::new(2.0, 0.0, 0.5), Vec3::X);
    assert!(torus.crossings_from(&top, false).times().is_empty());
    assert_eq!(torus.crossings_from(&top, true).times(), [0.0]);
    // along the inner equator, with the solid on both sides
    let inner = Ray::new(1.5 * Vec3::X, Vec3::Y);
    let times = torus.crossings_from(&inner, true);
    assert!(times.times().len() == 1 && (times.times()[0] - 2.0).abs() < 1e-15, "{times:?}");
    assert_eq!(torus.crossings_from(&inner, false).times()[0], 0.0);
}
