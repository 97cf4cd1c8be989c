//! Contacts of volumes, found by random lines.

use crate::lines::random_line;
use crate::philox::{Purpose, Stream};
use rayweave_math::Bounds;
use rayweave_model::{Crossing, Evaluator, Query, RayAnswer, RayBatch, Window};
use rayweave_shape::Ray;
use std::collections::{BTreeMap, BTreeSet};

/// The number of lines in all, and the least and the largest number of lines for one volume.
const LINES: u64 = 1 << 16;
const LEAST: u64 = 1 << 8;
const MOST: u64 = 1 << 12;

/// The number of lines in all above which volumes get fewer than [`LEAST`], and the number that each of them gets in any case.
const MANY_LINES: u64 = 1 << 20;
const FEWEST: u64 = 1 << 4;

/// The margin of a box around a volume, in diagonals: lines end behind the boundary.
const MARGIN: f64 = 1e-3;

/// The pairs of regions between which lines cross a boundary, in the direction of the line, with the numbers of the optical surfaces
/// there (`None` for none).
pub(super) type Contacts = BTreeMap<(u32, u32), BTreeSet<Option<usize>>>;

/// The contacts that random lines find. The lines pass through the box of each region and end at its faces, so that a contact is missed
/// with a probability that falls with its part of the box, and the time is in proportion to the number of regions. `surface` returns
/// the number of the surface at a crossing.
pub(super) fn contacts<E: Evaluator>(
    evaluator: &E,
    boxes: &[Bounds],
    surface: impl Fn(&Crossing) -> Option<usize>,
) -> Contacts {
    let bounded: Vec<&Bounds> = boxes.iter().filter(|own| own.is_finite() && !own.is_empty()).collect();
    let share = |lines: u64| lines / bounded.len().max(1) as u64;
    let each = share(LINES).max(LEAST.min(share(MANY_LINES))).clamp(FEWEST, MOST);
    let mut rays = RayBatch::default();
    for (volume, own) in (0..).zip(bounded) {
        let around = own.grown(MARGIN * own.size().length());
        for number in 0..each {
            let line = random_line(own, &mut Stream::new(volume, number, 0, Purpose::Position));
            piece(&line, &around).into_iter().for_each(|piece| rays.push(piece));
        }
    }
    let mut found = Contacts::new();
    let mut sink = |answer: RayAnswer<'_>| {
        for crossing in answer.crossings.iter().filter(|own| own.before.0 != 0 && own.after.0 != 0) {
            found.entry((crossing.before.0, crossing.after.0)).or_default().insert(surface(crossing));
        }
    };
    // the pieces go from t = 0 to t = 1
    let Ok(window) = Window::new(0.0, 1.0) else { return found };
    let query = Query { window, ..Query::default() };
    evaluator.crossings(rays.rays(), &query, &mut evaluator.scratch(), &mut sink);
    found
}

/// The piece of a line in a box, as a ray from t = 0 to t = 1.
fn piece(line: &Ray, bounds: &Bounds) -> Option<Ray> {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let [a, b] =
            [bounds.lo, bounds.hi].map(|face| (face[axis] - line.origin[axis]) / line.direction[axis]);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    (enter < leave).then(|| Ray::new(line.at(enter), (leave - enter) * line.direction))
}
