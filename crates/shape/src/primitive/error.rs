//! Errors of primitives: unknown names, wrong kinds, values out of range.

use super::parameter::{ParameterKind, Range};
use super::value::short;
use crate::surface::sag::SagError;
use rayweave_error::{Classified, ErrorKind};
use rayweave_mesh::MeshError;

/// The reason why a primitive cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// No primitive has this name.
    #[error("unknown shape `{name}`: the shapes are {}.{}", super::names(), or_name(.suggestion))]
    UnknownShape {
        /// Requested name.
        name: String,
        /// The nearest existing name.
        suggestion: Option<&'static str>,
    },
    /// The primitive has no parameter of this name.
    #[error("{shape}: unknown parameter `{name}`: the parameters are {}.{}", parameters(.shape), or_parameter(.name, .suggestion))]
    UnknownParameter {
        /// The primitive.
        shape: &'static str,
        /// Given name.
        name: String,
        /// The nearest existing name.
        suggestion: Option<&'static str>,
    },
    /// A required parameter is missing.
    #[error("{shape}: {parameter} is missing: it is {kind} and has no default. Did you forget it?")]
    MissingParameter {
        /// The primitive.
        shape: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// Kind of the parameter.
        kind: ParameterKind,
    },
    /// A parameter was given more than once.
    #[error("{shape}: {parameter} is given more than once: each parameter has one value. Keep one of them.")]
    RepeatedParameter {
        /// The primitive.
        shape: &'static str,
        /// The parameter.
        parameter: &'static str,
    },
    /// A number where a list is needed, a list of the wrong length, and so on.
    #[error("{shape}: {parameter}{} is {found}: {parameter} must be {expected}. Are there too few or too many numbers?", at(.index))]
    WrongKind {
        /// The primitive.
        shape: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// The row at fault, if there is one.
        index: Vec<usize>,
        /// Expected kind.
        expected: ParameterKind,
        /// Description of the given value.
        found: String,
    },
    /// A number outside its range, NaN and infinity included.
    #[error("{shape}: {parameter}{} is {}: {parameter} must be {range}.{}", at(.index), short(*.value), or_value(.suggestion))]
    OutOfRange {
        /// The primitive.
        shape: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// The position in the parameter: one index for a list, two for rows.
        index: Vec<usize>,
        /// The value given.
        value: f64,
        /// The allowed values.
        range: Range,
        /// A value that was possibly meant.
        suggestion: Option<f64>,
    },
    /// A length beyond the range of computation.
    #[error("{shape}: {parameter}{} is {}: only lengths from 1e-60 to 1e60 are supported. Is the unit right?", at(.index), short(*.value))]
    Extreme {
        /// The primitive.
        shape: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// The position in the parameter, if that is a list or has rows.
        index: Vec<usize>,
        /// The length; for a plane the offset after division by the length of its normal.
        value: f64,
    },
    /// A normal of length zero.
    #[error("{shape}: {parameter}{} has length zero: a normal must have a direction. Did you mean [0, 0, 1]?", at(.index))]
    ZeroNormal {
        /// The primitive.
        shape: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// The row, if the parameter has rows.
        index: Vec<usize>,
    },
    /// Two parameters that are not in increasing order.
    #[error("{shape}: {lower}{place} is {} and {upper}{place} is {}: {lower} must be less than {upper}. Are they the wrong way round?", short(*.lo), short(*.hi), place = at(.index))]
    NotIncreasing {
        /// The primitive.
        shape: &'static str,
        /// The parameter that must be the smaller one.
        lower: &'static str,
        /// The parameter that must be the greater one.
        upper: &'static str,
        /// The component, if the parameters are vectors.
        index: Vec<usize>,
        /// The value of `lower`.
        lo: f64,
        /// The value of `upper`.
        hi: f64,
    },
    /// Two parameters that are both zero; at most one may be.
    #[error(
        "{shape}: {first} and {second} are both 0: the solid would be empty. Should one of them be positive?"
    )]
    BothZero {
        /// The primitive.
        shape: &'static str,
        /// One parameter.
        first: &'static str,
        /// The other.
        second: &'static str,
    },
    /// A sag surface that does not exist.
    #[error("{shape}: {problem}")]
    Sag {
        /// The primitive.
        shape: &'static str,
        /// The reason.
        problem: SagError,
    },
    /// A matrix that is not symmetric.
    #[error("{shape}: {parameter}[{row}][{column}] is {} but {parameter}[{column}][{row}] is {}: the matrix must be symmetric. Did you mean {} in both places?", short(*.value), short(*.mirrored), short(0.5 * *.value + 0.5 * *.mirrored))]
    NotSymmetric {
        /// The primitive.
        shape: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// The row, less than the column.
        row: usize,
        /// The column.
        column: usize,
        /// The entry at (row, column).
        value: f64,
        /// The entry at (column, row).
        mirrored: f64,
    },
    /// Points and triangles that do not form a closed mesh.
    #[error("{shape}: {error}")]
    Mesh {
        /// The primitive.
        shape: &'static str,
        /// The reason.
        error: MeshError,
    },
}

