//! Crossings in R^d, as columns.

use std::num::NonZeroUsize;

use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple, PyType};
use rayweave::rootray::RootRay;
use rayweave::space::{Face, Point, Program, Solid, SpaceError, Tracer};

use super::follow::follow;
use super::{AnyCurve, Holds, Shared};
use crate::arrays::{double_array, room, shape_text};
use crate::crossings::{offsets, rows_of};
use crate::engine::in_chunks;
use crate::error::bad_value;

/// Lines per chunk of a thread.
const CHUNK: usize = 256;

/// Crossings of lines or curves, row by row.
#[derive(Default)]
pub struct PointTable {
    counts: Vec<usize>,
    start_inside: Vec<bool>,
    t: Vec<f64>,
    point: Vec<f64>,
    normal: Vec<f64>,
    enters: Vec<bool>,
    surface: Vec<i32>,
    leaf: Vec<i32>,
}

impl PointTable {
    /// Crossings of the lines through pairs of points.
    pub fn of_lines<'py, const D: usize>(
        solid: &Solid<D>,
        [p, q]: [&Bound<'py, PyAny>; 2],
        threads: Option<NonZeroUsize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = p.py();
        let (from, to) = (points::<D>(p, "p")?, points::<D>(q, "q")?);
        let len = match (from.rows.len(), to.rows.len()) {
            (a, b) if a == b => a,
            (1, n) | (n, 1) => n,
            (a, b) => {
                return Err(bad_value(format!(
                    "there are {a} points p and {b} points q: the numbers must be equal, or one of them 1."
                )));
            }
        };
        let single = from.single && to.single;
        let mut table = PointTable::default();
        let program = py.detach(|| {
            let program = solid.compile().map_err(bad_value)?;
            let work = |tracer: &mut Result<Tracer<D>, SpaceError>, chunk: std::ops::Range<usize>| {
                let mut part = PointTable::default();
                for k in chunk {
                    let line = tracer.as_mut().map_err(|error| error.clone());
                    let found = line.and_then(|tracer| tracer.trace(from.get(k), to.get(k)));
                    let place = if single { String::new() } else { format!("line {k}: ") };
                    part.push(&program, &found.map_err(|error| bad_value(format!("{place}{error}")))?);
                }
                Ok::<_, PyErr>(part)
            };
            in_chunks(
                len,
                CHUNK,
                threads,
                || Tracer::new(solid),
                work,
                |part| {
                    table.append(part?);
                    Ok(())
                },
            )?;
            Ok::<_, PyErr>(program)
        })?;
        table.into_python(py, &program)
    }

    /// Crossings of curves.
    pub fn of_curves<'py, const D: usize>(
        solid: &Solid<D>,
        curves: &Bound<'py, PyAny>,
        window: [&Bound<'py, PyAny>; 2],
        threads: Option<NonZeroUsize>,
    ) -> PyResult<Bound<'py, PyAny>>
    where
        AnyCurve: Holds<Shared<D>>,
    {
        let program = solid.compile().map_err(bad_value)?;
        let mut table = PointTable::default();
        follow(
            curves,
            window,
            threads,
            || Tracer::new(solid),
            |tracer, curve, t0, t1| {
                let tracer = tracer.as_mut().map_err(|error| error.clone())?;
                tracer.trace_curve(&curve, t0, t1)
            },
            |ray| {
                table.push(&program, &ray);
                Ok(())
            },
        )?;
        table.into_python(curves.py(), &program)
    }

    fn push<const D: usize>(&mut self, program: &Program<D>, ray: &RootRay<Face<D>>) {
        self.counts.push(ray.roots().len());
        self.start_inside.push(ray.start().is_inside());
        for (root, side) in ray.crossings() {
            self.t.push(root.t);
            self.point.extend(root.surface.point);
            self.normal.extend(root.surface.normal);
            self.enters.push(side.is_inside());
            self.surface.push(program.face_number(&root.surface) as i32);
            self.leaf.push(root.surface.leaf as i32);
        }
    }

    fn append(&mut self, mut other: PointTable) {
        self.counts.append(&mut other.counts);
        self.start_inside.append(&mut other.start_inside);
        self.t.append(&mut other.t);
        self.point.append(&mut other.point);
        self.normal.append(&mut other.normal);
        self.enters.append(&mut other.enters);
        self.surface.append(&mut other.surface);
        self.leaf.append(&mut other.leaf);
    }

    fn into_python<'py, const D: usize>(
        self,
        py: Python<'py>,
        program: &Program<D>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (rows, fields) = (self.t.len(), PyDict::new(py));
        fields.set_item("ray", PyArray1::from_vec(py, rows_of(&self.counts, rows)?))?;
        fields.set_item("offsets", PyArray1::from_vec(py, offsets(&self.counts)?))?;
        fields.set_item("t", PyArray1::from_vec(py, self.t))?;
        fields.set_item("point", PyArray1::from_vec(py, self.point).reshape([rows, D])?)?;
        fields.set_item("normal", PyArray1::from_vec(py, self.normal).reshape([rows, D])?)?;
        fields.set_item("enters", PyArray1::from_vec(py, self.enters))?;
        fields.set_item("surface", PyArray1::from_vec(py, self.surface))?;
        fields.set_item("leaf", PyArray1::from_vec(py, self.leaf))?;
        fields.set_item("start_inside", PyArray1::from_vec(py, self.start_inside))?;
        fields.set_item("surface_names", PyTuple::new(py, program.face_names())?)?;
        static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
        CLASS.import(py, "rayweave.space", "PointCrossings")?.call((), Some(&fields))
    }
}

/// Points of R^d as given by Python; their values are checked where they are used.
pub struct Points<const D: usize> {
    /// The points; one, if a single one was given.
    pub rows: Vec<Point<D>>,
    /// Given as (d,), and broadcast.
    single: bool,
    name: &'static str,
}

impl<const D: usize> Points<D> {
    /// Point k, or the only one.
    fn get(&self, k: usize) -> Point<D> {
        self.rows[if self.rows.len() == 1 { 0 } else { k }]
    }

    /// The name of point k in messages.
    pub fn place(&self, k: usize) -> String {
        if self.single { self.name.to_owned() } else { format!("{}[{k}]", self.name) }
    }
}

/// The points in an array of shape (N, d) or (d,).
pub fn points<const D: usize>(object: &Bound<'_, PyAny>, name: &'static str) -> PyResult<Points<D>> {
    let array = double_array(object, name)?;
    let single = match *array.shape() {
        [_, columns] if columns == D => false,
        [columns] if columns == D => true,
        ref other => {
            let shape = shape_text(other);
            return Err(bad_value(format!("{name} has shape {shape}: it must be (N, {D}) or ({D},).")));
        }
    };
    let view = array.try_readonly().map_err(bad_value)?;
    let mut rows = room(if single { 1 } else { array.shape()[0] })?;
    let mut numbers = view.as_array().into_iter().copied();
    // the shape guarantees that no number is left over
    while let Some(first) = numbers.next() {
        let mut row = [first; D];
        row[1..].iter_mut().zip(&mut numbers).for_each(|(entry, value)| *entry = value);
        rows.push(row);
    }
    Ok(Points { rows, single, name })
}
