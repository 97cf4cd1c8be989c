//! Tolerance analysis: effect of manufacturing and mounting errors on a merit, by Monte Carlo trials and
//! sensitivities.

use super::merit::{MeritEvaluator, MeritValue};
use super::variant::{RINGS, pupil};
use super::{DesignError, DesignParameter, Merit};
use crate::prescription::Prescription;
use rand::rngs::ChaCha8Rng;
use rand::{Rng, SeedableRng};
use rayweave_math::unit_fraction;
use rayweave_model::drive::{Cancel, Stopped, drive, thread_count};
use rayweave_model::memory::Growth;
use rayweave_optics::component::SurfaceForm;
use std::num::NonZeroUsize;

/// Random stream of tolerances, distinct from other streams of the same seed.
const TOLERANCES: u64 = u64::from_be_bytes(*b"tolerate");

/// Trials per chunk of work.
const CHUNK: u64 = 16;

/// The distribution of the error of a parameter, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spread {
    /// Uniform between minus and plus this value.
    Uniform(f64),
    /// A normal distribution of this standard deviation.
    Normal(f64),
    /// Uniform from the first value to the second.
    Between(f64, f64),
}

impl Spread {
    /// The lower and the upper end; for a normal distribution the standard deviation to both sides.
    pub fn ends(self) -> [f64; 2] {
        match self {
            Spread::Uniform(scale) | Spread::Normal(scale) => [-scale, scale],
            Spread::Between(low, high) => [low, high],
        }
    }

    /// The greatest distance of an end from 0: the half width, or the standard deviation.
    pub fn scale(self) -> f64 {
        match self {
            Spread::Uniform(scale) | Spread::Normal(scale) => scale,
            Spread::Between(low, high) => low.abs().max(high.abs()),
        }
    }

    /// The error of a trial, from two numbers uniform in [0, 1); the normal distribution by the transform of
    /// G. E. P. Box and M. E. Muller, Ann. Math. Stat. 29, 610, 1958.
    fn deviation(self, [a, b]: [f64; 2]) -> f64 {
        match self {
            Spread::Uniform(scale) => scale * (2.0 * a - 1.0),
            Spread::Between(low, high) => low + (high - low) * a,
            Spread::Normal(scale) => {
                scale * (-2.0 * libm::log1p(-a)).sqrt() * libm::cos(std::f64::consts::TAU * b)
            }
        }
    }
}

/// Monte Carlo tolerancing: parameters with random errors, and a merit.
///
/// Each position in the list of parameters has a random stream, and trial k uses its k-th entry. A trial
/// therefore does not depend on the number of trials or threads, and appending parameters does not change the
/// errors of earlier ones.
#[derive(Clone, Debug)]
pub struct Tolerancing<'a> {
    lens: &'a Prescription,
    merit: Merit,
    errors: Vec<(DesignParameter, Spread)>,
    refocus: bool,
    vignettes: bool,
    rings: usize,
    mirrors_fields: Option<bool>,
    seed: u64,
    threads: Option<NonZeroUsize>,
    cancel: Cancel,
}

impl<'a> Tolerancing<'a> {
    /// Tolerancing of a prescription, without errors yet, with 6 rings of rays in the pupil
    /// ([`PupilQuadrature::gaussian`](crate::analysis::PupilQuadrature::gaussian)).
    pub fn new(lens: &'a Prescription, merit: Merit) -> Tolerancing<'a> {
        Tolerancing {
            lens,
            merit,
            errors: Vec::new(),
            refocus: false,
            vignettes: false,
            rings: RINGS,
            mirrors_fields: None,
            seed: 0,
            threads: None,
            cancel: Cancel::new(),
        }
    }

    /// Adds a parameter with an error.
    pub fn add(mut self, parameter: DesignParameter, spread: Spread) -> Tolerancing<'a> {
        self.errors.push((parameter, spread));
        self
    }

