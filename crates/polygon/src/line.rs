//! Crossings of straight lines with the boundary of a region, watertight, with symbolic perturbation.
//!
//! The side of a vertex depends on the line and the vertex alone, not on the edge. A line crosses an edge if the ends of the edge
//! are on different sides. The number of crossings with a contour is therefore even, and rounding cannot make a line slip between
//! two edges.
//!
//! A vertex within the tolerance `delta` of the line counts as on the side on which it lies after the line is moved
//! infinitesimally along the perturbation direction `w` ([`rayweave_math::perturbation_direction`]), the same rule as for rays
//! in surfaces. A line that touches a corner has two crossings there or none. Both have the time of the vertex, so that they
//! cancel exactly where necessary.

use crate::{LineError, MAX_COORDINATE, MIN_COORDINATE, Point, Polygons};
use rayweave_math::{UNIT_ROUNDOFF, perturbs_inside};
use rayweave_rootray::{Root, RootRay, Side, weld_runs};
use rayweave_shape::surface::{coincides_between, delta_of, is_near};

impl Polygons {
    /// The times at which the line `origin + t direction` crosses the boundary. Each root carries the index of its edge
    /// ([`Polygons::edge`]).
    ///
    /// The direction may have any length. Spans within the tolerance `delta` of both edges that bound them are dropped. Takes
    /// O(n) time for n edges; for many parallel lines use [`Polygons::scan`].
    ///
    /// # Errors
    ///
    /// [`LineError`]: a number is not finite or out of range, or the direction is zero.
    pub fn trace(&self, origin: Point, direction: Point) -> Result<RootRay<u32>, LineError> {
        let scan = self.scan(direction, &[origin])?;
        let roots = scan.roots(0).to_vec();
        // never fails: the times are finite, sorted and distinct
        Ok(RootRay::new(self.outside, roots).unwrap_or_default())
    }

    /// True if the point is in the region. A point on the boundary has the side of the line along +x just after the point.
    ///
    /// # Errors
    ///
    /// Those of [`Polygons::trace`].
    pub fn contains(&self, point: Point) -> Result<bool, LineError> {
        let along_x = self.trace(point, [1.0, 0.0])?;
        Ok(along_x.side_at(0.0).is_ok_and(Side::is_inside))
    }

    /// The crossings of many parallel lines (scan lines), one through each origin.
    ///
    /// A sorted list gives the lines that can cross an edge. The cost is O(n log m + k log k) for n edges, m lines and k
    /// crossings. The results are those of [`Polygons::trace`], bit for bit.
    ///
    /// # Errors
    ///
    /// Those of [`Polygons::trace`].
    pub fn scan(&self, direction: Point, origins: &[Point]) -> Result<Scan, LineError> {
        check(direction, origins)?;
        let mut found: Vec<(u32, Root<u32>)> = Vec::new();
        let lines = SortedLines::new(direction, origins);
        for edge in 0..self.vertices.len() as u32 {
            let ends = self.edge_ends(edge);
            for &number in lines.candidates(ends) {
                let line = Line::new(origins[number as usize], direction);
                found.extend(line.crossing(ends).map(|t| (number, Root::new(t, edge))));
            }
        }
        found.sort_unstable_by(|(m, a), (n, b)| {
            m.cmp(n).then(a.t.total_cmp(&b.t)).then(a.surface.cmp(&b.surface))
        });
        Ok(self.gather(found, direction, origins))
    }

    /// The roots of each line from crossings sorted by line and time; crossings at equal times cancel in pairs.
    fn gather(&self, found: Vec<(u32, Root<u32>)>, direction: Point, origins: &[Point]) -> Scan {
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
                [a, b].iter().all(|root| line.coincides_along(self.edge_ends(root.surface), a.t, b.t))
            };
            let runs = weld_runs(&single, welded);
            scan.roots.extend(runs.filter(|run| run.len() % 2 == 1).map(|run| single[run.end - 1]));
            scan.offsets.push(scan.roots.len());
        }
        scan
    }
}

fn check(direction: Point, origins: &[Point]) -> Result<(), LineError> {
    let numbers = || origins.iter().flatten().chain(&direction);
    let longest = direction[0].abs().max(direction[1].abs());
    match () {
        () if !numbers().all(|x| x.is_finite()) => Err(LineError::NotFinite),
        () if longest == 0.0 => Err(LineError::ZeroDirection),
        () if longest < MIN_COORDINATE || numbers().any(|x| x.abs() > MAX_COORDINATE) => {
            Err(LineError::Extreme)
        }
        () => Ok(()),
    }
}

/// The crossings of many parallel lines with a region.
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

    /// The side of every line as t -> -inf.
    pub fn start(&self) -> Side {
        self.outside
    }

    /// The crossings of a line by its index: strictly increasing in time, each with the index of its edge.
    pub fn roots(&self, line: usize) -> &[Root<u32>] {
        &self.roots[self.offsets[line]..self.offsets[line + 1]]
    }
}

