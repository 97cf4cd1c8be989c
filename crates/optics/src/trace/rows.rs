//! The rows of a chunk: those of eight rays at a time, event by event, and those of single rays.

use crate::segments::Segments;
use crate::settings::Keep;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The bit of parents that are rows of eight rays at a time; below it stand the number of the event and, in the lower half,
/// that of the row.
const ABREAST: i64 = 1 << 62;

/// The rows of a chunk as they come about.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    /// The rows of single rays, round by round.
    pub single: Segments,
    /// Where each round begins among them.
    pub rounds: Vec<usize>,
    /// The rows of eight rays at a time, event by event: a round each.
    pub abreast: Vec<Segments>,
}

/// Where rows have come to stand in a table.
#[derive(Debug, Default)]
struct Places {
    single: Vec<i64>,
    abreast: Vec<Place>,
}

#[derive(Debug)]
enum Place {
    /// One after the other from here on.
    From(i64),
    Each(Vec<i64>),
}

impl Places {
    fn of(&self, parent: i64) -> i64 {
        match parent {
            ..0 => parent,
            0..ABREAST => self.single[parent as usize],
            _ => match (&self.abreast[((parent ^ ABREAST) >> 32) as usize], i64::from(parent as u32)) {
                (Place::From(first), row) => first + row,
                (Place::Each(places), row) => places[row as usize],
            },
        }
    }

    /// The rows of a round stand as they were, first those of single rays.
    fn add_in_order(&mut self, first: usize, singles: usize) {
        let next = (first + singles) as i64;
        self.single.extend(first as i64..next);
        self.abreast.push(Place::From(next));
    }

    /// They stand in another order, given by their old numbers.
    fn add(&mut self, first: usize, singles: usize, order: &[usize]) {
        let mut places = vec![0; order.len()];
        for (row, &old) in (first as i64..).zip(order) {
            places[old] = row;
        }
        let eights = places.split_off(singles);
        self.single.append(&mut places);
        self.abreast.push(Place::Each(eights));
    }
}

impl Rows {
    /// The first of eight rows that are to be appended for an event, as the parent of others.
    pub fn parent_abreast(&self, event: u32) -> i64 {
        let row = self.abreast.get(event as usize).map_or(0, Segments::len);
        ABREAST | i64::from(event) << 32 | row as i64
    }

    /// The rows of eight rays for an event.
    pub fn abreast_at(&mut self, event: u32) -> &mut Segments {
        let event = event as usize;
        if self.abreast.len() <= event {
            self.abreast.resize_with(event + 1, Segments::default);
        }
        &mut self.abreast[event]
    }

    /// The number of rows.
    pub fn len(&self) -> usize {
        self.single.len() + self.abreast.iter().map(Segments::len).sum::<usize>()
    }

    /// Forgets all rows and keeps the memory.
    fn clear(&mut self) {
        self.single.clear();
        self.rounds.clear();
        self.abreast.iter_mut().for_each(Segments::clear);
    }

    /// Appends all rows to a table, round by round, in each by the numbers of the rays: as if all had been alone.
    pub fn append_to(&self, table: &mut Segments, keep: Keep) {
        let (first, mut places) = (table.len(), Places::default());
        for round in 0..self.rounds.len().max(self.abreast.len()) {
            self.append_round(round, table, &mut places);
        }
        if keep == Keep::All {
            table.parent[first..].iter_mut().for_each(|parent| *parent = places.of(*parent));
        }
    }

    fn append_round(&self, round: usize, table: &mut Segments, places: &mut Places) {
        let (none, first) = (Segments::default(), table.len());
        let (single, range) = (&self.single, self.single_in(round));
        let eights = self.abreast.get(round).unwrap_or(&none);
        let ids = || single.id[range.clone()].iter().chain(&eights.id);
        if ids().is_sorted() {
            table.append_range(single, range.clone());
            table.append_range(eights, 0..eights.len());
            return places.add_in_order(first, range.len());
        }
        let ids: Vec<i64> = ids().copied().collect();
        let mut order: Vec<usize> = (0..ids.len()).collect();
        // stable: rows of one ray stay in their order
        order.sort_by_key(|&k| ids[k]);
        for &k in &order {
            table.push(match k.checked_sub(range.len()) {
                Some(k) => eights.get(k),
                None => single.get(range.start + k),
            });
        }
        places.add(first, range.len(), &order);
    }

    /// The rows of single rays in a round.
    fn single_in(&self, round: usize) -> Range<usize> {
        let at = |round: usize| self.rounds.get(round).copied().unwrap_or(self.single.len());
        at(round)..at(round + 1)
    }
}

/// Memory for rows that goes from the merge back to the threads.
#[derive(Debug, Default)]
pub(crate) struct Pool(Mutex<Vec<Rows>>);

impl Pool {
    fn lock(&self) -> MutexGuard<'_, Vec<Rows>> {
        // what a thread that panicked left is memory still
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
    use crate::segments::{EightRows, Event, Segment};
    use rayweave_math::Vec3;

    const EIGHT: [f64; 8] = [0.0; 8];

    /// Rows of rays `id..id + 8` after so many events.
    fn add_eight(rows: &mut Rows, id: i64, events: u32) -> i64 {
        let parent = if events == 0 { -1 } else { rows.parent_abreast(events - 1) - 8 };
        rows.abreast_at(events).extend(&EightRows {
            id: std::array::from_fn(|lane| id + lane as i64),
            parent: std::array::from_fn(|lane| if parent < 0 { -1 } else { parent + lane as i64 }),
            generation: [events; 8],
            source: &[0; 8],
            wavelength_nm: &EIGHT,
            intensity: &EIGHT,
            index: EIGHT,
            start: [EIGHT; 3],
            end: [EIGHT; 3],
            direction: [EIGHT; 3],
            path: EIGHT,
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
    fn rows_stand_as_if_all_rays_had_been_alone() {
        let mut rows = Rows::default();
        add_eight(&mut rows, 0, 0);
        add_eight(&mut rows, 0, 1);
        let last = rows.parent_abreast(1) - 8;
        add_eight(&mut rows, 16, 0);
        rows.rounds.push(0);
        let alone: Vec<i64> = (8..16).map(|id| add_single(&mut rows, id, 0, -1)).collect();
        rows.rounds.push(rows.single.len());
        // ray 9 is split; rays 0 to 7 go on alone after two events, those of 16 to 23 after one
        let nine = [add_single(&mut rows, 9, 1, alone[1]), add_single(&mut rows, 9, 1, alone[1])];
        let first = rows.parent_abreast(0) - 8;
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
