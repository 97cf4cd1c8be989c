//! Contacts of volumes, found by random lines.

use crate::lines::random_line;
use crate::philox::{Purpose, Stream};
use rayweave_math::Bounds;
use rayweave_model::{Evaluator, Query, RayAnswer, RayBatch};
use std::collections::BTreeSet;

/// The number of lines in all, and the least and the largest number of lines for one volume.
const LINES: u64 = 1 << 16;
const LEAST: u64 = 1 << 6;
const MOST: u64 = 1 << 12;

/// The largest number of volumes whose boxes lines pass through.
const VOLUMES: usize = 1 << 12;

/// The pairs of regions between which random lines cross a boundary, in the direction of the line. The lines pass through the box of
/// each region, so that a contact is missed with a probability that falls with its part of the box.
pub(super) fn contacts<E: Evaluator>(evaluator: &E, boxes: &[Bounds]) -> BTreeSet<(u32, u32)> {
    let bounded = boxes.iter().filter(|own| own.is_finite() && !own.is_empty()).take(VOLUMES);
    let bounded: Vec<&Bounds> = bounded.collect();
    let each = (LINES / bounded.len().max(1) as u64).clamp(LEAST, MOST);
    let mut rays = RayBatch::default();
    for (volume, own) in (0..).zip(bounded) {
        for number in 0..each {
            rays.push(random_line(own, &mut Stream::new(volume, number, 0, Purpose::Position)));
        }
    }
    let mut found = BTreeSet::new();
    let mut sink = |answer: RayAnswer<'_>| {
        let pairs = answer.crossings.iter().map(|crossing| (crossing.before.0, crossing.after.0));
        found.extend(pairs.filter(|(before, after)| *before != 0 && *after != 0));
    };
    evaluator.crossings(rays.rays(), &Query::default(), &mut evaluator.scratch(), &mut sink);
    found
}
