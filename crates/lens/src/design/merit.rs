//! Merit functions of tolerancing.

use super::modulation::{MtfKind, MtfLines, modulation};
use super::variant::{Variant, WavefrontReference};
use super::{DesignError, DesignParameter};
use crate::analysis::{Arrival, PupilQuadrature, Spot, defocused, focal_moments};
use crate::prescription::Prescription;

/// A figure of merit of a prescription. Lengths are in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Merit {
    /// The RMS radius of the spots about their centroids, over all wavelengths with their weights; the root
    /// mean square over all fields.
    SpotRms,
    /// The RMS of the wavefronts about the centroids of the images, without tilt
    /// ([`Wavefront::rms`](crate::analysis::Wavefront::rms)), at the primary wavelength, in waves; the root mean square
    /// over all fields.
    WavefrontRms,
    /// The same about the chief rays, with tilt
    /// ([`Wavefront::rms_about_chief_ray`](crate::analysis::Wavefront::rms_about_chief_ray)).
    WavefrontRmsAboutChiefRay,
    /// The modulation transfer function at a frequency, for all wavelengths with their weights: the mean of the tangential and
    /// sagittal lines of all fields.
    Mtf {
        /// With or without diffraction.
        kind: MtfKind,
        /// The frequency in cycles per unit of length.
        frequency: f64,
    },
    /// The fraction of the pupil whose rays pass all stated semi-diameters and arrive, the mean over all fields and wavelengths;
    /// exact to about one ray of the pupil.
    Transmitted,
    /// The focal length at the primary wavelength.
    FocalLength,
    /// The distance from the last vertex to the back focal point at the primary wavelength.
    BackFocalDistance,
    /// The distance of the centroid of the first field's spot from its position without errors.
    ImageShift,
}

/// Evaluator of a merit, with its settings and the reference centroid.
pub(super) struct MeritEvaluator {
    merit: Merit,
    refocus: bool,
    vignettes: bool,
    pupil: PupilQuadrature,
    centroid: [f64; 2],
    /// The weight of each field of the prescription.
    weights: Vec<f64>,
}

/// A merit, the image shift of the refocusing, and the number of rays of all fields and wavelengths that did
/// not arrive.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeritValue {
    pub merit: f64,
    pub shift: f64,
    pub lost: usize,
}

impl MeritEvaluator {
    pub fn new(
        lens: &Prescription,
        merit: Merit,
        [refocus, vignettes]: [bool; 2],
        pupil: PupilQuadrature,
        weights: Vec<f64>,
    ) -> Result<MeritEvaluator, DesignError> {
        let mut evaluator = MeritEvaluator { merit, refocus, vignettes, pupil, centroid: [0.0; 2], weights };
        if merit == Merit::ImageShift {
            let (images, _) = evaluator.images(&evaluator.variant(lens, &[])?)?;
            evaluator.centroid =
                images.first().and_then(|rays| Spot::of(rays)).map_or([0.0; 2], |spot| spot.centroid);
        }
        Ok(evaluator)
    }

    /// The merit after changes of parameters; NaN if no light arrives.
    pub fn evaluate(
        &self,
        lens: &Prescription,
        changes: &[(DesignParameter, f64)],
    ) -> Result<MeritValue, DesignError> {
        let variant = self.variant(lens, changes)?;
        let nm = lens.primary_nm();
        let plain = |merit: f64| MeritValue { merit, shift: 0.0, lost: 0 };
        match self.merit {
            Merit::FocalLength => Ok(plain(variant.first_order(nm)?.focal_length)),
            Merit::BackFocalDistance => Ok(plain(variant.first_order(nm)?.back_focal_distance)),
            Merit::SpotRms | Merit::ImageShift => {
                let (images, shift) = self.images(&variant)?;
                Ok(MeritValue { merit: self.of_spots(&images), shift, lost: self.lost(lens, &images) })
            }
            Merit::Mtf { kind, frequency } => {
                let (images, shift) = self.images(&variant)?;
                let lost = self.lost(lens, &images);
                Ok(MeritValue {
                    merit: self.of_modulations(&variant, (kind, frequency), shift)?,
                    shift,
                    lost,
                })
            }
            Merit::Transmitted => {
                let (images, shift) = self.images(&variant)?;
                Ok(MeritValue {
                    merit: self.transmitted(lens, &images),
                    shift,
                    lost: self.lost(lens, &images),
                })
            }
            Merit::WavefrontRms | Merit::WavefrontRmsAboutChiefRay => {
                let (images, shift) = self.images(&variant)?;
                let lost = self.lost(lens, &images);
                Ok(MeritValue { merit: self.of_wavefronts(&variant, shift)?, shift, lost })
            }
        }
    }

