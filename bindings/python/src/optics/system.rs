//! Optical systems, and tracing of light through them.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayweave::Packets;
use rayweave::optics::source::Sources;
use rayweave::optics::table::{SegmentFile, trace_light};
use rayweave::optics::{Assembly, Balance, Emitter, RowLimit, Segments, System, TraceSettings, Tracer};

use crate::error::bad_value;
use crate::optics::element::Part;
use crate::optics::light::{LightOptions, beam};
use crate::optics::medium::Substance;
use crate::optics::segments::{accounts, columns, rows_of};
use crate::optics::source::PySource;
use crate::optics::stream::{Batch, PyStream};
use crate::optics::watch::{Halt, Watch};

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
    #[pyo3(signature = (
        origins: "ArrayLike", directions: "ArrayLike", wavelength_nm: "ArrayLike", power: "ArrayLike",
        source: "ArrayLike", stokes: "ArrayLike | None", settings,
        progress: "Callable[[int, int], object] | None" = None
    ) -> "tuple[dict[str, NDArray[Any]], dict[str, Any]]")]
    #[allow(clippy::too_many_arguments)] // those of the function in Python
    fn trace<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        wavelength_nm: &Bound<'py, PyAny>,
        power: &Bound<'py, PyAny>,
        source: Vec<u32>,
        stokes: Option<Vec<[f64; 7]>>,
        settings: LightOptions<'py>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>)> {
        let py = origins.py();
        let beam = beam([origins, directions], [wavelength_nm, power], source, stokes)?;
        let settings = settings.settings()?;
        let (segments, balance) = py.detach(|| self.run(&beam, &settings, progress))?;
        Ok((columns(py, segments)?, accounts(py, &balance)?))
    }

    /// Traces the light of sources: columns by name, and the balance of power.
    #[pyo3(signature = (
        sources, settings, progress: "Callable[[int, int], object] | None" = None
    ) -> "tuple[dict[str, NDArray[Any]], dict[str, Any]]")]
    fn trace_sources<'py>(
        &self,
        py: Python<'py>,
        sources: Vec<PyRef<'py, PySource>>,
        settings: LightOptions<'py>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>)> {
        let (light, settings) = (all(&sources), settings.settings()?);
        let (segments, balance) = py.detach(|| self.run(&light, &settings, progress))?;
        Ok((columns(py, segments)?, accounts(py, &balance)?))
    }

    /// The phases of s- and p-polarised light for the rows of a whole trace with the given columns, in degrees.
    #[pyo3(signature = (columns: "dict[str, NDArray[Any]]"))]
    #[allow(clippy::type_complexity)] // two arrays
    fn phases<'py>(
        &self,
        columns: &Bound<'py, PyDict>,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)> {
        let (py, segments) = (columns.py(), rows_of(columns)?);
        let found = py.detach(|| Tracer::new(&self.system, Packets::new).phases(&segments));
        Ok((PyArray1::from_vec(py, found.s), PyArray1::from_vec(py, found.p)))
    }

    /// Traces the light of sources in the background, in tables of at least `rows` rows.
    #[pyo3(signature = (sources, settings, rows, phases))]
    fn stream(
        &self,
        sources: Vec<PyRef<'_, PySource>>,
        settings: LightOptions<'_>,
        rows: usize,
        phases: bool,
    ) -> PyResult<PyStream> {
        let batch = Batch { rows: rows.max(1), phases };
        Ok(PyStream::start(self.system.clone(), all(&sources), settings.settings()?, batch))
    }

    /// Traces the light of sources into a file, `.csv` or `.npy`, and returns the balance of power. `unit` is that of
    /// lengths.
    #[pyo3(signature = (
        path, unit, sources, settings, phases, progress: "Callable[[int, int], object] | None" = None
    ) -> "dict[str, Any]")]
    #[allow(clippy::too_many_arguments)] // those of the function in Python
    fn trace_to<'py>(
        &self,
        py: Python<'py>,
        path: PathBuf,
        unit: &str,
        sources: Vec<PyRef<'py, PySource>>,
        settings: LightOptions<'py>,
        phases: bool,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (light, settings) = (all(&sources), settings.settings()?);
        let balance = py.detach(|| {
            self.write(SegmentFile { path: &path, unit, phases, part: None }, &light, &settings, progress)
        })?;
        accounts(py, &balance)
    }
}

/// Several sources as one.
fn all(sources: &[PyRef<'_, PySource>]) -> Sources {
    Sources::new(sources.iter().map(|source| source.0.clone()).collect())
}

impl PySystem {
    fn run(
        &self,
        light: &impl Emitter,
        settings: &TraceSettings,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Segments, Balance)> {
        let tracer = Tracer::new(&self.system, Packets::new);
        let (mut segments, mut watch) = (Segments::default(), Watch::new(light, progress));
        let mut limit = RowLimit::new(light, settings).map_err(bad_value)?;
        let balance = tracer.run(light, settings, |part| {
            limit.check(segments.len() + part.len())?;
            segments.append(&part);
            watch.check(&part).map_err(Halt::Raised)
        });
        let balance = balance.map_err(Halt::into_error)?;
        watch.end()?;
        Ok((segments, balance))
    }

    /// Writes the table of segments to a file; after an interrupt there is no file.
    fn write(
        &self,
        out: SegmentFile<'_>,
        light: &impl Emitter,
        settings: &TraceSettings,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Balance> {
        let tracer = Tracer::new(&self.system, Packets::new);
        let (mut watch, mut raised) = (Watch::new(light, progress), None);
        let written = trace_light(&tracer, &self.system, light, settings, Some(out), |part: &Segments| {
            if raised.is_none() {
                raised = watch.check(part).inspect_err(|_| settings.cancel.cancel()).err();
            }
        });
        match (raised, written) {
            (Some(error), _) => Err(error),
            (None, Ok(summary)) => watch.end().map(|()| summary.balance),
            (None, Err(error)) => Err(bad_value(error)),
        }
    }
}
