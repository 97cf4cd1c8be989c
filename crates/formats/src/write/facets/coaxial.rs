//! Booleans of solids of revolution about a common axis, in the half-plane of their profiles.
//!
//! Two such solids may touch along a circle, for example a fillet and the plane beside it. The facets of one then cut those of the other in
//! slivers, and the mesh kernel may return triangles that intersect. In the half-plane the circle is a point, which both profiles have as
//! a vertex. Profiles are combined with `i_overlay`, and revolved before they are combined with a solid of another kind.

use super::revolved::{self, circle_count};
use super::{number, planes_of, profile};
use crate::kernel::Body;
use crate::write::fold::Operation;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::simplify::SimplifyShape;
use i_overlay::float::single::SingleFloatOverlay;
use rayweave_math::{Affine, Bounds, Vec3, any_perpendicular, sin_cos_degrees};
use rayweave_model::MAX_POINTS;
use rayweave_shape::primitive::{Primitive, Value};

/// Closed chains of points (r, z).
type Contours = Vec<Vec<[f64; 2]>>;

/// The spacing of the grid of points relative to the size of the model, as in the drawings of OpenSCAD files: far above the rounding
/// errors of profiles, so that common vertices stay equal, and far below any tolerance. A power of 2.
const GRID: f64 = 1.0 / (1u64 << 40) as f64;

/// The relative size of a deviation of axes or of a double root that counts as 0: matrices of files have rounding errors.
const NEAR: f64 = 1e-12;

/// The thickness in spacings below which a contour is what rounding left between two parts with a common edge.
const SLIVER: f64 = 8.0;

/// An axis of revolution.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Axis {
    /// The point of the axis nearest to the origin.
    point: Vec3,
    /// A unit vector whose largest component is positive.
    along: Vec3,
}

/// A solid of revolution by its profile in the half-plane r >= 0.
#[derive(Clone, Debug)]
pub(in crate::write) struct Turned {
    axis: Axis,
    profile: Contours,
    /// True if chords replace arcs.
    is_bent: bool,
    /// True if the profile is exact only within the clip box.
    is_cut: bool,
}

/// The clip box and the tolerance of a profile.
#[derive(Clone, Copy)]
pub(in crate::write) struct Frame<'a> {
    pub clip: &'a Bounds,
    pub tolerance: f64,
}

impl Frame<'_> {
    /// The highest r and the lowest and highest z of a rectangle that contains the clip box and a margin.
    fn rectangle(&self, axis: &Axis) -> [f64; 3] {
        let (mut reach, mut low, mut high) = (0.0f64, f64::INFINITY, f64::NEG_INFINITY);
        for corner in self.clip.corners() {
            let from = corner - axis.point;
            let z = from.dot(axis.along);
            reach = reach.max((from - z * axis.along).length());
            (low, high) = (low.min(z), high.max(z));
        }
        let margin = 0.125 * reach.max(high - low);
        [reach + margin, low - margin, high + margin]
    }

    /// Spacing of the grid.
    fn spacing(&self) -> f64 {
        libm::exp2(libm::ceil(libm::log2(self.clip.size().length()))) * GRID
    }

    fn snapped(&self, mut contours: Contours) -> Contours {
        let spacing = self.spacing();
        contours.iter_mut().flatten().flatten().for_each(|x| *x = libm::rint(*x / spacing) * spacing);
        contours
    }

    fn whole(&self, axis: &Axis) -> Contours {
        let [reach, low, high] = self.rectangle(axis);
        self.snapped(vec![vec![[0.0, low], [reach, low], [reach, high], [0.0, high]]])
    }

    fn is_same(&self, a: &Axis, b: &Axis) -> bool {
        let size = self.clip.size().length();
        (a.along - b.along).length() <= NEAR && (a.point - b.point).length() <= NEAR * size
    }
}

impl Turned {
    /// A placed shape; `None` if it is not a solid of revolution about the z axis of its frame, or not one of the kinds that outlines
    /// consist of.
    pub fn of(shape: &Primitive, place: &Affine, frame: Frame) -> Result<Option<Turned>, String> {
        let Some(scale) = place.similarity() else { return Ok(None) };
        let mut along = place.linear.z_axis / scale;
        let largest = along.to_array().into_iter().fold(0.0f64, |a, b| if b.abs() > a.abs() { b } else { a });
        let sign = if largest < 0.0 { -1.0 } else { 1.0 };
        along *= sign;
        let lift = place.translation.dot(along);
        let axis = Axis { point: place.translation - lift * along, along };
        // the frame of the shape in that of the axis: r grows by `scale`, z by `scale * sign`, then by `lift`
        let [reach, low, high] = frame.rectangle(&axis);
        let ends = [low, high].map(|z| (z - lift) / (scale * sign));
        let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        let room = [reach / scale, low, high];
        let Some((contours, is_bent, is_cut)) = local(shape, room, frame.tolerance / scale)? else {
            return Ok(None);
        };
        let placed = |[r, z]: &[f64; 2]| [scale * r, scale * sign * z + lift];
        let contours: Contours = contours.iter().map(|own| own.iter().map(placed).collect()).collect();
        let profile = frame.snapped(contours).simplify_shape_as::<i64>(FillRule::EvenOdd);
        let profile = profile.into_iter().flatten().collect();
        Ok(Some(Turned { axis, profile, is_bent, is_cut }))
    }

