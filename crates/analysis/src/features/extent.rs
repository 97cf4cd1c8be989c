//! The extent of a model along the axes.

use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Evaluator, Query, RayAnswer, RayBatch, RayLoad, RegionId};
use rayweave_shape::Ray;

/// The extent of a model along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// The box that the rays found. The model reaches each of its sides.
    pub bounds: Bounds,
    /// True if the model is proved not to reach beyond the box: it agrees with the bounding box of the program to rounding.
    pub is_exact: bool,
}

/// Rays along each side of a cross-section of the bounding box: the usual number, and that of models of which each ray reaches very
/// many shapes.
const ACROSS: usize = 64;
const LEAST_ACROSS: usize = 6;

/// The number of shapes that the rays of an extent may reach, by the boxes of the shapes: half of that of a measurement of volumes.
/// It affects models of which a ray reaches more than about a hundred shapes.
pub(crate) const MOST_REACHED: u64 = 1 << 22;

/// The part of it that the first rays may reach; the others search beside the farthest of these.
const FIRST_PART: f64 = 0.5;

/// The number of the farthest rays from which a search for points still farther starts.
const STARTS: usize = 6;

/// The smallest step of that search, relative to the size of the model: the error of a smooth surface is its square.
const FINEST: f64 = 1e-10;

/// The difference from the bounding box, relative to the size of the model, that counts as rounding.
const EQUAL: f64 = 1e-9;

/// The extent of a bounded model; `None` for an empty or unbounded one.
///
/// For each side, the farthest crossing of parallel rays through the box is followed to the farthest point beside it. A needle
/// between the rays is missed; then the result is not exact. There are fewer rays where each reaches hundreds of shapes.
///
/// ```
/// use rayweave_analysis::features::extent;
/// use rayweave_math::Vec3;
/// use rayweave_model::{Program, Solid};
/// use rayweave_shape::primitive::{Primitive, Sphere};
/// use rayweave_trace::Packets;
/// use std::sync::Arc;
///
/// let ball = Solid::from(Primitive::from(Sphere::new(2.0)?));
/// // the bounding box of an intersection may be too large
/// let lens = &ball & &ball.translate(Vec3::new(0.0, 0.0, 3.0));
/// let found = extent(&Packets::new(Arc::new(Program::compile(&lens)?))).ok_or("unbounded")?;
/// assert!((found.bounds.size().x - 2.0 * 1.75f64.sqrt()).abs() < 1e-9);
/// assert!((found.bounds.size().z - 1.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn extent<E: Evaluator>(evaluator: &E) -> Option<Extent> {
    let program = evaluator.program();
    let is_in = |region| program.medium_of(region) != 0;
    extent_of(evaluator, program.bounds(), &is_in, (&program.ray_load(), MOST_REACHED))
}

/// The extent of the selected regions, which lie within a box. `most_reached` limits the number of shapes that all rays reach.
pub(crate) fn extent_of<E: Evaluator>(
    evaluator: &E,
    outer: Bounds,
    is_in: &dyn Fn(RegionId) -> bool,
    (load, most_reached): (&RayLoad, u64),
) -> Option<Extent> {
    if outer.is_empty() || !outer.is_finite() {
        return None;
    }
    let size = outer.size().max_element();
    let (mut bounds, mut is_exact, mut scratch) = (outer, true, evaluator.scratch());
    let load = load.along_axes(&outer);
    for (axis, load) in load.into_iter().enumerate() {
        let left = most_reached as f64 / 3.0;
        let load = load.max(1.0);
        let mut side = Side { evaluator, outer: &outer, is_in, axis, load, left, scratch: &mut scratch };
        let [lo, hi] = side.reach(size)?;
        let ends = [(lo, &mut bounds.lo), (hi, &mut bounds.hi)];
        for (found, corner) in ends {
            if (found - corner[axis]).abs() > EQUAL * size {
                corner[axis] = found;
                is_exact = false;
            }
        }
    }
    Some(Extent { bounds, is_exact })
}

/// The search along an axis.
struct Side<'a, E: Evaluator> {
    evaluator: &'a E,
    outer: &'a Bounds,
    is_in: &'a dyn Fn(RegionId) -> bool,
    axis: usize,
    /// The number of shapes that a ray reaches, and the number that further rays may reach.
    load: f64,
    left: f64,
    scratch: &'a mut E::Scratch,
}