    /// Refocuses every trial: moves the image along the axis to the least mean square radius of all spots.
    pub fn refocused(self) -> Tolerancing<'a> {
        Tolerancing { refocus: true, ..self }
    }

    /// Enables vignetting: a ray ends where it hits a surface outside its stated semi-diameter, or in its hole.
    pub fn vignetted(self) -> Tolerancing<'a> {
        Tolerancing { vignettes: true, ..self }
    }

    /// Sets the number of rings of rays in the pupil.
    pub fn rings(self, rings: usize) -> Tolerancing<'a> {
        Tolerancing { rings, ..self }
    }

    /// Evaluates each field also at its mirror image on the other side of the axis, with half the weight of the
    /// field for each of the two, or does not. By default the answer is [`Tolerancing::has_one_sided_fields`].
    pub fn mirror_fields(self, mirrors: bool) -> Tolerancing<'a> {
        Tolerancing { mirrors_fields: Some(mirrors), ..self }
    }

    /// True if fields lie on one side of the axis only, the lens is the same on both sides, and a parameter
    /// with an error decentres or tilts surfaces. Such an error can improve the given fields as much as it spoils
    /// those on the other side, so that a merit of the given fields alone has no minimum without errors.
    pub fn has_one_sided_fields(&self) -> bool {
        let fields = &self.lens.fields;
        let is_opposite = |&[a, b]: &[f64; 2], &[c, d]: &[f64; 2]| a * c + b * d < 0.0;
        let has_both = fields.iter().any(|one| fields.iter().any(|other| is_opposite(one, other)));
        let is_off_axis = fields.iter().any(|field| *field != [0.0; 2]);
        let is_round = |surface: &crate::prescription::Surface| SurfaceForm::is_round(&surface.form());
        let is_symmetric = self.lens.breaks.is_empty() && self.lens.surfaces.iter().all(is_round);
        let moves = self.errors.iter().any(|(parameter, _)| parameter.quantity.is_pose());
        moves && is_symmetric && is_off_axis && !has_both
    }

    /// The prescription with the mirror images of its fields where they are evaluated, behind the given ones, and the weight
    /// of each field.
    fn evaluated(&self) -> (Prescription, Vec<f64>) {
        let mut lens = self.lens.clone();
        if !self.mirrors_fields.unwrap_or_else(|| self.has_one_sided_fields()) {
            let weights = vec![1.0; lens.fields.len()];
            return (lens, weights);
        }
        let is_central = |field: &[f64; 2]| *field == [0.0; 2];
        let mut weights: Vec<f64> =
            lens.fields.iter().map(|field| if is_central(field) { 2.0 } else { 1.0 }).collect();
        let mirrored: Vec<[f64; 2]> =
            lens.fields.iter().filter(|field| !is_central(field)).map(|[x, y]| [-x, -y]).collect();
        weights.resize(weights.len() + mirrored.len(), 1.0);
        lens.fields.extend(mirrored);
        (lens, weights)
    }

    /// Sets the seed of the random numbers.
    pub fn seed(self, seed: u64) -> Tolerancing<'a> {
        Tolerancing { seed, ..self }
    }

    /// Sets the number of threads.
    pub fn threads(self, threads: Option<NonZeroUsize>) -> Tolerancing<'a> {
        Tolerancing { threads, ..self }
    }

    /// Sets a cancellation token.
    pub fn cancel(self, cancel: Cancel) -> Tolerancing<'a> {
        Tolerancing { cancel, ..self }
    }

    /// The merit without errors.
    ///
    /// # Errors
    /// [`DesignError`] for parameters that do not exist, spreads below 0, and invalid prescriptions.
    pub fn nominal(&self) -> Result<f64, DesignError> {
        let (lens, evaluator) = self.evaluator()?;
        Ok(evaluator.evaluate(&lens, &[])?.merit)
    }

    /// The prescription with all fields that are evaluated, and the evaluator of the merit.
    fn evaluator(&self) -> Result<(Prescription, MeritEvaluator), DesignError> {
        for (parameter, spread) in &self.errors {
            parameter.value(self.lens)?;
            if let Spread::Between(low, high) = *spread
                && !(low <= high && low.is_finite() && high.is_finite())
            {
                let (what, range) =
                    (format!("the upper end of the spread of {parameter}"), "at least the lower end");
                return Err(DesignError::BadNumber { what, value: high, range });
            }
            let scale = spread.scale();
            if !(scale >= 0.0 && scale.is_finite()) {
                let (what, range) = (format!("the spread of {parameter}"), "at least 0 and finite");
                return Err(DesignError::BadNumber { what, value: scale, range });
            }
        }
        let (lens, weights) = self.evaluated();
        let settings = [self.refocus, self.vignettes];
        let evaluator = MeritEvaluator::new(&lens, self.merit, settings, pupil(self.rings)?, weights)?;
        Ok((lens, evaluator))
    }

    /// Runs `count` trials. The merit is NaN in a trial in which no light arrives or a number is out of its
    /// range.
    ///
    /// # Errors
    /// As for [`Tolerancing::nominal`], and [`DesignError::None`] without errors, and
    /// [`DesignError::Memory`] for trials that do not fit into memory. A cancelled run returns
    /// fewer trials.
    pub fn trials(&self, count: u64) -> Result<Trials, DesignError> {
        if self.errors.is_empty() {
            return Err(DesignError::None("parameter with an error"));
        }
        let ((lens, evaluator), mut growth) = (self.evaluator()?, Growth::default());
        let mut trials = Trials {
            nominal: evaluator.evaluate(&lens, &[])?.merit,
            parameters: self.errors.iter().map(|(parameter, _)| *parameter).collect(),
            deviations: vec![Vec::new(); self.errors.len()],
            merits: Vec::new(),
            shifts: Vec::new(),
            lost: Vec::new(),
        };
        let chunks = (0..count).step_by(CHUNK as usize).map(|at| at..(at + CHUNK).min(count));
        let work = |(): &mut (), chunk: std::ops::Range<u64>| -> Vec<(Vec<f64>, MeritValue)> {
            chunk.map(|trial| self.trial(&lens, &evaluator, trial)).collect()
        };
        let merge = |found: Vec<(Vec<f64>, MeritValue)>| {
            found.iter().for_each(|(deviations, value)| trials.push(deviations, *value));
            let numbers = trials.merits.len() * (self.errors.len() + 3);
            Ok(growth.check(numbers as u64 * 8)?)
        };
        match drive(thread_count(self.threads), &self.cancel, chunks, || (), work, merge) {
            Ok(()) | Err(Stopped::Cancelled) => Ok(trials),
            Err(Stopped::Failed(error)) => Err(error),
        }
    }

    fn trial(&self, lens: &Prescription, evaluator: &MeritEvaluator, trial: u64) -> (Vec<f64>, MeritValue) {
        let deviations: Vec<f64> =
            (0..self.errors.len()).map(|k| self.errors[k].1.deviation(self.numbers(k, trial))).collect();
        let changes: Vec<(DesignParameter, f64)> =
            self.errors.iter().map(|error| error.0).zip(deviations.iter().copied()).collect();
        let nothing = MeritValue { merit: f64::NAN, shift: f64::NAN, lost: evaluator.sent(lens) };
        (deviations, evaluator.evaluate(lens, &changes).unwrap_or(nothing))
    }

    /// The two random numbers of a parameter in a trial.
    fn numbers(&self, parameter: usize, trial: u64) -> [f64; 2] {
        let mut generator = ChaCha8Rng::seed_from_u64(self.seed);
        generator.set_stream(TOLERANCES ^ parameter as u64);
        // two 32-bit words for each number
        generator.set_word_pos(u128::from(trial) * 4);
        [unit_fraction(generator.next_u64()), unit_fraction(generator.next_u64())]
    }

    /// The merit with each parameter changed alone, to both ends of its spread.
    ///
    /// # Errors
    /// As for [`Tolerancing::nominal`].
    pub fn sensitivities(&self) -> Result<Vec<Sensitivity>, DesignError> {
        let (lens, evaluator) = self.evaluator()?;
        let at = |parameter: DesignParameter, change: f64| {
            evaluator.evaluate(&lens, &[(parameter, change)]).map_or(f64::NAN, |value| value.merit)
        };
        let of = |&(parameter, spread): &(DesignParameter, Spread)| {
            let [low, high] = spread.ends();
            let (minus, plus) = (at(parameter, low), at(parameter, high));
            Sensitivity { parameter, minus, plus, slope: (plus - minus) / (high - low) }
        };
        Ok(self.errors.iter().map(of).collect())
    }
}

