//! Solids in contact need no gap or overlap: for any way of making and placing each of them, any order of
//! operands, any rotation of the whole, and any angle of the ray to the shared face.

use crate::models::{block, compiled, motion, shape};
use crate::rays::batch;
use crate::{Effort, Random, Tally, list};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{CompileError, Crossing, Evaluator, Program, Query, Region, RegionId, Solid};
use rayweave_shape::Ray;
use rayweave_shape::surface::delta;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Solids in contact, and equivalent solids without shared faces.
struct Case {
    name: &'static str,
    regions: Vec<Solid>,
    expected: Vec<Solid>,
    /// Draws a point in a shared face and the normal there.
    seam: fn(&mut Random) -> (Vec3, Vec3),
}

type Make = fn(&mut Random) -> Case;

const CASES: &[Make] =
    &[tiles, common_faces, equal_boxes, doublet, shells, wedges, rods, frusta, touching_pair];

/// Traces rays through points of shared faces, at angles from 1 to 1e-12, and compares with the equivalent
/// model without those faces: the same number of crossings between the same regions, each on the expected
/// surface.
pub fn at_any_angle<E: Evaluator>(make: impl Fn(Arc<Program>) -> E, effort: Effort) {
    let mut tally = Tally::new("rays through touching faces");
    for seed in 0..effort.of(3_000, 250_000) {
        let mut rng = Random::new(11_000_000 + seed);
        let case = CASES[seed as usize % CASES.len()](&mut rng);
        let far = rng.pick(&[0.0, 0.0, 10.0, 1e3]);
        let frame = motion(&mut rng).then(&Affine::translate(far * rng.direction()));
        let ours = make(compiled(regions(&case.regions, &frame)));
        let theirs = make(compiled(regions(&case.expected, &frame)));
        let rays: Vec<Ray> = (0..40).map(|_| seam_ray(&mut rng, &case, &frame)).collect();
        let found = ours.collect(batch(&rays).rays(), &Query::default()).unwrap();
        let expected = theirs.collect(batch(&rays).rays(), &Query::default()).unwrap();
        for (i, ray) in rays.iter().enumerate() {
            let (l, r) = (without_grazes(found.of(i), ray), without_grazes(expected.of(i), ray));
            let same = found.starts[i] == expected.starts[i]
                && l.len() == r.len()
                && l.iter().zip(&r).all(|(a, b)| agree(theirs.program(), ray, a, b));
            tally.check(same, || {
                let lists = (list(found.of(i)), list(expected.of(i)));
                let regions = &case.regions;
                format!(
                    "seed {seed}, ray {i}, {}: {ray:?}\n{regions:?}\nin {frame:?}{}\nexpected{}",
                    case.name, lists.0, lists.1
                )
            });
        }
    }
    tally.finish(effort.of(100_000, 9_000_000));
}

fn regions(solids: &[Solid], frame: &Affine) -> Result<Program, CompileError> {
    let region = |(k, s): (usize, &Solid)| Region {
        name: format!("r{k}"),
        solid: s.apply(*frame),
        medium: k as u32 + 1,
    };
    let regions: Vec<Region> = solids.iter().enumerate().map(region).collect();
    Program::compile_regions(&regions)
}

/// A ray through a point of the seam, with a slope to it between -1 and 1.
fn seam_ray(rng: &mut Random, case: &Case, frame: &Affine) -> Ray {
    let (point, normal) = (case.seam)(rng);
    let along = rng.direction().cross(normal).normalize();
    // in a distant frame smaller angles are within rounding of 0
    let least = (1e-12 * (1.0 + frame.translation.length())).max(1e-12);
    let angle = match rng.below(3) {
        0 => rng.magnitude(libm::log10(least), -6.0),
        1 => rng.magnitude(-6.0, 0.0),
        _ => rng.between(-1.0, 1.0),
    };
    let direction = (along + angle * normal) * rng.pick(&[1.0, 1.0, 3.7, 1e-3]);
    let origin = point - rng.between(-9.0, 9.0) * direction;
    Ray::new(origin, direction).transformed(frame)
}

