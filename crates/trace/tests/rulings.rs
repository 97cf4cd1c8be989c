//! Rays along rulings of cones and hyperboloids: the answer is that of the ray moved infinitesimally along the
//! perturbation direction, at every time, whatever else the model contains.

mod everyone;

use rayweave_conformance::Random;
use rayweave_math::{Affine, PERTURBATION_DIRECTION, Vec3};
use rayweave_model::{Collected, Evaluator, Program, RegionId, Solid};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Value, build};
use rayweave_shape::surface::delta;
use rayweave_trace::Reference;
use std::sync::Arc;

fn numbers(name: &str, arguments: &[(&str, f64)]) -> Solid {
    let arguments: Vec<(&str, Value)> = arguments.iter().map(|&(n, x)| (n, Value::Number(x))).collect();
    Solid::from(build(name, &arguments).unwrap())
}

fn half_space(normal: Vec3, offset: f64) -> Solid {
    Solid::from(build("half_space", &[("normal", normal.into()), ("offset", offset.into())]).unwrap())
}

/// A hyperboloid of one sheet, x^2 + y^2 - z^2 < 1, which is unbounded.
fn hyperboloid() -> Solid {
    let rows = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 0.0, 0.0, -1.0]];
    Solid::from(build("quadric", &[("matrix", rows.as_slice().into())]).unwrap())
}

fn trace(solid: &Solid, ray: Ray) -> Collected {
    everyone::trace(&Arc::new(Program::compile(solid).unwrap()), ray)
}

/// True if the ray is inside at a time that is not that of a crossing.
fn is_inside(answer: &Collected, t: f64) -> bool {
    let last = answer.crossings.iter().rev().find(|crossing| crossing.t < t);
    last.map_or(answer.starts[0], |crossing| crossing.after) != RegionId(0)
}

/// A cone within the half-space below its tangent plane: nothing of it is above, and a distant ball, which lengthens the
/// chord of the model, does not change that.
#[test]
fn a_cone_is_below_its_tangent_plane() {
    let cone = numbers("cone", &[("radius1", 3.0), ("radius2", 0.0), ("height", 4.0)]);
    let wall = half_space(Vec3::new(4.0, 0.0, 3.0), 6.0);
    let ball = numbers("sphere", &[("radius", 1.0)]).translate([0.0, 0.0, 20.0]);
    let ruling = Ray::new(Vec3::new(3.0, 0.0, -2.0), Vec3::new(-3.0, 0.0, 4.0));
    for turn in [0.0, 1e-3, 40.0, 200.0] {
        let map = Affine::rotation(Vec3::new(0.3, 1.0, -0.2), turn);
        for solid in [&cone - &wall, (&cone - &wall) | ball.clone()] {
            let answer = trace(&solid.apply(map), ruling.transformed(&map));
            assert_eq!(answer.crossings.len(), 0, "{turn}: {:?}", answer.crossings);
            assert_eq!(answer.starts[0], RegionId(0));
        }
    }
}

/// Two cones that touch along a common ruling, one displaced along it: the second is left later.
#[test]
fn tangent_cones_end_at_their_own_apexes() {
    let cone = numbers("cone", &[("radius1", 3.0), ("radius2", 0.0), ("height", 4.0)]);
    let ruling = Ray::new(Vec3::new(3.0, 0.0, -2.0), Vec3::new(-3.0, 0.0, 4.0));
    let longer = cone.translate([-1.5, 0.0, 2.0]);
    let inside = |solid: &Solid, t: f64| is_inside(&trace(solid, ruling), t);
    // where the moved ray is inside of the cones at all, it is so up to the apex of each
    let is_in = inside(&cone, 0.75);
    assert_eq!([0.25, 0.75, 1.25].map(|t| inside(&cone, t)), [is_in, is_in, false]);
    assert_eq!([0.25, 0.75, 1.25].map(|t| inside(&longer, t)), [false, is_in, is_in]);
    assert_eq!([0.25, 0.75, 1.25].map(|t| inside(&(&longer - &cone), t)), [false, false, is_in]);
    assert_eq!([0.25, 0.75, 1.25].map(|t| inside(&(&cone - &longer), t)), [is_in, false, false]);
}

