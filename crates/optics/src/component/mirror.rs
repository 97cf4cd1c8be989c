//! Mirrors: plane, spherical, conic, aspheric and freeform; substrates with one optical face.
//!
//! The vertex of the face `front` is the origin, wherever the aperture is: an off-axis mirror is an
//! off-axis piece of a mirror about the axis. Its back is the plane `back.plane`, its rim `edge`. A
//! mirror reflects light that travels towards +z, and its substrate lies on the side of +z;
//! [`Blank::turned`] makes mirrors that face the other way. Radii have the usual sign in both
//! cases: the centre of curvature is at (0, 0, radius).

use super::element::Element;
use super::error::{consistent, finite, positive};
use super::face::{Asphere, Face, Profile};
use super::form::SurfaceForm;
use super::form_side::form_side;
use super::side::between_sides;
use super::{Aperture, ComponentError};
use rayweave_error::Message;
use rayweave_math::Vec3;
use rayweave_model::Solid;

/// The substrate of a mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blank {
    /// Its outline.
    pub aperture: Aperture,
    /// The place of the aperture's centre, along x and y.
    pub off_axis: [f64; 2],
    /// The distance from the vertex to the plane back.
    pub thickness: f64,
    /// True if the mirror faces +z and its back is at z = -thickness.
    pub turned: bool,
}

impl Blank {
    /// A blank about the axis.
    pub fn new(aperture: Aperture, thickness: f64) -> Blank {
        Blank { aperture, off_axis: [0.0; 2], thickness, turned: false }
    }

    /// The blank with its aperture moved off the axis.
    pub fn off_axis(self, x: f64, y: f64) -> Blank {
        Blank { off_axis: [x, y], ..self }
    }

    /// The blank that faces the other way: towards +z, with the substrate on the side of -z.
    pub fn turned(self) -> Blank {
        Blank { turned: !self.turned, ..self }
    }

    /// The thickness, if all numbers are valid.
    fn checked(&self, part: &'static str) -> Result<f64, ComponentError> {
        for (axis, value) in ["x", "y"].into_iter().zip(self.off_axis) {
            finite(part, format!("off_axis {axis}"), value)?;
        }
        positive(part, "thickness", self.thickness)
    }

    /// The substrate behind a surface.
    fn cut(&self, part: &'static str, profile: Profile) -> Result<Solid, ComponentError> {
        let thickness = self.checked(part)?;
        let profile = if self.turned { profile.reversed() } else { profile };
        let front = Face { name: "front", vertex: 0.0, profile };
        let back = Face { name: "back", vertex: thickness, profile: Profile::PLANE };
        let (aperture, centre) = (self.aperture, self.off_axis);
        let solid = Element { part, front, back, aperture, centre }.build()?;
        Ok(if self.turned { solid.mirror(Vec3::Z) } else { solid })
    }
}

/// A plane mirror; its face is `front.plane` in the plane z = 0.
///
/// # Errors
/// A thickness or an aperture that is not positive.
pub fn plane_mirror(blank: &Blank) -> Result<Solid, ComponentError> {
    blank.cut("plane mirror", Profile::PLANE)
}

/// A spherical mirror, `front.side`, with its centre at (0, 0, `radius`) and its paraxial focus
/// halfway between vertex and centre.
///
/// Facing the light (see [`Blank`]) it is concave if `radius` < 0 and convex if `radius` > 0;
/// turned, the reverse. An infinite radius is a plane.
///
/// # Errors
/// As for [`lens`](super::lens): the back is the second surface.
///
/// ```
/// use rayweave_optics::component::{Aperture, Blank, spherical_mirror};
///
/// let blank = Blank::new(Aperture::circle(20.0), 3.0).off_axis(0.0, 15.0);
/// let concave = spherical_mirror(-100.0, &blank)?;
/// // spherical_mirror(100, 3) of PyRayT: it faces +z
/// let facing_away = spherical_mirror(100.0, &blank.turned())?;
/// # Ok::<(), rayweave_optics::component::ComponentError>(())
/// ```
pub fn spherical_mirror(radius: f64, blank: &Blank) -> Result<Solid, ComponentError> {
    conic_mirror(radius, 0.0, blank)
}

/// A mirror whose face is a conic of revolution (see [`sag`](super::sag)) with its vertex at the
/// origin and the centre of its curvature there at (0, 0, `radius`); otherwise a
/// [`spherical_mirror`].
///
/// # Errors
/// As for [`spherical_mirror`], and a conic constant that is not finite.
pub fn conic_mirror(radius: f64, conic: f64, blank: &Blank) -> Result<Solid, ComponentError> {
    let profile = Profile::conic(radius, conic).checked("mirror", "radius")?;
    blank.cut("mirror", profile)
}

