//! Regions of the plane bounded by polygons.
//!
//! [`from_polygons`] takes closed contours that keep apart from each other and may lie within each other:
//! *islands*, whose vertices go around counter-clockwise, and *holes*, clockwise. So the region is on the left of
//! every edge.
//!
//! ```text
//!   +---------<---------+
//!   | island            |      + 1: outside of all contours is outside of the region
//!   |   +---->----+     |      - 1: it is inside; the outermost contours are holes
//!   |   | hole    |     |
//!   |   |  +-<-+  v     ^
//!   |   |  | i |  |     |
//!   |   |  +->-+  |     |
//!   |   +----<----+     |
//!   +--------->---------+
//! ```
//!
//! A region is asked in two ways that share no code: along lines, by the sides of its vertices
//! ([`Polygons::trace`], [`Polygons::scan`]), and as a boolean formula of half-planes, one for each edge
//! ([`Polygons::fold`]), which makes it an ordinary solid of the plane or, as a prism, of space.

mod contour;
mod error;
mod exact;
mod formula;
mod line;
mod nest;
mod solid;
mod sweep;
#[cfg(test)]
mod tests;

pub use error::{Edge, LineError, PolygonError};
pub use formula::{HalfPlane, Operator};
pub use line::Scan;

use crate::Point;
use nest::{Place, nest};
use rayweave_rootray::Side;
use sweep::{Ring, sweep};

/// The largest coordinate: what the shapes of space allow, too.
const MOST: f64 = 1e60;

/// A coordinate that is nearer to 0 is taken as 0.
const LEAST: f64 = 1e-60;

/// A region of the plane bounded by polygons.
///
/// Only corners are kept: repeated vertices, vertices on a straight run, spikes, and contours that are nothing
/// else (points, segments, ways there and back) have no area and vanish when the region is made.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygons {
    outside: Side,
    /// The corners of all contours, one contour after the other.
    vertices: Vec<Point<2>>,
    /// The number of each corner in its contour as it was given.
    given: Vec<u32>,
    /// Edge k goes from corner k to corner `next[k]`.
    next: Vec<u32>,
    /// The contour of each corner.
    contour: Vec<u32>,
    /// Where each contour begins in `vertices`, and their number at the end.
    first: Vec<u32>,
    /// The number of each contour as it was given.
    names: Vec<usize>,
    places: Vec<Place>,
}

/// A contour of a region, as [`Polygons::contours`] lists them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contour<'a> {
    /// Its number among the contours that were given.
    pub number: usize,
    /// Its corners, at least three, in the order in which they were given.
    pub corners: &'a [Point<2>],
    /// True for an island (counter-clockwise), false for a hole (clockwise).
    pub is_island: bool,
    /// The number of the contour directly around it, if there is one.
    pub around: Option<usize>,
}

/// The region bounded by closed contours; `outside` is the side far away from all of them.
///
/// A contour is a list of vertices, each joined to the next and the last to the first (which may be repeated at
/// the end). Contours are pairwise disjoint and do not touch themselves; islands go around counter-clockwise and
/// stand outside (or within a hole), holes go around clockwise and stand inside an island. With [`Side::Inside`]
/// for `outside` the outermost contours are holes and the region is unbounded. Contours and parts of contours
/// that have no area vanish without a trace. Without contours the region is nothing, or the whole plane.
///
/// Coordinates are at most 1e60 in magnitude; below 1e-60 they count as 0. What touches and which way a contour
/// turns is decided without rounding. O(n log n).
///
/// # Errors
///
/// [`PolygonError`]: a coordinate that is not finite or too large, two edges that cross or touch, a contour that
/// goes around the wrong way.
///
/// ```
/// use rayweave_space::polygon::from_polygons;
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
pub fn from_polygons<C: AsRef<[Point<2>]>>(contours: &[C], outside: Side) -> Result<Polygons, PolygonError> {
    let mut polygons = Polygons::empty(outside);
    for (number, contour) in contours.iter().enumerate() {
        polygons.add(number, contour.as_ref())?;
    }
    let ring = Ring { vertices: &polygons.vertices, next: &polygons.next, contour: &polygons.contour };
    let footings = sweep(&ring).map_err(|(first, second)| PolygonError::Touching {
        first: polygons.edge(first),
        second: polygons.edge(second),
    })?;
    polygons.places = nest(&ring, &footings, outside, &polygons.names)?;
    Ok(polygons)
}

