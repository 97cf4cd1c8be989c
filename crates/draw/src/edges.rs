//! Visible edges of a model in a direction of view: outlines, edges in front of other faces, and edges between faces at an angle.
//!
//! Rays through the points of a grid find the first face. Where the depth or the normal differs between two neighbours, the place is
//! bisected, so that the points of the lines lie on the edges to a millionth of the distance of the grid. Within each cell of the
//! grid the points are joined by straight lines. Faces that continue each other without an angle have no edge between them.

use rayweave_analysis::Cancelled;
use rayweave_analysis::section::Cut;
use rayweave_math::Vec3;
use rayweave_model::drive::{Cancel, Stopped, drive, thread_count};
use rayweave_model::{Evaluator, FirstHitColumns, RayBatch, Window};
use rayweave_shape::Ray;
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::num::NonZeroUsize;

type Point = [f64; 2];

/// A view of a model without perspective.
#[derive(Clone, Copy, Debug)]
pub struct EdgeView {
    /// The plane of the picture: the viewer is on the side of its normal.
    pub plane: Cut,
    /// True to show only the part behind the plane; false for the whole model.
    pub is_behind: bool,
    /// The lower left and upper right corners of the window.
    pub window: [Point; 2],
    /// The distance of the rays.
    pub step: f64,
}

/// The limit on the number of rays of a grid.
const MAX_RAYS: usize = 4_000_000;

/// The number of bisections between neighbours.
pub(crate) const BISECTIONS: usize = 20;

/// The cosine of the smallest angle between faces that have an edge, 12 degrees: the facets of a round mesh have none.
pub(crate) const SMOOTH: f64 = 0.978;

/// The least jump in depth at an edge, relative to the size of the window.
pub(crate) const JUMP: f64 = 1e-4;

/// The first face along a ray.
#[derive(Clone, Copy, Debug)]
struct Sample {
    /// Infinite for a miss.
    t: f64,
    normal: Vec3,
    face: (i32, u32),
    /// The ray starts in material.
    is_cut: bool,
}

/// The visible edges, as lines in the coordinates of the plane; closed lines end where they begin.
///
/// # Errors
///
/// [`Cancelled`].
pub fn visible_edges<E: Evaluator>(
    evaluator: &E,
    view: &EdgeView,
    threads: Option<NonZeroUsize>,
    cancel: &Cancel,
) -> Result<Vec<Vec<Point>>, Cancelled> {
    let grid = Grid::new(view);
    let sampler = Sampler { evaluator, view };
    let mut samples = Vec::with_capacity(grid.columns * grid.rows);
    let work = |scratch: &mut E::Scratch, row: usize| {
        let places: Vec<Point> = (0..grid.columns).map(|column| grid.point(column, row)).collect();
        sampler.samples(&places, scratch)
    };
    let merge = |row: Vec<Sample>| {
        samples.extend(row);
        Ok::<(), Infallible>(())
    };
    let scratch = || evaluator.scratch();
    match drive(thread_count(threads), cancel, 0..grid.rows, scratch, work, merge) {
        Ok(()) => {}
        Err(Stopped::Cancelled) => return Err(Cancelled),
        Err(Stopped::Failed(never)) => match never {},
    }
    let size = (view.window[1][0] - view.window[0][0]).max(view.window[1][1] - view.window[0][1]);
    let crossings = crossings(&grid, &samples, &sampler, JUMP * size, cancel)?;
    Ok(joined(&grid, &crossings))
}

/// The points of the grid.
pub(crate) struct Grid {
    lo: Point,
    pub step: f64,
    pub columns: usize,
    pub rows: usize,
}

impl Grid {
    pub fn new(view: &EdgeView) -> Grid {
        let [lo, hi] = view.window;
        let size = [0, 1].map(|k| (hi[k] - lo[k]).max(f64::MIN_POSITIVE));
        let least = (size[0] * size[1] / MAX_RAYS as f64).sqrt();
        let step = view.step.max(least);
        let [columns, rows] = size.map(|length| (length / step).ceil() as usize + 1);
        Grid { lo, step, columns, rows }
    }

