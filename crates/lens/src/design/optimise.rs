//! Optimisation by damped least squares (Levenberg-Marquardt).

use super::variant::{RINGS, Variant, pupil};
use super::{DesignError, DesignParameter, Goal, Quantity};
use crate::analysis::PupilQuadrature;
use crate::prescription::Prescription;
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::{DMatrix, DVector, Dyn, Owned};

/// Step of the central differences, in units of the scale of a parameter: about the cube root of the
/// roundoff, where rounding error and third-order error are equal (Nocedal & Wright, *Numerical
/// Optimization*, section 8.1).
const STEP: f64 = 1e-5;

/// Residual where no light arrives, in units of the norm at the start: worse than any acceptable step.
const PENALTY: f64 = 1e3;

/// Damped least squares: minimises the weighted sum of squares of the residuals of all goals, from a start
/// prescription.
///
/// The algorithm is Levenberg and Marquardt's in the form of J. J. Moré (MINPACK; *The Levenberg-Marquardt
/// algorithm*, Lecture Notes in Mathematics 630, 1978), with derivatives by central differences. It finds a
/// local minimum near the start, not the global one.
#[derive(Clone, Debug)]
pub struct Optimiser<'a> {
    lens: &'a Prescription,
    parameters: Vec<DesignParameter>,
    goals: Vec<Goal>,
    rings: usize,
    evaluation_limit: usize,
    aims: bool,
}

/// The result of an optimisation.
#[derive(Clone, Debug, PartialEq)]
pub struct Optimum {
    /// The optimised prescription.
    pub lens: Prescription,
    /// The parameters with their values.
    pub values: Vec<(DesignParameter, f64)>,
    /// The root of the sum of squares of all residuals at the start.
    pub before: f64,
    /// The same at the end.
    pub after: f64,
    /// The goals with their values at the start and at the end.
    pub goals: Vec<GoalReport>,
    /// The fields of spots, wavefronts and transfer functions that the stated semi-diameters of the result vignette, with the
    /// fraction of the pupil that is lost at the primary wavelength. The goals ignore vignetting.
    pub vignetted: Vec<(usize, f64)>,
    /// The number of evaluations of the residuals, without those for derivatives.
    pub evaluations: usize,
    /// True if no step improves the result further; false if the evaluation limit ended the search.
    pub has_converged: bool,
    /// The reason for the end.
    pub reason: String,
}

/// A goal with its values at the start and at the end of an optimisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoalReport {
    /// The goal.
    pub goal: Goal,
    /// The values of its operand, those of rays as the root of the sum of their squares: the RMS radius of a spot, the RMS
    /// of a wavefront.
    pub values: [f64; 2],
    /// The sums of squares of its weighted residuals. Their sums over all goals are the squares of
    /// [`Optimum::before`] and [`Optimum::after`].
    pub contributions: [f64; 2],
}

impl<'a> Optimiser<'a> {
    /// An optimiser that starts from a prescription, with 6 rings of rays in the pupil
    /// ([`PupilQuadrature::gaussian`]).
    pub fn new(lens: &'a Prescription) -> Optimiser<'a> {
        Optimiser {
            lens,
            parameters: Vec::new(),
            goals: Vec::new(),
            rings: RINGS,
            evaluation_limit: 100,
            aims: false,
        }
    }

    /// Adds a parameter to vary. Decentres and tilts cannot be varied.
    pub fn vary(mut self, parameter: DesignParameter) -> Optimiser<'a> {
        self.parameters.push(parameter);
        self
    }

