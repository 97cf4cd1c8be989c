//! Surface kernels: implicit surfaces `f(p) = 0`, with the inside where `f < 0`.
//!
//! A surface is given in the frame of the rays (that of one un-instanced group), in a canonical form about its own centre,
//! never expanded about the world origin.
//!
//! # Properties of all kernels
//!
//! - *Pure*: crossings are a function of (surface, origin, direction) only, computed with +, -, *, / and square
//!   roots in a fixed order, without fused operations. Equal input gives equal bits.
//! - *Backward stable*: a computed point r(t) lies within `64 u (|o| + |t| |d| + magnitude)` of the surface, and the
//!   number of crossings is exact if the ray is farther from tangency than that: see [`delta`].
//! - *Scaling*: lengths times a power of two give times multiplied by that power, to the bit.
//! - *Range*: lengths between 1e-70 and 1e70 (fourth powers are formed), directions of any length.

mod affine_torus;
mod along;
pub(crate) mod cone;
pub(crate) mod cylinder;
mod mesh;
pub mod object;
mod plane;
pub(crate) mod quadric;
mod ranges;
pub mod sag;
mod second_degree;
mod share;
pub(crate) mod sphere;
mod tolerance;
mod torus;
pub(crate) mod torus_line;

pub use affine_torus::AffineTorus;
pub use along::quadratic_crossings;
pub(crate) use along::{Approach, DOT_NOISE, SQUARE_NOISE};
pub use cone::Cone;
pub use cylinder::Cylinder;
pub use mesh::MeshForm;
pub use object::{Form, Object};
pub use plane::Plane;
pub use quadric::{DISTANT, Quadric};
pub use sag::Sag;
pub use share::{Shared, WideClass, share};
pub use sphere::Sphere;
pub use tolerance::{
    Chord, Perturbation, coincides_along, coincides_between, crossings_in, delta, delta_of, is_near, lies_in,
    separated_along,
};
pub use torus::Torus;

use crate::Ray;
use crate::real::Vector;
use along::Departure;
use rayweave_math::roots::Crossings;
use rayweave_math::{Affine, Bounds, Mat3, Transform, Vec3};

/// Sides and times of a surface along a ray: at most four sign changes.
pub type SurfaceCrossings = Crossings<4>;

/// A surface in canonical form.
///
/// Kinds with many parameters are boxed, to keep the size of a plane small.
#[derive(Clone, Debug, PartialEq)]
pub enum Surface {
    /// A plane.
    Plane(Plane),
    /// A sphere.
    Sphere(Sphere),
    /// An unbounded circular cylinder.
    Cylinder(Cylinder),
    /// An unbounded circular double cone.
    Cone(Cone),
    /// Any other surface of degree 2.
    Quadric(Box<Quadric>),
    /// A torus.
    Torus(Torus),
    /// An affine image of a torus that is not a torus.
    AffineTorus(Box<AffineTorus>),
    /// A surface with any number of crossings.
    Object(Box<Object>),
}

/// Constructors, unchecked: lengths must be finite, directions not zero, radii > 0.
impl Surface {
    /// The plane `normal . p = offset`, with the inside where `normal . p` is smaller; the normal may have any length.
    pub fn plane(normal: Vec3, offset: f64) -> Surface {
        Surface::Plane(Plane::new(normal, offset))
    }

    /// The sphere with this centre and radius.
    pub fn sphere(centre: Vec3, radius: f64) -> Surface {
        Surface::Sphere(Sphere { centre, radius })
    }

    /// The cylinder about the line through `point` along `axis`.
    pub fn cylinder(point: Vec3, axis: Vec3, radius: f64) -> Surface {
        Surface::Cylinder(Cylinder::new(point, axis, radius))
    }

    /// The double cone with this apex, axis and slope (radius per height).
    pub fn cone(apex: Vec3, axis: Vec3, slope: f64) -> Surface {
        Surface::Cone(Cone::new(apex, axis, slope))
    }

