//! Polygonal faces along the axes (pockets, holes and bosses), and steps: planes perpendicular to an axis.

use super::CylindricalFace;
use super::spans::{Spans, spans_along};
use crate::Cancelled;
use crate::distance::world_surfaces;
use crate::section::{Cut, SectionError, SectionRun, SectionWindow, section_with};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Evaluator, RayBatch, RegionId};
use rayweave_shape::Ray;
use rayweave_shape::surface::Surface;

/// A prism along an axis whose cross-section is a regular polygon or a rectangle: a hole, a pocket or a boss.
#[derive(Clone, Debug, PartialEq)]
pub struct PolygonalFace {
    /// The corners at the lower end, counter-clockwise as seen from the upper one.
    pub corners: Vec<Vec3>,
    /// The vector from the lower end to the upper one: in the direction of x, y or z.
    pub along: Vec3,
    /// True if the material is outside, as at a hole; false if it is inside, as at a boss.
    pub is_hole: bool,
    /// The depth of a hole that ends in the material at one end.
    pub depth: Option<f64>,
    /// The radius of the rounded corners of a rectangle, all of them equal; 0 for sharp corners. `corners` are those of its sides,
    /// extended.
    pub corner_radius: f64,
}

/// The features of a model along the axes x, y and z.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxialFeatures {
    /// Polygonal holes, which are open at one end or both, and bosses with at least five sides.
    pub polygons: Vec<PolygonalFace>,
    /// For each axis, the coordinates of the flat faces perpendicular to it between the ends of the model, in ascending order,
    /// without the floors of round and polygonal holes.
    pub steps: [Vec<f64>; 3],
    /// The axes that have too many faces: no polygons were searched for along these.
    pub left_out: Vec<usize>,
}

/// Rays along each side of a cross-section of the box, and the distance of the rays that test whether a face is flat, in cells.
const ACROSS: usize = 64;
const APART: f64 = 0.31;

/// The least number of places of a step.
const PLACES: usize = 3;

/// The greatest number of slabs between flat faces in which cross-sections are computed.
const MAX_SLABS: usize = 32;

/// The greatest number of corners of a polygon, and of points of a contour, whose corners may be round.
const MAX_CORNERS: usize = 256;
const MAX_POINTS: usize = 4096;

/// The relative error of equal lengths, and the distance of the lines inside and outside of an edge.
const EQUAL: f64 = 1e-7;
const BESIDE: f64 = 1e-6;

/// Finds the polygonal faces and steps of a bounded model along its axes; `round` are its cylindrical faces.
///
/// # Errors
///
/// [`Cancelled`].
pub fn axial_features<E: Evaluator>(
    evaluator: &E,
    round: &[CylindricalFace],
    run: &SectionRun,
) -> Result<AxialFeatures, Cancelled> {
    let bounds = evaluator.program().bounds();
    if bounds.is_empty() || !bounds.is_finite() {
        return Ok(AxialFeatures::default());
    }
    let planes: Vec<(Vec3, f64)> = world_surfaces(evaluator.program())
        .unwrap_or_default()
        .into_iter()
        .filter_map(|surface| match surface {
            Surface::Plane(plane) => Some((plane.normal, plane.offset)),
            _ => None,
        })
        .collect();
    let mut found = AxialFeatures::default();
    let mut all_flat = Vec::new();
    for axis in 0..3 {
        let view = AxisView::new(evaluator, &bounds, axis);
        let flat = view.flat_places();
        let own = planes.iter().filter(|(normal, _)| normal[axis].abs() > 1.0 - 1e-12);
        let mut levels: Vec<f64> = own.map(|(normal, offset)| offset * normal[axis].signum()).collect();
        levels.extend(flat.iter().map(|place| place.level));
        match view.slabs(levels) {
            Some(slabs) => found.polygons.extend(view.polygons(&slabs, run)?),
            None => found.left_out.push(axis),
        }
        all_flat.push(flat);
    }
    for (axis, flat) in all_flat.iter().enumerate() {
        found.steps[axis] = AxisView::new(evaluator, &bounds, axis).steps(flat, round, &found.polygons);
    }
    Ok(found)
}

