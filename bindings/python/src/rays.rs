//! Conversion and validation of arrays of rays and points, and access to blocks of them.

use std::ops::Range;

use numpy::ndarray::{ArrayView2, s};
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use rayweave::Ray;
use rayweave::model::{BadRay, Program, Rays};

use crate::arrays::{double_array, shape_text};
use crate::engine::BLOCK;
use crate::error::bad_value;
use crate::layout::deinterleave;

/// Requirements on the components of vectors.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// The components are finite and not too large.
    Point,
    /// In addition, the largest component is at least [`Ray::MIN_DIRECTION`] in magnitude.
    Direction,
}

impl Kind {
    /// True if a vector is valid. NaN is rejected.
    #[inline(always)]
    fn accepts(self, [x, y, z]: [f64; 3]) -> bool {
        let (x, y, z) = (x.abs(), y.abs(), z.abs());
        // no branches, because it runs for millions of consecutive numbers
        let small = (x <= Ray::MAX_COMPONENT) & (y <= Ray::MAX_COMPONENT) & (z <= Ray::MAX_COMPONENT);
        small
            & ((self == Kind::Point)
                | (x >= Ray::MIN_DIRECTION)
                | (y >= Ray::MIN_DIRECTION)
                | (z >= Ray::MIN_DIRECTION))
    }
}

/// Vectors (N, 3), a grid of vectors (..., 3) in row-major order, or one vector (3,) that is broadcast.
///
/// Their components are checked as they are read: see [`Columns`].
pub struct Vectors<'py> {
    rows: PyReadonlyArray2<'py, f64>,
    /// The shape of the array without its last axis: empty for a single vector.
    shape: Vec<usize>,
    name: &'static str,
    kind: Kind,
}

impl<'py> Vectors<'py> {
    /// Converts an object to points; `name` is the array's name in messages.
    pub fn points(object: &Bound<'py, PyAny>, name: &'static str) -> PyResult<Self> {
        Vectors::new(object, name, Kind::Point)
    }

    /// Converts an object to vectors of non-zero length.
    pub fn directions(object: &Bound<'py, PyAny>, name: &'static str) -> PyResult<Self> {
        Vectors::new(object, name, Kind::Direction)
    }

    fn new(object: &Bound<'py, PyAny>, name: &'static str, kind: Kind) -> PyResult<Self> {
        let array = double_array(object, name)?;
        let shape = match array.shape() {
            [leading @ .., 3] => leading.to_vec(),
            other => {
                let shape = shape_text(other);
                let wanted = "(N, 3), (3,), or a grid (..., 3)";
                let hint =
                    if other.first() == Some(&3) && other.len() == 2 { " Is it transposed?" } else { "" };
                return Err(bad_value(format!("{name} has shape {shape}: it must be {wanted}.{hint}")));
            }
        };
        let rows = match shape.len() {
            1 => array.into_any(),
            _ => array.reshape([shape.iter().product(), 3])?.into_any(),
        };
        let rows = rows.cast_into::<PyArray2<f64>>()?;
        Ok(Vectors { rows: rows.try_readonly().map_err(bad_value)?, shape, name, kind })
    }

    /// The rows, readable from any thread.
    pub fn rows(&self) -> Rows<'_> {
        let view = self.rows.as_array();
        // one vector broadcast by NumPy: all rows are the same memory
        let is_one = view.nrows() == 1 || view.nrows() > 1 && view.strides()[0] == 0;
        let packed = if is_one { None } else { view.to_slice().map(|flat| flat.as_chunks().0) };
        Rows { view, one: is_one.then(|| row(view, 0)), packed, kind: self.kind }
    }

    /// The shape of the array without its last axis: empty for a single vector.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// The number of vectors; 1 for a single one.
    pub fn len(&self) -> usize {
        self.rows.as_array().nrows()
    }

    /// The index of a row in the array, such as `7`, or `2, 5` in a grid.
    fn position(&self, row: usize) -> String {
        let mut rest = row;
        let mut indices: Vec<String> = Vec::new();
        for &size in self.shape.iter().rev() {
            indices.push((rest % size).to_string());
            rest /= size;
        }
        indices.reverse();
        indices.join(", ")
    }

    /// The error for the first invalid vector; components out of range have priority.
    pub fn problem(&self) -> Option<PyErr> {
        let view = self.rows.as_array();
        let first_bad = |kind: Kind| (0..view.nrows()).find(|&i| !kind.accepts(row(view, i)));
        // components out of range are reported before directions that are too short, even at a later row
        let i = first_bad(Kind::Point).or_else(|| first_bad(self.kind))?;
        let [x, y, z] = row(view, i);
        let place = match self.shape.len() {
            0 => self.name.to_owned(),
            _ => format!("{}[{}]", self.name, self.position(i)),
        };
        Some(bad_value(match () {
            () if !Kind::Point.accepts([x, y, z]) => format!(
                "{place} is ({x:?}, {y:?}, {z:?}): every component must be finite, from {:e} to {:e}.",
                -Ray::MAX_COMPONENT,
                Ray::MAX_COMPONENT
            ),
            () if [x, y, z] == [0.0; 3] => format!("{place} has length 0: a ray needs a direction."),
            () => format!(
                "{place} is ({x:?}, {y:?}, {z:?}): its largest component must be at least {:e} in magnitude.",
                Ray::MIN_DIRECTION
            ),
        }))
    }
}

