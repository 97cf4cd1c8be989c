//! Graphics cards: the argument `device`, and their list.

use std::ops::Deref;
use std::str::FromStr;

use pyo3::exceptions::PyRuntimeWarning;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use rayweave::AnyEvaluator;
use rayweave::device::{Device, DeviceEvaluator};

use crate::error::bad_value;

/// The argument `device`.
pub fn device_argument(name: &str) -> PyResult<Device> {
    Device::from_str(name).map_err(|error| {
        let names = Device::NAMES.map(|name| format!("'{name}'")).join(", ");
        let known = rayweave::Message::unknown("device", name, Device::NAMES);
        let hint = known.suggestion().map_or(String::new(), |near| format!(" {near}"));
        match error {
            rayweave::device::DeviceError::UnknownName(_) => {
                bad_value(format!("device is '{name}': it must be one of {names}.{hint}"))
            }
            other => bad_value(other),
        }
    })
}

/// Warns if `auto` uses the CPU.
pub fn warn(py: Python<'_>, reason: Option<&str>) -> PyResult<()> {
    let Some(reason) = reason else { return Ok(()) };
    let text = std::ffi::CString::new(format!("the CPU is used: {reason}")).map_err(bad_value)?;
    PyErr::warn(py, &py.get_type::<PyRuntimeWarning>(), &text, 1)
}

/// The evaluator of a query.
pub enum Chosen<'e> {
    /// One that is kept with the program.
    Kept(&'e AnyEvaluator),
    /// One that is made for the query.
    Made(AnyEvaluator),
    /// One with a device, kept with the program.
    Device(&'e DeviceEvaluator),
}

impl Deref for Chosen<'_> {
    type Target = AnyEvaluator;

    fn deref(&self) -> &AnyEvaluator {
        match self {
            Chosen::Kept(evaluator) => evaluator,
            Chosen::Made(evaluator) => evaluator,
            Chosen::Device(device) => device.evaluator(),
        }
    }
}

impl Chosen<'_> {
    /// Checks after a query that the device has answered it.
    pub fn finish(&self, py: Python<'_>) -> PyResult<()> {
        match self {
            Chosen::Device(device) => warn(py, device.finish().map_err(bad_value)?.as_deref()),
            _ => Ok(()),
        }
    }
}

/// The graphics cards that can trace rays, best first: a list of dicts with "name", "kind", "driver", "largest_table_bytes" and
/// "f64", whether it computes in double precision. It is empty if no driver is installed. An error in a package that was built
/// without the Cargo feature `gpu`.
///
/// >>> import rayweave as rw
/// >>> [card["name"] for card in rw.devices()]  # doctest: +SKIP
/// ['NVIDIA H200']
#[pyfunction]
#[pyo3(signature = () -> "list[dict[str, Any]]")]
pub fn devices(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let list = PyList::empty(py);
    for device in rayweave::device::list().map_err(bad_value)? {
        let row = PyDict::new(py);
        row.set_item("name", device.name)?;
        row.set_item("kind", device.kind)?;
        row.set_item("driver", device.driver)?;
        row.set_item("largest_table_bytes", device.largest_table_bytes)?;
        row.set_item("f64", device.has_f64)?;
        list.append(row)?;
    }
    Ok(list)
}
