//! Tables of segments and balances of power, as columns by name.

use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayweave::optics::{Balance, Event, Segments};

use crate::error::bad_value;

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

/// Segments from columns by name, in the form of [`columns`].
pub fn rows_of(table: &Bound<'_, PyDict>) -> PyResult<Segments> {
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
    let parents_come_first = segments.parent.iter().zip(0..).all(|(&parent, row)| parent < row);
    if parents_come_first {
        Ok(segments)
    } else {
        Err(bad_value(
            "parent refers to a row that is not before its own: a parent must be an earlier row. Pass the complete trace.",
        ))
    }
}

fn column<T: numpy::Element + Clone>(table: &Bound<'_, PyDict>, name: &str) -> PyResult<Vec<T>> {
    let missing = || bad_value(format!("there is no column {name:?}: pass the complete trace."));
    let array = table.get_item(name)?.ok_or_else(missing)?;
    let array = array.cast::<PyArray1<T>>().map_err(|_| {
        bad_value(format!("the column {name} has a different type: it must be the column of a trace."))
    })?;
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
