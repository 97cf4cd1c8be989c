//! Files that appear complete or not at all, for writers in Python.

use std::io::Write;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use rayweave::table::{AtomicFile, TableError};

/// A file that is renamed to its path at `finish`: see `rayweave._files.AtomicFile`.
#[pyclass(frozen, module = "rayweave._core", name = "AtomicFile")]
pub struct PyAtomicFile {
    /// `None` after `finish` and `discard`.
    file: Mutex<Option<AtomicFile>>,
}

impl PyAtomicFile {
    fn lock(&self) -> MutexGuard<'_, Option<AtomicFile>> {
        self.file.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl PyAtomicFile {
    #[new]
    #[pyo3(signature = (path))]
    fn new(path: PathBuf) -> PyResult<Self> {
        let file = AtomicFile::create(path).map_err(failed)?;
        Ok(PyAtomicFile { file: Mutex::new(Some(file)) })
    }

    /// Appends bytes.
    #[pyo3(signature = (data))]
    fn write(&self, py: Python<'_>, data: &[u8]) -> PyResult<()> {
        py.detach(|| {
            let mut file = self.lock();
            let file = file.as_mut().ok_or_else(closed)?;
            let written = file.write_all(data);
            written.map_err(|error| {
                let path = file.target().display().to_string();
                failed(TableError::Io { action: "write", path, error })
            })
        })
    }

    /// Completes the file.
    fn finish(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| self.lock().take().ok_or_else(closed)?.finish().map_err(failed))
    }

    /// Removes what has been written, unless the file is complete.
    fn discard(&self) {
        self.lock().take();
    }
}

fn failed(error: TableError) -> PyErr {
    PyOSError::new_err(error.to_string())
}

fn closed() -> PyErr {
    PyOSError::new_err("the file is closed: nothing can be written to it.")
}
