//! The kinds of errors.

use std::convert::Infallible;

/// The kinds of errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A parameter of a shape is wrong.
    Shape,
    /// A solid cannot be compiled: a singular transform, sizes that overflow, a tree too large for an evaluator.
    Compile,
    /// A model file cannot be read or is wrong.
    ModelFile,
    /// A file of rays, or another input file, cannot be read or is wrong.
    Input,
    /// An output file cannot be written.
    Output,
    /// A file name has no known extension, or one that this build cannot write.
    Format,
    /// A value is out of range: a ray without direction, an empty time window, a NaN root, a picture without pixels.
    Value,
    /// The question does not apply to a solid, because the solid is empty or unbounded.
    Solid,
    /// An optical system is inconsistent, or light cannot be traced through it.
    Optics,
    /// A name is unknown.
    Name,
    /// The run was cancelled.
    Cancelled,
}

/// An error that reports its kind.
pub trait Classified: std::error::Error {
    /// The kind of the error.
    fn kind(&self) -> ErrorKind;
}

/// For constructors that cannot fail, where a fallible one is accepted.
impl Classified for Infallible {
    fn kind(&self) -> ErrorKind {
        match *self {}
    }
}
