//! Rays that are so far from a model that it would vanish within the tolerance: rejected with their number, for every
//! evaluator and query, and only those.

use rayweave_math::Vec3;
use rayweave_model::{BadRay, Collected, Evaluator, Program, Query, RayBatch, Solid, Window};
use rayweave_shape::primitive::{Value, build};
use rayweave_shape::{Ray, RayError};
use rayweave_trace::single_hit::{ExplainError, explain};
use rayweave_trace::{AnyEvaluator, Packets};
use std::sync::Arc;

fn shape(name: &str, arguments: &[(&str, Value)]) -> Solid {
    Solid::from(build(name, arguments).unwrap())
}

fn ball() -> Solid {
    shape("sphere", &[("radius", 1.0.into())])
}

fn cube() -> Solid {
    shape("box", &[("size", 1.0.into())])
}

fn below(normal: Vec3, offset: f64) -> Solid {
    shape("half_space", &[("normal", normal.into()), ("offset", offset.into())])
}

fn program(solid: &Solid) -> Arc<Program> {
    Arc::new(Program::compile(solid).unwrap())
}

/// The answer of all evaluators, which is the same.
fn trace(program: &Arc<Program>, ray: Ray, query: &Query<'_>) -> Result<Collected, RayError> {
    let mut answers = AnyEvaluator::NAMES
        .iter()
        .map(|name| AnyEvaluator::new(Some(name), program.clone()).unwrap().one(ray, query));
    let first = answers.next().unwrap();
    assert!(answers.all(|answer| answer == first), "{ray:?}");
    first
}

fn count(solid: &Solid, ray: Ray) -> Result<usize, RayError> {
    trace(&program(solid), ray, &Query::default()).map(|answer| answer.crossings.len())
}

fn is_too_far(solid: &Solid, ray: Ray) -> bool {
    let checked = program(solid).check_ray(&ray);
    assert_eq!(checked.err(), count(solid, ray).err());
    matches!(checked, Err(RayError::TooFar { .. }))
}

fn along_x(from: f64) -> Ray {
    Ray::new(Vec3::new(-from, 0.0, 0.0), Vec3::X)
}

/// The tolerance of a ray that starts at a distance d is 128 u d. It reaches a quarter of the diameter, 1/2, at d =
/// 2^45.
#[test]
fn the_limit_is_a_quarter_of_the_size() {
    let limit = libm::ldexp(1.0, 45);
    let after = limit * (1.0 + f64::EPSILON);
    assert_eq!(count(&ball(), along_x(limit)), Ok(2));
    let size = 2.0;
    let expected = RayError::TooFar { distance: after, accuracy: 0.5 * (1.0 + f64::EPSILON), size };
    assert_eq!(count(&ball(), along_x(after)), Err(expected));
    // the length of the direction and the unit of length do not matter
    for scale in [1e-90, 1e-8, 1e8, 1e90] {
        let ray = |from: f64| Ray::new(along_x(from).origin, scale * Vec3::X);
        assert_eq!(count(&ball(), ray(limit)), Ok(2));
        assert!(is_too_far(&ball(), ray(1.01 * limit)), "{scale}");
    }
    for scale in [1e-20, 1e20] {
        let ball = shape("sphere", &[("radius", scale.into())]);
        assert_eq!(count(&ball, along_x(0.99 * limit * scale)), Ok(2));
        assert!(is_too_far(&ball, along_x(1.01 * limit * scale)));
    }
}

/// From any distance, a ray through the middle of a bounded solid crosses it or is rejected.
#[test]
fn no_solid_vanishes_without_an_error() {
    let plate = shape("box", &[("size", Vec3::new(1.0, 1.0, 1e-9).into())]);
    let ring = shape("torus", &[("major", 1.0.into()), ("minor", 0.3.into())]);
    let lens = ball().translate([0.0, 0.0, 0.9]) & ball().translate([0.0, 0.0, -0.9]);
    let part = (cube() - ball().translate([1.0, 0.0, 0.0])) | cube().translate([3.0, 0.0, 0.0]);
    for (number, solid) in [ball(), cube(), plate, ring, lens, part].iter().enumerate() {
        for axis in [Vec3::X, Vec3::Z, Vec3::new(0.6, 0.0, 0.8)] {
            // through the tube of the torus
            let middle = if number == 3 { Vec3::X } else { Vec3::ZERO };
            let mut rejected = 0;
            for step in 0..=90 {
                let distance = libm::pow(10.0, f64::from(step) * 0.2);
                let ray = Ray::new(middle - distance * axis, axis);
                match count(solid, ray) {
                    Ok(crossings) => assert!(crossings > 0 && rejected == 0, "{number} {axis} {distance:e}"),
                    Err(RayError::TooFar { .. }) => rejected += 1,
                    Err(other) => panic!("{other}"),
                }
            }
            assert!((20..75).contains(&rejected), "{number} {axis}: {rejected} rejected");
        }
    }
}

