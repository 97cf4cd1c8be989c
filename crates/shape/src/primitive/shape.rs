//! The trait of primitives.

use super::arguments::Arguments;
use super::error::ShapeError;
use super::lowered::Lowered;
use super::parameter::Parameter;
use super::value::Value;

/// A kind of primitive. Its items define all interfaces: model files, the command line, Python and the manual.
pub trait Shape: Sized {
    /// The name in all interfaces.
    const NAME: &'static str;
    /// The condition for a point (x, y, z) to be inside, as text.
    const EQUATION: &'static str;
    /// The parameters, in the order of [`Shape::arguments`].
    const PARAMETERS: &'static [Parameter];
    /// The names of the faces; `side0..sideN-1` stands for a numbered sequence.
    const FACES: &'static [&'static str];

    /// Creates a primitive from arguments, each of which was checked against [`Shape::PARAMETERS`].
    ///
    /// # Errors
    /// [`ShapeError`] if the arguments are not consistent with each other.
    fn from_arguments(arguments: &Arguments) -> Result<Self, ShapeError>;

    /// The values of the parameters; [`Shape::from_arguments`] creates an equal primitive from them.
    fn arguments(&self) -> Vec<(&'static str, Value)>;

    /// Checks conditions that involve several parameters.
    fn consistent(&self) -> Result<(), ShapeError> {
        Ok(())
    }

    /// The primitive as a conjunction of facets, or the complement of one, with its bounds.
    fn lower(&self) -> Lowered;

    /// The volume, which may be infinite; `None` if there is no closed form.
    fn volume(&self) -> Option<f64> {
        None
    }

    /// A typical primitive, for examples and tests.
    fn example() -> Self;

    /// A random primitive of size about 1. `rng` returns random numbers, uniform in [0, 1).
    fn random(rng: &mut dyn FnMut() -> f64) -> Self;

    /// Returns the primitive itself if its parameters are in range and consistent, else an error.
    fn validated(self) -> Result<Self, ShapeError> {
        for (parameter, (_, value)) in Self::PARAMETERS.iter().zip(self.arguments()) {
            parameter.check(Self::NAME, &value)?;
        }
        self.consistent()?;
        Ok(self)
    }
}

/// A random number, uniform in [lo, hi), from `rng` uniform in [0, 1).
pub(super) fn between(rng: &mut dyn FnMut() -> f64, lo: f64, hi: f64) -> f64 {
    lo + (hi - lo) * rng()
}
