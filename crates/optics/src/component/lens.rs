//! Lenses: spherical, conic, aspheric, freeform, cylindrical and cemented; windows, ball lenses,
//! rods and axicons.
//!
//! Radii of curvature have the usual sign: positive if the centre lies on the side of +z, where the
//! light goes. An infinite radius is a plane.

use super::aperture::solid;
use super::element::Element;
use super::error::{between, positive};
use super::face::{Asphere, Face, Profile};
use super::form::SurfaceForm;
use super::form_side::form_side;
use super::side::between_sides;
use super::{Aperture, ComponentError};
use rayweave_math::{Vec3, sin_cos_degrees};
use rayweave_model::Solid;
use rayweave_shape::primitive::{Cone, HalfSpace, Sphere};

/// A lens with two spherical surfaces, `thickness` thick on the axis.
///
/// The vertices are at z = -`thickness`/2 (face `front.side`, radius `r1`) and z = `thickness`/2
/// (`back.side`, `r2`); the rim is `edge.side`. Planes are `front.plane` and `back.plane`, the rim
/// of a rectangular aperture `edge.x-` to `edge.y+`.
///
/// # Errors
/// A radius that is 0 or NaN, a thickness that is not positive, an aperture larger than a sphere,
/// surfaces that cross inside the aperture (a sharp edge is allowed).
///
/// ```
/// use rayweave_optics::component::{Aperture, lens};
///
/// let biconvex = lens(50.0, -50.0, 6.0, Aperture::circle(25.0))?;
/// let meniscus = lens(50.0, 80.0, 4.0, Aperture::rectangle(20.0, 10.0))?;
/// let plano_concave = lens(-30.0, f64::INFINITY, 2.0, Aperture::ellipse(20.0, 10.0))?;
///
/// let error = lens(50.0, -50.0, 1.0, Aperture::circle(25.0)).unwrap_err();
/// assert!(error.to_string().contains("cross inside the aperture, 7.05"));
/// # Ok::<(), rayweave_optics::component::ComponentError>(())
/// ```
pub fn lens(r1: f64, r2: f64, thickness: f64, aperture: Aperture) -> Result<Solid, ComponentError> {
    conic_lens(r1, 0.0, r2, 0.0, thickness, aperture)
}

/// A lens with two convex spherical surfaces of radii |`r1`| and |`r2`|; otherwise like [`lens`].
///
/// # Errors
/// As for [`lens`].
pub fn biconvex(r1: f64, r2: f64, thickness: f64, aperture: Aperture) -> Result<Solid, ComponentError> {
    lens(r1.abs(), -r2.abs(), thickness, aperture)
}

/// A lens with two concave spherical surfaces of radii |`r1`| and |`r2`|; otherwise like [`lens`].
///
/// # Errors
/// As for [`lens`].
pub fn biconcave(r1: f64, r2: f64, thickness: f64, aperture: Aperture) -> Result<Solid, ComponentError> {
    lens(-r1.abs(), r2.abs(), thickness, aperture)
}

/// A lens with a plane in front and a convex surface of radius |`r`| behind; otherwise like [`lens`].
///
/// # Errors
/// As for [`lens`].
pub fn plano_convex(r: f64, thickness: f64, aperture: Aperture) -> Result<Solid, ComponentError> {
    lens(f64::INFINITY, -r.abs(), thickness, aperture)
}

/// A lens with a plane in front and a concave surface of radius |`r`| behind; otherwise like [`lens`].
///
/// # Errors
/// As for [`lens`].
pub fn plano_concave(r: f64, thickness: f64, aperture: Aperture) -> Result<Solid, ComponentError> {
    lens(f64::INFINITY, r.abs(), thickness, aperture)
}

/// A plate with plane faces `front.plane` and `back.plane` at z = -+`thickness`/2.
///
/// # Errors
/// A thickness or an aperture that is not positive.
pub fn window(thickness: f64, aperture: Aperture) -> Result<Solid, ComponentError> {
    lens(f64::INFINITY, f64::INFINITY, thickness, aperture)
}

/// A lens whose surfaces are conics of revolution: radii of curvature at the vertices, conic
/// constants (see [`sag`](super::sag)). Otherwise like [`lens`]; faces that are not spherical are
/// quadrics, `front.side` and `back.side`.
///
/// # Errors
/// As for [`lens`], and conic constants that are not finite.
pub fn conic_lens(
    r1: f64,
    k1: f64,
    r2: f64,
    k2: f64,
    thickness: f64,
    aperture: Aperture,
) -> Result<Solid, ComponentError> {
    let profiles =
        [Profile::conic(r1, k1).checked("lens", "r1")?, Profile::conic(r2, k2).checked("lens", "r2")?];
    between_vertices("lens", profiles, positive("lens", "thickness", thickness)?, aperture)
}

