//! Cross-sections as a Python class.

use std::path::PathBuf;

use numpy::ndarray::Array2;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyIterator, PyTuple};
use rayweave::model::drive::Cancel;
use rayweave::scene::{Colour, Unit};
use rayweave::section::{
    By, CrossSection, SectionPart, SectionPlane, SectionRun, SectionSettings, cross_sections, section_dxf,
    section_svg,
};
use rayweave::{AnyEvaluator, Vec3};

use crate::engine::thread_argument;
use crate::error::bad_value;
use crate::interrupt::interruptible;
use crate::subject::{bounds, scene};

/// Plane section of a model: areas and contours of each medium or region.
///
/// A notebook shows it as a picture.
///
/// >>> import rayweave as rw
/// >>> cut = rw.section(rw.box([2, 3, 4]), "z=1")
/// >>> cut.names, cut.areas
/// (['solid'], array([6.]))
/// >>> [contour.shape for contour in cut.contours("solid")]
/// [(4, 2)]
#[pyclass(frozen, module = "rayweave", name = "Section")]
pub struct PySection {
    section: CrossSection,
    unit: &'static str,
}

impl PySection {
    pub fn new(section: CrossSection, unit: &'static str) -> PySection {
        PySection { section, unit }
    }

    fn numbers<'py>(&self, py: Python<'py>, of: fn(&SectionPart) -> f64) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.section.parts.iter().map(of))
    }
}

#[pymethods]
impl PySection {
    /// The names of the media or regions that the plane intersects, in their order.
    #[getter]
    fn names(&self) -> Vec<&str> {
        self.section.parts.iter().map(|part| part.name.as_str()).collect()
    }

    /// The plane in words: `z = 0.5`.
    #[getter]
    fn plane(&self) -> String {
        self.section.plane.to_string()
    }

    /// Offset of the plane: its coordinate along the axis or, if it was given by a normal, its signed distance from `point` along
    /// `normal`.
    #[getter]
    fn offset(&self) -> f64 {
        self.section.plane.offset()
    }

    /// Maximum distance of contours from the surfaces; the error of an area is at most this times the perimeter.
    #[getter]
    fn tolerance(&self) -> f64 {
        self.section.tolerance
    }

    /// True if the plane lies in a plane face of a shape of the model. The section then shows the material on the side of larger
    /// coordinates: that of the box from z = -1 to 1 is full at -1 and empty at 1. A plane slightly beside it leaves no choice.
    ///
    /// >>> import rayweave as rw
    /// >>> rw.section(rw.box(2), "z=1")
    /// <Section z = 1 in a face, on its +z side, areas in mm^2: nothing>
    #[getter]
    fn in_face(&self) -> bool {
        self.section.in_face
    }

