//! The error bounds against an adversary that chooses the rounding of each operation and the errors of the input.

use super::adversary::{Adversary, V3};
use super::surfaces::{TwinRay, cylinder, discriminant, placed, plane, plane_time, quadric, sphere, value};
use super::torus;
use super::{Bounds, DIRECTION_ERROR};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

/// Errors and bounds of the outputs of a kernel in one run.
type Errors = Vec<(f64, f64)>;

type V3d = [f64; 3];

/// A number within `bound` of x, as far away as possible.
fn off(m: &mut Adversary, x: f32, bound: f32) -> f64 {
    let sign = if m.choice() { 1.0 } else { -1.0 };
    f64::from(x) + sign * f64::from(bound)
}

fn off3(m: &mut Adversary, v: V3, bound: f32) -> V3d {
    v.map(|x| off(m, x, bound))
}

fn dot(a: V3d, b: V3d) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn difference((value, bound): (f32, f32), exact: f64) -> (f64, f64) {
    ((f64::from(value) - exact).abs(), f64::from(bound))
}

/// The greatest ratios of error and bound that an adversary reaches by changing one choice after the other.
fn worst(rng: &mut ChaCha8Rng, run: impl Fn(&mut Adversary) -> Errors) -> Vec<f64> {
    let mut first = Adversary::default();
    let outputs = run(&mut first).len();
    (0..outputs)
        .map(|output| {
            let ratio = |choices: &[bool]| {
                let (error, bound) = run(&mut Adversary::new(choices.to_vec()))[output];
                error / bound
            };
            let mut choices: Vec<bool> = (0..first.count()).map(|_| rng.random_bool(0.5)).collect();
            let mut best = ratio(&choices);
            for _ in 0..2 {
                for k in 0..choices.len() {
                    choices[k] ^= true;
                    let found = ratio(&choices);
                    if found > best {
                        best = found;
                    } else {
                        choices[k] ^= true;
                    }
                }
            }
            best
        })
        .collect()
}

/// Random numbers, often all of one sign and size, where sums accumulate rounding errors.
fn vector(rng: &mut ChaCha8Rng, size: f32) -> V3 {
    match rng.random_range(0..5) {
        // just above powers of two, where a unit in the last place is largest
        3 | 4 => {
            let mut near = |x: f32| x * rng.random_range(1.0f32..1.0005);
            [near(1.0), near(1.0), near(2.0)]
        }
        0 => std::array::from_fn(|_| size * rng.random_range(-1.0f32..1.0)),
        1 => std::array::from_fn(|_| size * rng.random_range(0.5f32..0.52)),
        _ => std::array::from_fn(|_| size * rng.random_range(0.25f32..1.0)),
    }
}

/// A unit vector, or a vector just above powers of two as it is: no bound needs the length.
fn unit(v: V3) -> V3 {
    if v[2] >= 2.0 && v[2] < 2.01 {
        return v;
    }
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt().max(1e-20);
    v.map(|x| x / length)
}

/// A ray with errors of its input, or without: then only rounding counts.
fn ray(rng: &mut ChaCha8Rng, with_errors: bool) -> TwinRay {
    let (o, d) = (vector(rng, 3.0), unit(vector(rng, 1.0)));
    if with_errors {
        TwinRay { o, d, eo: 3e-6, ed: DIRECTION_ERROR }
    } else {
        TwinRay { o, d, eo: 0.0, ed: 0.0 }
    }
}

/// The maximum of each ratio over many inputs.
fn greatest(
    seed: u64,
    mut case: impl FnMut(&mut ChaCha8Rng, bool) -> Vec<f64>,
    with_errors: bool,
) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut greatest: Vec<f64> = Vec::new();
    for _ in 0..150 {
        let found = case(&mut rng, with_errors);
        greatest.resize(found.len(), 0.0);
        greatest.iter_mut().zip(found).for_each(|(most, ratio)| *most = most.max(ratio));
    }
    greatest
}

