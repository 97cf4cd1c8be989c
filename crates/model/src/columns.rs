//! Results of ray queries in columns, filled batch by batch, for tables, arrays and pictures. There is no list and no
//! callback per ray.
//!
//! - [`HitArrayRows`]: a hit array, the times at which each ray enters or leaves the model;
//! - [`FirstHits`]: the first crossing of each ray;
//! - [`CrossingColumns`]: all crossings of each ray.
//!
//! [`Evaluator::hits`](crate::Evaluator::hits), [`Evaluator::nearest`](crate::Evaluator::nearest) and
//! [`Evaluator::columns`](crate::Evaluator::columns) fill them. The values are those of
//! [`Evaluator::crossings`](crate::Evaluator::crossings), bit for bit, but an evaluator may compute them in a
//! faster way. The caller owns the memory and chooses the size of a batch.

use crate::{Crossing, Face, LeafId, PlacementId, Program, RayAnswer, Rays, RegionId, Sink, attributes};
use rayweave_math::Vec3;
use std::ops::Range;

/// A hit array (H rows, N columns): one column per ray, with its entries in order of time.
///
/// The entries are the times at which a ray enters or leaves the union of all regions whose medium is not that
/// of the world. The first entry is -inf if the ray is inside this union just after `t_min`; unused entries are
/// +inf. A change of medium within the union is not an entry.
#[derive(Debug)]
pub struct HitArrayRows<'r, 'a> {
    /// The rows of times, in units of the length of each ray's direction; each row is as long as the batch.
    pub times: &'r mut [&'a mut [f64]],
    /// The rows of face numbers ([`Program::face_number`]), -1 where an entry has no face: as many rows as `times`,
    /// or no rows to leave the faces out.
    pub faces: &'r mut [&'a mut [i32]],
}

impl HitArrayRows<'_, '_> {
    /// Writes the column of one ray and returns its number of entries, including those beyond the last row, which
    /// are not written.
    pub fn put(&mut self, program: &Program, answer: &RayAnswer<'_>) -> usize {
        let mut count = 0;
        for (t, face) in HitArrayRows::entries(program, answer) {
            if let Some(row) = self.times.get_mut(count) {
                row[answer.ray] = t;
            }
            if let Some(row) = self.faces.get_mut(count) {
                row[answer.ray] = face;
            }
            count += 1;
        }
        self.pad(answer.ray, count);
        count
    }

    /// The entries of one ray, each with the number of its face.
    pub fn entries(program: &Program, answer: &RayAnswer<'_>) -> impl Iterator<Item = (f64, i32)> {
        let is_inside = |region| program.medium_of(region) != 0;
        let mut inside = is_inside(answer.start);
        let first = inside.then_some((f64::NEG_INFINITY, -1));
        first.into_iter().chain(answer.crossings.iter().filter_map(move |crossing| {
            let changes = is_inside(crossing.after) != inside;
            inside ^= changes;
            changes.then(|| (crossing.t, face_number(program, crossing)))
        }))
    }

    fn pad(&mut self, ray: usize, count: usize) {
        self.times.iter_mut().skip(count).for_each(|row| row[ray] = f64::INFINITY);
        self.faces.iter_mut().skip(count).for_each(|row| row[ray] = -1);
    }
}

/// The first crossing of each ray of a batch: columns as long as the batch.
#[derive(Debug)]
pub struct FirstHits<'a> {
    /// The time of the crossing, in units of the length of the ray's direction; +inf for a miss.
    pub t: &'a mut [f64],
    /// The number of the face ([`Program::face_number`]); -1 for a miss.
    pub face: &'a mut [i32],
    /// The placement of the face; 0 for a miss.
    pub placement: &'a mut [u32],
    /// The region before the crossing; for a miss, the region of the whole ray.
    pub before: &'a mut [u32],
    /// The region after the crossing; for a miss, the region of the whole ray.
    pub after: &'a mut [u32],
    /// Components of the unit normals ([`attributes::normal`]), NaN for a miss; `None` to leave them out.
    pub normal: Option<[&'a mut [f64]; 3]>,
}

impl FirstHits<'_> {
    /// Writes the first crossing of one ray.
    pub fn put(&mut self, program: &Program, rays: &Rays<'_>, answer: &RayAnswer<'_>) {
        let i = answer.ray;
        let first = answer.crossings.first();
        self.t[i] = first.map_or(f64::INFINITY, |crossing| crossing.t);
        self.face[i] = first.map_or(-1, |crossing| face_number(program, crossing));
        self.placement[i] = first.map_or(0, |crossing| crossing.face.placement.0);
        self.before[i] = first.map_or(answer.start, |crossing| crossing.before).0;
        self.after[i] = first.map_or(answer.start, |crossing| crossing.after).0;
        if let Some(columns) = &mut self.normal {
            let normal = first.map_or([f64::NAN; 3], |crossing| {
                attributes::normal(program, &rays.get(i), crossing).to_array()
            });
            columns.iter_mut().zip(normal).for_each(|(column, component)| column[i] = component);
        }
    }
}

/// Columns of their own for the first crossings of a batch with normals: the fields of [`FirstHits`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FirstHitColumns {
    /// The time of the crossing; +inf for a miss.
    pub t: Vec<f64>,
    /// The number of the face ([`Program::face_number`]); -1 for a miss.
    pub face: Vec<i32>,
    /// The placement of the face; 0 for a miss.
    pub placement: Vec<u32>,
    /// The region before the crossing; for a miss, the region of the whole ray.
    pub before: Vec<u32>,
    /// The region after the crossing; for a miss, the region of the whole ray.
    pub after: Vec<u32>,
    /// Components of the unit normals ([`attributes::normal`]); NaN for a miss.
    pub normal: [Vec<f64>; 3],
}