#[test]
fn clear_misses_are_answered() {
    for far in [1e14, 1e20, 1e60] {
        for direction in [Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::new(1e-3, 0.0, 1.0)] {
            assert_eq!(
                count(&cube(), Ray::new(Vec3::new(far, 0.0, 0.0), direction)),
                Ok(0),
                "{far:e} {direction}"
            );
        }
        // the whole line counts, before the origin as well
        assert!(is_too_far(&cube(), Ray::new(Vec3::new(far, 0.0, 0.0), Vec3::X)));
    }
}

/// Half-spaces do not vanish; a slab and an unbounded cylinder do.
#[test]
fn unbounded_solids() {
    let slab = below(Vec3::X, 0.5) & below(-Vec3::X, 0.5);
    let rod = shape("cylinder", &[("radius", 1.0.into())]);
    for from in [0.0, 1e6, 1e13, 1e20, 1e60] {
        assert_eq!(count(&below(Vec3::new(3.0, 0.0, 4.0), 5.0), along_x(from)), Ok(1), "{from:e}");
        assert_eq!(count(&below(Vec3::X, 0.0), along_x(from)), Ok(1), "{from:e}");
        for solid in [&slab, &rod] {
            match from < 1e14 {
                true => assert_eq!(count(solid, along_x(from)), Ok(2), "{from:e}"),
                false => assert!(is_too_far(solid, along_x(from)), "{from:e}"),
            }
        }
    }
}

/// Parts that touch up to rounding leave boxes without thickness, which must not cause any ray to be rejected.
#[test]
fn slivers_reject_no_ray() {
    let left = shape("box", &[("size", (0.1 + 0.2).into())]).translate([0.0; 3]);
    let corner = cube() & cube().translate([1.0, 1.0, 1.0]);
    let face = cube() & cube().translate([1.0, 0.0, 0.0]);
    let edge = left & shape("box", &[("size", 0.3.into())]).translate([0.3, 0.3, 0.0]);
    let walls = below(Vec3::X, 0.1 + 0.2) & below(-Vec3::X, -0.3);
    let zero = below(Vec3::X, 0.0) & below(-Vec3::X, 0.0);
    for (number, solid) in [corner, face, edge, walls, zero, Solid::empty()].iter().enumerate() {
        for from in [5.0, 1e4, 1e7] {
            assert_eq!(count(solid, along_x(from)), Ok(0), "{number} {from:e}");
        }
    }
}

/// A model far from the origin of the coordinates loses all digits, wherever the ray starts.
#[test]
fn a_model_may_be_too_far_from_the_origin() {
    let solid = ball().translate([1e15, 0.0, 0.0]);
    assert!(is_too_far(&solid, along_x(0.0)));
    assert!(is_too_far(&solid, along_x(-1e15 + 10.0)));
    assert_eq!(count(&ball().translate([1e12, 0.0, 0.0]), along_x(0.0)), Ok(2));
}

#[test]
fn every_query_names_the_ray() {
    let program = program(&ball());
    let rays =
        RayBatch::from_iter([along_x(5.0), Ray::new(Vec3::new(0.0, 3e14, 0.0), Vec3::X), along_x(3e14)]);
    let evaluator = Packets::new(program.clone());
    let after = Query { window: Window::new(1.0, 2.0).unwrap(), ..Query::default() };
    for query in [Query::default(), Query::nearest(), after] {
        let bad = evaluator.collect(rays.rays(), &query).unwrap_err();
        assert_eq!(bad.ray, 2);
        assert_eq!(
            bad.to_string(),
            "ray 2: the ray is too far from the model: at its closest point, 3e14 from its origin, coordinates are \
             accurate to 4.263, and the model is 2 thick. Start the ray closer to the model, and keep the model \
             close to the origin of the coordinates."
        );
        assert!(trace(&program, along_x(3e14), &query).is_err());
    }
    let explained = explain(&program, along_x(3e14), Window::ALL);
    assert!(matches!(explained, Err(ExplainError::Ray(RayError::TooFar { .. }))), "{explained:?}");
    let huge = Ray::new(Vec3::new(1e101, 0.0, 0.0), Vec3::X);
    let bad = program.check_rays(RayBatch::from_iter([along_x(0.0), huge]).rays()).unwrap_err();
    assert_eq!(bad, BadRay { ray: 1, problem: huge.check().unwrap_err() });
}
