//! Models with curved faces of every kind, eight rays at a time: equal to the reference, bit for bit.

use fearless_simd::Level;
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::Vec3;
use rayweave_model::{
    Collected, Evaluator, FirstHitColumns, Limit, Program, Query, RayBatch, Region, Solid, Window,
};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Value, build};
use rayweave_trace::{Packets, Reference};
use std::sync::Arc;

fn shape(name: &str, arguments: &[(&str, f64)]) -> Solid {
    let arguments: Vec<_> = arguments.iter().map(|&(n, v)| (n, Value::Number(v))).collect();
    Solid::from(build(name, &arguments).unwrap())
}

fn cone(radius1: f64, radius2: f64, height: f64) -> Solid {
    shape("cone", &[("radius1", radius1), ("radius2", radius2), ("height", height)])
}

fn torus(major: f64, minor: f64) -> Solid {
    shape("torus", &[("major", major), ("minor", minor)])
}

fn sphere(radius: f64) -> Solid {
    shape("sphere", &[("radius", radius)])
}

fn cylinder(radius: f64, height: f64) -> Solid {
    shape("cylinder", &[("radius", radius), ("height", height)])
}

fn cube(size: f64) -> Solid {
    shape("box", &[("size", size)])
}

fn ellipsoid(radii: [f64; 3]) -> Solid {
    Solid::from(build("ellipsoid", &[("radii", Value::from(Vec3::from_array(radii)))]).unwrap())
}

fn diagonal(x: f64, y: f64, z: f64, constant: f64) -> Solid {
    let rows = [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0], [0.0, 0.0, 0.0, constant]];
    Solid::from(build("quadric", &[("matrix", Value::from(&rows[..]))]).unwrap())
}

/// Models of about unit size around the origin.
fn models() -> Vec<(&'static str, Solid)> {
    let bore = cone(0.7, 0.3, 3.0);
    let bowl = shape("paraboloid", &[("focal_length", 0.4), ("height", 1.0)]);
    let saddle = {
        let rows = [[1.0, 0.0, 0.0, 0.0], [0.0, -0.8, 0.0, 0.0], [0.0, 0.0, 0.0, 0.5], [0.0, 0.0, 0.5, 0.0]];
        Solid::from(build("quadric", &[("matrix", Value::from(&rows[..]))]).unwrap())
    };
    let ring = torus(1.0, 0.35);
    vec![
        ("bored die", (cube(2.0) & sphere(1.35)) - &bore - bore.rotate_x(90.0) - bore.rotate_y(35.0)),
        ("cup", cone(0.5, 1.2, 2.0) - cone(0.4, 1.1, 2.0).translate([0.0, 0.0, 0.3])),
        (
            "top",
            cone(0.0, 1.0, 1.0).translate([0.0, 0.0, -0.5]) | cone(1.0, 0.0, 0.7).translate([0.0, 0.0, 0.35]),
        ),
        ("tip in a ball", sphere(0.8) ^ cone(1.0, 0.0, 1.5).rotate_x(20.0)),
        ("hour-glass", diagonal(1.0, 1.0, -0.5, 0.0) & cube(2.0)),
        ("its complement", cube(2.0) - diagonal(1.0, 0.7, -0.5, 0.0).rotate_y(15.0)),
        ("nearly a rod", cone(0.8, 0.8 - 1e-4, 2.5) - cone(0.6, 0.61, 3.0)),
        ("stretched cone", cone(0.9, 0.2, 2.0).scale([1.0, 0.5, 0.8]).rotate_x(40.0) - sphere(0.5)),
        ("mirror", (cylinder(0.9, 2.0) & bowl.translate([0.0, 0.0, -0.2])) - bowl.translate([0.0, 0.0, 0.1])),
        ("egg", ellipsoid([1.0, 0.7, 1.3]) - ellipsoid([0.9, 0.6, 1.2]) - ellipsoid([0.3, 2.0, 0.4])),
        ("needle", ellipsoid([0.05, 0.05, 1.5]) | ellipsoid([1.2, 0.02, 0.4]).rotate_z(30.0)),
        ("tower", diagonal(1.0, 1.0, -0.6, -0.3) & cylinder(1.5, 2.0)),
        ("two sheets", cube(3.0) & diagonal(1.0, 0.8, -0.6, 0.2).rotate_x(10.0)),
        ("beyond two sheets", cube(2.0) - diagonal(1.0, 0.8, -0.6, 0.2)),
        ("saddle", saddle & cylinder(1.0, 2.0)),
        ("ring", &ring - cube(1.4).translate([0.7, 0.0, 0.0])),
        ("chain", &ring | ring.rotate_x(90.0).translate([1.0, 0.0, 0.0])),
        ("squeezed ring", ring.scale([1.0, 0.6, 1.3]).rotate_y(25.0) ^ sphere(0.9)),
        ("spindle", torus(0.5, 0.7) - torus(0.9, 0.2)),
        ("groove", cylinder(1.0, 1.0) - torus(1.0, 0.2) - torus(0.5, 0.5).translate([0.0, 0.0, 0.5])),
        ("ball in a ring", torus(1.0, 0.3) | sphere(0.7)),
        ("ball in a cone", cone(0.0, 1.0, 1.0) & sphere(0.5) & diagonal(1.0, 1.0, 0.4, -0.2)),
    ]
}

fn unit(rng: &mut ChaCha8Rng) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)))
}

