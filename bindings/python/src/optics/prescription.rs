//! Prescriptions, their first-order data and studies of their images.

use numpy::ndarray::{Array2, ArrayView1, Ix2};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayweave::optics::analysis::{AnalysisError, Study, fan_x, fan_y, hexapolar, square};
use rayweave::optics::component::{Figure, Zernike};
use rayweave::optics::paraxial::{FirstOrder, Meridian, Pupil, Seidel};
use rayweave::optics::prescription::{
    Behind, CoordinateBreak, FieldKind, ImageSurface, Layout, Line, Prescription, Surface, SystemAperture,
    read_zmx, write_zmx,
};
use rayweave::optics::{Beam, Medium, System, Tracer};
use rayweave::{Affine, Packets};
use std::sync::OnceLock;

use crate::arrays::{double_array, shape_text};
use crate::error::bad_value;
use crate::optics::arrivals::{Of, PyArrivals};
use crate::optics::glass::PyGlass;
use crate::optics::parts::parts;
use crate::optics::system::Spec;

/// What lies behind a surface: "air", "mirror" or the name of a glass; an index, n_d and V_d, or a glass.
#[derive(FromPyObject)]
enum Substance<'py> {
    Glass(PyRef<'py, PyGlass>),
    Name(String),
    Index(f64),
    Model(f64, f64),
}

impl Substance<'_> {
    fn behind(&self) -> Behind {
        match self {
            Substance::Glass(glass) => Behind::Medium(Medium::from(glass.0.clone())),
            Substance::Name(name) if name == "air" => Behind::Air,
            Substance::Name(name) if name == "mirror" => Behind::Mirror,
            Substance::Name(name) => Behind::Glass(name.clone()),
            Substance::Index(n) => Behind::Index(*n),
            Substance::Model(n_d, v_d) => Behind::Abbe { n_d: *n_d, v_d: *v_d },
        }
    }
}

fn substance<'py>(py: Python<'py>, behind: &Behind) -> PyResult<Bound<'py, PyAny>> {
    match behind {
        Behind::Air => "air".into_bound_py_any(py),
        Behind::Mirror => "mirror".into_bound_py_any(py),
        Behind::Glass(name) => name.into_bound_py_any(py),
        Behind::Index(n) => n.into_bound_py_any(py),
        Behind::Abbe { n_d, v_d } => (*n_d, *v_d).into_bound_py_any(py),
        Behind::Medium(medium) => match (medium.as_glass(), medium.as_constant()) {
            (Some(glass), _) => PyGlass(glass.clone()).into_bound_py_any(py),
            (None, Some(index)) => index.re.into_bound_py_any(py),
            (None, None) => medium.name().into_bound_py_any(py),
        },
    }
}

/// Radius, thickness, material, conic constant, semi-diameter and hole of a surface, its even and odd terms, and its figure.
#[derive(FromPyObject)]
struct Row<'py>(f64, f64, Substance<'py>, f64, Option<f64>, f64, Vec<f64>, Vec<f64>, Spec);

impl Row<'_> {
    fn surface(&self) -> PyResult<Surface> {
        let Row(radius, thickness, behind, conic, semi_diameter, hole, even, odd, shape) = self;
        let surface = Surface::new(*radius, *thickness, behind.behind()).conic(*conic).hole(*hole);
        let surface = surface.even(terms("even", even)?).odd(terms("odd", odd)?).figure(figure(shape)?);
        Ok(match semi_diameter {
            Some(semi_diameter) => surface.semi_diameter(*semi_diameter),
            None => surface,
        })
    }
}

/// Eight coefficients; those that are not given are 0.
pub fn terms(name: &str, given: &[f64]) -> PyResult<[f64; 8]> {
    let mut terms = [0.0; 8];
    let places = terms.get_mut(..given.len());
    let too_many = || bad_value(format!("{name} has {} coefficients (8 at most)", given.len()));
    places.ok_or_else(too_many)?.copy_from_slice(given);
    Ok(terms)
}

