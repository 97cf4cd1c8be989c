//! One side of a surface, prepared for SIMD lanes.

use super::axis::{AxisCylinder, AxisSlab, axis_of_plane};
use super::cone::ConeLanes;
use super::quadratic::Roots;
use super::quadric::LaneQuadric;
use super::ray::{LaneRay, LaneStarts, Uncertain};
use super::span::{Gap, LaneSpan};
use super::torus::{LaneTorus, TorusInterval};
use super::vector::{Lanes, Mask, Vec3Lanes, splat};
use crate::surface::{Approach, Cone, Cylinder, DOT_NOISE, Plane, Sphere, Surface};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::Vec3;

/// The lane kernels.
#[derive(Clone, Debug)]
pub enum Kernel {
    /// A plane across coordinate axis `axis`: normal `sign` along it.
    AxisPlane {
        /// 0, 1 or 2.
        axis: u8,
        /// 1 or -1.
        sign: f64,
        /// Offset of the [`Plane`].
        offset: f64,
    },
    /// Any other plane.
    Plane(Plane),
    /// A sphere.
    Sphere(Sphere),
    /// A cylinder.
    Cylinder(Cylinder),
    /// A cylinder along a coordinate axis.
    AxisCylinder(AxisCylinder),
    /// Two opposite faces of an axis-parallel box.
    AxisSlab(AxisSlab),
    /// Two opposite faces of a box in any direction.
    Slab(LaneSlab),
    /// A cone.
    Cone(Cone),
    /// Any other surface of degree 2. (Boxed, as large kernels are rare: tables of facets fit nearer caches.)
    Quadric(Box<LaneQuadric>),
    /// A torus.
    Torus(Box<LaneTorus>),
}

/// Two parallel planes that face away from each other.
#[derive(Clone, Copy, Debug)]
pub struct LaneSlab {
    /// Unit normal of the high plane.
    pub normal: Vec3,
    /// Offset of the plane with the opposite normal, and the number of its face.
    pub low: (f64, f64),
    /// Offset of the plane with the normal, and the number of its face.
    pub high: (f64, f64),
    /// For the low and high plane: true if the leaf is the outside of the plane with the opposite sign.
    pub turned: [bool; 2],
}

impl Kernel {
    /// The kernel for a surface; `None` if there is none.
    pub fn of(surface: &Surface) -> Option<Kernel> {
        match surface {
            Surface::Plane(plane) => Some(axis_plane(plane).unwrap_or(Kernel::Plane(*plane))),
            Surface::Sphere(sphere) => Some(Kernel::Sphere(*sphere)),
            Surface::Cylinder(cylinder) => {
                let along = AxisCylinder::of(cylinder).map(Kernel::AxisCylinder);
                Some(along.unwrap_or(Kernel::Cylinder(*cylinder)))
            }
            Surface::Cone(cone) => Some(Kernel::Cone(*cone)),
            Surface::Quadric(quadric) => Some(Kernel::Quadric(Box::new(LaneQuadric::of(quadric)))),
            Surface::Torus(torus) => Some(Kernel::Torus(Box::new(LaneTorus::plain(torus)))),
            Surface::AffineTorus(torus) => {
                LaneTorus::image(torus).map(|torus| Kernel::Torus(Box::new(torus)))
            }
            Surface::Object(_) => None,
        }
    }

    /// The point between the two pieces of the inside of a cone or a hyperboloid of two sheets; some planes through it
    /// separate the pieces.
    pub fn waist(&self) -> Option<Vec3> {
        match self {
            Kernel::Cone(cone) => Some(cone.apex),
            Kernel::Quadric(quadric) => quadric.waist(),
            _ => None,
        }
    }
}

fn axis_plane(plane: &Plane) -> Option<Kernel> {
    let (axis, sign) = axis_of_plane(plane)?;
    Some(Kernel::AxisPlane { axis, sign, offset: plane.offset })
}

