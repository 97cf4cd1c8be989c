//! Union, difference and intersection of parts.

use super::part::{Part, Piece, union, whole};
use rayweave_model::Solid;
use rayweave_scene::Colour;
use std::collections::HashMap;

/// More pieces than these are joined before something is cut from each of them, so that what is cut is not
/// repeated too often.
const MOST_CUT_PIECES: usize = 16;

/// How parts are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operation {
    Union,
    Difference,
    Intersection,
}

/// Joins solids; pieces keep their colours, those of the first operand where something is cut.
pub(super) fn join_solids(operation: Operation, operands: Vec<Vec<Piece>>) -> Part {
    match operation {
        Operation::Union => gather(operands.into_iter().flatten()),
        Operation::Difference => cut(operands, |piece, others| piece - union(others)),
        Operation::Intersection => cut(operands, |piece, mut others| {
            others.insert(0, piece);
            Solid::intersection(others)
        }),
    }
}

/// The union: pieces of one colour become one.
fn gather(pieces: impl Iterator<Item = Piece>) -> Part {
    let mut groups: Vec<(Option<Colour>, Vec<Solid>)> = Vec::new();
    let mut places: HashMap<Option<Colour>, usize> = HashMap::new();
    for Piece { colour, solid } in pieces {
        let place = *places.entry(colour).or_insert(groups.len());
        match groups.get_mut(place) {
            Some((_, solids)) => solids.push(solid),
            None => groups.push((colour, vec![solid])),
        }
    }
    let pieces: Vec<Piece> =
        groups.into_iter().map(|(colour, solids)| Piece { colour, solid: union(solids) }).collect();
    if pieces.is_empty() { Part::Empty } else { Part::Solid(pieces) }
}

/// The first operand, each piece of which is joined with the others as wholes.
fn cut(operands: Vec<Vec<Piece>>, join: impl Fn(Solid, Vec<Solid>) -> Solid) -> Part {
    let mut operands = operands.into_iter();
    let Some(mut first) = operands.next() else {
        return Part::Empty;
    };
    let others: Vec<Solid> = operands.map(whole).collect();
    if others.is_empty() {
        return Part::Solid(first);
    }
    if first.len() > MOST_CUT_PIECES {
        let colour = first[0].colour;
        first = vec![Piece { colour, solid: whole(first) }];
    }
    let pieces = first.into_iter();
    let pieces = pieces.map(|piece| Piece { solid: join(piece.solid, others.clone()), ..piece });
    Part::Solid(pieces.collect())
}
