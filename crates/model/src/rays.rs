//! Batches of rays as structures of arrays.

use rayweave_error::{Classified, ErrorKind};
use rayweave_math::Vec3;
use rayweave_shape::{Ray, RayError};
use std::ops::Range;

/// A ray of a batch that cannot be traced.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("ray {ray}: {problem}")]
pub struct BadRay {
    /// The number of the ray in its batch.
    pub ray: usize,
    /// The reason.
    pub problem: RayError,
}

impl Classified for BadRay {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Value
    }
}

/// Rays as a structure of arrays: component k of ray i is `origins[k][i]`.
#[derive(Clone, Copy, Debug)]
pub struct Rays<'a> {
    /// The components of the origins.
    pub origins: [&'a [f64]; 3],
    /// The components of the directions.
    pub directions: [&'a [f64]; 3],
}

impl<'a> Rays<'a> {
    /// Rays from columns of components, such as those of a chunk of a file of rays. All columns must have the same length.
    pub fn from_columns(origins: &'a [Vec<f64>; 3], directions: &'a [Vec<f64>; 3]) -> Rays<'a> {
        let slices = |columns: &'a [Vec<f64>; 3]| columns.each_ref().map(Vec::as_slice);
        Rays { origins: slices(origins), directions: slices(directions) }
    }

    /// A range of the rays.
    pub fn slice(&self, range: Range<usize>) -> Rays<'a> {
        let part = |columns: [&'a [f64]; 3]| columns.map(|column| &column[range.clone()]);
        Rays { origins: part(self.origins), directions: part(self.directions) }
    }
}

impl Rays<'_> {
    /// The number of rays.
    pub fn len(&self) -> usize {
        self.origins[0].len()
    }

    /// True if there are no rays.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Ray number `i`.
    #[inline]
    pub fn get(&self, i: usize) -> Ray {
        let at = |columns: &[&[f64]; 3]| Vec3::new(columns[0][i], columns[1][i], columns[2][i]);
        Ray::new(at(&self.origins), at(&self.directions))
    }

    /// Checks that every ray is in the range that can be traced: see [`Ray::check`]. [`Program::check_rays`](crate::Program::check_rays)
    /// also rejects rays that are too far from a model.
    ///
    /// # Errors
    /// [`BadRay`] for the first ray that is not.
    pub fn check(&self) -> Result<(), BadRay> {
        if self.are_within(Ray::MAX_COMPONENT) {
            return Ok(());
        }
        let check = |ray: usize| self.get(ray).check().map_err(|problem| BadRay { ray, problem });
        (0..self.len()).try_for_each(check)
    }

    /// True only if all rays pass the check and no component of an origin exceeds `near`. Runs column by column, without a
    /// branch per ray.
    pub(crate) fn are_within(&self, near: f64) -> bool {
        let is_within =
            |column: &[f64], most: f64| column.iter().fold(true, |all, x| all & (x.abs() <= most));
        let [x, y, z] = self.directions;
        let goes =
            |((x, y), z): ((&f64, &f64), &f64)| x.abs().max(y.abs()).max(z.abs()) >= Ray::MIN_DIRECTION;
        let all_go = x.iter().zip(y).zip(z).fold(true, |all, direction| all & goes(direction));
        all_go
            && self.origins.iter().all(|column| is_within(column, near.min(Ray::MAX_COMPONENT)))
            && self.directions.iter().all(|column| is_within(column, Ray::MAX_COMPONENT))
    }
}

/// Rays that own their arrays.
#[derive(Clone, Debug, Default)]
pub struct RayBatch {
    origins: [Vec<f64>; 3],
    directions: [Vec<f64>; 3],
}

impl RayBatch {
    /// Appends a ray.
    pub fn push(&mut self, ray: Ray) {
        for k in 0..3 {
            self.origins[k].push(ray.origin[k]);
            self.directions[k].push(ray.direction[k]);
        }
    }

    /// Replaces all rays.
    pub fn replace(&mut self, rays: impl ExactSizeIterator<Item = Ray>) {
        let count = rays.len();
        self.origins.iter_mut().chain(&mut self.directions).for_each(|column| column.resize(count, 0.0));
        let [ox, oy, oz] = self.origins.each_mut().map(|column| &mut column[..count]);
        let [dx, dy, dz] = self.directions.each_mut().map(|column| &mut column[..count]);
        for (i, ray) in rays.take(count).enumerate() {
            (ox[i], oy[i], oz[i]) = ray.origin.into();
            (dx[i], dy[i], dz[i]) = ray.direction.into();
        }
    }

    /// Appends the rays of a range of a batch.
    pub fn extend(&mut self, rays: Rays<'_>, range: Range<usize>) {
        for k in 0..3 {
            self.origins[k].extend_from_slice(&rays.origins[k][range.clone()]);
            self.directions[k].extend_from_slice(&rays.directions[k][range.clone()]);
        }
    }

    /// The number of rays.
    pub fn len(&self) -> usize {
        self.origins[0].len()
    }

    /// True if there are no rays.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Appends rays with their directions normalised to unit length. The directions must not be 0.
    pub fn extend_normalised(&mut self, rays: Rays<'_>) {
        for (own, given) in self.origins.iter_mut().zip(rays.origins) {
            own.extend_from_slice(given);
        }
        let first = self.directions[0].len();
        for (own, given) in self.directions.iter_mut().zip(rays.directions) {
            own.extend_from_slice(given);
        }
        let [x, y, z] = self.directions.each_mut().map(|column| &mut column[first..]);
        for ((x, y), z) in x.iter_mut().zip(y).zip(z) {
            let unit = Vec3::new(*x, *y, *z).normalize();
            (*x, *y, *z) = (unit.x, unit.y, unit.z);
        }
    }

    /// Removes all rays; keeps the allocated memory.
    pub fn clear(&mut self) {
        self.origins.iter_mut().chain(&mut self.directions).for_each(Vec::clear);
    }

    /// The rays as slices.
    pub fn rays(&self) -> Rays<'_> {
        let [ox, oy, oz] = &self.origins;
        let [dx, dy, dz] = &self.directions;
        Rays { origins: [ox, oy, oz], directions: [dx, dy, dz] }
    }
}

impl FromIterator<Ray> for RayBatch {
    fn from_iter<I: IntoIterator<Item = Ray>>(rays: I) -> Self {
        let mut batch = RayBatch::default();
        rays.into_iter().for_each(|ray| batch.push(ray));
        batch
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_bad_ray_is_named() {
        let good = Ray::new(Vec3::ZERO, Vec3::X);
        let bad = |x: f64| Ray::new(Vec3::new(x, 0.0, 0.0), Vec3::X);
        let batch = RayBatch::from_iter([good, bad(1e101), bad(f64::NAN)]);
        let found = batch.rays().check().unwrap_err();
        assert_eq!((found.ray, found.problem), (1, bad(1e101).check().unwrap_err()));
        assert!(found.to_string().starts_with("ray 1: the origin is (1e101, 0.0, 0.0)"), "{found}");
        assert_eq!(RayBatch::from_iter([good, good]).rays().check(), Ok(()));
        assert_eq!(RayBatch::default().rays().check(), Ok(()));
    }
}
