//! Result columns of ray queries: buffers that threads fill, and the Python object that holds them.

use numpy::{Element, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{IntoPyDict, PyDict, PyTuple, PyType};
use rayweave::model::RegionId;

use crate::arrays::{fresh, fresh_flags, fresh_table};
use crate::engine::Engine;
use crate::error::bad_value;

/// Buffers for some rows of a result.
#[derive(Default)]
pub struct Rows<'a> {
    pub t: &'a mut [f64],
    pub point: &'a mut [[f64; 3]],
    pub normal: &'a mut [[f64; 3]],
    pub enters: &'a mut [bool],
    pub surface: &'a mut [i32],
    /// Empty if the program has no placements.
    pub placement: &'a mut [i32],
    /// The regions before and after, and their media; empty for a single solid.
    pub regions: [&'a mut [i32]; 2],
    pub media: [&'a mut [i32]; 2],
}

impl<'a> Rows<'a> {
    /// The number of rows.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Splits off the first `count` rows, or all if there are fewer.
    pub fn take(&mut self, count: usize) -> Rows<'a> {
        let count = count.min(self.len());
        Rows {
            t: take(&mut self.t, count),
            point: take(&mut self.point, count),
            normal: take(&mut self.normal, count),
            enters: take(&mut self.enters, count),
            surface: take(&mut self.surface, count),
            placement: take(&mut self.placement, count),
            regions: self.regions.each_mut().map(|column| take(column, count)),
            media: self.media.each_mut().map(|column| take(column, count)),
        }
    }

    /// Writes the regions on both sides of every row, and their media, if the result has these
    /// columns.
    pub fn put_regions(&mut self, engine: &Engine, regions: impl Iterator<Item = [u32; 2]>) {
        if engine.media.is_none() {
            return;
        }
        for (i, numbers) in regions.enumerate() {
            for (k, number) in numbers.into_iter().enumerate() {
                self.regions[k][i] = number as i32;
                self.media[k][i] = medium_of(engine, number);
            }
        }
    }
}

/// Splits off the first `count` entries of a column; nothing from an empty column.
pub fn take<'a, T>(column: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    column.split_off_mut(..count).unwrap_or_default()
}

/// The number of a region's medium.
pub fn medium_of(engine: &Engine, region: u32) -> i32 {
    engine.medium_of(RegionId(region)) as i32
}

