//! Tolerancing: what errors of making and mounting do to a merit.

use super::merit::{Judge, Verdict};
use super::{DesignError, Merit, Parameter};
use crate::analysis::hexapolar;
use crate::prescription::Prescription;
use rand::rngs::ChaCha8Rng;
use rand::{Rng, SeedableRng};
use rayweave_math::unit_fraction;
use rayweave_model::drive::{Cancel, Stopped, drive, thread_count};
use std::num::NonZeroUsize;

/// Keeps the streams of errors apart from those of other things that are drawn by the same seed.
const TOLERANCES: u64 = u64::from_be_bytes(*b"tolerate");

/// Trials per chunk of work.
const CHUNK: u64 = 16;

/// How far a parameter may be from its value, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spread {
    /// Anything up to a distance, all equally likely.
    Uniform(f64),
    /// A normal distribution of this standard deviation.
    Normal(f64),
}

impl Spread {
    /// The distance, or the standard deviation.
    pub fn scale(self) -> f64 {
        let (Spread::Uniform(scale) | Spread::Normal(scale)) = self;
        scale
    }

    /// The deviation of a trial by two numbers uniform in [0, 1): the normal one by the transform of G. E. P. Box and M. E.
    /// Muller, Ann. Math. Stat. 29, 610, 1958.
    fn deviation(self, [a, b]: [f64; 2]) -> f64 {
        match self {
            Spread::Uniform(scale) => scale * (2.0 * a - 1.0),
            Spread::Normal(scale) => {
                scale * (-2.0 * libm::log1p(-a)).sqrt() * libm::cos(std::f64::consts::TAU * b)
            }
        }
    }
}

/// Errors of parameters, and the merit that they change.
///
/// Trial k draws its errors from the k-th place of a stream for each parameter: it is the same whatever the number of trials
/// and threads, and the errors of one parameter do not depend on the others.
#[derive(Clone, Debug)]
pub struct Tolerancing<'a> {
    lens: &'a Prescription,
    merit: Merit,
    errors: Vec<(Parameter, Spread)>,
    refocus: bool,
    vignettes: bool,
    rings: usize,
    seed: u64,
    threads: Option<NonZeroUsize>,
    cancel: Cancel,
}

impl<'a> Tolerancing<'a> {
    /// Of a prescription without errors, in place, with 6 rings of rays in the pupil.
    pub fn new(lens: &'a Prescription, merit: Merit) -> Tolerancing<'a> {
        Tolerancing {
            lens,
            merit,
            errors: Vec::new(),
            refocus: false,
            vignettes: false,
            rings: 6,
            seed: 0,
            threads: None,
            cancel: Cancel::new(),
        }
    }

    /// The same with an error of one more parameter.
    pub fn add(mut self, parameter: Parameter, spread: Spread) -> Tolerancing<'a> {
        self.errors.push((parameter, spread));
        self
    }

