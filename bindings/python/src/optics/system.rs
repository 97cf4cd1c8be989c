//! Optical systems and light through them.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayweave::files::{SegmentFile, trace_light};
use rayweave::math::Vec3;
use rayweave::optics::interface::{Film, Stokes};
use rayweave::optics::source::Sources;
use rayweave::optics::{
    Action, Assembly, Balance, Beam, Branches, Element, Emitter, Event, Finish, Light, Material, Medium,
    OpticsError, Segments, Settings, System, Tracer,
};
use rayweave::{Packets, Ray};

use crate::arrays::{double_array, list, shape_text};
use crate::engine::thread_argument;
use crate::error::bad_value;
use crate::optics::component::PySheet;
use crate::optics::file::PyElement;
use crate::optics::glass::PyGlass;
use crate::optics::gradient::PyGradedMedium;
use crate::optics::source::PySource;
use crate::optics::stream::{Batch, PyStream};
use crate::solid::PySolid;

/// A glass, a constant index n + i k, or either with a gradient.
#[derive(FromPyObject)]
pub enum Substance<'py> {
    Glass(PyRef<'py, PyGlass>),
    Graded(PyRef<'py, PyGradedMedium>),
    Constant(f64, f64),
}

impl Substance<'_> {
    pub fn medium(&self) -> PyResult<Medium> {
        match self {
            Substance::Graded(medium) => Ok(medium.0.clone()),
            Substance::Glass(glass) => Ok(Medium::from(glass.0.clone())),
            Substance::Constant(n, k) => {
                let name = if *k == 0.0 { format!("index {n}") } else { format!("index {n} + {k} i") };
                Medium::constant(&name, *n, *k).map_err(bad_value)
            }
        }
    }
}

/// A kind with its numbers.
#[derive(FromPyObject)]
pub struct Spec(String, Vec<f64>);

impl Spec {
    /// What it is.
    pub fn kind(&self) -> &str {
        &self.0
    }

    /// Its numbers.
    pub fn numbers(&self) -> &[f64] {
        &self.1
    }

    /// The finish.
    pub fn finish(&self) -> PyResult<Finish> {
        Ok(match (self.0.as_str(), self.1.as_slice()) {
            ("polished", []) => Finish::Polished,
            ("absorber", []) => Finish::Absorber,
            ("mirror", &[reflectance]) => Finish::Mirror { reflectance },
            ("splitter", &[reflectance]) => Finish::Splitter { reflectance },
            ("diffuse", &[reflectance]) => Finish::Diffuse { reflectance },
            ("rough", &[slope]) => Finish::Rough { slope },
            ("coated", films) if films.len() % 3 == 0 => {
                let film = |film: &[f64]| Film::new(film[0], film[1], film[2]);
                Finish::Coated(films.chunks_exact(3).map(film).collect())
            }
            (kind, numbers) => return Err(unknown("finish", kind, numbers)),
        })
    }

    fn action(&self) -> PyResult<Action> {
        Ok(match (self.0.as_str(), self.1.as_slice()) {
            ("absorb", []) => Action::Absorb,
            ("record", []) => Action::Record,
            ("mirror", &[reflectance]) => Action::Mirror { reflectance },
            ("splitter", &[reflectance]) => Action::Splitter { reflectance },
            ("thin_lens", &[focal_length]) => Action::ThinLens { focal_length },
            ("grating", &[x, y, order, reflects]) => Action::Grating {
                lines: Vec3::new(x, y, 0.0),
                order: order as i32,
                reflects: reflects != 0.0,
            },
            ("polariser", &[x, y]) => Action::Polariser { axis: Vec3::new(x, y, 0.0) },
            ("retarder", &[x, y, retardance_degrees]) => {
                Action::Retarder { axis: Vec3::new(x, y, 0.0), retardance_degrees }
            }
            (kind, numbers) => return Err(unknown("action", kind, numbers)),
        })
    }
}

fn unknown(what: &str, kind: &str, numbers: &[f64]) -> PyErr {
    bad_value(format!("there is no {what} {kind:?} with {} numbers", numbers.len()))
}

