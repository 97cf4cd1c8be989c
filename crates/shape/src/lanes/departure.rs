//! Rays that start on surfaces, in SIMD lanes, equal to
//! [`Surface::crossings_from`](crate::surface::Surface::crossings_from): the root at the start is divided out. A plane is
//! then not crossed again, and a surface of degree 2 at most once.

use super::facet::{Kernel, LaneFacet};
use super::ray::{LaneRay, LaneStarts, Uncertain, infinite};
use super::span::{Gap, LaneSpan};
use super::vector::{Lanes, Mask, Vec3Lanes, splat};
use crate::surface::Plane;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::Vec3;

/// The remaining crossing of a surface of degree 2.
#[derive(Clone, Copy, Debug)]
struct Again<S: Simd> {
    /// Time of the crossing; +inf for none.
    t: Lanes<S>,
    /// Uncertain lanes: the ray does not leave the surface to the listed side, or it is tangent, or this kernel cannot
    /// compute its return.
    unsure: Mask<S>,
    /// True if the square term is small: the ray may stay close to the surface over a long distance.
    slow: Mask<S>,
}

impl LaneFacet {
    /// [`LaneFacet::narrow`] for rays some of which may start on the surface of the facet.
    #[inline(always)]
    pub fn narrow_from<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        starts: &LaneStarts<S>,
        span: &mut LaneSpan<S>,
        uncertain: &mut Uncertain<S>,
    ) -> Option<Gap<S>> {
        let [low, high] = self.surfaces;
        let is_listed = starts.surface.simd_eq(low) | starts.surface.simd_eq(high);
        if !is_listed.any_true() {
            return self.narrow(simd, ray, span, uncertain);
        }
        if let Kernel::AxisSlab(_) | Kernel::Slab(_) = &self.kernel {
            self.slab(simd, ray, Some(starts), span, uncertain);
            return None;
        }
        self.depart(simd, ray, starts, span, uncertain)
    }

    /// Out-of-line version on copies, so that the data of facets on which no ray starts stays in registers.
    #[inline(always)]
    fn depart<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        starts: &LaneStarts<S>,
        span: &mut LaneSpan<S>,
        uncertain: &mut Uncertain<S>,
    ) -> Option<Gap<S>> {
        let (ray, starts, mut copies) = (*ray, *starts, (*span, *uncertain));
        let gap = simd.vectorize(
            #[inline(always)]
            || self.depart_here(simd, &ray, &starts, &mut copies.0, &mut copies.1),
        );
        (*span, *uncertain) = copies;
        gap
    }

    #[inline(always)]
    fn depart_here<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        starts: &LaneStarts<S>,
        span: &mut LaneSpan<S>,
        uncertain: &mut Uncertain<S>,
    ) -> Option<Gap<S>> {
        let is_listed = starts.surface.simd_eq(self.surfaces[0]);
        let (mut listed_span, mut listed_uncertain) = (*span, *uncertain);
        self.narrow_listed(simd, ray, starts.inside, &mut listed_span, &mut listed_uncertain);
        let [plus, minus] = infinite(simd);
        if is_listed.all_true() {
            (*span, *uncertain) = (listed_span, listed_uncertain);
            return Some(Gap { from: plus, to: minus });
        }
        let gap = self.narrow(simd, ray, span, uncertain);
        span.from = is_listed.select(listed_span.from, span.from);
        span.to = is_listed.select(listed_span.to, span.to);
        span.from_face = is_listed.select(listed_span.from_face, span.from_face);
        span.to_face = is_listed.select(listed_span.to_face, span.to_face);
        uncertain.always = (is_listed & listed_uncertain.always) | (!is_listed & uncertain.always);
        uncertain.grazes = (is_listed & listed_uncertain.grazes) | (!is_listed & uncertain.grazes);
        match gap {
            Some(gap) => {
                Some(Gap { from: is_listed.select(plus, gap.from), to: is_listed.select(minus, gap.to) })
            }
            None => None,
        }
    }

    /// Narrows the span as if all rays started on the surface; a surface with a single root acts like a plane.
    #[inline(always)]
    fn narrow_listed<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        inside: Mask<S>,
        span: &mut LaneSpan<S>,
        uncertain: &mut Uncertain<S>,
    ) {
        let Again { t, unsure, slow } = self.kernel.again(simd, ray, inside);
        let [plus, minus] = infinite(simd);
        let holds = if self.inside { inside } else { !inside };
        let is_met = t.simd_lt(plus);
        uncertain.always |= unsure;
        if self.is_one_piece {
            // at equal times the face declared first is reported, but this facet is tested last, whatever its position
            uncertain.always |= is_met & (t.simd_eq(span.from) | t.simd_eq(span.to));
        }
        let face = splat(simd, self.face);
        let begins = span.begin_after(holds.select(minus, t), face);
        let ends = span.end_before(holds.select(t, plus), face);
        uncertain.grazes |= slow & is_met & (begins | ends);
    }
}

