//! Media: glasses, constant indices, and gradient indices.

use pyo3::prelude::*;
use rayweave::optics::gradient::Gradient;
use rayweave::optics::{Medium, OpticsError};

use crate::error::bad_value;
use crate::optics::glass::PyGlass;
use crate::optics::spec::Spec;
use crate::vectors::matrix;

/// A glass, a constant index n + i k, or either with a gradient.
#[derive(FromPyObject)]
pub enum Substance<'py> {
    Glass(PyRef<'py, PyGlass>),
    Graded(PyRef<'py, PyGradedMedium>),
    Constant(f64, f64),
}

impl Substance<'_> {
    pub fn medium(&self) -> PyResult<Medium> {
        match self {
            Substance::Graded(medium) => Ok(medium.0.clone()),
            Substance::Glass(glass) => Ok(Medium::from(glass.0.clone())),
            Substance::Constant(n, k) => {
                let name = if *k == 0.0 { format!("index {n}") } else { format!("index {n} + {k} i") };
                Medium::constant(&name, *n, *k).map_err(bad_value)
            }
        }
    }
}

/// A medium with a gradient: see `rayweave.optics.graded`.
///
/// >>> import rayweave.optics as ro
/// >>> rod = ro.graded(1.6, "selfoc", 0.1)
/// >>> round(rod.index(587.6, (1, 0, 0)), 5)
/// 1.59198
#[pyclass(frozen, module = "rayweave.optics", name = "GradedMedium")]
pub struct PyGradedMedium(pub Medium);

#[pymethods]
impl PyGradedMedium {
    #[new]
    #[pyo3(signature = (base, law, world_from_local: "ArrayLike"))]
    fn new(base: Substance<'_>, law: Spec, world_from_local: &Bound<'_, PyAny>) -> PyResult<Self> {
        let map = matrix(world_from_local, "matrix")?;
        let gradient = gradient(&law)?.and_then(|gradient| gradient.placed(&map)).map_err(bad_value)?;
        Ok(PyGradedMedium(base.medium()?.graded(gradient)))
    }

    /// The index at a point, a vector of three numbers, at a vacuum wavelength in nanometres; NaN where there is none.
    #[pyo3(signature = (wavelength_nm, point))]
    fn index(&self, wavelength_nm: f64, point: [f64; 3]) -> f64 {
        self.0.index_at(wavelength_nm, point.into()).re
    }

    fn __repr__(&self) -> String {
        format!("GradedMedium({:?})", self.0.name())
    }
}

fn gradient(law: &Spec) -> PyResult<Result<Gradient, OpticsError>> {
    Ok(match (law.kind(), law.numbers()) {
        ("selfoc", &[g]) => Gradient::selfoc(g),
        ("squared", numbers) => Gradient::squared(numbers),
        ("radial", numbers) => Gradient::polynomial(numbers, &[]),
        ("axial", numbers) => Gradient::axial(numbers),
        ("fish_eye", &[radius]) => Gradient::fish_eye(radius),
        ("luneburg", &[radius]) => Gradient::luneburg(radius),
        (kind, numbers) => {
            let text = format!("there is no gradient {kind:?} with {} numbers", numbers.len());
            return Err(bad_value(text));
        }
    })
}
