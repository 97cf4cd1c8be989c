//! Outlines of components and beams.

use pyo3::prelude::*;
use rayweave::optics::component::Aperture;

use crate::error::bad_value;

/// The outline of a component: a kind and its sizes.
#[derive(FromPyObject)]
pub struct Outline(String, f64, f64);

impl Outline {
    /// The aperture.
    pub fn aperture(&self) -> PyResult<Aperture> {
        match self.0.as_str() {
            "circle" => Ok(Aperture::circle(self.1)),
            "rectangle" => Ok(Aperture::rectangle(self.1, self.2)),
            "ellipse" => Ok(Aperture::ellipse(self.1, self.2)),
            other => Err(bad_value(format!(
                "the outline is {other:?}: it can be \"circle\", \"rectangle\" or \"ellipse\"."
            ))),
        }
    }
}
