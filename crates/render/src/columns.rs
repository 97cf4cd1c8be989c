//! Rays and their first hits in columns (structure of arrays).

use rayweave_math::Vec3;
use rayweave_model::{Evaluator, FirstHitColumns, PixelRays, Query, Rays, RegionId, Window};
use rayweave_shape::Ray;

/// A batch of rays with their first hits. The buffers are reused from batch to batch.
#[derive(Default)]
pub(crate) struct Columns {
    pub origins: [Vec<f64>; 3],
    pub directions: [Vec<f64>; 3],
    pub hits: FirstHitColumns,
}

impl Columns {
    pub fn clear(&mut self) {
        self.origins.iter_mut().chain(&mut self.directions).for_each(Vec::clear);
    }

    /// Resizes the batch to `count` rays, to be written by the caller.
    pub fn resize(&mut self, count: usize) {
        self.origins.iter_mut().chain(&mut self.directions).for_each(|column| column.resize(count, 0.0));
    }

    pub fn len(&self) -> usize {
        self.origins[0].len()
    }

    #[inline]
    pub fn push(&mut self, ray: Ray) {
        for k in 0..3 {
            self.origins[k].push(ray.origin[k]);
            self.directions[k].push(ray.direction[k]);
        }
    }

    #[inline]
    pub fn ray(&self, i: usize) -> Ray {
        Ray::new(vector(&self.origins, i), vector(&self.directions, i))
    }

    /// The normal at the hit; stale if the last call of [`Columns::trace`] computed none.
    #[inline]
    pub fn normal(&self, i: usize) -> Vec3 {
        self.hits.normal(i)
    }

    /// True if the ray hits something.
    #[inline]
    pub fn is_hit(&self, i: usize) -> bool {
        self.hits.face[i] >= 0
    }

    /// The visible region: see [`crate::sample::seen`].
    #[inline]
    pub fn seen(&self, i: usize) -> RegionId {
        RegionId(if self.hits.after[i] != 0 { self.hits.after[i] } else { self.hits.before[i] })
    }

    /// Computes the first hit of each ray, and its normal if `with_normals` is set.
    pub fn trace<E: Evaluator>(
        &mut self,
        evaluator: &E,
        window: Window,
        with_normals: bool,
        scratch: &mut E::Scratch,
    ) {
        let count = self.len();
        self.hits.resize(count);
        let rays = Rays::from_columns(&self.origins, &self.directions);
        let mut hits = self.hits.hits();
        hits.normal = hits.normal.filter(|_| with_normals);
        evaluator.nearest(rays, window, scratch, &mut hits);
    }

    /// Like [`Columns::trace`] from t = 0 on, for the rays through `pixels`, which a device can compute.
    pub fn trace_pixels<E: Evaluator>(
        &mut self,
        evaluator: &E,
        pixels: &PixelRays<'_>,
        with_normals: bool,
        scratch: &mut E::Scratch,
    ) {
        debug_assert_eq!(self.len(), pixels.len());
        self.hits.resize(self.len());
        let rays = Rays::from_columns(&self.origins, &self.directions);
        let mut hits = self.hits.hits();
        hits.normal = hits.normal.filter(|_| with_normals);
        evaluator.nearest_through((pixels, rays), Query::nearest().window, scratch, &mut hits);
    }
}

/// Row `i` of three columns.
#[inline]
pub(crate) fn vector(columns: &[Vec<f64>; 3], i: usize) -> Vec3 {
    Vec3::new(columns[0][i], columns[1][i], columns[2][i])
}
