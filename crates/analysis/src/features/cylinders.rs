//! Cylindrical faces: holes, shafts, and rounded edges.

use super::spans::{Spans, spans_along};
use crate::distance::world_surfaces;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::weld::local_ray;
use rayweave_model::{Crossing, Evaluator, Query, RayAnswer, RayBatch, SurfaceEntry};
use rayweave_shape::Ray;
use rayweave_shape::surface::{Cylinder, Surface};
use std::f64::consts::TAU;

/// A circular cylinder, or a part of one, that is a face of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CylindricalFace {
    /// The points of the axis at both ends of the face.
    pub ends: [Vec3; 2],
    /// The radius.
    pub radius: f64,
    /// True if the material is outside, as at a hole; false if it is inside, as at a shaft.
    pub is_hole: bool,
    /// The part of the circumference that belongs to the face, 0 to 1, in steps of 1/24.
    pub share: f64,
    /// The direction from the axis to the middle of the face around it, a unit vector to 1/48 of a turn; zero if the face goes all the
    /// way around.
    pub middle: Vec3,
    /// The depth of a hole that ends in the material at one end, on its axis. It is measured from the face around the open end, plane or
    /// curved and in front of a chamfer, to the floor of the hole, behind a fillet or chamfer in the corner. A hole without a floor, such as one with a conical
    /// or spherical end, is as deep as its full diameter: the depth ends where the cylinder does.
    pub depth: Option<f64>,
    /// True if a hole is open at both ends; a groove is closed at both. Only the region around a hole closes it, not another part
    /// in front of it, such as the head of a bolt.
    pub is_through: bool,
}

impl CylindricalFace {
    /// The unit vector along the axis.
    pub fn axis(&self) -> Vec3 {
        (self.ends[1] - self.ends[0]).normalize_or_zero()
    }

    /// The length along the axis.
    pub fn length(&self) -> f64 {
        (self.ends[1] - self.ends[0]).length()
    }

    /// True if the face goes all the way around.
    pub fn is_round(&self) -> bool {
        self.share == 1.0
    }

    /// True if another face is the same to rounding.
    fn is_like(&self, other: &CylindricalFace, tolerance: f64) -> bool {
        let is_near = |a: Vec3, b: Vec3| (a - b).length() < tolerance;
        let [a, b] = [self.ends, other.ends];
        (self.radius - other.radius).abs() < tolerance
            && self.is_hole == other.is_hole
            && (is_near(a[0], b[0]) && is_near(a[1], b[1]) || is_near(a[0], b[1]) && is_near(a[1], b[0]))
    }
}

/// The cylindrical faces of a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CylindricalFaces {
    /// The faces, the largest radius first.
    pub faces: Vec<CylindricalFace>,
    /// The number of cylinders that were not examined, since there are more than [`MAX_CYLINDERS`](CylindricalFaces::MAX_CYLINDERS), or
    /// more than a million surfaces of any kind.
    pub left_out: usize,
}

impl CylindricalFaces {
    /// The greatest number of cylinders that are examined.
    pub const MAX_CYLINDERS: usize = 2000;
}

/// The number of lines along a cylinder, each a pair inside and outside of it.
const LINES: usize = 24;

/// The distance of the lines from the cylinder in radii: the square root of the unit roundoff u = 1.1e-16. A distance d has the relative
/// error u / d by rounding of the radius, and lines end off the ends of the face by d times the slope there; both are equal at this d.
const OFFSET: f64 = 1e-8;

/// The least distance relative to the size of the model. A line counts as in the surface up to 64 u times the lengths involved, its
/// origin, its length and the position of the surface, which are at most five sizes together: 4e-14, far below this distance.
const LEAST_OFFSET: f64 = 1e-11;

/// Shorter pieces than this, in radii, result from the distance of the lines. At an end with slope s they are 2 `OFFSET` s long; at a
/// tangent rounding of half the radius r, sqrt(2 (r/2) `OFFSET` r), which is the square root of `OFFSET`.
const SHORT: f64 = 1e-4;

/// The difference of ends of faces that are the same, relative to the size of the model. Both ends are off by the distance of the lines
/// times the slope at the end, and the radius is at most half the size: at ten times [`OFFSET`], slopes up to 10 are covered.
const SAME: f64 = 1e-7;