/// A lens whose surfaces are aspheres of revolution. Otherwise like [`lens`]; faces with terms are
/// `front.surface` and `back.surface`.
///
/// # Errors
/// As for [`lens`], and constants or coefficients that are not finite. Crossings of the surfaces are
/// searched for in 64 steps.
///
/// ```
/// use rayweave_optics::component::{Aperture, Asphere, aspheric_lens};
///
/// let plane = Asphere::conic(f64::INFINITY, 0.0);
/// let even = [0.0, 3e-6, -2e-9, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let condenser = aspheric_lens(&Asphere { even, ..Asphere::conic(15.5, -1.0) }, &plane, 9.0, Aperture::circle(25.0))?;
/// # Ok::<(), rayweave_optics::component::ComponentError>(())
/// ```
pub fn aspheric_lens(
    front: &Asphere,
    back: &Asphere,
    thickness: f64,
    aperture: Aperture,
) -> Result<Solid, ComponentError> {
    let profiles =
        [Profile::asphere(front).checked("lens", "r1")?, Profile::asphere(back).checked("lens", "r2")?];
    between_vertices("lens", profiles, positive("lens", "thickness", thickness)?, aperture)
}

/// A lens with surfaces of any form. Otherwise like [`lens`]; the faces of toroids are those of a
/// [`toric_lens`](super::toric_lens), all others that are not conics of revolution are
/// `front.surface` and `back.surface`.
///
/// # Errors
/// As for [`lens`], numbers out of range, and toroids without a solid: those whose curve is rotated
/// about an axis nearer than its own centre, or is not a circle. Crossings of the surfaces are
/// searched for at 33 x 33 points.
///
/// ```
/// use rayweave_optics::component::{Aperture, Asphere, Figure, SurfaceForm, freeform_lens};
///
/// let plane = SurfaceForm::from(Asphere::conic(f64::INFINITY, 0.0));
/// let biconic = SurfaceForm::new(Asphere::conic(50.0, 0.0), Figure::Biconic { radius_x: 30.0, conic_x: -1.0 });
/// let lens = freeform_lens(&biconic, &plane, 5.0, Aperture::circle(20.0))?;
/// # Ok::<(), rayweave_optics::component::ComponentError>(())
/// ```
pub fn freeform_lens(
    front: &SurfaceForm,
    back: &SurfaceForm,
    thickness: f64,
    aperture: Aperture,
) -> Result<Solid, ComponentError> {
    if front.is_round() && back.is_round() {
        return aspheric_lens(&front.asphere, &back.asphere, thickness, aperture);
    }
    let (part, centre) = ("lens", [0.0; 2]);
    let half = 0.5 * positive(part, "thickness", thickness)?;
    let front = form_side(part, "front", (front, -half), &aperture, centre)?;
    let back = form_side(part, "back", (back, half), &aperture, centre)?;
    between_sides(part, [&*front, &*back], &aperture, centre)
}

/// A lens that is curved along x only, so that it focuses to a line along y; `width` along x,
/// `height` along y. Otherwise like [`lens`].
///
/// # Errors
/// As for [`lens`].
pub fn cylindrical_lens(
    r1: f64,
    r2: f64,
    thickness: f64,
    width: f64,
    height: f64,
) -> Result<Solid, ComponentError> {
    let part = "cylindrical lens";
    let profiles = [Profile::cylinder(r1).checked(part, "r1")?, Profile::cylinder(r2).checked(part, "r2")?];
    let thickness = positive(part, "thickness", thickness)?;
    between_vertices(part, profiles, thickness, Aperture::Rectangle { width, height })
}

fn between_vertices(
    part: &'static str,
    [front, back]: [Profile; 2],
    thickness: f64,
    aperture: Aperture,
) -> Result<Solid, ComponentError> {
    let front = Face { name: "front", vertex: -0.5 * thickness, profile: front };
    let back = Face { name: "back", vertex: 0.5 * thickness, profile: back };
    Element { part, front, back, aperture, centre: [0.0; 2] }.build()
}

