//! Histories of photons as arrays and drawings.

use std::collections::HashSet;
use std::path::PathBuf;
use std::sync::Arc;

use numpy::ndarray::Array2;
use numpy::{Element, PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayweave::Vec3;
use rayweave::layout::{LayoutPlane, OpticalLayout};
use rayweave::photon::{Histories, Process, StepRow, sequence_text, step_schema};
use rayweave::table::{TableError, TableWriter};

use crate::error::bad_value;
use crate::photons::parts::DetectorParts;

/// Photons, tracks and words of sequences.
type Sequences<'py> =
    (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray2<u64>>, Vec<String>);

/// The histories of a run: see `rayweave.photons.Histories`.
#[pyclass(frozen, module = "rayweave.photons", name = "PhotonHistories")]
pub struct PyHistories {
    histories: Histories,
    detector: Arc<DetectorParts>,
}

impl PyHistories {
    pub fn new(histories: Histories, detector: Arc<DetectorParts>) -> PyHistories {
        PyHistories { histories, detector }
    }

    fn column<'py, T: Element>(
        &self,
        py: Python<'py>,
        value: impl Fn(&StepRow) -> T,
    ) -> Bound<'py, PyArray1<T>> {
        PyArray1::from_iter(py, self.histories.steps.iter().map(value))
    }
}

#[pymethods]
impl PyHistories {
    /// The columns of the steps by name.
    #[pyo3(signature = () -> "dict[str, NDArray[Any]]")]
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let table = PyDict::new(py);
        table.set_item("photon", self.column(py, |row| row.photon))?;
        table.set_item("track", self.column(py, |row| row.track))?;
        table.set_item("step", self.column(py, |row| i64::from(row.step)))?;
        table.set_item("process", self.column(py, |row| row.process.number() as i32))?;
        let vector = |names: [&str; 3], vector: fn(&StepRow) -> Vec3| {
            let set = |(k, name)| table.set_item(name, self.column(py, |row| vector(row).to_array()[k]));
            names.into_iter().enumerate().try_for_each(set)
        };
        vector(["x", "y", "z"], |row| row.position)?;
        table.set_item("time", self.column(py, |row| row.time))?;
        vector(["dx", "dy", "dz"], |row| row.direction)?;
        vector(["px", "py", "pz"], |row| row.polarisation)?;
        table.set_item("wavelength_nm", self.column(py, |row| row.wavelength_nm))?;
        table.set_item("volume", self.column(py, |row| row.volume as i32))?;
        table.set_item("surface", self.column(py, |row| row.surface.map_or(-1, |number| number as i32)))?;
        Ok(table)
    }

    /// The names of the processes, by their numbers.
    #[getter]
    fn process_names(&self) -> Vec<&'static str> {
        Process::ALL.iter().map(|process| process.name()).collect()
    }

    /// The paths of the volumes, by their numbers.
    #[getter]
    fn volume_paths(&self) -> Vec<String> {
        self.histories.volumes().iter().map(ToString::to_string).collect()
    }

    /// The names of the optical surfaces, by their numbers.
    #[getter]
    fn surface_names(&self) -> Vec<String> {
        self.detector.detector.surfaces().iter().map(|surface| surface.name.clone()).collect()
    }

    /// The sequences: photons, tracks, words (N, 2), texts.
    #[pyo3(signature = () -> "tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.uint64], list[str]]")]
    fn sequences<'py>(&self, py: Python<'py>) -> Sequences<'py> {
        let list = &self.histories.sequences;
        let words = Array2::from_shape_fn((list.len(), 2), |(row, k)| list[row].words[k]);
        (
            PyArray1::from_iter(py, list.iter().map(|sequence| sequence.photon)),
            PyArray1::from_iter(py, list.iter().map(|sequence| sequence.track)),
            PyArray2::from_owned_array(py, words),
            list.iter().map(|sequence| sequence_text(sequence.words)).collect(),
        )
    }

    /// The number of processes by name.
    #[getter]
    fn processes(&self) -> Vec<(&'static str, u64)> {
        self.histories.processes.iter().map(|(process, count)| (process.name(), *count)).collect()
    }

    /// The number of events at each optical surface (None: a bare interface): surface, process, number.
    #[getter]
    fn surfaces(&self) -> Vec<(Option<u32>, &'static str, u64)> {
        let rows = self.histories.surfaces.iter();
        rows.map(|((surface, process), count)| (*surface, process.name(), *count)).collect()
    }

    /// Writes the table of steps of the command: .csv, .npy or .parquet.
    #[pyo3(signature = (path))]
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let write = || -> Result<(), TableError> {
            let mut table = TableWriter::create(&path, &step_schema(&self.detector.detector)?)?;
            table.write(&self.histories.to_rows()?)?;
            table.finish().map(|_| ())
        };
        py.detach(write).map_err(bad_value)
    }

    /// The tracks in a section of the detector, as SVG: all of them, or those of some photons.
    #[pyo3(signature = (title, plane = None, photons: "list[int] | None" = None))]
    fn tracks_svg(
        &self,
        py: Python<'_>,
        title: &str,
        plane: Option<&str>,
        photons: Option<Vec<i64>>,
    ) -> PyResult<String> {
        let plane = plane.map(str::parse::<LayoutPlane>).transpose().map_err(bad_value)?;
        let DetectorParts { detector, evaluator, .. } = &*self.detector;
        let draw = || {
            let chosen: Option<HashSet<i64>> = photons.map(|own| own.into_iter().collect());
            let chosen = chosen.map(|own| {
                let mut histories = Histories::default();
                let steps = self.histories.steps.iter().filter(|row| own.contains(&row.photon));
                histories.steps = steps.copied().collect();
                histories
            });
            let histories = chosen.as_ref().unwrap_or(&self.histories);
            let layout = OpticalLayout::of_light(
                evaluator,
                |region| detector.medium(region),
                histories.to_segments(),
                plane,
            );
            let points = histories.detections().map(|row| row.position);
            let sensors = detector.sensors().map(|(region, _)| region);
            layout
                .map(|layout| layout.with_sensors(sensors).with_marks("detected", points).to_svg(title, "mm"))
        };
        py.detach(draw).map_err(bad_value)
    }
}