/// Removes the crossings of a ray nearly tangent to a curved face: the piece cut off is too thin to be
/// guaranteed.
fn without_grazes(crossings: &[Crossing], ray: &Ray) -> Vec<Crossing> {
    // the sagitta of such a chord is at most about a thousand delta
    let limit = 1e-5 * (1.0 + ray.origin.length()).sqrt();
    let mut kept: Vec<Crossing> = Vec::new();
    for &crossing in crossings {
        let undone = |last: &Crossing| {
            let inside = last.before != RegionId(0) && last.after != RegionId(0);
            inside && last.before == crossing.after && (crossing.t - last.t) * ray.direction.length() < limit
        };
        match kept.last() {
            Some(last) if undone(last) => {
                kept.pop();
            }
            _ => kept.push(crossing),
        }
    }
    kept
}

/// True for the same change of region on the expected surface.
fn agree(expected: &Program, ray: &Ray, found: &Crossing, wanted: &Crossing) -> bool {
    let entry = expected.surface(wanted.face.surface);
    let (value, gradient) = entry.surface.value_and_gradient(ray.at(found.t));
    let near = value.abs() <= 8.0 * delta(entry.magnitude + 20.0, ray, found.t) * gradient.length();
    near && (found.before, found.after) == (wanted.before, wanted.after)
}

/// A solid moved by `by`, in one of several ways that differ by rounding.
fn moved(rng: &mut Random, solid: &Solid, by: Vec3) -> Solid {
    let detour = rng.point(4.0);
    let turn = Affine::rotation(rng.direction(), rng.between(-180.0, 180.0));
    let back = turn.inverse().unwrap_or(turn);
    match rng.below(6) {
        0..2 => solid.translate(by),
        2 => solid.translate(detour).translate(by - detour),
        3 => solid.apply(turn).translate(detour).apply(back).translate(by - back.vector(detour)),
        4 => solid.apply(turn.then(&back)).translate(by),
        // two copies in the same place
        _ => solid.place([
            Affine::translate(by),
            turn.then(&back).then(&Affine::translate(detour)).then(&Affine::translate(by - detour)),
        ]),
    }
}

/// The box between two corners, made in one of several ways.
fn made_box(rng: &mut Random, lo: Vec3, hi: Vec3) -> Solid {
    let (size, middle) = (hi - lo, 0.5 * (lo + hi));
    match rng.below(4) {
        0 => block(lo, hi),
        1 => moved(rng, &block(-0.5 * size, 0.5 * size), middle),
        2 => moved(rng, &shape("box", &[("size", 1.0)]).scale(size), middle),
        _ => moved(rng, &block(Vec3::ZERO, size), lo),
    }
}

fn shuffled(rng: &mut Random, parts: Vec<Solid>) -> Solid {
    let order = rng.order(parts.len());
    let parts = order.into_iter().map(|k| parts[k].clone());
    match rng.below(3) {
        0 => Solid::union(parts),
        1 => parts.reduce(|a, b| a | b).unwrap_or_else(Solid::empty),
        _ => !Solid::intersection(parts.map(|s| !s)),
    }
}

fn tiles(rng: &mut Random) -> Case {
    let size = Vec3::new(1.0, 0.7, 0.3);
    let mut parts = Vec::new();
    for x in 0..3 {
        for y in 0..2 {
            let lo = size * Vec3::new(f64::from(x), f64::from(y), 0.0);
            parts.push(made_box(rng, lo, lo + size));
        }
    }
    Case {
        name: "tiles",
        regions: vec![shuffled(rng, parts)],
        expected: vec![block(Vec3::ZERO, size * Vec3::new(3.0, 2.0, 1.0))],
        seam: |rng| match rng.below(2) {
            0 => (Vec3::new(rng.pick(&[1.0, 2.0]), rng.between(0.1, 0.6), rng.between(0.05, 0.25)), Vec3::X),
            _ => (Vec3::new(rng.between(0.1, 0.9), 0.7, rng.between(0.05, 0.25)), Vec3::Y),
        },
    }
}

/// `box - box` with five faces in common.
fn common_faces(rng: &mut Random) -> Case {
    let (a, b) = (
        made_box(rng, Vec3::ZERO, Vec3::new(2.0, 1.0, 1.0)),
        made_box(rng, Vec3::X, Vec3::new(2.0, 1.0, 1.0)),
    );
    let whole = match rng.below(3) {
        0 => &a - &b,
        1 => !(!&a | &b),
        _ => &a & !(&b & &a),
    };
    Case {
        name: "box - box",
        regions: vec![whole],
        expected: vec![block(Vec3::ZERO, Vec3::ONE)],
        seam: |rng| match rng.below(3) {
            0 => (Vec3::new(rng.between(1.1, 1.9), 1.0, rng.between(0.1, 0.9)), Vec3::Y),
            1 => (Vec3::new(rng.between(1.1, 1.9), rng.between(0.1, 0.9), 0.0), Vec3::Z),
            _ => (Vec3::new(2.0, rng.between(0.1, 0.9), rng.between(0.1, 0.9)), Vec3::X),
        },
    }
}

