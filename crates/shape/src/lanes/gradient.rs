//! Gradients of surfaces at eight points, equal to those of [`Surface::value_and_gradient`].

use super::vector::{Lanes, Vec3Lanes, splat};
use crate::surface::{AffineTorus, Cone, Cylinder, Plane, Quadric, Sphere, Surface, Torus};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::Vec3;

/// Data for the gradient of a surface.
#[derive(Clone, Debug)]
pub enum LaneGradient {
    /// Constant gradient.
    Plane(Plane),
    /// Parallel to the line from the centre.
    Sphere(Sphere),
    /// Parallel to the perpendicular from the axis.
    Cylinder(Cylinder),
    /// Parallel to the perpendicular from the axis, tilted by the slope.
    Cone(Cone),
    /// Any other surface of degree 2. (Boxed, as the others are smaller and more frequent.)
    Quadric(Box<Quadric>),
    /// Parallel to the line from the centre circle of the tube.
    Torus(Box<Torus>),
    /// Gradient of a torus, transformed to the image.
    AffineTorus(Box<AffineTorus>),
}

impl LaneGradient {
    /// The gradient of a surface; `None` for an object.
    pub fn of(surface: &Surface) -> Option<LaneGradient> {
        Some(match surface {
            Surface::Plane(plane) => LaneGradient::Plane(*plane),
            Surface::Sphere(sphere) => LaneGradient::Sphere(*sphere),
            Surface::Cylinder(cylinder) => LaneGradient::Cylinder(*cylinder),
            Surface::Cone(cone) => LaneGradient::Cone(*cone),
            Surface::Quadric(quadric) => LaneGradient::Quadric(quadric.clone()),
            Surface::Torus(torus) => LaneGradient::Torus(Box::new(*torus)),
            Surface::AffineTorus(torus) => LaneGradient::AffineTorus(torus.clone()),
            Surface::Object(_) => return None,
        })
    }

    /// Gradients at some points.
    #[inline(always)]
    pub fn at<S: Simd>(&self, simd: S, points: Vec3Lanes<S>) -> Vec3Lanes<S> {
        match self {
            LaneGradient::Plane(plane) => Vec3Lanes::splat(simd, plane.normal),
            LaneGradient::Sphere(sphere) => twice(points.minus_all(sphere.centre)),
            LaneGradient::Cylinder(s) => twice(points.minus_all(s.point).perpendicular(s.axis)),
            LaneGradient::Cone(cone) => of_cone(cone, points),
            LaneGradient::Quadric(quadric) => of_quadric(quadric, points),
            LaneGradient::Torus(torus) => of_torus(simd, torus, points),
            LaneGradient::AffineTorus(image) => {
                let map = &image.local_from_world;
                let local = points.minus_all(image.centre).dots([map.row(0), map.row(1), map.row(2)]);
                of_torus(simd, &image.torus, local).dots([map.x_axis, map.y_axis, map.z_axis])
            }
        }
    }
}

#[inline(always)]
fn twice<S: Simd>(v: Vec3Lanes<S>) -> Vec3Lanes<S> {
    Vec3Lanes { x: v.x * 2.0, y: v.y * 2.0, z: v.z * 2.0 }
}

/// The same vector in all lanes, times one number per lane.
#[inline(always)]
fn along<S: Simd>(v: Vec3, factor: Lanes<S>) -> Vec3Lanes<S> {
    Vec3Lanes { x: factor * v.x, y: factor * v.y, z: factor * v.z }
}

#[inline(always)]
fn of_cone<S: Simd>(cone: &Cone, points: Vec3Lanes<S>) -> Vec3Lanes<S> {
    let q = points.minus_all(cone.apex);
    let radius = q.dot_all(cone.axis) * cone.slope;
    twice(q.perpendicular(cone.axis).without(radius * cone.slope, cone.axis))
}

#[inline(always)]
fn of_quadric<S: Simd>(quadric: &Quadric, points: Vec3Lanes<S>) -> Vec3Lanes<S> {
    let [a, b, c] = quadric.axes;
    let x = points.minus_all(quadric.centre).dots(quadric.axes).times_all(quadric.weights);
    let sum = along(a, x.x).plus(along(b, x.y)).plus(along(c, x.z));
    let (twice, linear) = (twice(sum), quadric.linear);
    Vec3Lanes { x: twice.x + linear.x, y: twice.y + linear.y, z: twice.z + linear.z }
}

#[inline(always)]
fn of_torus<S: Simd>(simd: S, torus: &Torus, points: Vec3Lanes<S>) -> Vec3Lanes<S> {
    let q = points.minus_all(torus.centre);
    let z = q.dot_all(torus.axis);
    let across = q.without(z, torus.axis);
    let rho = across.length_squared().sqrt();
    let (ring, zero) = (rho - torus.major, splat(simd, 0.0));
    let off = rho.simd_gt(0.0);
    let outwards = Vec3Lanes {
        x: off.select(across.x / rho, zero),
        y: off.select(across.y / rho, zero),
        z: off.select(across.z / rho, zero),
    };
    twice(outwards.times(ring).plus(along(torus.axis, z)))
}