/// A mirror whose face is an asphere of revolution; otherwise like [`conic_mirror`]. A face with terms
/// is `front.surface`.
///
/// # Errors
/// As for [`conic_mirror`], and coefficients that are not finite.
pub fn aspheric_mirror(face: &Asphere, blank: &Blank) -> Result<Solid, ComponentError> {
    let profile = Profile::asphere(face).checked("mirror", "radius")?;
    blank.cut("mirror", profile)
}

/// A mirror with a face of any form; otherwise like [`aspheric_mirror`].
///
/// # Errors
/// As for [`freeform_lens`](super::freeform_lens).
pub fn freeform_mirror(face: &SurfaceForm, blank: &Blank) -> Result<Solid, ComponentError> {
    if face.is_round() {
        return aspheric_mirror(&face.asphere, blank);
    }
    let part = "mirror";
    let thickness = blank.checked(part)?;
    let face = if blank.turned { face.reversed() } else { face.clone() };
    let plane = SurfaceForm::from(Asphere::conic(f64::INFINITY, 0.0));
    let (aperture, centre) = (&blank.aperture, blank.off_axis);
    let front = form_side(part, "front", (&face, 0.0), aperture, centre)?;
    let back = form_side(part, "back", (&plane, thickness), aperture, centre)?;
    let solid = between_sides(part, [&*front, &*back], aperture, centre)?;
    Ok(if blank.turned { solid.mirror(Vec3::Z) } else { solid })
}

/// A concave paraboloid: it focuses collimated light along the axis exactly, at any distance from the axis.
///
/// Facing the light, its focus is (0, 0, -`focal_length`) and the face
/// `z = -(x^2 + y^2) / (4 focal_length)`; turned its focus is (0, 0, `focal_length`). (PyRayT moves
/// the focus to the origin: translate a turned one by -`focal_length`.)
///
/// # Errors
/// As for [`spherical_mirror`], and a focal length that is not positive.
pub fn parabolic_mirror(focal_length: f64, blank: &Blank) -> Result<Solid, ComponentError> {
    let radius = 2.0 * positive("parabolic mirror", "focal_length", focal_length)?;
    blank.cut("parabolic mirror", Profile::conic(concave(radius, blank), -1.0))
}

/// A concave ellipsoid of revolution: it images one focus exactly onto the other.
///
/// Both foci lie on the axis in front of the mirror, `near` and `far` from its vertex: facing the
/// light at (0, 0, -`near`) and (0, 0, -`far`). With half axes a = (near + far)/2 and e = |far -
/// near| / (near + far) the radius at the vertex is a (1 - e^2) = 2 near far / (near + far) and the
/// conic constant -e^2.
///
/// # Errors
/// As for [`spherical_mirror`], and distances that are not positive.
pub fn elliptic_mirror(near: f64, far: f64, blank: &Blank) -> Result<Solid, ComponentError> {
    let part = "elliptic mirror";
    let (near, far) = (positive(part, "near", near)?, positive(part, "far", far)?);
    let eccentricity = (far - near) / (far + near);
    let radius = concave(2.0 * near * far / (near + far), blank);
    blank.cut(part, Profile::conic(radius, -eccentricity * eccentricity))
}

/// A convex hyperboloid of revolution, the secondary mirror of a Cassegrain telescope: it images
/// the focus behind it exactly onto the focus in front of it.
///
/// The foci lie on the axis, `behind` and `in_front` from the vertex: facing the light at (0, 0,
/// `behind`) and (0, 0, -`in_front`). The radius at the vertex is 2 behind in_front / (in_front -
/// behind), the eccentricity (in_front + behind) / (in_front - behind).
///
/// # Errors
/// As for [`spherical_mirror`], and distances that are not positive, or `behind` not less than `in_front`.
pub fn hyperbolic_mirror(behind: f64, in_front: f64, blank: &Blank) -> Result<Solid, ComponentError> {
    let part = "hyperbolic mirror";
    let (behind, in_front) = (positive(part, "behind", behind)?, positive(part, "in_front", in_front)?);
    let difference = in_front - behind;
    consistent(difference > 0.0, || {
        let problem = format!("foci of the {part} are {behind} behind and {in_front} in front of the vertex");
        Message::new(problem, "a convex mirror has the nearer focus behind").suggest("Are the two swapped?")
    })?;
    let eccentricity = (in_front + behind) / difference;
    let radius = -concave(2.0 * behind * in_front / difference, blank);
    blank.cut(part, Profile::conic(radius, -eccentricity * eccentricity))
}

/// The sign of the radius of a concave mirror.
fn concave(radius: f64, blank: &Blank) -> f64 {
    if blank.turned { radius } else { -radius }
}
