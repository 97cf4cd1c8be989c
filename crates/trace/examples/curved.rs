//! Throughput of complete hit lists on models with cones, quadrics and tori, on one thread: eight rays at a
//! time and one by one.

use rayweave_math::Vec3;
use rayweave_model::{Evaluator, HitArrayRows, Program, RayBatch, Solid, Window};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Value, build};
use rayweave_trace::{Packets, Weave};
use std::sync::Arc;
use std::time::Instant;

/// Rays per batch, few enough for the cache.
const RAYS: usize = 4096;
/// Number of runs per batch; the fastest counts.
const ROUNDS: usize = 100;
/// Rows of the hit arrays.
const ROWS: usize = 16;

fn shape(name: &str, arguments: &[(&str, f64)]) -> Solid {
    let arguments: Vec<_> = arguments.iter().map(|&(n, v)| (n, Value::Number(v))).collect();
    Solid::from(build(name, &arguments).expect("a valid shape"))
}

fn ellipsoid(radii: [f64; 3]) -> Solid {
    let radii = Value::from(Vec3::from_array(radii));
    Solid::from(build("ellipsoid", &[("radii", radii)]).expect("a valid shape"))
}

/// `body` less three bores.
fn bored(body: Solid, bore: &Solid) -> Solid {
    body - bore - bore.rotate_x(90.0) - bore.rotate_y(90.0)
}

fn models() -> Vec<(&'static str, Solid)> {
    let cube = shape("box", &[("size", 2.0)]);
    let ball = shape("sphere", &[("radius", 1.35)]);
    let rod = shape("cylinder", &[("radius", 0.5)]);
    let cone = shape("cone", &[("radius1", 0.7), ("radius2", 0.3), ("height", 3.0)]);
    let ring = shape("torus", &[("major", 0.9), ("minor", 0.25)]);
    let bowl = shape("paraboloid", &[("focal_length", 1.0), ("height", 2.0)]);
    let egg = ellipsoid([1.5, 1.3, 1.2]);
    vec![
        ("die", bored(&cube & &ball, &rod)),
        ("die with conical bores", bored(&cube & &ball, &cone)),
        ("die cut from an ellipsoid", bored(&cube & &egg, &rod)),
        ("three turned ellipsoids", &egg & egg.rotate(Vec3::ONE, 120.0) & egg.rotate(Vec3::ONE, 40.0)),
        (
            "mirror",
            (shape("cylinder", &[("radius", 1.0), ("height", 1.5)]) & &bowl)
                - bowl.translate([0.0, 0.0, 0.2]),
        ),
        ("ring", ring.clone()),
        ("die with three grooves", bored(cube & ball, &ring)),
    ]
}

/// Rays from points on a sphere towards points in a box, from a fixed linear congruential sequence.
fn rays() -> RayBatch {
    let mut state = 1u64;
    let mut unit = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    let ray = || {
        let from = Vec3::new(unit(), unit(), unit()).normalize() * 5.0;
        let to = Vec3::new(unit(), unit(), unit());
        Ray::new(from, (to - from).normalize())
    };
    std::iter::repeat_with(ray).take(RAYS).collect()
}

/// Seconds per batch.
fn seconds<E: Evaluator>(evaluator: &E, batch: &RayBatch, rounds: usize) -> f64 {
    let (mut times, mut faces) = (vec![0.0; ROWS * RAYS], vec![0; ROWS * RAYS]);
    let mut scratch = evaluator.scratch();
    let mut best = f64::INFINITY;
    for _ in 0..rounds {
        let mut times: Vec<&mut [f64]> = times.chunks_mut(RAYS).collect();
        let mut faces: Vec<&mut [i32]> = faces.chunks_mut(RAYS).collect();
        let mut rows = HitArrayRows { times: &mut times, faces: &mut faces };
        let started = Instant::now();
        evaluator.hits(batch.rays(), Window::ALL, &mut scratch, &mut rows);
        best = best.min(started.elapsed().as_secs_f64());
    }
    best
}

fn main() {
    let batch = rays();
    for (name, solid) in models() {
        let program = Arc::new(Program::compile(&solid).expect("a valid solid"));
        let (packets, weave) = (Packets::new(program.clone()), Weave::new(program));
        let rate = |seconds: f64| RAYS as f64 / seconds / 1e6;
        let eight = rate(seconds(&packets, &batch, ROUNDS));
        let one = rate(seconds(&weave, &batch, ROUNDS / 10));
        println!(
            "{name}: packets {eight:.1} Mray/s, weave {one:.2} Mray/s, {:.1} times as many",
            eight / one
        );
    }
}
