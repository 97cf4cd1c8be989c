//! The rows of a chunk: those of ray bundles, event by event, and those of single rays.

use crate::segments::Segments;
use crate::settings::Keep;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Marks parent numbers that refer to rows of bundles; the bits below hold the number of the event
/// and, in the lower half, the number of the row.
const BUNDLE: i64 = 1 << 62;

/// The rows of a chunk in the order of their computation.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    /// The rows of single rays, round by round.
    pub single: Segments,
    /// The first row of each generation among them.
    pub rounds: Vec<usize>,
    /// The rows of bundles, event by event: one table for each generation.
    pub bundles: Vec<Segments>,
}

/// The row numbers in the final table.
#[derive(Debug, Default)]
struct RowNumbers {
    single: Vec<i64>,
    bundles: Vec<BundleNumbers>,
}

/// The row numbers of the bundles of one generation.
#[derive(Debug)]
enum BundleNumbers {
    /// Consecutive numbers from this one.
    From(i64),
    Each(Vec<i64>),
}

impl RowNumbers {
    fn get(&self, parent: i64) -> i64 {
        match parent {
            ..0 => parent,
            0..BUNDLE => self.single[parent as usize],
            _ => match (&self.bundles[((parent ^ BUNDLE) >> 32) as usize], i64::from(parent as u32)) {
                (BundleNumbers::From(first), row) => first + row,
                (BundleNumbers::Each(numbers), row) => numbers[row as usize],
            },
        }
    }

    /// Adds the rows of a generation that keep their order, single rays first.
    fn add_in_order(&mut self, first: usize, singles: usize) {
        let next = (first + singles) as i64;
        self.single.extend(first as i64..next);
        self.bundles.push(BundleNumbers::From(next));
    }

    /// Adds the rows of a generation in a different order, given by their old numbers.
    fn add(&mut self, first: usize, singles: usize, order: &[usize]) {
        let mut numbers = vec![0; order.len()];
        for (row, &old) in (first as i64..).zip(order) {
            numbers[old] = row;
        }
        let bundles = numbers.split_off(singles);
        self.single.append(&mut numbers);
        self.bundles.push(BundleNumbers::Each(bundles));
    }
}

impl Rows {
    /// The parent number that stands for the next row appended to the bundles of an event.
    pub fn bundle_parent(&self, event: u32) -> i64 {
        let row = self.bundles.get(event as usize).map_or(0, Segments::len);
        BUNDLE | i64::from(event) << 32 | row as i64
    }

    /// The rows of bundles for an event.
    pub fn bundles_at(&mut self, event: u32) -> &mut Segments {
        let event = event as usize;
        if self.bundles.len() <= event {
            self.bundles.resize_with(event + 1, Segments::default);
        }
        &mut self.bundles[event]
    }

    /// The number of rows.
    pub fn len(&self) -> usize {
        self.single.len() + self.bundles.iter().map(Segments::len).sum::<usize>()
    }

    /// Removes all rows and keeps the memory.
    fn clear(&mut self) {
        self.single.clear();
        self.rounds.clear();
        self.bundles.iter_mut().for_each(Segments::clear);
    }

    /// Appends all rows to a table, by generation and then by ray number: the order of rays that
    /// are traced one by one.
    pub fn append_to(&self, table: &mut Segments, keep: Keep) {
        let (first, mut numbers) = (table.len(), RowNumbers::default());
        for round in 0..self.rounds.len().max(self.bundles.len()) {
            self.append_round(round, table, &mut numbers);
        }
        if keep == Keep::All {
            table.parent[first..].iter_mut().for_each(|parent| *parent = numbers.get(*parent));
        }
    }

    fn append_round(&self, round: usize, table: &mut Segments, numbers: &mut RowNumbers) {
        let (none, first) = (Segments::default(), table.len());
        let (single, range) = (&self.single, self.single_in(round));
        let bundles = self.bundles.get(round).unwrap_or(&none);
        let ids = || single.id[range.clone()].iter().chain(&bundles.id);
        if ids().is_sorted() {
            table.append_range(single, range.clone());
            table.append_range(bundles, 0..bundles.len());
            return numbers.add_in_order(first, range.len());
        }
        let ids: Vec<i64> = ids().copied().collect();
        let mut order: Vec<usize> = (0..ids.len()).collect();
        // stable: rows of one ray stay in their order
        order.sort_by_key(|&k| ids[k]);
        for &k in &order {
            table.push(match k.checked_sub(range.len()) {
                Some(k) => bundles.get(k),
                None => single.get(range.start + k),
            });
        }
        numbers.add(first, range.len(), &order);
    }