/// A model, seen along an axis.
struct AxisView<'a, E> {
    evaluator: &'a E,
    bounds: &'a Bounds,
    axis: usize,
    size: f64,
}

/// A flat place of a face, perpendicular to the axis.
struct FlatPlace {
    at: [f64; 2],
    level: f64,
}

impl<'a, E: Evaluator> AxisView<'a, E> {
    fn new(evaluator: &'a E, bounds: &'a Bounds, axis: usize) -> AxisView<'a, E> {
        AxisView { evaluator, bounds, axis, size: bounds.size().max_element() }
    }

    /// The plane at a level, with the axis as its normal.
    fn cut(&self, level: f64) -> Option<Cut> {
        Cut::new(self.direction() * level, self.across(0), self.across(1)).ok()
    }

    fn direction(&self) -> Vec3 {
        Vec3::AXES[self.axis]
    }

    fn across(&self, k: usize) -> Vec3 {
        Vec3::AXES[(self.axis + 1 + k) % 3]
    }

    fn place(&self, point: Vec3) -> [f64; 2] {
        [self.across(0).dot(point), self.across(1).dot(point)]
    }

    /// The places where three rays beside each other cross a face at the same level.
    fn flat_places(&self) -> Vec<FlatPlace> {
        let (lo, step) =
            (self.place(self.bounds.lo), self.place(self.bounds.size()).map(|x| x / ACROSS as f64));
        let base = self.direction() * self.bounds.centre()[self.axis];
        let (mut batch, mut places) = (RayBatch::default(), Vec::new());
        for cell in 0..ACROSS * ACROSS {
            let [i, j] = [cell % ACROSS, cell / ACROSS].map(|k| k as f64 + 0.5);
            for [right, up] in [[0.0, 0.0], [APART, 0.0], [0.0, APART]] {
                let at = [lo[0] + step[0] * (i + right), lo[1] + step[1] * (j + up)];
                places.push(at);
                batch
                    .push(Ray::new(base + at[0] * self.across(0) + at[1] * self.across(1), self.direction()));
            }
        }
        let spans = spans_along(self.evaluator, &batch, &mut self.evaluator.scratch());
        let mut found = Vec::new();
        for (rays, at) in spans.chunks_exact(3).zip(places.chunks_exact(3)) {
            for t in rays[0].ends() {
                let is_there = |other: &Spans| other.ends().any(|own| (own - t).abs() < 1e-9 * self.size);
                if is_there(&rays[1]) && is_there(&rays[2]) {
                    found.push(FlatPlace { at: at[0], level: base[self.axis] + t });
                }
            }
        }
        found
    }

    /// The middles of the slabs between the levels; `None` if there are too many.
    fn slabs(&self, mut levels: Vec<f64>) -> Option<Vec<f64>> {
        let [lo, hi] = [self.bounds.lo[self.axis], self.bounds.hi[self.axis]];
        levels.extend([lo, hi]);
        levels.retain(|level| (lo..=hi).contains(level));
        levels.sort_by(f64::total_cmp);
        let is_slab = |pair: &&[f64]| pair[1] - pair[0] > 10.0 * BESIDE * self.size;
        let middles: Vec<f64> =
            levels.windows(2).filter(is_slab).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        (middles.len() <= MAX_SLABS).then_some(middles)
    }

    fn polygons(&self, slabs: &[f64], run: &SectionRun) -> Result<Vec<PolygonalFace>, Cancelled> {
        let program = self.evaluator.program();
        let margin = 0.013 * self.size;
        let [lo, hi] = [self.bounds.lo, self.bounds.hi].map(|corner| self.place(corner));
        let window = SectionWindow {
            columns: 256,
            ..SectionWindow::new(lo.map(|x| x - margin), hi.map(|x| x + margin))
        };
        let regions = 1..=program.region_bounds().len();
        let regions: Vec<RegionId> =
            regions.map(|k| RegionId(k as _)).filter(|&id| program.medium_of(id) != 0).collect();
        let mut found: Vec<PolygonalFace> = Vec::new();
        for &level in slabs {
            let Some(cut) = self.cut(level) else { continue };
            let section = match section_with(self.evaluator, &cut, &window, run) {
                Ok(section) => section,
                Err(SectionError::Cancelled) => return Err(Cancelled),
                Err(_) => continue,
            };
            for contour in regions.iter().flat_map(|&region| section.contours(region)) {
                let Some(face) = self.face(&contour, &cut) else { continue };
                let is_known = |own: &PolygonalFace| own.is_like(&face, 10.0 * EQUAL * self.size);
                if !found.iter().any(is_known) {
                    found.push(face);
                }
            }
        }
        Ok(found)
    }

    /// The face of a contour, if it is a polygon of a known kind and a hole that is open somewhere, or a boss.
    fn face(&self, contour: &[[f64; 2]], cut: &Cut) -> Option<PolygonalFace> {
        let mut points = corners(contour, EQUAL * self.size);
        let is_hole = area(&points) < 0.0;
        if is_hole {
            points.reverse();
        }
        let rounded = if is_hole { straight_sides(&points) } else { None };
        let sides = rounded.map_or_else(|| edges(&points), Vec::from);
        let corners = match sides.len() <= MAX_CORNERS {
            true => self.sharpened(&sides, cut)?,
            false => return None,
        };
        let corner_radius = match rounded {
            Some(_) => self.corner_radius(&corners, &points, cut)?,
            None => 0.0,
        };
        let is_rectangle = is_hole && sides_of_rectangle(&corners, EQUAL * self.size).is_some();
        let is_boss = !is_hole && corners.len() >= 5;
        if !(is_rectangle || (is_hole || is_boss) && is_regular(&corners, 10.0 * EQUAL * self.size)) {
            return None;
        }
        let pairs = self.lines_beside(&corners, cut);
        // inside and outside of the edge
        let (wall, free) = if is_hole { (1, 0) } else { (0, 1) };
        if !pairs.iter().all(|pair| pair[wall].is_in(0.0) && !pair[free].is_in(0.0)) {
            return None;
        }
        let ends = [-1.0, 1.0].map(|sign| end(&pairs, [wall, free], sign, 2.0 * BESIDE * self.size));
        let [(below, is_floor), (above, is_ceiling)] = ends;
        if is_hole && is_floor && is_ceiling {
            return None;
        }
        let depth = (is_hole && (is_floor || is_ceiling)).then_some(above - below);
        let lower = corners.iter().map(|&at| cut.point(at) + below * self.direction()).collect();
        let along = (above - below) * self.direction();
        Some(PolygonalFace { corners: lower, along, is_hole, depth, corner_radius })
    }

    /// The common radius of the corners of a rectangular hole that rays towards its corners, and beside them, find. `points` are those
    /// of its contour.
    fn corner_radius(&self, corners: &[[f64; 2]], points: &[[f64; 2]], cut: &Cut) -> Option<f64> {
        const PER_RADIUS: f64 = std::f64::consts::SQRT_2 - 1.0;
        let nearest =
            |corner: [f64; 2]| points.iter().map(|&p| distance(p, corner)).fold(f64::INFINITY, f64::min);
        // from a corner into the hole, at equal angles to its sides
        let inward = |k: usize| {
            let [before, at, after] = [k + 3, k, k + 1].map(|k| corners[k % 4]);
            let to = |p: [f64; 2]| [0, 1].map(|i| (p[i] - at[i]) / distance(p, at));
            let (a, b) = (to(before), to(after));
            [0, 1].map(|i| (a[i] + b[i]) * std::f64::consts::FRAC_1_SQRT_2)
        };
        let near: Vec<f64> = (0..4).map(|k| nearest(corners[k])).collect();
        let inside = |k: usize, by: f64| [0, 1].map(|i| corners[k][i] + by * inward(k)[i]);
        let starts = (0..4).map(|k| (inside(k, 2.0 * near[k]), inward(k).map(|x| -x), near[k]));
        let depths = self.ways(starts, cut)?;
        let radii: Vec<f64> =
            depths.iter().zip(&near).map(|(t, near)| (2.0 * near - t) / PER_RADIUS).collect();
        let (radius, tolerance) = (radii[0], 10.0 * EQUAL * self.size);
        let is_equal = |own: &f64| (own - radius).abs() < tolerance;
        if radius < 100.0 * tolerance || !radii.iter().all(is_equal) {
            return None;
        }
        // rays from the centre of each corner
        let around = (0..4).flat_map(|k| {
            [-0.6, 0.3].map(|angle: f64| {
                let ([x, y], sin, cos) = (inward(k).map(|x| -x), libm::sin(angle), libm::cos(angle));
                let centre = inside(k, std::f64::consts::SQRT_2 * radius);
                (centre, [cos * x - sin * y, sin * x + cos * y], radius)
            })
        });
        self.ways(around, cut)?.iter().all(is_equal).then_some(radius)
    }

    /// The ways from points in directions to the nearest ends of material, about as long as expected; `None` if one is not there.
    fn ways(&self, rays: impl Iterator<Item = ([f64; 2], [f64; 2], f64)>, cut: &Cut) -> Option<Vec<f64>> {
        let (mut batch, mut expected) = (RayBatch::default(), Vec::new());
        for (start, out, way) in rays {
            batch.push(Ray::new(cut.point(start), out[0] * self.across(0) + out[1] * self.across(1)));
            expected.push(way);
        }
        let spans = spans_along(self.evaluator, &batch, &mut self.evaluator.scratch());
        let way = |(spans, &way): (&Spans, &f64)| {
            let t = spans.ends().min_by(|s, t| (s - way).abs().total_cmp(&(t - way).abs()))?;
            ((t - way).abs() < 0.5 * way).then_some(t)
        };
        spans.iter().zip(&expected).map(way).collect()
    }

    /// The points where the edges meet, by rays across each edge at two places: a contour may cut a corner. `None` without edges there.
    fn sharpened(&self, edges: &[[[f64; 2]; 2]], cut: &Cut) -> Option<Vec<[f64; 2]>> {
        let count = edges.len();
        let (mut batch, mut starts) = (RayBatch::default(), Vec::new());
        for &[a, b] in edges {
            let (length, far) = (distance(a, b), 0.01 * distance(a, b));
            let out = [(b[1] - a[1]) / length, (a[0] - b[0]) / length];
            for part in [0.29, 0.73] {
                let start = [0, 1].map(|i| a[i] + part * (b[i] - a[i]) - far * out[i]);
                let direction = out[0] * self.across(0) + out[1] * self.across(1);
                batch.push(Ray::new(cut.point(start), direction));
                starts.push((start, out, far));
            }
        }
        let spans = spans_along(self.evaluator, &batch, &mut self.evaluator.scratch());
        let crossing = |(spans, &([x, y], out, far)): (&Spans, &([f64; 2], [f64; 2], f64))| {
            let t = spans.ends().min_by(|s, t| (s - far).abs().total_cmp(&(t - far).abs()))?;
            ((t - far).abs() < far).then_some([x + t * out[0], y + t * out[1]])
        };
        let points: Vec<[f64; 2]> = spans.iter().zip(&starts).map(crossing).collect::<Option<_>>()?;
        let line = |k: usize| [points[2 * k], points[2 * k + 1]];
        (0..count).map(|k| meeting(line((k + count - 1) % count), line(k))).collect()
    }

    /// The spans of two lines beside the middle of each edge, inside and outside of the polygon.
    fn lines_beside(&self, corners: &[[f64; 2]], cut: &Cut) -> Vec<[Spans; 2]> {
        let mut batch = RayBatch::default();
        for (k, a) in corners.iter().enumerate() {
            let b = corners[(k + 1) % corners.len()];
            let (middle, length) = ([0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])], distance(*a, b));
            let out = [(b[1] - a[1]) / length, (a[0] - b[0]) / length];
            for sign in [-1.0, 1.0] {
                let by = sign * BESIDE * self.size;
                batch.push(Ray::new(
                    cut.point([middle[0] + by * out[0], middle[1] + by * out[1]]),
                    self.direction(),
                ));
            }
        }
        let spans = spans_along(self.evaluator, &batch, &mut self.evaluator.scratch());
        spans.chunks_exact(2).map(|pair| [pair[0].clone(), pair[1].clone()]).collect()
    }

    fn steps(&self, flat: &[FlatPlace], round: &[CylindricalFace], polygons: &[PolygonalFace]) -> Vec<f64> {
        let tolerance = EQUAL * self.size;
        let is_round = |face: &&CylindricalFace| {
            face.is_hole && face.share > 0.5 && face.axis()[self.axis].abs() > 1.0 - 1e-9
        };
        let circles: Vec<_> =
            round.iter().filter(is_round).map(|face| (self.place(face.ends[0]), face.radius)).collect();
        let is_of_hole = |place: &FlatPlace| {
            let point =
                place.at[0] * self.across(0) + place.at[1] * self.across(1) + place.level * self.direction();
            circles.iter().any(|(centre, radius)| distance(*centre, place.at) < *radius)
                || polygons.iter().any(|face| face.has(point, tolerance))
        };
        let [lo, hi] = [self.bounds.lo[self.axis], self.bounds.hi[self.axis]];
        let own = flat.iter().filter(|place| place.level > lo + tolerance && place.level < hi - tolerance);
        let mut levels: Vec<f64> = own.filter(|place| !is_of_hole(place)).map(|place| place.level).collect();
        levels.sort_by(f64::total_cmp);
        let groups = levels.chunk_by(|a, b| b - a < tolerance);
        groups.filter(|group| group.len() >= PLACES).map(|group| group[group.len() / 2]).collect()
    }
}