    /// The quadric `q . M q + linear . q + constant = 0` with q = p - centre; M is symmetric and not zero.
    pub fn quadric_about(centre: Vec3, matrix: Mat3, linear: Vec3, constant: f64) -> Surface {
        Surface::Quadric(Box::new(Quadric::about(centre, &matrix, linear, constant)))
    }

    /// The surface `[x y z 1] Q [x y z 1]^T = 0`, with the inside where the left side is negative, about its centre or
    /// vertex.
    ///
    /// Only the symmetric part of Q matters. A Q without quadratic terms gives a plane, a constant or non-finite one
    /// `None`.
    pub fn quadric(matrix: &[[f64; 4]; 4]) -> Option<Surface> {
        quadric::from_matrix(matrix)
    }

    /// The torus with this centre, axis, radius of the centre circle and radius of the tube.
    pub fn torus(centre: Vec3, axis: Vec3, major: f64, minor: f64) -> Surface {
        Surface::Torus(Torus::new(centre, axis, major, minor))
    }
}

impl Surface {
    /// Crossings of the ray: a pure function of (surface, origin, direction). For an [`Object`] only the first four times
    /// ([`Surface::few_crossings`] and [`Surface::all_crossings`] give all).
    pub fn crossings(&self, ray: &Ray) -> SurfaceCrossings {
        if let Surface::Plane(s) = self {
            return s.crossings(ray).widen();
        }
        match ray.rescaled() {
            None => self.crossings_in_range(ray),
            Some((ray, rate)) => self.crossings_in_range(&ray).scaled(rate),
        }
    }

    fn crossings_in_range(&self, ray: &Ray) -> SurfaceCrossings {
        match self {
            Surface::Plane(s) => s.crossings(ray).widen(),
            Surface::Sphere(s) => s.crossings(ray).widen(),
            Surface::Cylinder(s) => s.crossings(ray).widen(),
            Surface::Cone(s) => s.crossings(ray).widen(),
            Surface::Quadric(s) => s.crossings(ray).widen(),
            Surface::Torus(s) => s.crossings(ray),
            Surface::AffineTorus(s) => s.crossings(ray),
            Surface::Object(s) => object::first_four(|emit| s.crossings(ray, &Perturbation::WORLD, emit)).0,
        }
    }

    /// Crossings of the ray, or `None` if there are more than four.
    pub fn few_crossings(&self, ray: &Ray) -> Option<SurfaceCrossings> {
        self.few_crossings_in(ray, &Perturbation::WORLD)
    }

    /// [`Surface::few_crossings`] in a frame other than the world's.
    #[inline]
    pub fn few_crossings_in(&self, ray: &Ray, perturbation: &Perturbation) -> Option<SurfaceCrossings> {
        let Surface::Object(object) = self else { return Some(self.crossings(ray)) };
        let (crossings, is_all) = object::first_four(|emit| object.crossings(ray, perturbation, emit));
        is_all.then_some(crossings)
    }

    /// Passes all crossing times to `emit`, in order; returns true if the ray is inside at -inf.
    pub fn all_crossings(&self, ray: &Ray, emit: impl FnMut(f64)) -> bool {
        self.all_crossings_in(ray, &Perturbation::WORLD, emit)
    }

    /// [`Surface::all_crossings`] in a frame other than the world's.
    pub fn all_crossings_in(
        &self,
        ray: &Ray,
        perturbation: &Perturbation,
        mut emit: impl FnMut(f64),
    ) -> bool {
        if let Surface::Object(object) = self {
            return object.crossings(ray, perturbation, emit);
        }
        let crossings = self.crossings(ray);
        crossings.times().iter().for_each(|&t| emit(t));
        crossings.starts_negative()
    }

