//! What an item stands for.

use rayweave_model::Solid;
use rayweave_scene::Colour;

/// The geometry of an item.
#[derive(Clone, Debug)]
pub(super) enum Part {
    /// Nothing.
    Empty,
    /// What could not be read: it counts as if it did not stand there.
    Refused,
    /// A solid in pieces of different colours; it is their union.
    Solid(Vec<Piece>),
}

/// A part of a solid, with its colour if it has one.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub colour: Option<Colour>,
    pub solid: Solid,
}

impl From<Solid> for Part {
    fn from(solid: Solid) -> Part {
        Part::Solid(vec![Piece { colour: None, solid }])
    }
}

/// The union of solids.
pub(super) fn union(mut solids: Vec<Solid>) -> Solid {
    match solids.len() {
        1 => solids.remove(0),
        _ => Solid::union(solids),
    }
}

/// The union of all pieces.
pub(super) fn whole(pieces: Vec<Piece>) -> Solid {
    union(pieces.into_iter().map(|piece| piece.solid).collect())
}