fn plane_case(rng: &mut ChaCha8Rng, with_errors: bool) -> Vec<f64> {
    let offset = -[rng.random_range(0.5f32..2.0), rng.random_range(4.0f32..4.01)][rng.random_range(0..2)];
    let normal = unit(vector(rng, 1.0));
    let e = if with_errors { [3e-8, 6e-8] } else { [0.0; 2] };
    let r = ray(rng, with_errors);
    let p = [normal[0], normal[1], normal[2], offset];
    worst(rng, |m| {
        let (n, c) = (off3(m, normal, e[0]), off(m, offset, e[1]));
        let (o, d) = (off3(m, r.o, r.eo), off3(m, r.d, r.ed));
        let [h, v] = plane(m, Bounds::default().room, p, e, &r);
        vec![difference(h, c - dot(n, o)), difference(v, dot(n, d))]
    })
}

/// The crossing of a plane, given height and speed: the bound has room for a division that no adversary uses up without errors.
fn plane_time_case(rng: &mut ChaCha8Rng, with_errors: bool) -> Vec<f64> {
    if !with_errors {
        return Vec::new();
    }
    let (h, v) = (rng.random_range(-4.0f32..4.0), rng.random_range(0.1f32..1.0));
    let given = [(h, 1e-5), (v, 1e-6)];
    worst(rng, |m| {
        let exact = off(m, h, given[0].1) / off(m, v, given[1].1);
        vec![difference(plane_time(m, Bounds::default().room, given), exact)]
    })
}

/// A quadratic at a random point, and its discriminant.
fn quadratic_case(rng: &mut ChaCha8Rng, with_errors: bool) -> Vec<f64> {
    let [a, b, c] = vector(rng, 1.0);
    let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    let x = [rng.random_range(-2.0f32..2.0), rng.random_range(1.0f32..1.0005)][rng.random_range(0..2)];
    let e = if with_errors { [1e-6f32, 2e-6, 3e-6] } else { [0.0; 3] };
    let given = [(a, e[0]), (b, e[1]), (sign * c, e[2])];
    worst(rng, |m| {
        let [a, b, c] = given.map(|(x, bound)| off(m, x, bound));
        let at = f64::from(x);
        let room = Bounds::default().room;
        vec![
            difference(value(m, room, given, x), (a * at + 2.0 * b) * at + c),
            difference(discriminant(m, room, given), b * b - a * c),
        ]
    })
}

fn moved(o: V3d, d: V3d, s: f32) -> V3d {
    std::array::from_fn(|k| o[k] + f64::from(s) * d[k])
}

fn sphere_case(rng: &mut ChaCha8Rng, with_errors: bool) -> Vec<f64> {
    let (centre, square) = (vector(rng, 1.0), rng.random_range(0.01f32..4.0));
    let e = if with_errors { [3e-8, 1e-7] } else { [0.0; 2] };
    let r = ray(rng, with_errors);
    let c = [centre[0], centre[1], centre[2], square];
    worst(rng, |m| {
        let (centre, square) = (off3(m, centre, e[0]), off(m, square, e[1]));
        let (o, d) = (off3(m, r.o, r.eo), off3(m, r.d, r.ed));
        let ([a, b, k], s) = sphere(m, Bounds::default().room, c, e, &r);
        let q = moved(std::array::from_fn(|k| o[k] - centre[k]), d, s);
        vec![difference(a, dot(d, d)), difference(b, dot(q, d)), difference(k, dot(q, q) - square)]
    })
}

fn axes(rng: &mut ChaCha8Rng) -> [V3; 3] {
    let first = unit(vector(rng, 1.0));
    let other = unit(vector(rng, 1.0));
    let cross =
        |a: V3, b: V3| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let second = unit(cross(first, other));
    [first, second, cross(first, second)]
}

