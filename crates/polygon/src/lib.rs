//! Polygons with holes: regions of the plane with exact validation, line crossings, scan lines, boolean formulas of half-planes,
//! and prisms.
//!
//! [`from_polygons`] takes closed contours that do not touch and may be nested: *islands*, with counter-clockwise vertices, and
//! *holes*, with clockwise vertices. The region is on the left of every edge.
//!
//! ```text
//!   +---------<---------+
//!   | island            |      outside = +1: the plane outside all contours is outside the region
//!   |   +---->----+     |      outside = -1: it is inside the region; the outermost contours are holes
//!   |   | hole    |     |
//!   |   |  +-<-+  v     ^
//!   |   |  | i |  |     |
//!   |   |  +->-+  |     |
//!   |   +----<----+     |
//!   +--------->---------+
//! ```
//!
//! Two algorithms that share no code evaluate a region: crossings along lines, by the sides of the vertices
//! ([`Polygons::trace`], [`Polygons::scan`]), and a boolean formula of half-planes, one for each edge ([`Polygons::fold`]) or, for
//! many edges, one for each edge in each cell of the plane ([`Polygons::fold_by_cells`]). The formula turns the region into a solid
//! of the plane or a prism in space ([`Polygons::extrude`]).

mod cells;
mod contour;
mod error;
mod exact;
mod formula;
mod line;
mod nest;
mod outline;
mod point;
mod prism;
mod sweep;

pub use error::{ContourEdge, LineError, PolygonError};
pub use formula::{HalfPlane, Operator};
pub use line::Scan;
pub use outline::{
    Corner, Outline, OutlineError, Rim, Vertex, is_outline_cell, is_outline_part, near_cylinder,
};
pub use point::Point;

use nest::{Nesting, nest};
use rayweave_rootray::Side;
use sweep::{Contours, sweep};

/// The maximal magnitude of a coordinate, the same as for shapes.
const MAX_COORDINATE: f64 = 1e60;

/// Coordinates of smaller magnitude are set to 0.
const MIN_COORDINATE: f64 = 1e-60;

/// A region of the plane bounded by polygons.
///
/// Stores corners only. The constructor removes repeated vertices, collinear vertices, spikes, and degenerate contours without
/// area.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygons {
    outside: Side,
    /// The corners of all contours, contour by contour.
    vertices: Vec<Point>,
    /// The index of each corner among the given vertices of its contour.
    original: Vec<u32>,
    /// Edge k goes from corner k to corner `next[k]`.
    next: Vec<u32>,
    /// The contour of each corner.
    contour: Vec<u32>,
    /// The index of the first corner of each contour, then the number of corners.
    first: Vec<u32>,
    /// The index of each contour among the given ones.
    numbers: Vec<usize>,
    nesting: Vec<Nesting>,
}

/// A contour of a region, an item of [`Polygons::contours`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contour<'a> {
    /// The index of the contour among the given ones.
    pub number: usize,
    /// The corners, at least three, in the given order.
    pub corners: &'a [Point],
    /// True for an island (counter-clockwise), false for a hole (clockwise).
    pub is_island: bool,
    /// The index of the innermost contour around it, if there is one.
    pub parent: Option<usize>,
}

/// The region bounded by closed contours; `outside` is its side at infinity.
///
/// A contour is a list of vertices, each joined to the next and the last to the first, which may be repeated at the end.
/// Contours are pairwise disjoint and do not touch themselves. Islands are counter-clockwise and lie outside other contours or in
/// a hole; holes are clockwise and lie in an island. With [`Side::Inside`] for `outside` the outermost contours are holes and the
/// region is unbounded. Contours and parts of contours without area are removed. Without contours the region is empty, or the
/// whole plane.
///
/// The maximal magnitude of a coordinate is 1e60; below 1e-60 it counts as 0. Contact of edges and orientation of contours are
/// determined with exact predicates. Takes O(n log n) time.
///
/// # Errors
///
/// [`PolygonError`]: a coordinate is not finite or too large, two edges cross or touch, or a contour has the wrong orientation.
///
/// ```
/// use rayweave_polygon::from_polygons;
/// use rayweave_rootray::Side;
///
/// let island = vec![[0.0, 0.0], [6.0, 0.0], [6.0, 4.0], [0.0, 4.0]];
/// let hole = vec![[1.0, 1.0], [1.0, 3.0], [3.0, 3.0], [3.0, 1.0]];
/// let plate = from_polygons(&[island, hole], Side::Outside)?;
/// assert_eq!(plate.area(), 20.0);
/// let along_x = plate.trace([0.0, 2.0], [1.0, 0.0])?;
/// assert_eq!(along_x.times().collect::<Vec<_>>(), [0.0, 1.0, 3.0, 6.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn from_polygons<C: AsRef<[Point]>>(contours: &[C], outside: Side) -> Result<Polygons, PolygonError> {
    let mut polygons = Polygons::empty(outside);
    for (number, contour) in contours.iter().enumerate() {
        polygons.add(number, contour.as_ref())?;
    }
    let contours =
        Contours { vertices: &polygons.vertices, next: &polygons.next, contour: &polygons.contour };
    let starts = sweep(&contours).map_err(|(first, second)| PolygonError::Touching {
        first: polygons.edge(first),
        second: polygons.edge(second),
    })?;
    polygons.nesting = nest(&contours, &starts, outside, &polygons.numbers)?;
    Ok(polygons)
}