    pub fn point(&self, column: usize, row: usize) -> Point {
        [self.lo[0] + self.step * column as f64, self.lo[1] + self.step * row as f64]
    }

    pub fn index(&self, column: usize, row: usize) -> usize {
        row * self.columns + column
    }
}

struct Sampler<'a, E> {
    evaluator: &'a E,
    view: &'a EdgeView,
}

impl<E: Evaluator> Sampler<'_, E> {
    fn samples(&self, places: &[Point], scratch: &mut E::Scratch) -> Vec<Sample> {
        let forward = -self.view.plane.normal();
        let mut batch = RayBatch::default();
        places.iter().for_each(|&place| batch.push(Ray::new(self.view.plane.point(place), forward)));
        let mut found = FirstHitColumns::new(places.len());
        let window = match self.view.is_behind {
            true => Window::new(0.0, f64::INFINITY).unwrap_or(Window::ALL),
            false => Window::ALL,
        };
        self.evaluator.nearest(batch.rays(), window, scratch, &mut found.hits());
        let sample = |k: usize| Sample {
            t: found.t[k],
            normal: Vec3::new(found.normal[0][k], found.normal[1][k], found.normal[2][k]),
            face: (found.face[k], found.placement[k]),
            is_cut: found.before[k] != 0,
        };
        (0..places.len()).map(sample).collect()
    }
}

impl Sample {
    fn is_miss(&self) -> bool {
        self.t == f64::INFINITY
    }

    /// True if there may be an edge between neighbours at this distance.
    fn may_differ(&self, other: &Sample, distance: f64) -> bool {
        match () {
            () if self.is_cut || other.is_cut => self.is_cut != other.is_cut,
            () if self.is_miss() || other.is_miss() => self.is_miss() != other.is_miss(),
            // the triangles of a mesh are one face
            () => {
                self.face != other.face
                    || (self.t - other.t).abs() > 4.0 * distance
                    || self.normal.dot(other.normal) < SMOOTH
            }
        }
    }

    /// True if an edge separates points that are very near each other. The outline of a cut face belongs to the cut.
    fn differs(&self, other: &Sample, jump: f64) -> bool {
        match () {
            () if self.is_cut || other.is_cut => false,
            () if self.is_miss() || other.is_miss() => self.is_miss() != other.is_miss(),
            () => (self.t - other.t).abs() > jump || self.normal.dot(other.normal) < SMOOTH,
        }
    }

    /// True if the edge between two others is on the side of the first of them. `distance` is that of the others.
    fn is_beyond(&self, first: &Sample, last: &Sample, distance: f64) -> bool {
        let kind = |s: &Sample| (s.is_cut, s.is_miss(), s.face);
        match () {
            () if kind(self) == kind(first) && kind(first) != kind(last) => false,
            () if kind(self) == kind(last) && kind(first) != kind(last) => true,
            () if kind(self) != kind(first) => true,
            // an edge between triangles of a mesh
            () if (first.t - last.t).abs() <= 4.0 * distance => {
                self.normal.dot(first.normal) < self.normal.dot(last.normal)
            }
            // one face in front of itself
            () => (self.t - first.t).abs() > (self.t - last.t).abs(),
        }
    }
}

/// The sides of cells with an edge, by the index of their first point and their direction: 0 to the right, 1 up.
type Crossings = BTreeMap<(usize, usize), Point>;

