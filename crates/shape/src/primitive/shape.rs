//! The trait of all primitives.

use super::arguments::Arguments;
use super::error::ShapeError;
use super::lowered::Lowered;
use super::parameter::Parameter;
use super::value::Value;

/// A kind of primitive. All interfaces (files, command line, Python, manual) are derived from it.
pub trait Shape: Sized {
    /// Name in all interfaces.
    const NAME: &'static str;
    /// Condition for a point (x, y, z) to be inside.
    const EQUATION: &'static str;
    /// The parameters, in order.
    const PARAMETERS: &'static [Parameter];
    /// Names of the faces; `side0..sideN-1` is a numbered sequence.
    const FACES: &'static [&'static str];

    /// A primitive from arguments that match [`Shape::PARAMETERS`] individually.
    fn from_arguments(arguments: &Arguments) -> Result<Self, ShapeError>;

    /// Values of the parameters; `from_arguments` makes an equal primitive from them.
    fn arguments(&self) -> Vec<(&'static str, Value)>;

    /// Checks conditions that involve several parameters.
    fn consistent(&self) -> Result<(), ShapeError> {
        Ok(())
    }

    /// The primitive as sides of surfaces.
    fn lower(&self) -> Lowered;

    /// The volume, if there is a closed form; `inf` if it is unbounded.
    fn volume(&self) -> Option<f64> {
        None
    }

    /// A typical example.
    fn example() -> Self;

    /// A random primitive of size about 1, from numbers uniform in [0, 1).
    fn random(rng: &mut dyn FnMut() -> f64) -> Self;

    /// The primitive itself if its parameters are in range and consistent.
    fn validated(self) -> Result<Self, ShapeError> {
        for (parameter, (_, value)) in Self::PARAMETERS.iter().zip(self.arguments()) {
            parameter.check(Self::NAME, &value)?;
        }
        self.consistent()?;
        Ok(self)
    }
}

/// A number uniform in [lo, hi).
pub(super) fn between(rng: &mut dyn FnMut() -> f64, lo: f64, hi: f64) -> f64 {
    lo + (hi - lo) * rng()
}
