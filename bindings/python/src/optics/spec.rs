//! Kinds with their numbers: finishes, actions, laws and figures in the form that Python uses.

use pyo3::prelude::*;
use rayweave::math::Vec3;
use rayweave::optics::interface::Film;
use rayweave::optics::{Action, Finish};

use crate::error::bad_value;

/// A kind with its numbers, in the form that is returned to Python.
pub type SpecOut = (&'static str, Vec<f64>);

/// A kind with its numbers.
#[derive(FromPyObject)]
pub struct Spec(String, Vec<f64>);

impl Spec {
    /// The kind.
    pub fn kind(&self) -> &str {
        &self.0
    }

    /// Its numbers.
    pub fn numbers(&self) -> &[f64] {
        &self.1
    }

    /// The finish.
    pub fn finish(&self) -> PyResult<Finish> {
        Ok(match (self.0.as_str(), self.1.as_slice()) {
            ("polished", []) => Finish::Polished,
            ("absorber", []) => Finish::Absorber,
            ("mirror", &[reflectance]) => Finish::Mirror { reflectance },
            ("splitter", &[reflectance]) => Finish::Splitter { reflectance },
            ("diffuse", &[reflectance]) => Finish::Diffuse { reflectance },
            ("rough", &[slope]) => Finish::Rough { slope },
            ("coated", films) if films.len() % 3 == 0 => {
                let film = |film: &[f64]| Film::new(film[0], film[1], film[2]);
                Finish::Coated(films.chunks_exact(3).map(film).collect())
            }
            (kind, numbers) => return Err(unknown("finish", kind, numbers)),
        })
    }

    /// The action of a sheet.
    pub fn action(&self) -> PyResult<Action> {
        Ok(match (self.0.as_str(), self.1.as_slice()) {
            ("absorb", []) => Action::Absorb,
            ("record", []) => Action::Record,
            ("mirror", &[reflectance]) => Action::Mirror { reflectance },
            ("splitter", &[reflectance]) => Action::Splitter { reflectance },
            ("thin_lens", &[focal_length]) => Action::ThinLens { focal_length },
            ("grating", &[x, y, order, reflects]) => Action::Grating {
                lines: Vec3::new(x, y, 0.0),
                order: order as i32,
                reflects: reflects != 0.0,
            },
            ("polariser", &[x, y]) => Action::Polariser { axis: Vec3::new(x, y, 0.0) },
            ("retarder", &[x, y, retardance_degrees]) => {
                Action::Retarder { axis: Vec3::new(x, y, 0.0), retardance_degrees }
            }
            (kind, numbers) => return Err(unknown("action", kind, numbers)),
        })
    }
}

/// The error for an unknown kind, or a wrong number of numbers.
pub fn unknown(what: &str, kind: &str, numbers: &[f64]) -> PyErr {
    bad_value(format!("there is no {what} {kind:?} with {} numbers", numbers.len()))
}

/// A finish as a kind with its numbers.
pub fn spec_of_finish(finish: &Finish) -> SpecOut {
    match finish {
        Finish::Polished => ("polished", Vec::new()),
        Finish::Absorber => ("absorber", Vec::new()),
        Finish::Mirror { reflectance } => ("mirror", vec![*reflectance]),
        Finish::Splitter { reflectance } => ("splitter", vec![*reflectance]),
        Finish::Diffuse { reflectance } => ("diffuse", vec![*reflectance]),
        Finish::Rough { slope } => ("rough", vec![*slope]),
        Finish::Coated(films) => {
            let numbers = films.iter().flat_map(|film| [film.index.re, film.index.im, film.thickness_nm]);
            ("coated", numbers.collect())
        }
    }
}

/// An action as a kind with its numbers.
pub fn spec_of_action(action: &Action) -> SpecOut {
    match action {
        Action::Absorb => ("absorb", Vec::new()),
        Action::Record => ("record", Vec::new()),
        Action::Mirror { reflectance } => ("mirror", vec![*reflectance]),
        Action::Splitter { reflectance } => ("splitter", vec![*reflectance]),
        Action::ThinLens { focal_length } => ("thin_lens", vec![*focal_length]),
        Action::Grating { lines, order, reflects } => {
            ("grating", vec![lines.x, lines.y, f64::from(*order), f64::from(u8::from(*reflects))])
        }
        Action::Polariser { axis } => ("polariser", vec![axis.x, axis.y]),
        Action::Retarder { axis, retardance_degrees } => {
            ("retarder", vec![axis.x, axis.y, *retardance_degrees])
        }
    }
}
