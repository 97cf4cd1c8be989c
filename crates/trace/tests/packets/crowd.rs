//! Unions of many small solids that touch or nearly touch, and bundles of rays.

use crate::aim::{Target, aimed};
use crate::arrange::{cube, cylinder, gap, sphere};
use rayweave_conformance::Random;
use rayweave_conformance::models::shape;
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Region, Solid};
use rayweave_shape::Ray;

/// One to three regions of 20 to 39 solids each, on a grid of unit cubes or anywhere.
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

/// A plate, a block or an intersection of unions, minus 20 to 49 solids on a grid; or two copies of it.
pub fn carved(rng: &mut Random, frame: &Affine) -> (Vec<Region>, Vec<Target>) {
    let place = |rng: &mut Random| Vec3::new(rng.below(5) as f64 - 2.0, rng.below(5) as f64 - 2.0, 0.0);
    let plate = cube(Vec3::new(2.5, 2.5, rng.pick(&[0.25, 0.5, 1.0])));
    let beside = |rng: &mut Random| member(rng).translate(2.0 * rng.pick(&Vec3::AXES));
    let mut solid = plate | beside(rng) | member(rng).translate([0.0, 0.0, 0.75]);
    if rng.chance(0.5) {
        solid = solid & (sphere(rng.pick(&[2.0, 2.5])) | cylinder(0.5, f64::INFINITY));
    }
    let holes = (0..20 + rng.below(30)).map(|_| {
        let at = place(rng) + gap(rng) * rng.pick(&Vec3::AXES);
        let hole = if rng.chance(0.5) { cylinder(rng.pick(&[0.25, 0.5]), 2.0) } else { single(rng) };
        hole.translate(at)
    });
    let mut solid = solid - Solid::union(holes.collect::<Vec<_>>());
    if rng.chance(0.3) {
        let turn = Affine::rotation(rng.pick(&Vec3::AXES), 90.0);
        solid = solid.place([Affine::IDENTITY, turn.then(&Affine::translate(Vec3::new(0.0, 0.0, 1.5)))]);
    }
    let region = Region { name: "carved".to_owned(), solid: solid.apply(*frame), medium: 1 };
    let target = |rng: &mut Random| {
        let axis = rng.below(3);
        let (normal, along) = (Vec3::AXES[axis], Vec3::AXES[(axis + 1) % 3]);
        let point = place(rng) + rng.pick(&[0.25, 0.5]) * normal + rng.pick(&[0.0, 0.5, 0.1]) * along;
        Target::new(point, normal, along)
    };
    (vec![region], (0..8).map(|_| target(rng)).collect())
}

/// A primitive of about the size of a unit cube.
fn single(rng: &mut Random) -> Solid {
    match rng.below(5) {
        0 => sphere(0.5),
        1 => cube(Vec3::splat(0.5)),
        2 => shape("cone", &[("radius1", 0.5), ("radius2", rng.pick(&[0.0, 0.25])), ("height", 1.0)]),
        3 => shape("torus", &[("major", 0.5), ("minor", 0.25)]),
        _ => shape("tube", &[("inner_radius", 0.25), ("outer_radius", 0.5), ("height", 2.0)]),
    }
}

/// A solid of about the size of a unit cube.
pub fn member(rng: &mut Random) -> Solid {
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

/// Rays in bundles of eight that are close to each other, some of them bitwise equal.
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
