//! Events with overlapping intervals, in an order that the device does not know.
//!
//! The device returns up to four such events, with the region after each subset of them: one of two, whose media differ. The CPU
//! computes their times and applies them in order, those at exactly one time together. If the region changes once, this is the
//! crossing. Its face is that of the lowest leaf whose event alone matters there, as in [`rayweave_model::weld`]. A crossing is welded
//! only to other changes within the intervals, and there are none.

/// The greatest number of tied events.
pub(crate) const MOST_TIED: usize = 4;

/// Tied events as the device returns them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Tied {
    /// Bit s is 1 if the events in the set s change the region.
    table: u16,
    /// The differences between the facets of the other events and that of the first; 0 if there is no other.
    offsets: [i16; MOST_TIED - 1],
}

/// A tied event with its time.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TiedEvent {
    pub t: f64,
    /// Facets are numbered in the order of the leaves.
    pub facet: usize,
    /// The placed solid of the group that has the facet, counted from 1; 0 if the group itself has it.
    pub instance: u32,
}

impl Tied {
    pub fn new(bits: u64) -> Tied {
        let part = |k: u32| (bits >> (16 * k)) as u16;
        Tied { table: part(0), offsets: [1, 2, 3].map(|k| part(k) as i16) }
    }

    /// The number of events.
    pub fn count(self) -> usize {
        1 + self.offsets.iter().take_while(|&&offset| offset != 0).count()
    }

    /// The facet of an event, given that of the first.
    pub fn facet(self, first: usize, k: usize) -> usize {
        k.checked_sub(1).map_or(first, |k| first.wrapping_add_signed(self.offsets[k].into()))
    }

    fn changes(self, set: usize) -> bool {
        self.table >> set & 1 == 1
    }

    /// The event to which the crossing belongs, and its time; `None` if the region changes more than once, if two events
    /// of one placed solid coincide, or if no event alone matters.
    pub fn crossing(self, events: &[TiedEvent]) -> Option<(usize, f64)> {
        let mut order: Vec<usize> = (0..events.len()).collect();
        order.sort_by(|&a, &b| {
            events[a].t.total_cmp(&events[b].t).then(events[a].facet.cmp(&events[b].facet))
        });
        let (mut found, mut set) = (None, 0);
        for group in order.chunk_by(|&a, &b| events[a].t == events[b].t) {
            let before = set;
            for (n, &k) in group.iter().enumerate() {
                let instance = events[k].instance;
                if instance != 0 && group[..n].iter().any(|&other| events[other].instance == instance) {
                    return None;
                }
                set |= 1 << k;
            }
            if self.changes(before) == self.changes(set) {
                continue;
            }
            if found.is_some() {
                return None;
            }
            let matters = |&&k: &&usize| {
                self.changes(before | 1 << k) != self.changes(before)
                    || self.changes(set & !(1 << k)) != self.changes(set)
            };
            let face = *group.iter().find(matters)?;
            found = Some((face, events[face].t));
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn events(times: &[f64]) -> Vec<TiedEvent> {
        times.iter().enumerate().map(|(k, &t)| TiedEvent { t, facet: 10 + k, instance: 0 }).collect()
    }

    #[test]
    fn events_are_read_as_the_device_writes_them() {
        let tied = Tied::new(0xfffe_0003_8000);
        assert_eq!((tied.table, tied.offsets, tied.count()), (0x8000, [3, -2, 0], 3));
        assert_eq!([0, 1, 2].map(|k| tied.facet(7, k)), [7, 10, 5]);
    }

    /// A union is entered at the first of its faces, an intersection at the last.
    #[test]
    fn unions_and_intersections() {
        let union = Tied { table: 0b1110, offsets: [1, 0, 0] };
        let both = Tied { table: 0b1000, ..union };
        let times = [2.0, 1.5];
        assert_eq!(union.crossing(&events(&times)), Some((1, 1.5)));
        assert_eq!(both.crossing(&events(&times)), Some((0, 2.0)));
        // at one time the lowest leaf has the face
        let once = [1.0; 2];
        assert_eq!([union, both].map(|tied| tied.crossing(&events(&once))), [Some((0, 1.0)); 2]);
        // events of one placed solid at one time are left to the CPU's evaluators
        let mut same = events(&once);
        same.iter_mut().for_each(|event| event.instance = 3);
        assert_eq!(union.crossing(&same), None);
    }

    /// Leaving one solid and entering another is one change only if they touch at exactly one time.
    #[test]
    fn a_change_there_and_back_is_not_clear() {
        // entered by the first or the second event, left by both, entered again by all three
        let tied = Tied { table: 0b1000_0110, offsets: [1, 2, 0] };
        assert_eq!(tied.crossing(&events(&[1.0, 2.0, 3.0])), None);
        assert_eq!(tied.crossing(&events(&[1.0, 1.0, 3.0])), Some((2, 3.0)));
        assert_eq!(tied.crossing(&events(&[1.0, 2.0, 2.0])), Some((0, 1.0)));
    }
}
