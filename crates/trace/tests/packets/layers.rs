//! Layered models: volumes in volumes, in copies, some of which touch, each region with a medium of its own.

use crate::arrange::{cube, gap, sphere};
use crate::oracle::{Setting, levels};
use crate::starts;
use rayweave_conformance::{Random, Tally};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Region, Solid};
use rayweave_shape::Ray;

/// Copies of a core with a sensor on it, in a shell within a cover; in the world, beside a ball of the last region.
fn layers(rng: &mut Random, frame: &Affine) -> Vec<Region> {
    let half = Vec3::new(1.0, rng.pick(&[1.0, 0.5]), rng.pick(&[1.0, 2.0]));
    let shell = Vec3::splat(rng.pick(&[0.3, 0.01, 1e-9]));
    let up = Vec3::Z * (half.z + 0.1 + gap(rng));
    let at = |x: u32| Vec3::new(f64::from(x % 3), f64::from(x / 3), 0.0) * apart(half, shell);
    let maps: Vec<Affine> = (0..9).map(|x| Affine::translate(at(x))).collect();
    let core = if rng.chance(0.3) { sphere(half.min_element()) } else { cube(half) };
    let sensor = cube(Vec3::new(0.9 * half.x, 0.9 * half.y, 0.1)).translate(up.to_array());
    let inner = cube(half + shell + Vec3::Z * 0.2);
    let cover = cube(half + 2.0 * shell + Vec3::Z * 0.2);
    let is_placed = rng.chance(0.8);
    let copies = |solid: Solid| if is_placed { solid.place(maps.clone()) } else { solid };
    let world = cube(Vec3::splat(30.0));
    let ball = copies(sensor) | sphere(1.0).translate([-10.0, 0.0, 0.0]);
    let solids = [world, copies(cover), copies(inner), copies(core), ball];
    let region = |(k, solid): (u32, Solid)| Region {
        name: format!("layer {k}"),
        solid: solid.apply(*frame),
        medium: k + 1,
    };
    (0..).zip(solids).map(region).collect()
}

/// The distances of copies with some space between their covers.
fn apart(half: Vec3, shell: Vec3) -> Vec3 {
    2.0 * half + 4.0 * shell + Vec3::splat(0.1)
}

/// Rays that are scattered from face to face.
#[test]
fn layers_from_their_surfaces() {
    let mut tally = Tally::new("layers from their surfaces");
    for seed in 0..120 {
        let rng = &mut Random::new(9 << 40 | seed);
        let frame = match rng.below(3) {
            0 => Affine::rotation(rng.direction(), 30.0),
            _ => Affine::IDENTITY,
        };
        let regions = layers(rng, &frame);
        let ray = |_| {
            let from = Vec3::new(rng.between(-1.0, 8.0), rng.between(-1.0, 4.0), rng.between(-1.0, 1.0));
            Ray::new(from, rng.direction()).transformed(&frame)
        };
        let rays = (0..40).map(ray).collect();
        let Some(setting) = Setting::new(regions, rays, format!("layers, seed {seed}")) else { continue };
        starts::follow(&setting, levels()[seed as usize % 2], rng, &mut tally);
    }
    tally.finish(15_000);
}
