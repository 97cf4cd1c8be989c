//! Corners between two scan lines, from the surfaces of the faces that they cross.

use super::Cut;
use super::scan_line::{ScanCrossing, ScanLine};
use rayweave_math::{Affine, Transform, UNIT_ROUNDOFF, Vec3};
use rayweave_model::{Face, Program};
use rayweave_shape::surface::Surface;

/// Corners are computed between scan lines with at least this number of crossings together: shorter ones are halved at little cost.
const LONG: usize = 32;

/// The number of crossings that are compared to find where two scan lines agree again.
const AHEAD: usize = 64;

/// The distance of crossings that are not welded, and the largest distance of scan lines from a corner, relative to the coordinates.
const WELDED: f64 = 4096.0 * UNIT_ROUNDOFF;
const FARTHEST: f64 = 1e-9;

/// The most corners for each gap; further ones are found in the gaps between them.
pub const MAX_CORNERS: usize = 256;

/// The most steps of Newton's method to the common point of two curves, each of which doubles the number of correct digits.
const STEPS: usize = 12;

/// Finds corners of a section.
pub struct Corners<'a> {
    pub program: &'a Program,
    pub cut: &'a Cut,
    /// Half the largest width of a gap that is not divided further.
    pub narrow: f64,
    /// The largest coordinate.
    pub size: f64,
}

/// A corner.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// Coordinates across the scan lines on both sides of it.
    pub between: [f64; 2],
    /// The coordinate along the scan lines.
    pub v: f64,
    /// The largest distance along the scan lines of the faces from the corner between these sides, with rounding.
    pub reach: f64,
}

/// The intersection `a u + b v = c` of a flat face with the plane of the section.
pub type Line = [f64; 3];

