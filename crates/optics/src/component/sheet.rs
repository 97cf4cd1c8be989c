//! Sheets: trimmed surfaces without thickness (stops, detectors, gratings, thin lenses), crossed
//! without a change of medium.

use super::aperture::solid;
use super::error::consistent;
use super::face::{Face, Profile};
use super::form_side::form_side;
use super::{Aperture, ComponentError, SurfaceForm};
use rayweave_error::Message;
use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;
use rayweave_shape::primitive::HalfSpace;

/// A surface trimmed by a solid: an event takes place where the boundary of `surface` is crossed
/// inside `trim`.
///
/// Stops, baffles, screens, detectors, gratings and thin lenses are sheets. Each has its centre at
/// the origin and its normal along z; [`Sheet::apply`] moves it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// The solid whose boundary is the surface, in world coordinates; its leaf is named `sheet`.
    /// The solid lies on the side of -z, so that light along +z leaves it.
    pub surface: Solid,
    /// The solid that trims the surface, in world coordinates.
    pub trim: Solid,
    /// `world_from_local`: the frame of the sheet, with the origin at its centre, z along its
    /// normal and x, y along the sides of its aperture.
    pub frame: Affine,
}

impl Sheet {
    /// The sheet moved by an affine map.
    ///
    /// # Errors
    /// A map that is singular or not finite.
    pub fn apply(&self, world_from_local: &Affine) -> Result<Sheet, ComponentError> {
        world_from_local.inverse()?;
        Ok(Sheet {
            surface: self.surface.apply(*world_from_local),
            trim: self.trim.apply(*world_from_local),
            frame: self.frame.then(world_from_local),
        })
    }

    /// A piece of the plane z = 0 with the outline of an aperture: a baffle, a screen, a detector.
    ///
    /// # Errors
    /// Sizes that are not positive.
    pub fn plane(aperture: Aperture) -> Result<Sheet, ComponentError> {
        let trim = aperture.column([0.0; 2], [-1.0, 1.0].map(|side| side * thickness(&aperture)))?;
        let surface = solid(HalfSpace::new(Vec3::Z, 0.0)?).named("sheet");
        Ok(Sheet { surface, trim: trim.named("outline"), frame: Affine::IDENTITY })
    }

    /// A piece of the plane z = 0 with an opening about the axis: an aperture stop.
    ///
    /// # Errors
    /// Sizes that are not positive, an opening that is wider or higher than the stop.
    ///
    /// ```
    /// use rayweave_optics::component::{Aperture, Sheet};
    ///
    /// let stop = Sheet::stop(Aperture::rectangle(50.0, 50.0), Aperture::circle(10.0))?;
    /// # Ok::<(), rayweave_optics::component::ComponentError>(())
    /// ```
    pub fn stop(outline: Aperture, opening: Aperture) -> Result<Sheet, ComponentError> {
        check_opening(&outline, &opening)?;
        let margin = thickness(&outline);
        Sheet::plane(outline)?.with_opening(opening, [-2.0 * margin, 2.0 * margin])
    }

    /// A stop on a curved surface with its vertex at the origin: the piece of the surface between an opening about
    /// the axis and an outline. Where it coincides with the face of a lens or mirror, light crosses it before
    /// that face, on either side: no gap is needed.
    ///
    /// # Errors
    /// As for [`Sheet::stop`]; forms with parameters out of range; an outline that is larger than the surface.
    ///
    /// ```
    /// use rayweave_optics::component::{Aperture, Asphere, Sheet};
    ///
    /// let form = Asphere::conic(20.0, 0.0).into();
    /// let stop = Sheet::curved_stop(&form, Aperture::circle(10.0), Aperture::circle(8.0))?;
    /// # Ok::<(), rayweave_optics::component::ComponentError>(())
    /// ```
    pub fn curved_stop(
        form: &SurfaceForm,
        outline: Aperture,
        opening: Aperture,
    ) -> Result<Sheet, ComponentError> {
        check_opening(&outline, &opening)?;
        let side = form_side("stop", "sheet", (form, 0.0), &outline, [0.0; 2])?;
        let ([low, high], margin) = (side.range(), thickness(&outline));
        let ends = [side.floor(low - margin), side.ceiling(high + margin)];
        let trim = outline.column([0.0; 2], ends)?.named("outline");
        let surface = side.before(ends[0])?;
        let sheet = Sheet { surface, trim, frame: Affine::IDENTITY };
        sheet.with_opening(opening, [ends[0] - margin, ends[1] + margin])
    }

