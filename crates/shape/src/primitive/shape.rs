//! What every primitive provides.

use super::arguments::Arguments;
use super::error::ShapeError;
use super::lowered::Lowered;
use super::parameter::Parameter;
use super::value::Value;

/// A kind of primitive. Everything that the doors (files, command line, Python, manual) need is made from this.
pub trait Shape: Sized {
    /// The name at every door.
    const NAME: &'static str;
    /// Where a point (x, y, z) is inside.
    const EQUATION: &'static str;
    /// The parameters, in order.
    const PARAMETERS: &'static [Parameter];
    /// The names of the faces; `side0..sideN-1` stands for as many as there are.
    const FACES: &'static [&'static str];

    /// From arguments that fit [`Shape::PARAMETERS`] one by one.
    fn from_arguments(arguments: &Arguments) -> Result<Self, ShapeError>;

    /// The parameters' values: given to `from_arguments` they make an equal primitive.
    fn arguments(&self) -> Vec<(&'static str, Value)>;

    /// The rules that join several parameters.
    fn consistent(&self) -> Result<(), ShapeError> {
        Ok(())
    }

    /// The primitive as sides of surfaces.
    fn lower(&self) -> Lowered;

    /// The volume, where it has a closed form; `inf` where it is unbounded.
    fn volume(&self) -> Option<f64> {
        None
    }

    /// One that shows well.
    fn example() -> Self;

    /// A random one, of a size about 1, from numbers uniform in [0, 1).
    fn random(rng: &mut dyn FnMut() -> f64) -> Self;

    /// The primitive itself if all its parameters are in their ranges and fit together.
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
