//! Polygonal regions of the plane as a Python class.

use numpy::ndarray::{Array2, arr2};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use rayweave::polygon::{Polygons, from_polygons};
use rayweave::rootray::{RootRay, Side};

use crate::arrays::{double_array, list, room, shape_text};
use crate::error::{bad_type, bad_value, shown};
use crate::rootray::PyRootRay;
use crate::solid::PySolid;
use crate::space::kinds::polygon_numbers;
use crate::space::solid::PySpaceSolid;
use crate::space::table;

/// Recipe that recreates a region: a function and its arguments.
type Remake<'py> = (Bound<'py, PyAny>, (Bound<'py, PyTuple>, i64));

/// A region of the plane bounded by polygons. Immutable; created by `from_polygons`.
///
/// >>> import rayweave as rw
/// >>> frame = rw.from_polygons([[[0, 0], [4, 0], [4, 4], [0, 4]], [[1, 1], [1, 3], [3, 3], [3, 1]]])
/// >>> frame.area, frame.contains([[0.5, 2], [2, 2]])
/// (12.0, array([ True, False]))
/// >>> round(frame.extrude(0, 2).volume)
/// 24
#[pyclass(frozen, module = "rayweave", name = "Polygons")]
pub struct PyPolygons(Polygons);

impl PyPolygons {
    /// The region.
    pub fn polygons(&self) -> &Polygons {
        &self.0
    }
}

/// The region bounded by closed contours, arrays of shape (N, 2): islands go around counter-clockwise, holes clockwise.
/// `outside` is +1 or, if the outermost contours are holes, -1.
///
/// >>> import rayweave as rw
/// >>> triangle = rw.from_polygons([[[0, 0], [2, 0], [0, 2]]])
/// >>> triangle.area
/// 2.0
#[pyfunction]
#[pyo3(name = "from_polygons", signature = (contours: "Iterable[ArrayLike]", outside = 1))]
pub fn region_from_polygons(
    py: Python<'_>,
    contours: &Bound<'_, PyAny>,
    outside: i64,
) -> PyResult<PyPolygons> {
    let side = match outside {
        1 => Side::Outside,
        -1 => Side::Inside,
        other => return Err(bad_value(format!("outside is {other}: it must be +1 or -1."))),
    };
    let each = contours
        .try_iter()
        .map_err(|_| bad_type(format!("contours is {}: it must be a list of arrays.", shown(contours))))?;
    let contours: Vec<Vec<[f64; 2]>> =
        each.enumerate().map(|(k, contour)| vertices(&contour?, k)).collect::<PyResult<_>>()?;
    py.detach(|| from_polygons(&contours, side)).map(PyPolygons).map_err(bad_value)
}

fn vertices(object: &Bound<'_, PyAny>, number: usize) -> PyResult<Vec<[f64; 2]>> {
    let name = format!("contours[{number}]");
    let array = double_array(object, &name)?;
    match array.shape() {
        [_, 2] | [0] => {}
        shape => {
            let shape = shape_text(shape);
            return Err(bad_value(format!("{name} has shape {shape}: it must be (N, 2).")));
        }
    }
    let array = array.try_readonly().map_err(bad_value)?;
    let numbers: Vec<f64> = array.as_array().iter().copied().collect();
    Ok(numbers.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect())
}

fn pair(object: &Bound<'_, PyAny>, name: &str) -> PyResult<[f64; 2]> {
    let numbers = list(object, name)?;
    let found = numbers.len();
    numbers.try_into().map_err(|_| bad_value(format!("{name} has {found} numbers: it must have 2.")))
}

#[pymethods]
impl PyPolygons {
    /// The side far away from all contours: +1 outside, -1 inside.
    #[getter]
    fn outside(&self) -> i64 {
        if self.0.outside().is_inside() { -1 } else { 1 }
    }

    /// The area, inf if the region is unbounded.
    #[getter]
    fn area(&self) -> f64 {
        self.0.area()
    }

    /// A box around the contours: float64 (2, 2), the smallest and the largest coordinates; (+inf, -inf) without contours.
    #[getter]
    #[cfg_attr(false, stub("() -> NDArray[np.float64]"))]
    fn bounds<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for corner in self.0.contours().flat_map(|contour| contour.corners) {
            for axis in 0..2 {
                lo[axis] = lo[axis].min(corner[axis]);
                hi[axis] = hi[axis].max(corner[axis]);
            }
        }
        PyArray2::from_owned_array(py, arr2(&[lo, hi]))
    }

    /// The contours after simplification, without vertices that are not corners: arrays of shape
    /// (N, 2).
    #[getter]
    #[cfg_attr(false, stub("() -> tuple[NDArray[np.float64], ...]"))]
    fn contours<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let array = |corners: &[[f64; 2]]| {
            let array = Array2::from_shape_fn((corners.len(), 2), |(k, axis)| corners[k][axis]);
            PyArray2::from_owned_array(py, array)
        };
        PyTuple::new(py, self.0.contours().map(|contour| array(contour.corners)))
    }

    /// The root-ray of the line origin + t direction.
    #[pyo3(signature = (origin: "ArrayLike", direction: "ArrayLike"))]
    fn trace(&self, origin: &Bound<'_, PyAny>, direction: &Bound<'_, PyAny>) -> PyResult<PyRootRay> {
        let (origin, direction) = (pair(origin, "origin")?, pair(direction, "direction")?);
        let traced = self.0.trace(origin, direction).map_err(bad_value)?;
        let plain: RootRay = traced.map_surfaces(|_| ());
        Ok(PyRootRay::from_root_ray(plain))
    }

    /// Whether points (N, 2) or (2,) are inside: bool (N,). A point on the boundary has the side
    /// that the line along +x has just after it.
    #[pyo3(signature = (points: "ArrayLike"))]
    fn contains<'py>(&self, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let py = points.py();
        let rows = table::points::<2>(points, "points")?;
        let mut inside = room(rows.rows.len())?;
        for (k, point) in rows.rows.iter().enumerate() {
            let answer = self.0.contains(*point);
            inside.push(answer.map_err(|error| bad_value(format!("{}: {error}", rows.place(k))))?);
        }
        Ok(PyArray1::from_vec(py, inside))
    }

    /// The region as a solid of `rayweave.space`: of the plane or, unbounded along the other axes, of a space of `d` dimensions.
    #[pyo3(signature = (d = 2))]
    fn solid(&self, d: usize) -> PyResult<PySpaceSolid> {
        let contours: Vec<_> = self.0.contours().map(|contour| contour.corners).collect();
        PySpaceSolid::make("polygons", d, polygon_numbers(self.0.outside(), &contours), None, &[])
    }

    /// The prism over the region, lo < z < hi, as a solid.
    fn extrude(&self, lo: f64, hi: f64) -> PyResult<PySolid> {
        self.0.extrude(lo, hi).map(PySolid::from_solid).map_err(bad_value)
    }

    fn __eq__(&self, other: PyRef<'_, Self>) -> bool {
        let corners = |region: &Polygons| region.contours().map(|c| c.corners.to_vec()).collect::<Vec<_>>();
        self.0.outside() == other.0.outside() && corners(&self.0) == corners(&other.0)
    }

    fn __hash__(&self) -> u64 {
        self.0.area().to_bits() ^ self.0.edge_count() as u64
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    #[pyo3(signature = (_memo: "dict[int, Any]"))]
    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __repr__(&self) -> String {
        let (contours, edges) = (self.0.contours().len(), self.0.edge_count());
        format!("<Polygons of {contours} contours, {edges} edges>")
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Remake<'py>> {
        let make = py.import("rayweave")?.getattr("from_polygons")?;
        Ok((make, (self.contours(py)?, self.outside())))
    }
}
