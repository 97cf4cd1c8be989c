//! Numbers of prescriptions that belong to no single surface.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayweave::Affine;
use rayweave::lens::prescription::{
    CoordinateBreak, FieldKind, ImageSurface, Prescription, SystemAperture, WeightedWavelength,
};

use crate::error::bad_value;

/// The numbers that belong to no single surface.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Frame {
    name: String,
    notes: Vec<String>,
    unit_nm: f64,
    aperture: (String, f64),
    field_kind: String,
    fields: Vec<[f64; 2]>,
    lines: Vec<(f64, f64)>,
    primary: usize,
    object_distance: f64,
    stop: usize,
    image: (f64, f64, Option<f64>),
    /// Surfaces with the maps of the coordinate breaks in front of them, row by row.
    breaks: Vec<(usize, [[f64; 4]; 4])>,
}

/// A prescription with the numbers of a frame.
pub fn framed(lens: Prescription, frame: Frame) -> PyResult<Prescription> {
    let (radius, conic, semi_diameter) = frame.image;
    let line = |(wavelength_nm, weight)| WeightedWavelength { wavelength_nm, weight };
    Ok(Prescription {
        name: frame.name,
        notes: frame.notes,
        unit_nm: frame.unit_nm,
        aperture: aperture(&frame.aperture)?,
        field_kind: field_kind(&frame.field_kind)?,
        fields: frame.fields,
        lines: frame.lines.into_iter().map(line).collect(),
        primary: frame.primary,
        object_distance: frame.object_distance,
        stop: frame.stop,
        image: ImageSurface { radius, conic, semi_diameter },
        breaks: frame.breaks.into_iter().map(read_break).collect::<PyResult<_>>()?,
        ..lens
    })
}

fn read_break((before, rows): (usize, [[f64; 4]; 4])) -> PyResult<CoordinateBreak> {
    let last = || {
        bad_value(format!("the last row of a coordinate break is {:?}: it must be [0, 0, 0, 1].", rows[3]))
    };
    Ok(CoordinateBreak { before, map: Affine::from_rows(&rows).ok_or_else(last)? })
}

fn aperture((kind, size): &(String, f64)) -> PyResult<SystemAperture> {
    Ok(match kind.as_str() {
        "entrance_pupil_diameter" => SystemAperture::EntrancePupilDiameter(*size),
        "f_number" => SystemAperture::FNumber(*size),
        "object_numerical_aperture" => SystemAperture::ObjectNumericalAperture(*size),
        "stop_semi_diameter" => SystemAperture::StopSemiDiameter(*size),
        other => return Err(bad_value(format!("there is no aperture {other:?}"))),
    })
}

fn aperture_text(aperture: SystemAperture) -> (&'static str, f64) {
    match aperture {
        SystemAperture::EntrancePupilDiameter(size) => ("entrance_pupil_diameter", size),
        SystemAperture::FNumber(size) => ("f_number", size),
        SystemAperture::ObjectNumericalAperture(size) => ("object_numerical_aperture", size),
        SystemAperture::StopSemiDiameter(size) => ("stop_semi_diameter", size),
    }
}

/// The kinds of fields with their names.
const FIELD_KINDS: [(&str, FieldKind); 3] = [
    ("angle", FieldKind::Angle),
    ("object height", FieldKind::ObjectHeight),
    ("image height", FieldKind::ImageHeight),
];

fn field_kind(name: &str) -> PyResult<FieldKind> {
    let known = FIELD_KINDS.iter().find(|(known, _)| *known == name);
    let names = "\"angle\", \"object height\" or \"image height\"";
    let problem = || bad_value(format!("field_kind is {name:?}: it can be {names}."));
    known.map(|(_, kind)| *kind).ok_or_else(problem)
}

fn field_kind_text(kind: FieldKind) -> &'static str {
    FIELD_KINDS.iter().find(|(_, known)| *known == kind).map_or("", |(name, _)| name)
}

/// The frame of a prescription, as [`Frame`] reads it, and its primary wavelength.
pub fn frame_table<'py>(py: Python<'py>, lens: &Prescription) -> PyResult<Bound<'py, PyDict>> {
    let table = PyDict::new(py);
    table.set_item("name", &lens.name)?;
    table.set_item("notes", &lens.notes)?;
    table.set_item("unit_nm", lens.unit_nm)?;
    table.set_item("aperture", aperture_text(lens.aperture))?;
    table.set_item("field_kind", field_kind_text(lens.field_kind))?;
    let fields: Vec<(f64, f64)> = lens.fields.iter().map(|&[x, y]| (x, y)).collect();
    table.set_item("fields", fields)?;
    let lines: Vec<(f64, f64)> = lens.lines.iter().map(|line| (line.wavelength_nm, line.weight)).collect();
    table.set_item("lines", lines)?;
    table.set_item("primary", lens.primary)?;
    table.set_item("primary_nm", lens.primary_nm())?;
    table.set_item("object_distance", lens.object_distance)?;
    table.set_item("stop", lens.stop)?;
    table.set_item("image", (lens.image.radius, lens.image.conic, lens.image.semi_diameter))?;
    let breaks: Vec<_> = lens.breaks.iter().map(|at| (at.before, at.map.to_rows())).collect();
    table.set_item("breaks", breaks)?;
    Ok(table)
}