impl PolygonalFace {
    /// True for a point on one of its sides or, for a hole, at one of its ends.
    fn has(&self, point: Vec3, tolerance: f64) -> bool {
        let length = self.along.length();
        let axis = self.along / length;
        let height = axis.dot(point - self.corners[0]);
        if height < -tolerance || height > length + tolerance {
            return false;
        }
        let is_end = height.abs() < tolerance || (height - length).abs() < tolerance;
        let depths = self.corners.iter().enumerate().map(|(k, &a)| {
            let out = (self.corners[(k + 1) % self.corners.len()] - a).cross(axis).normalize_or_zero();
            out.dot(point - a)
        });
        let farthest = depths.fold(f64::NEG_INFINITY, f64::max);
        farthest < tolerance && (is_end && self.is_hole || farthest > -tolerance)
    }

    fn is_like(&self, other: &PolygonalFace, tolerance: f64) -> bool {
        let middle = |face: &PolygonalFace| {
            face.corners.iter().copied().fold(Vec3::ZERO, |a, b| a + b) / face.corners.len() as f64
        };
        self.corners.len() == other.corners.len()
            && self.is_hole == other.is_hole
            && (middle(self) - middle(other)).length() < tolerance
            && (self.along - other.along).length() < tolerance
            && (self.corner_radius - other.corner_radius).abs() < tolerance
            && ((self.corners[0] - middle(self)).length() - (other.corners[0] - middle(other)).length()).abs()
                < tolerance
    }
}