    /// Crossings, for t >= 0, of a ray that starts *on* the surface, i.e. that has the surface on its start list.
    ///
    /// One root at 0 is divided out of f(r(t)). The answer starts on the side `inside_after` of the list, and each time
    /// changes the side. If the direction leads to the other side, the ray crosses the surface at its start: the first time
    /// is exactly 0 (and no other one is). For a tangent direction the next derivative determines the side; for a ray in
    /// the surface it is the side of [`rayweave_math::PERTURBATION_DIRECTION`].
    pub fn crossings_from(&self, ray: &Ray, inside_after: bool) -> SurfaceCrossings {
        self.crossings_from_in(ray, inside_after, &Perturbation::WORLD)
    }

    /// [`Surface::crossings_from`] in a frame other than the world's.
    pub fn crossings_from_in(
        &self,
        ray: &Ray,
        inside_after: bool,
        perturbation: &Perturbation,
    ) -> SurfaceCrossings {
        self.first_crossings_from(ray, inside_after, perturbation).0
    }

    /// [`Surface::crossings_from_in`], or `None` if there are more than four crossings.
    pub fn few_crossings_from(
        &self,
        ray: &Ray,
        inside_after: bool,
        perturbation: &Perturbation,
    ) -> Option<SurfaceCrossings> {
        let (crossings, is_all) = self.first_crossings_from(ray, inside_after, perturbation);
        is_all.then_some(crossings)
    }

    /// [`Surface::crossings_from_in`] that passes all times to `emit`.
    pub fn all_crossings_from(
        &self,
        ray: &Ray,
        inside_after: bool,
        perturbation: &Perturbation,
        mut emit: impl FnMut(f64),
    ) {
        match self {
            Surface::Object(object) => object.crossings_from(ray, inside_after, perturbation, emit),
            _ => {
                let crossings = self.crossings_from_in(ray, inside_after, perturbation);
                crossings.times().iter().for_each(|&t| emit(t));
            }
        }
    }

    /// The first four crossings of a ray from the surface, and whether these are all.
    fn first_crossings_from(
        &self,
        ray: &Ray,
        inside_after: bool,
        perturbation: &Perturbation,
    ) -> (SurfaceCrossings, bool) {
        if let Surface::Object(object) = self {
            return object::first_four(|emit| {
                object.crossings_from(ray, inside_after, perturbation, emit);
                inside_after
            });
        }
        (self.departing(ray, inside_after, perturbation), true)
    }

    fn departing(&self, ray: &Ray, inside_after: bool, perturbation: &Perturbation) -> SurfaceCrossings {
        let (ray, rate) = ray.rescaled().unwrap_or((*ray, 1.0));
        let along_w = || perturbation.leads_inside(self.value_and_gradient(ray.origin).1);
        let newton = |t: f64| {
            let (value, gradient) = self.value_and_gradient(ray.at(t));
            value / gradient.dot(ray.direction)
        };
        let mut departure = self.departure(&ray);
        if departure.negative_after.is_none() && self.turns_along_rulings() {
            // in a ruling: from the start over the lengths of surface and ray
            let end = (ray.origin.length() + self.magnitude()) / ray.direction.length();
            let turns =
                tolerance::perturbed_crossings(self, self.magnitude(), &ray, perturbation, (0.0, end));
            let ahead = turns.times().last().copied().filter(|&t| t > 0.0);
            departure.times = Crossings::new(false, ahead.as_slice());
        } else if self.degree() == 2 {
            // along a ruling both f and its rate are rounding errors
            departure = departure.polished(newton);
        }
        departure.crossings(inside_after, along_w).scaled(rate)
    }

    fn departure(&self, ray: &Ray) -> Departure {
        let (origin, direction) = (ray.origin.into(), ray.direction.into());
        match self {
            Surface::Plane(s) => Departure::quadratic(s.departure(direction)),
            Surface::Sphere(s) => Departure::quadratic(s.departure(origin, direction)),
            Surface::Cylinder(s) => Departure::quadratic(s.departure(origin, direction)),
            Surface::Cone(s) => Departure::quadratic(s.departure(origin, direction)),
            Surface::Quadric(s) => Departure::quadratic(s.departure(origin, direction)),
            Surface::Torus(s) => s.departure(ray),
            Surface::AffineTorus(s) => s.departure(ray),
            // `Object::crossings_from` handles objects
            Surface::Object(_) => Departure { negative_after: None, times: Crossings::constant(false) },
        }
    }