fn row(view: ArrayView2<'_, f64>, i: usize) -> [f64; 3] {
    [view[[i, 0]], view[[i, 1]], view[[i, 2]]]
}

/// The error for the first invalid vector of the arrays.
pub fn invalid_input(arrays: &[&Vectors<'_>]) -> PyErr {
    let problem = arrays.iter().find_map(|vectors| vectors.problem());
    problem.unwrap_or_else(|| bad_value(CHANGED))
}

/// The error if all vectors are valid when they are read again.
const CHANGED: &str = "an array was modified during the query: another thread wrote to it. Pass a copy.";

/// Rows of three components in any layout.
#[derive(Clone, Copy)]
pub struct Rows<'a> {
    view: ArrayView2<'a, f64>,
    /// The row, if all rows are the same.
    one: Option<[f64; 3]>,
    /// The rows, if they are contiguous.
    packed: Option<&'a [[f64; 3]]>,
    kind: Kind,
}

impl Rows<'_> {
    /// Every `step`-th row.
    fn every(self, step: usize) -> Self {
        Rows { view: self.view.slice_move(s![..;step as isize, ..]), packed: None, ..self }
    }
}

/// The arrays of a ray query.
pub struct RayArrays<'py> {
    origins: Vectors<'py>,
    directions: Vectors<'py>,
    len: usize,
}

impl<'py> RayArrays<'py> {
    /// Pairs origins with directions. Their lengths must be equal, or one of them 1, which is broadcast. Grids (..., 3) are
    /// broadcast against each other by the rules of NumPy.
    pub fn new([origins, directions]: [&Bound<'py, PyAny>; 2]) -> PyResult<Self> {
        let (mut first, mut second) =
            (Vectors::points(origins, "origins")?, Vectors::directions(directions, "directions")?);
        let is_grid = first.shape.len() > 1 || second.shape.len() > 1;
        if is_grid && first.shape != second.shape && first.len() != 1 && second.len() != 1 {
            let [a, b] = broadcast(origins, directions)?;
            (first, second) = (Vectors::points(&a, "origins")?, Vectors::directions(&b, "directions")?);
        }
        let (origins, directions) = (first, second);
        let len = match (origins.len(), directions.len()) {
            (a, b) if a == b => a,
            (1, n) | (n, 1) => n,
            (a, b) => {
                return Err(bad_value(format!(
                    "there are {a} origins and {b} directions: the numbers must be equal, or one of them 1."
                )));
            }
        };
        // with zero rays no block is read, so the vectors are validated here
        match (len == 0).then(|| origins.problem().or_else(|| directions.problem())).flatten() {
            Some(problem) => Err(problem),
            None => Ok(RayArrays { origins, directions, len }),
        }
    }

    /// The number of rays.
    pub fn len(&self) -> usize {
        self.len
    }

    /// The rays, readable from any thread.
    pub fn rows(&self) -> RayRows<'_> {
        RayRows { origins: self.origins.rows(), directions: self.directions.rows() }
    }

