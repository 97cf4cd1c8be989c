//! Surfaces of prescriptions as rows.

use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use rayweave::lens::prescription::{Behind, Surface};
use rayweave::optics::Medium;
use rayweave::optics::component::{Figure, Zernike};

use crate::error::bad_value;
use crate::optics::component::terms;
use crate::optics::glass::PyGlass;
use crate::optics::spec::{Spec, SpecOut};

/// The material behind a surface: "air", "mirror" or the name of a glass; an index, n_d and V_d, or
/// a glass.
#[derive(FromPyObject)]
enum MaterialBehind<'py> {
    Glass(PyRef<'py, PyGlass>),
    Name(String),
    Index(f64),
    Model(f64, f64),
}

impl MaterialBehind<'_> {
    fn behind(&self) -> Behind {
        match self {
            MaterialBehind::Glass(glass) => Behind::Medium(Medium::from(glass.0.clone())),
            MaterialBehind::Name(name) if name == "air" => Behind::Air,
            MaterialBehind::Name(name) if name == "mirror" => Behind::Mirror,
            MaterialBehind::Name(name) => Behind::Glass(name.clone()),
            MaterialBehind::Index(n) => Behind::Index(*n),
            MaterialBehind::Model(n_d, v_d) => Behind::Abbe { n_d: *n_d, v_d: *v_d },
        }
    }
}

fn material_behind<'py>(py: Python<'py>, behind: &Behind) -> PyResult<Bound<'py, PyAny>> {
    match behind {
        Behind::Air => "air".into_bound_py_any(py),
        Behind::Mirror => "mirror".into_bound_py_any(py),
        Behind::Glass(name) => name.into_bound_py_any(py),
        Behind::Index(n) => n.into_bound_py_any(py),
        Behind::Abbe { n_d, v_d } => (*n_d, *v_d).into_bound_py_any(py),
        Behind::Medium(medium) => match (medium.as_glass(), medium.as_constant()) {
            (Some(glass), _) => PyGlass(glass.clone()).into_bound_py_any(py),
            (None, Some(index)) => index.re.into_bound_py_any(py),
            (None, None) => Err(bad_value(format!(
                "{}: a law of dispersion has no name in Python. Use a glass or an index.",
                medium.name()
            ))),
        },
    }
}

/// The clear and the mechanical semi-diameter.
type SemiDiameters = (Option<f64>, Option<f64>);

/// Radius, thickness, material, conic constant, semi-diameters and hole of a surface, its even and odd terms, and its figure.
#[derive(FromPyObject)]
pub struct Row<'py>(f64, f64, MaterialBehind<'py>, f64, SemiDiameters, f64, Vec<f64>, Vec<f64>, Spec);

impl Row<'_> {
    /// The surface.
    pub fn surface(&self) -> PyResult<Surface> {
        let Row(radius, thickness, behind, conic, semi_diameters, hole, even, odd, shape) = self;
        let surface = Surface::new(*radius, *thickness, behind.behind()).conic(*conic).hole(*hole);
        let surface = surface.even(terms("even", even)?).odd(terms("odd", odd)?).figure(figure(shape)?);
        let (semi_diameter, mechanical_semi_diameter) = *semi_diameters;
        Ok(Surface { semi_diameter, mechanical_semi_diameter, ..surface })
    }
}

/// The figure of a name and numbers.
fn figure(spec: &Spec) -> PyResult<Figure> {
    let zernike = |order, norm_radius, coefficients: &[f64]| Figure::Zernike {
        order,
        norm_radius,
        coefficients: coefficients.to_vec(),
    };
    Ok(match (spec.kind(), spec.numbers()) {
        ("round", []) => Figure::Round,
        ("biconic", &[radius_x, conic_x]) => Figure::Biconic { radius_x, conic_x },
        ("toroidal", &[turn]) => Figure::Toroidal { turn },
        ("polynomial", &[norm_radius, ref coefficients @ ..]) => {
            Figure::Polynomial { norm_radius, coefficients: coefficients.to_vec() }
        }
        ("noll", &[norm_radius, ref coefficients @ ..]) => zernike(Zernike::Noll, norm_radius, coefficients),
        ("osa", &[norm_radius, ref coefficients @ ..]) => zernike(Zernike::Osa, norm_radius, coefficients),
        ("fringe", &[norm_radius, ref coefficients @ ..]) => {
            zernike(Zernike::Fringe, norm_radius, coefficients)
        }
        (kind, numbers) => {
            return Err(bad_value(format!("there is no figure {kind:?} with {} numbers", numbers.len())));
        }
    })
}

fn figure_out(figure: &Figure) -> SpecOut {
    let (name, numbers) = match figure {
        Figure::Round => ("round", vec![]),
        Figure::Biconic { radius_x, conic_x } => ("biconic", vec![*radius_x, *conic_x]),
        Figure::Toroidal { turn } => ("toroidal", vec![*turn]),
        Figure::Polynomial { norm_radius, coefficients } => {
            ("polynomial", [&[*norm_radius], &coefficients[..]].concat())
        }
        Figure::Zernike { order, norm_radius, coefficients } => {
            let name = match order {
                Zernike::Noll => "noll",
                Zernike::Osa => "osa",
                Zernike::Fringe => "fringe",
            };
            (name, [&[*norm_radius], &coefficients[..]].concat())
        }
    };
    (name, numbers)
}

/// The coefficients up to the last that is not 0.
fn given(terms: &[f64; 8]) -> Vec<f64> {
    let count = terms.iter().rposition(|&c| c != 0.0).map_or(0, |last| last + 1);
    terms[..count].to_vec()
}

/// The row in the form that is returned to Python.
pub type RowOut<'py> = (f64, f64, Bound<'py, PyAny>, f64, SemiDiameters, f64, Vec<f64>, Vec<f64>, SpecOut);

/// The row of a surface.
pub fn row_of<'py>(py: Python<'py>, surface: &Surface) -> PyResult<RowOut<'py>> {
    let behind = material_behind(py, &surface.behind)?;
    let Surface { radius, thickness, conic, hole, even, odd, figure, .. } = surface;
    let semi_diameters = (surface.semi_diameter, surface.mechanical_semi_diameter);
    let (even, odd, figure) = (given(even), given(odd), figure_out(figure));
    Ok((*radius, *thickness, behind, *conic, semi_diameters, *hole, even, odd, figure))
}
