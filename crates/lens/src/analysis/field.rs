//! Field aberrations: distortion and field curvature.

use super::{LensAnalysisError, Study};
use crate::prescription::{Prescription, PrescriptionError, Resolved};
use rayweave_model::Evaluator;

/// The pupil distance between the chief ray and the neighbours that measure field curvature, in units of
/// the semi-diameter.
const NEAR: f64 = 1e-3;

/// The real and the paraxial height of a chief ray, the one through the centre of the stop, on the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distortion {
    /// The distance from the axis of the real chief ray on the image.
    pub real: f64,
    /// The distance from the axis of the paraxial chief ray on the image plane.
    pub paraxial: f64,
}

impl Distortion {
    /// (real - paraxial) / paraxial; NaN on the axis.
    pub fn relative(&self) -> f64 {
        (self.real - self.paraxial) / self.paraxial
    }
}

/// Tangential and sagittal foci: where rays near the chief ray intersect it, as distances along the axis
/// from the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldFoci {
    /// The focus of rays in the plane of the axis and the chief ray.
    pub tangential: f64,
    /// The focus of rays perpendicular to that plane.
    pub sagittal: f64,
}

/// The height of the paraxial chief ray of a field on the image plane.
pub(crate) fn paraxial_height(
    lens: &Prescription,
    resolved: &Resolved,
    field: usize,
    wavelength_nm: f64,
) -> Result<f64, PrescriptionError> {
    let ray = lens.launch(resolved, field)?.ray([0.0; 2]);
    let pupil = lens.first_order_resolved(resolved, lens.primary_nm())?.entrance_pupil.position;
    let slope = libm::hypot(ray.direction.x, ray.direction.y) / ray.direction.z;
    let n = resolved.indices(wavelength_nm)?;
    let matrix = lens.first_order_resolved(resolved, wavelength_nm)?.matrix;
    let [y, nu] = matrix.apply([-slope * pupil, n[0] * slope]);
    let last = lens.surfaces.len();
    Ok(y + lens.surfaces[last - 1].thickness * nu / n[last])
}

impl<E: Evaluator> Study<'_, E> {
    /// The distortion of a field at a wavelength. The chief ray is aimed at the centre of the stop in
    /// every study.
    ///
    /// # Errors
    /// As for [`Study::chief_ray`].
    pub fn distortion(&self, field: usize, wavelength_nm: f64) -> Result<Distortion, LensAnalysisError> {
        let position = self.chief_ray(field, wavelength_nm)?.position;
        let paraxial = paraxial_height(self.lens, &self.lens.resolved()?, field, wavelength_nm)?;
        Ok(Distortion { real: libm::hypot(position.x, position.y), paraxial: paraxial.abs() })
    }

    /// The tangential and sagittal foci of a field (Coddington) at a wavelength, computed from rays a
    /// thousandth of the pupil away from the chief ray.
    ///
    /// # Errors
    /// As for [`Study::chief_ray`].
    pub fn field_foci(&self, field: usize, wavelength_nm: f64) -> Result<FieldFoci, LensAnalysisError> {
        let [x, y] = self.lens.fields.get(field).copied().unwrap_or([0.0, 1.0]);
        let length = libm::hypot(x, y);
        let along = if length > 0.0 { [x / length, y / length] } else { [0.0, 1.0] };
        let across = [along[1], -along[0]];
        Ok(FieldFoci {
            tangential: self.pencil(field, wavelength_nm, along)?,
            sagittal: self.pencil(field, wavelength_nm, across)?,
        })
    }

    /// The z at which two rays on both sides of the chief ray have the same coordinate along a direction.
    fn pencil(&self, field: usize, wavelength_nm: f64, [a, b]: [f64; 2]) -> Result<f64, LensAnalysisError> {
        let ray = |side: f64| self.beside_chief_ray(field, wavelength_nm, [side * a, side * b]);
        let (one, other) = (ray(NEAR)?, ray(-NEAR)?);
        let slope = |d: rayweave_math::Vec3| (a * d.x + b * d.y) / d.z;
        // on a curved image the two rays end at different z
        let place = |p: rayweave_math::Vec3, d| a * p.x + b * p.y - p.z * slope(d);
        let apart = place(one.position, one.direction) - place(other.position, other.direction);
        Ok(-apart / (slope(one.direction) - slope(other.direction)))
    }
}
