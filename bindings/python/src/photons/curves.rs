//! Plots of material properties.

use pyo3::prelude::*;
use rayweave::detector::{PropertyCurve, property_curves_svg};

/// Plots properties against wavelength as SVG; a curve is its label with the unit, and pairs of a wavelength in nm and a value.
#[pyfunction]
pub fn photon_property_svg(py: Python<'_>, title: &str, curves: Vec<(String, Vec<[f64; 2]>)>) -> String {
    py.detach(|| {
        let curves: Vec<PropertyCurve<'_>> =
            curves.iter().map(|(name, points)| PropertyCurve { name, points }).collect();
        property_curves_svg(&curves, title)
    })
}