/// The effect of one parameter on a merit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensitivity {
    /// The parameter.
    pub parameter: DesignParameter,
    /// The merit with the parameter at the lower end of its spread, or one standard deviation lower.
    pub minus: f64,
    /// The merit with the parameter at the upper end of its spread, or one standard deviation higher.
    pub plus: f64,
    /// The change of the merit per change of the parameter, between `minus` and `plus`.
    pub slope: f64,
}

/// The results of Monte Carlo trials: merits and deviations.
#[derive(Clone, Debug, PartialEq)]
pub struct Trials {
    /// The merit without errors.
    pub nominal: f64,
    /// The parameters.
    pub parameters: Vec<DesignParameter>,
    /// The deviations, a column for each parameter in the order of `parameters`, a row for each trial.
    pub deviations: Vec<Vec<f64>>,
    /// The merit of each trial.
    pub merits: Vec<f64>,
    /// The shift of the image along the axis in each trial; 0 without refocusing.
    pub shifts: Vec<f64>,
    /// The number of rays of all fields and wavelengths that did not arrive in each trial; 0 for first-order
    /// merits.
    pub lost: Vec<usize>,
}

impl Trials {
    fn push(&mut self, deviations: &[f64], value: MeritValue) {
        self.deviations.iter_mut().zip(deviations).for_each(|(column, value)| column.push(*value));
        self.merits.push(value.merit);
        self.shifts.push(value.shift);
        self.lost.push(value.lost);
    }

