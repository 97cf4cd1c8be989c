//! Tessellation of one shape within a chord tolerance, or as an exact convex polytope if its faces are planar.
//!
//! Vertices lie on the surface. With n vertices per turn of a circle of radius r, the chords deviate by r (1 - cos(pi /
//! n)). Faces curved in two directions use half of the tolerance in each: with half angles a and b, the deviation is at
//! most r (1 - cos a cos b). Circles start at +x and n is a multiple of 4, so that concentric equal cylinders and spheres
//! have the same facets and keep their bounding boxes.

mod coaxial;
mod implicit;
mod polytope;
mod quadric;
mod revolved;
mod sag;

pub(super) use coaxial::{Frame, Turned, is_cone};
pub(super) use polytope::planes_of;

use crate::kernel::Body;
use rayweave_math::{Affine, Bounds, Vec3};
use rayweave_shape::primitive::{Cylinder, Lowered, Paraboloid, Primitive, Tube, Value};
use rayweave_shape::surface::Surface;
pub(super) use revolved::circle_count;
use revolved::{Profile, revolved};

/// True if the reason of a failure is a number of vertices that grows with a finer tolerance.
pub(super) fn is_too_fine(why: &str) -> bool {
    why.contains("needs more than") && why.contains("vertices")
}

/// Input for the tessellation of a shape.
pub(super) struct Request<'a> {
    pub shape: &'a Primitive,
    pub place: &'a Affine,
    /// Clip box around the whole model, in the frame of the model.
    pub clip: &'a Bounds,
    pub tolerance: f64,
}

/// The box in which a shape is tessellated: the clip box or, for a quadric, its intersection with the box in which it matters. Quadrics are
/// unbounded, and the size of the box determines the number of their triangles.
pub(super) fn clip_box(shape: &Primitive, clip: &Bounds, within: &Bounds) -> Bounds {
    match shape {
        Primitive::Quadric(_) => clip.intersection(within),
        _ => *clip,
    }
}

impl Request<'_> {
    /// The clip box in the frame of the shape.
    pub fn local_clip(&self) -> Option<Bounds> {
        Some(self.clip.transformed(&self.place.inverse().ok()?))
    }

    /// The tolerance in the frame of the shape.
    pub fn local_tolerance(&self) -> f64 {
        tolerance_within(self.place, self.tolerance)
    }
}

/// A tolerance of the model in the frame that is placed by a map.
pub(super) fn tolerance_within(place: &Affine, tolerance: f64) -> f64 {
    // the Frobenius norm of a similarity is sqrt(3) times its scale factor
    tolerance / place.similarity().unwrap_or(place.linear_norm())
}

/// Value of a numeric parameter of a shape.
pub(super) fn number(shape: &Primitive, name: &str) -> Option<f64> {
    shape.arguments().into_iter().find_map(|(own, value)| match value {
        Value::Number(number) if own == name => Some(number),
        _ => None,
    })
}

/// An infinite cylinder, tube or paraboloid, truncated outside the clip box; `None` for other shapes.
pub(super) fn finite(shape: &Primitive, place: &Affine, clip: &Bounds) -> Option<Primitive> {
    let local = clip.transformed(&place.inverse().ok()?);
    // well outside the clip box, so that no end coincides with one of its faces
    let reach = 3.0 * local.lo.z.abs().max(local.hi.z.abs());
    let number = |name: &str| number(shape, name);
    if number("height").is_none_or(f64::is_finite) {
        return None;
    }
    Some(match shape {
        Primitive::Cylinder(_) => Cylinder::new(number("radius")?, reach).ok()?.into(),
        Primitive::Tube(_) => Tube::new(number("outer_radius")?, number("inner_radius")?, reach).ok()?.into(),
        Primitive::Paraboloid(_) => Paraboloid::new(number("focal_length")?, reach).ok()?.into(),
        Primitive::Sphere(_)
        | Primitive::Ellipsoid(_)
        | Primitive::CentredBox(_)
        | Primitive::BoxFromCorners(_)
        | Primitive::Cone(_)
        | Primitive::HalfSpace(_)
        | Primitive::Slab(_)
        | Primitive::Torus(_)
        | Primitive::Quadric(_)
        | Primitive::Wedge(_)
        | Primitive::Prism(_)
        | Primitive::Convex(_)
        | Primitive::Mesh(_)
        | Primitive::Asphere(_)
        | Primitive::Biconic(_)
        | Primitive::Freeform(_) => return None,
    })
}