    /// `f` and its gradient at a point.
    pub fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        match self {
            Surface::Plane(s) => single(s.value_and_gradient(point.into())),
            Surface::Sphere(s) => single(s.value_and_gradient(point.into())),
            Surface::Cylinder(s) => single(s.value_and_gradient(point.into())),
            Surface::Cone(s) => single(s.value_and_gradient(point.into())),
            Surface::Quadric(s) => single(s.value_and_gradient(point.into())),
            Surface::Torus(s) => s.value_and_gradient(point),
            Surface::AffineTorus(s) => s.value_and_gradient(point),
            Surface::Object(s) => s.value_and_gradient(point),
        }
    }

    /// `f` at a point and the length of its gradient (on a ridge of f, of the gradient on one side).
    fn value_and_slope(&self, point: Vec3) -> (f64, f64) {
        let (value, gradient) = match self {
            Surface::Torus(s) => s.value_and_steepest(point),
            Surface::AffineTorus(s) => s.value_and_steepest(point),
            _ => self.value_and_gradient(point),
        };
        (value, gradient.length())
    }

    /// The test of [`coincides_along`] per face, for surfaces of many faces.
    fn coincident_faces(&self, magnitude: f64, ray: &Ray, a: f64, b: f64) -> Option<bool> {
        match self {
            Surface::Object(s) => s.coincident_faces(magnitude, ray, a, b),
            _ => None,
        }
    }

    /// The degree of `f` along a straight line, which bounds the number of crossings. For an [`Object`] it only sets the
    /// number of points that [`coincides_along`] tests.
    pub fn degree(&self) -> u8 {
        match self {
            Surface::Plane(_) => 1,
            Surface::Sphere(_) | Surface::Cylinder(_) | Surface::Cone(_) | Surface::Quadric(_) => 2,
            Surface::Torus(_) | Surface::AffineTorus(_) => 4,
            Surface::Object(s) => s.form.degree().max(5),
        }
    }

    /// True if a straight line may lie in the surface.
    pub fn is_ruled(&self) -> bool {
        match self {
            Surface::Plane(_) | Surface::Cylinder(_) | Surface::Cone(_) => true,
            Surface::Quadric(s) => s.is_ruled(),
            Surface::Sphere(_) | Surface::Torus(_) | Surface::AffineTorus(_) => false,
            Surface::Object(s) => s.form.is_ruled(),
        }
    }

    /// True if the normal may turn along a straight line in the surface: it does along the rulings of cones, hyperboloids and
    /// hyperbolic paraboloids, but not in planes and along cylinders.
    pub fn turns_along_rulings(&self) -> bool {
        matches!(self, Surface::Cone(_) | Surface::Quadric(_))
    }

    /// The change of the gradient per unit of time along a line with this direction, for surfaces with a linear gradient
    /// that [turns along rulings](Surface::turns_along_rulings); zero for all others.
    fn gradient_rate(&self, direction: Vec3) -> Vec3 {
        match self {
            Surface::Cone(s) => s.gradient_rate(direction),
            Surface::Quadric(s) => s.gradient_rate(direction),
            _ => Vec3::ZERO,
        }
    }

    /// Upper bound of the lengths that describe the surface, including its position relative to the origin.
    pub fn magnitude(&self) -> f64 {
        match self {
            Surface::Plane(s) => s.magnitude(),
            Surface::Sphere(s) => s.magnitude(),
            Surface::Cylinder(s) => s.magnitude(),
            Surface::Cone(s) => s.apex.length(),
            Surface::Quadric(s) => s.magnitude(),
            Surface::Torus(s) => s.magnitude(),
            Surface::AffineTorus(s) => s.magnitude(),
            Surface::Object(s) => s.magnitude(),
        }
    }

    /// The longest length in the equation of the surface about its [anchor](Surface::anchor): over pieces much shorter than
    /// that, the surface may be flat up to rounding. 0 for planes and cones, which have no length of their own.
    pub fn size(&self) -> f64 {
        match self {
            Surface::Plane(_) | Surface::Cone(_) => 0.0,
            Surface::Sphere(s) => s.radius,
            Surface::Cylinder(s) => s.radius,
            Surface::Quadric(s) => s.size(),
            Surface::Torus(s) => s.size(),
            Surface::AffineTorus(s) => s.size(),
            Surface::Object(s) => s.size(),
        }
    }

    /// A reference point of the surface: its centre, apex, vertex or foot of the perpendicular.
    pub fn anchor(&self) -> Vec3 {
        match self {
            Surface::Plane(s) => s.anchor(),
            Surface::Sphere(s) => s.centre,
            Surface::Cylinder(s) => s.point,
            Surface::Cone(s) => s.apex,
            Surface::Quadric(s) => s.centre,
            Surface::Torus(s) => s.centre,
            Surface::AffineTorus(s) => s.centre,
            Surface::Object(s) => s.centre,
        }
    }

    /// Smallest box around the inside, `f < 0`, up to rounding (a few u times its distance from the origin); infinite if
    /// the inside is unbounded, empty if f is nowhere negative.
    pub fn inside_bounds(&self) -> Bounds {
        match self {
            Surface::Plane(s) => s.inside_bounds(),
            Surface::Sphere(s) => Bounds::centred(s.centre, Vec3::splat(s.radius)),
            Surface::Cylinder(s) => s.inside_bounds(),
            Surface::Cone(_) => Bounds::ALL,
            Surface::Quadric(s) => s.inside_bounds(),
            Surface::Torus(s) => s.inside_bounds(),
            Surface::AffineTorus(s) => s.inside_bounds(),
            Surface::Object(s) => s.inside_bounds(),
        }
    }

    /// Canonical form of the image of this surface. The inside maps to the inside, and the identity preserves all bits.
    pub fn transformed(&self, to: &Transform) -> Surface {
        if to.world_from_local == Affine::IDENTITY {
            return self.clone();
        }
        match self {
            Surface::Plane(s) => Surface::Plane(s.transformed(to)),
            Surface::Sphere(s) => s.transformed(to),
            Surface::Cylinder(s) => s.transformed(to),
            Surface::Cone(s) => s.transformed(to),
            Surface::Quadric(s) => Surface::Quadric(Box::new(s.transformed(to))),
            Surface::Torus(s) => s.transformed(to),
            Surface::AffineTorus(s) => s.transformed(to),
            Surface::Object(s) => Surface::Object(Box::new(s.transformed(to))),
        }
    }

    /// True if all parameters of the surface are finite.
    pub fn is_finite(&self) -> bool {
        match self {
            Surface::Plane(s) => s.normal.is_finite() && s.offset.is_finite(),
            Surface::Sphere(s) => s.centre.is_finite() && s.radius.is_finite(),
            Surface::Cylinder(s) => s.point.is_finite() && s.axis.is_finite() && s.radius.is_finite(),
            Surface::Cone(s) => s.apex.is_finite() && s.axis.is_finite() && s.slope.is_finite(),
            Surface::Quadric(s) => s.is_finite(),
            Surface::Torus(s) => s.is_finite(),
            Surface::AffineTorus(s) => s.is_finite(),
            Surface::Object(s) => s.is_finite(),
        }
    }
}

/// The value and the gradient of a generic kernel for a single point.
#[inline(always)]
fn single((value, gradient): (f64, Vector<f64>)) -> (f64, Vec3) {
    (value, gradient.into())
}