impl Kernel {
    /// Second crossing of rays that start on the surface.
    #[inline(always)]
    fn again<S: Simd>(&self, simd: S, ray: &LaneRay<S>, inside: Mask<S>) -> Again<S> {
        let zero = splat(simd, 0.0);
        let [a, b] = self.departure(simd, ray);
        let first = b * -2.0 / a;
        let comes_back = first.simd_gt(0.0) & first.simd_lt(f64::INFINITY);
        let mut t = comes_back.select(first, splat(simd, f64::INFINITY));
        if comes_back.any_true() {
            let step = self.newton(simd, ray.origin.plus(ray.direction.times(t)), ray.direction);
            let is_small = comes_back & step.abs().simd_le(t * 1e-6);
            t = is_small.select(t - step, t);
        }
        let is_tangent = b.simd_eq(zero) | !(b.abs().simd_lt(f64::INFINITY));
        let disagrees = b.simd_lt(zero) ^ inside;
        Again { t, unsure: is_tangent | disagrees, slow: a.abs().simd_lt(ray.slow_square) }
    }

    /// `[a, b]` of f along rays from the surface, `a t^2 + 2 b t`; zeros for kernels that are left to the scalar code.
    #[inline(always)]
    fn departure<S: Simd>(&self, simd: S, ray: &LaneRay<S>) -> [Lanes<S>; 2] {
        let zero = splat(simd, 0.0);
        match self {
            &Kernel::AxisPlane { axis, sign, .. } => [zero, ray.direction.component(axis.into()) * sign],
            Kernel::Plane(plane) => plane.departure(ray.direction),
            Kernel::Sphere(sphere) => sphere.departure(ray.origin, ray.direction),
            Kernel::Cylinder(cylinder) => cylinder.departure(ray.origin, ray.direction),
            Kernel::AxisCylinder(cylinder) => cylinder.general().departure(ray.origin, ray.direction),
            Kernel::Cone(cone) => cone.departure(ray.origin, ray.direction),
            Kernel::Quadric(quadric) => quadric.quadric().departure(ray.origin, ray.direction),
            _ => [zero, zero],
        }
    }

    /// One Newton step from some points along the rays.
    #[inline(always)]
    fn newton<S: Simd>(&self, simd: S, point: Vec3Lanes<S>, direction: Vec3Lanes<S>) -> Lanes<S> {
        let (value, gradient) = self.value_and_gradient(simd, point);
        value / gradient.dot(direction)
    }

    /// True if [`Kernel::value_and_gradient`] supports the surface: all except tori and slabs.
    pub fn has_value(&self) -> bool {
        !matches!(self, Kernel::AxisSlab(_) | Kernel::Slab(_) | Kernel::Torus(_))
    }

    /// f and its gradient at some points, equal to
    /// [`Surface::value_and_gradient`](crate::surface::Surface::value_and_gradient); zeros if [`Kernel::has_value`] is
    /// false.
    #[inline(always)]
    pub fn value_and_gradient<S: Simd>(&self, simd: S, point: Vec3Lanes<S>) -> (Lanes<S>, Vec3Lanes<S>) {
        match self {
            &Kernel::AxisPlane { axis, sign, offset } => {
                let mut normal = Vec3::ZERO;
                normal[usize::from(axis)] = sign;
                Plane { normal, offset }.value_and_gradient(point)
            }
            Kernel::Plane(plane) => plane.value_and_gradient(point),
            Kernel::Sphere(sphere) => sphere.value_and_gradient(point),
            Kernel::Cylinder(cylinder) => cylinder.value_and_gradient(point),
            Kernel::AxisCylinder(cylinder) => cylinder.general().value_and_gradient(point),
            Kernel::Cone(cone) => cone.value_and_gradient(point),
            Kernel::Quadric(quadric) => quadric.quadric().value_and_gradient(point),
            Kernel::AxisSlab(_) | Kernel::Slab(_) | Kernel::Torus(_) => {
                (splat(simd, 0.0), Vec3Lanes::splat(simd, Vec3::ZERO))
            }
        }
    }
}