/// The arrays of the result of a ray query.
pub struct Answer<'py> {
    t: Bound<'py, PyArray1<f64>>,
    vectors: [Bound<'py, PyArray2<f64>>; 2],
    enters: Bound<'py, PyArray1<bool>>,
    surface: Bound<'py, PyArray1<i32>>,
    placement: Option<Bound<'py, PyArray1<i32>>>,
    /// The regions before and after, and their media.
    regions: Option<[Bound<'py, PyArray1<i32>>; 4]>,
    start_inside: Bound<'py, PyArray1<bool>>,
}

impl<'py> Answer<'py> {
    /// Buffers for `rows` rows of `rays` rays.
    pub fn new(py: Python<'py>, engine: &Engine, [rows, rays]: [usize; 2]) -> PyResult<Self> {
        let numbers = || fresh::<i32>(py, rows);
        let regions = || Ok::<_, PyErr>([numbers()?, numbers()?, numbers()?, numbers()?]);
        Ok(Answer {
            t: fresh(py, rows)?,
            vectors: [fresh_table(py, [rows, 3])?, fresh_table(py, [rows, 3])?],
            enters: fresh_flags(py, rows)?,
            surface: numbers()?,
            placement: engine.has_placements().then(numbers).transpose()?,
            regions: engine.media.is_some().then(regions).transpose()?,
            start_inside: fresh_flags(py, rays)?,
        })
    }

    /// Changes the number of rows. The old number must exceed [`MANY`], and there must be no other
    /// reference to the arrays.
    pub fn resize(&self, rows: usize) -> PyResult<()> {
        let py = self.t.py();
        let options = [("refcheck", false)].into_py_dict(py)?;
        let resize = |column: &Bound<'py, PyAny>| {
            let shape: Vec<usize> = column.getattr("shape")?.extract()?;
            column.call_method(
                "resize",
                (PyTuple::new(py, [&[rows], &shape[1..]].concat())?,),
                Some(&options),
            )
        };
        let numbers = [&self.surface].into_iter().chain(&self.placement).chain(self.regions.iter().flatten());
        let mut columns: Vec<&Bound<'py, PyAny>> = numbers.map(|column| column.as_any()).collect();
        columns.extend(self.vectors.iter().map(|column| column.as_any()));
        columns.extend([self.t.as_any(), self.enters.as_any()]);
        columns.into_iter().try_for_each(|column| resize(column).map(|_| ()))
    }

    /// Calls a function that fills all rows, and the flags by ray for a start inside.
    pub fn fill<R>(&self, fill: impl FnOnce(Rows<'_>, &mut [bool]) -> PyResult<R>) -> PyResult<R> {
        let (mut t, mut enters) = (self.t.readwrite(), self.enters.readwrite());
        let [mut point, mut normal] = self.vectors.each_ref().map(|array| array.readwrite());
        let (mut surface, mut placement) =
            (self.surface.readwrite(), self.placement.as_ref().map(|array| array.readwrite()));
        let mut regions =
            self.regions.as_ref().map(|arrays| arrays.each_ref().map(|array| array.readwrite()));
        let [r0, r1, m0, m1] = match &mut regions {
            Some(arrays) => arrays.each_mut().map(|array| array.as_slice_mut().map_err(bad_value)),
            None => std::array::from_fn(|_| Ok(&mut [][..])),
        };
        let mut start_inside = self.start_inside.readwrite();
        let rows = Rows {
            t: t.as_slice_mut().map_err(bad_value)?,
            point: point.as_slice_mut().map_err(bad_value)?.as_chunks_mut().0,
            normal: normal.as_slice_mut().map_err(bad_value)?.as_chunks_mut().0,
            enters: enters.as_slice_mut().map_err(bad_value)?,
            surface: surface.as_slice_mut().map_err(bad_value)?,
            placement: match &mut placement {
                Some(array) => array.as_slice_mut().map_err(bad_value)?,
                None => &mut [],
            },
            regions: [r0?, r1?],
            media: [m0?, m1?],
        };
        fill(rows, start_inside.as_slice_mut().map_err(bad_value)?)
    }

    /// Creates the Python object. Without offsets there is one row for every ray.
    pub fn into_python(
        self,
        engine: &Engine,
        offsets: Option<Bound<'py, PyArray1<i64>>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = self.t.py();
        static CLASSES: [PyOnceLock<Py<PyType>>; 2] = [PyOnceLock::new(), PyOnceLock::new()];
        let (class, name) =
            if engine.media.is_some() { (&CLASSES[1], "ModelCrossings") } else { (&CLASSES[0], "Crossings") };
        let class = class.import(py, "rayweave._answers", name)?;
        // sets the fields directly, without the constructor, except those that the class computes
        // on demand
        let object = class.call_method1("__new__", (class,))?;
        let fields = object.getattr("__dict__")?.cast_into::<PyDict>()?;
        let [point, normal] = self.vectors;
        fields.set_item("t", self.t)?;
        fields.set_item("point", point)?;
        fields.set_item("normal", normal)?;
        fields.set_item("enters", self.enters)?;
        fields.set_item("surface", self.surface)?;
        fields.set_item("_leaves", engine.leaves(py))?;
        self.placement.into_iter().try_for_each(|column| fields.set_item("placement", column))?;
        fields.set_item("start_inside", self.start_inside)?;
        fields.set_item("surface_names", engine.surface_names(py)?)?;
        if let Some(offsets) = offsets {
            fields.set_item("offsets", offsets)?;
        }
        if let Some(regions) = self.regions {
            let names = ["region_before", "region_after", "medium_before", "medium_after"];
            names.into_iter().zip(regions).try_for_each(|(name, column)| fields.set_item(name, column))?;
            fields.set_item("medium_names", engine.medium_names(py)?)?;
            fields.set_item("region_names", engine.region_names(py)?)?;
        }
        Ok(object)
    }
}

/// Converts complete columns to arrays.
pub fn column<T: Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    PyArray1::from_vec(py, values)
}
