//! First pass: one sample per pixel.

use crate::Size;
use crate::extent::Extent;
use crate::sample::Sample;
use std::ops::Range;

/// The first surfaces at the centre of each pixel; `levels` samples per pixel, stored only inside the extent.
pub(crate) struct FirstPass {
    pub size: Size,
    pub extent: Extent,
    pub levels: usize,
    pub rows: Vec<Vec<Sample>>,
}

impl FirstPass {
    /// A first pass whose samples are still to be computed.
    pub fn new(size: Size, extent: Extent, levels: usize) -> FirstPass {
        let rows = vec![Vec::new(); size.height()];
        FirstPass { size, extent, levels, rows }
    }

    /// The sample of a pixel at a level.
    pub fn at(&self, x: usize, y: usize, level: usize) -> &Sample {
        let columns = self.extent.columns(y);
        if columns.contains(&x) {
            &self.rows[y][(x - columns.start) * self.levels + level]
        } else {
            &Sample::MISS
        }
    }

    /// The columns of a row that can differ from their right or lower neighbours.
    pub fn busy_columns(&self, y: usize) -> Range<usize> {
        let here = self.extent.columns(y);
        let below = self.extent.columns((y + 1).min(self.size.height() - 1));
        let (start, end) = match (here.is_empty(), below.is_empty()) {
            (true, _) => (below.start, below.end),
            (_, true) => (here.start, here.end),
            _ => (here.start.min(below.start), here.end.max(below.end)),
        };
        start.saturating_sub(1)..end
    }
}