impl Polygons {
    fn empty(outside: Side) -> Polygons {
        Polygons {
            outside,
            vertices: Vec::new(),
            original: Vec::new(),
            next: Vec::new(),
            contour: Vec::new(),
            first: vec![0],
            numbers: Vec::new(),
            nesting: Vec::new(),
        }
    }

    /// Appends a contour, unless it has no area.
    fn add(&mut self, number: usize, contour: &[Point]) -> Result<(), PolygonError> {
        let mut points = Vec::with_capacity(contour.len());
        for (vertex, &point) in contour.iter().enumerate() {
            points.push(checked(number, vertex, point)?);
        }
        let corners = contour::corners(points);
        if corners.is_empty() {
            return Ok(());
        }
        let (first, count) = (self.vertices.len() as u32, corners.len() as u32);
        self.vertices.extend(corners.iter().map(|(point, _)| point));
        self.original.extend(corners.iter().map(|&(_, vertex)| vertex as u32));
        self.next.extend((1..count).chain([0]).map(|k| first + k));
        self.contour.extend(corners.iter().map(|_| self.numbers.len() as u32));
        self.first.push(first + count);
        self.numbers.push(number);
        Ok(())
    }

    /// The side at infinity.
    pub fn outside(&self) -> Side {
        self.outside
    }

    /// The contours with an area, in the given order.
    pub fn contours(&self) -> impl ExactSizeIterator<Item = Contour<'_>> {
        self.nesting.iter().enumerate().map(|(k, nesting)| Contour {
            number: self.numbers[k],
            corners: &self.vertices[self.corners_of(k)],
            is_island: nesting.is_island,
            parent: nesting.parent.map(|outer| self.numbers[outer as usize]),
        })
    }

    fn corners_of(&self, contour: usize) -> std::ops::Range<usize> {
        self.first[contour] as usize..self.first[contour + 1] as usize
    }

    /// The number of edges. Edges have indices from 0 in the given order of their first vertices.
    pub fn edge_count(&self) -> usize {
        self.vertices.len()
    }

    /// An edge by its index, which is less than [`Polygons::edge_count`].
    pub fn edge(&self, number: u32) -> ContourEdge {
        let (from, to) = (number as usize, self.next[number as usize] as usize);
        ContourEdge {
            contour: self.numbers[self.contour[from] as usize],
            from: self.original[from] as usize,
            to: self.original[to] as usize,
        }
    }

    /// The end points of an edge by its index.
    pub fn edge_ends(&self, number: u32) -> [Point; 2] {
        [number, self.next[number as usize]].map(|corner| self.vertices[corner as usize])
    }

    /// The bounding box of all corners, as smallest and largest coordinates; (+inf, -inf) if there are none.
    pub fn corner_bounds(&self) -> [Point; 2] {
        let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for vertex in &self.vertices {
            for k in 0..2 {
                bounds[0][k] = bounds[0][k].min(vertex[k]);
                bounds[1][k] = bounds[1][k].max(vertex[k]);
            }
        }
        bounds
    }

    /// The area of the region; infinite if it is unbounded. Uses the shoelace formula relative to the first corner of each contour,
    /// which keeps the precision of regions far from the origin.
    pub fn area(&self) -> f64 {
        match self.outside {
            Side::Inside => f64::INFINITY,
            Side::Outside => self.contours().map(|contour| signed_area(contour.corners)).sum(),
        }
    }
}

/// The area within a contour, positive if the corners are counter-clockwise.
fn signed_area(corners: &[Point]) -> f64 {
    let relative = |p: &Point| [p[0] - corners[0][0], p[1] - corners[0][1]];
    let cross = |pair: &[Point]| {
        let (a, b) = (relative(&pair[0]), relative(&pair[1]));
        a[0] * b[1] - a[1] * b[0]
    };
    0.5 * corners.windows(2).map(cross).sum::<f64>()
}

/// The point, with tiny coordinates set to 0.
fn checked(contour: usize, vertex: usize, point: Point) -> Result<Point, PolygonError> {
    for (axis, &value) in point.iter().enumerate() {
        if !value.is_finite() {
            return Err(PolygonError::NotFinite { contour, vertex, axis, value });
        }
        if value.abs() > MAX_COORDINATE {
            return Err(PolygonError::Extreme { contour, vertex, axis, value });
        }
    }
    Ok(point.map(|x| if x.abs() < MIN_COORDINATE { 0.0 } else { x }))
}