/// The difference of positions along the axis, in radii, that counts as rounding, here of planes across the axis. Positions are exact to
/// 64 u times five sizes, 4e-14 of the size: the radius is larger than 4e-5 of it. Lines are 1/100 of a radius apart or more, so that
/// planes tilted by less than 1e-7 count as perpendicular to the axis.
const FLAT: f64 = 1e-9;

/// Finds the cylindrical faces of a bounded model. Cylinders that a transform has made elliptic are not included.
///
/// ```
/// use rayweave_analysis::features::cylindrical_faces;
/// use rayweave_math::Vec3;
/// use rayweave_model::{Program, Solid};
/// use rayweave_shape::primitive::{CentredBox, Cylinder, Primitive};
/// use rayweave_trace::Packets;
/// use std::sync::Arc;
///
/// let plate = Solid::from(Primitive::from(CentredBox::new(Vec3::new(40.0, 40.0, 10.0))?));
/// let drill = Solid::from(Primitive::from(Cylinder::new(3.0, 8.0)?));
/// // a hole from above, 4 deep
/// let part = &plate - &drill.translate(Vec3::new(0.0, 0.0, 5.0));
/// let found = cylindrical_faces(&Packets::new(Arc::new(Program::compile(&part)?)));
/// let [hole] = &found.faces[..] else { panic!("one face") };
/// assert!(hole.is_hole && hole.is_round() && hole.radius == 3.0);
/// assert!((hole.depth.ok_or("open")? - 4.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn cylindrical_faces<E: Evaluator>(evaluator: &E) -> CylindricalFaces {
    let program = evaluator.program();
    let bounds = program.bounds();
    if bounds.is_empty() || !bounds.is_finite() {
        return CylindricalFaces::default();
    }
    let Some(surfaces) = world_surfaces(program) else {
        // those of placed solids count once
        let is_cylinder = |entry: &&SurfaceEntry| matches!(entry.surface, Surface::Cylinder(_));
        let left_out = program.surfaces().iter().filter(is_cylinder).count();
        return CylindricalFaces { faces: Vec::new(), left_out };
    };
    let cylinders = surfaces.into_iter().filter_map(|surface| match surface {
        Surface::Cylinder(cylinder) => Some(cylinder),
        _ => None,
    });
    let mut cylinders: Vec<Cylinder> = cylinders.collect();
    let left_out = cylinders.len().saturating_sub(CylindricalFaces::MAX_CYLINDERS);
    cylinders.truncate(CylindricalFaces::MAX_CYLINDERS);
    let tolerance = SAME * bounds.size().max_element();
    let (mut faces, mut scratch): (Vec<CylindricalFace>, _) = (Vec::new(), evaluator.scratch());
    for cylinder in &cylinders {
        let lines = Lines::new(evaluator, cylinder, &bounds, &mut scratch);
        for face in lines.faces(evaluator, &mut scratch) {
            if !faces.iter().any(|known| known.is_like(&face, tolerance)) {
                faces.push(face);
            }
        }
    }
    faces.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    CylindricalFaces { faces, left_out }
}

/// Pairs of lines along a cylinder.
struct Lines<'a> {
    cylinder: &'a Cylinder,
    /// The point of the axis at t = 0.
    base: Vec3,
    across: [Vec3; 2],
    /// The distance of the lines from the cylinder.
    offset: f64,
    /// For each angle, the spans inside and outside of the cylinder.
    pairs: Vec<[Spans; 2]>,
}

/// A piece of a line along which a cylinder separates material from space.
#[derive(Clone, Copy)]
struct Stretch {
    line: usize,
    from: f64,
    to: f64,
    is_hole: bool,
}

