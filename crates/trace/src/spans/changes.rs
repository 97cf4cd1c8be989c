//! The changes of the owner of a group along a ray, from the hit arrays of all outputs.

use rayweave_model::gate::OutputSet;
use rayweave_rootray::hit_array::MergedHit;

/// A change of the owner: the number of the last output that is inside, from 1, or 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Switch {
    pub t: f64,
    pub before: u32,
    pub after: u32,
}

/// The changes of one ray, in order of time.
pub(super) struct Changes<'a> {
    /// The entries of all outputs, each tagged with its output.
    hits: &'a [MergedHit],
    outputs: &'a mut OutputSet,
    done: usize,
}

impl<'a> Changes<'a> {
    /// Starts at t = -inf. `outputs` holds the outputs that are inside where no array has an entry, and is
    /// restored on drop.
    pub fn new(hits: &'a [MergedHit], outputs: &'a mut OutputSet) -> Self {
        let mut changes = Changes { hits, outputs, done: 0 };
        changes.pass(hits.partition_point(|hit| hit.t == f64::NEG_INFINITY));
        changes
    }

    /// The current owner: before any call of `next`, at t = -inf.
    pub fn now(&self) -> u32 {
        self.outputs.last()
    }

    /// True if no entry is left.
    pub fn is_over(&self) -> bool {
        self.done == self.hits.len()
    }

    /// Inverts the outputs of the next `count` entries.
    fn pass(&mut self, count: usize) {
        self.hits[self.done..][..count].iter().for_each(|hit| toggle(self.outputs, hit.tag));
        self.done += count;
    }
}

impl Iterator for Changes<'_> {
    type Item = Switch;

    fn next(&mut self) -> Option<Switch> {
        while let Some(&MergedHit { t, .. }) = self.hits.get(self.done) {
            let before = self.now();
            self.pass(self.hits[self.done..].iter().take_while(|hit| hit.t == t).count());
            let after = self.now();
            if before != after {
                return Some(Switch { t, before, after });
            }
        }
        None
    }
}

impl Drop for Changes<'_> {
    fn drop(&mut self) {
        self.hits[..self.done].iter().for_each(|hit| toggle(self.outputs, hit.tag));
    }
}

fn toggle(outputs: &mut OutputSet, output: u32) {
    outputs.set(output, !outputs.get(output));
}
