//! Contacts of volumes, found by random lines.

use crate::lines::random_line;
use crate::philox::{Purpose, Stream};
use rayweave_math::Bounds;
use rayweave_model::{Crossing, Evaluator, Query, RayAnswer, RayBatch};
use std::collections::{BTreeMap, BTreeSet};

/// The number of lines in all, and the least and the largest number of lines for one volume.
const LINES: u64 = 1 << 16;
const LEAST: u64 = 1 << 6;
const MOST: u64 = 1 << 12;

/// The largest number of volumes whose boxes lines pass through.
const VOLUMES: usize = 1 << 12;

/// The pairs of regions between which lines cross a boundary, in the direction of the line, with the numbers of the optical surfaces
/// there (`None` for none).
pub(super) type Contacts = BTreeMap<(u32, u32), BTreeSet<Option<usize>>>;

/// The contacts that random lines find. The lines pass through the box of each region, so that a contact is missed with a probability
/// that falls with its part of the box. `surface` returns the number of the surface at a crossing.
pub(super) fn contacts<E: Evaluator>(
    evaluator: &E,
    boxes: &[Bounds],
    surface: impl Fn(&Crossing) -> Option<usize>,
) -> Contacts {
    let bounded = boxes.iter().filter(|own| own.is_finite() && !own.is_empty()).take(VOLUMES);
    let bounded: Vec<&Bounds> = bounded.collect();
    let each = (LINES / bounded.len().max(1) as u64).clamp(LEAST, MOST);
    let mut rays = RayBatch::default();
    for (volume, own) in (0..).zip(bounded) {
        for number in 0..each {
            rays.push(random_line(own, &mut Stream::new(volume, number, 0, Purpose::Position)));
        }
    }
    let mut found = Contacts::new();
    let mut sink = |answer: RayAnswer<'_>| {
        for crossing in answer.crossings.iter().filter(|own| own.before.0 != 0 && own.after.0 != 0) {
            found.entry((crossing.before.0, crossing.after.0)).or_default().insert(surface(crossing));
        }
    };
    evaluator.crossings(rays.rays(), &Query::default(), &mut evaluator.scratch(), &mut sink);
    found
}