    /// (P,) areas of the parts.
    #[getter]
    fn areas<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.numbers(py, |part| part.area)
    }

    /// (P,) the largest errors of the areas: the tolerance times the perimeter. Areas between straight edges are exact to rounding.
    #[getter]
    fn area_errors<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let tolerance = self.section.tolerance;
        PyArray1::from_iter(py, self.section.parts.iter().map(|part| tolerance * part.perimeter))
    }

    /// (P,) perimeters of the parts, holes included.
    #[getter]
    fn perimeters<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.numbers(py, |part| part.perimeter)
    }

    /// The contours of a part, each (N, 2): outlines counter-clockwise, holes clockwise; the first point is not repeated at the
    /// end.
    #[pyo3(signature = (name) -> "tuple[NDArray[np.float64], ...]")]
    fn contours<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyTuple>> {
        let Some(part) = self.section.part(name) else {
            let names = self.names();
            let reason = match names.is_empty() {
                true => "it is empty".to_owned(),
                false => format!("its parts are {}", names.join(", ")),
            };
            return Err(bad_value(format!("the section has no part '{name}': {reason}.")));
        };
        let array = |contour: &Vec<[f64; 2]>| {
            let points = contour.as_flattened().to_vec();
            let array = Array2::from_shape_vec((contour.len(), 2), points).map_err(bad_value)?;
            Ok(PyArray2::from_owned_array(py, array))
        };
        PyTuple::new(py, part.contours.iter().map(array).collect::<PyResult<Vec<_>>>()?)
    }

    /// A point of the plane and its axes, to the right and up, (3, 3): `frame[0] + u * frame[1] + v * frame[2]` is a point of space.
    #[getter]
    fn frame<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let cut = self.section.plane.cut().map_err(bad_value)?;
        let origin = cut.point([0.0, 0.0]);
        let rows = [origin, cut.point([1.0, 0.0]) - origin, cut.point([0.0, 1.0]) - origin];
        let rows: Vec<Vec<f64>> = rows.iter().map(|row: &Vec3| row.to_array().to_vec()).collect();
        PyArray2::from_vec2(py, &rows).map_err(bad_value)
    }

    fn __repr__(&self) -> String {
        let tolerance = self.section.tolerance;
        let part = |part: &SectionPart| {
            let error = tolerance * part.perimeter;
            // as many digits as are accurate
            let area = rayweave::draw::axis::format_number(part.area, 0.1 * error);
            format!("{} {area} \u{b1} {error:.1e}", part.name)
        };
        let parts: Vec<String> = self.section.parts.iter().map(part).collect();
        let areas = if parts.is_empty() { "nothing".to_owned() } else { parts.join(", ") };
        let plane = self.section.plane;
        let face = match self.section.in_face {
            true => format!(" in a face, on its {}", plane.side_in_face()),
            false => String::new(),
        };
        format!("<Section {plane}{face}, areas in {}^2: {areas}>", self.unit)
    }

    /// The number of parts.
    fn __len__(&self) -> usize {
        self.section.parts.len()
    }

    /// The names of the parts.
    #[cfg_attr(false, stub("() -> Iterator[str]"))]
    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        PyTuple::new(py, self.names())?.try_iter()
    }

    /// The parts as a pandas DataFrame: name, area, area_error, perimeter.
    #[pyo3(signature = () -> "Any")]
    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        rows(slf)?.call_method0("to_pandas")
    }

    /// The parts as an Arrow table: name, area, area_error, perimeter.
    #[pyo3(signature = () -> "Any")]
    fn to_arrow<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        rows(slf)?.call_method0("to_arrow")
    }

    /// The parts as an xarray Dataset with the dimension `row`: name, area, area_error, perimeter.
    #[pyo3(signature = () -> "Any")]
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        rows(slf)?.call_method0("to_xarray")
    }

    /// Writes the section as a picture (.svg) or as closed polylines and circles (.dxf): see `rayweave.save_section`.
    ///
    /// >>> import rayweave as rw
    /// >>> rw.section(rw.sphere(1), "z=0").save("circle.svg")
    #[pyo3(signature = (path, *, title = ""))]
    fn save(slf: &Bound<'_, Self>, path: PathBuf, title: &str) -> PyResult<()> {
        let module = slf.py().import("rayweave._section")?;
        let options = [("title", title)].into_py_dict(slf.py())?;
        module.getattr("save_section")?.call((slf, path), Some(&options)).map(|_| ())
    }

    /// Shows the section: in a notebook below the cell, otherwise in the browser.
    fn show(slf: &Bound<'_, Self>) -> PyResult<()> {
        let svg = slf.get()._repr_svg_();
        let show = slf.py().import("rayweave._drawing")?.getattr("show")?;
        show.call1((slf, svg.as_bytes(), ".svg")).map(|_| ())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Pickled)> {
        let CrossSection { plane, parts, lo, hi, tolerance, in_face } = self.section.clone();
        let part = |own: SectionPart| {
            let SectionPart { name, colour, area, perimeter, contours } = own;
            (name, [colour.red, colour.green, colour.blue, colour.alpha], [area, perimeter], contours)
        };
        let parts = parts.into_iter().map(part).collect();
        let make = py.import("rayweave._core")?.getattr("section_from_parts")?;
        Ok((make, (plane.to_numbers(), parts, [lo, hi], tolerance, self.unit.to_owned(), in_face)))
    }

    fn _repr_svg_(&self) -> String {
        section_svg(std::slice::from_ref(&self.section), "", self.unit)
    }
}

/// The numbers of the plane, the parts, the corners, the tolerance and the unit of a section, and whether it lies in a face.
type Pickled = (Vec<f64>, Vec<PickledPart>, [[f64; 2]; 2], f64, String, bool);

