//! One side of a surface, ready for lanes.

use super::ray::{Doubt, LaneRay};
use super::span::{Gap, Span};
use super::vector::{Lanes, Mask, splat};
use crate::surface::{Cylinder, Plane, Sphere, Surface};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::Vec3;

/// The kernels that exist for lanes.
#[derive(Clone, Copy, Debug)]
pub enum Kernel {
    /// A plane across coordinate axis `axis`: normal `sign` along it.
    AxisPlane {
        /// 0, 1 or 2.
        axis: u8,
        /// 1 or -1.
        sign: f64,
        /// As of [`Plane`].
        offset: f64,
    },
    /// Any other plane.
    Plane(Plane),
    /// A sphere.
    Sphere(Sphere),
    /// A cylinder.
    Cylinder(Cylinder),
}

impl Kernel {
    /// For a surface; `None` if there is none for its kind.
    pub fn of(surface: &Surface) -> Option<Kernel> {
        match surface {
            Surface::Plane(plane) => Some(axis_plane(plane).unwrap_or(Kernel::Plane(*plane))),
            Surface::Sphere(sphere) => Some(Kernel::Sphere(*sphere)),
            Surface::Cylinder(cylinder) => Some(Kernel::Cylinder(*cylinder)),
            Surface::Cone(_) | Surface::Quadric(_) | Surface::Torus(_) | Surface::AffineTorus(_) => None,
        }
    }
}

fn axis_plane(plane: &Plane) -> Option<Kernel> {
    let along = |k: &usize| plane.normal.abs() == Vec3::AXES[*k];
    let axis = (0..3).find(along)?;
    Some(Kernel::AxisPlane { axis: axis as u8, sign: plane.normal[axis], offset: plane.offset })
}

/// A side of a surface that bounds a leaf.
#[derive(Clone, Copy, Debug)]
pub struct Facet {
    /// The surface.
    pub kernel: Kernel,
    /// True if the leaf lies where f < 0.
    pub inside: bool,
    /// The number of the face.
    pub face: f64,
    /// The greatest gap that the facet may cut out of a stretch of its leaf: see [`Facet::can_gap`].
    pub gap: u32,
}

impl Facet {
    /// True if the facet may hold before and after some time, but not at it.
    pub fn can_gap(&self) -> bool {
        match self.kernel {
            Kernel::AxisPlane { .. } | Kernel::Plane(_) => false,
            Kernel::Sphere(_) | Kernel::Cylinder(_) => !self.inside,
        }
    }

    /// Narrows the stretch of a leaf to where this facet holds; or answers with a stretch in which it does not.
    #[inline(always)]
    pub fn narrow<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        span: &mut Span<S>,
        doubt: &mut Doubt<S>,
    ) -> Option<Gap<S>> {
        match &self.kernel {
            &Kernel::AxisPlane { axis, sign, offset } => {
                let height = splat(simd, offset) - ray.origin.component(axis.into()) * sign;
                let speed = ray.direction.component(axis.into()) * sign;
                self.plane(simd, ray, [height, speed], span, doubt);
                None
            }
            Kernel::Plane(plane) => {
                let height = splat(simd, plane.offset) - ray.origin.dot_all(plane.normal);
                let speed = ray.direction.dot_all(plane.normal);
                self.plane(simd, ray, [height, speed], span, doubt);
                None
            }
            Kernel::Sphere(sphere) => {
                let (from, to) = sphere_times(simd, sphere, ray);
                self.stretch(simd, from, to, span)
            }
            Kernel::Cylinder(cylinder) => {
                let (from, to) = cylinder_times(simd, cylinder, ray, doubt);
                self.stretch(simd, from, to, span)
            }
        }
    }

    /// The stretch in which f < 0, taken from the leaf or cut out of it.
    #[inline(always)]
    fn stretch<S: Simd>(&self, simd: S, from: Lanes<S>, to: Lanes<S>, span: &mut Span<S>) -> Option<Gap<S>> {
        if !self.inside {
            return Some(Gap { from, to });
        }
        span.begin_after(from, splat(simd, self.face));
        span.end_before(to, splat(simd, self.face));
        None
    }

    /// A plane: crossed at `height / speed`, so that the facet holds before or after that time.
    #[inline(always)]
    fn plane<S: Simd>(
        &self,
        simd: S,
        ray: &LaneRay<S>,
        [height, speed]: [Lanes<S>; 2],
        span: &mut Span<S>,
        doubt: &mut Doubt<S>,
    ) {
        let t = height / speed + 0.0;
        let [plus, minus] = super::ray::infinite(simd);
        let before = if self.inside { speed.simd_gt(0.0) } else { speed.simd_lt(0.0) };
        let (mut from, mut to) = (before.select(minus, t), before.select(t, plus));
        let finite = t.abs().simd_lt(f64::INFINITY);
        if !finite.all_true() {
            let below = height.simd_gt(0.0);
            let holds = if self.inside { below } else { !below };
            from = finite.select(from, holds.select(minus, plus));
            to = finite.select(to, holds.select(plus, minus));
        }
        let face = splat(simd, self.face);
        let (begins, ends) = (span.begin_after(from, face), span.end_before(to, face));
        let slow = speed.abs().simd_le(ray.slow_plane);
        if slow.any_true() {
            // c - n . r(middle)
            let value = height - ray.middle * speed;
            doubt.always |= slow & value.abs().simd_le(ray.near);
            doubt.grazes |= slow & finite & (begins | ends);
        }
    }
}