/// A side of a surface that bounds a leaf.
#[derive(Clone, Debug)]
pub struct LaneFacet {
    /// The surface.
    pub kernel: Kernel,
    /// True if the leaf lies where f < 0.
    pub inside: bool,
    /// The number of the face.
    pub face: f64,
    /// Number of the surface, twice; for two faces of a box, those of the lower and the higher one.
    pub surfaces: [f64; 2],
    /// Number of the gap that the facet may cut out of the span of its leaf, from 1: see [`LaneFacet::can_gap`].
    pub gap: u32,
    /// True if the other facets of the leaf are expected to cut off one of the two pieces that the gap of this facet
    /// leaves. Rays for which both pieces remain are uncertain; such a facet must be the last.
    pub is_one_piece: bool,
}

impl LaneFacet {
    /// True if the facet may hold before and after some interval, but not within it.
    pub fn can_gap(&self) -> bool {
        match &self.kernel {
            Kernel::AxisPlane { .. } | Kernel::AxisSlab(_) | Kernel::Slab(_) | Kernel::Plane(_) => false,
            Kernel::Sphere(_) | Kernel::Cylinder(_) | Kernel::AxisCylinder(_) => !self.inside,
            Kernel::Quadric(quadric) => !self.inside || quadric.may_open,
            Kernel::Cone(_) | Kernel::Torus(_) => true,
        }
    }

    /// False if the facet may hold in more than two pieces.
    pub fn has_one_gap(&self) -> bool {
        self.inside || !matches!(self.kernel, Kernel::Torus(_))
    }

    /// This facet and the next one of the same leaf as a single slab, if they are opposite faces of a box.
    pub fn joined(&self, next: &LaneFacet) -> Option<LaneFacet> {
        let (here, there) = (self.surfaces[0], next.surfaces[0]);
        let (kernel, surfaces) = match (&self.kernel, &next.kernel) {
            (
                &Kernel::AxisPlane { axis, sign, offset },
                &Kernel::AxisPlane { axis: other, sign: next_sign, offset: next_offset },
            ) if axis == other => {
                // the signs for which the facets are the insides of their planes
                let outward = |inside: bool, sign: f64, offset: f64| {
                    if inside { (sign, offset) } else { (-sign, -offset) }
                };
                let (sign, offset) = outward(self.inside, sign, offset);
                let (next_sign, next_offset) = outward(next.inside, next_sign, next_offset);
                if sign == next_sign {
                    return None;
                }
                let here = ((offset, self.face), here, !self.inside);
                let there = ((next_offset, next.face), there, !next.inside);
                let (low, high) = if sign < 0.0 { (here, there) } else { (there, here) };
                let slab = AxisSlab { axis, low: low.0, high: high.0, turned: [low.2, high.2] };
                (Kernel::AxisSlab(slab), [low.1, high.1])
            }
            (Kernel::Plane(plane), Kernel::Plane(other)) => {
                let (high, low) = (self.outward(plane), next.outward(other));
                if high.normal != -low.normal {
                    return None;
                }
                let (low, normal) = ((low.offset, next.face), high.normal);
                let (high, turned) = ((high.offset, self.face), [!next.inside, !self.inside]);
                (Kernel::Slab(LaneSlab { normal, low, high, turned }), [there, here])
            }
            _ => return None,
        };
        Some(LaneFacet { kernel, surfaces, inside: true, ..self.clone() })
    }

    /// The plane with the sign for which the facet is its inside. Exact, here and along a ray.
    fn outward(&self, plane: &Plane) -> Plane {
        match self.inside {
            true => *plane,
            false => Plane { normal: -plane.normal, offset: -plane.offset },
        }
    }