impl Corners<'_> {
    /// Positions on both sides of each corner at which faces of two scan lines meet, in ascending order. They divide the gap between
    /// the scan lines into narrow gaps around the corners and wide ones between them. A corner may be missing, or a position may have
    /// no corner.
    pub fn between(&self, left: &ScanLine, right: &ScanLine) -> Vec<f64> {
        let middle = 0.5 * (left.u + right.u);
        let corner = |[a, b]: [ScanCrossing; 2]| {
            let flat = self.corner(a.face?, b.face?).map(|corner| corner.between);
            flat.or_else(|| self.curved_corner(a.face?, b.face?, [middle, 0.5 * (a.v + b.v)]))
        };
        let mut found: Vec<[f64; 2]> =
            self.meeting(left, right).into_iter().flatten().filter_map(corner).collect();
        found.retain(|[from, to]| left.u < *from && *to < right.u);
        found.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut apart: Vec<[f64; 2]> = Vec::new();
        for [from, to] in found {
            match apart.last_mut().filter(|last| from <= last[1]) {
                Some(last) => last[1] = last[1].max(to),
                None => apart.push([from, to]),
            }
        }
        apart.truncate(MAX_CORNERS);
        apart.into_flattened()
    }

    /// The corners of flat faces between two scan lines, in ascending order; `None` for short scan lines, which are halved at little
    /// cost.
    pub fn of_flat_faces(&self, left: &ScanLine, right: &ScanLine) -> Option<Vec<Corner>> {
        let pairs = self.meeting(left, right)?;
        let corner = |[a, b]: [ScanCrossing; 2]| self.corner(a.face?, b.face?);
        let mut found: Vec<Corner> = pairs.into_iter().filter_map(corner).collect();
        found.retain(|corner| left.u < corner.between[0] && corner.between[1] < right.u);
        found.sort_by(|a, b| a.between[0].total_cmp(&b.between[0]));
        Some(found)
    }

    /// The pairs of crossings whose faces may meet between two scan lines; `None` for short scan lines and narrow gaps.
    fn meeting(&self, left: &ScanLine, right: &ScanLine) -> Option<Vec<[ScanCrossing; 2]>> {
        if left.passes.len() + right.passes.len() < LONG || right.u - left.u < 64.0 * self.narrow {
            return None;
        }
        let mut found = Vec::new();
        for [a, b] in differences(&left.passes, &right.passes) {
            let meeting = |pair: &[ScanCrossing]| [pair[0], pair[1]];
            let ends = a.iter().zip(b).chain(a.iter().rev().zip(b.iter().rev()));
            let pairs = a.windows(2).map(meeting).chain(b.windows(2).map(meeting));
            found.extend(pairs.chain(ends.map(|(a, b)| [*a, *b])));
        }
        Some(found)
    }

    /// The corner of two flat faces, with positions far enough from it for crossings that rounding does not weld.
    fn corner(&self, one: Face, two: Face) -> Option<Corner> {
        let [[a, b, c], [d, e, f]] = [self.line(one)?, self.line(two)?];
        let determinant = a * e - b * d;
        let [u, v] = [(c * e - b * f) / determinant, (a * f - c * d) / determinant];
        let apart = determinant / (b * e);
        let aside = self.narrow.max(WELDED * self.size / apart.abs());
        // the faces are at most as far along the scan lines as the steeper one rises, apart from rounding
        let reach = (a / b).abs().max((d / e).abs()) * aside + WELDED * self.size;
        (u.is_finite() && aside <= FARTHEST * self.size).then_some(Corner {
            between: [u - aside, u + aside],
            v,
            reach,
        })
    }

    /// Like [`corner`](Self::corner) of faces that are not both flat: the common point of their curves that Newton's method reaches from
    /// a point.
    fn curved_corner(&self, one: Face, two: Face, from: [f64; 2]) -> Option<[f64; 2]> {
        let curves = [self.curve(one)?, self.curve(two)?];
        let [origin, across, up] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|place| self.cut.point(place));
        let [across, up] = [across - origin, up - origin];
        let mut place = from;
        for _ in 0..STEPS {
            let point = self.cut.point(place);
            let [[f, a, b], [g, c, d]] = curves.map(|(surface, local_from_world)| {
                let (value, gradient) = surface.value_and_gradient(local_from_world.point(point));
                let along = |way: Vec3| gradient.dot(local_from_world.vector(way));
                [value, along(across), along(up)]
            });
            let determinant = a * d - b * c;
            let step = [(f * d - b * g) / determinant, (a * g - c * f) / determinant];
            if !step.iter().all(|x| x.is_finite()) {
                return None;
            }
            place = [place[0] - step[0], place[1] - step[1]];
            // the error of the next step, its square, is below rounding
            if step.iter().all(|x| x.abs() <= FARTHEST * self.size) {
                let apart = determinant / (b * d);
                let aside = self.narrow.max(WELDED * self.size / apart.abs());
                return (aside <= FARTHEST * self.size).then_some([place[0] - aside, place[0] + aside]);
            }
        }
        None
    }

    /// The surface of a face, and the map of the world to its frame.
    fn curve(&self, face: Face) -> Option<(&Surface, Affine)> {
        let map = self.program.placement(face.placement).0;
        let surface = &self.program.surface(face.surface).surface;
        // the equation of an object, such as a mesh, is not that of the surface through a crossing
        (!matches!(surface, Surface::Object(_))).then_some((surface, map.inverse().ok()?))
    }

    /// The line of a flat face.
    pub fn line(&self, face: Face) -> Option<Line> {
        let own = &self.program.surface(face.surface).surface;
        let map = self.program.placement(face.placement).0;
        let Surface::Plane(plane) = own.transformed(&Transform::from_affine(map).ok()?) else { return None };
        let [origin, u, v] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|place| self.cut.point(place));
        let normal = plane.normal;
        Some([normal.dot(u - origin), normal.dot(v - origin), plane.offset - normal.dot(origin)])
    }
}

/// The parts of two lists of crossings that differ.
fn differences<'a>(left: &'a [ScanCrossing], right: &'a [ScanCrossing]) -> Vec<[&'a [ScanCrossing]; 2]> {
    let (mut found, mut i, mut j) = (Vec::new(), 0, 0);
    while i < left.len() || j < right.len() {
        if i < left.len() && j < right.len() && left[i].is_like(&right[j]) {
            (i, j) = (i + 1, j + 1);
            continue;
        }
        let is_next = |a: usize, b: usize| match (left.get(i + a), right.get(j + b)) {
            (Some(one), Some(two)) => one.is_like(two),
            (None, None) => true,
            _ => false,
        };
        let ahead = (1..=AHEAD).flat_map(|sum| (0..=sum).map(move |a| (a, sum - a)));
        let (a, b) = ahead.into_iter().find(|&(a, b)| is_next(a, b)).unwrap_or((AHEAD, AHEAD));
        let ends = [(i + a).min(left.len()), (j + b).min(right.len())];
        found.push([&left[i.min(ends[0])..ends[0]], &right[j.min(ends[1])..ends[1]]]);
        [i, j] = ends;
    }
    found
}
