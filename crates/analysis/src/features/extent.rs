//! The extent of a model along the axes.

use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Evaluator, Limit, Query, RayAnswer, RayBatch, RegionId};
use rayweave_shape::Ray;

/// The extent of a model along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// The box that the rays found. The model reaches each of its sides.
    pub bounds: Bounds,
    /// True if the model is proved not to reach beyond the box: it agrees with the bounding box of the program to rounding.
    pub is_exact: bool,
}

/// Rays along each side of a cross-section of the bounding box.
const ACROSS: usize = 64;

/// The number of the farthest rays from which a search for points still farther starts.
const STARTS: usize = 6;

/// The smallest step of that search, relative to the size of the model: the error of a smooth surface is its square.
const FINEST: f64 = 1e-10;

/// The difference from the bounding box, relative to the size of the model, that counts as rounding.
const EQUAL: f64 = 1e-9;

/// The extent of a bounded model; `None` for an empty or unbounded one.
///
/// For each side, the farthest crossing of parallel rays through the box is followed to the farthest point beside it. A needle
/// between the rays is missed; then the result is not exact.
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
    extent_of(evaluator, program.bounds(), &|region| program.medium_of(region) != 0)
}

/// The extent of the selected regions, which lie within a box.
pub(crate) fn extent_of<E: Evaluator>(
    evaluator: &E,
    outer: Bounds,
    is_in: &dyn Fn(RegionId) -> bool,
) -> Option<Extent> {
    if outer.is_empty() || !outer.is_finite() {
        return None;
    }
    let size = outer.size().max_element();
    let (mut bounds, mut is_exact, mut scratch) = (outer, true, evaluator.scratch());
    for axis in 0..3 {
        let mut side = Side { evaluator, outer: &outer, is_in, axis, scratch: &mut scratch };
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
    scratch: &'a mut E::Scratch,
}

/// A place across the axis with the coordinate of the farthest crossing there, in one direction.
#[derive(Clone, Copy)]
struct Reach {
    place: [f64; 2],
    end: f64,
}

impl<E: Evaluator> Side<'_, E> {
    /// The least and the greatest coordinate; `None` if no ray crosses the model.
    fn reach(&mut self, size: f64) -> Option<[f64; 2]> {
        let [u, v] = [1, 2].map(|k| (self.axis + k) % 3);
        let (lo, step) = (self.outer.lo, self.outer.size() / ACROSS as f64);
        let centre = |axis: usize, k: usize| lo[axis] + step[axis] * (k as f64 + 0.5);
        let cells = (0..ACROSS * ACROSS).map(|k| [centre(u, k % ACROSS), centre(v, k / ACROSS)]);
        let cells: Vec<[f64; 2]> = cells.collect();
        let first = step[u].max(step[v]);
        let mut ends = [f64::NAN; 2];
        for (end, sign) in [-1.0, 1.0].into_iter().enumerate() {
            let mut found = self.farthest(&cells, sign);
            // stable: equal ones stay in the order of the cells
            found.sort_by(|a, b| (sign * b.end).total_cmp(&(sign * a.end)));
            let known = if end == 0 { self.outer.lo } else { self.outer.hi }[self.axis];
            let mut best = found.first()?.end;
            for start in found.iter().take(STARTS) {
                if (best - known).abs() <= EQUAL * size {
                    break;
                }
                let farthest = self.climbed(*start, sign, (first, FINEST * size));
                best = if sign * farthest > sign * best { farthest } else { best };
            }
            ends[end] = best;
        }
        Some(ends)
    }

    /// The coordinate of the farthest point that small steps lead to.
    fn climbed(&mut self, start: Reach, sign: f64, (mut step, finest): (f64, f64)) -> f64 {
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
        while step > finest {
            let [x, y] = best.place;
            let around = self.farthest(&AROUND.map(|[u, v]| [x + step * u, y + step * v]), sign);
            let next = around
                .into_iter()
                .max_by(|a, b| (sign * a.end).total_cmp(&(sign * b.end)))
                .filter(|next| sign * next.end > sign * best.end);
            match next {
                Some(next) => best = next,
                None => step *= 0.5,
            }
        }
        best.end
    }

    /// The farthest crossings along the axis (`sign` 1) or against it (-1) of the lines at places; those that miss are left out.
    fn farthest(&mut self, places: &[[f64; 2]], sign: f64) -> Vec<Reach> {
        let (axis, centre) = (self.axis, self.outer.centre());
        let is_in = self.is_in;
        let mut found: Vec<Option<f64>> = vec![None; places.len()];
        let mut numbers: Vec<usize> = (0..places.len()).collect();
        // the first crossing from that side, which takes far less time than all where there are many; all if another region is there
        for limit in [Limit::First, Limit::All] {
            let mut batch = RayBatch::default();
            for [u, v] in numbers.iter().map(|&number| places[number]) {
                let mut origin = centre;
                origin[(axis + 1) % 3] = u;
                origin[(axis + 2) % 3] = v;
                batch.push(Ray::new(origin, -sign * Vec3::AXES[axis]));
            }
            let mut others = Vec::new();
            let mut sink = |answer: RayAnswer<'_>| {
                let number = numbers[answer.ray];
                match answer.crossings.iter().find(|c| is_in(c.before) != is_in(c.after)) {
                    Some(first) => found[number] = Some(centre[axis] - sign * first.t),
                    None if !answer.crossings.is_empty() => others.push(number),
                    None => {}
                }
            };
            let query = Query { limit, ..Query::default() };
            self.evaluator.crossings(batch.rays(), &query, self.scratch, &mut sink);
            numbers = others;
        }
        let found = places.iter().zip(found);
        found.filter_map(|(place, end)| Some(Reach { place: *place, end: end? })).collect()
    }
}
