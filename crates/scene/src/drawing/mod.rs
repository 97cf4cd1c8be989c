//! Outlines from drawings: closed curves of DXF and SVG files, with arcs as arcs.

mod curve;
mod dxf;
mod svg;

use curve::Contours;

/// The closed curves of a drawing whose file name is given; `layer` selects a layer of a DXF file.
///
/// # Errors
///
/// The reason, as a clause.
pub(crate) fn read(name: &str, text: &str, layer: Option<&str>) -> Result<Contours, String> {
    let ending = name.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
    let contours = match (ending.as_deref(), layer) {
        (Some("dxf"), layer) => dxf::read(text, layer),
        (Some("svg"), Some(_)) => Err("layers are selected in DXF files only".to_owned()),
        (Some("svg"), None) => svg::read(text),
        _ => Err("outlines are read from .dxf and .svg files".to_owned()),
    }?;
    match contours.is_empty() {
        true => Err("it has no closed curves".to_owned()),
        false => Ok(contours),
    }
}