    /// Adds a goal.
    pub fn goal(mut self, goal: Goal) -> Optimiser<'a> {
        self.goals.push(goal);
        self
    }

    /// Sets the number of rings of rays in the pupil.
    pub fn rings(self, rings: usize) -> Optimiser<'a> {
        Optimiser { rings, ..self }
    }

    /// Aims rays at the stop: points of the pupil become points of the stop, as for
    /// [`Study::aimed`](crate::analysis::Study::aimed). Needed for wide fields; each evaluation takes several times as long.
    pub fn aimed(self) -> Optimiser<'a> {
        Optimiser { aims: true, ..self }
    }

    /// Limits the evaluations to `evaluation_limit` times the number of parameters plus one; the default is 100.
    pub fn evaluation_limit(self, evaluation_limit: usize) -> Optimiser<'a> {
        Optimiser { evaluation_limit: evaluation_limit.max(1), ..self }
    }

    /// Runs the search.
    ///
    /// # Errors
    /// [`DesignError`] for parameters that do not exist, goals without a value at the start, no parameters or
    /// no goals.
    pub fn run(&self) -> Result<Optimum, DesignError> {
        let task = self.task()?;
        let start = match task.values_at(&task.at)? {
            Some(values) => values,
            None => return Err(task.no_start()?),
        };
        let residuals = task.residuals_of(&start);
        let before = residuals.norm();
        let penalty = PENALTY * before.max(f64::MIN_POSITIVE);
        let task = Task { penalty, residual_count: residuals.len(), ..task };
        let (task, report) = LevenbergMarquardt::new().with_patience(self.evaluation_limit).minimize(task);
        let variant = task.variant(&task.at)?;
        // the search ends where the goals have values
        let end = task.values_at(&task.at)?.unwrap_or_else(|| vec![f64::NAN; start.len()]);
        let value = |&parameter: &DesignParameter| Ok((parameter, parameter.value(&variant.lens)?));
        Ok(Optimum {
            values: self.parameters.iter().map(value).collect::<Result<_, DesignError>>()?,
            before,
            goals: task.reports([&start, &end]),
            vignetted: task.vignetted(&variant)?,
            after: (2.0 * report.objective_function).sqrt(),
            evaluations: report.number_of_evaluations,
            has_converged: has_converged(&report.termination),
            reason: format!("{:?}", report.termination),
            lens: variant.lens,
        })
    }

    fn task(&self) -> Result<Task<'_>, DesignError> {
        if self.parameters.is_empty() {
            return Err(DesignError::None("parameter to vary"));
        }
        if self.goals.is_empty() {
            return Err(DesignError::None("goal"));
        }
        if let Some(&parameter) = self.parameters.iter().find(|parameter| parameter.quantity.is_pose()) {
            return Err(DesignError::Absent { parameter, why: "decentres and tilts cannot be varied" });
        }
        let scale = |parameter: &DesignParameter| scale(*parameter, self.lens);
        let scales: Vec<f64> = self.parameters.iter().map(scale).collect::<Result<_, _>>()?;
        Ok(Task {
            optimiser: self,
            pupil: pupil(self.rings)?,
            at: DVector::zeros(scales.len()),
            scales,
            residual_count: 0,
            penalty: f64::INFINITY,
        })
    }
}

/// The scale of a parameter, such that changes by one scale affect a prescription about equally: derived
/// from the length of the system for lengths and curvatures, and also from the pupil height for aspheric
/// terms.
fn scale(parameter: DesignParameter, lens: &Prescription) -> Result<f64, DesignError> {
    let value = parameter.value(lens)?;
    let length = lens.surfaces.iter().map(|surface| surface.thickness.abs()).sum::<f64>();
    let length = if length > 0.0 { length } else { 1.0 };
    Ok(match parameter.quantity {
        Quantity::Radius => value.abs(),
        Quantity::Curvature => 1.0 / length,
        Quantity::Thickness => length,
        // as high at the rim of the pupil as a sphere of the curvature above
        Quantity::Term(power) => {
            let height = 0.5 * lens.first_order(lens.primary_nm())?.entrance_pupil.diameter;
            let height = if height > 0.0 && height.is_finite() { height } else { length };
            0.5 / length * libm::pow(height, 2.0 - f64::from(power))
        }
        _ => 1.0,
    })
}

fn has_converged(reason: &TerminationReason) -> bool {
    // rounding allows no better step: a minimum
    reason.was_successful() || matches!(reason, TerminationReason::NoImprovementPossible(_))
}

/// The least-squares problem; its variables are changes of parameters in units of their scales.
#[derive(Clone, Debug)]
struct Task<'a> {
    optimiser: &'a Optimiser<'a>,
    pupil: PupilQuadrature,
    scales: Vec<f64>,
    at: DVector<f64>,
    /// The number of residuals, with padding.
    residual_count: usize,
    /// The residual used where no light arrives.
    penalty: f64,
}

