//! Regions along lines.

use rayweave_model::{Evaluator, Query, RayAnswer, RayBatch, RegionId};

/// The regions along a line.
#[derive(Clone, Debug, Default)]
pub struct Spans {
    /// The region at the beginning; 0 stands for every region without a medium.
    pub start: usize,
    /// The places where the region changes, with the next one.
    pub changes: Vec<(f64, usize)>,
}

impl Spans {
    fn count_until(&self, t: f64) -> usize {
        self.changes.partition_point(|&(change, _)| change <= t)
    }

    pub fn region(&self, t: f64) -> usize {
        self.count_until(t).checked_sub(1).map_or(self.start, |k| self.changes[k].1)
    }

    pub fn is_in(&self, t: f64) -> bool {
        self.region(t) != 0
    }

    /// The first change after t.
    fn next(&self, t: f64) -> Option<f64> {
        self.changes.get(self.count_until(t)).map(|&(change, _)| change)
    }

    /// The last change before t.
    fn before(&self, t: f64) -> Option<f64> {
        let count = self.changes.partition_point(|&(change, _)| change < t);
        count.checked_sub(1).map(|k| self.changes[k].0)
    }

    /// The first change from t on in a direction.
    pub fn onward(&self, t: f64, sign: f64) -> Option<f64> {
        if sign > 0.0 { self.next(t) } else { self.before(t) }
    }

    /// The places where material begins or ends.
    pub fn ends(&self) -> impl Iterator<Item = f64> {
        let before = std::iter::once(self.start).chain(self.changes.iter().map(|&(_, region)| region));
        let is_end = |&(&(_, after), before): &(&(f64, usize), usize)| (after == 0) != (before == 0);
        self.changes.iter().zip(before).filter(is_end).map(|(&(t, _), _)| t)
    }
}

/// The spans of rays.
pub fn spans_along<E: Evaluator>(evaluator: &E, batch: &RayBatch, scratch: &mut E::Scratch) -> Vec<Spans> {
    let program = evaluator.program();
    let number = |region: RegionId| if program.medium_of(region) == 0 { 0 } else { region.index() };
    let mut found = vec![Spans::default(); batch.len()];
    let mut sink = |answer: RayAnswer<'_>| {
        let changes = answer.crossings.iter().filter(|c| number(c.before) != number(c.after));
        let changes = changes.map(|crossing| (crossing.t, number(crossing.after))).collect();
        found[answer.ray] = Spans { start: number(answer.start), changes };
    };
    evaluator.crossings(batch.rays(), &Query::default(), scratch, &mut sink);
    found
}
