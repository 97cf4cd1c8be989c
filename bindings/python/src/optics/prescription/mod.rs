//! Prescriptions, their first-order data and their image analysis.

mod frame;
mod row;
mod table;

use numpy::{PyArray1, PyArray2};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayweave::Packets;
use rayweave::lens::analysis::{LensAnalysisError, Study, fan_x, fan_y, hexapolar, needs_aiming, square};
use rayweave::lens::paraxial::Meridian;
use rayweave::lens::prescription::{CoordinateBreak, Prescription, PrescriptionLayout, read_zmx, write_zmx};
use rayweave::optics::{System, Tracer};
use std::sync::OnceLock;

use crate::engine::computed;
use crate::error::bad_value;
use crate::optics::arrivals::PyArrivals;
use crate::optics::parts::parts;
use crate::vectors::{pairs, points};
use frame::{Frame, frame_table, framed};
use row::{Row, RowOut, row_of};
use table::{first_order_table, ray_arrays, seidel_table};

/// A prescription, with a system that is compiled on demand: see `rayweave.optics.Prescription`.
#[pyclass(frozen, module = "rayweave.optics", name = "CompiledPrescription")]
pub struct PyPrescription {
    lens: Prescription,
    built: OnceLock<(PrescriptionLayout, System)>,
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
        // reject invalid prescriptions in the constructor
        lens.first_order(lens.primary_nm()).map_err(bad_value)?;
        Ok(PyPrescription::from(lens))
    }

    /// The prescription in the bytes of a Zemax file, and notes on ignored entries.
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
    #[pyo3(signature = () -> "list[tuple[Any, ...]]")]
    fn rows<'py>(&self, py: Python<'py>) -> PyResult<Vec<RowOut<'py>>> {
        self.lens.surfaces.iter().map(|surface| row_of(py, surface)).collect()
    }

    /// Aperture, fields, wavelengths, stop and image, in the form that the constructor takes.
    #[pyo3(signature = () -> "dict[str, Any]")]
    fn frame<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        frame_table(py, &self.lens)
    }

    /// A dict of first-order data at a wavelength, with the matrix (a, b, c, d); pupils are (position, diameter).
    #[pyo3(signature = (wavelength_nm, along) -> "dict[str, Any]")]
    fn first_order<'py>(
        &self,
        py: Python<'py>,
        wavelength_nm: f64,
        along: &str,
    ) -> PyResult<Bound<'py, PyDict>> {
        let meridian = match along {
            "x" => Meridian::X,
            "y" => Meridian::Y,
            other => return Err(bad_value(format!("along is {other:?}: it can be \"x\" or \"y\"."))),
        };
        first_order_table(py, &self.lens.first_order_along(meridian, wavelength_nm).map_err(bad_value)?)
    }

    /// The Seidel sums of every surface, as columns.
    #[pyo3(signature = () -> "dict[str, NDArray[np.float64]]")]
    fn seidel<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        seidel_table(py, &self.lens.seidel().map_err(bad_value)?)
    }

    /// The solids, stop and image of the prescription.
    #[pyo3(signature = () -> "list[tuple[str, Any, Any, Any, Any]]")]
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let (layout, _) = self.built(py)?;
        parts(py, &layout.assembly)?.into_iter().map(|part| part.into_bound_py_any(py)).collect()
    }

    /// The drawing of a lens, or of the cemented lenses from the first to the last number, counted from 1, as SVG, with the texts
    /// of fields.
    #[pyo3(signature = (first, last, title, indications))]
    fn drawing(
        &self,
        py: Python<'_>,
        first: usize,
        last: usize,
        title: &str,
        indications: Vec<(String, String)>,
    ) -> PyResult<String> {
        py.detach(|| rayweave::lens_drawing_with(&self.lens, [first, last], title, indications))
            .map_err(bad_value)
    }

    /// The clear semi-diameters of the surfaces and of the image.
    fn semi_diameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_slice(py, &self.built(py)?.0.semi_diameters))
    }

    /// Origins and directions, both (N, 3), of the rays of a field through points of the pupil, (N, 2), in units of its
    /// semi-diameter.
    #[pyo3(signature = (field, wavelength_nm, pupil: "ArrayLike", aimed))]
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
    #[pyo3(signature = (field, wavelength_nm, pupil: "ArrayLike", aimed))]
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

    /// A ray fan: points of the pupil and transverse ray aberrations, both (N, 2), from the central ray at `reference_nm`.
    #[pyo3(signature = (field, wavelength_nm, reference_nm, pupil: "ArrayLike", aimed))]
    #[allow(clippy::type_complexity)] // two arrays
    fn fan<'py>(
        &self,
        field: usize,
        wavelength_nm: f64,
        reference_nm: f64,
        pupil: &Bound<'py, PyAny>,
        aimed: bool,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)> {
        let (py, points) = (pupil.py(), points(pupil, "pupil")?);
        let fan =
            self.study(py, aimed, |study| study.fan_about(field, wavelength_nm, reference_nm, &points))?;
        Ok((pairs(py, &fan.pupil), pairs(py, &fan.errors)))
    }

    /// A wavefront: points of the pupil (N, 2) and optical path differences in waves (N,).
    #[pyo3(signature = (field, wavelength_nm, pupil: "ArrayLike", aimed))]
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

    /// The point of the paraxial entrance pupil through which the chief ray passes.
    #[pyo3(signature = (field, wavelength_nm))]
    fn chief_ray_pupil_point(
        &self,
        py: Python<'_>,
        field: usize,
        wavelength_nm: f64,
    ) -> PyResult<(f64, f64)> {
        let [x, y] =
            py.detach(|| self.lens.chief_ray_pupil_point(field, wavelength_nm)).map_err(bad_value)?;
        Ok((x, y))
    }

    /// Whether rays of a field have to be aimed at the stop.
    #[pyo3(signature = (field, wavelength_nm))]
    fn needs_aiming(&self, py: Python<'_>, field: usize, wavelength_nm: f64) -> PyResult<bool> {
        py.detach(|| needs_aiming(&self.lens, field, wavelength_nm)).map_err(bad_value)
    }

    /// The heights of the real and the paraxial chief ray on the image, and the tangential and the sagittal focus.
    #[pyo3(signature = (field, wavelength_nm))]
    fn principal(&self, py: Python<'_>, field: usize, wavelength_nm: f64) -> PyResult<[f64; 4]> {
        self.study(py, false, |study| {
            let distortion = study.distortion(field, wavelength_nm)?;
            let foci = study.field_foci(field, wavelength_nm)?;
            Ok([distortion.real, distortion.paraxial, foci.tangential, foci.sagittal])
        })
    }

    /// The distance from the image to the axis crossing of the ray at a height in the pupil, in units of its
    /// semi-diameter. The first field must be on the axis.
    #[pyo3(signature = (wavelength_nm, height))]
    fn axial_focus(&self, py: Python<'_>, wavelength_nm: f64, height: f64) -> PyResult<f64> {
        self.study(py, false, |study| study.axial_focus(wavelength_nm, height))
    }

    /// The height of the chief ray on the image minus that at the primary wavelength.
    #[pyo3(signature = (field, wavelength_nm))]
    fn lateral_colour(&self, py: Python<'_>, field: usize, wavelength_nm: f64) -> PyResult<f64> {
        self.study(py, false, |study| study.lateral_colour(field, wavelength_nm))
    }
}

