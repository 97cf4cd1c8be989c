//! The boundary events of the leaves of a group along one ray, computed once and looked up by every query.

use super::{LeafAnswers, Next};
use rayweave_model::{Event, Face};

/// The boundary events of one leaf.
#[derive(Clone, Copy, Debug, Default)]
struct Span {
    first: u32,
    end: u32,
    starts_inside: bool,
}

/// The boundary events of the leaves of a group, leaf by leaf.
#[derive(Clone, Debug, Default)]
pub(super) struct Roots {
    spans: Vec<Span>,
    flips: Vec<(f64, Face)>,
}

impl Roots {
    /// Removes all leaves; the memory is kept.
    pub fn clear(&mut self) {
        self.spans.clear();
        self.flips.clear();
    }

    /// Appends the next leaf with its boundary events in order of time.
    pub fn enter(&mut self, starts_inside: bool, flips: impl Iterator<Item = (f64, Face)>) {
        let first = self.flips.len() as u32;
        self.flips.extend(flips);
        self.spans.push(Span { first, end: self.flips.len() as u32, starts_inside });
    }

    fn flips(&self, leaf: u32) -> (bool, &[(f64, Face)]) {
        let span = self.spans[leaf as usize];
        (span.starts_inside, &self.flips[span.first as usize..span.end as usize])
    }

    /// The side of a leaf just after `t`, and the next boundary event.
    fn after(&self, leaf: u32, t: f64) -> (bool, Option<&(f64, Face)>) {
        let (starts_inside, flips) = self.flips(leaf);
        let passed = flips.partition_point(|flip| flip.0 <= t);
        (starts_inside ^ (passed % 2 == 1), flips.get(passed))
    }

    /// True if a leaf is inside just after `t`.
    pub fn is_inside(&self, leaf: u32, t: f64) -> bool {
        self.after(leaf, t).0
    }

    /// The face that a leaf crosses next after `t`.
    pub fn next_face(&self, leaf: u32, t: f64) -> Option<Face> {
        self.after(leaf, t).1.map(|flip| flip.1)
    }

    /// Appends the boundary events of all leaves with `after < t <= to`, sorted by time, then leaf.
    pub fn events(&self, after: f64, to: f64, out: &mut Vec<Event>) {
        let old = out.len();
        for leaf in 0..self.spans.len() as u32 {
            let flips = self.flips(leaf).1;
            let [first, end] = [after, to].map(|t| flips.partition_point(|flip| flip.0 <= t));
            out.extend(flips[first..end].iter().map(|&(t, face)| Event { t, leaf, face }));
        }
        out[old..].sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.leaf.cmp(&b.leaf)));
    }
}

impl LeafAnswers for Roots {
    fn next(&self, leaf: u32, t_min: f64) -> Next {
        let (inside, flip) = self.after(leaf, t_min);
        Next::new(inside, flip.map(|flip| flip.0))
    }
}