impl FirstHitColumns {
    /// Columns for a number of rays, filled with zeros.
    pub fn new(rays: usize) -> FirstHitColumns {
        let mut columns = FirstHitColumns::default();
        columns.resize(rays);
        columns
    }

    /// Resizes the columns to a number of rays. Rows that exist keep their old values.
    pub fn resize(&mut self, rays: usize) {
        self.t.resize(rays, 0.0);
        self.face.resize(rays, 0);
        for column in [&mut self.placement, &mut self.before, &mut self.after] {
            column.resize(rays, 0);
        }
        self.normal.iter_mut().for_each(|column| column.resize(rays, 0.0));
    }

    /// The normal at the hit of ray `i`.
    #[inline]
    pub fn normal(&self, i: usize) -> Vec3 {
        Vec3::new(self.normal[0][i], self.normal[1][i], self.normal[2][i])
    }

    /// The columns, for [`Evaluator::nearest`](crate::Evaluator::nearest) to fill.
    pub fn hits(&mut self) -> FirstHits<'_> {
        let FirstHitColumns { t, face, placement, before, after, normal: [x, y, z] } = self;
        FirstHits { t, face, placement, before, after, normal: Some([x, y, z]) }
    }
}

/// All crossings of a batch in columns: one row per crossing, sorted by ray, then t.
///
/// [`Evaluator::columns`](crate::Evaluator::columns) appends the rows of a batch. The rows do not depend on
/// the size of the batches. [`CrossingColumns::clear`] keeps the memory, so that a loop over batches of
/// similar size allocates nothing once the columns have grown.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossingColumns {
    /// The region of each ray just after `t_min`: one element per ray.
    pub start: Vec<u32>,
    /// The rows of ray i are `offsets[i]..offsets[i + 1]`: one element more than the number of rays.
    pub offsets: Vec<usize>,
    /// The time of each crossing, in units of the length of the ray's direction.
    pub t: Vec<f64>,
    /// The number of the face ([`Program::face_number`]).
    pub face: Vec<u32>,
    /// The leaf of the face.
    pub leaf: Vec<u32>,
    /// The placement of the leaf.
    pub placement: Vec<u32>,
    /// True if the ray enters a region, false if it leaves into the world.
    pub enters: Vec<bool>,
    /// The region before the crossing; 0 is the world.
    pub before: Vec<u32>,
    /// The region after the crossing.
    pub after: Vec<u32>,
    /// The rows whose crossing has more than one face ([`Crossing::is_between`]), in ascending order, each with the full
    /// crossing.
    pub between: Vec<(usize, Crossing)>,
}

impl Default for CrossingColumns {
    fn default() -> Self {
        CrossingColumns {
            start: Vec::new(),
            offsets: vec![0],
            t: Vec::new(),
            face: Vec::new(),
            leaf: Vec::new(),
            placement: Vec::new(),
            enters: Vec::new(),
            before: Vec::new(),
            after: Vec::new(),
            between: Vec::new(),
        }
    }
}

impl CrossingColumns {
    /// The number of rays.
    pub fn rays(&self) -> usize {
        self.start.len()
    }

    /// The number of crossings.
    pub fn rows(&self) -> usize {
        self.t.len()
    }

    /// The rows of ray `i`.
    pub fn rows_of(&self, i: usize) -> Range<usize> {
        self.offsets[i]..self.offsets[i + 1]
    }

    /// Removes all rays; keeps the allocated memory.
    pub fn clear(&mut self) {
        let CrossingColumns { start, offsets, t, face, leaf, placement, enters, before, after, between } =
            self;
        offsets.truncate(1);
        t.clear();
        enters.clear();
        between.clear();
        [start, face, leaf, placement, before, after].into_iter().for_each(Vec::clear);
    }

    /// The crossing of a row, with the faces of the regions before and after it.
    pub fn crossing(&self, program: &Program, row: usize) -> Crossing {
        if let Ok(k) = self.between.binary_search_by_key(&row, |(row, _)| *row) {
            return self.between[k].1;
        }
        let leaf = LeafId(self.leaf[row]);
        let face = Face {
            leaf,
            facet: self.face[row] - program.face_number(leaf, 0),
            surface: program.facets()[self.face[row] as usize].surface(),
            placement: PlacementId(self.placement[row]),
        };
        let (before, after) = (RegionId(self.before[row]), RegionId(self.after[row]));
        Crossing { t: self.t[row], face, left: face, entered: face, before, after }
    }

    /// Appends the crossings of the next ray.
    pub fn push(&mut self, program: &Program, answer: &RayAnswer<'_>) {
        let first = self.t.len();
        for (k, crossing) in answer.crossings.iter().enumerate() {
            let face = crossing.face;
            self.t.push(crossing.t);
            self.face.push(program.face_number(face.leaf, face.facet));
            self.leaf.push(face.leaf.0);
            self.placement.push(face.placement.0);
            self.enters.push(crossing.enters());
            self.before.push(crossing.before.0);
            self.after.push(crossing.after.0);
            if crossing.is_between() {
                self.between.push((first + k, *crossing));
            }
        }
        self.start.push(answer.start.0);
        self.offsets.push(self.t.len());
    }
}

/// A sink that appends the crossings of a program to columns.
pub(crate) struct ColumnSink<'a> {
    pub program: &'a Program,
    pub columns: &'a mut CrossingColumns,
}

impl Sink for ColumnSink<'_> {
    fn ray(&mut self, answer: RayAnswer<'_>) {
        self.columns.push(self.program, &answer);
    }
}

/// The number of the face of a crossing.
fn face_number(program: &Program, crossing: &Crossing) -> i32 {
    program.face_number(crossing.face.leaf, crossing.face.facet) as i32
}