    /// The rows of single rays in a generation.
    fn single_in(&self, round: usize) -> Range<usize> {
        let at = |round: usize| self.rounds.get(round).copied().unwrap_or(self.single.len());
        at(round)..at(round + 1)
    }
}

/// Pool of row buffers: the merge returns them to the threads.
#[derive(Debug, Default)]
pub(crate) struct Pool(Mutex<Vec<Rows>>);

impl Pool {
    fn lock(&self) -> MutexGuard<'_, Vec<Rows>> {
        // buffers remain valid if a thread has panicked
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn give(&self, mut rows: Rows) {
        rows.clear();
        self.lock().push(rows);
    }

    pub fn take(&self) -> Option<Rows> {
        self.lock().pop()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::segments::{BundleRows, Event, Segment};
    use rayweave_math::Vec3;

    const ZEROS: [f64; 8] = [0.0; 8];

    /// Appends rows of the rays `id..id + 8` after a number of events.
    fn add_bundle(rows: &mut Rows, id: i64, events: u32) -> i64 {
        let parent = if events == 0 { -1 } else { rows.bundle_parent(events - 1) - 8 };
        rows.bundles_at(events).extend_bundle(&BundleRows {
            id: std::array::from_fn(|lane| id + lane as i64),
            parent: std::array::from_fn(|lane| if parent < 0 { -1 } else { parent + lane as i64 }),
            generation: [events; 8],
            source: &[0; 8],
            wavelength_nm: &ZEROS,
            intensity: &ZEROS,
            index: ZEROS,
            start: [ZEROS; 3],
            end: [ZEROS; 3],
            direction: [ZEROS; 3],
            path: ZEROS,
            element: 0,
            surface: 0,
            event: Event::Transmitted,
        });
        parent
    }

    fn add_single(rows: &mut Rows, id: i64, generation: u32, parent: i64) -> i64 {
        let (zero, none) = (0.0, Vec3::ZERO);
        rows.single.push(Segment {
            id,
            parent,
            generation,
            source: 0,
            wavelength_nm: zero,
            intensity: zero,
            index: zero,
            start: none,
            end: none,
            direction: none,
            path: zero,
            element: 0,
            surface: 0,
            event: Event::Transmitted,
        });
        rows.single.len() as i64 - 1
    }

    #[test]
    fn rows_have_the_order_of_rays_traced_alone() {
        let mut rows = Rows::default();
        add_bundle(&mut rows, 0, 0);
        add_bundle(&mut rows, 0, 1);
        let last = rows.bundle_parent(1) - 8;
        add_bundle(&mut rows, 16, 0);
        rows.rounds.push(0);
        let alone: Vec<i64> = (8..16).map(|id| add_single(&mut rows, id, 0, -1)).collect();
        rows.rounds.push(rows.single.len());
        // ray 9 is split; rays 0 to 7 leave their bundle after two events, rays 16 to 23 after one
        let nine = [add_single(&mut rows, 9, 1, alone[1]), add_single(&mut rows, 9, 1, alone[1])];
        let first = rows.bundle_parent(0) - 8;
        (0..8).for_each(|lane| _ = add_single(&mut rows, 16 + lane, 1, first + lane));
        rows.rounds.push(rows.single.len());
        add_single(&mut rows, 9, 2, nine[1]);
        (0..8).for_each(|lane| _ = add_single(&mut rows, lane, 2, last + lane));
        let mut table = Segments::default();
        rows.append_to(&mut table, Keep::All);
        rows.append_to(&mut table, Keep::All);
        assert_eq!(table.len(), 2 * rows.len());
        for (at, row) in table.iter().enumerate().filter(|(_, row)| row.parent >= 0) {
            let parent = table.get(row.parent as usize);
            assert_eq!((parent.id, parent.generation + 1), (row.id, row.generation));
            assert!(at / rows.len() == row.parent as usize / rows.len());
        }
        let half: Vec<Segment> = table.iter().take(rows.len()).collect();
        assert!(half.is_sorted_by_key(|row| (row.generation, row.id)));
        assert_eq!(half.iter().filter(|row| row.generation == 0).count(), 24);
        // the two halves of ray 9 keep their order
        let nines: Vec<usize> = (0..half.len()).filter(|&at| half[at].id == 9).collect();
        assert_eq!(nines.len(), 4);
        assert_eq!([half[nines[1]].parent, half[nines[2]].parent], [nines[0] as i64; 2]);
        assert_eq!(half[nines[3]].parent, nines[2] as i64);
    }
}
