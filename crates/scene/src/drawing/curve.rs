//! Curves of drawings, and their join to contours.

use rayweave_polygon::{Corner, Vertex};

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
pub fn joined(mut segments: Vec<Segment>) -> Result<Contours, String> {
    let within = JOINT * size(segments.iter().flat_map(|s| [s.from, s.to]));
    let distance = |a: [f64; 2], b: [f64; 2]| libm::hypot(a[0] - b[0], a[1] - b[1]);
    let mut contours = Vec::new();
    while let Some(first) = segments.pop() {
        let mut contour = vec![vertex(first.from, first.bulge)];
        let mut end = first.to;
        while distance(end, first.from) > within {
            let near = |s: &Segment| distance(s.from, end).min(distance(s.to, end));
            let next = (0..segments.len()).min_by(|&a, &b| near(&segments[a]).total_cmp(&near(&segments[b])));
            let Some(next) = next.filter(|&next| near(&segments[next]) <= within) else {
                return Err(format!("a curve is open: it ends at ({}, {})", end[0], end[1]));
            };
            let mut segment = segments.swap_remove(next);
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
