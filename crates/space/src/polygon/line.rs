//! Where straight lines cross the boundary of a region.
//!
//! The side of a vertex is decided once for each line, whatever edge asks. An edge is crossed if its ends are on
//! different sides; so the number of edges that a line crosses on its way around a contour is even, and no line
//! slips in or out between two edges, however it is rounded.
//!
//! A vertex that is within `delta` of the line (it cannot be told from it) is on the side on which it comes to
//! lie when the line is moved along the fixed direction `w`: an edge in the line is so answered as every surface
//! is that a ray lies in, and a corner that the line touches is crossed twice or not at all. There the time is
//! that of the vertex for both of its edges, so that the two crossings cancel exactly where they have to.

use super::{LEAST, LineError, MOST, Polygons};
use crate::{Point, leads_inside};
use rayweave_math::UNIT_ROUNDOFF;
use rayweave_rootray::{Root, RootRay, Side, weld_runs};
use rayweave_shape::surface::{delta_of, hugs_along, is_near};

impl Polygons {
    /// The times at which the line `origin + t direction` crosses the boundary; each root carries the number of
    /// its edge ([`Polygons::edge`]).
    ///
    /// The direction need not be of unit length. Pieces that lie within `delta` of both edges that bound them are
    /// dropped. O(n) for n edges; for many parallel lines see [`Polygons::scan`].
    ///
    /// # Errors
    ///
    /// [`LineError`]: a number that is not finite or cannot be squared, a direction of length 0.
    pub fn trace(&self, origin: Point<2>, direction: Point<2>) -> Result<RootRay<u32>, LineError> {
        let scan = self.scan(direction, &[origin])?;
        let roots = scan.roots(0).to_vec();
        // cannot fail: the times are finite, sorted and distinct
        Ok(RootRay::new(self.outside, roots).unwrap_or_default())
    }

    /// True if the point is in the region. A point on the boundary is where the line along +x through it is just
    /// after the point.
    ///
    /// # Errors
    ///
    /// As [`Polygons::trace`].
    pub fn contains(&self, point: Point<2>) -> Result<bool, LineError> {
        let along_x = self.trace(point, [1.0, 0.0])?;
        Ok(along_x.side_at(0.0).is_ok_and(Side::is_inside))
    }

    /// The crossings of many parallel lines, one through each origin.
    ///
    /// Every edge looks up the lines that can cross it in a sorted list, so that the cost is O(n log m + k log k) for
    /// n edges, m lines and k crossings. The answers are those of [`Polygons::trace`], bit for bit.
    ///
    /// # Errors
    ///
    /// As [`Polygons::trace`].
    pub fn scan(&self, direction: Point<2>, origins: &[Point<2>]) -> Result<Scan, LineError> {
        check(direction, origins)?;
        let mut found: Vec<(u32, Root<u32>)> = Vec::new();
        let shelf = Shelf::new(direction, origins);
        for edge in 0..self.vertices.len() as u32 {
            let ends = self.edge_ends(edge);
            for &number in shelf.between(ends) {
                let line = Line::new(origins[number as usize], direction);
                found.extend(line.crossing(ends).map(|t| (number, Root::new(t, edge))));
            }
        }
        found.sort_unstable_by(|(m, a), (n, b)| {
            m.cmp(n).then(a.t.total_cmp(&b.t)).then(a.surface.cmp(&b.surface))
        });
        Ok(self.gather(found, direction, origins))
    }

    /// The roots of each line, sorted by line and time, without those that cancel.
    fn gather(&self, found: Vec<(u32, Root<u32>)>, direction: Point<2>, origins: &[Point<2>]) -> Scan {
        let mut scan = Scan { outside: self.outside, offsets: vec![0], roots: Vec::new() };
        let mut rest = &found[..];
        let mut single: Vec<Root<u32>> = Vec::new();
        for (number, &origin) in origins.iter().enumerate() {
            let count = rest.partition_point(|&(line, _)| line as usize <= number);
            let (own, others) = rest.split_at(count);
            rest = others;
            single.clear();
            let times = own.chunk_by(|a, b| a.1.t == b.1.t);
            single.extend(times.filter(|group| group.len() % 2 == 1).map(|group| group[0].1));
            let line = Line::new(origin, direction);
            let welded = |a: &Root<u32>, b: &Root<u32>| {
                [a, b].iter().all(|root| line.hugs(self.edge_ends(root.surface), a.t, b.t))
            };
            let runs = weld_runs(&single, welded);
            scan.roots.extend(runs.filter(|run| run.len() % 2 == 1).map(|run| single[run.end - 1]));
            scan.offsets.push(scan.roots.len());
        }
        scan
    }
}

fn check(direction: Point<2>, origins: &[Point<2>]) -> Result<(), LineError> {
    let numbers = || origins.iter().flatten().chain(&direction);
    let longest = direction[0].abs().max(direction[1].abs());
    match () {
        () if !numbers().all(|x| x.is_finite()) => Err(LineError::NotFinite),
        () if longest == 0.0 => Err(LineError::ZeroDirection),
        () if longest < LEAST || numbers().any(|x| x.abs() > MOST) => Err(LineError::Extreme),
        () => Ok(()),
    }
}

/// What many parallel lines cross.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    outside: Side,
    offsets: Vec<usize>,
    roots: Vec<Root<u32>>,
}

impl Scan {
    /// The number of lines.
    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// True if there are no lines.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The side on which every line begins, as t -> -inf.
    pub fn start(&self) -> Side {
        self.outside
    }

