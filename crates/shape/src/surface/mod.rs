//! The kernels: surfaces `f(p) = 0`, inside where `f < 0`.
//!
//! A surface is given in the frame in which rays are asked (the frame of one un-instanced group), in a
//! canonical form about its own centre, never expanded about the world origin.

mod plane;
mod sphere;
mod tolerance;

pub use plane::Plane;
pub use sphere::Sphere;
pub use tolerance::{Chord, LIE_DIRECTION, delta, hugs, lies_in, side_along_gradient};

use crate::Ray;
use rayweave_math::roots::Crossings;
use rayweave_math::{Transform, Vec3};

/// The sides and times that a surface gives along a ray: at most four sign changes.
pub type SurfaceCrossings = Crossings<4>;

/// One surface, in canonical form.
#[derive(Clone, Debug, PartialEq)]
pub enum Surface {
    /// A plane.
    Plane(Plane),
    /// A sphere.
    Sphere(Sphere),
}

impl Surface {
    /// Where the ray crosses the surface: a pure function of (surface, origin, direction).
    pub fn crossings(&self, ray: &Ray) -> SurfaceCrossings {
        match self {
            Surface::Plane(s) => s.crossings(ray).widen(),
            Surface::Sphere(s) => s.crossings(ray).widen(),
        }
    }

    /// `f` and its gradient at a point.
    pub fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        match self {
            Surface::Plane(s) => s.value_and_gradient(point),
            Surface::Sphere(s) => s.value_and_gradient(point),
        }
    }

    /// The degree of `f` along a straight line.
    pub fn degree(&self) -> u8 {
        match self {
            Surface::Plane(_) => 1,
            Surface::Sphere(_) => 2,
        }
    }

    /// True if a straight line can lie in the surface.
    pub fn is_ruled(&self) -> bool {
        match self {
            Surface::Plane(_) => true,
            Surface::Sphere(_) => false,
        }
    }

    /// The size and position of the surface: how far from the origin the numbers that describe it reach.
    pub fn reach(&self) -> f64 {
        match self {
            Surface::Plane(s) => s.reach(),
            Surface::Sphere(s) => s.reach(),
        }
    }

    /// A point that says where the surface is: its centre, apex, vertex or foot of the perpendicular.
    pub fn anchor(&self) -> Vec3 {
        match self {
            Surface::Plane(s) => s.anchor(),
            Surface::Sphere(s) => s.centre,
        }
    }

    /// The canonical form of the image of this surface; inside stays inside.
    pub fn transformed(&self, to: &Transform) -> Surface {
        match self {
            Surface::Plane(s) => Surface::Plane(s.transformed(to)),
            Surface::Sphere(s) => Surface::Sphere(s.transformed(to)),
        }
    }
}
