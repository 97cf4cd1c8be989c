//! User-defined curves: any Python object with `position(t)`, `velocity(t)` and
//! `acceleration_bound(t0, t1)`.

use std::cell::RefCell;

use pyo3::prelude::*;
use rayweave::space::{Curve, Point};

use crate::arrays::list;
use crate::error::{bad_type, bad_value, shown};

/// Methods that an object must have to be a curve.
const METHODS: [&str; 3] = ["position", "velocity", "acceleration_bound"];

/// True if an object has a method of a curve, so that it is not a list of curves.
pub fn is_curve(object: &Bound<'_, PyAny>) -> PyResult<bool> {
    object.hasattr(METHODS[0])
}

/// A Python object as a curve in R^d. The trait has no errors, so the first exception is stored,
/// and NaN is returned in its place.
pub struct OwnCurve<'py, const D: usize> {
    object: Bound<'py, PyAny>,
    domain: (f64, f64),
    memory: RefCell<Memory<D>>,
}

#[derive(Default)]
struct Memory<const D: usize> {
    failed: Option<PyErr>,
    /// Cache of the last call: root isolation evaluates the same argument several times.
    position: Option<(f64, Point<D>)>,
    velocity: Option<(f64, Point<D>)>,
}

impl<'py, const D: usize> OwnCurve<'py, D> {
    /// The object as a curve, if it has the methods.
    pub fn new(object: Bound<'py, PyAny>) -> PyResult<Self> {
        for method in METHODS {
            if !object.hasattr(method)? {
                let kind = shown(&object);
                return Err(bad_type(format!(
                    "a curve is {kind}, without {method}: it must have position(t), velocity(t) and acceleration_bound(t0, t1)."
                )));
            }
        }
        let domain = match object.getattr_opt("domain")? {
            None => (f64::NEG_INFINITY, f64::INFINITY),
            Some(pair) => pair.extract().map_err(|_| {
                bad_type(format!("domain of a curve is {}: it must be a pair of times.", shown(&pair)))
            })?,
        };
        let memory = Memory { failed: None, position: None, velocity: None };
        Ok(OwnCurve { object, domain, memory: RefCell::new(memory) })
    }

    /// The first exception, if there was any.
    pub fn failure(&self) -> Option<PyErr> {
        self.memory.borrow_mut().failed.take()
    }

    fn has_failed(&self) -> bool {
        self.memory.borrow().failed.is_some()
    }

    /// A point or a vector from a method of the object.
    fn vector(&self, method: &str, t: f64) -> Point<D> {
        if self.has_failed() {
            return [f64::NAN; D];
        }
        let called = self.object.call_method1(method, (t,)).and_then(|answer| {
            let name = format!("{method}({t:?}) of the curve");
            let numbers = list(&answer, &name)?;
            let count = numbers.len();
            numbers.try_into().map_err(|_| {
                bad_value(format!(
                    "{name} has {count} numbers: it must have {D}, as many as the space has dimensions."
                ))
            })
        });
        called.unwrap_or_else(|error| {
            self.memory.borrow_mut().failed = Some(error);
            [f64::NAN; D]
        })
    }
}

impl<const D: usize> Curve<D> for OwnCurve<'_, D> {
    fn position(&self, t: f64) -> Point<D> {
        if let Some((_, position)) = self.memory.borrow().position.filter(|known| known.0 == t) {
            return position;
        }
        let position = self.vector(METHODS[0], t);
        self.memory.borrow_mut().position = Some((t, position));
        position
    }

    fn velocity(&self, t: f64) -> Point<D> {
        if let Some((_, velocity)) = self.memory.borrow().velocity.filter(|known| known.0 == t) {
            return velocity;
        }
        let velocity = self.vector(METHODS[1], t);
        self.memory.borrow_mut().velocity = Some((t, velocity));
        velocity
    }

    fn acceleration_bound(&self, t0: f64, t1: f64) -> f64 {
        if self.has_failed() {
            return f64::NAN;
        }
        let called = self.object.call_method1(METHODS[2], (t0, t1)).and_then(|answer| {
            let kind = shown(&answer);
            let wrong = move |_| {
                bad_type(format!(
                    "acceleration_bound({t0:?}, {t1:?}) of the curve is {kind}: it must be a number."
                ))
            };
            answer.extract::<f64>().map_err(wrong)
        });
        called.unwrap_or_else(|error| {
            self.memory.borrow_mut().failed = Some(error);
            f64::NAN
        })
    }

    fn domain(&self) -> (f64, f64) {
        self.domain
    }
}
