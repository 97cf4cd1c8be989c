//! Sweep-line algorithm over all edges: detects intersecting edges, and finds the edge below each contour.
//!
//! *Source*: M. I. Shamos and D. Hoey, "Geometric intersection problems", FOCS 1976. A line moves over the plane in
//! lexicographic order (x, then y). The edges that it crosses are stored in their order along it, and only neighbours are
//! compared. The first two edges that intersect become neighbours before the line reaches their intersection, so that
//! comparisons never involve edges that have crossed. All signs are exact.
//!
//! *Cost*: O(n log n) for n edges.

use crate::Point;
use crate::exact::orientation;
use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::ops::Bound;

/// Closed contours as linked lists of corners.
pub struct Contours<'a> {
    /// The corners of all contours.
    pub vertices: &'a [Point],
    /// The index of the next corner of the same contour; edge k goes from corner k to `next[k]`.
    pub next: &'a [u32],
    /// The contour of each corner.
    pub contour: &'a [u32],
}

/// The first corner of a contour in sweep order, with its surroundings.
#[derive(Clone, Copy, Debug)]
pub struct ContourStart {
    /// The contour.
    pub contour: u32,
    /// The first corner in lexicographic order.
    pub first: u32,
    /// The edge directly below that corner, if any, and whether it points to the right.
    pub below: Option<(u32, bool)>,
}

/// The contours in sweep order, or two edges that have a common point without being neighbours in their contour.
pub fn sweep(contours: &Contours<'_>) -> Result<Vec<ContourStart>, (u32, u32)> {
    let previous = previous(contours.next);
    let order = in_order(contours)?;
    let mut status = Status::default();
    let mut found = vec![false; contours.contour.iter().max().map_or(0, |&last| last as usize + 1)];
    let mut starts = Vec::new();
    for v in order {
        let edges = [previous[v as usize], v].map(|edge| Segment::new(contours, edge));
        let at = contours.vertices[v as usize];
        let ends = edges.map(|edge| edge.right == at);
        for edge in (0..2).filter(|&k| ends[k]).map(|k| &edges[k]) {
            status.remove(edge, ends[0] && ends[1])?;
        }
        for edge in (0..2).filter(|&k| !ends[k]).map(|k| edges[k]) {
            status.insert(edge)?;
        }
        let contour = contours.contour[v as usize];
        if !std::mem::replace(&mut found[contour as usize], true) {
            let lower = edges[0].min(edges[1]);
            let below = status.below(&lower).map(|edge| (edge.edge, edge.points_right));
            starts.push(ContourStart { contour, first: v, below });
        }
    }
    Ok(starts)
}

/// The corner before each corner.
pub fn previous(next: &[u32]) -> Vec<u32> {
    let mut previous = vec![0; next.len()];
    for (from, &to) in next.iter().enumerate() {
        previous[to as usize] = from as u32;
    }
    previous
}

/// All corners in lexicographic order, or the edges that begin in two coinciding corners.
fn in_order(contours: &Contours<'_>) -> Result<Vec<u32>, (u32, u32)> {
    let at = |v: u32| contours.vertices[v as usize];
    let mut order: Vec<u32> = (0..contours.vertices.len() as u32).collect();
    order.sort_by(|&a, &b| lexicographic(at(a), at(b)).then(a.cmp(&b)));
    match order.windows(2).find(|pair| at(pair[0]) == at(pair[1])) {
        Some(pair) => Err((pair[0], pair[1])),
        None => Ok(order),
    }
}

/// Lexicographic order by x, then y: the sweep order.
pub fn lexicographic(a: Point, b: Point) -> Ordering {
    a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
}

/// An edge, from left to right.
#[derive(Clone, Copy, Debug)]
struct Segment {
    left: Point,
    right: Point,
    edge: u32,
    points_right: bool,
}

impl Segment {
    fn new(contours: &Contours<'_>, edge: u32) -> Segment {
        let from = contours.vertices[edge as usize];
        let to = contours.vertices[contours.next[edge as usize] as usize];
        match lexicographic(from, to).is_lt() {
            true => Segment { left: from, right: to, edge, points_right: true },
            false => Segment { left: to, right: from, edge, points_right: false },
        }
    }

    /// The side of this edge's line on which a point lies: 1 above, 0 on it, -1 below.
    fn side(&self, point: Point) -> i8 {
        orientation(self.left, self.right, point)
    }

    /// True if the edges have a common point that is not an end of both.
    fn intersects(&self, other: &Segment) -> bool {
        let ends = [self.left, self.right];
        if ends.contains(&other.left) || ends.contains(&other.right) {
            // corners are distinct, and three consecutive ones are not collinear
            return false;
        }
        let over = |a: &Segment, b: &Segment| a.side(b.left) * a.side(b.right);
        let first_end = |a: &Segment, b: &Segment| lexicographic(a.left, b.right).is_le();
        over(self, other) <= 0 && over(other, self) <= 0 && first_end(self, other) && first_end(other, self)
    }
}

/// The order of edges along the sweep line, from below, where both of them cross it.
impl Ord for Segment {
    fn cmp(&self, other: &Segment) -> Ordering {
        if self.edge == other.edge {
            return Ordering::Equal;
        }
        // the side of the edge that begins later: that of its beginning or, if this is on the line, of its end
        let order = match lexicographic(self.left, other.left) {
            Ordering::Less => first_sign(self.side(other.left), || self.side(other.right)),
            Ordering::Equal => self.side(other.right),
            Ordering::Greater => -first_sign(other.side(self.left), || other.side(self.right)),
        };
        0.cmp(&order).then(self.edge.cmp(&other.edge))
    }
}

fn first_sign(first: i8, second: impl Fn() -> i8) -> i8 {
    if first == 0 { second() } else { first }
}

impl PartialOrd for Segment {
    fn partial_cmp(&self, other: &Segment) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Segment {
    fn eq(&self, other: &Segment) -> bool {
        self.edge == other.edge
    }
}

impl Eq for Segment {}

/// The edges that the sweep line crosses, from below.
#[derive(Default)]
struct Status(BTreeSet<Segment>);

impl Status {
    fn below(&self, edge: &Segment) -> Option<&Segment> {
        self.0.range(..edge).next_back()
    }

    fn above(&self, edge: &Segment) -> Option<&Segment> {
        self.0.range((Bound::Excluded(edge), Bound::Unbounded)).next()
    }

    fn insert(&mut self, edge: Segment) -> Result<(), (u32, u32)> {
        self.0.insert(edge);
        compare(self.below(&edge), Some(&edge))?;
        compare(Some(&edge), self.above(&edge))
    }

    /// Removes an edge. Without a replacement its neighbours become adjacent and are compared.
    fn remove(&mut self, edge: &Segment, is_last: bool) -> Result<(), (u32, u32)> {
        self.0.remove(edge);
        if is_last { compare(self.below(edge), self.above(edge)) } else { Ok(()) }
    }
}

fn compare(a: Option<&Segment>, b: Option<&Segment>) -> Result<(), (u32, u32)> {
    match (a, b) {
        (Some(a), Some(b)) if a.intersects(b) => Err((a.edge.min(b.edge), a.edge.max(b.edge))),
        _ => Ok(()),
    }
}
