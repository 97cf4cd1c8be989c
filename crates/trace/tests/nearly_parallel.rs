//! Rays that are parallel to a surface up to rounding, which would hit it at times of about 1e16: nearby
//! crossings must stay correct.

mod everyone;

use rayweave_math::{Affine, Mat3, Vec3};
use rayweave_model::{Program, RegionId, Solid};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Value, build};
use std::sync::Arc;

/// A rotation without round numbers.
fn turn() -> Affine {
    let columns = [
        [0.9198678251134597, -0.29241932082280053, -0.2614079668460134],
        [-0.251575838561128, 0.07145065224197675, -0.9651965611969728],
        [0.300919892618118, 0.9536171900210946, -0.00784047976670625],
    ];
    let [x, y, z] = columns.map(Vec3::from_array);
    Affine {
        linear: Mat3::from_cols(x, y, z),
        translation: Vec3::new(0.41304945128100856, 2.7895525294933172, 0.892537635104067),
    }
}

fn made(name: &str, arguments: &[(&str, Value)]) -> Solid {
    Solid::from(build(name, arguments).unwrap())
}

/// True if the origin of the ray is inside, and the number of crossings with |t| < 1000.
fn near(solid: &Solid, origin: Vec3, direction: Vec3) -> (bool, usize) {
    let program = Arc::new(Program::compile(&solid.apply(turn())).unwrap());
    let ray = Ray::new(origin, direction).transformed(&turn());
    let found = everyone::trace(&program, ray);
    let before = found.crossings.iter().rfind(|c| c.t < 0.0);
    let region = before.map_or(found.starts[0], |c| c.after);
    (region != RegionId(0), found.crossings.iter().filter(|c| c.t.abs() < 1e3).count())
}

#[test]
fn planes_met_very_far_away_are_not_welded() {
    let half = made("half_space", &[("normal", Vec3::Y.into()), ("offset", 2.0.into())]);
    let slab = made("slab", &[("normal", Vec3::Z.into()), ("lo", (-1.0).into()), ("hi", 1.0.into())]);
    for z in [-3.0, -0.5, 0.0, 0.5, 3.0] {
        for y in [-2.0, 1.5, 2.5] {
            let (inside, crossings) = near(&(&half - &slab), Vec3::new(-2.25, y, z), Vec3::X);
            assert_eq!((inside, crossings), (y < 2.0 && z.abs() > 1.0, 0), "y = {y}, z = {z}");
        }
    }
}

#[test]
fn an_elliptic_cylinder_is_not_met_beside_it() {
    let rod = made("cylinder", &[("radius", 1.0.into()), ("height", 1.0.into())]).scale([1.0, 2.0, 1.0]);
    for x in [0.25, 0.75, 1.25, 2.25] {
        for y in [-2.25, -1.75, 0.25, 1.75] {
            let inside = x * x + y * y / 4.0 < 1.0;
            let found = near(&rod, Vec3::new(x, y, 0.25), 2.0 * Vec3::Z);
            assert_eq!(found, (inside, if inside { 2 } else { 0 }), "x = {x}, y = {y}");
        }
    }
}

/// A ray in an asymptotic direction has one crossing nearby: its square term is 0 up to rounding.
#[test]
fn an_asymptotic_ray_meets_a_hyperboloid_once() {
    let rows: [[f64; 4]; 4] =
        [[3.0, 0.0, -0.03, -0.2], [0.0, 0.9, 0.0, 0.0], [-0.03, 0.0, 0.0, 0.0], [-0.2, 0.0, 0.0, -0.2]];
    let solid = made("quadric", &[("matrix", rows.as_slice().into())]);
    for x in [1.0, 2.0, -2.0] {
        // 3 x^2 + 0.9 y^2 - 0.06 x z - 0.4 x - 0.2 = 0 has one solution z
        let z = (3.0 * x * x + 0.9 - 0.4 * x - 0.2) / (0.06 * x);
        let start = Vec3::new(x, 1.0, z + 5.0);
        assert_eq!(near(&solid, start, Vec3::Z), (x > 0.0, 1), "x = {x}");
        assert_eq!(near(&solid, start, -Vec3::Z), (x > 0.0, 1), "x = {x}");
    }
}

/// A ray in the tangent plane on top of a torus, tangent to the circle of contact: a fourfold root. Rounding decides
/// whether it is found, but no root is found anywhere else.
#[test]
fn a_ray_that_touches_a_ring_on_top_meets_it_nowhere_else() {
    let ring = made("torus", &[("major", 1.0.into()), ("minor", 0.5.into())]);
    for degrees in 0..200 {
        let turn = Affine::rotation(Vec3::new(1.0, 2.0, -0.5), 1.7 * f64::from(degrees))
            .then(&Affine::translate(Vec3::new(-1.2, -2.8, -0.7)));
        let program = Arc::new(Program::compile(&ring.apply(turn)).unwrap());
        for side in [0.5, -0.5] {
            let ray = Ray::new(Vec3::new(-3.25, 1.0, side), 2.0 * Vec3::X).transformed(&turn);
            for crossing in everyone::trace(&program, ray).crossings {
                assert!((crossing.t - 1.625).abs() < 2e-3, "{degrees}: {}", crossing.t);
            }
        }
    }
}