    /// The error for the first invalid ray, or the first one that is too far from a program.
    pub fn invalid_input(&self, program: &Program) -> PyErr {
        let rows = self.rows();
        let mut columns = Columns::default();
        let too_far = (0..self.len).step_by(BLOCK).find_map(|first| {
            let rays = columns.components(rows, first..self.len.min(first + BLOCK))?;
            let bad = program.check_rays(rays).err()?;
            Some(bad_value(BadRay { ray: first + bad.ray, ..bad }))
        });
        let problem = self.origins.problem().or_else(|| self.directions.problem());
        problem.or(too_far).unwrap_or_else(|| invalid_input(&[&self.origins, &self.directions]))
    }
}

/// The arrays, broadcast against each other by NumPy.
fn broadcast<'py>(
    origins: &Bound<'py, PyAny>,
    directions: &Bound<'py, PyAny>,
) -> PyResult<[Bound<'py, PyAny>; 2]> {
    let numpy = origins.py().import("numpy")?;
    let arrays = numpy.call_method1("broadcast_arrays", (origins, directions)).map_err(|error| {
        bad_value(format!("the grids of origins and directions do not match: {}.", error.value(origins.py())))
    })?;
    Ok([arrays.get_item(0)?, arrays.get_item(1)?])
}

/// The origins and directions of rays.
#[derive(Clone, Copy)]
pub struct RayRows<'a> {
    origins: Rows<'a>,
    directions: Rows<'a>,
}

impl RayRows<'_> {
    /// Every `step`-th ray.
    pub fn every(self, step: usize) -> Self {
        RayRows { origins: self.origins.every(step), directions: self.directions.every(step) }
    }
}

/// The rays or points of a block as columns, validated; each thread reuses the memory during a query.
#[derive(Default)]
pub struct Columns {
    origins: VectorColumns,
    directions: VectorColumns,
}

impl Columns {
    /// The rays of a block; `None` if one of them is invalid, or too far from the program to be traced.
    pub fn rays(&mut self, rays: RayRows<'_>, block: Range<usize>, program: &Program) -> Option<Rays<'_>> {
        self.components(rays, block).filter(|rays| program.check_rays(*rays).is_ok())
    }

    /// The rays of a block; `None` if a component is invalid.
    fn components(&mut self, rays: RayRows<'_>, block: Range<usize>) -> Option<Rays<'_>> {
        let origins = self.origins.fill(rays.origins, block.clone())?;
        Some(Rays { origins, directions: self.directions.fill(rays.directions, block)? })
    }

    /// The points of a block; `None` if one of them is invalid.
    pub fn points(&mut self, points: Rows<'_>, block: Range<usize>) -> Option<[&[f64]; 3]> {
        self.origins.fill(points, block)
    }
}

/// Three columns: the components of vectors.
#[derive(Default)]
struct VectorColumns {
    columns: [Vec<f64>; 3],
}

impl VectorColumns {
    /// Copies rows of vectors to the columns; `None` if a row is invalid.
    fn fill(&mut self, rows: Rows<'_>, block: Range<usize>) -> Option<[&[f64]; 3]> {
        let len = block.len();
        if self.columns[0].len() < len {
            // a broadcast vector is written once; later blocks reuse it
            let vector = rows.one.unwrap_or_default();
            self.columns.iter_mut().zip(vector).for_each(|(column, value)| column.resize(len, value));
        }
        let [x, y, z] = &mut self.columns;
        let (x, y, z) = (&mut x[..len], &mut y[..len], &mut z[..len]);
        let ok = match (rows.one, rows.packed) {
            (Some(vector), _) => rows.kind.accepts(vector),
            (None, Some(packed)) => {
                deinterleave_checked(rows.kind, &packed[block], [&mut *x, &mut *y, &mut *z])
            }
            (None, None) => {
                for (k, column) in [&mut *x, &mut *y, &mut *z].into_iter().enumerate() {
                    let values = rows.view.column(k);
                    column.iter_mut().zip(block.clone()).for_each(|(to, i)| *to = values[i]);
                }
                x.iter().zip(&*y).zip(&*z).all(|((&x, &y), &z)| rows.kind.accepts([x, y, z]))
            }
        };
        ok.then_some([x, y, z])
    }
}

/// Copies rows to columns; true if all are valid.
fn deinterleave_checked(kind: Kind, rows: &[[f64; 3]], columns: [&mut [f64]; 3]) -> bool {
    // a specialised loop for each kind
    match kind {
        Kind::Point => deinterleave(rows, columns, |row| Kind::Point.accepts(row)),
        Kind::Direction => deinterleave(rows, columns, |row| Kind::Direction.accepts(row)),
    }
}