impl Polygons {
    fn empty(outside: Side) -> Polygons {
        Polygons {
            outside,
            vertices: Vec::new(),
            given: Vec::new(),
            next: Vec::new(),
            contour: Vec::new(),
            first: vec![0],
            names: Vec::new(),
            places: Vec::new(),
        }
    }

    /// Appends a contour, unless nothing remains of it.
    fn add(&mut self, number: usize, contour: &[Point<2>]) -> Result<(), PolygonError> {
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
        self.given.extend(corners.iter().map(|&(_, vertex)| vertex as u32));
        self.next.extend((1..count).chain([0]).map(|k| first + k));
        self.contour.extend(corners.iter().map(|_| self.names.len() as u32));
        self.first.push(first + count);
        self.names.push(number);
        Ok(())
    }

    /// The side far away from all contours.
    pub fn outside(&self) -> Side {
        self.outside
    }

    /// The contours of which something remains, in the order in which they were given.
    pub fn contours(&self) -> impl ExactSizeIterator<Item = Contour<'_>> {
        self.places.iter().enumerate().map(|(k, place)| Contour {
            number: self.names[k],
            corners: &self.vertices[self.corners_of(k)],
            is_island: place.is_island,
            around: place.around.map(|outer| self.names[outer as usize]),
        })
    }

    fn corners_of(&self, contour: usize) -> std::ops::Range<usize> {
        self.first[contour] as usize..self.first[contour + 1] as usize
    }

    /// The number of edges, which are numbered from 0 in the order in which their vertices were given.
    pub fn edge_count(&self) -> usize {
        self.vertices.len()
    }

    /// An edge by its number, which is less than [`Polygons::edge_count`].
    pub fn edge(&self, number: u32) -> Edge {
        let (from, to) = (number as usize, self.next[number as usize] as usize);
        Edge {
            contour: self.names[self.contour[from] as usize],
            from: self.given[from] as usize,
            to: self.given[to] as usize,
        }
    }

    /// The ends of an edge by its number.
    pub fn edge_ends(&self, number: u32) -> [Point<2>; 2] {
        [number, self.next[number as usize]].map(|corner| self.vertices[corner as usize])
    }

    /// The smallest and the largest coordinates of all corners; (+inf, -inf) if there are none.
    pub fn corner_bounds(&self) -> [Point<2>; 2] {
        let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for vertex in &self.vertices {
            for k in 0..2 {
                bounds[0][k] = bounds[0][k].min(vertex[k]);
                bounds[1][k] = bounds[1][k].max(vertex[k]);
            }
        }
        bounds
    }

    /// The area of the region: infinite if it is unbounded. By the shoelace formula about each contour's first
    /// corner, so that a region far from the origin loses no digits.
    pub fn area(&self) -> f64 {
        match self.outside {
            Side::Inside => f64::INFINITY,
            Side::Outside => self.contours().map(|contour| signed_area(contour.corners)).sum(),
        }
    }
}

/// Positive if the corners go around counter-clockwise.
fn signed_area(corners: &[Point<2>]) -> f64 {
    let about = |p: &Point<2>| [p[0] - corners[0][0], p[1] - corners[0][1]];
    let cross = |pair: &[Point<2>]| {
        let (a, b) = (about(&pair[0]), about(&pair[1]));
        a[0] * b[1] - a[1] * b[0]
    };
    0.5 * corners.windows(2).map(cross).sum::<f64>()
}

/// The point, its coordinates next to 0 as 0.
fn checked(contour: usize, vertex: usize, point: Point<2>) -> Result<Point<2>, PolygonError> {
    for (axis, &value) in point.iter().enumerate() {
        if !value.is_finite() {
            return Err(PolygonError::NotFinite { contour, vertex, axis, value });
        }
        if value.abs() > MOST {
            return Err(PolygonError::Extreme { contour, vertex, axis, value });
        }
    }
    Ok(point.map(|x| if x.abs() < LEAST { 0.0 } else { x }))
}
