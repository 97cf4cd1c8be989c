//! Mean chord lengths of solids, compared with integral geometry, which is independent of any evaluator.
//!
//! Lines are drawn uniformly and isotropically through a ball of radius R: their directions are uniform on
//! the sphere, their points uniform in the disc perpendicular to them. Then for every body in the ball,
//! convex or not, connected or not, the mean length of a line inside is `V / (pi R^2) = 4 V / S_b`, where
//! `S_b = 4 pi R^2` is the surface area of the ball; and a line hits a convex body of surface area S with
//! probability `S / S_b`, so that the mean chord is `4 V / S` (A.-L. Cauchy 1841; M. W. Crofton, Phil. Trans.
//! 158 (1868); L. A. Santalo, "Integral Geometry and Geometric Probability", 2nd ed. (2004), ch. 14).

use crate::models::{block, compiled, half_space, motion, shape};
use crate::rays::batch;
use crate::{Effort, Random};
use rayweave_math::{Affine, Vec3, any_perpendicular};
use rayweave_model::{Collected, Evaluator, Program, Query, RegionId, Solid};
use rayweave_shape::Ray;
use std::f64::consts::PI;
use std::sync::Arc;

/// A body within distance 2 of the origin.
struct Body {
    name: &'static str,
    solid: Solid,
    volume: f64,
    /// The surface area, if the body is convex.
    surface: Option<f64>,
}

/// The radius of the ball through which the lines are drawn.
const RADIUS: f64 = 2.0;

fn body(name: &'static str, solid: Solid, volume: f64, surface: Option<f64>) -> Body {
    Body { name, solid, volume, surface }
}

fn convex_bodies() -> Vec<Body> {
    let rod = shape("cylinder", &[("radius", 1.0), ("height", 2.0)]);
    let cone = shape("cone", &[("radius1", 1.0), ("radius2", 0.0), ("height", 1.0)]);
    let hexagon = shape("prism", &[("sides", 6.0), ("radius", 1.0), ("height", 1.0)]);
    let base = 1.5 * 3f64.sqrt();
    // oblate, half axes 1, 1, 1/2: e = sqrt(3) / 2
    let e = 0.75f64.sqrt();
    let pill = shape("sphere", &[("radius", 1.0)]).scale([1.0, 1.0, 0.5]);
    let pill_surface = 2.0 * PI * (1.0 + (1.0 - e * e) / e * libm::atanh(e));
    let half = shape("sphere", &[("radius", 1.0)]) & half_space(Vec3::Z, 0.0);
    let halves = block(Vec3::splat(-1.0), Vec3::new(0.0, 1.0, 1.0))
        | block(Vec3::new(0.0, -1.0, -1.0), Vec3::splat(1.0));
    let wedges = [0.0, 120.0, 240.0]
        .map(|start| shape("wedge", &[("start_degrees", start), ("sweep_degrees", 120.0)]) & &rod);
    vec![
        body("ball", shape("sphere", &[("radius", 1.5)]), 4.5 * PI, Some(9.0 * PI)),
        body("block", block(Vec3::new(-1.0, -0.5, -0.25), Vec3::new(1.0, 0.5, 0.25)), 1.0, Some(7.0)),
        body("cone", cone, PI / 3.0, Some(PI * (1.0 + 2f64.sqrt()))),
        body("hexagon", hexagon, base, Some(2.0 * base + 6.0)),
        body("pill", pill, 2.0 / 3.0 * PI, Some(pill_surface)),
        body("half a ball", half, 2.0 / 3.0 * PI, Some(3.0 * PI)),
        // parts in contact form a convex body
        body("cube of two halves", halves, 8.0, Some(24.0)),
        body("rod of three sectors", Solid::union(wedges), 2.0 * PI, Some(6.0 * PI)),
    ]
}