/// An element as Python describes it: a solid with its material ("transparent", "opaque" or "metal"), or a sheet.
#[derive(FromPyObject)]
pub enum Part<'py> {
    Solid(String, PyRef<'py, PySolid>, String, Option<Substance<'py>>, Spec, Vec<(String, Spec)>),
    Sheet(String, PyRef<'py, PySheet>, Spec),
    /// As a model file says it.
    Read(String, PyRef<'py, PyElement>),
}

impl Part<'_> {
    fn element(&self) -> PyResult<Element> {
        match self {
            Part::Read(name, element) => Ok(element.0.clone().named(name)),
            Part::Sheet(name, sheet, action) => Ok(Element::sheet(name, sheet.0.clone(), action.action()?)),
            Part::Solid(name, solid, kind, substance, finish, faces) => {
                let medium = substance.as_ref().map(Substance::medium).transpose()?;
                let material = match (kind.as_str(), medium) {
                    ("opaque", None) => Material::Opaque,
                    ("transparent", Some(medium)) => Material::Transparent(medium),
                    ("metal", Some(medium)) => Material::Metal(medium),
                    (kind, _) => return Err(unknown("material", kind, &[])),
                };
                let element = Element::new(name, solid.solid().clone(), material).finish(finish.finish()?);
                faces
                    .iter()
                    .try_fold(element, |element, (face, finish)| Ok(element.face(face, finish.finish()?)))
            }
        }
    }
}

/// An optical system, compiled: see `rayweave.optics.System`.
#[pyclass(frozen, module = "rayweave.optics", name = "CompiledSystem")]
pub struct PySystem {
    pub system: Arc<System>,
}

#[pymethods]
impl PySystem {
    #[new]
    #[pyo3(signature = (parts, world, unit_nm))]
    fn new(py: Python<'_>, parts: Vec<Part<'_>>, world: Substance<'_>, unit_nm: f64) -> PyResult<Self> {
        let assembly = Assembly::new().world(world.medium()?).unit_nm(unit_nm);
        let assembly =
            parts.iter().try_fold(assembly, |all, part| Ok::<Assembly, PyErr>(all.add(part.element()?)))?;
        let system = py.detach(|| assembly.compile()).map_err(bad_value)?;
        Ok(PySystem { system: Arc::new(system) })
    }

    /// The names of the elements.
    #[getter]
    fn element_names(&self) -> Vec<String> {
        self.system.element_names().to_vec()
    }

    /// The names of all surfaces.
    #[getter]
    fn surface_names(&self) -> Vec<String> {
        self.system.surfaces().map(|surface| self.system.surface_name(surface).to_owned()).collect()
    }