impl<'a> Lines<'a> {
    fn new<E: Evaluator>(
        evaluator: &E,
        cylinder: &'a Cylinder,
        bounds: &Bounds,
        scratch: &mut E::Scratch,
    ) -> Lines<'a> {
        let axis = cylinder.axis;
        let base = cylinder.point + axis * axis.dot(bounds.centre() - cylinder.point);
        let flat =
            [0, 1, 2].into_iter().min_by(|&a, &b| axis[a].abs().total_cmp(&axis[b].abs())).unwrap_or(0);
        let first = (Vec3::AXES[flat] - axis * axis[flat]).normalize_or_zero();
        let offset = (OFFSET * cylinder.radius).max(LEAST_OFFSET * bounds.size().length());
        let across = [first, axis.cross(first)];
        let mut lines = Lines { cylinder, base, across, offset, pairs: Vec::new() };
        let radii = [cylinder.radius - offset, cylinder.radius + offset];
        let places: Vec<(usize, f64)> =
            (0..LINES).flat_map(|line| radii.map(|radius| (line, radius))).collect();
        let spans = lines.spans(evaluator, &places, scratch);
        let pair = |pair: &[Spans]| [pair[0].clone(), pair[1].clone()];
        lines.pairs = spans.chunks_exact(2).map(pair).collect();
        lines
    }

    /// The direction from the axis to a line.
    fn out(&self, line: usize) -> Vec3 {
        // beside the axes of the model, where seams and corners are likely
        let angle = TAU * (line as f64 + 0.37) / LINES as f64;
        libm::cos(angle) * self.across[0] + libm::sin(angle) * self.across[1]
    }

    /// The direction to the middle of the lines of a face. Opposite parts of one cylinder have none: the first part counts.
    fn middle(&self, is_there: &[bool; LINES]) -> Vec3 {
        let there = || (0..LINES).filter(|line| is_there[*line]);
        let sum: Vec3 = there().map(|line| self.out(line)).sum();
        match there().count() {
            LINES => Vec3::ZERO,
            _ if sum.length() > 0.5 => sum.normalize(),
            _ => there().next().map_or(Vec3::ZERO, |line| self.out(line)),
        }
    }

    /// The spans of lines at angles and distances from the axis.
    fn spans<E: Evaluator>(
        &self,
        evaluator: &E,
        places: &[(usize, f64)],
        scratch: &mut E::Scratch,
    ) -> Vec<Spans> {
        let mut batch = RayBatch::default();
        for &(line, radius) in places {
            batch.push(Ray::new(self.base + radius * self.out(line), self.cylinder.axis));
        }
        spans_along(evaluator, &batch, scratch)
    }

    fn faces<E: Evaluator>(&self, evaluator: &E, scratch: &mut E::Scratch) -> Vec<CylindricalFace> {
        let mut stretches: Vec<Stretch> =
            (0..LINES).flat_map(|line| self.stretches(line, &self.pairs[line])).collect();
        stretches.sort_by(|a, b| a.is_hole.cmp(&b.is_hole).then(a.from.total_cmp(&b.from)));
        let mut groups: Vec<Vec<Stretch>> = Vec::new();
        let mut end = f64::NEG_INFINITY;
        for stretch in stretches {
            match groups.last_mut() {
                Some(group) if group[0].is_hole == stretch.is_hole && stretch.from < end => {
                    end = end.max(stretch.to);
                    group.push(stretch);
                }
                _ => {
                    end = stretch.to;
                    groups.push(vec![stretch]);
                }
            }
        }
        groups.iter().map(|group| self.face(group, evaluator, scratch)).collect()
    }

    fn face<E: Evaluator>(
        &self,
        group: &[Stretch],
        evaluator: &E,
        scratch: &mut E::Scratch,
    ) -> CylindricalFace {
        let from = self.end(group, -1.0, evaluator, scratch);
        let to = self.end(group, 1.0, evaluator, scratch);
        let mut is_there = [false; LINES];
        group.iter().for_each(|stretch| is_there[stretch.line] = true);
        let count = is_there.iter().filter(|is| **is).count();
        let is_hole = group[0].is_hole;
        let beyond = SHORT * self.cylinder.radius;
        // most of the lines inside end in the material that is outside
        let is_closed = |at: &dyn Fn(&Stretch) -> [f64; 2]| {
            let is_same = |stretch: &&Stretch| {
                let ([inner, outer], [beyond, within]) = (&self.pairs[stretch.line], at(stretch));
                inner.is_in(beyond) && inner.region(beyond) == outer.region(within)
            };
            2 * group.iter().filter(is_same).count() > group.len()
        };
        let closed = [
            is_closed(&|stretch| [stretch.from - beyond, stretch.from + 0.5 * beyond]),
            is_closed(&|stretch| [stretch.to + beyond, stretch.to - 0.5 * beyond]),
        ];
        let depth = match (is_hole, closed) {
            (true, [false, true]) => {
                let floor = self.floor(group[0].line, to, 1.0, evaluator, scratch);
                Some(floor - self.opening(group, from, -1.0, evaluator, scratch))
            }
            (true, [true, false]) => {
                let floor = self.floor(group[0].line, from, -1.0, evaluator, scratch);
                Some(self.opening(group, to, 1.0, evaluator, scratch) - floor)
            }
            _ => None,
        };
        let axis = self.cylinder.axis;
        CylindricalFace {
            ends: [self.base + from * axis, self.base + to * axis],
            radius: self.cylinder.radius,
            is_hole,
            share: count as f64 / LINES as f64,
            middle: self.middle(&is_there),
            depth,
            is_through: is_hole && closed == [false; 2],
        }
    }

    /// The end of a face, in the direction of the axis or against it.
    ///
    /// If a rounding of radius r touches the cylinder there, a line at a distance d from the cylinder ends sqrt(2 r d) beyond the face.
    /// A line at four times the distance ends twice as far beyond, and the end of the face follows from both.
    fn end<E: Evaluator>(
        &self,
        group: &[Stretch],
        sign: f64,
        evaluator: &E,
        scratch: &mut E::Scratch,
    ) -> f64 {
        let of = |stretch: &Stretch| if sign > 0.0 { stretch.to } else { stretch.from };
        let Some(last) = group.iter().max_by(|a, b| (sign * of(a)).total_cmp(&(sign * of(b)))) else {
            return f64::NAN;
        };
        let radii = [-4.0, 4.0].map(|k| (last.line, self.cylinder.radius + k * self.offset));
        let mut spans = self.spans(evaluator, &radii, scratch).into_iter();
        let (Some(inner), Some(outer)) = (spans.next(), spans.next()) else { return of(last) };
        let wide = self
            .stretches(last.line, &[inner, outer])
            .into_iter()
            .find(|own| own.is_hole == last.is_hole && own.from < last.to && last.from < own.to);
        let beyond = wide.map_or(0.0, |wide| of(&wide) - of(last));
        // a plane or a cone at the end is no farther than a few distances
        if beyond.abs() > 100.0 * self.offset { of(last) - beyond } else { of(last) }
    }

    /// The pieces of a line with material on one side only; `pair` are the spans inside and outside of the cylinder.
    fn stretches(&self, line: usize, [inner, outer]: &[Spans; 2]) -> Vec<Stretch> {
        let mut ends: Vec<f64> = inner.ends().chain(outer.ends()).collect();
        ends.sort_by(f64::total_cmp);
        let least = SHORT * self.cylinder.radius;
        let mut found: Vec<Stretch> = Vec::new();
        for pair in ends.windows(2).filter(|pair| pair[1] - pair[0] > least) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let [is_in, is_out] = [inner, outer].map(|spans| spans.is_in(middle));
            if is_in == is_out {
                continue;
            }
            let is_hole = is_out;
            match found.last_mut() {
                Some(last) if last.is_hole == is_hole && pair[0] - last.to <= least => last.to = pair[1],
                _ => found.push(Stretch { line, from: pair[0], to: pair[1], is_hole }),
            }
        }
        found
    }

    /// The position of the plane around the open end of a hole: the end itself, or that of the face beyond a chamfer.
    fn opening<E: Evaluator>(
        &self,
        group: &[Stretch],
        end: f64,
        sign: f64,
        evaluator: &E,
        scratch: &mut E::Scratch,
    ) -> f64 {
        /// Lines farther and farther outside: a chamfer is at most twice as wide as the hole.
        const RADII: usize = 40;
        let (line, radius) = (group[0].line, self.cylinder.radius);
        let places: Vec<(usize, f64)> =
            (1..=RADII).map(|k| (line, radius * (1.0 + 0.05 * k as f64))).collect();
        let within = end - sign * SHORT * radius;
        let region = self.pairs[line][1].region(within);
        let exit = |spans: &Spans| spans.onward(within, sign).filter(|_| spans.region(within) == region);
        let exits: Vec<Option<f64>> =
            self.spans(evaluator, &places, scratch).iter().map(exit).take_while(Option::is_some).collect();
        let exits: Vec<f64> = exits.into_iter().flatten().collect();
        let is_flat = |pair: &&[f64]| (pair[1] - pair[0]).abs() < FLAT * radius;
        let flat = exits.windows(2).find(is_flat).map(|pair| pair[0]);
        flat.filter(|flat| sign * (flat - end) > 0.0)
            .or_else(|| self.opening_on_axis(group, end, sign, evaluator, scratch))
            .unwrap_or(end)
    }

    /// The place where the axis crosses the surface around the open end of a hole, which is a plane or a curved face.
    fn opening_on_axis<E: Evaluator>(
        &self,
        group: &[Stretch],
        end: f64,
        sign: f64,
        evaluator: &E,
        scratch: &mut E::Scratch,
    ) -> Option<f64> {
        let (program, axis, radius) = (evaluator.program(), self.cylinder.axis, self.cylinder.radius);
        let mut batch = RayBatch::default();
        // the line that reaches farthest
        let of = |stretch: &Stretch| if sign > 0.0 { stretch.to } else { -stretch.from };
        let farthest = group.iter().max_by(|a, b| of(a).total_cmp(&of(b)))?.line;
        batch.push(Ray::new(self.base + (radius + self.offset) * self.out(farthest), axis));
        let mut nearest: Option<Crossing> = None;
        let mut sink = |answer: RayAnswer<'_>| {
            let far = |crossing: &&Crossing| (crossing.t - end).abs();
            nearest = answer.crossings.iter().min_by(|a, b| far(a).total_cmp(&far(b))).copied();
        };
        evaluator.crossings(batch.rays(), &Query::default(), scratch, &mut sink);
        let face = nearest?.face;
        let (ray, _) = local_ray(program, &Ray::new(self.base, axis), face.placement);
        // the axis of a hole crosses a chamfer at its apex, and misses a fillet
        let surface = &program.surface(face.surface).surface;
        let is_outer = matches!(
            surface,
            Surface::Plane(_) | Surface::Sphere(_) | Surface::Cylinder(_) | Surface::Quadric(_)
        );
        let crossings = is_outer.then(|| surface.crossings(&ray))?;
        let times = crossings.times().iter().copied().filter(|t| (t - end).abs() < 2.0 * radius);
        times.min_by(|s, t| (s - end).abs().total_cmp(&(t - end).abs()))
    }

    /// The position of the floor of a hole, perpendicular to the axis, if a fillet or a chamfer in the corner leads to it; otherwise the
    /// end of the cylinder. `sign` is the direction of the floor.
    fn floor<E: Evaluator>(
        &self,
        line: usize,
        end: f64,
        sign: f64,
        evaluator: &E,
        scratch: &mut E::Scratch,
    ) -> f64 {
        /// Lines farther and farther inside.
        const STEPS: usize = 100;
        let radius = self.cylinder.radius;
        let step = radius / STEPS as f64;
        let rounding = FLAT * radius;
        let within = end - sign * SHORT * radius;
        let places: Vec<(usize, f64)> = (1..STEPS).map(|k| (line, radius - step * k as f64)).collect();
        let (mut last, mut rise) = (end, f64::INFINITY);
        for (k, spans) in self.spans(evaluator, &places, scratch).iter().enumerate() {
            let Some(next) = spans.onward(within, sign).filter(|_| !spans.is_in(within)) else { return end };
            let further = sign * (next - last);
            if k > 0 && further.abs() < rounding {
                // a corner is at most as deep as it is wide
                let is_corner = sign * (last - end) <= step * (k as f64 + 1.0) + rounding;
                return if is_corner { last } else { end };
            }
            // the slope of a chamfer is constant, and that of a fillet falls; at a smaller hole the bottom gets steeper
            if further < -rounding || further > rise + rounding {
                return end;
            }
            (last, rise) = (next, further);
        }
        end
    }
}
