//! Why a primitive cannot be made.

use super::parameter::{ParameterKind, Range};
use super::value::short;
use crate::surface::sag::SagError;
use rayweave_mesh::MeshError;

/// Why a primitive cannot be made; the message reads "problem (why) suggestion?".
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// No primitive has this name.
    #[error("unknown shape `{name}` (the shapes are {}){}", super::names(), or_name(.suggestion))]
    UnknownShape {
        /// The name asked for.
        name: String,
        /// The nearest name that there is.
        suggestion: Option<&'static str>,
    },
    /// The primitive has no parameter of this name.
    #[error("{shape}: unknown parameter `{name}` (the parameters are {}){}", parameters(.shape), or_name(.suggestion))]
    UnknownParameter {
        /// The primitive.
        shape: &'static str,
        /// The name given.
        name: String,
        /// The nearest name that there is.
        suggestion: Option<&'static str>,
    },
    /// A parameter without default was not given.
    #[error("{shape}: {parameter} is missing (it is {kind} and has no default) did you forget it?")]
    MissingParameter {
        /// The primitive.
        shape: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// What it should be.
        kind: ParameterKind,
    },
    /// A parameter was given more than once.
    #[error(
        "{shape}: {parameter} is given more than once (each parameter has one value) which one is meant?"
    )]
    RepeatedParameter {
        /// The primitive.
        shape: &'static str,
        /// The parameter.
        parameter: &'static str,
    },
    /// A number where a list is needed, a list of the wrong length, and so on.
    #[error("{shape}: {parameter}{} is {found} ({parameter} must be {expected}) are there numbers missing or too many?", at(.index))]
    WrongKind {
        /// The primitive.
        shape: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// The row at fault, if it is one row.
        index: Vec<usize>,
        /// What it should be.
        expected: ParameterKind,
        /// What was given.
        found: String,
    },
    /// A number outside its range, NaN and infinity included.
    #[error("{shape}: {parameter}{} is {} ({parameter} must be {range}){}", at(.index), short(*.value), or_value(.suggestion))]
    OutOfRange {
        /// The primitive.
        shape: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// The place in the parameter, if that is a list (one index) or has rows (two).
        index: Vec<usize>,
        /// The value given.
        value: f64,
        /// The values allowed.
        range: Range,
        /// A value that may have been meant.
        suggestion: Option<f64>,
    },
    /// A length beyond what can be computed with.
    #[error("{shape}: {parameter}{} is {} (only lengths from 1e-60 to 1e60 can be computed with) is the unit right?", at(.index), short(*.value))]
    Extreme {
        /// The primitive.
        shape: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// The place in the parameter, if that is a list or has rows.
        index: Vec<usize>,
        /// The length; where a plane's normal is not of unit length, after division by that.
        value: f64,
    },
    /// A normal of length zero.
    #[error("{shape}: {parameter}{} is a normal of length zero (it must say which way the plane faces) did you mean [0, 0, 1]?", at(.index))]
    ZeroNormal {
        /// The primitive.
        shape: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// The row, if the parameter has rows.
        index: Vec<usize>,
    },
    /// Two parameters of which one must be smaller than the other, and is not.
    #[error("{shape}: {lower}{place} is {} and {upper}{place} is {} ({lower} must be less than {upper}) are they the wrong way round?", short(*.lo), short(*.hi), place = at(.index))]
    NotIncreasing {
        /// The primitive.
        shape: &'static str,
        /// The parameter that must be smaller.
        lower: &'static str,
        /// The parameter that must be greater.
        upper: &'static str,
        /// The component, if the parameters are vectors.
        index: Vec<usize>,
        /// The value of `lower`.
        lo: f64,
        /// The value of `upper`.
        hi: f64,
    },
    /// Two parameters that are both zero, where one may be.
    #[error("{shape}: {first} and {second} are both 0 (then nothing is left) did you mean one of them?")]
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
        /// Why not.
        problem: SagError,
    },
    /// A matrix that should be symmetric and is not.
    #[error("{shape}: {parameter}[{row}][{column}] is {} but {parameter}[{column}][{row}] is {} (the matrix must be symmetric) did you mean {} in both places?", short(*.value), short(*.mirrored), short(0.5 * *.value + 0.5 * *.mirrored))]
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
    /// Points and triangles that are no closed mesh.
    #[error("{shape}: {error}")]
    Mesh {
        /// The primitive.
        shape: &'static str,
        /// Why not.
        error: MeshError,
    },
}

impl ShapeError {
    /// The parameter at fault, as it is spelt in the input; `None` if the shape itself is.
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

    /// The place in the parameter that is at fault: none, one index or two (row, column).
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

fn or_name(suggestion: &Option<&'static str>) -> String {
    suggestion.map(|name| format!(" did you mean `{name}`?")).unwrap_or_default()
}

fn or_value(suggestion: &Option<f64>) -> String {
    suggestion.map(|value| format!(" did you mean {}?", short(value))).unwrap_or_default()
}

fn parameters(shape: &str) -> String {
    let names = super::manual(shape).map(|manual| manual.parameters).unwrap_or_default();
    let names: Vec<&str> = names.iter().map(|parameter| parameter.name).collect();
    names.join(", ")
}

/// The nearest of the names, if it is near enough to be a slip of the fingers: at most a third of the
/// letters wrong (Damerau-Levenshtein distance), and at least one letter of two right.
pub(super) fn nearest_name<'a>(name: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let wrong = |other: &str| strsim::damerau_levenshtein(&name.to_lowercase(), other);
    names
        .map(|other| (wrong(other), other))
        .filter(|(wrong, other)| 3 * wrong <= other.len().max(name.chars().count()))
        .min_by_key(|(wrong, _)| *wrong)
        .map(|(_, other)| other)
}
