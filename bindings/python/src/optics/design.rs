//! Tolerancing and optimisation.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayweave::lens::design::{
    DesignParameter, Goal, Merit, MtfKind, MtfLines, Operand, Optimiser, SeidelTerm, Spread, Target,
    Tolerancing,
};

use crate::engine::thread_argument;
use crate::error::bad_value;
use crate::optics::prescription::PyPrescription;

/// A parameter by name, the kind of its spread, and its scale or its two ends.
#[derive(FromPyObject)]
pub struct ErrorOf(String, String, Vec<f64>);

impl ErrorOf {
    fn read(&self) -> PyResult<(DesignParameter, Spread)> {
        let spread = match (self.1.as_str(), self.2.as_slice()) {
            ("uniform", &[scale]) => Spread::Uniform(scale),
            ("normal", &[scale]) => Spread::Normal(scale),
            ("between", &[low, high]) => Spread::Between(low, high),
            (other, _) => {
                let text = format!("the spread is {other:?}: it can be \"uniform\" or \"normal\".");
                return Err(bad_value(text));
            }
        };
        Ok((self.0.parse().map_err(bad_value)?, spread))
    }
}

/// Merits with their names.
const MERITS: [(&str, Merit); 7] = [
    ("spot", Merit::SpotRms),
    ("wavefront", Merit::WavefrontRms),
    ("wavefront about chief ray", Merit::WavefrontRmsAboutChiefRay),
    ("focal length", Merit::FocalLength),
    ("back focal distance", Merit::BackFocalDistance),
    ("image shift", Merit::ImageShift),
    ("transmitted", Merit::Transmitted),
];

/// Kinds of transfer functions with their names.
const MTF_KINDS: [(&str, MtfKind); 2] =
    [("geometric mtf", MtfKind::Geometric), ("diffraction mtf", MtfKind::Diffraction)];

/// Looks up a name; an unknown name is an error that lists the known ones.
fn named<T: Copy>(what: &str, name: &str, known: &[(&str, T)]) -> PyResult<T> {
    let found = known.iter().find(|(known, _)| *known == name);
    let names = || known.iter().map(|(name, _)| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
    found
        .map(|(_, value)| *value)
        .ok_or_else(|| bad_value(format!("{what} is {name:?}: it can be {}.", names())))
}

/// The merits of trials with their deviations, and the effect of each parameter alone.
#[pyfunction]
#[pyo3(signature = (
    lens, errors, merit, trials, *, frequency, refocus, vignette, rings, mirror_fields, seed, threads: "int | None"
) -> "dict[str, Any]")]
#[allow(clippy::too_many_arguments)] // those of the function in Python
pub fn tolerance<'py>(
    lens: &Bound<'py, PyPrescription>,
    errors: Vec<ErrorOf>,
    merit: &str,
    trials: u64,
    frequency: Option<f64>,
    refocus: bool,
    vignette: bool,
    rings: usize,
    mirror_fields: Option<bool>,
    seed: u64,
    threads: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let py = lens.py();
    let threads = threads.map(thread_argument).transpose()?;
    let merit = match (frequency, MTF_KINDS.iter().find(|(name, _)| *name == merit)) {
        (Some(frequency), Some((_, kind))) => Merit::Mtf { kind: *kind, frequency },
        _ => named("merit", merit, &MERITS)?,
    };
    let start = Tolerancing::new(lens.get().lens(), merit);
    let start = start.rings(rings).seed(seed).threads(threads);
    let start = if refocus { start.refocused() } else { start };
    let start = if vignette { start.vignetted() } else { start };
    let start = mirror_fields.into_iter().fold(start, Tolerancing::mirror_fields);
    let tolerancing = errors.iter().try_fold(start, |all, error| {
        let (parameter, spread) = error.read()?;
        Ok::<_, PyErr>(all.add(parameter, spread))
    })?;
    let (found, alone) = py
        .detach(|| Ok((tolerancing.trials(trials)?, tolerancing.sensitivities()?)))
        .map_err(|error: rayweave::lens::design::DesignError| bad_value(error))?;
    let table = PyDict::new(py);
    table.set_item("nominal", found.nominal)?;
    table.set_item("mirrored", mirror_fields.unwrap_or_else(|| tolerancing.has_one_sided_fields()))?;
    let columns = found.deviations.into_iter().map(|column| PyArray1::from_vec(py, column));
    table.set_item("deviations", columns.collect::<Vec<_>>())?;
    table.set_item("merits", PyArray1::from_vec(py, found.merits))?;
    table.set_item("shifts", PyArray1::from_vec(py, found.shifts))?;
    let lost = found.lost.into_iter().map(|lost| lost as i64).collect();
    table.set_item("lost", PyArray1::<i64>::from_vec(py, lost))?;
    let alone: Vec<(f64, f64, f64)> = alone.iter().map(|one| (one.minus, one.plus, one.slope)).collect();
    table.set_item("alone", alone)?;
    Ok(table)
}