    /// Traces rays: columns by name, and the balance of power.
    #[pyo3(signature = (origins, directions, wavelength_nm, power, source, stokes, settings, progress=None))]
    #[allow(clippy::too_many_arguments)] // those of the function in Python
    fn trace<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        wavelength_nm: &Bound<'py, PyAny>,
        power: &Bound<'py, PyAny>,
        source: Vec<u32>,
        stokes: Option<Vec<[f64; 7]>>,
        settings: Wishes<'py>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>)> {
        let py = origins.py();
        let beam = beam([origins, directions], [wavelength_nm, power], source, stokes)?;
        let settings = settings.settings()?;
        let (segments, balance) = py.detach(|| self.run(&beam, &settings, progress))?;
        Ok((columns(py, segments)?, accounts(py, &balance)?))
    }

    /// Traces the light of sources: columns by name, and the balance of power.
    #[pyo3(signature = (sources, settings, progress=None))]
    fn trace_sources<'py>(
        &self,
        py: Python<'py>,
        sources: Vec<PyRef<'py, PySource>>,
        settings: Wishes<'py>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>)> {
        let (light, settings) = (all(&sources), settings.settings()?);
        let (segments, balance) = py.detach(|| self.run(&light, &settings, progress))?;
        Ok((columns(py, segments)?, accounts(py, &balance)?))
    }

    /// The phases of s and p of the rows of a whole trace, whose columns are given, in degrees.
    #[pyo3(signature = (columns))]
    #[allow(clippy::type_complexity)] // two arrays
    fn phases<'py>(
        &self,
        columns: &Bound<'py, PyDict>,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)> {
        let (py, segments) = (columns.py(), rows_of(columns)?);
        let found = py.detach(|| Tracer::new(&self.system, Packets::new).phases(&segments));
        Ok((PyArray1::from_vec(py, found.s), PyArray1::from_vec(py, found.p)))
    }

    /// Traces the light of sources in the background, in tables of at least so many rows.
    #[pyo3(signature = (sources, settings, rows, phases))]
    fn stream(
        &self,
        sources: Vec<PyRef<'_, PySource>>,
        settings: Wishes<'_>,
        rows: usize,
        phases: bool,
    ) -> PyResult<PyStream> {
        let batch = Batch { rows: rows.max(1), phases };
        Ok(PyStream::start(self.system.clone(), all(&sources), settings.settings()?, batch))
    }

    /// Traces the light of sources into a file, `.csv` or `.npy`; lengths are in a unit. The balance of power.
    #[pyo3(signature = (path, unit, sources, settings, phases, progress=None))]
    #[allow(clippy::too_many_arguments)] // those of the function in Python
    fn trace_to<'py>(
        &self,
        py: Python<'py>,
        path: PathBuf,
        unit: &str,
        sources: Vec<PyRef<'py, PySource>>,
        settings: Wishes<'py>,
        phases: bool,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (light, settings) = (all(&sources), settings.settings()?);
        let balance =
            py.detach(|| self.write(SegmentFile { path: &path, unit, phases }, &light, &settings, progress))?;
        accounts(py, &balance)
    }
}

/// Several sources as one.
fn all(sources: &[PyRef<'_, PySource>]) -> Sources {
    Sources::new(sources.iter().map(|source| source.0.clone()).collect())
}

/// Settings as Python has them.
#[derive(FromPyObject)]
pub struct Wishes<'py> {
    #[pyo3(item)]
    branches: String,
    #[pyo3(item)]
    polarised: bool,
    #[pyo3(item)]
    generation_limit: u32,
    #[pyo3(item)]
    threshold: f64,
    #[pyo3(item)]
    keep_escaped: bool,
    #[pyo3(item)]
    seed: u64,
    #[pyo3(item)]
    threads: Option<Bound<'py, PyAny>>,
}

impl Wishes<'_> {
    fn settings(&self) -> PyResult<Settings> {
        Ok(Settings {
            branches: branches_named(&self.branches)?,
            polarised: self.polarised,
            generation_limit: self.generation_limit,
            threshold: self.threshold,
            keep_escaped: self.keep_escaped,
            seed: self.seed,
            threads: self.threads.as_ref().map(thread_argument).transpose()?,
            ..Settings::default()
        })
    }
}

impl PySystem {
    fn run(
        &self,
        light: &impl Emitter,
        settings: &Settings,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Segments, Balance)> {
        let tracer = Tracer::new(&self.system, Packets::new);
        let (mut segments, mut watch) = (Segments::default(), Watch::new(light, progress));
        let balance = tracer.run(light, settings, |part| {
            segments.append(&part);
            watch.look(&part).map_err(Halt::Raised)
        });
        let balance = balance.map_err(Halt::into_error)?;
        watch.end()?;
        Ok((segments, balance))
    }

    /// The table of segments as a file; after an interrupt there is none.
    fn write(
        &self,
        out: SegmentFile<'_>,
        light: &impl Emitter,
        settings: &Settings,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Balance> {
        let tracer = Tracer::new(&self.system, Packets::new);
        let (mut watch, mut raised) = (Watch::new(light, progress), None);
        let written = trace_light(&tracer, &self.system, light, settings, Some(out), |part: &Segments| {
            if raised.is_none() {
                raised = watch.look(part).inspect_err(|_| settings.cancel.cancel()).err();
            }
        });
        match (raised, written) {
            (Some(error), _) => Err(error),
            (None, Ok(summary)) => watch.end().map(|()| summary.balance),
            (None, Err(error)) => Err(bad_value(error)),
        }
    }
}

/// Tells Python how far a run is, and looks at its signals.
struct Watch {
    progress: Option<Py<PyAny>>,
    total: usize,
    last: Instant,
}

/// So often progress is told.
const TELL: Duration = Duration::from_millis(100);

impl Watch {
    fn new(light: &impl Emitter, progress: Option<Py<PyAny>>) -> Watch {
        Watch { progress, total: light.count(), last: Instant::now() }
    }

