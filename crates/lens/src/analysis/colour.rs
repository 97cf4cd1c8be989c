//! How the image depends on the wavelength.

use super::{AnalysisError, Study};
use rayweave_model::Evaluator;

impl<E: Evaluator> Study<'_, E> {
    /// Where the ray of the axis through a height in the pupil, in units of its semi-diameter, crosses the axis: the distance
    /// along it from the image. Longitudinal spherical aberration by height, axial colour by wavelength. The first field has to
    /// be the axis.
    ///
    /// # Errors
    /// As of [`Study::principal`].
    pub fn axial_focus(&self, wavelength_nm: f64, height: f64) -> Result<f64, AnalysisError> {
        let arrival = self.one(0, wavelength_nm, [0.0, height], "axial")?;
        Ok(arrival.position.z - arrival.position.y * arrival.direction.z / arrival.direction.y)
    }

    /// How far from that of the primary wavelength the principal ray of a field meets the image, away from the axis: lateral
    /// colour.
    ///
    /// # Errors
    /// As of [`Study::principal`].
    pub fn lateral_colour(&self, field: usize, wavelength_nm: f64) -> Result<f64, AnalysisError> {
        let height = |wavelength_nm: f64| {
            let position = self.principal(field, wavelength_nm)?.position;
            Ok::<f64, AnalysisError>(libm::hypot(position.x, position.y))
        };
        Ok(height(wavelength_nm)? - height(self.lens.primary_nm())?)
    }
}