/// The position of the end of a face and whether it is closed by the material around it, on most of its edges. The indices are those of
/// the lines in the material and in the space beside it.
fn end(pairs: &[[Spans; 2]], [wall, free]: [usize; 2], sign: f64, beyond: f64) -> (f64, bool) {
    let of = |pair: &[Spans; 2]| {
        let exit = pair[wall].onward(0.0, sign).unwrap_or(sign * f64::INFINITY);
        let floor = pair[free].onward(0.0, sign).filter(|&floor| {
            sign * floor <= sign * exit && pair[free].region(floor + sign * beyond) == pair[wall].region(0.0)
        });
        (floor.unwrap_or(exit), floor.is_some())
    };
    let ends: Vec<(f64, bool)> = pairs.iter().map(of).collect();
    let is_closed = 2 * ends.iter().filter(|(_, is_closed)| *is_closed).count() > ends.len();
    // the nearest floor, or the farthest opening
    let own = ends.iter().filter(|(_, own)| *own == is_closed).map(|(at, _)| sign * at);
    let at =
        if is_closed { own.fold(f64::INFINITY, f64::min) } else { own.fold(f64::NEG_INFINITY, f64::max) };
    (sign * at, is_closed)
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

/// Twice the area of the triangle between three points.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn area(corners: &[[f64; 2]]) -> f64 {
    let Some(&first) = corners.first() else { return 0.0 };
    0.5 * corners.windows(2).map(|pair| turn(first, pair[0], pair[1])).sum::<f64>()
}