    /// The span of a leaf that is the inside of a ball or a cylinder, of which this is the only facet: faster than
    /// [`LaneFacet::narrow`]. `None` for other facets.
    #[inline(always)]
    pub fn only<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        uncertain: &mut Uncertain<S>,
    ) -> Option<LaneSpan<S>> {
        if !self.inside {
            return None;
        }
        let (from, to) = match &self.kernel {
            Kernel::AxisCylinder(cylinder) => {
                let approach = cylinder.approach(ray);
                cylinder_times(simd, splat(simd, cylinder.radius), &approach, ray, uncertain)
            }
            Kernel::Sphere(sphere) => {
                let approach = sphere.approach(ray.origin, ray.direction, ray.square);
                or_empty(simd, &approach, approach.half())
            }
            _ => return None,
        };
        let face = splat(simd, self.face);
        Some(LaneSpan { from, to, from_face: face, to_face: face })
    }

    /// Narrows the span of a leaf to where this facet holds, or returns a gap in which it does not hold.
    #[inline(always)]
    pub fn narrow<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        span: &mut LaneSpan<S>,
        uncertain: &mut Uncertain<S>,
    ) -> Option<Gap<S>> {
        match &self.kernel {
            &Kernel::AxisPlane { axis, sign, offset } => {
                let height = splat(simd, offset) - ray.origin.component(axis.into()) * sign;
                let speed = ray.direction.component(axis.into()) * sign;
                let side = (self.inside, splat(simd, self.face));
                narrow_to_plane(simd, ray, [height, speed], side, span, uncertain);
                None
            }
            Kernel::Plane(plane) => {
                let height = splat(simd, plane.offset) - ray.origin.dot_all(plane.normal);
                let speed = certain_dot(simd, ray, Vec3Lanes::splat(simd, plane.normal));
                let side = (self.inside, splat(simd, self.face));
                narrow_to_plane(simd, ray, [height, speed], side, span, uncertain);
                None
            }
            Kernel::Sphere(sphere) => {
                let approach = sphere.approach(ray.origin, ray.direction, ray.square);
                let (from, to) = or_empty(simd, &approach, approach.half());
                self.apply_interval(simd, from, to, span)
            }
            Kernel::Cylinder(cylinder) => {
                let approach = cylinder.approach(ray.origin, ray.direction, ray.slow_square);
                let (from, to) =
                    cylinder_times(simd, splat(simd, cylinder.radius), &approach, ray, uncertain);
                self.apply_interval(simd, from, to, span)
            }
            Kernel::AxisCylinder(cylinder) => {
                let approach = cylinder.approach(ray);
                let (from, to) =
                    cylinder_times(simd, splat(simd, cylinder.radius), &approach, ray, uncertain);
                self.apply_interval(simd, from, to, span)
            }
            Kernel::AxisSlab(_) | Kernel::Slab(_) => {
                self.slab(simd, ray, None, span, uncertain);
                None
            }
            Kernel::Torus(torus) => Some(self.torus(simd, torus, ray, span, uncertain)),
            Kernel::Cone(_) | Kernel::Quadric(_) => {
                // out of line and on copies, so that the most frequent kernels stay in registers
                let (ray, mut copies) = (*ray, (*span, *uncertain));
                let gap = simd.vectorize(
                    #[inline(always)]
                    || self.narrow_curved(simd, &ray, &mut copies.0, &mut copies.1),
                );
                (*span, *uncertain) = copies;
                gap
            }
        }
    }

    /// Lane version of [`LaneFacet::narrow`] for surfaces with long kernels.
    #[inline(always)]
    fn narrow_curved<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        span: &mut LaneSpan<S>,
        uncertain: &mut Uncertain<S>,
    ) -> Option<Gap<S>> {
        match &self.kernel {
            Kernel::Cone(cone) => {
                let cone = ConeLanes::same(simd, cone);
                let roots = super::cone::roots(simd, &cone, ray, uncertain);
                Some(self.curved_side(simd).narrow(simd, ray, (&roots, cone.bend()), span, uncertain))
            }
            Kernel::Quadric(quadric) => {
                let roots = quadric.roots(simd, ray, uncertain);
                Some(self.curved_side(simd).narrow(simd, ray, (&roots, splat(simd, 1.0)), span, uncertain))
            }
            _ => None,
        }
    }

    #[inline(always)]
    fn curved_side<S: Simd>(&self, simd: S) -> CurvedSide<S> {
        CurvedSide { inside: self.inside, is_one_piece: self.is_one_piece, face: splat(simd, self.face) }
    }

    /// A torus: most rays miss its bounding ball and skip the rest.
    #[inline(always)]
    fn torus<S: Simd>(
        &self,
        simd: S,
        torus: &LaneTorus,
        ray: &LaneRay<S>,
        span: &mut LaneSpan<S>,
        uncertain: &mut Uncertain<S>,
    ) -> Gap<S> {
        let approach = torus.approach(ray);
        let queried = torus.may_meet(ray, &approach) & span.is_some();
        let interval = if queried.any_true() {
            let (ray, mut copy) = (*ray, *uncertain);
            let interval = simd.vectorize(
                #[inline(always)]
                || torus.interval(simd, &ray, &approach, queried, &mut copy),
            );
            *uncertain = copy;
            interval
        } else {
            TorusInterval::none(simd)
        };
        self.apply_interval(simd, interval.from, interval.to, span);
        interval.gap
    }

    /// Two parallel planes that face away from each other: crossed at the same speed, one after the other. A plane that a ray
    /// starts on is not crossed again: it holds on the whole ray or not at all.
    #[inline(always)]
    pub(super) fn slab<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        starts: Option<&LaneStarts<S>>,
        span: &mut LaneSpan<S>,
        uncertain: &mut Uncertain<S>,
    ) {
        let (origin, speed, low, high, turned) = match &self.kernel {
            Kernel::AxisSlab(AxisSlab { axis, low, high, turned }) => {
                let axis = (*axis).into();
                (ray.origin.component(axis), ray.direction.component(axis), *low, *high, *turned)
            }
            Kernel::Slab(LaneSlab { normal, low, high, turned }) => (
                ray.origin.dot_all(*normal),
                certain_dot(simd, ray, Vec3Lanes::splat(simd, *normal)),
                *low,
                *high,
                *turned,
            ),
            _ => return,
        };
        let faces = [splat(simd, low.1), splat(simd, high.1)];
        let offsets = [splat(simd, low.0), splat(simd, high.0)];
        let mut times = SlabTimes::new(simd, ray, [origin, speed], offsets, uncertain);
        if let Some(starts) = starts {
            let [plus, minus] = super::ray::infinite(simd);
            let on = self.surfaces.map(|surface| starts.surface.simd_eq(surface));
            // true where the rays are between the planes just after the start
            let [above_low, below_high] =
                turned.map(|turned| if turned { !starts.inside } else { starts.inside });
            let outside = (on[0] & !above_low) | (on[1] & !below_high);
            // tangent, or against the listed side
            let (rises, falls) = (times.rises, speed.simd_lt(0.0));
            let moves = rises | falls;
            let agrees = moves & (!on[0] | !(rises ^ above_low)) & (!on[1] | !(falls ^ below_high));
            uncertain.always |= (on[0] | on[1]) & !agrees;
            times.from = ((rises & on[0]) | (!rises & on[1])).select(minus, times.from);
            times.to = ((rises & on[1]) | (!rises & on[0])).select(plus, times.to);
            times.from = outside.select(plus, times.from);
        }
        times.narrow(faces, span, uncertain);
    }

    /// Intersects the span with the interval in which f < 0, or returns that interval as a gap.
    #[inline(always)]
    fn apply_interval<S: Simd>(
        &self,
        simd: S,
        from: Lanes<S>,
        to: Lanes<S>,
        span: &mut LaneSpan<S>,
    ) -> Option<Gap<S>> {
        if !self.inside {
            return Some(Gap { from, to });
        }
        span.begin_after(from, splat(simd, self.face));
        span.end_before(to, splat(simd, self.face));
        None
    }
}

