//! The exact boolean algebra of root-rays: one sweep over the merged roots, with a counter of the solids inside.

use crate::{CountRule, Root, RootRay, Side};

/// One operand of the sweep; a complement borrows the roots of its operand.
struct Operand<'a, S> {
    start: Side,
    roots: &'a [Root<S>],
}

/// A root with the operand that it belongs to, in the order of the sweep.
struct BoundaryEvent<'a, S> {
    root: &'a Root<S>,
    operand: usize,
}

/// The state of the sweep between two distinct times.
struct Counter {
    rule: CountRule,
    /// For each operand, whether the trajectory is inside it.
    inside: Vec<bool>,
    /// The number of operands that it is inside of.
    count: usize,
}

impl Counter {
    fn new<S>(rule: CountRule, operands: &[Operand<'_, S>]) -> Self {
        let inside: Vec<bool> = operands.iter().map(|operand| operand.start.is_inside()).collect();
        let count = inside.iter().filter(|&&inside| inside).count();
        Self { rule, inside, count }
    }

    fn is_inside(&self) -> bool {
        self.rule.is_inside(self.count)
    }

    /// Toggles all operands with roots at one time. Returns the event to which the crossing is attributed, or `None` if the state
    /// does not change.
    fn cross<'f, 'a, S>(&mut self, tied: &'f [BoundaryEvent<'a, S>]) -> Option<&'f BoundaryEvent<'a, S>> {
        let before = self.count;
        for event in tied {
            self.toggle(event.operand);
        }
        if self.rule.is_inside(before) == self.is_inside() {
            return None;
        }
        tied.iter().find(|event| self.decides(event.operand, before)).or(tied.first())
    }

    fn toggle(&mut self, operand: usize) {
        self.count = toggled(self.count, self.inside[operand]);
        self.inside[operand] = !self.inside[operand];
    }

    /// Whether the event of `operand` alone changes the state before, or the event undone changes the state after.
    fn decides(&self, operand: usize, before: usize) -> bool {
        let inside_after = self.inside[operand];
        let alone = toggled(before, !inside_after);
        let undone = toggled(self.count, inside_after);
        self.rule.is_inside(alone) != self.rule.is_inside(before)
            || self.rule.is_inside(undone) != self.rule.is_inside(self.count)
    }
}

/// The count after an operand, `inside` before, has changed sides.
fn toggled(count: usize, inside: bool) -> usize {
    if inside { count - 1 } else { count + 1 }
}

/// Sweeps over the roots of all operands: O(n log n) for n roots, O(n log k) for k operands, because the sort merges sorted runs.
fn sweep<S: Clone>(rule: CountRule, operands: &[Operand<'_, S>]) -> RootRay<S> {
    let mut counter = Counter::new(rule, operands);
    let start = Side::from_inside(counter.is_inside());
    let roots = merged(operands)
        .chunk_by(|a, b| a.root.t == b.root.t)
        .filter_map(|tied| counter.cross(tied))
        .map(|event| event.root.clone())
        .collect();
    RootRay::from_ordered(start, roots)
}

/// All roots, sorted by time, then by operand.
fn merged<'a, S>(operands: &[Operand<'a, S>]) -> Vec<BoundaryEvent<'a, S>> {
    let mut events = Vec::with_capacity(operands.iter().map(|operand| operand.roots.len()).sum());
    for (index, operand) in operands.iter().enumerate() {
        events.extend(operand.roots.iter().map(|root| BoundaryEvent { root, operand: index }));
    }
    // stable: operands of equal times stay in order, and the sort exploits the operands' sorted runs
    events.sort_by(|a, b| a.root.t.total_cmp(&b.root.t));
    events
}

fn operands<'a, S: 'a>(rays: impl IntoIterator<Item = &'a RootRay<S>>) -> Vec<Operand<'a, S>> {
    rays.into_iter().map(|ray| Operand { start: ray.start(), roots: ray.roots() }).collect()
}

/// Boolean operations. If several operands cross at the same time, the crossing is attributed to the first operand whose event
/// alone changes the state before, or whose event undone changes the state after. If there is no such operand, it is attributed
/// to the first operand that crosses there.
impl<S: Clone> RootRay<S> {
    /// Inside where `self` is outside.
    #[must_use]
    pub fn complement(&self) -> Self {
        Self::from_ordered(!self.start(), self.roots().to_vec())
    }

    /// Inside where either is inside.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self::union_all([self, other])
    }

    /// Inside where both are inside.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        Self::intersection_all([self, other])
    }

    /// Inside where `self` is inside and `other` is not.
    #[must_use]
    pub fn difference(&self, other: &Self) -> Self {
        let complement = Operand { start: !other.start(), roots: other.roots() };
        let own = Operand { start: self.start(), roots: self.roots() };
        sweep(CountRule::AtLeast(2), &[own, complement])
    }

    /// Inside where exactly one is inside.
    #[must_use]
    pub fn symmetric_difference(&self, other: &Self) -> Self {
        Self::symmetric_difference_all([self, other])
    }

    /// Inside where at least one of `rays` is inside; the union of none is empty. O(n log n) for n roots.
    pub fn union_all<'a>(rays: impl IntoIterator<Item = &'a Self>) -> Self
    where
        S: 'a,
    {
        Self::at_least(1, rays)
    }

    /// Inside where all of `rays` are inside; the intersection of none is the universe. O(n log n) for n roots.
    pub fn intersection_all<'a>(rays: impl IntoIterator<Item = &'a Self>) -> Self
    where
        S: 'a,
    {
        let operands = operands(rays);
        sweep(CountRule::AtLeast(operands.len()), &operands)
    }

    /// Inside where an odd number of `rays` is inside; of none, empty. O(n log n) for n roots.
    pub fn symmetric_difference_all<'a>(rays: impl IntoIterator<Item = &'a Self>) -> Self
    where
        S: 'a,
    {
        sweep(CountRule::Odd, &operands(rays))
    }

    /// Inside where at least `threshold` of `rays` are inside. O(n log n) for n roots in all.
    pub fn at_least<'a>(threshold: usize, rays: impl IntoIterator<Item = &'a Self>) -> Self
    where
        S: 'a,
    {
        sweep(CountRule::AtLeast(threshold), &operands(rays))
    }
}