/// The edges between corners.
fn edges(corners: &[[f64; 2]]) -> Vec<[[f64; 2]; 2]> {
    corners.iter().enumerate().map(|(k, &corner)| [corner, corners[(k + 1) % corners.len()]]).collect()
}

/// The four sides of a rectangle with rounded corners, in order: the longest edges, with others between them.
fn straight_sides(points: &[[f64; 2]]) -> Option<[[[f64; 2]; 2]; 4]> {
    let edges = edges(points);
    let length = |k: usize| distance(edges[k][0], edges[k][1]);
    let mut longest: Vec<usize> = (0..edges.len()).collect();
    longest.sort_by(|&a, &b| length(b).total_cmp(&length(a)));
    longest.truncate(4);
    longest.sort_unstable();
    let sides: [usize; 4] = longest.try_into().ok()?;
    let is_corner = |k: usize| {
        let (one, two) = (sides[k], sides[(k + 1) % 4]);
        let [a, b] = [one, two].map(|k| [0, 1].map(|i| (edges[k][1][i] - edges[k][0][i]) / length(k)));
        (one + 1) % edges.len() != two && (a[0] * b[0] + a[1] * b[1]).abs() < 1e-3
    };
    (0..4).all(is_corner).then(|| sides.map(|k| edges[k]))
}