/// The figure of a name and numbers.
fn figure(spec: &Spec) -> PyResult<Figure> {
    let zernike = |order, norm_radius, coefficients: &[f64]| Figure::Zernike {
        order,
        norm_radius,
        coefficients: coefficients.to_vec(),
    };
    Ok(match (spec.kind(), spec.numbers()) {
        ("round", []) => Figure::Round,
        ("biconic", &[radius_x, conic_x]) => Figure::Biconic { radius_x, conic_x },
        ("toroidal", &[turn]) => Figure::Toroidal { turn },
        ("polynomial", &[norm_radius, ref coefficients @ ..]) => {
            Figure::Polynomial { norm_radius, coefficients: coefficients.to_vec() }
        }
        ("noll", &[norm_radius, ref coefficients @ ..]) => zernike(Zernike::Noll, norm_radius, coefficients),
        ("osa", &[norm_radius, ref coefficients @ ..]) => zernike(Zernike::Osa, norm_radius, coefficients),
        ("fringe", &[norm_radius, ref coefficients @ ..]) => {
            zernike(Zernike::Fringe, norm_radius, coefficients)
        }
        (kind, numbers) => {
            return Err(bad_value(format!("there is no figure {kind:?} with {} numbers", numbers.len())));
        }
    })
}

fn figure_out(figure: &Figure) -> SpecOut {
    let (name, numbers) = match figure {
        Figure::Round => ("round", vec![]),
        Figure::Biconic { radius_x, conic_x } => ("biconic", vec![*radius_x, *conic_x]),
        Figure::Toroidal { turn } => ("toroidal", vec![*turn]),
        Figure::Polynomial { norm_radius, coefficients } => {
            ("polynomial", [&[*norm_radius], &coefficients[..]].concat())
        }
        Figure::Zernike { order, norm_radius, coefficients } => {
            let name = match order {
                Zernike::Noll => "noll",
                Zernike::Osa => "osa",
                Zernike::Fringe => "fringe",
            };
            (name, [&[*norm_radius], &coefficients[..]].concat())
        }
    };
    (name, numbers)
}

/// A kind with its numbers on its way out.
type SpecOut = (&'static str, Vec<f64>);

/// The coefficients up to the last that is not 0.
fn given(terms: &[f64; 8]) -> Vec<f64> {
    let count = terms.iter().rposition(|&c| c != 0.0).map_or(0, |last| last + 1);
    terms[..count].to_vec()
}

/// The same on its way out.
type RowOut<'py> = (f64, f64, Bound<'py, PyAny>, f64, Option<f64>, f64, Vec<f64>, Vec<f64>, SpecOut);

/// What is not said of single surfaces.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Frame {
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

/// A prescription, compiled when it is first asked for what solids do: see `rayweave.optics.Prescription`.
#[pyclass(frozen, module = "rayweave.optics", name = "CompiledPrescription")]
pub struct PyPrescription {
    lens: Prescription,
    built: OnceLock<(Layout, System)>,
}

impl From<Prescription> for PyPrescription {
    fn from(lens: Prescription) -> PyPrescription {
        PyPrescription { lens, built: OnceLock::new() }
    }
}

#[pymethods]
impl PyPrescription {
    #[new]
    #[pyo3(signature = (rows, frame))]
    fn new(rows: Vec<Row<'_>>, frame: Frame) -> PyResult<Self> {
        let surfaces = rows.iter().map(Row::surface).collect::<PyResult<_>>()?;
        let lens = framed(Prescription::new(surfaces), frame)?;
        // what is wrong is said at once
        lens.first_order(lens.primary_nm()).map_err(bad_value)?;
        Ok(PyPrescription::from(lens))
    }

    /// The prescription in the bytes of a Zemax file, and notes on what was passed over.
    #[staticmethod]
    #[pyo3(signature = (file))]
    fn read_zmx(file: &[u8]) -> PyResult<(Self, Vec<String>)> {
        let read = read_zmx(file).map_err(bad_value)?;
        Ok((PyPrescription::from(read.prescription), read.notes.iter().map(ToString::to_string).collect()))
    }

    /// The text of a Zemax file.
    fn write_zmx(&self) -> PyResult<String> {
        write_zmx(&self.lens).map_err(bad_value)
    }

