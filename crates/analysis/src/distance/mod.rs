//! Signed distance of points from the boundary of a model, and nearest boundary points, with bounds.
//!
//! The distance is negative inside, as f of a surface is. A [`DistanceField`] is a boolean function of the signs of the
//! surfaces `f_i` of a [`Program`]; the solid is where the owner of a point has a medium other than that of the world.
//!
//! # Bounds
//!
//! *From below, by the rules for distance functions* (J. C. Hart, "Sphere tracing", The Visual Computer 12 (1996); exact and
//! bounded operators: I. Quilez, "Distance functions", iquilezles.org). Let `d_i` have the sign of `f_i` and at most the distance
//! from the surface as magnitude. With the minimum for a union, the maximum for an intersection and the opposite for a
//! complement the expression has a value d with the sign of the solid, whose distance is at least r = |d|: within r of the point
//! only surfaces with `|d_i| < r` change their sign. Minima and maxima of numbers that include those keep |d| >= r with either
//! sign of them, so that no such change matters. For a union of disjoint solids with exact functions d is exact outside; otherwise
//! it may be smaller than the distance.
//!
//! *From above*: a point on the other side of the boundary. The way there crosses the boundary.
//!
//! Candidates for that point are the feet of perpendiculars on single surfaces, which have closed forms on surfaces of revolution
//! and quadrics (`feet`); elsewhere Newton's method is used.
//!
//! *Both bounds meet by branch and bound* (A. H. Land, A. G. Doig, Econometrica 28 (1960); for interval methods R. E. Moore,
//! *Interval Analysis* (1966)). Boxes around the point are subdivided, those nearest to the point first. With bounds of f and
//! its gradient over a box (`Surface::ranges`) a box is discarded
//!
//! 1. if the signs that are constant in it determine the expression: it contains no boundary;
//! 2. if all sign patterns of its remaining surfaces, at most four, give the same value;
//! 3. if it contains no critical point of the distance. The nearest boundary point q to p lies on one surface, with `q - p`
//!    parallel to its gradient; or on two, with `q - p` perpendicular to the curve in which they meet; or on three.
//!
//! For the remaining boxes the smallest distance is at least that of the box, and that of the surfaces or the curve
//! (closed forms) on which q may lie. The search ends when the nearest box is as far away as the
//! best point found, within the tolerance, or after [`DistanceSettings::most_cells`] boxes.
//!
//! Both bounds are rounded outwards by `256 u` times the lengths involved or more: `u (|p| + magnitude)` is the rounding error of a
//! signed distance, and 256 covers the operations of every kernel.

mod candidates;
mod contained;
mod feet;
mod field;
mod quadric_foot;
mod search;
mod surfaces;
#[cfg(test)]
mod tests;
mod tree;

use crate::{AnalysisError, Cancelled};
use candidates::Witness;
pub(crate) use candidates::combination;
pub(crate) use contained::contained;
use field::Field;
use rayweave_error::Message;
use rayweave_math::Vec3;
use rayweave_model::drive::{Cancel, Stopped, drive, thread_count};
use rayweave_model::{BadPoint, Program, RegionId};
use rayweave_shape::surface::Surface;
use search::Search;
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::ops::Range;

/// Points per task of [`DistanceField::distances`].
const POINTS_PER_TASK: usize = 64;

/// The number of nearest surfaces whose feet are tried before the subdivision.
const NEAREST_SURFACES: usize = 12;

/// The surfaces of a program in the frame of the world, with one copy for each placement; `None` if there are more than a million.
pub(crate) fn world_surfaces(program: &Program) -> Option<Vec<Surface>> {
    let (_, surfaces) = tree::Tree::of(program)?;
    Some(surfaces.into_iter().map(|(surface, _)| surface).collect())
}

/// The distances of a model.
#[derive(Clone, Debug)]
pub struct DistanceField {
    field: Field,
    most_cells: usize,
}

/// The effort for distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceSettings {
    /// The relative difference between the bounds of a distance below which it counts as exact; 1e-15 to 1.
    pub precision: f64,
    /// The greatest number of boxes that are examined for a point.
    pub most_cells: usize,
}

impl Default for DistanceSettings {
    fn default() -> DistanceSettings {
        DistanceSettings { precision: 1e-9, most_cells: 20_000 }
    }
}