/// Lenses that share their inner surfaces, as cemented doublets and triplets do: one radius more
/// than thicknesses.
///
/// The first vertex is at z = 0, the last at the sum of the thicknesses. Element i has the faces
/// `front`, `back` and `edge`; the `back` of one and the `front` of the next are bitwise the same
/// surface, so that a ray passes from glass to glass in one crossing.
///
/// # Errors
/// As for [`lens`], and lists of inconsistent lengths.
///
/// ```
/// use rayweave_optics::component::{Aperture, cemented};
///
/// let doublet = cemented(&[62.8, -45.7, -128.2], &[4.0, 2.5], Aperture::circle(25.0))?;
/// assert_eq!(doublet.len(), 2);
/// # Ok::<(), rayweave_optics::component::ComponentError>(())
/// ```
pub fn cemented(
    radii: &[f64],
    thicknesses: &[f64],
    aperture: Aperture,
) -> Result<Vec<Solid>, ComponentError> {
    let part = "cemented lens";
    if thicknesses.is_empty() || radii.len() != thicknesses.len() + 1 {
        let (radii, thicknesses) = (radii.len(), thicknesses.len());
        return Err(ComponentError::Counts { part, radii, thicknesses });
    }
    let check = |(i, &radius): (usize, &f64)| Profile::sphere(radius).checked(part, format!("radii[{i}]"));
    let profiles = radii.iter().enumerate().map(check).collect::<Result<Vec<_>, _>>()?;
    let mut vertices = vec![0.0];
    for (i, &thickness) in thicknesses.iter().enumerate() {
        vertices.push(vertices[i] + positive(part, format!("thicknesses[{i}]"), thickness)?);
    }
    let face = |name, i: usize| Face { name, vertex: vertices[i], profile: profiles[i] };
    let element = |i: usize| Element {
        part,
        front: face("front", i),
        back: face("back", i + 1),
        aperture,
        centre: [0.0; 2],
    };
    (0..thicknesses.len()).map(|i| element(i).build().map_err(|error| numbered(error, i))).collect()
}

/// The error with the numbers of the surfaces that cross.
fn numbered(error: ComponentError, element: usize) -> ComponentError {
    match error {
        ComponentError::SurfacesCross { part, height, reach, .. } => {
            let name = |i: usize| format!("radii[{i}]");
            ComponentError::SurfacesCross {
                part,
                first: name(element),
                second: name(element + 1),
                height,
                reach,
            }
        }
        other => other,
    }
}

/// A ball about the origin; its face is `ball.side`.
///
/// # Errors
/// A diameter that is not positive.
pub fn ball_lens(diameter: f64) -> Result<Solid, ComponentError> {
    let diameter = positive("ball lens", "diameter", diameter)?;
    Ok(solid(Sphere::new(0.5 * diameter)?).named("ball"))
}

/// Half a ball: the dome `front.side` faces the light with its vertex at z = -`diameter`/2, the
/// flat face `back.plane` is z = 0.
///
/// # Errors
/// A diameter that is not positive.
pub fn half_ball_lens(diameter: f64) -> Result<Solid, ComponentError> {
    let diameter = positive("half-ball lens", "diameter", diameter)?;
    let dome = solid(Sphere::new(0.5 * diameter)?).named("front");
    Ok(dome & solid(HalfSpace::new(Vec3::Z, 0.0)?).named("back"))
}

/// A round rod along the axis from z = -`length`/2 (`front.plane`) to z = `length`/2
/// (`back.plane`), its side `edge.side`.
///
/// # Errors
/// Sizes that are not positive.
pub fn rod(diameter: f64, length: f64) -> Result<Solid, ComponentError> {
    positive("rod", "length", length)?;
    window(length, Aperture::Circle { diameter })
}

/// A plano-conical lens: the plane `front.plane` at z = -`thickness`/2, the cone `back.side` with
/// its tip on the axis at z = `thickness`/2, the rim `edge.side`.
///
/// `cone_degrees` is the angle between the cone and the plane of the base, more than 0 and less
/// than 90. A collimated beam is deflected towards the axis by `asin(n sin a) - a` at every height
/// (Snell's law).
///
/// # Errors
/// Sizes that are not positive, an angle out of range, a cone that crosses the plane inside the aperture.
pub fn axicon(cone_degrees: f64, thickness: f64, diameter: f64) -> Result<Solid, ComponentError> {
    let part = "axicon";
    let (sin, cos) = sin_cos_degrees(between(part, "cone_degrees", cone_degrees, (0.0, 90.0))?);
    let thickness = positive(part, "thickness", thickness)?;
    let reach = 0.5 * positive(part, "diameter", diameter)?;
    let (slope, half) = (sin / cos, 0.5 * thickness);
    // the radius at which the plane intersects the cone
    let height = thickness / slope;
    if height < reach * (1.0 - 1e-13) {
        let [first, second] = ["front", "back"].map(str::to_owned);
        return Err(ComponentError::SurfacesCross { part, first, second, height, reach });
    }
    let margin = 0.25 * thickness;
    let tall = thickness + 2.0 * margin;
    let cone = solid(Cone::new(tall / slope, 0.0, tall)?).translate([0.0, 0.0, half - 0.5 * tall]);
    let front = solid(HalfSpace::new(-Vec3::Z, half)?).named("front");
    let edge = Aperture::Circle { diameter }.column([0.0; 2], [-half - margin, half + margin])?;
    Ok(Solid::intersection([front, cone.named("back"), edge.named("edge")]))
}