/// A side of surfaces of degree 2.
pub(super) struct CurvedSide<S: Simd> {
    /// True for the side where f < 0.
    pub inside: bool,
    /// See [`LaneFacet::is_one_piece`].
    pub is_one_piece: bool,
    pub face: Lanes<S>,
}

impl<S: Simd> CurvedSide<S> {
    /// Narrows a span to this side, which some rays are on between the roots, others outside of them. Returns the gap of the
    /// latter, unless the side is one piece. `bend` is half of the largest change of the gradient per unit of length.
    #[inline(always)]
    pub fn narrow(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        (roots, bend): (&Roots<S>, Lanes<S>),
        span: &mut LaneSpan<S>,
        uncertain: &mut Uncertain<S>,
    ) -> Gap<S> {
        let [plus, minus] = super::ray::infinite(simd);
        let narrows = if self.inside { !roots.opens } else { roots.opens };
        let (mut from, mut to) = (narrows.select(roots.from, minus), narrows.select(roots.to, plus));
        let mut gap = Gap { from: narrows.select(plus, roots.from), to: narrows.select(minus, roots.to) };
        if self.is_one_piece {
            let [before, after] = gap.pieces(span);
            // at equal times the face declared first is reported, but this facet is tested last, whatever its position
            uncertain.always |= (before & after) | roots.meets_ends(span);
            let cuts = gap.from.simd_lt(gap.to);
            to = (cuts & before).select(gap.from, to);
            from = (cuts & !before).select(gap.to, from);
            gap = Gap { from: plus, to: minus };
        }
        let (begins, ends) = (span.begin_after(from, self.face), span.end_before(to, self.face));
        if roots.is_slow(ray).any_true() {
            let either = (!narrows & (begins | ends)) | gap.from.simd_lt(gap.to);
            uncertain.grazes |= (begins | either) & roots.is_gentle(ray, roots.from, bend);
            uncertain.grazes |= (ends | either) & roots.is_gentle(ray, roots.to, bend);
        }
        gap
    }
}

