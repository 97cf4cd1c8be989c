//! What can be wrong with a solid, a map or a trajectory in R^d.

use crate::CurveError;
use crate::polygon::PolygonError;
use rayweave_math::SingularError;
use rayweave_rootray::RootRayError;

/// Why a solid cannot be made or traced; the message reads "problem (why) suggestion?".
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpaceError {
    /// A number that must be finite is not.
    #[error("{what}{} is {value} (it must be a finite number) is an input missing or divided by zero?", at(.index))]
    NotFinite {
        /// The parameter.
        what: &'static str,
        /// The place in it: none, one index, or two (row, column).
        index: Vec<usize>,
        /// The value given.
        value: f64,
    },
    /// A length beyond what can be computed with.
    #[error("{what}{} is {value:?} (only 0 and lengths from 1e-60 to 1e60 can be computed with) is the unit right?", at(.index))]
    Extreme {
        /// The parameter.
        what: &'static str,
        /// The place in it.
        index: Vec<usize>,
        /// The value given.
        value: f64,
    },
    /// A size that is zero or negative.
    #[error("{what} is {value} (it must be greater than 0) is the sign wrong?")]
    NotPositive {
        /// The parameter.
        what: &'static str,
        /// The value given.
        value: f64,
    },
    /// Two bounds of which the lower is not the smaller one.
    #[error("lo{place} is {lo} and hi{place} is {hi} (lo must be less than hi) are they the wrong way round?", place = at(.index))]
    NotIncreasing {
        /// The component, if the bounds are points.
        index: Vec<usize>,
        /// The lower bound.
        lo: f64,
        /// The upper bound.
        hi: f64,
    },
    /// An axis that the space does not have.
    #[error("axis {axis} is out of range (R^{dimension} has the axes 0 to {last}) did you count from 1?", last = .dimension - 1)]
    Axis {
        /// The axis asked for.
        axis: usize,
        /// The dimension of the space.
        dimension: usize,
    },
    /// A rotation in a plane that is no plane.
    #[error(
        "the axes of the rotation are both {axis} (it turns one axis towards another one) which one is the other?"
    )]
    SameAxis {
        /// The axis given twice.
        axis: usize,
    },
    /// Numbers of squares that do not fit the space or each other.
    #[error(
        "n is {n} and m is {m} (of the {dimension} coordinates n are squared, and m <= n of these added) are they swapped?"
    )]
    Squares {
        /// The number of squared coordinates.
        n: usize,
        /// The number of those that are added.
        m: usize,
        /// The dimension of the space.
        dimension: usize,
    },
    /// A normal of length zero.
    #[error("the normal is zero (it must say which way the plane faces) did you mean the last axis?")]
    ZeroNormal,
    /// A space of too few dimensions.
    #[error("the solid is of dimension {from} (it can be extruded to spaces of at least as many, not {to})")]
    Dimension {
        /// The dimension of the solid.
        from: usize,
        /// The dimension asked for.
        to: usize,
    },
    /// A map without inverse.
    #[error("{0}")]
    Map(#[from] SingularError),
    /// Numbers that left the range of f64, or vanished, under all maps together.
    #[error(
        "the {leaf} has no finite size here (its numbers overflow or vanish under the maps) is a scale far too large or small?"
    )]
    Overflow {
        /// The name or kind of the leaf.
        leaf: String,
    },
    /// Two points that give no direction.
    #[error("p and q are the same point (a line needs two) is one of them missing?")]
    SamePoint,
    /// A polygon that is none.
    #[error("{0}")]
    Polygon(#[from] PolygonError),
    /// A curve that cannot be followed.
    #[error("{0}")]
    Curve(#[from] CurveError),
    /// Times that are no root-ray.
    #[error("{0}")]
    RootRay(#[from] RootRayError),
}

fn at(index: &[usize]) -> String {
    index.iter().map(|i| format!("[{i}]")).collect()
}

/// Checks of numbers at the door.
pub(crate) mod check {
    use super::SpaceError;

    /// A coordinate or an offset: 0, or of a magnitude from 1e-60 to 1e60.
    pub fn length(what: &'static str, index: &[usize], value: f64) -> Result<(), SpaceError> {
        finite(what, index, value)?;
        match value == 0.0 || (1e-60..=1e60).contains(&value.abs()) {
            true => Ok(()),
            false => Err(SpaceError::Extreme { what, index: index.to_vec(), value }),
        }
    }

    /// Any finite number.
    pub fn finite(what: &'static str, index: &[usize], value: f64) -> Result<(), SpaceError> {
        match value.is_finite() {
            true => Ok(()),
            false => Err(SpaceError::NotFinite { what, index: index.to_vec(), value }),
        }
    }

    /// A size, greater than 0.
    pub fn size(what: &'static str, value: f64) -> Result<(), SpaceError> {
        length(what, &[], value)?;
        if value > 0.0 { Ok(()) } else { Err(SpaceError::NotPositive { what, value }) }
    }

    /// Each coordinate of a point.
    pub fn point(what: &'static str, point: &[f64]) -> Result<(), SpaceError> {
        point.iter().enumerate().try_for_each(|(k, &x)| length(what, &[k], x))
    }
}
