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
//! Both bounds are valid in any case, up to `256 u` times the lengths involved: `u (|p| + magnitude)` is the rounding error of a
//! signed distance, and 256 covers the operations of every kernel.

mod candidates;
mod field;
mod search;
mod surfaces;
#[cfg(test)]
mod tests;
mod tree;

use crate::{AnalysisError, Cancelled};
use candidates::Witness;
pub(crate) use candidates::combination;
use field::Field;
use rayweave_error::Message;
use rayweave_math::Vec3;
use rayweave_model::drive::{Cancel, Stopped, drive, thread_count};
use rayweave_model::{BadPoint, Program};
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
    /// The distance is at most this; infinite without a known boundary point.
    pub upper: f64,
    /// A boundary point at the distance `upper`, up to rounding.
    pub nearest: Option<Vec3>,
    /// True if both bounds agree within the precision.
    pub is_exact: bool,
}

impl Distance {
    /// The distance of the nearest point found, or infinity, negative inside.
    pub fn signed(&self) -> f64 {
        if self.is_inside { -self.upper } else { self.upper }
    }
}

/// The options of a run.
#[derive(Default)]
pub struct DistanceRun {
    /// The number of threads; by default that of [`thread_count`]. Results do not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// Cancels the run.
    pub cancel: Cancel,
}

impl DistanceField {
    /// The distances of a program.
    ///
    /// # Errors
    /// A precision out of range; a model with more than a million surfaces, placed copies included.
    pub fn new(program: &Program, settings: DistanceSettings) -> Result<DistanceField, AnalysisError> {
        if !(1e-15..=1.0).contains(&settings.precision) {
            let problem = format!("the precision is {}", settings.precision);
            let message = Message::new(problem, "it must be from 1e-15 to 1").suggest("Try 1e-9.");
            return Err(AnalysisError::Value(message));
        }
        let Some(field) = Field::new(program, settings.precision) else {
            let problem = "the model has more than 1,000,000 surfaces, placed copies included";
            let message = Message::new(problem, "distances are computed for smaller models");
            return Err(AnalysisError::Solid(message.suggest("Select a part of it.")));
        };
        Ok(DistanceField { field, most_cells: settings.most_cells })
    }

    /// The distance of a point, whose coordinates must be finite; the answer for another point is arbitrary.
    pub fn distance(&self, point: Vec3) -> Distance {
        if let Some(is_inside) = self.field.tree.constant() {
            let (lower, upper) = (f64::INFINITY, f64::INFINITY);
            return Distance { is_inside, lower, upper, nearest: None, is_exact: true };
        }
        let rounding = self.field.rounding(point);
        let signed: Vec<f64> = self.field.surfaces.iter().map(|s| surfaces::signed_bound(s, point)).collect();
        let is_inside = self.field.is_inside(point);
        let lower = (self.field.tree.signed_bound(&signed).abs() - rounding).max(0.0);
        let distances: Vec<f64> = signed.iter().map(|d| (d.abs() - rounding).max(0.0)).collect();
        let mut best = self.best_foot(point, is_inside, lower, &distances);
        let mut bound = lower;
        if bound < best.distance - self.field.tolerance(point, best.distance) {
            bound = self.search(point, is_inside, lower, &distances, &mut best);
        }
        let best = self.field.settled(point, is_inside, best);
        self.answer(point, is_inside, bound, best)
    }

    fn answer(&self, point: Vec3, is_inside: bool, lower: f64, best: Witness) -> Distance {
        // the boundary point itself, if both sides of it were verified
        let upper = best.on.map_or(best.distance, |on| (on - point).length());
        let tolerance = self.field.tolerance(point, best.distance);
        let is_exact = best.distance < f64::INFINITY && lower >= best.distance - tolerance;
        Distance { is_inside, lower: lower.min(upper), upper, nearest: best.on, is_exact }
    }

    /// Bounds of the distances of many points, in their order.
    ///
    /// # Errors
    /// [`AnalysisError::Point`] for a point whose coordinates are not finite, and [`AnalysisError::Cancelled`].
    pub fn distances(&self, points: &[Vec3], run: &DistanceRun) -> Result<Vec<Distance>, AnalysisError> {
        BadPoint::check(points.iter().copied())?;
        let tasks = (0..points.len())
            .step_by(POINTS_PER_TASK)
            .map(|first| first..points.len().min(first + POINTS_PER_TASK));
        let work = |(): &mut (), range: Range<usize>| -> Vec<Distance> {
            points[range].iter().map(|&point| self.distance(point)).collect()
        };
        let mut answers = Vec::with_capacity(points.len());
        let merge = |found: Vec<Distance>| {
            answers.extend(found);
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
            if best.distance <= lower + self.field.tolerance(point, best.distance) {
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