/// The times at which rays are between two parallel planes that face away from each other.
pub(super) struct SlabTimes<S: Simd> {
    from: Lanes<S>,
    to: Lanes<S>,
    /// True if the low plane is crossed first.
    rises: Mask<S>,
    /// True if the planes are crossed at a grazing angle; `None` if there is no such ray.
    grazes: Option<Mask<S>>,
}

impl<S: Simd> SlabTimes<S> {
    /// From the position and the speed of the rays across the planes, and the offsets of the planes: of the low one with the
    /// opposite normal.
    #[inline(always)]
    pub fn new(
        simd: S,
        ray: &LaneRay<S>,
        [origin, speed]: [Lanes<S>; 2],
        [low, high]: [Lanes<S>; 2],
        uncertain: &mut Uncertain<S>,
    ) -> Self {
        let (below, above) = (origin + low, high - origin);
        let (low, high) = (below / -speed + 0.0, above / speed + 0.0);
        let rises = speed.simd_gt(0.0);
        let (mut from, mut to) = (rises.select(low, high), rises.select(high, low));
        let slow = speed.abs().simd_le(ray.slow_plane);
        if !slow.any_true() {
            return SlabTimes { from, to, rises, grazes: None };
        }
        let [plus, minus] = super::ray::infinite(simd);
        let finite = low.abs().max(high.abs()).simd_lt(plus);
        // c - n . r(middle)
        let shift = ray.middle * speed;
        let near = (below + shift).abs().min((above - shift).abs());
        uncertain.always |= slow & near.simd_le(ray.near);
        let zero = splat(simd, 0.0);
        let parallel = speed.simd_eq(zero);
        // the time is out of range
        uncertain.always |= !finite & !parallel;
        let holds = below.simd_gt(zero) & above.simd_gt(zero);
        from = parallel.select(holds.select(minus, plus), from);
        to = parallel.select(holds.select(plus, minus), to);
        SlabTimes { from, to, rises, grazes: Some(slow & !parallel) }
    }

    /// Narrows a span to these times; `faces` are those of the low and the high plane.
    #[inline(always)]
    pub fn narrow(self, [low, high]: [Lanes<S>; 2], span: &mut LaneSpan<S>, uncertain: &mut Uncertain<S>) {
        let begins = span.begin_after(self.from, self.rises.select(low, high));
        let ends = span.end_before(self.to, self.rises.select(high, low));
        if let Some(grazes) = self.grazes {
            uncertain.grazes |= grazes & (begins | ends);
        }
    }
}

