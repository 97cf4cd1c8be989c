//! Hits: when rays enter and leave a solid, as hit arrays.

use std::ops::Range;

use numpy::ndarray::Array2;
use numpy::{PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use rayweave::model::{Evaluator, Program, Query, RayAnswer, Window};

use crate::arrays::{room, shape_text};
use crate::engine::{Engine, How, Question, inside, surface};
use crate::error::{bad_type, bad_value};
use crate::rays::{Columns, RayRows, Vectors};

/// Entries and exits of every ray.
struct HitsQuestion<'a> {
    rays: RayRows<'a>,
    window: Window,
    surfaces: bool,
}

/// For each ray how many entries it has below +inf, and those entries one after the other.
#[derive(Default)]
struct Hits {
    counts: Vec<usize>,
    times: Vec<f64>,
    surfaces: Vec<i32>,
}

impl Hits {
    fn push(&mut self, program: &Program, answer: &RayAnswer<'_>, surfaces: bool) {
        let before = self.times.len();
        let mut state = inside(program, answer.start);
        if state {
            self.times.push(f64::NEG_INFINITY);
            self.surfaces.extend(surfaces.then_some(-1));
        }
        for crossing in answer.crossings {
            // from one medium to another: still inside
            if inside(program, crossing.after) != state {
                state = !state;
                self.times.push(crossing.t);
                self.surfaces.extend(surfaces.then(|| surface(program, crossing)));
            }
        }
        self.counts.push(self.times.len() - before);
    }

    fn append(&mut self, mut other: Hits) {
        self.counts.append(&mut other.counts);
        self.times.append(&mut other.times);
        self.surfaces.append(&mut other.surfaces);
    }

    /// The least even number of rows, at least 2, that holds every column.
    fn rows(&self) -> usize {
        self.counts.iter().copied().max().unwrap_or(0).next_multiple_of(2).max(2)
    }

    /// Writes entries column by column, rows in order; `put` takes row, column and the number of the entry.
    fn scatter(&self, mut put: impl FnMut(usize, usize, usize)) {
        let mut entry = 0;
        for (column, &count) in self.counts.iter().enumerate() {
            (0..count).for_each(|row| put(row, column, entry + row));
            entry += count;
        }
    }
}

impl Question for HitsQuestion<'_> {
    type Answer = Hits;
    type Scratch = Columns;

    fn len(&self) -> usize {
        self.rays.len()
    }

    fn answer<E: Evaluator>(
        &self,
        evaluator: &E,
        chunk: Range<usize>,
        memory: &mut E::Scratch,
        columns: &mut Columns,
    ) -> Hits {
        let query = Query { window: self.window, ..Query::default() };
        let mut hits = Hits::default();
        let mut sink = |answer: RayAnswer<'_>| hits.push(evaluator.program(), &answer, self.surfaces);
        evaluator.crossings(columns.rays(self.rays, chunk), &query, memory, &mut sink);
        hits
    }
}

/// A (rows, columns) array filled with one value, or a `MemoryError`.
fn filled<T: Clone>(rows: usize, columns: usize, value: T) -> PyResult<Array2<T>> {
    let len = rows.checked_mul(columns).ok_or_else(|| PyMemoryError::new_err("the result is too large"))?;
    let mut data = room(len)?;
    data.resize(len, value);
    Array2::from_shape_vec((rows, columns), data).map_err(bad_value)
}

/// The hits of every ray as an array (H, N), and the surfaces hit if they are asked for.
pub fn hits<'py>(
    engine: &Engine,
    [origins, directions]: [&Bound<'py, PyAny>; 2],
    how: &How,
    surfaces: bool,
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = origins.py();
    let (origins, directions) =
        (Vectors::new(origins, "origins")?, Vectors::directions(directions, "directions")?);
    let question = HitsQuestion { rays: RayRows::new(&origins, &directions)?, window: how.window, surfaces };
    let mut hits = Hits { counts: room(question.len())?, ..Hits::default() };
    engine.ask(py, how, &question, |chunk| hits.append(chunk))?;
    let (times, rows) = match out {
        None => {
            let mut times = filled(hits.rows(), hits.counts.len(), f64::INFINITY)?;
            py.detach(|| hits.scatter(|row, column, entry| times[[row, column]] = hits.times[entry]));
            let rows = times.nrows();
            (PyArray2::from_owned_array(py, times).into_any(), rows)
        }
        Some(out) => (out.clone(), write_hits(&hits, out)?),
    };
    if !surfaces {
        return Ok(times);
    }
    let mut table = filled(rows, hits.counts.len(), -1)?;
    py.detach(|| hits.scatter(|row, column, entry| table[[row, column]] = hits.surfaces[entry]));
    Ok(PyTuple::new(py, [times, PyArray2::from_owned_array(py, table).into_any()])?.into_any())
}

/// Writes hits into an array of the caller's and returns its number of rows.
fn write_hits(hits: &Hits, out: &Bound<'_, PyAny>) -> PyResult<usize> {
    let Ok(array) = out.cast::<PyArray2<f64>>() else {
        return Err(bad_type("out is no float64 array of two dimensions (hits are written into it)"));
    };
    let (rows, columns) = (array.shape()[0], array.shape()[1]);
    if rows < hits.rows() || rows % 2 == 1 || columns != hits.counts.len() {
        return Err(bad_value(format!(
            "out has shape {} (the hits need {} columns and an even number of rows, at least {})",
            shape_text(array.shape()),
            hits.counts.len(),
            hits.rows()
        )));
    }
    let whole = array.is_aligned() && array.strides().iter().all(|stride| stride % 8 == 0);
    let mut view = match array.try_readwrite() {
        Ok(view) if whole => view,
        Ok(_) => return Err(bad_value("out is laid out in parts of numbers (an aligned array is needed)")),
        Err(error) => return Err(bad_value(format!("out: {error}"))),
    };
    let mut view = view.as_array_mut();
    view.fill(f64::INFINITY);
    hits.scatter(|row, column, entry| view[[row, column]] = hits.times[entry]);
    Ok(rows)
}
