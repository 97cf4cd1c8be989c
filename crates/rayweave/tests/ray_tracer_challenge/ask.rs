//! Queries of solids by every evaluator.

use rayweave::model::{Collected, attributes};
use rayweave::{AnyEvaluator, Crossing, Evaluator, Program, Query, Ray, Region, Solid, Vec3};
use std::sync::Arc;

/// The book's own tolerance, for numbers that it gives with five digits.
pub const EPSILON: f64 = 1e-5;

pub fn ray(origin: [f64; 3], direction: [f64; 3]) -> Ray {
    Ray::new(origin.into(), direction.into())
}

/// A ray with its direction normalised.
pub fn unit_ray(origin: [f64; 3], direction: [f64; 3]) -> Ray {
    Ray::new(origin.into(), Vec3::from(direction).normalize())
}

/// A centred solid along z, rotated to lie along y with its middle at a height.
pub fn upright(solid: &Solid, middle: f64) -> Solid {
    solid.rotate_x(-90.0).translate([0.0, middle, 0.0])
}

/// The crossings of a ray, which have to be equal for all evaluators.
pub fn answer(program: &Arc<Program>, ray: Ray) -> Collected {
    let answers = AnyEvaluator::NAMES.map(|name| {
        let evaluator = AnyEvaluator::new(Some(name), program.clone()).unwrap();
        evaluator.one(ray, &Query::default()).unwrap()
    });
    assert!(answers.iter().all(|answer| *answer == answers[0]), "{ray:?}");
    answers.into_iter().next().unwrap()
}

pub fn compiled(solid: &Solid) -> Arc<Program> {
    Arc::new(Program::compile(solid).unwrap())
}

/// The times at which a ray crosses the boundary of a solid, with the names of the faces.
pub fn hits(solid: &Solid, ray: Ray) -> Vec<(f64, String)> {
    let program = compiled(solid);
    answer(&program, ray).crossings.iter().map(|crossing| (crossing.t, face(&program, crossing))).collect()
}

pub fn times(solid: &Solid, ray: Ray) -> Vec<f64> {
    hits(solid, ray).into_iter().map(|hit| hit.0).collect()
}

/// The name of the face at a crossing.
pub fn face(program: &Program, crossing: &Crossing) -> String {
    let number = program.face_number(crossing.face.leaf, crossing.face.facet);
    program.face_name(number)
}

/// The first crossing that is not behind the origin.
pub fn nearest(solid: &Solid, ray: Ray) -> Option<f64> {
    let program = compiled(solid);
    let found = AnyEvaluator::NAMES.map(|name| {
        let evaluator = AnyEvaluator::new(Some(name), program.clone()).unwrap();
        evaluator.one(ray, &Query::nearest()).unwrap().crossings.first().map(|crossing| crossing.t)
    });
    assert!(found.iter().all(|t| *t == found[0]));
    found[0]
}

/// The outward unit normal at a point of the boundary, from a ray that enters there obliquely.
pub fn normal(solid: &Solid, point: [f64; 3], expected: [f64; 3]) -> Vec3 {
    let program = compiled(solid);
    let point = Vec3::from(point);
    let along = -Vec3::from(expected).normalize() + Vec3::new(0.21, -0.13, 0.17);
    let ray = Ray::new(point - along, along);
    let found = answer(&program, ray);
    let there =
        found.crossings.iter().min_by(|a, b| (a.t - 1.0).abs().total_cmp(&(b.t - 1.0).abs())).unwrap();
    assert!((there.t - 1.0).abs() < 1e-3 && there.enters(), "{point} {found:?}");
    attributes::normal(&program, &ray, there)
}

pub fn assert_near(found: Vec3, expected: [f64; 3], tolerance: f64) {
    assert!((found - Vec3::from(expected)).abs().max_element() <= tolerance, "{found} for {expected:?}");
}

pub fn assert_times(found: &[f64], expected: &[f64], tolerance: f64) {
    let is_near = |(a, b): (&f64, &f64)| (a - b).abs() <= tolerance;
    assert!(
        found.len() == expected.len() && found.iter().zip(expected).all(is_near),
        "{found:?} for {expected:?}"
    );
}

/// Asserts that a ray crosses nothing.
pub fn assert_misses(solid: &Solid, ray: Ray) {
    let found = hits(solid, ray);
    assert!(found.is_empty(), "{ray:?}: {found:?}");
}

pub fn region(name: &str, medium: u32, solid: Solid) -> Region {
    Region { name: name.to_owned(), solid, medium }
}