    /// The surfaces, as the constructor takes them.
    fn rows<'py>(&self, py: Python<'py>) -> PyResult<Vec<RowOut<'py>>> {
        let row = |surface: &Surface| {
            let behind = substance(py, &surface.behind)?;
            let Surface { radius, thickness, conic, semi_diameter, hole, even, odd, figure, .. } = surface;
            let (even, odd, figure) = (given(even), given(odd), figure_out(figure));
            Ok((*radius, *thickness, behind, *conic, *semi_diameter, *hole, even, odd, figure))
        };
        self.lens.surfaces.iter().map(row).collect()
    }

    /// What is not said of single surfaces, as the constructor takes it.
    fn frame<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let lens = &self.lens;
        let table = PyDict::new(py);
        table.set_item("name", &lens.name)?;
        table.set_item("notes", &lens.notes)?;
        table.set_item("unit_nm", lens.unit_nm)?;
        table.set_item("aperture", aperture_text(lens.aperture))?;
        table.set_item("field_kind", field_kind_text(lens.field_kind))?;
        let fields: Vec<(f64, f64)> = lens.fields.iter().map(|&[x, y]| (x, y)).collect();
        table.set_item("fields", fields)?;
        let lines: Vec<(f64, f64)> =
            lens.lines.iter().map(|line| (line.wavelength_nm, line.weight)).collect();
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

    /// First-order data at a wavelength by name, with the matrix (a, b, c, d); pupils are (position, diameter).
    #[pyo3(signature = (wavelength_nm, along))]
    fn first_order<'py>(
        &self,
        py: Python<'py>,
        wavelength_nm: f64,
        along: &str,
    ) -> PyResult<Bound<'py, PyDict>> {
        let meridian = match along {
            "x" => Meridian::X,
            "y" => Meridian::Y,
            other => return Err(bad_value(format!("along is {other:?} (it can be \"x\" or \"y\")"))),
        };
        first_order_table(py, &self.lens.first_order_along(meridian, wavelength_nm).map_err(bad_value)?)
    }

    /// The Seidel sums of every surface, as columns.
    fn seidel<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let sums = self.lens.seidel().map_err(bad_value)?;
        let table = PyDict::new(py);
        let columns: [(&str, Of<Seidel>); 7] = [
            ("spherical", |sum| sum.spherical),
            ("coma", |sum| sum.coma),
            ("astigmatism", |sum| sum.astigmatism),
            ("petzval", |sum| sum.petzval),
            ("distortion", |sum| sum.distortion),
            ("axial_colour", |sum| sum.axial_colour),
            ("lateral_colour", |sum| sum.lateral_colour),
        ];
        for (name, value) in columns {
            table.set_item(name, PyArray1::from_vec(py, sums.iter().map(value).collect()))?;
        }
        Ok(table)
    }

    /// Its solids, stop and image.
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let (layout, _) = self.built(py)?;
        parts(py, &layout.assembly)?.into_iter().map(|part| part.into_bound_py_any(py)).collect()
    }

    /// The clear semi-diameters of the surfaces and of the image.
    fn semi_diameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_slice(py, &self.built(py)?.0.semi_diameters))
    }

    /// Origins and directions of the rays of a field through points of the pupil, (N, 2).
    #[pyo3(signature = (field, wavelength_nm, pupil, aimed))]
    #[allow(clippy::type_complexity)] // two arrays
    fn rays<'py>(
        &self,
        field: usize,
        wavelength_nm: f64,
        pupil: &Bound<'py, PyAny>,
        aimed: bool,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)> {
        let points = points(pupil, "pupil")?;
        let beam = match aimed {
            true => self.lens.beam_at_stop(field, wavelength_nm, &points),
            false => self.lens.beam(field, wavelength_nm, &points),
        };
        Ok(ray_arrays(pupil.py(), &beam.map_err(bad_value)?))
    }

    /// The rays of a field on the image, at one wavelength or at all of them with their weights.
    #[pyo3(signature = (field, wavelength_nm, pupil, aimed))]
    fn arrivals(
        &self,
        field: usize,
        wavelength_nm: Option<f64>,
        pupil: &Bound<'_, PyAny>,
        aimed: bool,
    ) -> PyResult<PyArrivals> {
        let points = points(pupil, "pupil")?;
        let found = self.study(pupil.py(), aimed, |study| match wavelength_nm {
            Some(wavelength_nm) => study.arrivals(field, wavelength_nm, &points),
            None => study.polychromatic(field, &points),
        });
        found.map(PyArrivals)
    }

    /// A ray fan: points of the pupil and transverse errors, both (N, 2).
    #[pyo3(signature = (field, wavelength_nm, pupil, aimed))]
    #[allow(clippy::type_complexity)] // two arrays
    fn fan<'py>(
        &self,
        field: usize,
        wavelength_nm: f64,
        pupil: &Bound<'py, PyAny>,
        aimed: bool,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)> {
        let (py, points) = (pupil.py(), points(pupil, "pupil")?);
        let fan = self.study(py, aimed, |study| study.fan(field, wavelength_nm, &points))?;
        Ok((pairs(py, &fan.pupil), pairs(py, &fan.errors)))
    }

    /// A wavefront: points of the pupil (N, 2) and differences in waves (N,).
    #[pyo3(signature = (field, wavelength_nm, pupil, aimed))]
    #[allow(clippy::type_complexity)] // two arrays
    fn wavefront<'py>(
        &self,
        field: usize,
        wavelength_nm: f64,
        pupil: &Bound<'py, PyAny>,
        aimed: bool,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>)> {
        let (py, points) = (pupil.py(), points(pupil, "pupil")?);
        let wavefront = self.study(py, aimed, |study| study.wavefront(field, wavelength_nm, &points))?;
        Ok((pairs(py, &wavefront.pupil), PyArray1::from_vec(py, wavefront.waves)))
    }

    /// The heights of the real and the paraxial principal ray on the image, and the tangential and the sagittal focus.
    #[pyo3(signature = (field, wavelength_nm))]
    fn principal(&self, py: Python<'_>, field: usize, wavelength_nm: f64) -> PyResult<[f64; 4]> {
        self.study(py, false, |study| {
            let distortion = study.distortion(field, wavelength_nm)?;
            let foci = study.field_foci(field, wavelength_nm)?;
            Ok([distortion.real, distortion.paraxial, foci.tangential, foci.sagittal])
        })
    }

    /// Where the ray of the first field, the axis, through a height in the pupil crosses the axis.
    #[pyo3(signature = (wavelength_nm, height))]
    fn axial_focus(&self, py: Python<'_>, wavelength_nm: f64, height: f64) -> PyResult<f64> {
        self.study(py, false, |study| study.axial_focus(wavelength_nm, height))
    }

    /// The height of the principal ray less that at the primary wavelength.
    #[pyo3(signature = (field, wavelength_nm))]
    fn lateral_colour(&self, py: Python<'_>, field: usize, wavelength_nm: f64) -> PyResult<f64> {
        self.study(py, false, |study| study.lateral_colour(field, wavelength_nm))
    }
}