/// Parallel lines, sorted by their signed distance from the origin.
struct SortedLines {
    direction: Point,
    /// Signed distances, times the length of the direction, and indices of the lines.
    levels: Vec<f64>,
    lines: Vec<u32>,
    /// Upper bound of the distance of an origin from zero.
    magnitude: f64,
}

impl SortedLines {
    fn new(direction: Point, origins: &[Point]) -> SortedLines {
        let mut lines: Vec<u32> = (0..origins.len() as u32).collect();
        let level = |line: &u32| cross(direction, origins[*line as usize]);
        lines.sort_by(|a, b| level(a).total_cmp(&level(b)));
        let levels = lines.iter().map(level).collect();
        let magnitude = origins.iter().map(size).fold(0.0, f64::max);
        SortedLines { direction, levels, lines, magnitude }
    }

    /// The lines that can cross an edge.
    ///
    /// A vertex counts as on a line if it is within `delta` of it, which is at most `128 u` times the magnitudes of vertex and
    /// origin, because the foot point of the vertex is not farther from the origin than the vertex. The rounding error of the
    /// levels is below `4 u` times these magnitudes. The margin is more than twice the sum.
    fn candidates(&self, ends: [Point; 2]) -> &[u32] {
        let [a, b] = ends.map(|end| cross(self.direction, end));
        let magnitude = size(&ends[0]).max(size(&ends[1])) + self.magnitude;
        let margin = 512.0 * UNIT_ROUNDOFF * magnitude * size(&self.direction);
        let first = self.levels.partition_point(|&level| level < a.min(b) - margin);
        let end = self.levels.partition_point(|&level| level <= a.max(b) + margin);
        &self.lines[first..end.max(first)]
    }
}

/// An upper bound of the distance from the origin (the 1-norm).
fn size(p: &Point) -> f64 {
    p[0].abs() + p[1].abs()
}

fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn length(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// The line `r(t) = origin + t direction`.
struct Line {
    origin: Point,
    direction: Point,
}

/// The position of a vertex relative to a line.
struct VertexSide {
    /// True if the vertex is to the left of the line, perturbed where the vertex is on the line.
    is_left: bool,
    /// True if the vertex is within the tolerance of the line.
    is_on_line: bool,
    /// The time of the foot point on the line.
    time: f64,
}

impl Line {
    fn new(origin: Point, direction: Point) -> Line {
        Line { origin, direction }
    }

    fn to(&self, vertex: Point) -> Point {
        [vertex[0] - self.origin[0], vertex[1] - self.origin[1]]
    }

    fn delta(&self, time: f64, magnitude: f64) -> f64 {
        delta_of(length(self.origin) + time.abs() * length(self.direction) + magnitude)
    }

    fn side(&self, vertex: Point) -> VertexSide {
        let (d, to) = (self.direction, self.to(vertex));
        let time = dot(d, to) / dot(d, d);
        let height = cross(d, to);
        let is_on_line = is_near(height, length(d), self.delta(time, length(vertex)), 0.0);
        let is_left = if is_on_line { is_left_after_perturbation(d) } else { height > 0.0 };
        VertexSide { is_left, is_on_line, time }
    }

    /// The time at which the line crosses an edge, if it does.
    fn crossing(&self, [a, b]: [Point; 2]) -> Option<f64> {
        let (from, to) = (self.side(a), self.side(b));
        if from.is_left == to.is_left {
            return None;
        }
        let t = match () {
            () if from.is_on_line => from.time,
            () if to.is_on_line => to.time,
            () => self.root(a, b).clamp(from.time.min(to.time), from.time.max(to.time)),
        };
        // adding 0 turns -0 into 0
        Some(t + 0.0)
    }

    /// The time at which the line crosses the edge's line, `n.(a - o) / n.d` with the normal n of the edge; the time of the first
    /// end if they are parallel.
    fn root(&self, a: Point, b: Point) -> f64 {
        let edge = [b[0] - a[0], b[1] - a[1]];
        let t = cross(self.to(a), edge) / cross(self.direction, edge);
        if t.is_finite() { t } else { self.side(a).time }
    }

    /// True if the span between two times is within the tolerance of the edge's line.
    fn coincides_along(&self, [a, b]: [Point; 2], from: f64, to: f64) -> bool {
        let edge = [b[0] - a[0], b[1] - a[1]];
        let magnitude = length(a).max(length(b));
        let near = |t: f64| {
            let at = [0, 1].map(|k| self.origin[k] + t * self.direction[k] - a[k]);
            is_near(cross(edge, at), length(edge), self.delta(t, magnitude), 0.0)
        };
        let start = (length(self.origin) + magnitude) / length(self.direction);
        coincides_between(near, start, 1, || f64::NAN, from, to)
    }
}

/// True if a vertex on the line is to the left, where `d x p > 0`, after the line is moved along `w`.
fn is_left_after_perturbation(d: Point) -> bool {
    // relative to the line the vertex moves along -w: it is on the left if d x p decreases along w
    perturbs_inside(&[-d[1], d[0]])
}