    /// The same with the image moved along the axis, in every trial, to where the mean square radius of all spots is least.
    pub fn refocused(self) -> Tolerancing<'a> {
        Tolerancing { refocus: true, ..self }
    }

    /// The same in which a ray ends where it meets a surface beyond the semi-diameter that is stated for it, or in its hole.
    pub fn vignetted(self) -> Tolerancing<'a> {
        Tolerancing { vignettes: true, ..self }
    }

    /// The same with another number of rings of rays in the pupil.
    pub fn rings(self, rings: usize) -> Tolerancing<'a> {
        Tolerancing { rings, ..self }
    }

    /// The same with other random numbers.
    pub fn seed(self, seed: u64) -> Tolerancing<'a> {
        Tolerancing { seed, ..self }
    }

    /// The same on so many threads.
    pub fn threads(self, threads: Option<NonZeroUsize>) -> Tolerancing<'a> {
        Tolerancing { threads, ..self }
    }

    /// The same with a token that ends the trials.
    pub fn cancel(self, cancel: Cancel) -> Tolerancing<'a> {
        Tolerancing { cancel, ..self }
    }

    /// The merit without errors.
    ///
    /// # Errors
    /// [`DesignError`] for parameters that are not there, spreads below 0, and prescriptions that say nothing.
    pub fn nominal(&self) -> Result<f64, DesignError> {
        Ok(self.judge()?.ask(self.lens, &[])?.merit)
    }

    fn judge(&self) -> Result<Judge, DesignError> {
        for (parameter, spread) in &self.errors {
            parameter.value(self.lens)?;
            let scale = spread.scale();
            if !(scale >= 0.0 && scale.is_finite()) {
                let (what, range) = (format!("the spread of {parameter}"), "at least 0, finite");
                return Err(DesignError::BadNumber { what, value: scale, range });
            }
        }
        Judge::new(self.lens, self.merit, [self.refocus, self.vignettes], hexapolar(self.rings))
    }

    /// The merits of so many trials. One in which no light arrives, or in which a number is out of its range, has the merit
    /// NaN.
    ///
    /// # Errors
    /// As of [`Tolerancing::nominal`], and [`DesignError::None`] without errors; a run that was cancelled has fewer trials.
    pub fn trials(&self, count: u64) -> Result<Trials, DesignError> {
        if self.errors.is_empty() {
            return Err(DesignError::None("parameter with an error"));
        }
        let judge = self.judge()?;
        let mut trials = Trials {
            nominal: judge.ask(self.lens, &[])?.merit,
            parameters: self.errors.iter().map(|(parameter, _)| *parameter).collect(),
            deviations: vec![Vec::new(); self.errors.len()],
            merits: Vec::new(),
            shifts: Vec::new(),
            lost: Vec::new(),
        };
        let chunks = (0..count).step_by(CHUNK as usize).map(|at| at..(at + CHUNK).min(count));
        let work = |(): &mut (), chunk: std::ops::Range<u64>| -> Vec<(Vec<f64>, Verdict)> {
            chunk.map(|trial| self.trial(&judge, trial)).collect()
        };
        let merge = |found: Vec<(Vec<f64>, Verdict)>| {
            found.iter().for_each(|(deviations, verdict)| trials.push(deviations, *verdict));
            Ok::<(), DesignError>(())
        };
        match drive(thread_count(self.threads), &self.cancel, chunks, || (), work, merge) {
            Ok(()) | Err(Stopped::Cancelled) => Ok(trials),
            Err(Stopped::Failed(error)) => Err(error),
        }
    }

    fn trial(&self, judge: &Judge, trial: u64) -> (Vec<f64>, Verdict) {
        let deviations: Vec<f64> =
            (0..self.errors.len()).map(|k| self.errors[k].1.deviation(self.numbers(k, trial))).collect();
        let changes: Vec<(Parameter, f64)> =
            self.errors.iter().map(|error| error.0).zip(deviations.iter().copied()).collect();
        let nothing = Verdict { merit: f64::NAN, shift: f64::NAN, lost: judge.sent(self.lens) };
        (deviations, judge.ask(self.lens, &changes).unwrap_or(nothing))
    }

    /// The two numbers of a parameter in a trial.
    fn numbers(&self, parameter: usize, trial: u64) -> [f64; 2] {
        let mut generator = ChaCha8Rng::seed_from_u64(self.seed);
        generator.set_stream(TOLERANCES ^ parameter as u64);
        // two words of 32 bits for each number
        generator.set_word_pos(u128::from(trial) * 4);
        [unit_fraction(generator.next_u64()), unit_fraction(generator.next_u64())]
    }

    /// What each parameter does alone, at both ends of its spread.
    ///
    /// # Errors
    /// As of [`Tolerancing::nominal`].
    pub fn sensitivities(&self) -> Result<Vec<Sensitivity>, DesignError> {
        let judge = self.judge()?;
        let at = |parameter: Parameter, change: f64| {
            judge.ask(self.lens, &[(parameter, change)]).map_or(f64::NAN, |verdict| verdict.merit)
        };
        let of = |&(parameter, spread): &(Parameter, Spread)| {
            let scale = spread.scale();
            let (minus, plus) = (at(parameter, -scale), at(parameter, scale));
            Sensitivity { parameter, minus, plus, slope: (plus - minus) / (2.0 * scale) }
        };
        Ok(self.errors.iter().map(of).collect())
    }
}

/// What one parameter does to a merit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensitivity {
    /// The parameter.
    pub parameter: Parameter,
    /// The merit where it is too small by its spread: the greatest deviation, or the standard one.
    pub minus: f64,
    /// The merit where it is too large by its spread.
    pub plus: f64,
    /// The merit's change over that of the parameter, between these.
    pub slope: f64,
}

/// The merits of trials, with the deviations that they had.
#[derive(Clone, Debug, PartialEq)]
pub struct Trials {
    /// The merit without errors.
    pub nominal: f64,
    /// The parameters.
    pub parameters: Vec<Parameter>,
    /// The deviations of every parameter, in the order of the trials.
    pub deviations: Vec<Vec<f64>>,
    /// The merit of every trial.
    pub merits: Vec<f64>,
    /// By how much the image was moved along the axis; 0 if it was not asked for.
    pub shifts: Vec<f64>,
    /// How many rays of all fields and wavelengths did not arrive in every trial; 0 for merits that follow none.
    pub lost: Vec<usize>,
}

impl Trials {
    fn push(&mut self, deviations: &[f64], verdict: Verdict) {
        self.deviations.iter_mut().zip(deviations).for_each(|(column, value)| column.push(*value));
        self.merits.push(verdict.merit);
        self.shifts.push(verdict.shift);
        self.lost.push(verdict.lost);
    }

    fn known(&self) -> impl Iterator<Item = f64> {
        self.merits.iter().copied().filter(|merit| !merit.is_nan())
    }

    /// The number of trials without a merit.
    pub fn failures(&self) -> usize {
        self.merits.len() - self.known().count()
    }

    /// The mean of the merits; NaN if there are none.
    pub fn mean(&self) -> f64 {
        self.known().sum::<f64>() / self.known().count() as f64
    }

    /// The standard deviation of the merits, with the number of trials less 1; NaN for fewer than two.
    pub fn standard_deviation(&self) -> f64 {
        let mean = self.mean();
        let squares: f64 = self.known().map(|merit| (merit - mean) * (merit - mean)).sum();
        (squares / (self.known().count() as f64 - 1.0)).sqrt()
    }

    /// The merit below which a fraction of the trials are, from 0 to 1, linear between two of them (R. J. Hyndman and Y. Fan,
    /// Am. Stat. 50, 361, 1996, definition 7); NaN if there are none.
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