impl PyPrescription {
    /// The prescription itself.
    pub fn lens(&self) -> &Prescription {
        &self.lens
    }

    fn built(&self, py: Python<'_>) -> PyResult<&(Layout, System)> {
        if let Some(built) = self.built.get() {
            return Ok(built);
        }
        let made = py.detach(|| {
            let layout = self.lens.assembly().map_err(bad_value)?;
            let system = layout.assembly.compile().map_err(bad_value)?;
            Ok::<_, PyErr>((layout, system))
        })?;
        Ok(self.built.get_or_init(|| made))
    }

    fn study<T: Send>(
        &self,
        py: Python<'_>,
        aimed: bool,
        ask: impl FnOnce(&Study<'_, Packets>) -> Result<T, AnalysisError> + Send,
    ) -> PyResult<T> {
        let (layout, system) = self.built(py)?;
        let answer = py.detach(|| {
            let tracer = Tracer::new(system, Packets::new);
            let study = Study::new(&self.lens, layout, &tracer);
            ask(&if aimed { study.aimed() } else { study })
        });
        answer.map_err(bad_value)
    }
}

/// The matrix of a coordinate break: coordinates in front of it from those behind, row by row.
#[pyfunction]
#[pyo3(signature = (decentre, tilt_degrees, tilts_first))]
pub fn coordinate_break(decentre: [f64; 2], tilt_degrees: [f64; 3], tilts_first: bool) -> [[f64; 4]; 4] {
    let made = if tilts_first { CoordinateBreak::tilts_first } else { CoordinateBreak::new };
    made(0, decentre, tilt_degrees).map.to_rows()
}

/// Points of a pupil by kind: "hexapolar" with a number of rings, "square", "fan_x" or "fan_y" with that of points across.
#[pyfunction]
#[pyo3(signature = (kind, count))]
pub fn pupil_points<'py>(py: Python<'py>, kind: &str, count: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let points = match kind {
        "hexapolar" => hexapolar(count),
        "square" => square(count),
        "fan_x" => fan_x(count),
        "fan_y" => fan_y(count),
        other => return Err(bad_value(format!("there is no pupil {other:?}"))),
    };
    Ok(pairs(py, &points))
}

