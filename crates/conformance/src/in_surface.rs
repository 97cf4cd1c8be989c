//! Rays that lie in faces and along edges: the answer is that of the ray moved slightly in one fixed
//! direction.

use crate::laws::nothing_of;
use crate::models::{block, compiled, motion, shape, solid};
use crate::rays::batch;
use crate::{Effort, Model, Random, Style, Tally, list};
use rayweave_math::{Affine, PERTURBATION_DIRECTION, Vec3};
use rayweave_model::{Crossing, Evaluator, Program, Query, Solid, Window};
use rayweave_shape::Ray;
use std::sync::Arc;

/// Models of planes on a grid, rotated as a whole, and rays along the lines of that grid. Compares the answer
/// with that of the ray moved by 1e-4 of a cell, except for pieces shorter than a thousandth.
pub fn as_if_moved<E: Evaluator>(make: impl Fn(Arc<Program>) -> E, effort: Effort) {
    let mut tally = Tally::new("rays in faces answered as if moved");
    let rounds = 400 * effort.times();
    for seed in 0..rounds {
        let mut rng = Random::new(8_000_000 + seed);
        let frame = if rng.chance(0.3) { Affine::IDENTITY } else { motion(&mut rng) };
        let depth = rng.below(6);
        let model = Model::of(solid(&mut rng, Style::Planes, depth).apply(frame));
        let evaluator = make(model.compiled());
        let rays: Vec<Ray> = (0..40).map(|_| grid_ray(&mut rng).transformed(&frame)).collect();
        // the displacement is always below a sixteenth of the smallest cell
        let moved: Vec<Ray> =
            rays.iter().map(|r| Ray::new(r.origin + 1e-4 * PERTURBATION_DIRECTION, r.direction)).collect();
        // a ray that only rounding keeps from being parallel to a plane crosses it far away, if at all
        let window = Window::new(-30.0, 30.0).unwrap_or_default();
        let query = Query { window, ..Query::default() };
        let here = evaluator.collect(batch(&rays).rays(), &query).unwrap();
        let there = evaluator.collect(batch(&moved).rays(), &query).unwrap();
        for i in 0..rays.len() {
            let (l, r) = (without_slivers(here.of(i)), without_slivers(there.of(i)));
            let near = |(a, b): (&Crossing, &Crossing)| {
                (a.t - b.t).abs() < 1e-3 && (a.before, a.after) == (b.before, b.after)
            };
            let same = here.starts[i] == there.starts[i] && l.len() == r.len() && l.iter().zip(&r).all(near);
            tally.check(same, || {
                format!("seed {seed}: {:?}\n{model}frame {frame:?}{}\nmoved{}", rays[i], list(&l), list(&r))
            });
        }
    }
    tally.finish(rounds * 20);
}

/// A ray along a line of the grid, in a face, along an edge or through corners.
pub(crate) fn grid_ray(rng: &mut Random) -> Ray {
    let mut grid = || 0.5 * (rng.below(13) as f64 - 6.0);
    let origin = Vec3::new(grid(), grid(), grid());
    let mut direction = Vec3::ZERO;
    direction[rng.below(3)] = rng.pick(&[1.0, -1.0]);
    if rng.chance(0.3) {
        direction[rng.below(3)] = rng.pick(&[1.0, -1.0]);
    }
    Ray::new(origin, direction)
}

/// Removes pairs of crossings less than 1e-3 apart that cancel: the ray cuts off a corner there.
fn without_slivers(crossings: &[Crossing]) -> Vec<Crossing> {
    let mut kept: Vec<Crossing> = Vec::new();
    for &crossing in crossings {
        match kept.last() {
            Some(last) if crossing.t - last.t < 1e-3 && last.before == crossing.after => {
                kept.pop();
            }
            _ => kept.push(crossing),
        }
    }
    kept
}

/// The consequence for two solids in contact, made and placed in different ways: along the shared face their
/// union is solid and their intersection empty, and the difference is the first of them.
pub fn in_shared_faces<E: Evaluator>(make: impl Fn(Arc<Program>) -> E, effort: Effort) {
    let mut tally = Tally::new("rays in shared faces and along shared edges");
    for seed in 0..1500 * effort.times() {
        let mut rng = Random::new(9_000_000 + seed);
        let frame = motion(&mut rng);
        let (one, other) = (cell(&mut rng, Vec3::ZERO), cell(&mut rng, Vec3::X));
        let along = rng.pick(&[Vec3::Y, -Vec3::Y, Vec3::Z, Vec3::new(0.0, 1.0, 1.0)]);
        let start = Vec3::new(1.0, rng.between(0.2, 0.8), rng.between(0.2, 0.8)) - 3.0 * along;
        let ray = Ray::new(start, along).transformed(&frame);
        let count = |solid: Solid| {
            make(compiled(Program::compile(&solid.apply(frame))))
                .one(ray, &Query::default())
                .unwrap()
                .crossings
        };
        let mut check = |name, solid: Solid, expected: &dyn Fn(&[Crossing]) -> bool| {
            let found = count(solid);
            let message =
                || format!("seed {seed}, {name}: {one:?} and {other:?} in {frame:?}{}", list(&found));
            tally.check(expected(&found), message);
        };
        let both = |found: &[Crossing]| found.len() == 2;
        check("A | B", &one | &other, &both);
        check("B | A", &other | &one, &both);
        check("A & B", &one & &other, &|found| found.is_empty());
        check("~(A & B)", !(&one & &other), &|found| found.is_empty());
        check("~(~A & ~B)", !(!&one & !&other), &both);
        let alone = |a: &Solid, b: &Solid| count(a | nothing_of(b));
        let (alone_one, alone_other) = (alone(&one, &other), alone(&other, &one));
        let times = |list: &[Crossing]| list.iter().map(|c| c.t.to_bits()).collect::<Vec<_>>();
        check("A - B", &one - &other, &|found| times(found) == times(&alone_one));
        check("B - A", &other - &one, &|found| times(found) == times(&alone_other));
        check("A ^ B", &one ^ &other, &both);
        // exactly one of the two contains the ray
        check("A or B", &one | &other, &|_| alone_one.len() + alone_other.len() == 2);
    }
    tally.finish(10_000 * effort.times());
}