fn quadric_case(rng: &mut ChaCha8Rng, with_errors: bool) -> Vec<f64> {
    let (centre, axes) = (vector(rng, 1.0), axes(rng));
    let (weights, linear, constant) = (vector(rng, 2.0), vector(rng, 1.0), rng.random_range(-2.0f32..2.0));
    let e = if with_errors { [3e-8f32, 3e-8, 6e-8, 6e-8, 1e-7] } else { [0.0; 5] };
    let r = ray(rng, with_errors);
    let row = |v: V3, w: f32| [v[0], v[1], v[2], w];
    let rows = [
        row(centre, e[0]),
        row(axes[0], e[1]),
        row(axes[1], e[2]),
        row(axes[2], e[3]),
        row(weights, constant),
        row(linear, e[4]),
    ];
    worst(rng, |m| {
        let centre = off3(m, centre, e[0]);
        let axes = axes.map(|axis| off3(m, axis, e[1]));
        let (w, l, c) = (off3(m, weights, e[2]), off3(m, linear, e[3]), off(m, constant, e[4]));
        let (o, d) = (off3(m, r.o, r.eo), off3(m, r.d, r.ed));
        let (found, s) = quadric(m, Bounds::default().room, &rows, &r);
        let z = moved(std::array::from_fn(|k| o[k] - centre[k]), d, s);
        let (p, y) = (axes.map(|axis| dot(axis, z)), axes.map(|axis| dot(axis, d)));
        let form = |a: V3d, b: V3d| w[0] * a[0] * b[0] + w[1] * a[1] * b[1] + w[2] * a[2] * b[2];
        let exact = [form(y, y), form(p, y) + 0.5 * dot(l, y), form(p, p) + dot(l, p) + c];
        found.iter().zip(exact).map(|(&found, exact)| difference(found, exact)).collect()
    })
}

/// The moment and |y|^2 of a line; at a random point of it, the function of the torus, half of its slope and the distance from the axis.
fn torus_case(rng: &mut ChaCha8Rng, with_errors: bool) -> Vec<f64> {
    let (centre, axes) = (vector(rng, 1.0), axes(rng));
    let radii = [rng.random_range(0.5f32..2.0), rng.random_range(0.2f32..1.5)];
    let e = if with_errors { [3e-8f32, 3e-8, 6e-8, 6e-8] } else { [0.0; 4] };
    let r = ray(rng, with_errors);
    let x = rng.random_range(-2.0f32..2.0);
    let row = |v: V3, w: f32| [v[0], v[1], v[2], w];
    let rows = [
        row(centre, e[0]),
        row(axes[0], e[1]),
        row(axes[1], radii[0]),
        row(axes[2], radii[1]),
        [e[2], e[3], 0.0, 0.0],
    ];
    worst(rng, |m| {
        let centre = off3(m, centre, e[0]);
        let axes = axes.map(|axis| off3(m, axis, e[1]));
        let [major, minor] = [off(m, radii[0], e[2]), off(m, radii[1], e[3])];
        let (o, d) = (off3(m, r.o, r.eo), off3(m, r.d, r.ed));
        let (line, [a, c], s) = torus::line(m, Bounds::default().room, &rows, &r);
        let [g, h, rho] = torus::jet(m, Bounds::default().room, &line, x);
        let z = moved(std::array::from_fn(|k| o[k] - centre[k]), d, s);
        let (start, y) = (axes.map(|axis| dot(axis, z)), axes.map(|axis| dot(axis, d)));
        let p = moved(start, y, x);
        let from_axis = (p[0] * p[0] + p[1] * p[1]).sqrt();
        let ring = from_axis - major;
        vec![
            difference(a, dot(y, y)),
            difference(c, start[0] * y[1] - start[1] * y[0]),
            difference(g, ring * ring + p[2] * p[2] - minor * minor),
            difference(h, ring * (p[0] * y[0] + p[1] * y[1]) / from_axis + p[2] * y[2]),
            difference(rho, from_axis),
        ]
    })
}

