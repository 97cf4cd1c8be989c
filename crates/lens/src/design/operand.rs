//! Operands and goals of an optimisation.

use super::modulation::{MtfKind, MtfLines, modulation};
use super::variant::{Variant, WavefrontReference};
use super::{DesignError, DesignParameter};
use crate::analysis::{Arrival, Distortion, PupilQuadrature, Spot, paraxial_height};
use crate::paraxial::Seidel;
use crate::prescription::PrescriptionError;
use rayweave_optics::component::{Asphere, SurfaceForm};

/// A Seidel sum, or a chromatic one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the fields of `Seidel` by name")]
pub enum SeidelTerm {
    Spherical,
    Coma,
    Astigmatism,
    Petzval,
    Distortion,
    AxialColour,
    LateralColour,
}

impl SeidelTerm {
    fn of(self, sum: &Seidel) -> f64 {
        match self {
            SeidelTerm::Spherical => sum.spherical,
            SeidelTerm::Coma => sum.coma,
            SeidelTerm::Astigmatism => sum.astigmatism,
            SeidelTerm::Petzval => sum.petzval,
            SeidelTerm::Distortion => sum.distortion,
            SeidelTerm::AxialColour => sum.axial_colour,
            SeidelTerm::LateralColour => sum.lateral_colour,
        }
    }
}

/// Quantity of a prescription that a goal constrains; lengths are in the unit of the prescription.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operand {
    /// The focal length at the primary wavelength.
    FocalLength,
    /// The distance from the last vertex to the back focal point at the primary wavelength.
    BackFocalDistance,
    /// The distance from the image to the paraxial image along the axis, at the primary wavelength.
    Defocus,
    /// The lateral magnification at the primary wavelength.
    Magnification,
    /// A Seidel sum over all surfaces: third-order aberrations of the last field.
    Seidel(SeidelTerm),
    /// The relative distortion of the chief ray of a field at the primary wavelength, of all orders
    /// ([`Distortion::relative`]); 0 on the axis.
    Distortion {
        /// The field, counted from 0.
        field: usize,
    },
    /// The transverse aberrations of the rays of a field from their centroid, along x and y, times the roots of
    /// the weights of their points of the pupil ([`PupilQuadrature::gaussian`]): the root of the sum of their
    /// squares is the RMS radius of the spot. A target other than 0 is one of this radius.
    Spot {
        /// The field, counted from 0.
        field: usize,
        /// The wavelength in nanometres; `None` for all wavelengths of the prescription with their weights,
        /// about the common centroid, so that lateral colour counts.
        wavelength_nm: Option<f64>,
    },
    /// The optical path differences of the rays of a field about the centroid of the image, without piston and tilt, in
    /// waves, times the roots of the weights: the root of the sum of their squares is the RMS of the wavefront
    /// ([`Wavefront::rms`](crate::analysis::Wavefront::rms)). A target other than 0 is one of this RMS.
    Wavefront {
        /// The field, counted from 0.
        field: usize,
        /// The wavelength in nanometres.
        wavelength_nm: f64,
    },
    /// The same from the reference sphere about the chief ray, with tilt
    /// ([`Wavefront::rms_about_chief_ray`](crate::analysis::Wavefront::rms_about_chief_ray)).
    WavefrontAboutChiefRay {
        /// The field, counted from 0.
        field: usize,
        /// The wavelength in nanometres.
        wavelength_nm: f64,
    },
    /// The modulation transfer function of a field at a frequency, for all wavelengths with their weights.
    Mtf {
        /// With or without diffraction.
        kind: MtfKind,
        /// The field, counted from 0.
        field: usize,
        /// The frequency in cycles per unit of length.
        frequency: f64,
        /// The direction of the lines.
        lines: MtfLines,
    },
    /// The least distance of the rays of a field through the rim of the pupil from the edges of all stated semi-diameters, at the
    /// primary wavelength: negative where rays are vignetted. Needs at least one stated semi-diameter.
    Clearance {
        /// The field, counted from 0.
        field: usize,
    },
    /// The value of a parameter.
    Value(DesignParameter),
    /// The distance from the first vertex to the image along the axis.
    TotalTrack,
    /// The distance along z from a surface to the next one at a height off the axis: the edge thickness of a
    /// lens.
    EdgeThickness {
        /// The surface, counted from 1.
        surface: usize,
        /// The distance from the axis; `None` for the larger clear semi-diameter of the two surfaces, which follows the rays
        /// of the fields while the prescription changes.
        height: Option<f64>,
    },
}

/// The target of an operand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// At a value.
    Equal(f64),
    /// Not below a value.
    AtLeast(f64),
    /// Not above a value.
    AtMost(f64),
    /// Neither below the first value nor above the second one.
    Between(f64, f64),
}

impl Target {
    /// The difference between a number and its target; 0 within a bound.
    fn residual(self, value: f64) -> f64 {
        match self {
            Target::Equal(wanted) => value - wanted,
            Target::AtLeast(least) => (value - least).min(0.0),
            Target::AtMost(most) => (value - most).max(0.0),
            Target::Between(least, most) => (value - least).min(0.0) + (value - most).max(0.0),
        }
    }
}