fn other_bodies() -> Vec<Body> {
    let ball = shape("sphere", &[("radius", 1.0)]);
    let cube = block(Vec3::splat(-1.0), Vec3::splat(1.0));
    let ring = shape("torus", &[("major", 1.0), ("minor", 0.5)]);
    let tube = shape("tube", &[("outer_radius", 1.0), ("inner_radius", 0.5), ("height", 2.0)]);
    let bore = shape("cylinder", &[("radius", 0.5), ("height", 2.0)]);
    let small = shape("sphere", &[("radius", 0.5)]);
    let spots = [-1.0, 0.0, 1.0].map(|x| Affine::translate(Vec3::X * x));
    // two balls of radius 1 with centres one apart overlap in a lens of 5 pi / 12
    let pair = ball.translate([-0.5, 0.0, 0.0]) | ball.translate([0.5, 0.0, 0.0]);
    let odd = ball.translate([-0.5, 0.0, 0.0]) ^ ball.translate([0.5, 0.0, 0.0]);
    vec![
        body("ring", ring, PI * PI / 2.0, None),
        body("tube", tube, 1.5 * PI, None),
        body("bored cube", &cube - bore, 8.0 - 0.5 * PI, None),
        body("cube without its ball", &cube - &ball, 8.0 - 4.0 / 3.0 * PI, None),
        body("touching balls", small.place(spots), 0.5 * PI, None),
        body("two balls", pair, (8.0 / 3.0 - 5.0 / 12.0) * PI, None),
        body("two balls but for their lens", odd, (8.0 / 3.0 - 10.0 / 12.0) * PI, None),
    ]
}

/// Tests mean lengths inside, and the share of lines that hit convex bodies: within five standard errors of
/// the values from volume and surface area. Bodies are rotated, moved and scaled.
pub fn mean_length<E: Evaluator>(make: impl Fn(Arc<Program>) -> E, effort: Effort) {
    let lines = effort.of(4_000, 400_000) as usize;
    for (k, body) in convex_bodies().into_iter().chain(other_bodies()).enumerate() {
        let mut rng = Random::new(14_000_000 + k as u64);
        let size = rng.pick(&[1e-3, 1.0, 20.0]);
        let frame = Affine::scale(Vec3::splat(size)).then(&motion(&mut rng));
        let evaluator = make(compiled(Program::compile(&body.solid.apply(frame))));
        let rays: Vec<Ray> = (0..lines).map(|_| line(&mut rng).transformed(&frame)).collect();
        let found = evaluator.collect(batch(&rays).rays(), &Query::default()).unwrap_or_default();
        let lengths: Vec<f64> = (0..lines).map(|i| inside(&found, i)).collect();
        expect(body.name, "length inside", &lengths, body.volume / (PI * RADIUS * RADIUS));
        if let Some(surface) = body.surface {
            let hits: Vec<f64> = lengths.iter().map(|&length| f64::from(u8::from(length > 0.0))).collect();
            expect(body.name, "share of hits", &hits, surface / (4.0 * PI * RADIUS * RADIUS));
        }
    }
}

/// A line with a direction of unit length.
fn line(rng: &mut Random) -> Ray {
    let direction = unit(rng);
    let side = any_perpendicular(direction);
    let (sin, cos) = libm::sincos(2.0 * PI * rng.uniform());
    let across = cos * side + sin * direction.cross(side);
    Ray::new(RADIUS * rng.uniform().sqrt() * across, direction)
}

/// A uniformly distributed unit vector (Archimedes: z is uniform).
fn unit(rng: &mut Random) -> Vec3 {
    let z = rng.between(-1.0, 1.0);
    let (sin, cos) = libm::sincos(2.0 * PI * rng.uniform());
    let flat = (1.0 - z * z).sqrt();
    Vec3::new(flat * cos, flat * sin, z)
}

/// The length of ray `i` inside the body.
fn inside(found: &Collected, i: usize) -> f64 {
    assert_eq!(found.starts[i], RegionId(0), "a bounded body");
    found.of(i).iter().map(|c| if c.enters() { -c.t } else { c.t }).sum()
}

/// Asserts that the mean of samples is within five standard errors of `expected`, and that the standard error
/// is below 6 % of it.
fn expect(name: &str, what: &str, samples: &[f64], expected: f64) {
    let count = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / count;
    let variance = samples.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (count - 1.0);
    let error = (variance / count).sqrt();
    assert!(
        error < 0.06 * expected,
        "{name}: the standard error {error} is too large for a mean of {expected}"
    );
    assert!((mean - expected).abs() <= 5.0 * error, "{name}: {what} {mean} +- {error}, not {expected}");
}