/// A place across the axis with the first and last crossing there.
#[derive(Clone, Copy)]
struct Reach {
    place: [f64; 2],
    ends: [f64; 2],
}

impl<E: Evaluator> Side<'_, E> {
    /// The least and the greatest coordinate; `None` if no ray crosses the model.
    fn reach(&mut self, size: f64) -> Option<[f64; 2]> {
        let [u, v] = [1, 2].map(|k| (self.axis + k) % 3);
        let affordable = (FIRST_PART * self.left / self.load).sqrt() as usize;
        let across = affordable.clamp(LEAST_ACROSS, ACROSS);
        let (lo, step) = (self.outer.lo, self.outer.size() / across as f64);
        let centre = |axis: usize, k: usize| lo[axis] + step[axis] * (k as f64 + 0.5);
        let cells = (0..across * across).map(|k| [centre(u, k % across), centre(v, k / across)]);
        let mut found = self.crossings(&cells.collect::<Vec<_>>());
        let first = step[u].max(step[v]);
        let mut ends = [f64::NAN; 2];
        for (end, sign) in [-1.0, 1.0].into_iter().enumerate() {
            // stable: equal ones stay in the order of the cells
            found.sort_by(|a, b| (sign * b.ends[end]).total_cmp(&(sign * a.ends[end])));
            let known = if end == 0 { self.outer.lo } else { self.outer.hi }[self.axis];
            // both ends get equal parts
            let kept = if end == 0 { 0.5 * self.left } else { 0.0 };
            let mut best = found.first()?.ends[end];
            for start in found.iter().take(STARTS) {
                if (best - known).abs() <= EQUAL * size {
                    break;
                }
                let farthest = self.climbed(*start, (end, sign), (first, FINEST * size), kept);
                best = if sign * farthest > sign * best { farthest } else { best };
            }
            ends[end] = best;
        }
        Some(ends)
    }

    /// The coordinate of the farthest point that small steps lead to, as long as more shapes than `kept` may be reached.
    fn climbed(
        &mut self,
        start: Reach,
        (end, sign): (usize, f64),
        (mut step, finest): (f64, f64),
        kept: f64,
    ) -> f64 {
        const AROUND: [[f64; 2]; 8] = [
            [1.0, 0.0],
            [0.0, 1.0],
            [-1.0, 0.0],
            [0.0, -1.0],
            [0.7, 0.7],
            [-0.7, 0.7],
            [-0.7, -0.7],
            [0.7, -0.7],
        ];
        let mut best = start;
        // eight rays for each step
        while step > finest && self.left - kept >= 8.0 * self.load {
            let [x, y] = best.place;
            let around = self.crossings(&AROUND.map(|[u, v]| [x + step * u, y + step * v]));
            let next = around
                .into_iter()
                .max_by(|a, b| (sign * a.ends[end]).total_cmp(&(sign * b.ends[end])))
                .filter(|next| sign * next.ends[end] > sign * best.ends[end]);
            match next {
                Some(next) => best = next,
                None => step *= 0.5,
            }
        }
        best.ends[end]
    }

    /// The first and last crossings of the rays at places; those that miss are left out.
    fn crossings(&mut self, places: &[[f64; 2]]) -> Vec<Reach> {
        let (axis, centre) = (self.axis, self.outer.centre());
        self.left -= places.len() as f64 * self.load;
        let mut batch = RayBatch::default();
        for [u, v] in places {
            let mut origin = centre;
            origin[(axis + 1) % 3] = *u;
            origin[(axis + 2) % 3] = *v;
            batch.push(Ray::new(origin, Vec3::AXES[axis]));
        }
        let is_in = self.is_in;
        let mut found = Vec::new();
        let mut sink = |answer: RayAnswer<'_>| {
            let mut bounds = answer.crossings.iter().filter(|c| is_in(c.before) != is_in(c.after));
            if let Some(first) = bounds.next() {
                let last = bounds.next_back().unwrap_or(first);
                let ends = [first.t, last.t].map(|t| centre[axis] + t);
                found.push(Reach { place: places[answer.ray], ends });
            }
        };
        self.evaluator.crossings(batch.rays(), &Query::default(), self.scratch, &mut sink);
        found
    }
}