/// Narrows a span to one side of a plane that is crossed at `height / speed`: before or after that time. `inside` is true for the
/// side where f < 0.
#[inline(always)]
pub(super) fn narrow_to_plane<S: Simd>(
    simd: S,
    ray: &LaneRay<S>,
    [height, speed]: [Lanes<S>; 2],
    (inside, face): (bool, Lanes<S>),
    span: &mut LaneSpan<S>,
    uncertain: &mut Uncertain<S>,
) {
    let t = height / speed + 0.0;
    let [plus, minus] = super::ray::infinite(simd);
    let before = if inside { speed.simd_gt(0.0) } else { speed.simd_lt(0.0) };
    let (mut from, mut to) = (before.select(minus, t), before.select(t, plus));
    let slow = speed.abs().simd_le(ray.slow_plane);
    let (any_slow, mut finite) = (slow.any_true(), slow);
    if any_slow {
        finite = t.abs().simd_lt(f64::INFINITY);
        let below = height.simd_gt(0.0);
        let holds = if inside { below } else { !below };
        from = finite.select(from, holds.select(minus, plus));
        to = finite.select(to, holds.select(plus, minus));
    }
    let (begins, ends) = (span.begin_after(from, face), span.end_before(to, face));
    if any_slow {
        // c - n . r(middle)
        let value = height - ray.middle * speed;
        uncertain.always |= slow & value.abs().simd_le(ray.near);
        uncertain.grazes |= slow & finite & (begins | ends);
    }
}

/// Lane version of [`certain_dot`](crate::surface) for the directions of rays.
#[inline(always)]
pub(super) fn certain_dot<S: Simd>(simd: S, ray: &LaneRay<S>, normal: Vec3Lanes<S>) -> Lanes<S> {
    let dot = ray.direction.dot(normal);
    let size = dot.abs();
    // the terms add up to less than the taxicab length, up to rounding
    if !size.simd_le(ray.speed * (1.01 * DOT_NOISE)).any_true() {
        return dot;
    }
    let terms = ray.direction.abs().dot(normal.abs());
    size.simd_le(terms * DOT_NOISE).select(splat(simd, 0.0), dot)
}

/// Interval inside a cylinder, equal to [`Cylinder::crossings`].
#[inline(always)]
pub(super) fn cylinder_times<S: Simd>(
    simd: S,
    radius: Lanes<S>,
    approach: &Approach<Lanes<S>>,
    ray: &LaneRay<S>,
    uncertain: &mut Uncertain<S>,
) -> (Lanes<S>, Lanes<S>) {
    let &Approach { time, square, inside } = approach;
    let slow = square.simd_lt(ray.slow_square);
    let any_slow = slow.any_true();
    let half = approach.half();
    // f(r(middle)), and a quarter of the squared gradient
    let late = ray.middle - time;
    let value = square * late * late - inside;
    let slope = value + radius * radius;
    // |f| <= delta (|grad f| + delta), squared, with 2 (x^2 + y^2) >= (x + y)^2
    let near = ray.near * ray.near;
    let bound = near * (slope.abs() * 4.0 + near) * 2.0;
    uncertain.always |= (value * value).simd_le(bound);
    let (mut from, mut to) = or_empty(simd, approach, half);
    if any_slow {
        let zero = splat(simd, 0.0);
        let (enters, parallel) = (inside.simd_gt(zero), square.simd_eq(zero));
        uncertain.grazes |= slow & enters & !parallel;
        // half of the interval may be infinite although its square is not
        uncertain.always |= enters & !parallel & !half.simd_lt(f64::INFINITY);
        let [plus, minus] = super::ray::infinite(simd);
        let holds: Mask<S> = parallel & enters;
        (from, to) = (holds.select(minus, from), holds.select(plus, to));
    }
    (from, to)
}

/// The interval of `half` before and after the closest approach; empty, from +inf to -inf, for a miss.
#[inline(always)]
pub(super) fn or_empty<S: Simd>(
    simd: S,
    approach: &Approach<Lanes<S>>,
    half: Lanes<S>,
) -> (Lanes<S>, Lanes<S>) {
    let [plus, minus] = super::ray::infinite(simd);
    let (time, enters) = (approach.time, approach.inside.simd_gt(0.0));
    (enters.select(time - half + 0.0, plus), enters.select(time + half + 0.0, minus))
}
