//! The boundary events of the leaves of a group along one ray, computed once and looked up by every query.

use super::{LeafAnswers, Next};
use rayweave_model::{Event, Face};

/// The boundary events of one leaf.
#[derive(Clone, Copy, Debug, Default)]
struct EventRange {
    first: u32,
    end: u32,
    starts_inside: bool,
}

/// The boundary events of the leaves of a group, leaf by leaf.
#[derive(Clone, Debug, Default)]
pub(super) struct Roots {
    ranges: Vec<EventRange>,
    events: Vec<(f64, Face)>,
}

impl Roots {
    /// Removes all leaves; the memory is kept.
    pub fn clear(&mut self) {
        self.ranges.clear();
        self.events.clear();
    }

    /// Appends the next leaf with its boundary events in order of time.
    pub fn enter(&mut self, starts_inside: bool, events: impl Iterator<Item = (f64, Face)>) {
        let first = self.events.len() as u32;
        self.events.extend(events);
        self.ranges.push(EventRange { first, end: self.events.len() as u32, starts_inside });
    }

    fn leaf_events(&self, leaf: u32) -> (bool, &[(f64, Face)]) {
        let range = self.ranges[leaf as usize];
        (range.starts_inside, &self.events[range.first as usize..range.end as usize])
    }

    /// The side of a leaf just after `t`, and the next boundary event.
    fn after(&self, leaf: u32, t: f64) -> (bool, Option<&(f64, Face)>) {
        let (starts_inside, events) = self.leaf_events(leaf);
        let passed = events.partition_point(|event| event.0 <= t);
        (starts_inside ^ (passed % 2 == 1), events.get(passed))
    }

    /// True if a leaf is inside just after `t`.
    pub fn is_inside(&self, leaf: u32, t: f64) -> bool {
        self.after(leaf, t).0
    }

    /// The face that a leaf crosses next after `t`.
    pub fn next_face(&self, leaf: u32, t: f64) -> Option<Face> {
        self.after(leaf, t).1.map(|event| event.1)
    }

    /// Appends the boundary events of all leaves with `after < t <= to`, sorted by time, then leaf.
    pub fn events(&self, after: f64, to: f64, out: &mut Vec<Event>) {
        let old = out.len();
        for leaf in 0..self.ranges.len() as u32 {
            let events = self.leaf_events(leaf).1;
            let [first, end] = [after, to].map(|t| events.partition_point(|event| event.0 <= t));
            out.extend(events[first..end].iter().map(|&(t, face)| Event { t, leaf, face }));
        }
        out[old..].sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.leaf.cmp(&b.leaf)));
    }
}

impl LeafAnswers for Roots {
    fn next(&self, leaf: u32, t_min: f64) -> Next {
        let (inside, event) = self.after(leaf, t_min);
        Next::new(inside, event.map(|event| event.0))
    }
}
