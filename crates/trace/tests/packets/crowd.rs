//! Many small solids, united, that touch or nearly do; and bundles of rays.

use crate::aim::{Target, aimed};
use crate::arrange::{cube, cylinder, gap, sphere};
use rayweave_conformance::Random;
use rayweave_conformance::models::shape;
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Region, Solid};
use rayweave_shape::Ray;

/// One or some regions of twenty to eighty solids on a grid of unit cubes, or anywhere.
pub fn crowd(rng: &mut Random, frame: &Affine) -> (Vec<Region>, Vec<Target>) {
    let on_grid = rng.chance(0.6);
    let place = |rng: &mut Random| match on_grid {
        true => Vec3::new(rng.below(5) as f64 - 2.0, rng.below(5) as f64 - 2.0, rng.below(3) as f64 - 1.0),
        false => rng.point(2.5),
    };
    let count = 1 + rng.below(3);
    let solids: Vec<Solid> = (0..count)
        .map(|_| {
            let parts = (0..20 + rng.below(20)).map(|_| {
                let at = place(rng) + gap(rng) * rng.pick(&Vec3::AXES);
                member(rng).translate(at)
            });
            Solid::union(parts.collect::<Vec<_>>())
        })
        .collect();
    let region = |(k, solid): (usize, &Solid)| Region {
        name: format!("crowd {k}"),
        solid: solid.apply(*frame),
        medium: 1 + rng.below(2) as u32,
    };
    let regions = solids.iter().enumerate().map(region).collect();
    let target = |rng: &mut Random| {
        let axis = rng.below(3);
        let (normal, along) = (Vec3::AXES[axis], Vec3::AXES[(axis + 1) % 3]);
        let point = place(rng) + 0.5 * normal + rng.pick(&[0.0, 0.5, 0.1]) * along;
        Target::new(point, normal, along)
    };
    (regions, (0..8).map(|_| target(rng)).collect())
}

/// A solid of about the size of a unit cube.
fn member(rng: &mut Random) -> Solid {
    let bore = |rng: &mut Random| cylinder(rng.pick(&[0.25, 0.5]), 2.0);
    match rng.below(8) {
        0..2 => sphere(0.5),
        2..4 => cube(Vec3::splat(0.5)),
        4 => cube(Vec3::splat(0.5)) - bore(rng),
        5 => sphere(0.7) & cube(Vec3::splat(0.5)),
        6 => shape("cone", &[("radius1", 0.5), ("radius2", 0.0), ("height", 1.0)]) - bore(rng),
        _ => bore(rng).rotate_x(90.0),
    }
}

/// Rays in bundles of eight that hardly go apart, some of them equal to the bit.
pub fn bundles(rng: &mut Random, targets: &[Target], count: usize) -> Vec<Ray> {
    let mut rays = Vec::with_capacity(count);
    while rays.len() < count {
        let lead = aimed(rng, targets);
        let length = lead.direction.length();
        let (apart, turn) = (rng.magnitude(-12.0, -1.0), rng.magnitude(-12.0, -1.5));
        for _ in 0..8 {
            let origin = lead.origin + apart * rng.point(1.0);
            let direction = lead.direction + length * turn * rng.point(1.0);
            rays.push(rng.pick(&[lead, Ray::new(origin, lead.direction), Ray::new(origin, direction)]));
        }
    }
    rays.truncate(count);
    rays
}
