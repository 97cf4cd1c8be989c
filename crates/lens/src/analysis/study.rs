//! Image analysis of a prescription, field by field.

use super::{AnalysisError, Arrival, Wavefront, arrivals, followed, reference_radius};
use crate::prescription::{IMAGE, Layout, Prescription, PrescriptionError};
use rayweave_model::Evaluator;
use rayweave_optics::{Beam, Settings, Tracer};

/// Image analysis of a prescription on its traced system; fields are counted from 0.
#[derive(Debug)]
pub struct Study<'a, E> {
    pub(super) lens: &'a Prescription,
    layout: &'a Layout,
    tracer: &'a Tracer<'a, E>,
    aims: bool,
}

/// A ray fan: transverse aberrations of rays along a line of the pupil.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fan {
    /// The points of the pupil, in units of its semi-diameter.
    pub pupil: Vec<[f64; 2]>,
    /// The positions on the image, relative to the principal ray.
    pub errors: Vec<[f64; 2]>,
}

impl<'a, E: Evaluator> Study<'a, E> {
    /// A study of a prescription with its layout, and a tracer of the system compiled from that layout.
    pub fn new(lens: &'a Prescription, layout: &'a Layout, tracer: &'a Tracer<'a, E>) -> Study<'a, E> {
        Study { lens, layout, tracer, aims: false }
    }

    /// Aims rays at the stop: pupil points become points of the stop (see [`Prescription::beam_at_stop`]).
    pub fn aimed(self) -> Study<'a, E> {
        Study { aims: true, ..self }
    }

    fn beam(&self, field: usize, wavelength_nm: f64, pupil: &[[f64; 2]]) -> Result<Beam, PrescriptionError> {
        match self.aims {
            true => self.lens.beam_at_stop(field, wavelength_nm, pupil),
            false => self.lens.beam(field, wavelength_nm, pupil),
        }
    }

    /// Traces rays of a field through points of the pupil and returns those that arrive at the image through
    /// the surfaces in the order of the prescription. The id of a ray is the index of its point. Rays are
    /// lossless and have power 1.
    ///
    /// # Errors
    /// [`AnalysisError`] for fields that do not exist and beams that cannot be traced.
    pub fn arrivals(
        &self,
        field: usize,
        wavelength_nm: f64,
        pupil: &[[f64; 2]],
    ) -> Result<Vec<Arrival>, AnalysisError> {
        let beam = self.beam(field, wavelength_nm, pupil)?;
        let limit = 4 * self.layout.sequence.len() as u32 + 4;
        let settings = Settings { generation_limit: limit, keep_escaped: false, ..Settings::default() };
        let trace = self.tracer.trace(&beam, &settings)?;
        arrivals(self.tracer.system(), &trace.segments, IMAGE, Some(&self.layout.sequence))
    }

    /// The rays of a field at all wavelengths of the prescription, with the weights of the wavelengths as
    /// power.
    ///
    /// # Errors
    /// As of [`Study::arrivals`].
    pub fn polychromatic(&self, field: usize, pupil: &[[f64; 2]]) -> Result<Vec<Arrival>, AnalysisError> {
        let mut all = Vec::new();
        for line in &self.lens.lines {
            let found = self.arrivals(field, line.wavelength_nm, pupil)?;
            all.extend(
                found.into_iter().map(|arrival| Arrival { power: arrival.power * line.weight, ..arrival }),
            );
        }
        Ok(all)
    }

    /// The principal (chief) ray: the ray of a field through the centre of the entrance pupil.
    ///
    /// # Errors
    /// As of [`Study::arrivals`], and [`AnalysisError::Stopped`].
    pub fn principal(&self, field: usize, wavelength_nm: f64) -> Result<Arrival, AnalysisError> {
        self.one(field, wavelength_nm, [0.0; 2], "principal")
    }

    pub(super) fn one(
        &self,
        field: usize,
        wavelength_nm: f64,
        point: [f64; 2],
        ray: &'static str,
    ) -> Result<Arrival, AnalysisError> {
        let found = self.arrivals(field, wavelength_nm, &[point])?;
        found
            .first()
            .copied()
            .or_else(|| self.unobstructed(field, wavelength_nm, point))
            .ok_or(AnalysisError::Stopped { ray, field })
    }

    /// The arrival of a ray without obstruction: the secondary mirror of a telescope blocks its principal
    /// ray.
    fn unobstructed(&self, field: usize, wavelength_nm: f64, point: [f64; 2]) -> Option<Arrival> {
        let beam = self.beam(field, wavelength_nm, &[point]).ok()?;
        let passes = self.lens.follow(&beam.get(0).ray, wavelength_nm).ok()?;
        Some(followed(&self.lens.resolved().ok()?, 0, passes.last()?, wavelength_nm))
    }

    /// A ray fan through points of the pupil such as those of [`fan_x`](super::fan_x) and
    /// [`fan_y`](super::fan_y).
    ///
    /// # Errors
    /// As of [`Study::principal`].
    pub fn fan(&self, field: usize, wavelength_nm: f64, pupil: &[[f64; 2]]) -> Result<Fan, AnalysisError> {
        let middle = self.principal(field, wavelength_nm)?.position;
        let found = self.arrivals(field, wavelength_nm, pupil)?;
        let error = |arrival: &Arrival| [arrival.position.x - middle.x, arrival.position.y - middle.y];
        Ok(Fan {
            pupil: found.iter().map(|arrival| pupil[arrival.id]).collect(),
            errors: found.iter().map(error).collect(),
        })
    }

    /// The wavefront of a field. The radius of the reference sphere is the distance from the paraxial exit
    /// pupil, on the axis, to the point of the principal ray on the image.
    ///
    /// # Errors
    /// As of [`Study::principal`].
    pub fn wavefront(
        &self,
        field: usize,
        wavelength_nm: f64,
        pupil: &[[f64; 2]],
    ) -> Result<Wavefront, AnalysisError> {
        let principal = self.principal(field, wavelength_nm)?;
        let found = self.arrivals(field, wavelength_nm, pupil)?;
        let first_order = self.lens.first_order(wavelength_nm)?;
        let image = self.lens.surfaces.iter().map(|surface| surface.thickness).sum::<f64>();
        let exit = first_order.exit_pupil.position - image;
        let radius = reference_radius(&principal, exit);
        Ok(Wavefront::new(&principal, &found, pupil, radius, self.lens.unit_nm))
    }
}
