//! Geometry of an item: a solid, a plane region, or nothing.

use super::arguments::{Arguments, Refusal};
use super::flat::Flat;
use rayweave_model::Solid;
use rayweave_scene::Colour;
use rayweave_shape::primitive::{Primitive, ShapeError};

/// The geometry of an item.
#[derive(Clone, Debug)]
pub(super) enum Part {
    /// An item without geometry.
    Empty,
    /// An item that could not be read; booleans treat it as absent.
    Refused,
    /// A plane region: the union of pieces of different colours.
    Flat(Vec<Piece<Flat>>),
    /// A solid: the union of pieces of different colours.
    Solid(Vec<Piece<Solid>>),
}

impl Part {
    /// Number of pieces of different colours.
    pub fn piece_count(&self) -> usize {
        match self {
            Part::Empty | Part::Refused => 0,
            Part::Flat(pieces) => pieces.len(),
            Part::Solid(pieces) => pieces.len(),
        }
    }
}

/// A piece of a solid or of a plane region, with its colour if it has one.
#[derive(Clone, Debug)]
pub(super) struct Piece<T> {
    pub colour: Option<Colour>,
    pub body: T,
}

impl From<Solid> for Part {
    fn from(body: Solid) -> Part {
        Part::Solid(vec![Piece { colour: None, body }])
    }
}

impl From<Flat> for Part {
    fn from(body: Flat) -> Part {
        Part::Flat(vec![Piece { colour: None, body }])
    }
}

/// The union of solids.
pub(super) fn union(mut solids: Vec<Solid>) -> Solid {
    match solids.len() {
        1 => solids.remove(0),
        _ => Solid::union(solids),
    }
}

/// A primitive as a solid; invalid parameters become a refusal.
pub(super) fn solid<S: Into<Primitive>>(
    arguments: &Arguments,
    shape: Result<S, ShapeError>,
) -> Result<Solid, Refusal> {
    match shape {
        Ok(shape) => Ok(Solid::from(shape.into())),
        Err(error) => Err(arguments.refusal(&error.to_string())),
    }
}
