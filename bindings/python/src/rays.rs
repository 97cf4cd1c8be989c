//! Rays and points on their way in, and the cutting of them into chunks.

use std::ops::Range;

use numpy::ndarray::ArrayView2;
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use rayweave::Ray;
use rayweave::model::Rays;

use crate::arrays::{double_array, shape_text};
use crate::error::bad_value;

/// The greatest component in absolute value.
fn largest(vector: [f64; 3]) -> f64 {
    vector.into_iter().fold(0.0, |most, component| component.abs().max(most))
}

/// Vectors (N, 3), or one vector (3,) that stands for as many as are needed; all components are finite.
pub struct Vectors<'py> {
    rows: PyReadonlyArray2<'py, f64>,
    /// Given as (3,).
    single: bool,
}

impl<'py> Vectors<'py> {
    /// The vectors in an object; `name` is the array's name in messages.
    pub fn new(object: &Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let array = double_array(object, name)?;
        let (rows, single) = match array.shape() {
            [_, 3] => (array.into_any(), false),
            [3] => (array.reshape([1, 3])?.into_any(), true),
            other => {
                let shape = shape_text(other);
                return Err(bad_value(format!("{name} has shape {shape} ((N, 3) or (3,) is needed)")));
            }
        };
        let rows = rows.cast_into::<PyArray2<f64>>()?;
        let vectors = Vectors { rows: rows.try_readonly().map_err(bad_value)?, single };
        // NaN is in no range
        match vectors.position(|v| !v.iter().all(|component| (-Ray::MOST..=Ray::MOST).contains(component))) {
            None => Ok(vectors),
            Some(i) => Err(bad_value(format!(
                "{}: {} (every component must be finite, from {:e} to {:e})",
                vectors.place(name, i),
                vectors.text(i),
                -Ray::MOST,
                Ray::MOST
            ))),
        }
    }

    /// The vectors in an object, none of which may be of length zero.
    pub fn directions(object: &Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let vectors = Self::new(object, name)?;
        match vectors.position(|v| largest(v) < Ray::LEAST) {
            None => Ok(vectors),
            Some(i) => {
                let place = vectors.place(name, i);
                Err(bad_value(match largest(vectors.row(i)) {
                    0.0 => format!("{place}: zero length (a ray must go somewhere)"),
                    _ => {
                        format!("{place}: {} (its length must be at least {:e})", vectors.text(i), Ray::LEAST)
                    }
                }))
            }
        }
    }

    /// The rows (N, 3); N is 1 for a single vector.
    pub fn view(&self) -> ArrayView2<'_, f64> {
        self.rows.as_array()
    }

    /// The number of vectors; 1 for a single one.
    pub fn len(&self) -> usize {
        self.view().nrows()
    }

    /// The first vector of which something is true.
    fn position(&self, is_bad: impl Fn([f64; 3]) -> bool) -> Option<usize> {
        let rows = self.view();
        // one vector broadcast by NumPy: all rows are the same memory
        let count = if rows.strides()[0] == 0 { rows.nrows().min(1) } else { rows.nrows() };
        (0..count).position(|i| is_bad([rows[[i, 0]], rows[[i, 1]], rows[[i, 2]]]))
    }

    fn row(&self, i: usize) -> [f64; 3] {
        let rows = self.view();
        [rows[[i, 0]], rows[[i, 1]], rows[[i, 2]]]
    }

    fn place(&self, name: &str, i: usize) -> String {
        if self.single { name.to_owned() } else { format!("{name}[{i}]") }
    }

    fn text(&self, i: usize) -> String {
        let rows = self.view();
        format!("({:?}, {:?}, {:?})", rows[[i, 0]], rows[[i, 1]], rows[[i, 2]])
    }
}

/// Origins and directions, broadcast to as many rays as the longer of the two has.
#[derive(Clone, Copy)]
pub struct RayRows<'a> {
    origins: ArrayView2<'a, f64>,
    directions: ArrayView2<'a, f64>,
    len: usize,
}

impl<'a> RayRows<'a> {
    /// Both arrays together, if their lengths are equal or one of them is 1.
    pub fn new(origins: &'a Vectors<'_>, directions: &'a Vectors<'_>) -> PyResult<Self> {
        let len = match (origins.len(), directions.len()) {
            (a, b) if a == b => a,
            (1, n) | (n, 1) => n,
            (a, b) => {
                return Err(bad_value(format!(
                    "there are {a} origins and {b} directions (as many of both, or one of either, are needed)"
                )));
            }
        };
        Ok(RayRows { origins: origins.view(), directions: directions.view(), len })
    }

    /// The number of rays.
    pub fn len(&self) -> usize {
        self.len
    }
}

/// Rays or points of one chunk, component by component; kept by each thread.
#[derive(Default)]
pub struct Columns {
    origins: [Vec<f64>; 3],
    directions: [Vec<f64>; 3],
}

impl Columns {
    /// The rays of a chunk.
    pub fn rays(&mut self, rows: RayRows<'_>, chunk: Range<usize>) -> Rays<'_> {
        fill(&mut self.origins, rows.origins, chunk.clone());
        fill(&mut self.directions, rows.directions, chunk);
        Rays { origins: slices(&self.origins), directions: slices(&self.directions) }
    }

    /// The points of a chunk.
    pub fn points(&mut self, points: ArrayView2<'_, f64>, chunk: Range<usize>) -> [&[f64]; 3] {
        fill(&mut self.origins, points, chunk);
        slices(&self.origins)
    }
}

fn slices(columns: &[Vec<f64>; 3]) -> [&[f64]; 3] {
    let [x, y, z] = columns;
    [x, y, z]
}

/// Copies rows of vectors into columns; a single row is repeated.
fn fill(columns: &mut [Vec<f64>; 3], rows: ArrayView2<'_, f64>, chunk: Range<usize>) {
    for (k, column) in columns.iter_mut().enumerate() {
        let values = rows.column(k);
        column.clear();
        if values.len() == 1 {
            column.resize(chunk.len(), values[0]);
        } else {
            column.extend(chunk.clone().map(|i| values[i]));
        }
    }
}
