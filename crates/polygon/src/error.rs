//! Errors of contours and lines.

use rayweave_error::{Classified, ErrorKind};
use std::fmt;

/// An edge of a contour, by the indices of its given vertices. `to` does not follow `from` directly if repeated or collinear
/// vertices between them were removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ContourEdge {
    /// The index of the contour.
    pub contour: usize,
    /// The index of the first vertex.
    pub from: usize,
    /// The index of the last vertex.
    pub to: usize,
}

impl fmt::Display for ContourEdge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "contour {}, edge from vertex {} to vertex {}", self.contour, self.from, self.to)
    }
}

/// Error: contours do not bound a region.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PolygonError {
    /// A coordinate is not a finite number.
    #[error("contour {contour}, vertex {vertex}: {} is {value}: coordinates must be finite.", axis_name(*.axis))]
    NotFinite {
        /// The index of the contour.
        contour: usize,
        /// The index of the vertex.
        vertex: usize,
        /// 0 for x, 1 for y.
        axis: usize,
        /// The given value.
        value: f64,
    },
    /// A coordinate exceeds the supported range.
    #[error(
        "contour {contour}, vertex {vertex}: {} is {value}: the largest supported magnitude is 1e60. Use a different unit.",
        axis_name(*.axis)
    )]
    Extreme {
        /// The index of the contour.
        contour: usize,
        /// The index of the vertex.
        vertex: usize,
        /// 0 for x, 1 for y.
        axis: usize,
        /// The given value.
        value: f64,
    },
    /// Two edges have a common point that is not a corner between them.
    #[error(
        "{first} crosses or touches {second}: contours must not touch each other or themselves. Make each contour a \
        separate region and combine the regions with boolean operators."
    )]
    Touching {
        /// One of the edges.
        first: ContourEdge,
        /// The other one.
        second: ContourEdge,
    },
    /// A contour has the wrong orientation for its nesting.
    #[error("contour {contour} {}", orientation(*.clockwise, *.parent))]
    Orientation {
        /// The index of the contour.
        contour: usize,
        /// True if it is clockwise.
        clockwise: bool,
        /// The innermost contour around it, if there is one.
        parent: Option<usize>,
    },
}

impl Classified for PolygonError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Value
    }
}

fn axis_name(axis: usize) -> &'static str {
    ["x", "y"][axis]
}

fn orientation(clockwise: bool, parent: Option<usize>) -> String {
    let place = match parent {
        Some(outer) => format!("within contour {outer}"),
        None => "within no other contour".to_owned(),
    };
    let (orientation, kind, side) = match clockwise {
        true => ("clockwise", "a hole", "outside"),
        false => ("counter-clockwise", "an island", "inside"),
    };
    let alternative = match (parent, clockwise) {
        (None, true) => ", or set outside to -1 if the region is unbounded",
        (None, false) => ", or set outside to +1 if the region is bounded",
        (Some(_), _) => "",
    };
    format!(
        "is {orientation}, as {kind}, but lies {place}, which is {side} the region: islands are counter-clockwise, holes \
         clockwise. Reverse its vertices{alternative}."
    )
}

/// Error: a line is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LineError {
    /// A number is not finite.
    #[error("the line has a coordinate that is NaN or infinite: origin and direction must be finite.")]
    NotFinite,
    /// The direction is the zero vector.
    #[error("the direction of the line is zero: it must be a nonzero vector.")]
    ZeroDirection,
    /// Squares of numbers would over- or underflow.
    #[error(
        "the line has numbers beyond 1e60, or a direction shorter than 1e-60: they are out of range. Use a different unit."
    )]
    Extreme,
}

impl Classified for LineError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Value
    }
}