/// The distance of a point from the boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// Whether the point is inside.
    pub is_inside: bool,
    /// The distance is at least this.
    pub lower: f64,
    /// The distance is at most this: that of a point on the other side of the boundary. Infinite without a known one.
    pub upper: f64,
    /// The best value, between the bounds: the distance of `nearest`.
    pub value: f64,
    /// The nearest boundary point found.
    pub nearest: Option<Vec3>,
    /// True if both bounds agree within the precision.
    pub is_exact: bool,
}

impl Distance {
    /// The distance of the nearest point found, or infinity, negative inside.
    pub fn signed(&self) -> f64 {
        if self.is_inside { -self.value } else { self.value }
    }
}

/// The options of a run.
#[derive(Default)]
pub struct DistanceRun<'a> {
    /// The number of threads; by default that of [`thread_count`]. Results do not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// Cancels the run.
    pub cancel: Cancel,
    /// Callback with the number of finished points, on the calling thread.
    pub progress: Option<&'a mut dyn FnMut(usize)>,
}

impl DistanceField {
    /// The distances of a program.
    ///
    /// # Errors
    /// A precision out of range; a model with more than a million surfaces, placed copies included.
    pub fn new(program: &Program, settings: DistanceSettings) -> Result<DistanceField, AnalysisError> {
        DistanceField::of_regions(program, &|region| program.medium_of(region) != 0, settings)
    }

    /// The distances from the part of space that belongs to the selected regions of a program; all other regions count as the world.
    /// Regions whose borders matter need media of their own, as in a program that is compiled by region.
    ///
    /// # Errors
    /// Those of [`DistanceField::new`].
    pub fn of_regions(
        program: &Program,
        is_selected: &dyn Fn(RegionId) -> bool,
        settings: DistanceSettings,
    ) -> Result<DistanceField, AnalysisError> {
        if !(1e-15..=1.0).contains(&settings.precision) {
            let problem = format!("the precision is {}", settings.precision);
            let message = Message::new(problem, "it must be from 1e-15 to 1").suggest("Try 1e-9.");
            return Err(AnalysisError::Value(message));
        }
        let Some(field) = Field::new(program, is_selected, settings.precision) else {
            let problem = "the model has more than 1,000,000 surfaces, placed copies included";
            let message = Message::new(problem, "distances are computed for smaller models");
            return Err(AnalysisError::Solid(message.suggest("Select a part of it.")));
        };
        Ok(DistanceField { field, most_cells: settings.most_cells })
    }

    /// The distance of a point, whose coordinates must be finite; the answer for another point is arbitrary.
    pub fn distance(&self, point: Vec3) -> Distance {
        if let Some(is_inside) = self.field.tree.constant() {
            let infinite = f64::INFINITY;
            let (lower, upper, value) = (infinite, infinite, infinite);
            return Distance { is_inside, lower, upper, value, nearest: None, is_exact: true };
        }
        let rounding = self.field.rounding(point);
        let mut signed: Vec<f64> =
            self.field.surfaces.iter().map(|s| surfaces::signed_bound(s, point)).collect();
        let is_inside = self.field.is_inside(point);
        let below = |signed: f64| (signed.abs() - rounding).max(0.0);
        let mut lower = below(self.field.tree.signed_bound(&signed));
        let mut distances: Vec<f64> = signed.iter().map(|&d| below(d)).collect();
        let mut best = self.best_foot(point, is_inside, lower, &distances);
        let is_close =
            |lower: f64, best: &Witness| lower >= best.distance - self.field.tolerance(point, best.distance);
        if !is_close(lower, &best) && self.refine(point, best.distance, &mut signed) {
            distances.iter_mut().zip(&signed).for_each(|(distance, &d)| *distance = below(d));
            lower = below(self.field.tree.signed_bound(&signed));
        }
        let mut bound = lower;
        if !is_close(bound, &best) {
            bound = self.search(point, is_inside, lower, &distances, &mut best);
        }
        let best = self.field.settled(point, is_inside, best);
        self.answer(point, is_inside, bound, best)
    }