    /// Called chunk by chunk.
    fn look(&mut self, part: &Segments) -> PyResult<()> {
        let done = part.id.iter().max().map_or(0, |&last| last + 1);
        Python::attach(|py| {
            py.check_signals()?;
            match &self.progress {
                Some(progress) if self.last.elapsed() >= TELL => {
                    self.last = Instant::now();
                    progress.call1(py, (done, self.total)).map(|_| ())
                }
                _ => Ok(()),
            }
        })
    }

    /// All is done.
    fn end(&self) -> PyResult<()> {
        let Some(progress) = &self.progress else { return Ok(()) };
        Python::attach(|py| progress.call1(py, (self.total, self.total)).map(|_| ()))
    }
}

/// Why a run ends early.
enum Halt {
    Refused(OpticsError),
    Raised(PyErr),
}

impl From<OpticsError> for Halt {
    fn from(error: OpticsError) -> Halt {
        Halt::Refused(error)
    }
}

impl Halt {
    fn into_error(self) -> PyErr {
        match self {
            Halt::Refused(OpticsError::Cancelled) => PyKeyboardInterrupt::new_err("cancelled"),
            Halt::Refused(error) => bad_value(error),
            Halt::Raised(error) => error,
        }
    }
}

fn branches_named(name: &str) -> PyResult<Branches> {
    match name {
        "ideal" => Ok(Branches::Ideal),
        "both" => Ok(Branches::Both),
        "random" => Ok(Branches::Random),
        other => {
            Err(bad_value(format!("branches is {other:?} (it can be \"ideal\", \"both\" or \"random\")")))
        }
    }
}

/// The light in arrays of one length: rays (N, 3), everything else (N,).
fn beam(
    rays: [&Bound<'_, PyAny>; 2],
    light: [&Bound<'_, PyAny>; 2],
    source: Vec<u32>,
    stokes: Option<Vec<[f64; 7]>>,
) -> PyResult<Beam> {
    let origins = vectors(rays[0], "origins")?;
    let directions = vectors(rays[1], "directions")?;
    let (wavelengths, powers) = (list(light[0], "wavelength_nm")?, list(light[1], "power")?);
    let count = origins.len();
    let lengths = [
        ("directions", directions.len()),
        ("wavelength_nm", wavelengths.len()),
        ("power", powers.len()),
        ("source", source.len()),
        ("stokes", stokes.as_ref().map_or(count, Vec::len)),
    ];
    if let Some((column, found)) = lengths.into_iter().find(|(_, length)| *length != count) {
        return Err(bad_value(OpticsError::Length { column, found, expected: count }));
    }
    let light = |i: usize| Light {
        ray: Ray::new(origins[i], directions[i]),
        wavelength_nm: wavelengths[i],
        power: powers[i],
        source: source[i],
        stokes: stokes.as_ref().map(|rows| polarisation(&rows[i])),
    };
    Ok((0..count).map(light).collect())
}

/// The four parameters and the axis.
fn polarisation(&[i, q, u, v, x, y, z]: &[f64; 7]) -> Stokes {
    Stokes { parameters: [i, q, u, v], axis: Vec3::new(x, y, z) }
}

/// The rows of an array (N, 3).
pub fn vectors(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<Vec3>> {
    let array = double_array(object, name)?;
    let [_, 3] = *array.shape() else {
        return Err(bad_value(format!("{name} has shape {} ((N, 3) is needed)", shape_text(array.shape()))));
    };
    let array = array.try_readonly().map_err(bad_value)?;
    let row = |row: numpy::ndarray::ArrayView1<'_, f64>| Vec3::new(row[0], row[1], row[2]);
    let view = array.as_array().into_dimensionality::<numpy::ndarray::Ix2>().map_err(bad_value)?;
    Ok(view.rows().into_iter().map(row).collect())
}

/// The columns of segments by their names.
pub fn columns(py: Python<'_>, segments: Segments) -> PyResult<Bound<'_, PyDict>> {
    let table = PyDict::new(py);
    table.set_item("id", PyArray1::from_vec(py, segments.id))?;
    table.set_item("parent", PyArray1::from_vec(py, segments.parent))?;
    table.set_item("generation", PyArray1::from_vec(py, segments.generation))?;
    table.set_item("source", PyArray1::from_vec(py, segments.source))?;
    table.set_item("wavelength_nm", PyArray1::from_vec(py, segments.wavelength_nm))?;
    table.set_item("intensity", PyArray1::from_vec(py, segments.intensity))?;
    table.set_item("index", PyArray1::from_vec(py, segments.index))?;
    let vectors = [
        (["x0", "y0", "z0"], segments.start),
        (["x1", "y1", "z1"], segments.end),
        (["x_tilt", "y_tilt", "z_tilt"], segments.direction),
    ];
    for (names, columns) in vectors {
        for (name, column) in names.into_iter().zip(columns) {
            table.set_item(name, PyArray1::from_vec(py, column))?;
        }
    }
    table.set_item("path", PyArray1::from_vec(py, segments.path))?;
    table.set_item("element", PyArray1::from_vec(py, segments.element))?;
    table.set_item("surface", PyArray1::from_vec(py, segments.surface))?;
    table.set_item("event", PyArray1::from_vec(py, segments.event))?;
    Ok(table)
}

/// Segments from columns by name, as [`columns`] gives them.
fn rows_of(table: &Bound<'_, PyDict>) -> PyResult<Segments> {
    let vectors = [["x0", "y0", "z0"], ["x1", "y1", "z1"], ["x_tilt", "y_tilt", "z_tilt"]];
    let [start, end, direction] = vectors.map(|names| -> PyResult<[Vec<f64>; 3]> {
        let [x, y, z] = names.map(|name| column(table, name));
        Ok([x?, y?, z?])
    });
    let segments = Segments {
        id: column(table, "id")?,
        parent: column(table, "parent")?,
        generation: column(table, "generation")?,
        source: column(table, "source")?,
        wavelength_nm: column(table, "wavelength_nm")?,
        intensity: column(table, "intensity")?,
        index: column(table, "index")?,
        start: start?,
        end: end?,
        direction: direction?,
        path: column(table, "path")?,
        element: column(table, "element")?,
        surface: column(table, "surface")?,
        event: column(table, "event")?,
    };
    let last = segments.parent.iter().zip(0..).all(|(&parent, row)| parent < row);
    if last {
        Ok(segments)
    } else {
        Err(bad_value("parent names a row that is not before its own (all rows of a trace are needed)"))
    }
}

fn column<T: numpy::Element + Clone>(table: &Bound<'_, PyDict>, name: &str) -> PyResult<Vec<T>> {
    let missing = || bad_value(format!("there is no column {name:?}"));
    let array = table.get_item(name)?.ok_or_else(missing)?;
    let array = array.cast::<PyArray1<T>>().map_err(|_| bad_value(format!("{name} is of another type")))?;
    Ok(array.try_readonly().map_err(bad_value)?.as_array().to_vec())
}

/// A balance as a table.
pub fn accounts<'py>(py: Python<'py>, balance: &Balance) -> PyResult<Bound<'py, PyDict>> {
    let table = PyDict::new(py);
    table.set_item("emitted", balance.emitted)?;
    table.set_item("absorbed", balance.absorbed.clone())?;
    table.set_item("absorbed_in_media", balance.absorbed_in_media)?;
    table.set_item("escaped", balance.escaped)?;
    table.set_item("dropped", balance.dropped)?;
    Ok(table)
}

/// The names of events by their numbers.
#[pyfunction]
pub fn event_names() -> Vec<&'static str> {
    Event::ALL.iter().map(|event| event.name()).collect()
}