fn crossings<E: Evaluator>(
    grid: &Grid,
    samples: &[Sample],
    sampler: &Sampler<'_, E>,
    jump: f64,
    cancel: &Cancel,
) -> Result<Crossings, Cancelled> {
    struct Open {
        side: (usize, usize),
        ends: [(Point, Sample); 2],
    }
    let mut open = Vec::new();
    for row in 0..grid.rows {
        for column in 0..grid.columns {
            let at = grid.index(column, row);
            for (direction, (right, up)) in [(1, 0), (0, 1)].into_iter().enumerate() {
                if column + right == grid.columns || row + up == grid.rows {
                    continue;
                }
                let (first, last) = (samples[at], samples[grid.index(column + right, row + up)]);
                if first.may_differ(&last, grid.step) {
                    let ends =
                        [(grid.point(column, row), first), (grid.point(column + right, row + up), last)];
                    open.push(Open { side: (at, direction), ends });
                }
            }
        }
    }
    let mut scratch = sampler.evaluator.scratch();
    for _ in 0..BISECTIONS {
        if cancel.is_cancelled() {
            return Err(Cancelled);
        }
        let middle = |open: &Open| {
            let [(a, _), (b, _)] = open.ends;
            [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
        };
        for part in open.chunks_mut(1024) {
            let places: Vec<Point> = part.iter().map(middle).collect();
            let found = sampler.samples(&places, &mut scratch);
            for ((open, place), sample) in part.iter_mut().zip(places).zip(found) {
                let is_beyond = sample.is_beyond(&open.ends[0].1, &open.ends[1].1, grid.step);
                open.ends[usize::from(is_beyond)] = (place, sample);
            }
        }
    }
    let is_edge = |open: &&Open| open.ends[0].1.differs(&open.ends[1].1, jump);
    Ok(open.iter().filter(is_edge).map(|open| (open.side, open.ends[0].0)).collect())
}

/// Joins the crossings within each cell by lines, and these to longer ones.
fn joined(grid: &Grid, crossings: &Crossings) -> Vec<Vec<Point>> {
    let mut segments: Vec<[Point; 2]> = Vec::new();
    for row in 0..grid.rows.saturating_sub(1) {
        for column in 0..grid.columns.saturating_sub(1) {
            let sides = [
                (grid.index(column, row), 0),
                (grid.index(column, row + 1), 0),
                (grid.index(column, row), 1),
                (grid.index(column + 1, row), 1),
            ];
            let own: Vec<Point> = sides.iter().filter_map(|side| crossings.get(side).copied()).collect();
            match own[..] {
                [] | [_] => {}
                [a, b] => segments.push([a, b]),
                _ => {
                    let mean = |k: usize| own.iter().map(|p| p[k]).sum::<f64>() / own.len() as f64;
                    let middle = [mean(0), mean(1)];
                    segments.extend(own.iter().map(|&p| [p, middle]));
                }
            }
        }
    }
    chains(&segments)
}

/// Joins segments with common ends to lines. Where more than two meet, lines end.
pub(crate) fn chains(segments: &[[Point; 2]]) -> Vec<Vec<Point>> {
    let key = |p: Point| p.map(f64::to_bits);
    let mut at: BTreeMap<[u64; 2], Vec<usize>> = BTreeMap::new();
    for (k, segment) in segments.iter().enumerate() {
        segment.iter().for_each(|&end| at.entry(key(end)).or_default().push(k));
    }
    let mut is_used = vec![false; segments.len()];
    let other = |segment: usize, end: Point| {
        let [a, b] = segments[segment];
        if key(a) == key(end) { b } else { a }
    };
    let mut lines = Vec::new();
    // first from the ends of open lines, then around closed ones
    for is_closed in [false, true] {
        for (start, segment) in segments.iter().enumerate() {
            for &end in segment {
                if is_used[start] || (!is_closed && at[&key(end)].len() == 2) {
                    continue;
                }
                let (mut line, mut next) = (vec![end], Some(start));
                while let Some(k) = next {
                    is_used[k] = true;
                    let to = other(k, line[line.len() - 1]);
                    line.push(to);
                    let meeting = &at[&key(to)];
                    next = match meeting.len() {
                        2 => meeting.iter().copied().find(|&k| !is_used[k]),
                        _ => None,
                    };
                }
                lines.push(line);
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_scene::Compiled;
    use rayweave_trace::AnyEvaluator;

    fn edges(text: &str, plane: Cut, is_behind: bool) -> Vec<Vec<Point>> {
        let (_, scene) = rayweave_scene::parse(&format!("rayweave = 1\n{text}")).unwrap();
        let evaluator = AnyEvaluator::new(None, Compiled::new(&scene).unwrap().program).unwrap();
        let view = EdgeView { plane, is_behind, window: [[-5.0; 2], [5.0; 2]], step: 0.037 };
        visible_edges(&evaluator, &view, None, &Cancel::new()).unwrap()
    }

    fn from_top() -> Cut {
        Cut::new(Vec3::ZERO, Vec3::X, Vec3::Y).unwrap()
    }

    /// The total length of lines.
    fn length(lines: &[Vec<Point>]) -> f64 {
        let step = |pair: &[Point]| libm::hypot(pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
        lines.iter().flat_map(|line| line.windows(2).map(step)).sum()
    }

    /// The outline of a ball is a circle on the ball.
    #[test]
    fn outlines_are_exact() {
        let lines = edges("[solid.ball]\nsphere = { radius = 3 }", from_top(), false);
        let [circle] = &lines[..] else { panic!("{} lines", lines.len()) };
        assert!(circle.iter().all(|p| (libm::hypot(p[0], p[1]) - 3.0).abs() < 1e-6));
        assert_eq!(circle.first(), circle.last());
        assert!((length(&lines) - std::f64::consts::TAU * 3.0).abs() < 1e-2);
    }

    /// A square pyramid from above: four sides and four edges to the apex; and no edge where a face continues another.
    #[test]
    fn edges_between_faces_are_found_and_smooth_joints_are_not() {
        let pyramid = "[solid.p]\nconvex = { planes = [[1, 0, 1, 3], [-1, 0, 1, 3], [0, 1, 1, 3], [0, -1, 1, 3], [0, 0, -1, 0]] }";
        let found = length(&edges(pyramid, from_top(), false));
        let expected = 24.0 + 4.0 * 18f64.sqrt();
        assert!((found - expected).abs() < 0.01 * expected, "{found} {expected}");
        let two = "[solid.a]\nbox_from_corners = { lo = [-3, -1, 0], hi = [0, 1, 1] }\n\
            [solid.b]\nbox_from_corners = { lo = [0, -1, 0], hi = [3, 1, 1] }\n[solid.c]\nexpr = \"a | b\"\n[[region]]\nsolid = \"c\"";
        let found = length(&edges(two, from_top(), false));
        assert!((found - 16.0).abs() < 0.2, "{found}");
    }

    /// Behind the plane z = 0 through a pipe with a step inside: only the circle of the step; the rings of the cut are not repeated.
    #[test]
    fn behind_a_plane_the_outline_of_the_cut_is_left_out() {
        let pipe = "[solid.pipe]\ncylinder = { radius = 4, height = 8 }\n[solid.wide]\ncylinder = { radius = 3, height = 6 }\n\
            transform = { translate = [0, 0, 2] }\n[solid.narrow]\ncylinder = { radius = 2 }\n\
            [solid.part]\nexpr = \"pipe - wide - narrow\"\n[[region]]\nsolid = \"part\"";
        let lines = edges(pipe, from_top(), true);
        assert!((length(&lines) - std::f64::consts::TAU * 2.0).abs() < 1e-2, "{}", length(&lines));
        assert!(lines.iter().flatten().all(|p| (libm::hypot(p[0], p[1]) - 2.0).abs() < 1e-6));
    }

    #[test]
    fn a_torus_in_front_of_itself_has_two_outlines() {
        let ring = "[solid.ring]\ntorus = { major = 3, minor = 1 }";
        let slanted = Cut::new(Vec3::ZERO, Vec3::X, Vec3::new(0.0, 0.5, 1.0)).unwrap();
        // the outer outline is the ellipse of the ring, with semi-axes of 3 and 3 / sqrt(5), moved outwards by 1: its length is that
        // of the ellipse, 14.14 by Ramanujan's formula, and of a circle; a part of that around the hole is visible as well
        let (outer, slant) = (14.14 + std::f64::consts::TAU, length(&edges(ring, slanted, false)));
        assert!(slant > outer + 3.0 && slant < outer + 14.14, "{slant}");
        let top = length(&edges(ring, from_top(), false));
        assert!((top - std::f64::consts::TAU * 6.0).abs() < 2e-2, "{top}");
    }
}
