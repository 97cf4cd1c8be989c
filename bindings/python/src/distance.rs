//! Signed distances and nearest boundary points.

use numpy::ndarray::Array2;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};
use rayweave::Vec3;
use rayweave::distance::{DistanceField, DistanceRun, DistanceSettings};
use rayweave::model::RegionId;
use rayweave::model::drive::Cancel;

use crate::engine::{BLOCK, Engine, thread_argument};
use crate::error::bad_value;
use crate::progress::{callback, watched};
use crate::rays::{Columns, Vectors, invalid_input};

/// The distances of points from the boundary, as `rayweave.Distances`: that of the selected regions, or of all without a selection.
pub fn distance<'py>(
    engine: &Engine,
    points: &Bound<'py, PyAny>,
    regions: Option<&[bool]>,
    precision: f64,
    (threads, progress): (Option<&Bound<'py, PyAny>>, Option<&Bound<'py, PyAny>>),
) -> PyResult<Bound<'py, PyAny>> {
    let py = points.py();
    let settings = DistanceSettings { precision, ..DistanceSettings::default() };
    let threads = threads.map(thread_argument).transpose()?;
    let places = checked(points)?;
    let cancel = Cancel::new();
    let found = watched(py, &cancel, callback(py, progress)?, |watch| {
        let field = match regions {
            None => DistanceField::new(&engine.program, settings)?,
            Some(selected) => {
                let is_selected =
                    |region: RegionId| region.index().checked_sub(1).is_some_and(|k| selected[k]);
                DistanceField::of_regions(&engine.program, &is_selected, settings)?
            }
        };
        let mut tell = |done: usize| watch.report(done as u64, places.len() as u64);
        let mut run = DistanceRun { threads, cancel: cancel.clone(), progress: Some(&mut tell) };
        field.distances(&places, &mut run)
    })?;
    let vectors = |rows: Vec<Vec3>| {
        let flat = rows.iter().flat_map(|row| row.to_array()).collect();
        let table = Array2::from_shape_vec((rows.len(), 3), flat).map_err(bad_value)?;
        Ok::<_, PyErr>(PyArray2::from_owned_array(py, table).into_any())
    };
    let numbers = |column: Vec<f64>| PyArray1::from_vec(py, column).into_any();
    let nearest = found.iter().map(|found| found.nearest.unwrap_or(Vec3::NAN)).collect();
    let columns: Bound<'py, PyDict> = [
        ("distance", numbers(found.iter().map(|found| found.signed()).collect())),
        ("lower", numbers(found.iter().map(|found| found.lower).collect())),
        ("upper", numbers(found.iter().map(|found| found.upper).collect())),
        ("is_exact", PyArray1::from_iter(py, found.iter().map(|found| found.is_exact)).into_any()),
        ("nearest", vectors(nearest)?),
        ("point", vectors(places)?),
    ]
    .into_py_dict(py)?;
    py.import("rayweave._distance")?.getattr("Distances")?.call((), Some(&columns))
}

/// The points, all of them finite.
fn checked(points: &Bound<'_, PyAny>) -> PyResult<Vec<Vec3>> {
    let vectors = Vectors::points(points, "points")?;
    let (rows, count) = (vectors.rows(), vectors.len());
    let mut columns = Columns::default();
    let mut places = Vec::with_capacity(count);
    for first in (0..count).step_by(BLOCK) {
        let block = columns.points(rows, first..count.min(first + BLOCK));
        let [x, y, z] = block.ok_or_else(|| invalid_input(&[&vectors]))?;
        places.extend((0..x.len()).map(|k| Vec3::new(x[k], y[k], z[k])));
    }
    Ok(places)
}