/// Rays in general position, parallel to the axes, at edges and apexes, from far away and from inside.
fn rays(count: usize, program: &Arc<Program>, rng: &mut ChaCha8Rng) -> RayBatch {
    let reference = Reference::new(program.clone());
    let mut rays: Vec<Ray> = Vec::with_capacity(count);
    for k in 0..count {
        let to = unit(rng);
        let from = 5.0 * unit(rng).normalize();
        let snapped = |v: Vec3| (4.0 * v).round() / 4.0;
        let axis = Vec3::AXES[k % 3];
        rays.push(match k % 11 {
            0..=3 => Ray::new(from, (to - from).normalize()),
            4 => Ray::new(1.2 * to - 5.0 * axis, axis),
            5 => Ray::new(snapped(to) - 3.0 * axis, axis),
            6 => Ray::new(1.2 * to - 5.0 * axis, axis + 10f64.powi(-(k as i32 % 9)) * unit(rng)),
            7 => Ray::new(snapped(to), from * 10f64.powi(k as i32 % 60 - 30)),
            8 => Ray::new(1e6 * from, (to - 1e6 * from).normalize()),
            9 => tangent(&reference, Ray::new(from, to - from), rng),
            _ => Ray::new(snapped(to), snapped(from)),
        });
        let last = rays.len() - 1;
        if rays[last].check().is_err() {
            rays[last] = Ray::new(from, to - from);
        }
    }
    rays.into_iter().collect()
}

/// A ray that is tangent, or nearly so, to the model where another ray hits it.
fn tangent(reference: &Reference, ray: Ray, rng: &mut ChaCha8Rng) -> Ray {
    let found = reference.one(ray, &Query::default()).unwrap();
    let Some(crossing) = found.crossings.first() else { return ray };
    let program = reference.program();
    let point = ray.at(crossing.t);
    let (_, gradient) = program.surface(crossing.face.surface).surface.value_and_gradient(point);
    let (normal, perturbation) = (gradient.normalize(), 10f64.powi(-rng.random_range(2..18)));
    let along = normal.cross(unit(rng)).normalize();
    Ray::new(point + perturbation * normal - 2.0 * along, along)
}

fn bits(found: &Collected) -> Vec<u64> {
    found.crossings.iter().map(|c| c.t.to_bits()).collect()
}

/// Times and normals of first hits as bits, and their faces.
fn looks<E: Evaluator>(evaluator: &E, batch: &RayBatch, window: Window) -> (Vec<[u64; 4]>, Vec<i32>) {
    let count = batch.rays().len();
    let mut found = FirstHitColumns::new(count);
    evaluator.nearest(batch.rays(), window, &mut evaluator.scratch(), &mut found.hits());
    let FirstHitColumns { t, face, normal: [x, y, z], .. } = found;
    let bits = (0..count).filter(|&k| face[k] >= 0).map(|k| [t[k], x[k], y[k], z[k]].map(f64::to_bits));
    (bits.collect(), face)
}

fn compare(name: &str, program: &Arc<Program>, batch: &RayBatch, level: Level) {
    let (reference, packets) = (Reference::new(program.clone()), Packets::with_level(program.clone(), level));
    assert!(packets.uses_lanes(), "{name}");
    for (t_min, t_max) in [(f64::NEG_INFINITY, f64::INFINITY), (0.0, f64::INFINITY), (-1.0, 5.2)] {
        let window = Window::new(t_min, t_max).unwrap();
        assert_eq!(looks(&packets, batch, window), looks(&reference, batch, window), "{name}");
        for limit in [Limit::All, Limit::First] {
            let query = Query { window, limit, starts: None };
            let [expected, got] =
                [reference.collect(batch.rays(), &query), packets.collect(batch.rays(), &query)]
                    .map(Result::unwrap);
            for k in 0..expected.len() {
                let here = format!("{name}, ray {k}, {query:?}");
                assert_eq!(got.starts[k], expected.starts[k], "{here}");
                assert_eq!(got.of(k), expected.of(k), "{here}");
            }
            assert_eq!(bits(&got), bits(&expected), "{name}");
        }
    }
}

/// The best instruction set of this machine and, on x86, AVX2.
fn levels() -> Vec<Level> {
    let best = Level::new();
    #[cfg(target_arch = "x86_64")]
    let narrower = best.as_avx2().map(Level::Avx2);
    #[cfg(not(target_arch = "x86_64"))]
    let narrower = None;
    [Some(best), narrower].into_iter().flatten().collect()
}

fn check(count: usize, seed: u64) {
    for (name, solid) in models() {
        let program = Arc::new(Program::compile(&solid).unwrap());
        let batch = rays(count, &program, &mut ChaCha8Rng::seed_from_u64(seed));
        levels().into_iter().for_each(|level| compare(name, &program, &batch, level));
    }
}

#[test]
fn curved_models_get_the_answers_of_the_reference() {
    check(500, 1);
}

#[test]
#[ignore = "long"]
fn long_curved_models_get_the_answers_of_the_reference() {
    (10..20).for_each(|seed| check(5_000, seed));
}

/// Two media that share a curved face, and one that overlaps.
#[test]
fn curved_regions_get_the_answers_of_the_reference() {
    let (bowl, ring) = (cone(0.4, 1.0, 1.5), torus(0.7, 0.3));
    let solids = [&bowl - &ring, &bowl & &ring, ellipsoid([0.3, 0.4, 1.5])];
    let regions: Vec<Region> = solids
        .into_iter()
        .zip(1..)
        .map(|(solid, medium)| Region { name: format!("region {medium}"), solid, medium })
        .collect();
    let program = Arc::new(Program::compile_regions(&regions).unwrap());
    let batch = rays(1000, &program, &mut ChaCha8Rng::seed_from_u64(2));
    levels().into_iter().for_each(|level| compare("regions", &program, &batch, level));
}
