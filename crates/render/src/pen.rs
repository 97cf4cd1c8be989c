//! Line drawing: the neighbourhood in which an edge draws a line.

use crate::Lines;
use crate::colour::{Premultiplied, premultiply};
use crate::contrast::EdgeKind;

/// A pen: the neighbours that a sample is compared with.
pub(crate) struct Pen {
    /// Offsets on the grid of samples, nearest first, each with a flag: true if creases are drawn there.
    offsets: Vec<([isize; 2], bool)>,
    pub colour: Premultiplied,
    /// The greatest offset in pixels, at least 1.
    pub reach: usize,
}

/// The width of creases relative to that of outlines.
const CREASE_WIDTH: f64 = 0.6;

impl Pen {
    /// A line of width w covers the samples within w / 2 of the edge, which is half-way between two samples.
    /// At one sample per pixel every line would be two pixels wide, so only the neighbours on two sides are
    /// compared.
    pub fn new(lines: &Lines, samples: u32) -> Pen {
        let within = |width: f64| 0.5 * width * f64::from(samples) + 0.5;
        let (far, near) = (within(lines.width), within(CREASE_WIDTH * lines.width).max(1.0));
        let reach = if lines.width > 0.0 { far.max(1.0) as isize } else { 0 };
        let distance = |[x, y]: [isize; 2]| ((x * x + y * y) as f64).sqrt();
        let mut offsets: Vec<_> = (-reach..=reach)
            .flat_map(|y| (-reach..=reach).map(move |x| [x, y]))
            .filter(|&at| at != [0, 0] && distance(at) <= far.max(1.0))
            .filter(|&[x, y]| samples > 1 || (x >= 0 && y >= 0))
            .map(|at| (at, distance(at) <= near))
            .collect();
        offsets.sort_by(|a, b| distance(a.0).total_cmp(&distance(b.0)));
        Pen {
            offsets,
            colour: premultiply(lines.colour.linear(), lines.colour.opacity()),
            reach: reach.unsigned_abs().div_ceil(samples as usize).max(1),
        }
    }

    /// True if a line covers the sample; `edge` returns the kind of edge between it and the one at an offset.
    pub fn touches(&self, edge: impl Fn([isize; 2]) -> EdgeKind) -> bool {
        self.offsets.iter().any(|&(offset, creases_count)| {
            let least = if creases_count { EdgeKind::Crease } else { EdgeKind::Outline };
            edge(offset) >= least
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of samples of a row that a line covers, with the edge between 0 and -1.
    fn covered(width: f64, samples: u32, edge: EdgeKind) -> usize {
        let lines = Lines { width, ..Lines::default() };
        let pen = Pen::new(&lines, samples);
        let differ =
            |x: isize| pen.touches(|[dx, _]| if (x < 0) != (x + dx < 0) { edge } else { EdgeKind::None });
        (-99..99).filter(|&x| differ(x)).count()
    }

    #[test]
    fn lines_have_the_requested_width() {
        assert_eq!(covered(1.0, 1, EdgeKind::Outline), 1);
        assert_eq!(covered(1.0, 2, EdgeKind::Outline), 2);
        assert_eq!(covered(1.5, 4, EdgeKind::Outline), 6);
        assert_eq!(covered(8.0, 16, EdgeKind::Outline), 128);
        assert_eq!(covered(2.5, 4, EdgeKind::Crease), 6);
        assert_eq!(covered(0.0, 4, EdgeKind::Outline), 0);
        assert_eq!(covered(4.0, 4, EdgeKind::None), 0);
    }
}
