//! Traces along the curves of a query: one or many, built-in or user-defined.

use std::num::NonZeroUsize;

use pyo3::prelude::*;
use pyo3::types::PyIterator;
use rayweave::space::{Curve, SpaceError};

use super::curve::PyCurve;
use super::own::{OwnCurve, is_curve};
use super::{AnyCurve, Holds, Shared};
use crate::arrays::{double_array, shape_text};
use crate::engine::in_chunks;
use crate::error::{bad_type, bad_value, shown};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};

/// Curves per chunk of a thread; a curve is expensive.
const CHUNK: usize = 16;

/// A curve of the arguments.
enum Given<'py, const D: usize> {
    /// A built-in curve, which needs no GIL.
    Ours(Shared<D>),
    /// A user-defined curve.
    Own(OwnCurve<'py, D>),
}

/// All curves of a query.
struct Curves<'py, const D: usize> {
    curves: Vec<Given<'py, D>>,
    /// True if given as a list; messages then contain the index.
    many: bool,
}

/// Traces the curves of an object, one or a list of them, strictly between two times; `merge`
/// receives the results in order.
///
/// Built-in curves run on several threads without the GIL. If one of the curves is user-defined,
/// all run on this thread, one after the other. Exceptions of user functions propagate unchanged.
pub fn follow<const D: usize, M, A: Send>(
    curves: &Bound<'_, PyAny>,
    window: [&Bound<'_, PyAny>; 2],
    threads: Option<NonZeroUsize>,
    memory: impl Fn() -> M + Send + Sync,
    trace: impl Fn(&mut M, &dyn Curve<D>, f64, f64) -> Result<A, SpaceError> + Send + Sync,
    mut merge: impl FnMut(A) -> PyResult<()> + Send,
) -> PyResult<()>
where
    AnyCurve: Holds<Shared<D>>,
{
    let py = curves.py();
    let Curves { curves, many } = Curves::<D>::new(curves)?;
    let place = |k: usize| if many { format!("curves[{k}]: ") } else { String::new() };
    let [t_min, t_max] = [times(window[0], "t_min", curves.len())?, times(window[1], "t_max", curves.len())?];
    let bad = |k: usize, error: SpaceError| bad_value(format!("{}{error}", place(k)));
    let ours: Option<Vec<&Shared<D>>> = curves.iter().map(Given::ours).collect();
    if let Some(ours) = ours {
        let ours: Vec<Shared<D>> = ours.into_iter().cloned().collect();
        let work = |memory: &mut M, chunk: std::ops::Range<usize>| -> PyResult<Vec<A>> {
            chunk
                .map(|k| trace(memory, &*ours[k], t_min[k], t_max[k]).map_err(|error| bad(k, error)))
                .collect()
        };
        return py.detach(|| {
            in_chunks(ours.len(), CHUNK, threads, memory, work, |chunk| {
                chunk?.into_iter().try_for_each(&mut merge)
            })
        });
    }
    let mut memory = memory();
    for (k, curve) in curves.iter().enumerate() {
        let answer = match curve {
            Given::Ours(curve) => trace(&mut memory, &**curve, t_min[k], t_max[k]),
            Given::Own(curve) => {
                let answer = trace(&mut memory, curve, t_min[k], t_max[k]);
                if let Some(error) = curve.failure() {
                    return Err(if many { noted(py, error, k) } else { error });
                }
                answer
            }
        };
        merge(answer.map_err(|error| bad(k, error))?)?;
    }
    Ok(())
}

impl<const D: usize> Given<'_, D> {
    fn ours(&self) -> Option<&Shared<D>> {
        match self {
            Given::Ours(curve) => Some(curve),
            Given::Own(_) => None,
        }
    }
}

impl<'py, const D: usize> Curves<'py, D>
where
    AnyCurve: Holds<Shared<D>>,
{
    fn new(object: &Bound<'py, PyAny>) -> PyResult<Self> {
        if is_curve(object)? {
            return Ok(Curves { curves: vec![given(object.clone())?], many: false });
        }
        let wrong = |_| {
            bad_type(format!(
                "curves is {}: it must be a curve, which has position(t), velocity(t) and acceleration_bound(t0, t1), or a list of curves.",
                shown(object)
            ))
        };
        let all: Bound<'py, PyIterator> = object.try_iter().map_err(wrong)?;
        let curves =
            all.enumerate().map(|(k, item)| given(item?).map_err(|error| indexed(object.py(), error, k)));
        Ok(Curves { curves: curves.collect::<PyResult<_>>()?, many: true })
    }
}

/// A curve of the required dimension.
fn given<'py, const D: usize>(object: Bound<'py, PyAny>) -> PyResult<Given<'py, D>>
where
    AnyCurve: Holds<Shared<D>>,
{
    let Ok(curve) = object.cast::<PyCurve>() else {
        return OwnCurve::new(object).map(Given::Own);
    };
    let any = curve.get().any();
    match any.held() {
        Some(curve) => Ok(Given::Ours(curve.clone())),
        None => Err(bad_value(format!(
            "the curve is of dimension {} and the solid of dimension {D}: they must have the same dimension.",
            any.dimension()
        ))),
    }
}

/// One time for each curve: a number for all of them, or a list.
fn times(object: &Bound<'_, PyAny>, name: &str, count: usize) -> PyResult<Vec<f64>> {
    if let Ok(time) = object.extract::<f64>() {
        return Ok(vec![time; count]);
    }
    let array = double_array(object, name)?;
    if array.ndim() != 1 || array.len() != count {
        let shape = shape_text(array.shape());
        return Err(bad_value(format!(
            "{name} has shape {shape}: it must be a number or ({count},), one for each curve."
        )));
    }
    Ok(array.try_readonly().map_err(bad_value)?.as_array().iter().copied().collect())
}

/// Adds a note with the index of the curve to the exception.
fn noted(py: Python<'_>, error: PyErr, k: usize) -> PyErr {
    // an exception that cannot be annotated is passed on without the note
    let _ = error.value(py).call_method1("add_note", (format!("while tracing curves[{k}]"),));
    error
}

/// Prefixes the error with the index of the curve.
fn indexed(py: Python<'_>, error: PyErr, k: usize) -> PyErr {
    let text = format!("curves[{k}]: {}", error.value(py));
    if error.is_instance_of::<crate::error::RayweaveError>(py) {
        bad_value(text)
    } else if error.is_instance_of::<pyo3::exceptions::PyTypeError>(py) {
        bad_type(text)
    } else {
        error
    }
}