/// The time at which a ray along a ruling changes sides is as accurate as other crossings, however far away the ray starts.
#[test]
fn turning_points_of_distant_rays_are_within_the_tolerance() {
    let cone = numbers("cone", &[("radius1", 3.0), ("radius2", 0.0), ("height", 4.0)]);
    let saddle = Solid::from(
        build(
            "quadric",
            &[("matrix", [[0.0, 0.5, 0.0, 0.0], [0.5, 0.0, 0.0, 0.0], [0.0; 4], [0.0; 4]].as_slice().into())],
        )
        .unwrap(),
    );
    let ball = numbers("sphere", &[("radius", 1.0)]).translate([0.0, 9.0, 9.0]);
    let w = PERTURBATION_DIRECTION;
    // a point and the direction of a ruling, and the time from the point to the zero of w . grad f
    let cases = [
        // the cone ends at its apex
        (&cone, Vec3::new(-3.0, 0.0, -2.0), Vec3::new(3.0, 0.0, 4.0), 1.0),
        // grad f = (2, 2 t, -2 t)
        (&hyperboloid(), Vec3::X, Vec3::new(0.0, 1.0, 1.0), -w.x / (w.y - w.z)),
        // grad f = (0, 1 + t, 0)
        (&saddle, Vec3::new(1.0, 0.0, 1.0), Vec3::new(1.0, 0.0, -0.25), -1.0),
    ];
    for (solid, point, direction, turn) in cases {
        for away in [0.0, 3.0, 4096.0, 131_072.0, 1_048_576.0] {
            let ray = Ray::new(point - away * direction, direction);
            let answer = trace(&(solid ^ &ball), ray);
            let tolerance = delta(20.0, &ray, away + turn) / direction.length();
            let times: Vec<f64> = answer.crossings.iter().map(|crossing| crossing.t).collect();
            let nearest = times.iter().map(|t| (t - (away + turn)).abs()).fold(f64::INFINITY, f64::min);
            assert!(nearest <= tolerance, "{away}: {times:?}, {nearest:e} > {tolerance:e}");
        }
    }
}

/// Random models around a cone or hyperboloid, and rays along its rulings: at every time the answer is whether the
/// moved point of the ray is inside, found by a point query, which does not involve rays.
#[test]
fn the_answer_is_that_of_the_moved_points() {
    let (mut rng, mut tested) = (Random::new(11), 0);
    for round in 0..480 {
        let (solid, ray) =
            if round % 2 == 0 { beside_a_cone(&mut rng) } else { beside_a_hyperboloid(&mut rng) };
        let map = Affine::rotation(rng.direction(), rng.between(0.0, 360.0));
        let (solid, ray) = match round % 3 {
            0 => (solid, ray),
            _ => (solid.apply(map), ray.transformed(&map)),
        };
        let program = Arc::new(Program::compile(&solid).unwrap());
        let answer = everyone::trace(&program, ray);
        for _ in 0..40 {
            let t = rng.between(-4.0, 6.0);
            let moved =
                [1e-4, 1e-5, 1e-6].map(|by| contains(&program, ray.at(t) + by * PERTURBATION_DIRECTION));
            if moved[0] != moved[1] || moved[1] != moved[2] {
                continue;
            }
            tested += 1;
            assert_eq!(is_inside(&answer, t), moved[2], "{round}: {solid} along {ray:?} at {t}");
        }
    }
    assert!(tested > 15_000, "{tested}");
}

fn contains(program: &Arc<Program>, point: Vec3) -> bool {
    let mut region = [RegionId(0)];
    let reference = Reference::new(program.clone());
    let [x, y, z] = point.to_array().map(|coordinate| [coordinate]);
    reference.regions_at([&x, &y, &z], &mut reference.scratch(), &mut region);
    region[0] != RegionId(0)
}

/// A cone with a tangent plane, a plane through the ray or a box, and a ray along a ruling.
fn beside_a_cone(rng: &mut Random) -> (Solid, Ray) {
    let (radius, height) = (rng.between(0.5, 3.0), rng.between(0.5, 3.0));
    let cone = numbers("cone", &[("radius1", radius), ("radius2", 0.0), ("height", height)]);
    let (sin, cos) = libm::sincos(rng.between(0.0, 6.3));
    let bottom = Vec3::new(radius * cos, radius * sin, -0.5 * height);
    let direction = Vec3::new(-radius * cos, -radius * sin, height);
    let normal = match rng.below(3) {
        0 => Vec3::new(height * cos, height * sin, radius),
        _ => direction.cross(rng.direction()),
    };
    (joined(rng, cone, half_space(normal, normal.dot(bottom))), Ray::new(bottom, direction))
}

fn beside_a_hyperboloid(rng: &mut Random) -> (Solid, Ray) {
    let (sin, cos) = libm::sincos(rng.between(0.0, 6.3));
    let waist = Vec3::new(cos, sin, 0.0);
    let direction = Vec3::new(-sin, cos, rng.pick(&[1.0, -1.0]));
    let normal = direction.cross(rng.direction());
    (joined(rng, hyperboloid(), half_space(normal, normal.dot(waist))), Ray::new(waist, direction))
}

/// A boolean combination of two solids whose surfaces contain the ray, and of others that do not.
fn joined(rng: &mut Random, first: Solid, second: Solid) -> Solid {
    let both = match rng.below(4) {
        0 => first - second,
        1 => first | second,
        2 => first & second,
        _ => first ^ second,
    };
    let ball = numbers("sphere", &[("radius", rng.between(0.3, 2.0))]).translate(rng.point(2.0));
    match rng.below(4) {
        0 => both | ball.translate([0.0, 0.0, 30.0]),
        1 => both - ball,
        2 => both ^ ball,
        _ => both,
    }
}
