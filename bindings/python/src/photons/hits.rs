//! Detected photons as arrays, files and drawings.

use std::borrow::Cow;
use std::collections::HashSet;
use std::path::PathBuf;
use std::sync::Arc;

use numpy::ndarray::Array3;
use numpy::{PyArray1, PyArray3};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayweave::detector::{Histogram, HitPositions, MapPlane, MapScale, histograms_svg, hit_maps_svg};
use rayweave::photon::{Hits, hit_table, opticks_photons};
use rayweave::table::TableError;

use crate::error::bad_value;
use crate::photons::parts::DetectorParts;

/// The detected photons of a run: see `rayweave.photons.Hits`.
#[pyclass(frozen, module = "rayweave.photons", name = "PhotonHits")]
pub struct PyPhotonHits {
    pub hits: Hits,
    /// The masks of flags, if histories are recorded.
    pub flags: Option<Vec<u32>>,
    pub detector: Arc<DetectorParts>,
}

#[pymethods]
impl PyPhotonHits {
    /// The columns by name.
    #[pyo3(signature = () -> "dict[str, NDArray[Any]]")]
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let hits = &self.hits;
        let table = PyDict::new(py);
        table.set_item("event", PyArray1::from_slice(py, &hits.event))?;
        table.set_item("photon", PyArray1::from_slice(py, &hits.photon))?;
        let vectors = [
            (["x", "y", "z"], &hits.position),
            (["dx", "dy", "dz"], &hits.direction),
            (["px", "py", "pz"], &hits.polarisation),
        ];
        for (k, (names, columns)) in vectors.into_iter().enumerate() {
            for (name, column) in names.into_iter().zip(columns) {
                table.set_item(name, PyArray1::from_slice(py, column))?;
            }
            // in the order of the command's table
            if k == 0 {
                table.set_item("time", PyArray1::from_slice(py, &hits.time))?;
            }
        }
        table.set_item("wavelength_nm", PyArray1::from_slice(py, &hits.wavelength_nm))?;
        table.set_item("steps", PyArray1::from_slice(py, &hits.steps))?;
        let sensor = hits.sensor.iter().map(|&sensor| sensor as i32);
        table.set_item("sensor", PyArray1::from_iter(py, sensor))?;
        let copies = hits.sensor.iter().map(|&sensor| hits.copies()[sensor as usize]);
        table.set_item("copy", PyArray1::from_iter(py, copies))?;
        if let Some(gensteps) = &hits.genstep {
            table.set_item("genstep", PyArray1::from_slice(py, gensteps))?;
        }
        Ok(table)
    }

    /// The paths of the sensors, in the order of their placements.
    #[getter]
    fn sensor_paths(&self) -> Vec<String> {
        self.hits.paths().iter().map(ToString::to_string).collect()
    }

    /// The photons in the layout of Opticks, as the bits of float32 numbers.
    #[pyo3(signature = () -> "NDArray[np.uint32]")]
    fn opticks<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<u32>> {
        let words = opticks_photons(&self.hits, self.flags.as_deref(), |sensor| sensor).flatten();
        let array = Array3::from_shape_vec((self.hits.len(), 4, 4), words.collect());
        // the number of words is that of the shape
        PyArray3::from_owned_array(py, array.unwrap_or_default())
    }

    /// Writes the table of hits of the command: .csv, .npy or .parquet.
    #[pyo3(signature = (path))]
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let write = || -> Result<(), TableError> {
            let mut table = hit_table(&path, &self.detector.detector, self.hits.genstep.is_some())?;
            table.write(&self.hits.to_rows()?)?;
            table.finish().map(|_| ())
        };
        py.detach(write).map_err(bad_value)
    }

    /// Some of the hits by their rows.
    fn select(&self, rows: Vec<usize>) -> PyResult<PyPhotonHits> {
        if let Some(row) = rows.iter().find(|row| **row >= self.hits.len()) {
            return Err(bad_value(format!("there is no row {row}: there are {} hits.", self.hits.len())));
        }
        let flags = self.flags.as_ref().map(|flags| rows.iter().map(|&row| flags[row]).collect());
        Ok(PyPhotonHits { hits: self.hits.select(&rows), flags, detector: self.detector.clone() })
    }

    /// The numbers of the sensors whose path ends with a text, or of all sensors ("all").
    fn sensors_named(&self, text: &str) -> PyResult<Vec<u32>> {
        self.hits.sensors_named(text).map_err(bad_value)
    }

    /// Maps of the hits of each sensor as SVG, with a number of cells along their longer side, a plane of all maps, and the scale of the
    /// colours.
    #[pyo3(signature = (title, cells = None, plane = None, scale = "linear", chosen = None))]
    fn map_svg(
        &self,
        py: Python<'_>,
        title: &str,
        cells: Option<usize>,
        plane: Option<&str>,
        scale: &str,
        chosen: Option<Vec<u32>>,
    ) -> PyResult<String> {
        let scale = scale.parse::<MapScale>().map_err(bad_value)?;
        let plane = plane.map(str::parse::<MapPlane>).transpose().map_err(bad_value)?;
        let [x, y, z] = &self.hits.position;
        let (names, sensors) = (self.hits.paths(), &self.hits.sensor);
        let extents = self.detector.detector.sensor_extents();
        let (positions, chosen) = ([&x[..], y, z], chosen.as_deref());
        let hits = HitPositions { names, sensors, positions, extents, cells, plane, scale, chosen };
        Ok(py.detach(|| hit_maps_svg(hits, title, "mm")))
    }

    /// Spectra of times and wavelengths as SVG, with a number of bins and the range of times, of all hits or those of some sensors.
    #[pyo3(signature = (title, bins, time, chosen))]
    fn spectra_svg(
        &self,
        py: Python<'_>,
        title: &str,
        bins: Option<usize>,
        time: Option<(f64, f64)>,
        chosen: Option<Vec<u32>>,
    ) -> String {
        let chosen = chosen.map(|sensors| sensors.into_iter().collect::<HashSet<u32>>());
        let selected = |values| match &chosen {
            None => Cow::Borrowed(values),
            Some(sensors) => Cow::Owned(self.of_sensors(values, sensors)),
        };
        let times = selected(self.hits.time.as_slice());
        let wavelengths = selected(self.hits.wavelength_nm.as_slice());
        let range = time.map(<[f64; 2]>::from);
        let time = Histogram { bins, range, ..Histogram::new("time", "ns", &times) };
        let wavelength =
            Histogram { is_wavelength: true, bins, ..Histogram::new("wavelength", "nm", &wavelengths) };
        py.detach(|| histograms_svg(&[time, wavelength], title))
    }
}

impl PyPhotonHits {
    /// The values of the hits of some sensors.
    fn of_sensors(&self, values: &[f64], sensors: &HashSet<u32>) -> Vec<f64> {
        let hits = values.iter().zip(&self.hits.sensor);
        hits.filter(|(_, own)| sensors.contains(own)).map(|(value, _)| *value).collect()
    }
}