/// Operands of one number with their names.
const OPERANDS: [(&str, Operand); 12] = [
    ("focal length", Operand::FocalLength),
    ("back focal distance", Operand::BackFocalDistance),
    ("defocus", Operand::Defocus),
    ("magnification", Operand::Magnification),
    ("total track", Operand::TotalTrack),
    ("spherical", Operand::Seidel(SeidelTerm::Spherical)),
    ("coma", Operand::Seidel(SeidelTerm::Coma)),
    ("astigmatism", Operand::Seidel(SeidelTerm::Astigmatism)),
    ("petzval", Operand::Seidel(SeidelTerm::Petzval)),
    ("distortion", Operand::Seidel(SeidelTerm::Distortion)),
    ("axial colour", Operand::Seidel(SeidelTerm::AxialColour)),
    ("lateral colour", Operand::Seidel(SeidelTerm::LateralColour)),
];

/// An operand by its name and numbers; a kind of target, its value, the upper end of a range, and the weight.
#[derive(FromPyObject)]
pub struct GoalOf(String, Vec<f64>, String, f64, f64, f64);

/// The number of a field or surface.
fn whole(what: &str, number: f64) -> PyResult<usize> {
    let is_whole = number >= 0.0 && number.fract() == 0.0;
    let problem = || bad_value(format!("{what} is {number}: it must be a whole number."));
    is_whole.then_some(number as usize).ok_or_else(problem)
}

impl GoalOf {
    fn read(&self) -> PyResult<Goal> {
        let GoalOf(name, numbers, target, value, upper, weight) = self;
        let operand = match (name.as_str(), numbers.as_slice()) {
            ("spot", &[field]) => Operand::Spot { field: whole("field", field)?, wavelength_nm: None },
            ("spot", &[field, wavelength_nm]) => {
                Operand::Spot { field: whole("field", field)?, wavelength_nm: Some(wavelength_nm) }
            }
            ("wavefront", &[field, wavelength_nm]) => {
                Operand::Wavefront { field: whole("field", field)?, wavelength_nm }
            }
            ("wavefront about chief ray", &[field, wavelength_nm]) => {
                Operand::WavefrontAboutChiefRay { field: whole("field", field)?, wavelength_nm }
            }
            ("distortion", &[field]) => Operand::Distortion { field: whole("field", field)? },
            ("clearance", &[field]) => Operand::Clearance { field: whole("field", field)? },
            (name, &[field, frequency, is_sagittal]) => Operand::Mtf {
                kind: named("operand", name, &MTF_KINDS)?,
                field: whole("field", field)?,
                frequency,
                lines: if is_sagittal == 0.0 { MtfLines::Tangential } else { MtfLines::Sagittal },
            },
            ("edge", &[surface, height]) => {
                Operand::EdgeThickness { surface: whole("surface", surface)?, height: Some(height) }
            }
            ("edge", &[surface]) => {
                Operand::EdgeThickness { surface: whole("surface", surface)?, height: None }
            }
            (name, []) => match name.parse() {
                Ok(parameter) => Operand::Value(parameter),
                Err(_) => named("operand", name, &OPERANDS)?,
            },
            (name, _) => {
                return Err(bad_value(format!(
                    "there is no operand {name:?} with {} numbers",
                    numbers.len()
                )));
            }
        };
        let kinds = [
            ("equal", Target::Equal(*value)),
            ("least", Target::AtLeast(*value)),
            ("most", Target::AtMost(*value)),
            ("range", Target::Between(*value, *upper)),
        ];
        Ok(Goal { operand, target: named("target", target, &kinds)?, weight: *weight })
    }
}

/// The prescription that an optimisation finds, the values of the parameters, and the course of the
/// optimisation.
#[pyfunction]
#[pyo3(signature = (
    lens, parameters, goals, *, rings, patience, aimed
) -> "tuple[CompiledPrescription, dict[str, Any]]")]
pub fn optimise<'py>(
    lens: &Bound<'py, PyPrescription>,
    parameters: Vec<String>,
    goals: Vec<GoalOf>,
    rings: usize,
    patience: usize,
    aimed: bool,
) -> PyResult<(PyPrescription, Bound<'py, PyDict>)> {
    let py = lens.py();
    let start = Optimiser::new(lens.get().lens()).rings(rings).evaluation_limit(patience);
    let start = if aimed { start.aimed() } else { start };
    let start = parameters
        .iter()
        .try_fold(start, |all, name| Ok::<_, PyErr>(all.vary(name.parse().map_err(bad_value)?)))?;
    let optimiser = goals.iter().try_fold(start, |all, goal| Ok::<_, PyErr>(all.goal(goal.read()?)))?;
    let found = py.detach(|| optimiser.run()).map_err(bad_value)?;
    let table = PyDict::new(py);
    let values = PyDict::new(py);
    for (parameter, value) in &found.values {
        values.set_item(parameter.to_string(), *value)?;
    }
    table.set_item("values", values)?;
    let goals = found.goals.iter().map(|goal| (goal.values, goal.contributions));
    table.set_item("goals", goals.collect::<Vec<_>>())?;
    let vignetted = PyDict::new(py);
    for (field, lost) in &found.vignetted {
        vignetted.set_item(*field, *lost)?;
    }
    table.set_item("vignetted", vignetted)?;
    table.set_item("before", found.before)?;
    table.set_item("after", found.after)?;
    table.set_item("evaluations", found.evaluations)?;
    table.set_item("has_converged", found.has_converged)?;
    table.set_item("reason", found.reason)?;
    Ok((PyPrescription::from(found.lens), table))
}
