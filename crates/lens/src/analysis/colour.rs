//! Chromatic aberrations: axial and lateral colour.

use super::{LensAnalysisError, Study};
use rayweave_model::Evaluator;

impl<E: Evaluator> Study<'_, E> {
    /// The distance along the axis from the image to the point where an axial ray crosses the axis; `height`
    /// is its height in the pupil, in units of the pupil's semi-diameter. As a function of height it is the
    /// longitudinal spherical aberration, as a function of wavelength the axial colour. The first field has
    /// to be the axis.
    ///
    /// # Errors
    /// As for [`Study::arrivals`], and [`LensAnalysisError::Stopped`].
    pub fn axial_focus(&self, wavelength_nm: f64, height: f64) -> Result<f64, LensAnalysisError> {
        let arrival = self.axial(wavelength_nm, height)?;
        Ok(arrival.position.z - arrival.position.y * arrival.direction.z / arrival.direction.y)
    }

    /// Lateral colour: the height of the chief ray on the image at a wavelength minus that at the primary
    /// wavelength.
    ///
    /// # Errors
    /// As for [`Study::chief_ray`].
    pub fn lateral_colour(&self, field: usize, wavelength_nm: f64) -> Result<f64, LensAnalysisError> {
        let height = |wavelength_nm: f64| {
            let position = self.chief_ray(field, wavelength_nm)?.position;
            Ok::<f64, LensAnalysisError>(libm::hypot(position.x, position.y))
        };
        Ok(height(wavelength_nm)? - height(self.lens.primary_nm())?)
    }
}
