//! Answers as plain columns: what tables, pictures and arrays are filled from, without a list per ray in between.
//!
//! Two questions are asked of millions of rays at a time: where does each ray enter and leave ([`HitRows`]), and what
//! does it meet first ([`FirstHits`]). [`crate::Evaluator::hits`] and [`crate::Evaluator::nearest`] answer them into
//! columns that the caller owns. They are views of the list of crossings, the same to the bit; an evaluator may know a
//! shorter way to them.

use crate::{Crossing, Program, RayAnswer, Rays, dress};

/// A hit array (H rows, N columns): column = ray, row = entry, in order of time.
///
/// Entries are the times at which a ray enters or leaves whatever is not of the medium of the world, -inf first for a
/// ray that is inside just after `t_min`; unused entries are +inf. From one medium into another is no entry.
#[derive(Debug)]
pub struct HitRows<'r, 'a> {
    /// The times, in units of the rays' directions: row by row, each as long as the batch.
    pub times: &'r mut [&'a mut [f64]],
    /// The numbers of the faces hit ([`Program::face_number`]), -1 where there is none: as many rows as `times`, or no
    /// row if they are not asked for.
    pub faces: &'r mut [&'a mut [i32]],
}

impl HitRows<'_, '_> {
    /// Writes the column of one ray; how many entries it has, be there room for them or not.
    pub fn put(&mut self, program: &Program, answer: &RayAnswer<'_>) -> usize {
        let is_inside = |region| program.medium_of(region) != 0;
        let mut inside = is_inside(answer.start);
        let mut count = 0;
        if inside {
            self.entry(answer.ray, &mut count, f64::NEG_INFINITY, -1);
        }
        for crossing in answer.crossings {
            if is_inside(crossing.after) != inside {
                inside = !inside;
                self.entry(answer.ray, &mut count, crossing.t, face_number(program, crossing));
            }
        }
        self.pad(answer.ray, count);
        count
    }

    fn entry(&mut self, ray: usize, count: &mut usize, t: f64, face: i32) {
        if let Some(row) = self.times.get_mut(*count) {
            row[ray] = t;
        }
        if let Some(row) = self.faces.get_mut(*count) {
            row[ray] = face;
        }
        *count += 1;
    }

    fn pad(&mut self, ray: usize, count: usize) {
        self.times.iter_mut().skip(count).for_each(|row| row[ray] = f64::INFINITY);
        self.faces.iter_mut().skip(count).for_each(|row| row[ray] = -1);
    }
}

/// What each ray of a batch meets first: columns as long as the batch.
#[derive(Debug)]
pub struct FirstHits<'a> {
    /// When, in units of the rays' directions; +inf for a miss.
    pub t: &'a mut [f64],
    /// The number of the face ([`Program::face_number`]); -1 for a miss.
    pub face: &'a mut [i32],
    /// The placement of the face; 0 for a miss.
    pub placement: &'a mut [u32],
    /// The region before the crossing; for a miss the one that the ray is in.
    pub before: &'a mut [u32],
    /// The region after it; for a miss the one that the ray is in.
    pub after: &'a mut [u32],
    /// The components of the unit normals ([`dress::normal`]), NaN for a miss; `None` if they are not asked for.
    pub normal: Option<[&'a mut [f64]; 3]>,
}

impl FirstHits<'_> {
    /// Writes what one ray meets.
    pub fn put(&mut self, program: &Program, rays: &Rays<'_>, answer: &RayAnswer<'_>) {
        let i = answer.ray;
        let first = answer.crossings.first();
        self.t[i] = first.map_or(f64::INFINITY, |crossing| crossing.t);
        self.face[i] = first.map_or(-1, |crossing| face_number(program, crossing));
        self.placement[i] = first.map_or(0, |crossing| crossing.face.placement.0);
        self.before[i] = first.map_or(answer.start, |crossing| crossing.before).0;
        self.after[i] = first.map_or(answer.start, |crossing| crossing.after).0;
        if let Some(columns) = &mut self.normal {
            let normal = first
                .map_or([f64::NAN; 3], |crossing| dress::normal(program, &rays.get(i), crossing).to_array());
            columns.iter_mut().zip(normal).for_each(|(column, component)| column[i] = component);
        }
    }
}

/// The number of the face that a crossing belongs to.
fn face_number(program: &Program, crossing: &Crossing) -> i32 {
    program.face_number(crossing.face.leaf, crossing.face.facet) as i32
}
