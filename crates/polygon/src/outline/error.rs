//! Errors of outlines.

use crate::PolygonError;
use rayweave_error::{Classified, ErrorKind};
use rayweave_shape::primitive::ShapeError;

/// Error: an outline bounds no region, or its solid cannot be made. Contours and vertices are counted from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OutlineError {
    /// A coordinate or bulge is not finite or too large.
    #[error("contour {contour}, point {vertex}: coordinates must be finite and at most 1e60.")]
    NotFinite {
        /// The index of the contour.
        contour: usize,
        /// The index of the vertex.
        vertex: usize,
    },
    /// The size of a fillet or chamfer is not positive.
    #[error(
        "contour {contour}, point {vertex}: the size of the corner is {size}: it must be greater than 0."
    )]
    NotPositive {
        /// The index of the contour.
        contour: usize,
        /// The index of the vertex.
        vertex: usize,
        /// The given size.
        size: f64,
    },
    /// A contour has fewer than three corners, or all are in one line.
    #[error("contour {contour} has no area: it needs at least three points that are not in one line.")]
    NoArea {
        /// The index of the contour.
        contour: usize,
    },
    /// A fillet or chamfer at the end of an arc.
    #[error(
        "contour {contour}, point {vertex}: a fillet or chamfer lies between straight edges, but an arc ends here. \
         Draw the rounding as an arc."
    )]
    CornerAtArc {
        /// The index of the contour.
        contour: usize,
        /// The index of the vertex.
        vertex: usize,
    },
    /// An edge is too short for the roundings at its ends.
    #[error(
        "contour {contour}, point {vertex}: a fillet or chamfer of {size} takes {setback:.6} of the edge, where {room:.6} \
         is free. Choose a smaller one."
    )]
    NoRoom {
        /// The index of the contour.
        contour: usize,
        /// The index of the vertex.
        vertex: usize,
        /// The radius of the fillet or the length of the chamfer.
        size: f64,
        /// The length that it takes of each edge.
        setback: f64,
        /// The length that is left.
        room: f64,
    },
    /// Two edges cross or touch.
    #[error(
        "the outline crosses or touches itself: {} and {}. Edges meet only at their ends.",
        edge(*.first), edge(*.second)
    )]
    Touching {
        /// The contour and the vertex before one of the edges.
        first: (usize, usize),
        /// The same for the other edge.
        second: (usize, usize),
    },
    /// A contour that is revolved crosses the axis.
    #[error("contour {contour} reaches x = {x}: an outline that is revolved lies at x >= 0.")]
    Axis {
        /// The index of the contour.
        contour: usize,
        /// The smallest x.
        x: f64,
    },
    /// The treatment of the rim of an extrusion is not possible at an edge.
    #[error("contour {contour}, point {vertex}: the rim cannot be treated here: {reason}.")]
    Rim {
        /// The index of the contour.
        contour: usize,
        /// The index of the vertex before the edge.
        vertex: usize,
        /// The reason.
        reason: &'static str,
    },
    /// The fillets or chamfers at both ends are higher than the extrusion.
    #[error("the treatments of both rims are {size} high together: the extrusion is only {height} high.")]
    RimHeight {
        /// The sum of their sizes.
        size: f64,
        /// The height of the extrusion.
        height: f64,
    },
    /// A shape rejects a number.
    #[error(transparent)]
    Shape(#[from] ShapeError),
}

impl OutlineError {
    /// The contour and the vertex that the error is about.
    pub fn place(&self) -> Option<(usize, Option<usize>)> {
        match self {
            OutlineError::NotFinite { contour, vertex }
            | OutlineError::NotPositive { contour, vertex, .. }
            | OutlineError::CornerAtArc { contour, vertex }
            | OutlineError::NoRoom { contour, vertex, .. }
            | OutlineError::Rim { contour, vertex, .. } => Some((*contour, Some(*vertex))),
            OutlineError::Touching { first, .. } => Some((first.0, Some(first.1))),
            OutlineError::NoArea { contour } | OutlineError::Axis { contour, .. } => Some((*contour, None)),
            OutlineError::RimHeight { .. } | OutlineError::Shape(_) => None,
        }
    }

    /// The error of polygons whose vertices belong to these vertices of the contours.
    pub(super) fn of_polygons(error: PolygonError, origins: &[Vec<usize>]) -> OutlineError {
        match error {
            PolygonError::Touching { first, second } => {
                let [first, second] =
                    [first, second].map(|edge| (edge.contour, origins[edge.contour][edge.from]));
                OutlineError::Touching { first, second }
            }
            PolygonError::NotFinite { contour, vertex, .. }
            | PolygonError::Extreme { contour, vertex, .. } => {
                OutlineError::NotFinite { contour, vertex: origins[contour][vertex] }
            }
            // contours are oriented by their nesting: a contradiction is a contact
            PolygonError::Orientation { contour, parent, .. } => {
                OutlineError::Touching { first: (contour, 0), second: (parent.unwrap_or(contour), 0) }
            }
        }
    }
}

impl Classified for OutlineError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Value
    }
}

fn edge((contour, vertex): (usize, usize)) -> String {
    format!("contour {contour} after point {vertex}")
}