/// An array (N, 2) as a list of points.
pub fn points(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<[f64; 2]>> {
    let array = double_array(object, name)?;
    let [_, 2] = *array.shape() else {
        return Err(bad_value(format!("{name} has shape {} ((N, 2) is needed)", shape_text(array.shape()))));
    };
    let array = array.try_readonly().map_err(bad_value)?;
    let view = array.as_array().into_dimensionality::<Ix2>().map_err(bad_value)?;
    Ok(view.rows().into_iter().map(|row: ArrayView1<'_, f64>| [row[0], row[1]]).collect())
}

fn pairs<'py>(py: Python<'py>, points: &[[f64; 2]]) -> Bound<'py, PyArray2<f64>> {
    PyArray2::from_owned_array(py, Array2::from_shape_fn((points.len(), 2), |(row, k)| points[row][k]))
}

fn ray_arrays<'py>(py: Python<'py>, beam: &Beam) -> (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>) {
    let shape = (beam.len(), 3);
    let origins = Array2::from_shape_fn(shape, |(row, k)| beam.get(row).ray.origin[k]);
    let directions = Array2::from_shape_fn(shape, |(row, k)| beam.get(row).ray.direction[k]);
    (PyArray2::from_owned_array(py, origins), PyArray2::from_owned_array(py, directions))
}

/// What the surfaces do not say.
fn framed(lens: Prescription, frame: Frame) -> PyResult<Prescription> {
    let (radius, conic, semi_diameter) = frame.image;
    let line = |(wavelength_nm, weight)| Line { wavelength_nm, weight };
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
    let last =
        || bad_value(format!("the last row of a coordinate break is {:?} ([0, 0, 0, 1] is needed)", rows[3]));
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
    let problem = || bad_value(format!("field_kind is {name:?} (it can be {names})"));
    known.map(|(_, kind)| *kind).ok_or_else(problem)
}

fn field_kind_text(kind: FieldKind) -> &'static str {
    FIELD_KINDS.iter().find(|(_, known)| *known == kind).map_or("", |(name, _)| name)
}

fn first_order_table<'py>(py: Python<'py>, data: &FirstOrder) -> PyResult<Bound<'py, PyDict>> {
    let table = PyDict::new(py);
    let numbers = [
        ("focal_length", data.focal_length),
        ("back_focal_distance", data.back_focal_distance),
        ("front_focal_distance", data.front_focal_distance),
        ("back_principal_plane", data.back_principal_plane),
        ("front_principal_plane", data.front_principal_plane),
        ("stop_semi_diameter", data.stop_semi_diameter),
        ("f_number", data.f_number),
        ("magnification", data.magnification),
        ("angular_magnification", data.angular_magnification),
        ("image_distance", data.image_distance),
        ("petzval_sum", data.petzval_sum),
    ];
    for (name, number) in numbers {
        table.set_item(name, number)?;
    }
    let pupil = |pupil: &Pupil| (pupil.position, pupil.diameter);
    table.set_item("entrance_pupil", pupil(&data.entrance_pupil))?;
    table.set_item("exit_pupil", pupil(&data.exit_pupil))?;
    let matrix = data.matrix;
    table.set_item("matrix", [matrix.a, matrix.b, matrix.c, matrix.d])?;
    Ok(table)
}