impl Task<'_> {
    fn variant(&self, at: &DVector<f64>) -> Result<Variant, DesignError> {
        let parameters = self.optimiser.parameters.iter().copied();
        let changes = parameters.zip(at.iter().zip(&self.scales).map(|(at, scale)| at * scale));
        let variant = Variant::new(self.optimiser.lens, &changes.collect::<Vec<_>>())?;
        Ok(Variant { aims: self.optimiser.aims, ..variant })
    }

    /// The values of all goals; `None` if a ray that they need does not arrive.
    fn values_at(&self, at: &DVector<f64>) -> Result<Option<Vec<f64>>, DesignError> {
        let variant = self.variant(at)?;
        let mut all = Vec::new();
        for goal in &self.optimiser.goals {
            match goal.values(&variant, &self.pupil)? {
                Some(values) => all.extend(values),
                None => return Ok(None),
            }
        }
        Ok(Some(all))
    }

    /// The error about the first goal without values at the start.
    fn no_start(&self) -> Result<DesignError, DesignError> {
        let variant = self.variant(&self.at)?;
        let mut number = 1;
        for goal in &self.optimiser.goals {
            if goal.values(&variant, &self.pupil)?.is_none() {
                break;
            }
            number += 1;
        }
        Ok(DesignError::NoStart { goal: number, goals: self.optimiser.goals.len() })
    }

    /// The goals with their parts of a list of all values.
    fn goals_with<'v>(&self, values: &'v [f64]) -> impl Iterator<Item = (&Goal, &'v [f64])> {
        let mut rest = values;
        self.optimiser.goals.iter().map(move |goal| {
            let (own, others) = rest.split_at(self.value_count_of(goal));
            rest = others;
            (goal, own)
        })
    }

    /// The residuals, padded with zeros to at least one per parameter.
    fn residuals_of(&self, values: &[f64]) -> DVector<f64> {
        let mut residuals: Vec<f64> =
            self.goals_with(values).flat_map(|(goal, own)| goal.residuals(own)).collect();
        residuals.resize(residuals.len().max(self.scales.len()), 0.0);
        DVector::from_vec(residuals)
    }

    /// The derivatives of all values with respect to a parameter, by central differences.
    fn changes(&self, parameter: usize) -> Option<Vec<f64>> {
        let values_after = |step: f64| {
            let mut at = self.at.clone();
            at[parameter] += step;
            self.values_at(&at).ok().flatten()
        };
        let (plus, minus) = (values_after(STEP)?, values_after(-STEP)?);
        Some(plus.iter().zip(&minus).map(|(plus, minus)| (plus - minus) / (2.0 * STEP)).collect())
    }

    /// The goals with their values at the start and at the end.
    fn reports(&self, [start, end]: [&[f64]; 2]) -> Vec<GoalReport> {
        let square = |residuals: Vec<f64>| residuals.iter().map(|residual| residual * residual).sum();
        let pairs = self.goals_with(start).zip(self.goals_with(end));
        pairs
            .map(|((goal, start), (_, end))| GoalReport {
                goal: *goal,
                values: [goal.value(start), goal.value(end)],
                contributions: [square(goal.residuals(start)), square(goal.residuals(end))],
            })
            .collect()
    }

    /// The vignetted fields of the goals, and the fraction of the pupil that each one loses.
    fn vignetted(&self, variant: &Variant) -> Result<Vec<(usize, f64)>, DesignError> {
        let mut fields: Vec<usize> = self.optimiser.goals.iter().filter_map(Goal::pupil_field).collect();
        fields.sort_unstable();
        fields.dedup();
        let clipped = Variant { vignettes: true, ..variant.clone() };
        let nm = variant.lens.primary_nm();
        let power = |variant: &Variant, field: usize| {
            let rays = variant.arrivals(field, nm, &self.pupil)?;
            Ok::<f64, DesignError>(rays.iter().map(|ray| ray.power).sum())
        };
        let mut found = Vec::new();
        for field in fields {
            let lost = 1.0 - power(&clipped, field)? / power(variant, field)?;
            found.extend((lost > 0.0).then_some((field, lost)));
        }
        Ok(found)
    }

    /// The number of values of a goal.
    fn value_count_of(&self, goal: &Goal) -> usize {
        goal.value_count(self.pupil.points.len(), self.optimiser.lens.lines.len())
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Task<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, at: &DVector<f64>) {
        self.at.copy_from(at);
    }

    fn params(&self) -> DVector<f64> {
        self.at.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        // a step to where no light arrives, or to values out of range, is a bad step, not the end of the
        // search
        let penalty = || DVector::from_element(self.residual_count, self.penalty);
        Some(
            self.values_at(&self.at).ok().flatten().map_or_else(penalty, |values| self.residuals_of(&values)),
        )
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        // derivatives of the values, because the residuals have a kink at a bound
        let values = self.values_at(&self.at).ok().flatten()?;
        let mut jacobian = DMatrix::zeros(self.residual_count, self.scales.len());
        for parameter in 0..self.scales.len() {
            let changes = self.changes(parameter)?;
            let goals = self.goals_with(&values).zip(self.goals_with(&changes));
            let column =
                goals.flat_map(|((goal, values), (_, changes))| goal.residual_changes(values, changes));
            for (row, change) in column.enumerate() {
                jacobian[(row, parameter)] = change;
            }
        }
        Some(jacobian)
    }
}