    /// Improves the bounds of those quadrics that may be nearer than `best`; whether there is one.
    fn refine(&self, point: Vec3, best: f64, signed: &mut [f64]) -> bool {
        let mut is_refined = false;
        for (bound, surface) in signed.iter_mut().zip(&self.field.surfaces) {
            if bound.abs() < best && matches!(surface, Surface::Quadric(_)) {
                *bound = surfaces::refined_bound(surface, point, *bound);
                is_refined = true;
            }
        }
        is_refined
    }

    fn answer(&self, point: Vec3, is_inside: bool, lower: f64, best: Witness) -> Distance {
        // the boundary is not farther than the other side, and a point on it, up to rounding, is the better value
        let value = best.on.map_or(best.distance, |on| (on - point).length());
        let upper = best.distance.max(value) * (1.0 + 4.0 * f64::EPSILON);
        let tolerance = self.field.tolerance(point, best.distance);
        let is_exact = best.distance < f64::INFINITY && lower >= best.distance - tolerance;
        Distance { is_inside, lower: lower.min(value), upper, value, nearest: best.on, is_exact }
    }

    /// Bounds of the distances of many points, in their order.
    ///
    /// # Errors
    /// [`AnalysisError::Point`] for a point whose coordinates are not finite, and [`AnalysisError::Cancelled`].
    pub fn distances(
        &self,
        points: &[Vec3],
        run: &mut DistanceRun<'_>,
    ) -> Result<Vec<Distance>, AnalysisError> {
        BadPoint::check(points.iter().copied())?;
        let tasks = (0..points.len())
            .step_by(POINTS_PER_TASK)
            .map(|first| first..points.len().min(first + POINTS_PER_TASK));
        let work = |(): &mut (), range: Range<usize>| -> Vec<Distance> {
            points[range].iter().map(|&point| self.distance(point)).collect()
        };
        let mut answers = Vec::with_capacity(points.len());
        let progress = &mut run.progress;
        let merge = |found: Vec<Distance>| {
            answers.extend(found);
            if let Some(progress) = progress {
                progress(answers.len());
            }
            Ok::<(), Infallible>(())
        };
        drive(thread_count(run.threads), &run.cancel, tasks, || (), work, merge).map_err(|stopped| {
            match stopped {
                Stopped::Cancelled => AnalysisError::from(Cancelled),
                Stopped::Failed(never) => match never {},
            }
        })?;
        Ok(answers)
    }

    /// The nearest of the feet on the nearest surfaces that lie on the boundary.
    fn best_foot(&self, point: Vec3, is_inside: bool, lower: f64, distances: &[f64]) -> Witness {
        let mut order: Vec<u32> = (0..self.field.surfaces.len() as u32).collect();
        let by_distance =
            |a: &u32, b: &u32| distances[*a as usize].total_cmp(&distances[*b as usize]).then(a.cmp(b));
        if order.len() > NEAREST_SURFACES {
            order.select_nth_unstable_by(NEAREST_SURFACES, by_distance);
            order.truncate(NEAREST_SURFACES);
        }
        order.sort_unstable_by(by_distance);
        let mut best = Witness::NONE;
        for &number in &order {
            let least = lower.max(distances[number as usize]);
            if best.distance <= least + self.field.tolerance(point, best.distance) {
                break;
            }
            self.field.try_meeting(point, is_inside, point, &[number], &mut best);
        }
        best
    }

    /// Searches for the nearest boundary point: in the ball up to the best one known, or in growing balls.
    fn search(&self, point: Vec3, is_inside: bool, lower: f64, distances: &[f64], best: &mut Witness) -> f64 {
        let most = self.most_cells;
        if best.distance < f64::INFINITY {
            return Search::new(&self.field, point, is_inside, distances).run(
                lower,
                best,
                best.distance,
                most,
            );
        }
        if self.field.bounds.is_finite() {
            let far = self
                .field
                .bounds
                .corners()
                .into_iter()
                .map(|corner| (corner - point).length())
                .fold(0.0, f64::max);
            return Search::new(&self.field, point, is_inside, distances).run(
                lower,
                best,
                far * (1.0 + 1e-9),
                most,
            );
        }
        let mut bound = lower;
        let mut reach = self.field.lengths(point) + 2.0 * lower;
        for _ in 0..40 {
            bound = Search::new(&self.field, point, is_inside, distances).run(bound, best, reach, most);
            if best.distance < f64::INFINITY || bound < reach {
                break;
            }
            reach *= 4.0;
        }
        bound
    }
}
