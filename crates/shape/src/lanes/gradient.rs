//! Gradients of surfaces at eight points, equal to those of [`Surface::value_and_gradient`].

use super::vector::{Vec3Lanes, splat};
use crate::surface::{AffineTorus, Cone, Cylinder, Plane, Quadric, Sphere, Surface, Torus};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

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
            LaneGradient::Sphere(sphere) => sphere.value_and_gradient(points).1,
            LaneGradient::Cylinder(cylinder) => cylinder.value_and_gradient(points).1,
            LaneGradient::Cone(cone) => cone.value_and_gradient(points).1,
            LaneGradient::Quadric(quadric) => quadric.value_and_gradient(points).1,
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
    outwards.times(ring).plus(Vec3Lanes::along(torus.axis, z)).times_number(2.0)
}
