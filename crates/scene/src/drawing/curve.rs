//! Curves of drawings, and their join to contours.

use rayweave_polygon::{Corner, Vertex};
use std::collections::HashMap;

/// The contours of a drawing.
pub type Contours = Vec<Vec<Vertex>>;

/// The largest distance between ends of curves that are joined, relative to the larger side of the drawing: programs write six digits.
pub(super) const JOINT: f64 = 1e-5;

/// The largest distance of chords from the Bézier curves that they replace, relative to the larger side of the drawing.
pub(super) const CHORD: f64 = 1e-5;

/// A curve between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    pub from: [f64; 2],
    pub to: [f64; 2],
    pub bulge: f64,
}

/// A vertex with a sharp corner.
pub fn vertex(at: [f64; 2], bulge: f64) -> Vertex {
    Vertex { at, bulge, corner: Corner::Sharp }
}

/// The larger side of the box around points.
pub fn size(points: impl Iterator<Item = [f64; 2]>) -> f64 {
    let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for p in points {
        for (own, x) in bounds.iter_mut().zip(p) {
            *own = [own[0].min(x), own[1].max(x)];
        }
    }
    bounds.iter().map(|[lo, hi]| hi - lo).fold(0.0, f64::max)
}

/// Joins curves at their ends to closed contours.
pub fn joined(segments: Vec<Segment>) -> Result<Contours, String> {
    let within = JOINT * size(segments.iter().flat_map(|s| [s.from, s.to]));
    let mut ends = Ends::new(&segments, within);
    let mut contours = Vec::new();
    for (number, first) in segments.iter().enumerate().rev() {
        if !ends.take(number) {
            continue;
        }
        let mut contour = vec![vertex(first.from, first.bulge)];
        let mut end = first.to;
        while distance(end, first.from) > within {
            let Some(mut segment) = ends.take_nearest(end).map(|next| segments[next]) else {
                return Err(format!("a curve is open: it ends at ({}, {})", end[0], end[1]));
            };
            if distance(segment.to, end) < distance(segment.from, end) {
                segment = Segment { from: segment.to, to: segment.from, bulge: -segment.bulge };
            }
            contour.push(vertex(segment.from, segment.bulge));
            end = segment.to;
        }
        contours.push(contour);
    }
    contours.reverse();
    Ok(contours)
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

/// The ends of curves that are not joined yet, in square cells whose side is the largest distance of ends that are joined.
struct Ends<'s> {
    segments: &'s [Segment],
    within: f64,
    is_taken: Vec<bool>,
    cells: HashMap<[i64; 2], Vec<usize>>,
}

impl<'s> Ends<'s> {
    fn new(segments: &'s [Segment], within: f64) -> Ends<'s> {
        let is_taken = vec![false; segments.len()];
        let mut ends = Ends { segments, within, is_taken, cells: HashMap::new() };
        for (number, segment) in segments.iter().enumerate() {
            for end in [segment.from, segment.to] {
                ends.cells.entry(ends.cell(end)).or_default().push(number);
            }
        }
        ends
    }

    fn cell(&self, at: [f64; 2]) -> [i64; 2] {
        at.map(|x| (x / self.within).floor() as i64)
    }

    /// Removes a curve; false if it was removed before.
    fn take(&mut self, number: usize) -> bool {
        !std::mem::replace(&mut self.is_taken[number], true)
    }

    /// Removes the curve with the nearest end, if it is near enough; of equally near ones the first.
    fn take_nearest(&mut self, at: [f64; 2]) -> Option<usize> {
        let [x, y] = self.cell(at);
        let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [x.saturating_add(i), y.saturating_add(j)]));
        let mut nearest: Option<(f64, usize)> = None;
        for cell in around {
            let Some(numbers) = self.cells.get_mut(&cell) else { continue };
            numbers.retain(|&number| !self.is_taken[number]);
            for &number in &*numbers {
                let Segment { from, to, .. } = self.segments[number];
                let found = (distance(from, at).min(distance(to, at)), number);
                if found.0 <= self.within && nearest.is_none_or(|best| found < best) {
                    nearest = Some(found);
                }
            }
        }
        let (_, number) = nearest?;
        self.take(number);
        Some(number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sides of many squares, in an order and with senses without a system, also squares that share a corner.
    #[test]
    fn sides_of_squares_are_joined_whatever_their_order() {
        let mut sides = Vec::new();
        let count = 40;
        for k in 0..count {
            let at = f64::from(k);
            let corners = [[at, at], [at + 1.0, at], [at + 1.0, at + 1.0], [at, at + 1.0]];
            for i in 0..4 {
                let (from, to) = (corners[i], corners[(i + 1) % 4]);
                let bulge = if i == 0 { 0.5 } else { 0.0 };
                sides.push(if k % 3 == 0 {
                    Segment { from: to, to: from, bulge: -bulge }
                } else {
                    Segment { from, to, bulge }
                });
            }
        }
        // a permutation: 7 and 160 have no common factor
        let mixed: Vec<Segment> = (0..sides.len()).map(|k| sides[7 * k % sides.len()]).collect();
        let contours = joined(mixed).unwrap();
        let vertices: Vec<Vertex> = contours.concat();
        assert_eq!(vertices.len(), 4 * count as usize);
        assert_eq!(vertices.iter().filter(|vertex| vertex.bulge.abs() == 0.5).count(), count as usize);
        for contour in &contours {
            // sides have length 1, so the contours are closed
            for (a, b) in contour.iter().zip(contour.iter().cycle().skip(1)) {
                assert_eq!(distance(a.at, b.at), 1.0, "{contour:?}");
            }
        }
        sides.pop();
        assert!(joined(sides).unwrap_err().starts_with("a curve is open: it ends at ("));
    }
}