    /// The sheet without an opening about the axis; `ends` lie outside the sheet.
    fn with_opening(self, opening: Aperture, ends: [f64; 2]) -> Result<Sheet, ComponentError> {
        let hole = opening.column([0.0; 2], ends)?.named("opening");
        Ok(Sheet { trim: self.trim - hole, ..self })
    }

    /// A round stop with a round opening.
    ///
    /// # Errors
    /// As for [`Sheet::stop`].
    pub fn iris(diameter: f64, opening: f64) -> Result<Sheet, ComponentError> {
        Sheet::stop(Aperture::circle(diameter), Aperture::circle(opening))
    }

    /// A piece of a sphere with its vertex at the origin and its centre at (0, 0, `radius`): a
    /// curved detector.
    ///
    /// # Errors
    /// A radius that is 0 or NaN, sizes that are not positive, an aperture larger than the sphere.
    pub fn spherical(radius: f64, aperture: Aperture) -> Result<Sheet, ComponentError> {
        Sheet::conic(radius, 0.0, aperture)
    }

    /// A piece of a conic of revolution (see [`sag`](super::sag)) with its vertex at the origin.
    ///
    /// # Errors
    /// As for [`Sheet::spherical`], and a conic constant that is not finite.
    pub fn conic(radius: f64, conic: f64, aperture: Aperture) -> Result<Sheet, ComponentError> {
        let profile = Profile::conic(radius, conic).checked("sheet", "radius")?;
        curved(profile, aperture.checked()?, aperture.reach([0.0; 2]))
    }

    /// A piece of a round cylinder along y, `width` wide and `height` high, with its vertex at the
    /// origin and its axis through (0, 0, `radius`).
    ///
    /// # Errors
    /// As for [`Sheet::spherical`].
    pub fn cylindrical(radius: f64, width: f64, height: f64) -> Result<Sheet, ComponentError> {
        let profile = Profile::cylinder(radius).checked("sheet", "radius")?;
        let aperture = Aperture::rectangle(width, height).checked()?;
        curved(profile, aperture, 0.5 * width)
    }
}

/// Rejects an opening that is wider or higher than the outline of its stop.
fn check_opening(outline: &Aperture, opening: &Aperture) -> Result<(), ComponentError> {
    let ([w, h], [a, b]) = (outline.checked()?.size(), opening.checked()?.size());
    consistent(a <= w && b <= h, || {
        let problem = format!("opening of the stop is {a} x {b} and its outline {w} x {h}");
        Message::new(problem, "the stop would have no rim").suggest("Are the two swapped?")
    })
}

/// The piece of a surface inside an aperture that extends by `reach` from the axis, or from the plane x = 0.
fn curved(profile: Profile, aperture: Aperture, reach: f64) -> Result<Sheet, ComponentError> {
    if profile.is_plane() {
        return Sheet::plane(aperture);
    }
    let limit = profile.limit();
    if reach > limit {
        return Err(ComponentError::ApertureTooLarge { part: "sheet", surface: "curved", reach, limit });
    }
    let face = Face { name: "sheet", vertex: 0.0, profile };
    let ([low, high], margin) = (face.range(reach), thickness(&aperture));
    let ends = [face.floor(low, margin), face.ceiling(high, margin)];
    let trim = aperture.column([0.0; 2], ends)?.named("outline");
    Ok(Sheet { surface: face.before(ends[0])?, trim, frame: Affine::IDENTITY })
}

/// The extent of the trim of a sheet on either side: beyond any rounding, but a small box.
fn thickness(aperture: &Aperture) -> f64 {
    let [width, height] = aperture.size();
    0.125 * width.min(height)
}