    /// The whole rectangle about the axis of another solid.
    pub fn everything(other: &Turned, frame: Frame) -> Turned {
        let profile = frame.whole(&other.axis);
        Turned { axis: other.axis, profile, is_bent: false, is_cut: true }
    }

    /// True if both have the same axis.
    pub fn is_coaxial(&self, other: &Turned, frame: Frame) -> bool {
        frame.is_same(&self.axis, &other.axis)
    }

    /// The boolean of one or more solids with the same axis; `None` if it is empty.
    pub fn join(by: Operation, parts: Vec<Turned>, frame: Frame) -> Option<Turned> {
        let united = |all: Contours| -> Contours {
            all.simplify_shape_as::<i64>(FillRule::NonZero).into_iter().flatten().collect()
        };
        let overlaid = |a: &Contours, b: &Contours, rule: OverlayRule| -> Contours {
            a.overlay_as::<i64>(b, rule, FillRule::NonZero).into_iter().flatten().collect()
        };
        let is_bent = parts.iter().any(|part| part.is_bent);
        let is_cut = parts.iter().any(|part| part.is_cut);
        let axis = parts.first()?.axis;
        let mut profiles = parts.into_iter().map(|part| part.profile);
        let profile = match by {
            Operation::Union => united(profiles.flatten().collect()),
            Operation::Difference => {
                let first = profiles.next()?;
                overlaid(&first, &united(profiles.flatten().collect()), OverlayRule::Difference)
            }
            Operation::Intersection => {
                let first = profiles.next()?;
                profiles.fold(first, |rest, other| overlaid(&rest, &other, OverlayRule::Intersect))
            }
        };
        let profile = frame.snapped(profile);
        (!profile.is_empty()).then_some(Turned { axis, profile, is_bent, is_cut })
    }

    /// The solid as facets; `None` if it is empty.
    pub fn body(&self, frame: Frame) -> Result<Option<Body>, String> {
        let spacing = frame.spacing();
        // snapped points may have moved edges onto each other
        let contours = self.profile.simplify_shape_as::<i64>(FillRule::NonZero).into_iter().flatten();
        let contours: Contours = contours.filter_map(|contour| without_slivers(contour, spacing)).collect();
        if contours.is_empty() {
            return Ok(None);
        }
        let reach = contours.iter().flatten().map(|point| point[0]).fold(0.0, f64::max);
        let n = circle_count(reach, frame.tolerance / if self.is_bent { 2.0 } else { 1.0 })?;
        let count: usize = contours.iter().map(Vec::len).sum();
        if count.saturating_mul(n) > MAX_POINTS {
            return Err(format!("it needs more than {MAX_POINTS} vertices"));
        }
        let Axis { point, along } = self.axis;
        // facets start at +x, as those of all other shapes
        let across = if along == Vec3::Z { Vec3::X } else { any_perpendicular(along) };
        let other = along.cross(across);
        let turns: Vec<Vec3> = (0..n)
            .map(|k| {
                let (sin, cos) = sin_cos_degrees(360.0 * k as f64 / n as f64);
                cos * across + sin * other
            })
            .collect();
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for contour in &contours {
            let rings: Vec<[u32; 2]> = contour
                .iter()
                .map(|[r, z]| {
                    let (from, middle) = (points.len() as u32, point + *z * along);
                    match *r <= SLIVER * spacing {
                        true => points.push(middle),
                        false => points.extend(turns.iter().map(|turn| middle + *r * *turn)),
                    }
                    [from, points.len() as u32 - from]
                })
                .collect();
            for (k, [from, count]) in rings.iter().enumerate() {
                let [next, following] = rings[(k + 1) % rings.len()];
                revolved::between([*from, next], [*count, following], &mut triangles);
            }
        }
        let body = Body::from_triangles(points, triangles)?;
        match body {
            Some(body) if self.is_cut && !self.is_within(&contours, frame) => {
                body.intersection(&Body::cuboid(frame.clip))
            }
            body => Ok(body),
        }
    }

    /// True if the solid lies within the clip box.
    fn is_within(&self, contours: &Contours, frame: Frame) -> bool {
        contours.iter().flatten().all(|[r, z]| {
            let middle = self.axis.point + *z * self.axis.along;
            // the extent of a circle along each axis of space
            let extent = |k: usize| r * libm::sqrt((1.0 - self.axis.along[k] * self.axis.along[k]).max(0.0));
            (0..3).all(|k| {
                middle[k] - extent(k) >= frame.clip.lo[k] && middle[k] + extent(k) <= frame.clip.hi[k]
            })
        })
    }
}