    /// The crossings of a line, by its number: strictly increasing in time, each with the number of its edge.
    pub fn roots(&self, line: usize) -> &[Root<u32>] {
        &self.roots[self.offsets[line]..self.offsets[line + 1]]
    }
}

/// Parallel lines in the order of their distance from the origin, across the direction.
struct Shelf {
    direction: Point<2>,
    /// Distances and numbers of the lines.
    levels: Vec<f64>,
    lines: Vec<u32>,
    /// The largest coordinate sum among the origins.
    reach: f64,
}

impl Shelf {
    fn new(direction: Point<2>, origins: &[Point<2>]) -> Shelf {
        let mut lines: Vec<u32> = (0..origins.len() as u32).collect();
        let level = |line: &u32| cross(direction, origins[*line as usize]);
        lines.sort_by(|a, b| level(a).total_cmp(&level(b)));
        let levels = lines.iter().map(level).collect();
        let reach = origins.iter().map(size).fold(0.0, f64::max);
        Shelf { direction, levels, lines, reach }
    }

    /// The lines that can cross an edge.
    ///
    /// A vertex counts as on a line within `delta`, which is at most `128 u` times the sizes of vertex and origin (the
    /// foot of the vertex is no farther from the origin than the vertex); the levels themselves are rounded by less
    /// than `4 u` of them. Twice their sum is safe.
    fn between(&self, ends: [Point<2>; 2]) -> &[u32] {
        let [a, b] = ends.map(|end| cross(self.direction, end));
        let reach = size(&ends[0]).max(size(&ends[1])) + self.reach;
        let margin = 512.0 * UNIT_ROUNDOFF * reach * size(&self.direction);
        let first = self.levels.partition_point(|&level| level < a.min(b) - margin);
        let end = self.levels.partition_point(|&level| level <= a.max(b) + margin);
        &self.lines[first..end.max(first)]
    }
}

/// At least the distance from the origin.
fn size(p: &Point<2>) -> f64 {
    p[0].abs() + p[1].abs()
}

fn cross(a: Point<2>, b: Point<2>) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn dot(a: Point<2>, b: Point<2>) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn length(a: Point<2>) -> f64 {
    dot(a, a).sqrt()
}

/// `r(t) = origin + t direction`.
struct Line {
    origin: Point<2>,
    direction: Point<2>,
}

/// A vertex as a line sees it.
struct Stand {
    /// True if it is to the left of the line, after the line was moved aside where it is on it.
    is_left: bool,
    /// True if it cannot be told from the line.
    is_on_line: bool,
    /// The time of its foot on the line.
    time: f64,
}

impl Line {
    fn new(origin: Point<2>, direction: Point<2>) -> Line {
        Line { origin, direction }
    }

    fn to(&self, vertex: Point<2>) -> Point<2> {
        [vertex[0] - self.origin[0], vertex[1] - self.origin[1]]
    }

    fn delta(&self, time: f64, reach: f64) -> f64 {
        delta_of(length(self.origin) + time.abs() * length(self.direction) + reach)
    }

    fn stand(&self, vertex: Point<2>) -> Stand {
        let (d, to) = (self.direction, self.to(vertex));
        let time = dot(d, to) / dot(d, d);
        let height = cross(d, to);
        let is_on_line = is_near(height, length(d), self.delta(time, length(vertex)), 0.0);
        let is_left = if is_on_line { moves_to_the_left(d) } else { height > 0.0 };
        Stand { is_left, is_on_line, time }
    }

    /// The time at which the edge is crossed, if it is.
    fn crossing(&self, [a, b]: [Point<2>; 2]) -> Option<f64> {
        let (from, to) = (self.stand(a), self.stand(b));
        if from.is_left == to.is_left {
            return None;
        }
        let t = match () {
            () if from.is_on_line => from.time,
            () if to.is_on_line => to.time,
            () => self.root(a, b).clamp(from.time.min(to.time), from.time.max(to.time)),
        };
        // adding 0 makes -0 a 0
        Some(t + 0.0)
    }

    /// The root of the edge's own line, `n.(a - o) / n.d`, n being the edge turned by a right angle; the middle of
    /// nothing if the line is parallel to it.
    fn root(&self, a: Point<2>, b: Point<2>) -> f64 {
        let edge = [b[0] - a[0], b[1] - a[1]];
        let t = cross(self.to(a), edge) / cross(self.direction, edge);
        if t.is_finite() { t } else { self.stand(a).time }
    }

    /// True if the piece between two times cannot be told from the edge's line.
    fn hugs(&self, [a, b]: [Point<2>; 2], from: f64, to: f64) -> bool {
        let edge = [b[0] - a[0], b[1] - a[1]];
        let reach = length(a).max(length(b));
        let near = |t: f64| {
            let at = [0, 1].map(|k| self.origin[k] + t * self.direction[k] - a[k]);
            is_near(cross(edge, at), length(edge), self.delta(t, reach), 0.0)
        };
        let start = (length(self.origin) + reach) / length(self.direction);
        hugs_along(near, start, 1, from, to)
    }
}

/// The side of a vertex on the line after the line has moved along `w`: true for the left, where `d x p > 0`.
fn moves_to_the_left(d: Point<2>) -> bool {
    // the vertex moves against w, so that it is on the left if d x p decreases along w
    leads_inside(&[-d[1], d[0]])
}