fn cylinder_case(rng: &mut ChaCha8Rng, with_errors: bool) -> Vec<f64> {
    let (point, axes, square) = (vector(rng, 1.0), axes(rng), rng.random_range(0.01f32..4.0));
    let e = if with_errors { [3e-8f32, 3e-8, 1e-7] } else { [0.0; 3] };
    let r = ray(rng, with_errors);
    let row = |v: V3, w: f32| [v[0], v[1], v[2], w];
    let rows = [row(point, e[0]), row(axes[0], e[1]), row(axes[1], square), [e[2], 0.0, 0.0, 0.0]];
    worst(rng, |m| {
        let (point, square) = (off3(m, point, e[0]), off(m, square, e[2]));
        let across = [off3(m, axes[0], e[1]), off3(m, axes[1], e[1])];
        let (o, d) = (off3(m, r.o, r.eo), off3(m, r.d, r.ed));
        let (found, s) = cylinder(m, Bounds::default().room, &rows, &r);
        let z = moved(std::array::from_fn(|k| o[k] - point[k]), d, s);
        let (p, y) = (across.map(|axis| dot(axis, z)), across.map(|axis| dot(axis, d)));
        let form = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let exact = [form(y, y), form(p, y), form(p, p) - square];
        found.iter().zip(exact).map(|(&found, exact)| difference(found, exact)).collect()
    })
}

fn placed_case(rng: &mut ChaCha8Rng, with_errors: bool) -> Vec<f64> {
    let (map, shift) = (axes(rng).map(|axis| axis.map(|x| 30.0 * x)), vector(rng, 20.0));
    let e = if with_errors { [1e-6f32, 2e-6] } else { [0.0; 2] };
    let r = ray(rng, with_errors);
    let row = |k: usize| [map[k][0], map[k][1], map[k][2], shift[k]];
    let rows = [row(0), row(1), row(2), [e[0], e[1], 0.0, 0.0]];
    worst(rng, |m| {
        let map = map.map(|row| off3(m, row, e[0]));
        let shift = off3(m, shift, e[1]);
        let (o, d) = (off3(m, r.o, r.eo), off3(m, r.d, r.ed));
        let there = placed(m, Bounds::default().room, &rows, &r);
        let error = |found: V3, exact: V3d| {
            (0..3).map(|k| (f64::from(found[k]) - exact[k]).abs()).fold(0.0, f64::max)
        };
        let origin = std::array::from_fn(|k| dot(map[k], o) + shift[k]);
        let direction = map.map(|row| dot(row, d));
        vec![(error(there.o, origin), f64::from(there.eo)), (error(there.d, direction), f64::from(there.ed))]
    })
}

/// Each bound holds for every choice tried, and half of it does not. For rounding alone, with exact input, an adversary reaches
/// more than a third: a unit in the last place is the relative error EPS only just above a power of two, which not all operations of a kernel
/// are at once.
#[test]
fn an_adversary_reaches_more_than_half_of_each_bound() {
    type Case = fn(&mut ChaCha8Rng, bool) -> Vec<f64>;
    let cases: [(&str, Case); 8] = [
        ("plane: height, speed", plane_case),
        ("plane: time", plane_time_case),
        ("quadratic: value, discriminant", quadratic_case),
        ("sphere: a, b, c", sphere_case),
        ("cylinder: a, b, c", cylinder_case),
        ("quadric: a, b, c", quadric_case),
        ("torus: |y|^2, moment, value, slope, distance from the axis", torus_case),
        ("placed: origin, direction", placed_case),
    ];
    for with_errors in [true, false] {
        for (name, case) in cases {
            let ratios = greatest(7, case, with_errors);
            println!("{name}, input errors {with_errors}: {ratios:.3?}");
            assert!(ratios.iter().all(|&ratio| ratio <= 1.0), "{name}: {ratios:?}");
            let least = if with_errors { 0.5 } else { 0.35 };
            assert!(ratios.iter().all(|&ratio| ratio > least), "{name}: {ratios:?}");
        }
    }
}