/// The same box made twice: the difference is empty, and the union is the box.
fn equal_boxes(rng: &mut Random) -> Case {
    let (lo, hi) = (Vec3::ZERO, Vec3::new(1.0, 0.8, 0.6));
    let (a, b) = (made_box(rng, lo, hi), made_box(rng, lo, hi));
    let (whole, expected) = match rng.below(6) {
        0 => (&a - &b, Solid::empty()),
        1 => (&a ^ &b, Solid::empty()),
        2 => (&a & &b, block(lo, hi)),
        3 => (&a | &b, block(lo, hi)),
        4 => (!&a | &b, Solid::universe()),
        _ => ((&a ^ &b) ^ &a, block(lo, hi)),
    };
    // a distant box, so that neither model is empty
    let far = block(Vec3::splat(40.0), Vec3::splat(41.0));
    Case {
        name: "equal boxes",
        regions: vec![whole | far.clone()],
        expected: vec![expected | far],
        seam: |rng| (Vec3::new(rng.between(0.1, 0.9), rng.between(0.1, 0.7), rng.pick(&[0.0, 0.6])), Vec3::Z),
    }
}

/// A cemented doublet: two lenses made separately, with one spherical face in common.
fn doublet(rng: &mut Random) -> Case {
    let sphere = |rng: &mut Random, radius: f64, z: f64| {
        moved(rng, &shape("sphere", &[("radius", radius)]), Vec3::new(0.0, 0.0, z))
    };
    let rim = |rng: &mut Random| moved(rng, &shape("cylinder", &[("radius", 0.8)]), Vec3::new(0.0, 0.0, 0.3));
    let front = sphere(rng, 2.0, 1.7) & sphere(rng, 3.0, -2.6) & rim(rng);
    let back = (sphere(rng, 4.0, -3.2) - sphere(rng, 3.0, -2.6)) & rim(rng);
    let plain = |radius: f64, z: f64| shape("sphere", &[("radius", radius)]).translate([0.0, 0.0, z]);
    let whole = (plain(2.0, 1.7) & plain(4.0, -3.2)) & shape("cylinder", &[("radius", 0.8)]);
    let seam = |rng: &mut Random| {
        let (angle, rho) = (rng.between(0.0, TAU), rng.between(0.05, 0.7));
        let height = (9.0 - rho * rho).sqrt();
        let outward = Vec3::new(rho * libm::cos(angle), rho * libm::sin(angle), height) / 3.0;
        (Vec3::new(0.0, 0.0, -2.6) + 3.0 * outward, outward)
    };
    if rng.chance(0.5) {
        let order = if rng.chance(0.5) { front | back } else { back | front };
        return Case { name: "doublet as one", regions: vec![order], expected: vec![whole], seam };
    }
    let rest = &whole - &plain(3.0, -2.6);
    Case { name: "doublet", regions: vec![front, back], expected: vec![whole, rest], seam }
}

/// A ball in a shell whose inner radius equals that of the ball.
fn shells(rng: &mut Random) -> Case {
    let sphere = |radius: f64| shape("sphere", &[("radius", radius)]);
    let (ball, hole) = (moved(rng, &sphere(1.0), Vec3::Y), moved(rng, &sphere(1.0), Vec3::Y));
    let shell = moved(rng, &sphere(2.0), Vec3::Y) - hole;
    let whole = shuffled(rng, vec![ball, shell]);
    Case {
        name: "ball in shell",
        regions: vec![whole],
        expected: vec![sphere(2.0).translate(Vec3::Y)],
        seam: |rng| {
            let outward = rng.direction();
            (Vec3::Y + outward, outward)
        },
    }
}