/// Name, colour, area and perimeter, and contours of a part.
type PickledPart = (String, [u8; 4], [f64; 2], Vec<Vec<[f64; 2]>>);

/// A section from its pickled parts.
#[pyfunction]
#[pyo3(signature = (
    plane: "Sequence[float]", parts: "Sequence[Any]", corners: "Sequence[Sequence[float]]", tolerance, unit, in_face
))]
pub fn section_from_parts(
    plane: Vec<f64>,
    parts: Vec<PickledPart>,
    corners: [[f64; 2]; 2],
    tolerance: f64,
    unit: &str,
    in_face: bool,
) -> PyResult<PySection> {
    let damaged =
        || bad_value("the pickled object is not a section: it is damaged or comes from a different version.");
    let part = |own: PickledPart| {
        let (name, [red, green, blue, alpha], [area, perimeter], contours) = own;
        SectionPart { name, colour: Colour { red, green, blue, alpha }, area, perimeter, contours }
    };
    let (plane, [lo, hi]) = (SectionPlane::from_numbers(&plane).ok_or_else(damaged)?, corners);
    let section =
        CrossSection { plane, parts: parts.into_iter().map(part).collect(), lo, hi, tolerance, in_face };
    Ok(PySection::new(section, Unit::parse(unit).ok_or_else(damaged)?.symbol()))
}

/// The parts of a section as `rayweave._table.Rows`.
fn rows<'py>(section: &Bound<'py, PySection>) -> PyResult<Bound<'py, PyAny>> {
    section.py().import("rayweave._section")?.getattr("rows_of")?.call1((section,))
}

/// Sections of a solid or a model by a plane, at the given offsets: see `rayweave.section`.
#[pyfunction]
#[pyo3(signature = (
    subject: "Subject", plane, point: "Sequence[float]", normal: "Sequence[float] | None", offsets, by,
    tolerance, columns, within: "Sequence[Sequence[float]] | None", evaluator, threads: "int | None"
))]
#[expect(clippy::too_many_arguments, reason = "those of the function in Python")]
pub fn section_list(
    subject: &Bound<'_, PyAny>,
    plane: &str,
    point: [f64; 3],
    normal: Option<[f64; 3]>,
    offsets: Option<Vec<f64>>,
    by: &str,
    tolerance: Option<f64>,
    columns: u32,
    within: Option<[[f64; 3]; 2]>,
    evaluator: Option<&str>,
    threads: Option<&Bound<'_, PyAny>>,
) -> PyResult<Vec<PySection>> {
    let py = subject.py();
    let scene = scene(subject)?;
    let plane: SectionPlane = match normal {
        Some(normal) => SectionPlane::new(Vec3::from(point), Vec3::from(normal)),
        None => plane.parse(),
    }
    .map_err(bad_value)?;
    let planes = match offsets {
        None => vec![plane],
        Some(offsets) => {
            offsets.into_iter().map(|at| plane.at(at)).collect::<Result<_, _>>().map_err(bad_value)?
        }
    };
    let by = match by {
        "medium" => By::Medium,
        "region" => By::Region,
        other => return Err(bad_value(format!("by is '{other}': it can be medium or region."))),
    };
    let cancel = Cancel::new();
    let run = SectionRun { threads: threads.map(thread_argument).transpose()?, cancel: cancel.clone() };
    let settings = SectionSettings { by, tolerance, columns, within: within.map(bounds), run };
    let found = interruptible(py, &cancel, || {
        cross_sections(&scene, None, AnyEvaluator::maker(evaluator), &planes, &settings, &mut |_| ())
    })?;
    let unit = scene.unit.symbol();
    Ok(found.into_iter().map(|section| PySection::new(section, unit)).collect())
}

/// Sections as one document, "svg" or "dxf".
#[pyfunction]
#[pyo3(signature = (sections, format, title))]
pub fn section_text(sections: Vec<PyRef<'_, PySection>>, format: &str, title: &str) -> PyResult<String> {
    let all: Vec<CrossSection> = sections.iter().map(|section| section.section.clone()).collect();
    let unit = sections.first().map_or("mm", |section| section.unit);
    match format {
        "svg" => Ok(section_svg(&all, title, unit)),
        "dxf" => Ok(section_dxf(&all, unit)),
        other => Err(bad_value(format!("unknown format '{other}': it can be svg or dxf."))),
    }
}
