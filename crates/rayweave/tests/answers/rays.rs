//! Hashes of ray queries.

use crate::hash::Hash;
use rayweave::math::{Bounds, Vec3};
use rayweave::model::{FirstHitColumns, RayBatch, Rays};
use rayweave::{Crossing, Evaluator, Packets, Program, Query, Ray, Window};
use std::sync::Arc;

/// Hashes the bounds of a program, and crossings, nearest hits with normals and partitions of rays through
/// it.
pub fn answers(hash: &mut Hash, program: &Arc<Program>, rays: Rays<'_>) {
    let evaluator = Packets::new(program.clone());
    let bounds = program.bounds();
    hash.numbers(bounds.lo.as_ref());
    hash.numbers(bounds.hi.as_ref());
    let found = evaluator.collect(rays, &Query::default()).unwrap();
    found.offsets.iter().for_each(|offset| hash.count(*offset as u64));
    found.starts.iter().for_each(|region| hash.count(u64::from(program.medium_of(*region))));
    found.crossings.iter().for_each(|crossing| add_crossing(hash, program, crossing));
    nearest(hash, &evaluator, rays);
}

/// Adds all fields of a crossing.
pub fn add_crossing(hash: &mut Hash, program: &Program, crossing: &Crossing) {
    hash.number(crossing.t);
    for face in [crossing.face, crossing.left, crossing.entered] {
        hash.count(u64::from(face.leaf.0));
        hash.count(u64::from(face.facet));
        hash.count(u64::from(face.placement.0));
    }
    for region in [crossing.before, crossing.after] {
        hash.count(u64::from(region.0));
        hash.count(u64::from(program.medium_of(region)));
    }
}

/// Adds the nearest hits with their normals.
fn nearest<E: Evaluator>(hash: &mut Hash, evaluator: &E, rays: Rays<'_>) {
    let mut found = FirstHitColumns::new(rays.len());
    let window = Window::new(0.0, f64::INFINITY).unwrap();
    evaluator.nearest(rays, window, &mut evaluator.scratch(), &mut found.hits());
    hash.numbers(&found.t);
    found.normal.iter().for_each(|column| hash.numbers(column));
    for column in [found.placement, found.before, found.after] {
        column.into_iter().for_each(|value| hash.count(u64::from(value)));
    }
    found.face.into_iter().for_each(|value| hash.count(value as u64));
}

/// Rays between points in and around a box: a Weyl sequence of square roots, so no random numbers are needed.
pub fn through(bounds: &Bounds, count: usize) -> RayBatch {
    let side =
        |lo: f64, hi: f64| if lo.is_finite() && hi.is_finite() && lo < hi { (lo, hi) } else { (-10.0, 10.0) };
    let sides = [0, 1, 2].map(|k| side(bounds.lo[k], bounds.hi[k]));
    let steps = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0].map(f64::sqrt);
    let place = |k: usize, axis: usize, step: f64| {
        let (lo, hi) = sides[axis];
        let part = ((k + 1) as f64 * step).fract();
        lo + (1.2 * part - 0.1) * (hi - lo)
    };
    let point =
        |k: usize, first: usize| Vec3::from([0, 1, 2].map(|axis| place(k, axis, steps[first + axis])));
    (0..count).map(|k| Ray::new(point(k, 0), point(k, 3) - point(k, 0))).collect()
}
