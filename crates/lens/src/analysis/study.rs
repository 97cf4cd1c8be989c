//! Image analysis of a prescription, field by field.

use super::{Arrival, LensAnalysisError, Wavefront, arrivals, reference_radius, sequential_arrival};
use crate::prescription::{IMAGE, Prescription, PrescriptionError, PrescriptionLayout};
use rayweave_model::Evaluator;
use rayweave_optics::{Beam, TraceSettings, Tracer};

/// The distance between the real and the paraxial entrance pupil, in units of the semi-diameter, above which
/// rays have to be aimed.
const FAR_PUPIL: f64 = 0.25;

/// True if the rays of a field have to be aimed at the stop: the real entrance pupil lies more than a quarter
/// of its semi-diameter away from the paraxial one, so that rays through the latter illuminate the wrong part
/// of the stop. A [`Study`] refuses to trace such rays unaimed.
///
/// # Errors
/// As for [`Prescription::beam`].
pub fn needs_aiming(
    lens: &Prescription,
    field: usize,
    wavelength_nm: f64,
) -> Result<bool, PrescriptionError> {
    Ok(far_pupil(lens, field, wavelength_nm)?.is_some())
}

/// The distance of a real entrance pupil for which rays have to be aimed.
fn far_pupil(
    lens: &Prescription,
    field: usize,
    wavelength_nm: f64,
) -> Result<Option<f64>, PrescriptionError> {
    match lens.chief_ray_pupil_point(field, wavelength_nm) {
        Ok([x, y]) => Ok(Some(libm::hypot(x, y)).filter(|&off| off > FAR_PUPIL)),
        // a field without a chief ray can have other rays
        Err(PrescriptionError::Lost { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

/// Image analysis of a prescription on its traced system; fields are counted from 0.
#[derive(Debug)]
pub struct Study<'a, E> {
    pub(super) lens: &'a Prescription,
    layout: &'a PrescriptionLayout,
    tracer: &'a Tracer<'a, E>,
    aims: bool,
}

/// A ray fan: transverse aberrations of rays along a line of the pupil.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fan {
    /// The points of the pupil, in units of its semi-diameter.
    pub pupil: Vec<[f64; 2]>,
    /// The positions on the image, relative to the ray through the centre of the pupil or, if rays
    /// are aimed, of the stop, at the wavelength of the reference.
    pub errors: Vec<[f64; 2]>,
}

impl<'a, E: Evaluator> Study<'a, E> {
    /// A study of a prescription with its layout, and a tracer of the system compiled from that layout.
    pub fn new(
        lens: &'a Prescription,
        layout: &'a PrescriptionLayout,
        tracer: &'a Tracer<'a, E>,
    ) -> Study<'a, E> {
        Study { lens, layout, tracer, aims: false }
    }

    /// Aims rays at the stop: pupil points become points of the stop (see [`Prescription::beam_at_stop`]).
    pub fn aimed(self) -> Study<'a, E> {
        Study { aims: true, ..self }
    }

    /// The rays through points of the pupil or, if they are aimed, of the stop.
    fn beam(&self, field: usize, wavelength_nm: f64, pupil: &[[f64; 2]]) -> Result<Beam, LensAnalysisError> {
        if self.aims {
            return Ok(self.lens.beam_at_stop(field, wavelength_nm, pupil)?);
        }
        if let Some(off) = far_pupil(self.lens, field, wavelength_nm)? {
            return Err(LensAnalysisError::Unaimed { field, off });
        }
        Ok(self.lens.beam(field, wavelength_nm, pupil)?)
    }

    /// Traces rays of a field through points of the pupil and returns those that arrive at the image through
    /// the surfaces in the order of the prescription. The id of a ray is the index of its point. Rays are
    /// lossless and have power 1.
    ///
    /// # Errors
    /// [`LensAnalysisError`] for fields that do not exist and beams that cannot be traced;
    /// [`LensAnalysisError::Unaimed`] for rays that have to be aimed ([`Study::aimed`]) and are not.
    pub fn arrivals(
        &self,
        field: usize,
        wavelength_nm: f64,
        pupil: &[[f64; 2]],
    ) -> Result<Vec<Arrival>, LensAnalysisError> {
        self.traced(&self.beam(field, wavelength_nm, pupil)?)
    }

    fn traced(&self, beam: &Beam) -> Result<Vec<Arrival>, LensAnalysisError> {
        let limit = 4 * self.layout.sequence.len() as u32 + 4;
        let settings =
            TraceSettings { generation_limit: limit, keep_escaped: false, ..TraceSettings::default() };
        let trace = self.tracer.trace(beam, &settings)?;
        arrivals(self.tracer.system(), &trace.segments, IMAGE, Some(&self.layout.sequence))
    }

    /// The rays of a field at all wavelengths of the prescription, with the weights of the wavelengths as
    /// power.
    ///
    /// # Errors
    /// As for [`Study::arrivals`].
    pub fn polychromatic(&self, field: usize, pupil: &[[f64; 2]]) -> Result<Vec<Arrival>, LensAnalysisError> {
        let mut all = Vec::new();
        for line in &self.lens.lines {
            let found = self.arrivals(field, line.wavelength_nm, pupil)?;
            all.extend(
                found.into_iter().map(|arrival| Arrival { power: arrival.power * line.weight, ..arrival }),
            );
        }
        Ok(all)
    }

    /// The chief (principal) ray of a field: the ray through the centre of the stop. It is aimed in every study.
    ///
    /// # Errors
    /// As for [`Prescription::beam_at_stop`], and [`LensAnalysisError::Stopped`] if the ray does not arrive.
    pub fn chief_ray(&self, field: usize, wavelength_nm: f64) -> Result<Arrival, LensAnalysisError> {
        self.beside_chief_ray(field, wavelength_nm, [0.0; 2])
    }

    /// The ray through a point of the entrance pupil `off` from the chief ray.
    pub(super) fn beside_chief_ray(
        &self,
        field: usize,
        wavelength_nm: f64,
        off: [f64; 2],
    ) -> Result<Arrival, LensAnalysisError> {
        let [x, y] = self.lens.chief_ray_pupil_point(field, wavelength_nm)?;
        let beam = self.lens.beam(field, wavelength_nm, &[[x + off[0], y + off[1]]])?;
        let ray = if off == [0.0; 2] { "chief" } else { "neighbour of the chief ray" };
        self.one(&beam, LensAnalysisError::Stopped { ray, field })
    }

    /// The ray through the centre of the pupil or, if rays are aimed, of the stop: the reference of the other
    /// rays of the study.
    fn central(&self, field: usize, wavelength_nm: f64) -> Result<Arrival, LensAnalysisError> {
        let beam = self.beam(field, wavelength_nm, &[[0.0; 2]])?;
        self.one(&beam, LensAnalysisError::Stopped { ray: "chief", field })
    }

    /// The axial ray through a height in the pupil.
    pub(super) fn axial(&self, wavelength_nm: f64, height: f64) -> Result<Arrival, LensAnalysisError> {
        let beam = self.beam(0, wavelength_nm, &[[0.0, height]])?;
        self.one(&beam, LensAnalysisError::Stopped { ray: "axial", field: 0 })
    }

    /// The arrival of the only ray of a beam.
    fn one(&self, beam: &Beam, stopped: LensAnalysisError) -> Result<Arrival, LensAnalysisError> {
        let found = self.traced(beam)?;
        found.first().copied().or_else(|| self.unobstructed(beam)).ok_or(stopped)
    }

    /// The arrival of a ray without obstruction: the secondary mirror of a telescope blocks its principal
    /// ray.
    fn unobstructed(&self, beam: &Beam) -> Option<Arrival> {
        let light = beam.get(0);
        let passes = self.lens.follow(&light.ray, light.wavelength_nm).ok()?;
        Some(sequential_arrival(&self.lens.resolved().ok()?, 0, passes.last()?, light.wavelength_nm))
    }

    /// A ray fan through points of the pupil such as those of [`fan_x`](super::fan_x) and
    /// [`fan_y`](super::fan_y). The errors are those from the ray of the same wavelength through the centre of the
    /// paraxial entrance pupil or, if rays are aimed, of the stop: without lateral colour.
    ///
    /// # Errors
    /// As for [`Study::arrivals`], and [`LensAnalysisError::Stopped`].
    pub fn fan(
        &self,
        field: usize,
        wavelength_nm: f64,
        pupil: &[[f64; 2]],
    ) -> Result<Fan, LensAnalysisError> {
        self.fan_about(field, wavelength_nm, wavelength_nm, pupil)
    }

    /// Like [`Study::fan`], with errors from the central ray at another wavelength: with the primary wavelength as
    /// `reference_nm`, the errors contain lateral colour.
    ///
    /// # Errors
    /// As for [`Study::fan`].
    pub fn fan_about(
        &self,
        field: usize,
        wavelength_nm: f64,
        reference_nm: f64,
        pupil: &[[f64; 2]],
    ) -> Result<Fan, LensAnalysisError> {
        let middle = self.central(field, reference_nm)?.position;
        let found = self.arrivals(field, wavelength_nm, pupil)?;
        let error = |arrival: &Arrival| [arrival.position.x - middle.x, arrival.position.y - middle.y];
        Ok(Fan {
            pupil: found.iter().map(|arrival| pupil[arrival.id]).collect(),
            errors: found.iter().map(error).collect(),
        })
    }

    /// The wavefront of a field. The reference sphere is centred at the point on the image of the ray through
    /// the centre of the pupil or, if rays are aimed, of the stop; its radius is the distance from the
    /// paraxial exit pupil, on the axis, to that point.
    ///
    /// # Errors
    /// As for [`Study::arrivals`], and [`LensAnalysisError::Stopped`].
    pub fn wavefront(
        &self,
        field: usize,
        wavelength_nm: f64,
        pupil: &[[f64; 2]],
    ) -> Result<Wavefront, LensAnalysisError> {
        let principal = self.central(field, wavelength_nm)?;
        let found = self.arrivals(field, wavelength_nm, pupil)?;
        let first_order = self.lens.first_order(wavelength_nm)?;
        let image = self.lens.surfaces.iter().map(|surface| surface.thickness).sum::<f64>();
        let exit = first_order.exit_pupil.position - image;
        let radius = reference_radius(&principal, exit);
        Ok(Wavefront::new(&principal, &found, pupil, radius, self.lens.unit_nm))
    }
}