/// A contour without points that repeat their neighbour; `None` if it is only what rounding left between two edges.
fn without_slivers(mut contour: Vec<[f64; 2]>, spacing: f64) -> Option<Vec<[f64; 2]>> {
    contour.dedup();
    let edges = || contour.iter().zip(contour.iter().cycle().skip(1));
    let area: f64 = edges().map(|([a, b], [c, d])| 0.5 * (a * d - b * c)).sum();
    let length: f64 = edges().map(|([a, b], [c, d])| libm::hypot(c - a, d - b)).sum();
    (contour.len() > 2 && area.abs() > SLIVER * spacing * length).then_some(contour)
}

/// The profile of a shape about its own z axis, within a rectangle (highest r, lowest and highest z); whether it has chords instead of
/// arcs; and whether it is cut.
fn local(
    shape: &Primitive,
    room @ [reach, low, high]: [f64; 3],
    tolerance: f64,
) -> Result<Option<(Contours, bool, bool)>, String> {
    let clip = Bounds::new(Vec3::new(-reach, -reach, low), Vec3::new(reach, reach, high));
    if let Primitive::Cylinder(_)
    | Primitive::Tube(_)
    | Primitive::Cone(_)
    | Primitive::Sphere(_)
    | Primitive::Torus(_) = shape
    {
        let is_cut = number(shape, "height").is_some_and(f64::is_infinite);
        let Some(own) = profile(shape, &clip, tolerance)? else { return Ok(None) };
        return Ok(Some((vec![own.points], own.is_bent, is_cut)));
    }
    let half_plane = |normal: [f64; 2], offset: f64| half_plane(room, normal, offset);
    if let Primitive::HalfSpace(_) | Primitive::Slab(_) = shape {
        let lowered = shape.lower();
        let Some(planes) = planes_of(&lowered).filter(|_| !lowered.complement) else { return Ok(None) };
        let mut all = vec![rectangle(room)];
        for (normal, offset) in planes {
            if normal.x != 0.0 || normal.y != 0.0 {
                return Ok(None);
            }
            all = all
                .overlay_as::<i64>(
                    &half_plane([0.0, normal.z], offset),
                    OverlayRule::Intersect,
                    FillRule::NonZero,
                )
                .into_iter()
                .flatten()
                .collect();
        }
        return Ok(Some((all, false, true)));
    }
    let Some([slope, radius]) = cone(shape) else { return Ok(None) };
    // r < slope z + radius, or r < -(slope z + radius) beyond the apex
    let contours = [1.0, -1.0].map(|side| half_plane([1.0, -side * slope], side * radius)).concat();
    Ok(Some((contours, false, true)))
}

/// True for a quadric that is a cone about the z axis of its frame.
pub(in crate::write) fn is_cone(shape: &Primitive) -> bool {
    cone(shape).is_some_and(|[slope, _]| slope > 0.0)
}

/// Slope and radius of the double cone `r^2 < (slope z + radius)^2`, or of a cylinder, that a quadric about the z axis is.
fn cone(shape: &Primitive) -> Option<[f64; 2]> {
    let Primitive::Quadric(_) = shape else { return None };
    let q = shape.arguments().into_iter().find_map(|(_, value)| match value {
        Value::Rows(rows) if rows.len() == 4 && rows.iter().all(|row| row.len() == 4) => Some(rows),
        _ => None,
    })?;
    let a = q[0][0];
    let is_turned =
        [(0, 1), (0, 2), (1, 2), (0, 3), (1, 3)].iter().all(|&(i, j)| q[i][j] == 0.0 && q[j][i] == 0.0);
    let [zz, z, c] = [q[2][2], 0.5 * (q[2][3] + q[3][2]), q[3][3]].map(|entry| -entry / a);
    if !(a > 0.0 && a == q[1][1] && is_turned && zz >= 0.0 && c >= 0.0 && zz + c > 0.0) {
        return None;
    }
    // a double root: zz c = z^2
    if (zz * c - z * z).abs() > NEAR * (zz * c).max(z * z) {
        return None;
    }
    let (slope, radius) = (libm::sqrt(zz), libm::sqrt(c));
    Some([slope, if z < 0.0 { -radius } else { radius }])
}

fn rectangle([reach, low, high]: [f64; 3]) -> Vec<[f64; 2]> {
    vec![[0.0, low], [reach, low], [reach, high], [0.0, high]]
}

/// The part of a rectangle where `a r + b z < offset`, with `[a, b]` the normal.
fn half_plane(room: [f64; 3], [a, b]: [f64; 2], offset: f64) -> Contours {
    let corners = rectangle(room);
    let height = |[r, z]: [f64; 2]| a * r + b * z - offset;
    let mut kept = Vec::new();
    for (k, &p) in corners.iter().enumerate() {
        let q = corners[(k + 1) % corners.len()];
        let (g, h) = (height(p), height(q));
        if g <= 0.0 {
            kept.push(p);
        }
        if g * h < 0.0 {
            kept.push([0, 1].map(|i| if p[i] == q[i] { p[i] } else { p[i] + (q[i] - p[i]) * (g / (g - h)) }));
        }
    }
    if kept.len() > 2 { vec![kept] } else { Vec::new() }
}
