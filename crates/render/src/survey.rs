//! The first look: one sample per pixel.

use crate::Size;
use crate::extent::Extent;
use crate::sample::Sample;
use std::ops::Range;

/// One sample per pixel, at its centre. Samples are kept only where something may be seen.
pub(crate) struct Survey {
    pub size: Size,
    pub extent: Extent,
    pub rows: Vec<Vec<Sample>>,
}

static MISS: Sample = Sample::MISS;

impl Survey {
    /// A survey with all samples still to be taken.
    pub fn new(size: Size, extent: Extent) -> Survey {
        let rows = vec![Vec::new(); size.height()];
        Survey { size, extent, rows }
    }

    /// The sample of a pixel of the picture.
    pub fn at(&self, x: usize, y: usize) -> &Sample {
        let columns = self.extent.columns(y);
        if columns.contains(&x) { &self.rows[y][x - columns.start] } else { &MISS }
    }

    /// The columns of a row that may differ from their right or lower neighbours.
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

/// The centre of a pixel.
pub(crate) fn centre(x: usize, y: usize) -> [f64; 2] {
    [x as f64 + 0.5, y as f64 + 0.5]
}