impl Classified for ShapeError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Shape
    }
}

impl ShapeError {
    /// The parameter at fault, as spelt in the input; `None` if the shape itself is at fault.
    pub fn parameter(&self) -> Option<&str> {
        match self {
            ShapeError::UnknownShape { .. } | ShapeError::MissingParameter { .. } => None,
            ShapeError::Mesh { error: MeshError::Coordinate { .. }, .. } => Some("vertices"),
            ShapeError::Mesh { .. } => Some("faces"),
            ShapeError::UnknownParameter { name, .. } => Some(name),
            ShapeError::RepeatedParameter { parameter, .. }
            | ShapeError::WrongKind { parameter, .. }
            | ShapeError::OutOfRange { parameter, .. }
            | ShapeError::Extreme { parameter, .. }
            | ShapeError::ZeroNormal { parameter, .. }
            | ShapeError::NotSymmetric { parameter, .. } => Some(parameter),
            ShapeError::NotIncreasing { lower, .. } => Some(lower),
            ShapeError::BothZero { first, .. } => Some(first),
            ShapeError::Sag { .. } => Some("aperture"),
        }
    }

    /// The position at fault in the parameter: none, one index or two (row, column).
    pub fn index(&self) -> Vec<usize> {
        match self {
            ShapeError::WrongKind { index, .. }
            | ShapeError::OutOfRange { index, .. }
            | ShapeError::Extreme { index, .. }
            | ShapeError::ZeroNormal { index, .. }
            | ShapeError::NotIncreasing { index, .. } => index.clone(),
            ShapeError::NotSymmetric { row, column, .. } => vec![*row, *column],
            ShapeError::Mesh { error: MeshError::Coordinate { index, .. }, .. } => vec![*index],
            ShapeError::Mesh { error: MeshError::Index { triangle, .. }, .. } => vec![*triangle],
            ShapeError::Mesh { .. }
            | ShapeError::UnknownShape { .. }
            | ShapeError::UnknownParameter { .. }
            | ShapeError::MissingParameter { .. }
            | ShapeError::RepeatedParameter { .. }
            | ShapeError::Sag { .. }
            | ShapeError::BothZero { .. } => Vec::new(),
        }
    }
}

fn at(index: &[usize]) -> String {
    index.iter().map(|i| format!("[{i}]")).collect()
}

/// The suggestion of a parameter: for a diameter, half of it.
fn or_parameter(name: &str, suggestion: &Option<&'static str>) -> String {
    match (name, suggestion) {
        ("d" | "dia" | "diameter", Some(radius @ "radius")) => {
            format!(" Did you mean `{radius}`, half the diameter?")
        }
        _ => or_name(suggestion),
    }
}

fn or_name(suggestion: &Option<&'static str>) -> String {
    suggestion.map(|name| format!(" Did you mean `{name}`?")).unwrap_or_default()
}

fn or_value(suggestion: &Option<f64>) -> String {
    suggestion.map(|value| format!(" Did you mean {}?", short(value))).unwrap_or_default()
}

fn parameters(shape: &str) -> String {
    let names = super::manual(shape).map(|manual| manual.parameters).unwrap_or_default();
    let names: Vec<&str> = names.iter().map(|parameter| parameter.name).collect();
    names.join(", ")
}