/// A unit box with its lower corner at `lo`, made in one of several ways: moved, rotated, mirrored, scaled,
/// as an intersection, or as one of two instances (the other one is far away).
fn cell(rng: &mut Random, lo: Vec3) -> Solid {
    let middle = lo + Vec3::splat(0.5);
    let unit = shape("box", &[("size", 1.0)]);
    let axis = rng.pick(&[Vec3::X, Vec3::Y, Vec3::Z]);
    let turn = Affine::rotation(axis, rng.pick(&[90.0, 180.0, -90.0]));
    let away = Affine::translate(Vec3::splat(50.0));
    match rng.below(7) {
        0 => block(lo, lo + Vec3::ONE),
        1 => {
            unit.translate(rng.point(10.0)).apply(Affine::IDENTITY) & Solid::empty() | unit.translate(middle)
        }
        2 => unit.apply(turn).translate(middle),
        3 => unit.mirror(axis).translate(middle),
        4 => shape("box", &[("size", 0.125)]).scale(Vec3::splat(8.0)).translate(middle),
        5 => unit.place([turn.then(&Affine::translate(middle)), away]),
        _ => {
            let by = rng.point(5.0);
            unit.translate(by)
                .place([turn, away])
                .apply(turn.inverse().unwrap_or(turn))
                .translate(middle - by)
        }
    }
}

/// Tests that a fan of wedges is solid along its axis, and a stack of boxes along its common edge.
pub fn along_shared_edges<E: Evaluator>(make: impl Fn(Arc<Program>) -> E, effort: Effort) {
    let mut tally = Tally::new("rays along common edges");
    for seed in 0..1500 * effort.times() {
        let mut rng = Random::new(10_000_000 + seed);
        let frame = motion(&mut rng);
        let whole = if rng.chance(0.5) { fan(&mut rng) } else { quarters(&mut rng) };
        let ray = Ray::new(Vec3::new(0.0, 0.0, -5.0), Vec3::Z).transformed(&frame);
        let program = compiled(Program::compile(&whole.apply(frame)));
        let found = make(program).one(ray, &Query::default()).unwrap().crossings;
        let right = found.len() == 2 && (found[0].t - 4.0).abs() < 1e-9 && (found[1].t - 6.0).abs() < 1e-9;
        tally.check(right, || format!("seed {seed}: {whole:?} in {frame:?}{}", list(&found)));
    }
    tally.finish(1000 * effort.times());
}

/// Wedges between shuffled angles, cut to height 2.
pub(crate) fn fan(rng: &mut Random) -> Solid {
    let count = 2 + rng.below(7);
    let mut angles: Vec<f64> = (0..count).map(|_| rng.between(-180.0, 180.0)).collect();
    angles.sort_by(f64::total_cmp);
    let rod = shape("cylinder", &[("radius", 1.0), ("height", 2.0)]);
    let wedges: Vec<Solid> = (0..count)
        .map(|k| {
            let next = if k + 1 < count { angles[k + 1] } else { angles[0] + 360.0 };
            shape("wedge", &[("start_degrees", angles[k]), ("sweep_degrees", next - angles[k])])
        })
        .collect();
    let pieces = rng.order(count).into_iter().map(|k| &wedges[k] & &rod);
    Solid::union(pieces)
}

/// Four boxes of height 2 around the z axis.
fn quarters(rng: &mut Random) -> Solid {
    let boxes: Vec<Solid> = (0..4)
        .map(|k| {
            let quarter = block(Vec3::new(0.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0));
            match rng.below(3) {
                0 => quarter.rotate_z(90.0 * f64::from(k)),
                1 => {
                    let turn = Affine::rotation(Vec3::Z, 90.0 * f64::from(k));
                    quarter.place([turn, turn.then(&Affine::translate(Vec3::splat(9.0)))])
                }
                _ => quarter.rotate_z(90.0 * f64::from(k) - 77.0).rotate_z(77.0),
            }
        })
        .collect();
    Solid::union(rng.order(4).into_iter().map(|k| boxes[k].clone()))
}