/// The stretch in a sphere, as [`Sphere::crossings`]; empty, from +inf to -inf, for a ray that misses it.
#[inline(always)]
fn sphere_times<S: Simd>(simd: S, sphere: &Sphere, ray: &LaneRay<S>) -> (Lanes<S>, Lanes<S>) {
    let closest = ray.origin.taken_from(sphere.centre).dot(ray.direction) / ray.square;
    let offset = ray.origin.plus(ray.direction.times(closest)).minus_all(sphere.centre);
    let inside = splat(simd, sphere.radius * sphere.radius) - offset.length_squared();
    let half = (inside / ray.square).sqrt();
    or_empty(simd, inside.simd_gt(0.0), closest, half)
}

/// The stretch in a cylinder, as [`Cylinder::crossings`].
#[inline(always)]
fn cylinder_times<S: Simd>(
    simd: S,
    cylinder: &Cylinder,
    ray: &LaneRay<S>,
    doubt: &mut Doubt<S>,
) -> (Lanes<S>, Lanes<S>) {
    let (axis, radius) = (cylinder.axis, cylinder.radius);
    let from = ray.origin.minus_all(cylinder.point).perpendicular(axis);
    let along = ray.direction.perpendicular(axis);
    let square = along.length_squared();
    let zero = splat(simd, 0.0);
    let parallel = square.simd_eq(zero);
    let closest = parallel.select(zero, -from.dot(along) / square);
    let offset = from.plus(along.times(closest));
    let inside = splat(simd, radius * radius) - offset.length_squared();
    let enters = inside.simd_gt(0.0);
    let half = (inside / square).sqrt();
    // f(r(middle)) and a quarter of the square of its gradient
    let late = ray.middle - closest;
    let value = square * late * late - inside;
    let slope = value + radius * radius;
    // |f| <= delta (|grad f| + delta): the square of it, with 2 (x^2 + y^2) >= (x + y)^2
    let near = ray.near * ray.near;
    let bound = near * (slope.abs() * 4.0 + near) * 2.0;
    let slow = square.simd_lt(ray.slow_square);
    doubt.always |= (value * value).simd_le(bound);
    if slow.any_true() {
        doubt.grazes |= slow & enters & !parallel;
        // half of the time in the cylinder may be infinite, though its square is none
        doubt.always |= enters & !parallel & !half.simd_lt(f64::INFINITY);
        let [plus, minus] = super::ray::infinite(simd);
        let (a, b) = or_empty(simd, enters, closest, half);
        let holds: Mask<S> = parallel & enters;
        return (holds.select(minus, a), holds.select(plus, b));
    }
    or_empty(simd, enters, closest, half)
}

#[inline(always)]
fn or_empty<S: Simd>(simd: S, enters: Mask<S>, closest: Lanes<S>, half: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    let [plus, minus] = super::ray::infinite(simd);
    (enters.select(closest - half + 0.0, plus), enters.select(closest + half + 0.0, minus))
}
