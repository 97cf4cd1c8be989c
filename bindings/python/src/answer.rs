//! The columns of an answer: places that threads fill, and the object that Python sees.

use numpy::{Element, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyType};
use rayweave::model::RegionId;

use crate::arrays::{fresh, fresh_flags, fresh_table};
use crate::engine::Engine;
use crate::error::bad_value;

/// Places for some rows of an answer.
#[derive(Default)]
pub struct Rows<'a> {
    pub t: &'a mut [f64],
    pub point: &'a mut [[f64; 3]],
    pub normal: &'a mut [[f64; 3]],
    pub enters: &'a mut [bool],
    pub surface: &'a mut [i32],
    pub leaf: &'a mut [i32],
    pub placement: &'a mut [i32],
    /// The regions before and after, and their media; for a solid alone they have no places.
    pub regions: [&'a mut [i32]; 2],
    pub media: [&'a mut [i32]; 2],
}

impl<'a> Rows<'a> {
    /// The number of rows.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// The first so many rows, or all if there are fewer; these are left without.
    pub fn take(&mut self, count: usize) -> Rows<'a> {
        let count = count.min(self.len());
        Rows {
            t: take(&mut self.t, count),
            point: take(&mut self.point, count),
            normal: take(&mut self.normal, count),
            enters: take(&mut self.enters, count),
            surface: take(&mut self.surface, count),
            leaf: take(&mut self.leaf, count),
            placement: take(&mut self.placement, count),
            regions: self.regions.each_mut().map(|column| take(column, count)),
            media: self.media.each_mut().map(|column| take(column, count)),
        }
    }

    /// Writes the regions on both sides of every row, and their media, if there are places for them.
    pub fn put_regions(&mut self, engine: &Engine, before: &[u32], after: &[u32]) {
        for (k, numbers) in [before, after].into_iter().enumerate() {
            for ((region, medium), &number) in
                self.regions[k].iter_mut().zip(&mut *self.media[k]).zip(numbers)
            {
                (*region, *medium) = (number as i32, medium_of(engine, number));
            }
        }
    }
}

/// The first so many entries of a column; none of one without entries.
pub fn take<'a, T>(column: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    column.split_off_mut(..count).unwrap_or_default()
}

/// The number of a region's medium.
pub fn medium_of(engine: &Engine, region: u32) -> i32 {
    engine.program.medium_of(RegionId(region)) as i32
}

/// The arrays of an answer about rays.
pub struct Answer<'py> {
    t: Bound<'py, PyArray1<f64>>,
    vectors: [Bound<'py, PyArray2<f64>>; 2],
    enters: Bound<'py, PyArray1<bool>>,
    numbers: [Bound<'py, PyArray1<i32>>; 3],
    regions: [Bound<'py, PyArray1<i32>>; 4],
    start_inside: Bound<'py, PyArray1<bool>>,
}

impl<'py> Answer<'py> {
    /// Room for so many rows about so many rays.
    pub fn new(py: Python<'py>, engine: &Engine, [rows, rays]: [usize; 2]) -> PyResult<Self> {
        let in_regions = if engine.media.is_some() { rows } else { 0 };
        let numbers = |len| fresh::<i32>(py, len);
        Ok(Answer {
            t: fresh(py, rows)?,
            vectors: [fresh_table(py, [rows, 3])?, fresh_table(py, [rows, 3])?],
            enters: fresh_flags(py, rows)?,
            numbers: [numbers(rows)?, numbers(rows)?, numbers(rows)?],
            regions: [numbers(in_regions)?, numbers(in_regions)?, numbers(in_regions)?, numbers(in_regions)?],
            start_inside: fresh_flags(py, rays)?,
        })
    }

    /// Calls a function that fills all rows, and says of every ray whether it starts inside.
    pub fn fill<R>(&self, fill: impl FnOnce(Rows<'_>, &mut [bool]) -> PyResult<R>) -> PyResult<R> {
        let (mut t, mut enters) = (self.t.readwrite(), self.enters.readwrite());
        let [mut point, mut normal] = self.vectors.each_ref().map(|array| array.readwrite());
        let [mut surface, mut leaf, mut placement] = self.numbers.each_ref().map(|array| array.readwrite());
        let [mut r0, mut r1, mut m0, mut m1] = self.regions.each_ref().map(|array| array.readwrite());
        let mut start_inside = self.start_inside.readwrite();
        let rows = Rows {
            t: t.as_slice_mut().map_err(bad_value)?,
            point: point.as_slice_mut().map_err(bad_value)?.as_chunks_mut().0,
            normal: normal.as_slice_mut().map_err(bad_value)?.as_chunks_mut().0,
            enters: enters.as_slice_mut().map_err(bad_value)?,
            surface: surface.as_slice_mut().map_err(bad_value)?,
            leaf: leaf.as_slice_mut().map_err(bad_value)?,
            placement: placement.as_slice_mut().map_err(bad_value)?,
            regions: [r0.as_slice_mut().map_err(bad_value)?, r1.as_slice_mut().map_err(bad_value)?],
            media: [m0.as_slice_mut().map_err(bad_value)?, m1.as_slice_mut().map_err(bad_value)?],
        };
        fill(rows, start_inside.as_slice_mut().map_err(bad_value)?)
    }

    /// The object that Python sees. Without offsets there is one row for every ray.
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
        // the fields are put where the constructor would put them, but for those that the class makes when asked
        let object = class.call_method1("__new__", (class,))?;
        let fields = object.getattr("__dict__")?.cast_into::<PyDict>()?;
        let [point, normal] = self.vectors;
        let [surface, leaf, placement] = self.numbers;
        fields.set_item("t", self.t)?;
        fields.set_item("point", point)?;
        fields.set_item("normal", normal)?;
        fields.set_item("enters", self.enters)?;
        fields.set_item("surface", surface)?;
        fields.set_item("leaf", leaf)?;
        fields.set_item("placement", placement)?;
        fields.set_item("start_inside", self.start_inside)?;
        fields.set_item("surface_names", engine.surface_names(py)?)?;
        if let Some(offsets) = offsets {
            fields.set_item("offsets", offsets)?;
        }
        if engine.media.is_some() {
            let names = ["region_before", "region_after", "medium_before", "medium_after"];
            names
                .into_iter()
                .zip(self.regions)
                .try_for_each(|(name, column)| fields.set_item(name, column))?;
            fields.set_item("medium_names", engine.medium_names(py)?)?;
            fields.set_item("region_names", engine.region_names(py)?)?;
        }
        Ok(object)
    }
}

/// Whole columns as arrays.
pub fn column<T: Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    PyArray1::from_vec(py, values)
}
