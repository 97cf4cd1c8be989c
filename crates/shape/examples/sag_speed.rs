//! Prints the time per ray for each sag surface, single-threaded: `sag_speed [rays [name]]`.

use rayweave_math::Vec3;
use rayweave_shape::Ray;
use rayweave_shape::surface::Surface;
use rayweave_shape::surface::object::Object;
use rayweave_shape::surface::sag::{Base, Description, Sag, Zernike, zernike_terms};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

fn conic(curvature: f64, conic: f64) -> Description {
    Description::new(10.0, Base::Conic { curvature, conic })
}

fn cases() -> Vec<(&'static str, Description)> {
    let even = vec![0.0, 1e-5, -2e-7, 1e-9];
    let waves: Vec<f64> = (0..37).map(|k| 1e-3 / f64::from(k + 1)).collect();
    let mixed = (0u32..7).flat_map(|i| (0..7 - i).map(move |j| (i, j, 1e-2 / 10f64.powi((i + j) as i32))));
    vec![
        ("conic", conic(0.05, -0.5)),
        ("even asphere, 4 terms", Description { even: even.clone(), ..conic(0.05, -0.5) }),
        ("even and odd, 4 + 3 terms", Description { even, odd: vec![0.0, 1e-4, -1e-6], ..conic(0.05, -0.5) }),
        ("biconic", Description::new(10.0, Base::Biconic { curvatures: [0.05, 0.03], conics: [-0.5, 0.2] })),
        ("polynomial of degree 6", Description { mixed: mixed.collect(), ..conic(0.05, -0.5) }),
        (
            "fringe Zernike, 37 terms",
            Description { mixed: zernike_terms(Zernike::Fringe, &waves, 10.0), ..conic(0.05, -0.5) },
        ),
    ]
}

/// Rays of a lens (from far below, slightly oblique) or in all directions about the vertex.
fn rays(count: usize, oblique: bool) -> Vec<Ray> {
    let mut state = 1u64;
    let mut unit = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    let mut ray = || match oblique {
        true => {
            let through = Vec3::new(7.0 * unit(), 7.0 * unit(), 2.0 * unit());
            let direction = Vec3::new(unit(), unit(), unit());
            Ray::new(through - 20.0 * direction, direction)
        }
        false => {
            let through = Vec3::new(7.0 * unit(), 7.0 * unit(), 0.0);
            let direction = Vec3::new(0.2 * unit(), 0.2 * unit(), 1.0);
            Ray::new(through - 50.0 * direction, direction)
        }
    };
    (0..count).map(|_| ray()).collect()
}

fn main() {
    let count = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(100_000);
    println!("{:28} {:>12} {:>12}", "ns per ray", "of a lens", "any direction");
    let round = ("sphere, for comparison", Surface::sphere(Vec3::new(0.0, 0.0, 20.0), 20.0));
    let sags = cases().into_iter().filter_map(|(name, of)| {
        let object = Object::new(Arc::new(Sag::new(&of).ok()?));
        Some((name, Surface::Object(Box::new(object))))
    });
    let wanted = std::env::args().nth(2).unwrap_or_default();
    for (name, surface) in std::iter::once(round).chain(sags).filter(|(name, _)| name.contains(&wanted)) {
        let time = |oblique: bool| {
            let rays = rays(count, oblique);
            let once = || {
                let start = Instant::now();
                rays.iter().for_each(|ray| {
                    black_box(surface.few_crossings(black_box(ray)));
                });
                start.elapsed().as_secs_f64()
            };
            1e9 / count as f64 * (0..7).map(|_| once()).fold(f64::INFINITY, f64::min)
        };
        println!("{name:28} {:12.0} {:12.0}", time(false), time(true));
    }
}