/// An operand with its target and weight: one term of the merit function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// The operand.
    pub operand: Operand,
    /// Its target.
    pub target: Target,
    /// The factor of the residual; the sum of squares contains the square of their product.
    pub weight: f64,
}

impl Goal {
    /// An operand with a target value and weight 1.
    pub fn equal(operand: Operand, value: f64) -> Goal {
        Goal { operand, target: Target::Equal(value), weight: 1.0 }
    }

    /// An operand with a lower bound and weight 1.
    pub fn at_least(operand: Operand, value: f64) -> Goal {
        Goal { operand, target: Target::AtLeast(value), weight: 1.0 }
    }

    /// An operand with an upper bound and weight 1.
    pub fn at_most(operand: Operand, value: f64) -> Goal {
        Goal { operand, target: Target::AtMost(value), weight: 1.0 }
    }

    /// An operand with a lower and an upper bound, and weight 1.
    pub fn between(operand: Operand, least: f64, most: f64) -> Goal {
        Goal { operand, target: Target::Between(least, most), weight: 1.0 }
    }

    /// The goal with a different weight.
    pub fn weight(self, weight: f64) -> Goal {
        Goal { weight, ..self }
    }

    /// True for operands whose values belong to rays and whose value is the root of the sum of the squares of these.
    fn is_of_rays(&self) -> bool {
        matches!(
            self.operand,
            Operand::Spot { .. } | Operand::Wavefront { .. } | Operand::WavefrontAboutChiefRay { .. }
        )
    }

    /// The field whose rays through the whole pupil determine the value; `None` for other operands.
    pub(super) fn pupil_field(&self) -> Option<usize> {
        match self.operand {
            Operand::Spot { field, .. }
            | Operand::Wavefront { field, .. }
            | Operand::WavefrontAboutChiefRay { field, .. }
            | Operand::Mtf { field, .. } => Some(field),
            _ => None,
        }
    }

    /// True if each value has a residual: rays with target 0, where the sum of squares over rays is the square of the RMS value
    /// and more residuals make the search converge faster. Any other target is one of the RMS value.
    fn has_residual_per_value(&self) -> bool {
        !self.is_of_rays() || self.target == Target::Equal(0.0)
    }

    /// The value of the operand, from those of rays their RMS value.
    pub(super) fn value(&self, values: &[f64]) -> f64 {
        match values {
            [value] if !self.is_of_rays() => *value,
            _ => values.iter().map(|value| value * value).sum::<f64>().sqrt(),
        }
    }

    /// The number of values, for `rays` points of the pupil and `lines` wavelengths of the prescription.
    pub(super) fn value_count(&self, rays: usize, lines: usize) -> usize {
        match self.operand {
            Operand::Spot { wavelength_nm: Some(_), .. } => 2 * rays,
            Operand::Spot { wavelength_nm: None, .. } => 2 * rays * lines,
            Operand::Wavefront { .. } | Operand::WavefrontAboutChiefRay { .. } => rays,
            _ => 1,
        }
    }

    /// The values; `None` if a ray that they need does not arrive.
    pub(super) fn values(
        &self,
        variant: &Variant,
        pupil: &PupilQuadrature,
    ) -> Result<Option<Vec<f64>>, DesignError> {
        let values = match self.operand {
            Operand::Spot { field, wavelength_nm } => spot(variant, field, wavelength_nm, pupil)?,
            Operand::Wavefront { field, wavelength_nm } => {
                wavefront(variant, field, wavelength_nm, pupil, WavefrontReference::Centroid)?
            }
            Operand::WavefrontAboutChiefRay { field, wavelength_nm } => {
                wavefront(variant, field, wavelength_nm, pupil, WavefrontReference::ChiefRay)?
            }
            Operand::Distortion { field } => distortion(variant, field)?.map(|value| vec![value]),
            Operand::Mtf { kind, field, frequency, lines } => {
                modulation(variant, (kind, lines), (field, frequency), pupil, 0.0)?.map(|value| vec![value])
            }
            Operand::Clearance { field } => variant.clearance(field)?.map(|value| vec![value]),
            operand => Some(vec![number(operand, variant)?]),
        };
        Ok(values.filter(|values| values.iter().all(|value| value.is_finite())))
    }

    /// The weighted residuals of the values.
    pub(super) fn residuals(&self, values: &[f64]) -> Vec<f64> {
        let residual = |value: f64| self.weight * self.target.residual(value);
        match self.has_residual_per_value() {
            true => values.iter().copied().map(residual).collect(),
            false => vec![residual(self.value(values))],
        }
    }

    /// The derivatives of the residuals, from those of the values.
    pub(super) fn residual_changes(&self, values: &[f64], changes: &[f64]) -> Vec<f64> {
        if self.has_residual_per_value() {
            return changes.iter().zip(values).map(|(change, &value)| change * self.slope(value)).collect();
        }
        let value = self.value(values);
        let sum: f64 = changes.iter().zip(values).map(|(change, value)| change * value).sum();
        // an RMS value of 0 is at its minimum
        vec![if value > 0.0 { sum / value * self.slope(value) } else { 0.0 }]
    }

