//! Profiling target: runs one kernel, named by the first argument, on a number of rays: `kernels sphere 1000` in SIMD
//! lanes, `kernels sphere 1000 scalar` ray by ray. Prints the time per ray: the minimum over nine equal parts of the
//! run.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use rayweave_math::{Affine, Mat3, Transform, Vec3};
use rayweave_shape::Ray;
use rayweave_shape::lanes::{Kernel, LANES, LaneFacet, LaneLimits, LaneRay, LaneSpan, Lanes, Vec3Lanes};
use rayweave_shape::surface::Surface;
use std::hint::black_box;
use std::time::Instant;

fn surface(name: &str) -> Option<Surface> {
    let tilted = Vec3::new(0.3, -0.5, 1.0);
    let turned = Affine::rotation(tilted, 0.7);
    let quadric = |x, y, z, constant| {
        let matrix = Mat3::from_diagonal(Vec3::new(x, y, z));
        let here = Surface::quadric_about(Vec3::ZERO, matrix, Vec3::ZERO, constant);
        here.transformed(&Transform::from_affine(turned).expect("a rotation"))
    };
    Some(match name {
        "plane" => Surface::plane(tilted, 0.2),
        "sphere" => Surface::sphere(Vec3::ZERO, 1.0),
        "cylinder" => Surface::cylinder(Vec3::ZERO, tilted, 0.7),
        "upright" => Surface::cylinder(Vec3::ZERO, Vec3::Z, 0.7),
        "cone" => Surface::cone(Vec3::ZERO, tilted, 0.6),
        "ellipsoid" => quadric(1.0, 0.7, 0.5, -0.8),
        "hyperboloid" => quadric(1.0, 0.7, -0.5, -0.3),
        "torus" => Surface::torus(Vec3::ZERO, tilted, 0.9, 0.25),
        _ => return None,
    })
}

/// Rays from points on a sphere towards points in a box, eight per row.
fn rays(rows: usize) -> Vec<[[f64; LANES]; 6]> {
    let mut state = 1u64;
    let mut unit = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    let mut ray = || {
        let from = Vec3::new(unit(), unit(), unit()).normalize() * 5.0;
        let along = (Vec3::new(unit(), unit(), unit()) - from).normalize();
        [from.x, from.y, from.z, along.x, along.y, along.z]
    };
    let row = |rays: [[f64; 6]; LANES]| std::array::from_fn(|k| rays.map(|ray| ray[k]));
    (0..rows).map(|_| row(std::array::from_fn(|_| ray()))).collect()
}

#[inline(always)]
fn load<S: Simd>(simd: S, columns: &[[f64; LANES]]) -> Vec3Lanes<S> {
    let [x, y, z] = columns else { return Vec3Lanes::splat(simd, Vec3::ZERO) };
    let (x, y) = (Lanes::load_array_ref(simd, x), Lanes::load_array_ref(simd, y));
    Vec3Lanes { x, y, z: Lanes::load_array_ref(simd, z) }
}

/// Number of uncertain lanes, and a sum of times, so that nothing is optimised away. Without a facet only the rays are
/// generated.
#[inline(always)]
fn run<S: Simd>(simd: S, facet: Option<&LaneFacet>, rows: &[[[f64; LANES]; 6]], rounds: usize) -> (u32, f64) {
    let limits = LaneLimits {
        centre: Vec3::ZERO,
        radius: 3.0,
        magnitude: 2.0,
        largest_radius: 1.0,
        bend: 1.4,
        is_spherical: false,
    };
    let (mut uncertain_lanes, mut sum, mut last) = (0, 0.0, [0.0; LANES]);
    for _ in 0..rounds {
        for row in rows {
            let (origin, direction) = (load(simd, &row[..3]), load(simd, &row[3..]));
            let (ray, mut uncertain) = LaneRay::new(simd, origin, direction, &limits);
            let mut span = LaneSpan::line(simd);
            let mut ends = ray.middle;
            if let Some(facet) = facet {
                let gap = facet.narrow(simd, &ray, &mut span, &mut uncertain);
                ends = span.from.max(ends).min(span.to);
                if let Some(gap) = gap {
                    ends = ends.max(gap.from).min(gap.to);
                }
            }
            ends.store_array(&mut last);
            sum += last[0];
            uncertain_lanes += (uncertain.always | uncertain.grazes).to_bitmask().count_ones();
        }
    }
    (uncertain_lanes, sum)
}

/// Number of crossings, and the sum of their times, ray by ray.
fn run_scalar(surface: &Surface, rays: &[Ray], rounds: usize) -> (u32, f64) {
    let (mut crossings, mut sum) = (0, 0.0);
    for _ in 0..rounds {
        for ray in rays {
            let found = surface.crossings(ray);
            crossings += found.times().len() as u32;
            sum += found.times().iter().sum::<f64>();
        }
    }
    (crossings, sum)
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let name = arguments.get(1).map_or("cone", String::as_str);
    let rounds: usize = arguments.get(2).and_then(|n| n.parse().ok()).unwrap_or(1);
    let rows = rays(1024);
    let surface = surface(name);
    let kernel = surface.as_ref().and_then(Kernel::of);
    let facet = kernel.map(|kernel| LaneFacet {
        kernel,
        inside: true,
        face: 0.0,
        surfaces: [0.0; 2],
        gap: 0,
        is_one_piece: false,
    });
    let ray = |row: &[[f64; LANES]; 6], k: usize| {
        let [x, y, z, u, v, w] = row.map(|column| column[k]);
        Ray::new(Vec3::new(x, y, z), Vec3::new(u, v, w))
    };
    let rays: Vec<Ray> = rows.iter().flat_map(|row| (0..LANES).map(move |k| ray(row, k))).collect();
    let scalar = surface.filter(|_| arguments.get(3).is_some_and(|word| word == "scalar"));
    let part = || match &scalar {
        Some(surface) => run_scalar(surface, &rays, rounds),
        None => dispatch!(Level::new(), simd => run(simd, facet.as_ref(), &rows, rounds)),
    };
    let unit = if scalar.is_some() { "crossings" } else { "uncertain" };
    let mut least = f64::INFINITY;
    let mut last = (0, 0.0);
    for _ in 0..9 {
        let start = Instant::now();
        last = black_box(part());
        least = least.min(start.elapsed().as_secs_f64());
    }
    let count = rounds * rays.len();
    let nanoseconds = least / count as f64 * 1e9;
    println!("{name}: {count} rays, {} {unit}, {}, {nanoseconds:.3} ns per ray", last.0, last.1);
}