/// The tessellated shape; `None` if it does not intersect the clip box.
pub(super) fn body(request: &Request) -> Result<Option<Body>, String> {
    let Some(clip) = request.local_clip() else {
        return Ok(None);
    };
    let made = local(request.shape, &clip, request.local_tolerance())?;
    made.map_or(Ok(None), |body| body.placed(request.place))
}

fn local(shape: &Primitive, clip: &Bounds, tolerance: f64) -> Result<Option<Body>, String> {
    if let Primitive::Mesh(mesh) = shape {
        return Body::from_polyhedron(mesh.solid());
    }
    let lowered = shape.lower();
    if lowered.bounds.intersection(clip).is_empty() {
        return Ok(None);
    }
    if let Some(planes) = planes_of(&lowered) {
        return polytope::body(&planes, lowered.complement, clip);
    }
    let Some(profile) = profile(shape, clip, tolerance)? else {
        return curved(shape, &lowered, clip, tolerance);
    };
    let n = circle_count(profile.reach(), tolerance / if profile.is_bent { 2.0 } else { 1.0 })?;
    revolved(&profile, n, Vec3::ONE)
}

/// Profile of a solid of revolution about the z axis; `None` for other shapes.
fn profile(shape: &Primitive, clip: &Bounds, tolerance: f64) -> Result<Option<Profile>, String> {
    let number = |name: &str| number(shape, name).unwrap_or(0.0);
    let half =
        |height: f64| if height.is_finite() { [-0.5 * height, 0.5 * height] } else { [clip.lo.z, clip.hi.z] };
    Ok(Some(match shape {
        Primitive::Sphere(_) => Profile::arc([0.0, 0.0], number("radius"), [-90.0, 90.0], tolerance)?,
        Primitive::Cylinder(_) => Profile::column(number("radius"), half(number("height"))),
        Primitive::Tube(_) => {
            Profile::ring([number("inner_radius"), number("outer_radius")], half(number("height")))
        }
        Primitive::Cone(_) => {
            Profile::frustum([number("radius1"), number("radius2")], half(number("height")))
        }
        Primitive::Torus(_) => Profile::torus(number("major"), number("minor"), tolerance)?,
        Primitive::Ellipsoid(_)
        | Primitive::CentredBox(_)
        | Primitive::BoxFromCorners(_)
        | Primitive::HalfSpace(_)
        | Primitive::Slab(_)
        | Primitive::Paraboloid(_)
        | Primitive::Quadric(_)
        | Primitive::Wedge(_)
        | Primitive::Prism(_)
        | Primitive::Convex(_)
        | Primitive::Mesh(_)
        | Primitive::Asphere(_)
        | Primitive::Biconic(_)
        | Primitive::Freeform(_) => return Ok(None),
    }))
}

/// Tessellation of shapes with other curved faces.
fn curved(
    shape: &Primitive,
    lowered: &Lowered,
    clip: &Bounds,
    tolerance: f64,
) -> Result<Option<Body>, String> {
    match lowered.facets.first().map(|facet| &facet.surface) {
        Some(Surface::Quadric(quadric)) => {
            let cap = lowered.facets.get(1).and_then(|facet| match &facet.surface {
                Surface::Plane(plane) => Some((plane.normal, plane.offset)),
                _ => None,
            });
            let whole = quadric::body(quadric, clip, tolerance)?;
            match (whole, cap) {
                (Some(whole), Some(plane)) => match polytope::body(&[plane], false, clip)? {
                    Some(below) => whole.intersection(&below),
                    None => Ok(None),
                },
                (whole, _) => Ok(whole),
            }
        }
        Some(Surface::Sphere(sphere)) => {
            let profile = Profile::arc([0.0, 0.0], sphere.radius, [-90.0, 90.0], tolerance)?;
            let n = circle_count(sphere.radius, 0.5 * tolerance)?;
            let body = revolved(&profile, n, Vec3::ONE)?;
            body.map_or(Ok(None), |body| body.placed(&Affine::translate(sphere.centre)))
        }
        Some(surface @ Surface::Object(_)) => sag::body(surface, lowered, clip, tolerance),
        Some(
            surface @ (Surface::Plane(_)
            | Surface::Cylinder(_)
            | Surface::Cone(_)
            | Surface::Torus(_)
            | Surface::AffineTorus(_)),
        ) => implicit::single_face(surface, lowered, clip, tolerance),
        None => Err(format!("the shape `{}` cannot be tessellated", shape.name())),
    }
}