impl PyPrescription {
    /// The prescription.
    pub fn lens(&self) -> &Prescription {
        &self.lens
    }

    fn built(&self, py: Python<'_>) -> PyResult<&(PrescriptionLayout, System)> {
        computed(&self.built, || {
            py.detach(|| {
                let layout = self.lens.assembly().map_err(bad_value)?;
                let system = layout.assembly.compile().map_err(bad_value)?;
                Ok((layout, system))
            })
        })
    }

    fn study<T: Send>(
        &self,
        py: Python<'_>,
        aimed: bool,
        question: impl FnOnce(&Study<'_, Packets>) -> Result<T, LensAnalysisError> + Send,
    ) -> PyResult<T> {
        let (layout, system) = self.built(py)?;
        let answer = py.detach(|| {
            let tracer = Tracer::new(system, Packets::new);
            let study = Study::new(&self.lens, layout, &tracer);
            question(&if aimed { study.aimed() } else { study })
        });
        answer.map_err(bad_value)
    }
}

/// The matrix of a coordinate break, row by row: it maps coordinates behind the break to those in front of it.
#[pyfunction]
#[pyo3(signature = (decentre, tilt_degrees, tilts_first))]
pub fn coordinate_break(decentre: [f64; 2], tilt_degrees: [f64; 3], tilts_first: bool) -> [[f64; 4]; 4] {
    let made = if tilts_first { CoordinateBreak::tilts_first } else { CoordinateBreak::new };
    made(0, decentre, tilt_degrees).map.to_rows()
}

/// The maximum number of points of a fan; grids and rings are limited to its square root, so that a hexapolar pattern
/// has at most 3 * 2^26 points (3 GB).
const MAX_POINTS: usize = 1 << 26;

/// Points of a pupil by kind: "hexapolar" with a number of rings, "square", "fan_x" or "fan_y" with a number of points
/// across.
#[pyfunction]
#[pyo3(signature = (kind, count))]
pub fn pupil_points<'py>(py: Python<'py>, kind: &str, count: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let most = if kind.starts_with("fan") { MAX_POINTS } else { MAX_POINTS.isqrt() };
    if count > most {
        return Err(bad_value(format!(
            "the pupil {kind:?} has a count of {count}: it must be at most {most}."
        )));
    }
    let points = match kind {
        "hexapolar" => hexapolar(count),
        "square" => square(count),
        "fan_x" => fan_x(count),
        "fan_y" => fan_y(count),
        other => {
            return Err(bad_value(format!(
                "the pupil {other:?} does not exist: it must be hexapolar, square, fan_x or fan_y."
            )));
        }
    };
    Ok(pairs(py, &points))
}
