//! Errors of solids, maps and trajectories in R^d.

use crate::CurveError;
use rayweave_math::SingularError;
use rayweave_polygon::PolygonError;
use rayweave_rootray::RootRayError;

/// Error: a solid in R^d cannot be constructed or traced.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpaceError {
    /// A number that must be finite is not.
    #[error("{what}{} is {value}: it must be a finite number. Check for missing inputs and divisions by zero.", at(.index))]
    NotFinite {
        /// The parameter.
        what: &'static str,
        /// The index of the component: none, one index, or two (row, column).
        index: Vec<usize>,
        /// The given value.
        value: f64,
    },
    /// A length is out of range.
    #[error("{what}{} is {value:?}: lengths must be 0 or between 1e-60 and 1e60 in magnitude. Check the unit.", at(.index))]
    Extreme {
        /// The parameter.
        what: &'static str,
        /// The index of the component.
        index: Vec<usize>,
        /// The given value.
        value: f64,
    },
    /// A size that is zero or negative.
    #[error("{what} is {value}: it must be greater than 0. Check the sign.")]
    NotPositive {
        /// The parameter.
        what: &'static str,
        /// The given value.
        value: f64,
    },
    /// A lower bound is not less than its upper bound.
    #[error("lo{place} is {lo} and hi{place} is {hi}: lo must be less than hi. Check their order.", place = at(.index))]
    NotIncreasing {
        /// The index of the component, if the bounds are points.
        index: Vec<usize>,
        /// The lower bound.
        lo: f64,
        /// The upper bound.
        hi: f64,
    },
    /// The index of an axis is out of range.
    #[error("axis {axis} is out of range: R^{dimension} has the axes 0 to {last}. Number axes from 0.", last = .dimension - 1)]
    Axis {
        /// The given axis.
        axis: usize,
        /// The dimension of the space.
        dimension: usize,
    },
    /// Both axes of a rotation are equal.
    #[error(
        "the axes of the rotation are both {axis}: a rotation turns one axis towards another. Give two different axes."
    )]
    SameAxis {
        /// The repeated axis.
        axis: usize,
    },
    /// The numbers of squared coordinates are inconsistent.
    #[error(
        "n is {n} and m is {m}: a quadric in R^{dimension} has n squared coordinates, m of them with positive sign. Check their order."
    )]
    Squares {
        /// The number of squared coordinates.
        n: usize,
        /// The number of those with positive sign.
        m: usize,
        /// The dimension of the space.
        dimension: usize,
    },
    /// A normal is zero.
    #[error("the normal is zero: it must have a direction.")]
    ZeroNormal,
    /// The target space has too few dimensions.
    #[error("the solid is of dimension {from}: it cannot be extruded to the lower dimension {to}.")]
    Dimension {
        /// The dimension of the solid.
        from: usize,
        /// The target dimension.
        to: usize,
    },
    /// A map is singular.
    #[error("{0}")]
    Map(#[from] SingularError),
    /// Numbers over- or underflow under the composed maps.
    #[error(
        "the {leaf} has no finite size here: its numbers overflow or underflow under the maps. Check the scale factors."
    )]
    Overflow {
        /// The name or kind of the leaf.
        leaf: String,
    },
    /// The two points of a line coincide.
    #[error("p and q are the same point: a line needs two different points.")]
    SamePoint,
    /// A polygon is invalid.
    #[error("{0}")]
    Polygon(#[from] PolygonError),
    /// A curve is invalid.
    #[error("{0}")]
    Curve(#[from] CurveError),
    /// Times do not form a root-ray.
    #[error("{0}")]
    RootRay(#[from] RootRayError),
}

fn at(index: &[usize]) -> String {
    index.iter().map(|i| format!("[{i}]")).collect()
}

/// Validation of arguments.
pub(crate) mod check {
    use super::SpaceError;

    /// Checks a coordinate or an offset: 0, or between 1e-60 and 1e60 in magnitude.
    pub fn length(what: &'static str, index: &[usize], value: f64) -> Result<(), SpaceError> {
        finite(what, index, value)?;
        match value == 0.0 || (1e-60..=1e60).contains(&value.abs()) {
            true => Ok(()),
            false => Err(SpaceError::Extreme { what, index: index.to_vec(), value }),
        }
    }

    /// Checks that a number is finite.
    pub fn finite(what: &'static str, index: &[usize], value: f64) -> Result<(), SpaceError> {
        match value.is_finite() {
            true => Ok(()),
            false => Err(SpaceError::NotFinite { what, index: index.to_vec(), value }),
        }
    }

    /// Checks that a size is greater than 0.
    pub fn size(what: &'static str, value: f64) -> Result<(), SpaceError> {
        length(what, &[], value)?;
        if value > 0.0 { Ok(()) } else { Err(SpaceError::NotPositive { what, value }) }
    }

    /// Checks each coordinate of a point.
    pub fn point(what: &'static str, point: &[f64]) -> Result<(), SpaceError> {
        point.iter().enumerate().try_for_each(|(k, &x)| length(what, &[k], x))
    }
}