    /// The derivative of the residual with respect to the value: 0 within a bound.
    fn slope(&self, value: f64) -> f64 {
        let is_bound = !matches!(self.target, Target::Equal(_));
        if is_bound && self.target.residual(value) == 0.0 { 0.0 } else { self.weight }
    }
}

fn spot(
    variant: &Variant,
    field: usize,
    wavelength_nm: Option<f64>,
    pupil: &PupilQuadrature,
) -> Result<Option<Vec<f64>>, DesignError> {
    let (rays, lines) = match wavelength_nm {
        Some(line) => (variant.arrivals(field, line, pupil)?, 1),
        None => (variant.polychromatic(field, pupil)?, variant.lens.lines.len()),
    };
    let sent = pupil.points.len() * lines;
    let Some(spot) = Spot::of(&rays).filter(|spot| spot.rays == sent) else { return Ok(None) };
    let [x, y] = spot.centroid;
    let off = |ray: &Arrival| {
        let scale = (ray.power / spot.power).sqrt();
        [scale * (ray.position.x - x), scale * (ray.position.y - y)]
    };
    Ok(Some(rays.iter().flat_map(off).collect()))
}

fn wavefront(
    variant: &Variant,
    field: usize,
    wavelength_nm: f64,
    pupil: &PupilQuadrature,
    reference: WavefrontReference,
) -> Result<Option<Vec<f64>>, DesignError> {
    let found = variant.wavefront(field, wavelength_nm, pupil, 0.0)?;
    let whole = found.filter(|wavefront| wavefront.weights.len() == pupil.points.len());
    Ok(whole.map(|wavefront| wavefront.deviations(reference)))
}

/// The relative distortion of a field; `None` if its chief ray does not arrive.
fn distortion(variant: &Variant, field: usize) -> Result<Option<f64>, DesignError> {
    let (lens, nm) = (&variant.lens, variant.lens.primary_nm());
    if lens.fields.get(field) == Some(&[0.0; 2]) {
        return Ok(Some(0.0));
    }
    let centre = match lens.chief_ray_pupil_point(field, nm) {
        Ok(point) => PupilQuadrature::equal(&[point]),
        Err(PrescriptionError::Lost { .. }) => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    let rays = variant.arrivals(field, nm, &centre)?;
    let Some(chief) = rays.first() else { return Ok(None) };
    let real = libm::hypot(chief.position.x, chief.position.y);
    let paraxial = paraxial_height(lens, &variant.resolved, field, nm)?.abs();
    Ok(Some(Distortion { real, paraxial }.relative()))
}

fn number(operand: Operand, variant: &Variant) -> Result<f64, DesignError> {
    let lens = &variant.lens;
    let first_order = || variant.first_order(lens.primary_nm());
    Ok(match operand {
        Operand::FocalLength => first_order()?.focal_length,
        Operand::BackFocalDistance => first_order()?.back_focal_distance,
        Operand::Magnification => first_order()?.magnification,
        Operand::TotalTrack => lens.surfaces.iter().map(|surface| surface.thickness).sum(),
        Operand::Defocus => {
            let image = lens.surfaces.last().map_or(0.0, |surface| surface.thickness);
            first_order()?.image_distance - image
        }
        Operand::Seidel(term) => term.of(&Seidel::sum(&lens.seidel()?)),
        Operand::Value(parameter) => parameter.value(lens)?,
        Operand::EdgeThickness { surface, height } => edge(variant, surface, height)?,
        // these need rays
        Operand::Spot { .. }
        | Operand::Wavefront { .. }
        | Operand::WavefrontAboutChiefRay { .. }
        | Operand::Mtf { .. }
        | Operand::Clearance { .. }
        | Operand::Distortion { .. } => f64::NAN,
    })
}

/// The distance between two surfaces at a height along y; NaN beyond the end of one of them.
fn edge(variant: &Variant, surface: usize, height: Option<f64>) -> Result<f64, DesignError> {
    let lens = &variant.lens;
    let count = lens.surfaces.len();
    let no_such = || PrescriptionError::NoSuch { what: "surface", number: surface, first: 1, last: count };
    let front = surface.checked_sub(1).and_then(|k| lens.surfaces.get(k)).ok_or_else(no_such)?;
    let back = lens.surfaces.get(surface);
    let height = match height {
        Some(height) => height,
        None => {
            let radii = lens.semi_diameters(&variant.resolved)?;
            // the image is no edge of a lens: its own size does not count
            back.map_or(radii[surface - 1], |_| radii[surface - 1].max(radii[surface]))
        }
    };
    let image = SurfaceForm::from(Asphere::conic(lens.image.radius, lens.image.conic));
    let sag = |form: SurfaceForm| form.sag([0.0, height]).unwrap_or(f64::NAN);
    Ok(front.thickness + sag(back.map_or(image, |back| back.form())) - sag(front.form()))
}
