//! Hit arrays of rays that are traced one by one, written in blocks.
//!
//! The entries of a ray are far apart in memory: one in each row. Those of neighbouring rays share cache lines, so that writing
//! the entries of several rays row by row takes a fraction of the time. Most rays have few of the entries of the longest one:
//! the others are written for still more rays at a time.

use rayweave_model::HitArrayRows;

/// The number of rays of a block: their faces fill two cache lines.
const WIDTH: usize = 32;

/// The number of rays whose entries are first set to unused.
const CLEARED: usize = 16 * WIDTH;

/// The columns of up to [`WIDTH`] rays.
#[derive(Clone, Debug, Default)]
pub(super) struct HitBlock {
    /// Unused between blocks.
    times: Vec<[f64; WIDTH]>,
    faces: Vec<[i32; WIDTH]>,
    /// The number of rays so far.
    count: usize,
    /// The greatest number of entries of a ray of the block, and of any ray.
    used: usize,
    most: usize,
}

/// Unused entries.
const NO_TIMES: [f64; WIDTH] = [f64::INFINITY; WIDTH];
const NO_FACES: [i32; WIDTH] = [-1; WIDTH];

impl HitBlock {
    /// Begins a hit array.
    pub fn begin(&mut self) {
        self.most = 0;
    }

    /// Adds the entries of the next ray of the batch, the one with this number.
    pub fn put(
        &mut self,
        ray: usize,
        entries: impl Iterator<Item = (f64, i32)>,
        rows: &mut HitArrayRows<'_, '_>,
    ) {
        if ray.is_multiple_of(CLEARED) {
            rows.times.iter_mut().for_each(|row| piece(row, ray, CLEARED).fill(f64::INFINITY));
            rows.faces.iter_mut().for_each(|row| piece(row, ray, CLEARED).fill(-1));
        }
        let (lane, mut count) = (self.count % WIDTH, 0);
        for (t, face) in entries {
            if count == self.times.len() {
                self.times.push(NO_TIMES);
                self.faces.push(NO_FACES);
            }
            (self.times[count][lane], self.faces[count][lane]) = (t, face);
            count += 1;
        }
        self.used = self.used.max(count);
        self.count = lane + 1;
        if self.count == WIDTH {
            self.write(ray + 1, rows);
        }
    }

    /// Writes the last rays of a batch of `end` rays, all of which have been added. Returns the greatest number of entries of any ray.
    pub fn finish(&mut self, end: usize, rows: &mut HitArrayRows<'_, '_>) -> usize {
        self.write(end, rows);
        self.most
    }

    /// Writes the rays of the block, which end before a ray.
    fn write(&mut self, end: usize, rows: &mut HitArrayRows<'_, '_>) {
        let (count, used) = (self.count, self.used);
        let first = end - count;
        for (row, times) in rows.times.iter_mut().zip(&self.times[..used]) {
            copy(times, piece(row, first, count));
        }
        for (row, faces) in rows.faces.iter_mut().zip(&self.faces[..used]) {
            copy(faces, piece(row, first, count));
        }
        self.times[..used].fill(NO_TIMES);
        self.faces[..used].fill(NO_FACES);
        self.most = self.most.max(used);
        (self.count, self.used) = (0, 0);
    }
}

/// Up to `count` entries of a row.
fn piece<T>(row: &mut [T], first: usize, count: usize) -> &mut [T] {
    let end = row.len().min(first + count);
    &mut row[first..end]
}

/// Copies the first entries; all of a full block without a loop.
#[inline]
fn copy<T: Copy>(from: &[T; WIDTH], to: &mut [T]) {
    if to.len() == WIDTH
        && let Some(to) = to.first_chunk_mut::<WIDTH>()
    {
        *to = *from;
    } else {
        to.copy_from_slice(&from[..to.len()]);
    }
}