    fn known(&self) -> impl Iterator<Item = f64> {
        self.merits.iter().copied().filter(|merit| !merit.is_nan())
    }

    /// The number of trials whose merit is NaN.
    pub fn failures(&self) -> usize {
        self.merits.len() - self.known().count()
    }

    /// The mean of the merits; NaN if there are none.
    pub fn mean(&self) -> f64 {
        self.known().sum::<f64>() / self.known().count() as f64
    }

    /// The standard deviation of the merits, with n - 1 degrees of freedom; NaN for fewer than two.
    pub fn standard_deviation(&self) -> f64 {
        let mean = self.mean();
        let squares: f64 = self.known().map(|merit| (merit - mean) * (merit - mean)).sum();
        (squares / (self.known().count() as f64 - 1.0)).sqrt()
    }

    /// A quantile of the merits, for a fraction from 0 to 1, by linear interpolation (R. J. Hyndman and Y.
    /// Fan, Am. Stat. 50, 361, 1996, definition 7); NaN if there are no merits.
    pub fn quantile(&self, fraction: f64) -> f64 {
        let mut sorted: Vec<f64> = self.known().collect();
        sorted.sort_by(f64::total_cmp);
        let place = fraction.clamp(0.0, 1.0) * sorted.len().saturating_sub(1) as f64;
        let (low, part) = (place.floor() as usize, place - place.floor());
        match (sorted.get(low), sorted.get(low + 1)) {
            (Some(a), Some(b)) => a + part * (b - a),
            (Some(a), None) => *a,
            _ => f64::NAN,
        }
    }
}
