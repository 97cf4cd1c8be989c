//! Test cases with closed-form solutions.

use crate::models::{block, half_space, shape};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Evaluator, Program, Query, RegionId, Solid, attributes};
use rayweave_shape::Ray;
use std::sync::Arc;

/// A solid, a ray, the times of its crossings and the outward normals there.
type Known = (Solid, Ray, &'static [f64], &'static [[f64; 3]]);

fn ray(origin: [f64; 3], direction: [f64; 3]) -> Ray {
    Ray::new(Vec3::from_array(origin), Vec3::from_array(direction))
}

fn known() -> Vec<Known> {
    let ball = shape("sphere", &[("radius", 5.0)]);
    let x = ray([-10.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let ring = shape("torus", &[("major", 4.0), ("minor", 1.0)]);
    let cone = shape("cone", &[("radius1", 2.0), ("radius2", 0.0), ("height", 4.0)]);
    vec![
        (ball.clone(), x, &[5.0, 15.0], &[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]),
        // 3-4-5
        (
            ball.clone(),
            ray([-10.0, 3.0, 0.0], [2.0, 0.0, 0.0]),
            &[3.0, 7.0],
            &[[-0.8, 0.6, 0.0], [0.8, 0.6, 0.0]],
        ),
        (ball.clone(), ray([0.0, 5.0, -7.0], [0.0, 0.0, 1.0]), &[], &[]),
        (!&ball, x, &[5.0, 15.0], &[[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]]),
        (&ball - &half_space(Vec3::X, 3.0), x, &[13.0, 15.0], &[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]),
        (
            block(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)),
            ray([-1.0, -1.0, -1.0], [1.0, 2.0, 3.0]),
            &[1.0, 4.0 / 3.0],
            &[[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        ),
        (
            shape("cylinder", &[("radius", 5.0)]).rotate_y(90.0),
            ray([7.0, 3.0, -10.0], [0.0, 0.0, 1.0]),
            &[6.0, 14.0],
            &[[0.0, 0.6, -0.8], [0.0, 0.6, 0.8]],
        ),
        (
            cone.clone(),
            ray([-5.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
            &[4.0, 6.0],
            &[[-0.894427190999916, 0.0, 0.447213595499958], [0.894427190999916, 0.0, 0.447213595499958]],
        ),
        (
            cone,
            ray([0.5, 0.0, -9.0], [0.0, 0.0, 1.0]),
            &[7.0, 10.0],
            &[[0.0, 0.0, -1.0], [0.894427190999916, 0.0, 0.447213595499958]],
        ),
        (
            ring.clone(),
            x,
            &[5.0, 7.0, 13.0, 15.0],
            &[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
        ),
        (ring.clone(), ray([0.0, 0.0, -9.0], [0.0, 0.0, 1.0]), &[], &[]),
        (ring, ray([4.0, 0.0, -9.0], [0.0, 0.0, 1.0]), &[8.0, 10.0], &[[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]),
        (
            shape("paraboloid", &[("focal_length", 0.25), ("height", 9.0)]),
            ray([2.0, 0.0, 20.0], [0.0, 0.0, -1.0]),
            &[11.0, 16.0],
            &[[0.0, 0.0, 1.0], [0.970142500145332, 0.0, -0.242535625036333]],
        ),
        (
            half_space(Vec3::new(0.0, 3.0, 4.0), 10.0),
            ray([0.0, -1.0, 0.0], [0.0, 3.0, 4.0]),
            &[0.52],
            &[[0.0, 0.6, 0.8]],
        ),
        (Solid::universe(), x, &[], &[]),
        (Solid::empty(), x, &[], &[]),
    ]
}

/// Tests times and normals of simple solids, as they are and rotated, moved and scaled.
pub fn forms<E: Evaluator>(make: impl Fn(Arc<Program>) -> E) {
    let turn = Affine::rotation(Vec3::new(1.0, -2.0, 3.0), 123.4).then(&Affine::translate(Vec3::splat(7.0)));
    let large = Affine::scale(Vec3::splat(1e5)).then(&turn);
    for (frame, tolerance) in [(Affine::IDENTITY, 1e-14), (turn, 1e-13), (large, 1e-13)] {
        for (k, (solid, ray, times, normals)) in known().into_iter().enumerate() {
            let program = Program::compile(&solid.apply(frame)).unwrap_or_else(|e| panic!("{k}: {e}"));
            let evaluator = make(Arc::new(program));
            let ray = ray.transformed(&frame);
            let found = evaluator.one(ray, &Query::default()).unwrap();
            assert_eq!(found.crossings.len(), times.len(), "{k}: {solid:?}");
            for (crossing, (&t, &n)) in found.crossings.iter().zip(times.iter().zip(normals)) {
                assert!((crossing.t - t).abs() <= tolerance * (20.0 + t), "{k}: {} is not {t}", crossing.t);
                let normal = attributes::normal(evaluator.program(), &ray, crossing);
                let wanted = frame.vector(Vec3::from_array(n)).normalize();
                assert!((normal - wanted).length() <= 1e-12, "{k}: {normal} is not {wanted}");
                // outward: against the ray on entry
                assert_eq!(normal.dot(ray.direction) < 0.0, crossing.enters(), "{k}");
            }
        }
    }
}

/// Tests which points are inside; a point on a boundary counts as moved infinitesimally along `PERTURBATION_DIRECTION`.
pub fn points<E: Evaluator>(make: impl Fn(Arc<Program>) -> E) {
    let cube = block(Vec3::ZERO, Vec3::ONE);
    let contains = |solid: &Solid, point: [f64; 3]| {
        let program = Program::compile(solid).unwrap_or_else(|e| panic!("{e}"));
        let evaluator = make(Arc::new(program));
        let mut region = [RegionId(7)];
        evaluator.regions_at([&point[..1], &point[1..2], &point[2..]], &mut evaluator.scratch(), &mut region);
        assert_eq!(evaluator.contains(Vec3::from_array(point)), Ok(region[0] != RegionId(0)));
        region[0] == RegionId(1)
    };
    let evaluator = make(Arc::new(Program::compile(&cube).unwrap_or_else(|e| panic!("{e}"))));
    for bad in [f64::NAN, f64::INFINITY] {
        let problem = evaluator.contains(Vec3::new(0.5, bad, 0.5)).map_err(|problem| problem.to_string());
        assert!(problem.is_err_and(|text| text.contains("its coordinates must be finite")), "{bad}");
    }
    assert!(contains(&cube, [0.5, 0.5, 0.5]) && !contains(&cube, [1.5, 0.5, 0.5]));
    assert!(contains(&cube, [0.0, 0.5, 0.5]) && !contains(&cube, [1.0, 0.5, 0.5]));
    assert!(contains(&cube, [0.0, 0.0, 0.0]) && !contains(&cube, [0.0, 1.0, 0.0]));
    assert!(!contains(&!&cube, [0.0, 0.5, 0.5]) && contains(&!&cube, [1.0, 0.5, 0.5]));
    // of two solids that share a face, one contains it, also if it is turned by 180 degrees about z
    let turned = Affine::rotation(Vec3::Z, 180.0).then(&Affine::translate(Vec3::new(2.0, 1.0, 0.0)));
    let far = turned.then(&Affine::translate(Vec3::splat(9.0)));
    for next in [cube.translate([1.0, 0.0, 0.0]), cube.apply(turned), cube.place([turned, far])] {
        assert!(contains(&(&cube | &next), [1.0, 0.5, 0.5]));
        assert!(!contains(&(&cube & &next), [1.0, 0.5, 0.5]));
        assert!(contains(&(&cube ^ &next), [1.0, 0.5, 0.5]));
    }
}