/// Wedges around an axis, in steps of 40 degrees.
fn wedges(rng: &mut Random) -> Case {
    let rod = |rng: &mut Random| {
        let rod = shape("cylinder", &[("radius", 1.0), ("height", 2.0)]);
        let turn = rng.between(-180.0, 180.0);
        if rng.chance(0.5) { rod.rotate_z(turn) } else { rod }
    };
    let parts = (0..9)
        .map(|k| {
            let start = 40.0 * f64::from(k);
            let turn = rng.between(-180.0, 180.0);
            let wedge = match rng.below(3) {
                0 => shape("wedge", &[("start_degrees", start), ("sweep_degrees", 40.0)]),
                1 => {
                    let wedge = shape("wedge", &[("start_degrees", start - turn), ("sweep_degrees", 40.0)]);
                    wedge.rotate_z(turn)
                }
                _ => shape("wedge", &[("start_degrees", 0.0), ("sweep_degrees", 40.0)]).rotate_z(start),
            };
            moved(rng, &wedge, Vec3::ZERO) & rod(rng)
        })
        .collect();
    Case {
        name: "wedges",
        regions: vec![shuffled(rng, parts)],
        expected: vec![shape("cylinder", &[("radius", 1.0), ("height", 2.0)])],
        seam: |rng| {
            let angle = 40.0 * rng.below(9) as f64;
            let turn = Affine::rotation(Vec3::Z, angle);
            let here = Vec3::new(rng.between(0.1, 0.9), 0.0, rng.between(-0.9, 0.9));
            (turn.point(here), turn.vector(Vec3::Y))
        },
    }
}

/// Cylinders of equal radius on top of each other.
fn rods(rng: &mut Random) -> Case {
    let heights = [0.3, 1.1, 0.7];
    let mut z = -1.05;
    let mut parts = Vec::new();
    for height in heights {
        let rod = shape("cylinder", &[("radius", 0.9), ("height", height)]);
        let mirrored = if rng.chance(0.5) { rod.rotate_x(180.0) } else { rod };
        parts.push(moved(rng, &mirrored, Vec3::new(0.0, 0.0, z + 0.5 * height)));
        z += height;
    }
    Case {
        name: "rods",
        regions: vec![shuffled(rng, parts)],
        expected: vec![shape("cylinder", &[("radius", 0.9), ("height", 2.1)])],
        seam: |rng| {
            let (angle, rho) = (rng.between(0.0, TAU), rng.between(0.0, 0.8));
            let z = rng.pick(&[-0.75, 0.35]);
            (Vec3::new(rho * libm::cos(angle), rho * libm::sin(angle), z), Vec3::Z)
        },
    }
}

/// Two frusta of one cone, end to end.
fn frusta(rng: &mut Random) -> Case {
    let frustum =
        |bottom: f64, top: f64| shape("cone", &[("radius1", bottom), ("radius2", top), ("height", 1.0)]);
    let lower = moved(rng, &frustum(1.5, 1.0), Vec3::new(0.0, 0.0, -0.5));
    let upper = moved(rng, &frustum(1.0, 0.5), Vec3::new(0.0, 0.0, 0.5));
    Case {
        name: "frusta",
        regions: vec![shuffled(rng, vec![lower, upper])],
        expected: vec![shape("cone", &[("radius1", 1.5), ("radius2", 0.5), ("height", 2.0)])],
        seam: |rng| (Vec3::new(rng.between(-0.6, 0.6), rng.between(-0.6, 0.6), 0.0), Vec3::Z),
    }
}

/// Two boxes side by side: their intersection is empty, and their difference is the first one.
fn touching_pair(rng: &mut Random) -> Case {
    let (lo, hi) = (Vec3::new(1.0, 0.0, 0.0), Vec3::new(2.0, 1.0, 1.0));
    let (a, b) = (made_box(rng, Vec3::ZERO, Vec3::ONE), made_box(rng, lo, hi));
    let (one, both) = (block(Vec3::ZERO, Vec3::ONE), block(Vec3::ZERO, hi));
    let far = block(Vec3::splat(40.0), Vec3::splat(41.0));
    let (whole, expected) = match rng.below(5) {
        0 => (&a & &b, Solid::empty()),
        1 => (&a - &b, one),
        2 => (&a ^ &b, both),
        3 => (!(!&a & !&b), both),
        _ => (&a & !&b, one),
    };
    Case {
        name: "two boxes",
        regions: vec![whole | far.clone()],
        expected: vec![expected | far],
        seam: |rng| (Vec3::new(1.0, rng.between(0.1, 0.9), rng.between(0.1, 0.9)), Vec3::X),
    }
}
