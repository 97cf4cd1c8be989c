//! What an item stands for.

use super::flat::Flat;
use rayweave_model::Solid;
use rayweave_scene::Colour;

/// The geometry of an item.
#[derive(Clone, Debug)]
pub(super) enum Part {
    /// Nothing.
    Empty,
    /// What could not be read: it counts as if it did not stand there.
    Refused,
    /// A region of the plane in pieces of different colours; it is their union.
    Flat(Vec<Piece<Flat>>),
    /// A solid in pieces of different colours; it is their union.
    Solid(Vec<Piece<Solid>>),
}

/// A part of a solid or of a region of the plane, with its colour if it has one.
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
