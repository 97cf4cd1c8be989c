//! Memory for one group and a chunk of columns.

use super::{MAX_PAIRS, WIDTH};
use crate::accel::Accel;
use crate::spans::column_query::ColumnQuery;
use rayweave_model::{Event, LeafEvents, Query};
use rayweave_rootray::Side;
use rayweave_rootray::hit_array::{HitArrayBuf, MergedHits};
use std::ops::Range;

/// The buffers of one nesting level.
#[derive(Clone, Debug)]
pub(super) struct Level<P> {
    /// The rays or points, in the frame of the group.
    pub queries: Vec<P>,
    pub touched: Touched,
    /// A hit array for each slot of the schedule.
    pub arrays: Vec<HitArrayBuf>,
    /// Entries of the operands of a gate; in the end those of the outputs, each tagged with its output.
    pub merged: MergedHits,
    pub leaf: LeafEvents,
    pub events: EventLists,
}

impl<P> Default for Level<P> {
    fn default() -> Self {
        Level {
            queries: Vec::new(),
            touched: Touched::default(),
            arrays: Vec::new(),
            merged: MergedHits::default(),
            leaf: LeafEvents::default(),
            events: EventLists::default(),
        }
    }
}

/// The columns that can touch each leaf.
#[derive(Clone, Debug, Default)]
pub(super) struct Touched {
    /// (leaf, column) pairs, column by column.
    pairs: Vec<(u32, u32)>,
    leaves: Vec<u32>,
    /// The columns of each leaf, one after the other, and the end of each leaf's range.
    columns: Vec<u32>,
    ends: Vec<u32>,
}

impl Touched {
    /// Takes as many columns as fit into a chunk. Returns their number.
    pub fn fill(
        &mut self,
        queries: &[impl ColumnQuery],
        accel: &Accel,
        leaves: usize,
        query: &Query<'_>,
    ) -> usize {
        self.pairs.clear();
        let mut width = 0;
        for column in queries.iter().take(WIDTH) {
            self.leaves.clear();
            column.intersected_leaves(accel, query, &mut self.leaves);
            if width > 0 && self.pairs.len() + self.leaves.len() > MAX_PAIRS {
                break;
            }
            self.pairs.extend(self.leaves.iter().map(|&leaf| (leaf, width as u32)));
            width += 1;
        }
        self.by_leaf(leaves);
        width
    }

    fn by_leaf(&mut self, leaves: usize) {
        self.ends.clear();
        self.ends.resize(leaves, 0);
        self.pairs.iter().for_each(|pair| self.ends[pair.0 as usize] += 1);
        let mut total = 0;
        for end in &mut self.ends {
            (*end, total) = (total, total + *end);
        }
        self.columns.clear();
        self.columns.resize(total as usize, 0);
        for &(leaf, column) in &self.pairs {
            let end = &mut self.ends[leaf as usize];
            self.columns[*end as usize] = column;
            *end += 1;
        }
    }

    /// The columns that can touch a leaf, in order.
    pub fn columns(&self, leaf: u32) -> &[u32] {
        let first = leaf.checked_sub(1).map_or(0, |before| self.ends[before as usize]);
        &self.columns[first as usize..self.ends[leaf as usize] as usize]
    }
}

/// The boundary events of leaves, by column.
#[derive(Clone, Debug, Default)]
pub(super) struct EventLists {
    /// In the order of computation, leaf by leaf.
    found: Vec<(u32, Event)>,
    events: Vec<Event>,
    ends: Vec<usize>,
}

impl EventLists {
    pub fn clear(&mut self) {
        self.found.clear();
    }

    /// Appends a boundary event; t = -inf marks a leaf that is inside from the start.
    pub fn push(&mut self, column: u32, event: Event) {
        self.found.push((column, event));
    }

    /// The number of events.
    pub fn len(&self) -> usize {
        self.found.len()
    }

    /// Writes a column of a hit array from the events appended after the first `mark`.
    pub fn fill_column(&self, mark: usize, column: u32, out: &mut HitArrayBuf) {
        let times = self.found[mark..].iter().map(|(_, event)| event.t);
        out.fill_column(column as usize, Side::Outside, times);
    }

    /// Sorts all events by column.
    pub fn sort(&mut self, columns: usize) {
        self.ends.clear();
        self.ends.resize(columns, 0);
        self.found.iter().for_each(|(column, _)| self.ends[*column as usize] += 1);
        let mut total = 0;
        for end in &mut self.ends {
            (*end, total) = (total, total + *end);
        }
        self.events.clear();
        let Some(&(_, any)) = self.found.first() else { return };
        self.events.resize(total, any);
        for (column, event) in &self.found {
            let end = &mut self.ends[*column as usize];
            self.events[*end] = *event;
            *end += 1;
        }
    }

    /// The events of a column, sorted by time, then leaf; valid after [`EventLists::sort`].
    pub fn column(&mut self, column: usize) -> &[Event] {
        let events = &mut self.events[range(&self.ends, column)];
        events.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.leaf.cmp(&b.leaf)));
        events
    }
}

fn range(ends: &[usize], column: usize) -> Range<usize> {
    column.checked_sub(1).map_or(0, |before| ends[before])..ends[column]
}