    fn variant(
        &self,
        lens: &Prescription,
        changes: &[(DesignParameter, f64)],
    ) -> Result<Variant, DesignError> {
        let vignettes = self.vignettes || self.merit == Merit::Transmitted;
        Ok(Variant { vignettes, ..Variant::new(lens, changes)? })
    }

    /// The number of rays sent that did not arrive.
    fn lost(&self, lens: &Prescription, images: &[Vec<Arrival>]) -> usize {
        self.sent(lens).saturating_sub(images.iter().map(Vec::len).sum())
    }

    /// The number of rays sent, over all fields and wavelengths; 0 for first-order merits.
    pub fn sent(&self, lens: &Prescription) -> usize {
        match self.merit {
            Merit::FocalLength | Merit::BackFocalDistance => 0,
            _ => lens.fields.len() * lens.lines.len() * self.pupil.points.len(),
        }
    }

    /// The rays of all fields on the image, refocused if that is set, and the shift.
    fn images(&self, variant: &Variant) -> Result<(Vec<Vec<Arrival>>, f64), DesignError> {
        let fields = 0..variant.lens.fields.len();
        let images: Result<Vec<_>, _> =
            fields.map(|field| variant.polychromatic(field, &self.pupil)).collect();
        let images = images?;
        if !self.refocus {
            return Ok((images, 0.0));
        }
        // the mean squares of all fields are parabolas, and so is their sum
        let moments = images.iter().zip(&self.weights).map(|(rays, weight)| (focal_moments(rays), weight));
        let sum = moments.fold([0.0; 2], |[a, b], ([c, d], weight)| [a + weight * c, b + weight * d]);
        let shift = if sum[1] > 0.0 { -sum[0] / sum[1] } else { 0.0 };
        Ok((images.iter().map(|rays| defocused(rays, shift)).collect(), shift))
    }

    fn of_spots(&self, images: &[Vec<Arrival>]) -> f64 {
        let spots: Option<Vec<Spot>> = images.iter().map(|rays| Spot::of(rays)).collect();
        let Some(spots) = spots else { return f64::NAN };
        match (self.merit, spots.first()) {
            (Merit::ImageShift, Some(Spot { centroid: [x, y], .. })) => {
                libm::hypot(x - self.centroid[0], y - self.centroid[1])
            }
            _ => self.root_mean_square(spots.iter().map(|spot| spot.rms)),
        }
    }

    fn of_wavefronts(&self, variant: &Variant, shift: f64) -> Result<f64, DesignError> {
        let nm = variant.lens.primary_nm();
        let reference = match self.merit {
            Merit::WavefrontRmsAboutChiefRay => WavefrontReference::ChiefRay,
            _ => WavefrontReference::Centroid,
        };
        let rms = |field: usize| {
            let wavefront = variant.wavefront(field, nm, &self.pupil, shift)?;
            Ok::<f64, DesignError>(wavefront.map_or(f64::NAN, |wavefront| wavefront.rms(reference)))
        };
        let found: Result<Vec<f64>, _> = (0..variant.lens.fields.len()).map(rms).collect();
        Ok(self.root_mean_square(found?.into_iter()))
    }

    /// The mean modulation of both directions and all fields.
    fn of_modulations(
        &self,
        variant: &Variant,
        (kind, frequency): (MtfKind, f64),
        shift: f64,
    ) -> Result<f64, DesignError> {
        let mut sum = 0.0;
        for (field, weight) in self.weights.iter().enumerate() {
            for lines in [MtfLines::Tangential, MtfLines::Sagittal] {
                let found = modulation(variant, (kind, lines), (field, frequency), &self.pupil, shift)?;
                sum += 0.5 * weight * found.unwrap_or(f64::NAN);
            }
        }
        Ok(sum / self.weights.iter().sum::<f64>())
    }

    /// The part of the power of all fields that arrives.
    fn transmitted(&self, lens: &Prescription, images: &[Vec<Arrival>]) -> f64 {
        let power = |rays: &Vec<Arrival>| rays.iter().map(|ray| ray.power).sum::<f64>();
        let arrived: f64 = images.iter().zip(&self.weights).map(|(rays, weight)| weight * power(rays)).sum();
        let sent =
            lens.lines.iter().map(|line| line.weight).sum::<f64>() * self.pupil.weights.iter().sum::<f64>();
        arrived / (sent * self.weights.iter().sum::<f64>())
    }

    /// The root mean square over the fields with their weights.
    fn root_mean_square(&self, values: impl Iterator<Item = f64>) -> f64 {
        let squares = values.zip(&self.weights).map(|(value, weight)| weight * value * value);
        (squares.sum::<f64>() / self.weights.iter().sum::<f64>()).sqrt()
    }
}