/// The corners of a contour: points on straight lines between their neighbours are left out. Empty if there are too many.
fn corners(contour: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let mut points: Vec<usize> = (0..contour.len()).collect();
    let apart = |a: usize, b: usize| distance(contour[a], contour[b]);
    points.dedup_by(|a, b| apart(*a, *b) < tolerance);
    while points.len() > 1 && apart(points[0], points[points.len() - 1]) < tolerance {
        points.pop();
    }
    let mut k = 0;
    while k < points.len() && points.len() > 3 {
        let count = points.len();
        let (before, after) = (points[(k + count - 1) % count], points[(k + 1) % count]);
        let bend = turn(contour[before], contour[points[k]], contour[after]).abs();
        if bend < tolerance * apart(before, after) {
            points.remove(k);
            k = k.saturating_sub(1);
        } else {
            k += 1;
        }
    }
    match (3..=MAX_POINTS).contains(&points.len()) {
        true => points.into_iter().map(|k| contour[k]).collect(),
        false => Vec::new(),
    }
}

/// The point where two lines meet.
fn meeting([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    let (one, two) = ([b[0] - a[0], b[1] - a[1]], [d[0] - c[0], d[1] - c[1]]);
    let determinant = one[0] * two[1] - one[1] * two[0];
    let t = ((c[0] - a[0]) * two[1] - (c[1] - a[1]) * two[0]) / determinant;
    t.is_finite().then(|| [a[0] + t * one[0], a[1] + t * one[1]])
}

/// True for equal edges around a common centre.
fn is_regular(corners: &[[f64; 2]], tolerance: f64) -> bool {
    let count = corners.len();
    if count < 3 {
        return false;
    }
    let centre = [0, 1].map(|k| corners.iter().map(|p| p[k]).sum::<f64>() / count as f64);
    let radius = distance(centre, corners[0]);
    let edge = 2.0 * radius * libm::sin(std::f64::consts::PI / count as f64);
    edge > 100.0 * tolerance
        && corners.iter().enumerate().all(|(k, &corner)| {
            (distance(centre, corner) - radius).abs() < tolerance
                && (distance(corner, corners[(k + 1) % count]) - edge).abs() < tolerance
        })
}

/// The longer and the shorter side of a rectangle.
pub fn sides_of_rectangle(corners: &[[f64; 2]], tolerance: f64) -> Option<[f64; 2]> {
    let [a, b, c, d] = corners[..].try_into().ok()?;
    let middle = |p: [f64; 2], q: [f64; 2]| [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
    let is_rectangle = distance(middle(a, c), middle(b, d)) < tolerance
        && (distance(a, c) - distance(b, d)).abs() < tolerance;
    let (one, two) = (distance(a, b), distance(b, c));
    (is_rectangle && one.min(two) > 100.0 * tolerance).then_some([one.max(two), one.min(two)])
}
