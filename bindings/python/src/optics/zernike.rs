//! Zernike polynomials.

use numpy::PyArray1;
use pyo3::prelude::*;
use rayweave::lens::analysis::{ZernikePolynomial, fit_zernike};

use crate::arrays::list;
use crate::error::bad_value;
use crate::vectors::points;

/// The polynomial of an order and a frequency, if there is one.
fn zernike((n, m): (u32, i32)) -> PyResult<ZernikePolynomial> {
    let has_term = m.unsigned_abs() <= n && (n - m.unsigned_abs()).is_multiple_of(2);
    let problem =
        || bad_value(format!("there is no Zernike polynomial n = {n}, m = {m}: n - |m| is even and >= 0."));
    has_term.then_some(ZernikePolynomial { n, m }).ok_or_else(problem)
}

/// The radial order and the azimuthal frequency for an index: "noll" from 1, "osa" from 0.
#[pyfunction]
#[pyo3(signature = (scheme, index))]
pub fn zernike_term(scheme: &str, index: u32) -> PyResult<(u32, i32)> {
    let zernike = match (scheme, index) {
        ("noll", 1..) => ZernikePolynomial::noll(index),
        ("noll", _) => return Err(bad_value("the Noll index is 0: it counts from 1.")),
        ("osa", _) => ZernikePolynomial::osa(index),
        (other, _) => {
            return Err(bad_value(format!("the scheme is {other:?}: it can be \"noll\" or \"osa\".")));
        }
    };
    Ok((zernike.n, zernike.m))
}

/// The values of a Zernike polynomial at points (N, 2) of the unit disk.
#[pyfunction]
#[pyo3(signature = (term, pupil: "ArrayLike"))]
pub fn zernike_values<'py>(
    term: (u32, i32),
    pupil: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let zernike = zernike(term)?;
    let values = points(pupil, "pupil")?.into_iter().map(|point| zernike.at(point)).collect();
    Ok(PyArray1::from_vec(pupil.py(), values))
}

/// The coefficients of the least-squares fit, and the RMS of the residual.
#[pyfunction]
#[pyo3(signature = (pupil: "ArrayLike", values: "ArrayLike", terms))]
pub fn zernike_fit<'py>(
    pupil: &Bound<'py, PyAny>,
    values: &Bound<'py, PyAny>,
    terms: Vec<(u32, i32)>,
) -> PyResult<(Bound<'py, PyArray1<f64>>, f64)> {
    let (at, wanted) = (points(pupil, "pupil")?, list(values, "values")?);
    if at.len() != wanted.len() {
        let counts = format!("pupil has {} rows and values has {}", at.len(), wanted.len());
        return Err(bad_value(format!("{counts}: there must be one value for each point.")));
    }
    let terms: Vec<ZernikePolynomial> = terms.into_iter().map(zernike).collect::<PyResult<_>>()?;
    let fit = pupil.py().detach(|| fit_zernike(&at, &wanted, &terms)).map_err(bad_value)?;
    let coefficients = fit.terms.iter().map(|term| term.1).collect();
    Ok((PyArray1::from_vec(pupil.py(), coefficients), fit.residual_rms))
}
