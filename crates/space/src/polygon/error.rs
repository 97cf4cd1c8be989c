//! What can be wrong with contours.

use std::fmt;

/// An edge of a contour, by the numbers of its vertices as they were given. Where vertices between the two have
/// vanished (they were repeated, or on a straight run) `to` is not the number after `from`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Edge {
    /// The number of the contour.
    pub contour: usize,
    /// The number of the vertex where the edge begins.
    pub from: usize,
    /// The number of the vertex where it ends.
    pub to: usize,
}

impl fmt::Display for Edge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "contour {}, edge from vertex {} to vertex {}", self.contour, self.from, self.to)
    }
}

/// Why contours do not bound a region.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PolygonError {
    /// A coordinate is not a finite number.
    #[error("contour {contour}, vertex {vertex}: {} is {value} (coordinates are finite)", axis_name(*.axis))]
    NotFinite {
        /// The number of the contour.
        contour: usize,
        /// The number of the vertex in it.
        vertex: usize,
        /// 0 for x, 1 for y.
        axis: usize,
        /// What was given.
        value: f64,
    },
    /// A coordinate is too large to compute with.
    #[error(
        "contour {contour}, vertex {vertex}: {} is {value} (coordinates are at most 1e60 in magnitude) use another \
         unit?", axis_name(*.axis)
    )]
    Extreme {
        /// The number of the contour.
        contour: usize,
        /// The number of the vertex in it.
        vertex: usize,
        /// 0 for x, 1 for y.
        axis: usize,
        /// What was given.
        value: f64,
    },
    /// Two edges have a point in common that is no corner between them.
    #[error(
        "{first} crosses or touches {second} (contours keep apart from each other and from themselves) make each \
         contour a region of its own and join these by boolean operators?"
    )]
    Touching {
        /// One of the edges.
        first: Edge,
        /// The other one.
        second: Edge,
    },
    /// A contour goes around the wrong way for the place that it is in.
    #[error("contour {contour} {}", orientation(*.clockwise, *.around))]
    Orientation {
        /// The number of the contour.
        contour: usize,
        /// True if it goes around clockwise.
        clockwise: bool,
        /// The contour directly around it, if there is one.
        around: Option<usize>,
    },
}

fn axis_name(axis: usize) -> &'static str {
    ["x", "y"][axis]
}

fn orientation(clockwise: bool, around: Option<usize>) -> String {
    let place = match around {
        Some(outer) => format!("lies within contour {outer}"),
        None => "lies in no other contour".to_owned(),
    };
    let (turns, makes, side) = match clockwise {
        true => ("clockwise", "a hole", "outside"),
        false => ("counter-clockwise", "an island", "inside"),
    };
    let other = match (around, clockwise) {
        (None, true) => " (or give outside = -1, if the region is unbounded)",
        (None, false) => " (or give outside = +1, if the region is bounded)",
        (Some(_), _) => "",
    };
    format!(
        "goes around {turns}, as {makes} does, but {place}, where it is {side} already (islands go around \
         counter-clockwise, holes clockwise) reverse its vertices{other}?"
    )
}

/// Why a line cannot be followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LineError {
    /// A number is not finite.
    #[error("the line has a number that is not finite (its origin is a point, its direction a vector)")]
    NotFinite,
    /// The direction is the zero vector.
    #[error("the direction of the line is zero (a line leads somewhere)")]
    ZeroDirection,
    /// Numbers cannot be squared.
    #[error("the line has numbers beyond 1e60, or a direction shorter than 1e-60 (they cannot be squared)")]
    Extreme,
}
