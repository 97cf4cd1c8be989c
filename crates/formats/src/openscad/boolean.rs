//! Union, difference and intersection of coloured parts.

use super::operation::Operation;
use super::part::{Piece, union};
use rayweave_model::Solid;
use rayweave_scene::Colour;
use std::collections::HashMap;

/// Number of pieces above which they are united before a difference or intersection, so that the other operands are not
/// repeated for each piece.
const MAX_CUT_PIECES: usize = 16;

/// The boolean of solids; the difference is the first minus the union of the others.
pub(super) fn join_solids(operation: Operation, mut solids: Vec<Solid>) -> Solid {
    match operation {
        _ if solids.len() == 1 => solids.remove(0),
        Operation::Union => Solid::union(solids),
        Operation::Intersection => Solid::intersection(solids),
        Operation::Difference => {
            let others = solids.split_off(1.min(solids.len()));
            solids.pop().map_or_else(Solid::empty, |first| first - union(others))
        }
    }
}

/// The boolean of one or more operands. Pieces keep their colours; a difference or intersection has those of its first
/// operand.
pub(super) fn join<T: Clone>(
    operation: Operation,
    operands: Vec<Vec<Piece<T>>>,
    combine: &mut impl FnMut(Operation, Vec<T>) -> T,
) -> Vec<Piece<T>> {
    match operation {
        Operation::Union => gather(operands.into_iter().flatten(), combine),
        cut => cut_first(cut, operands, combine),
    }
}

/// The union: pieces of the same colour are united.
fn gather<T>(
    pieces: impl Iterator<Item = Piece<T>>,
    combine: &mut impl FnMut(Operation, Vec<T>) -> T,
) -> Vec<Piece<T>> {
    let mut groups: Vec<(Option<Colour>, Vec<T>)> = Vec::new();
    let mut places: HashMap<Option<Colour>, usize> = HashMap::new();
    for Piece { colour, body } in pieces {
        let place = *places.entry(colour).or_insert(groups.len());
        match groups.get_mut(place) {
            Some((_, bodies)) => bodies.push(body),
            None => groups.push((colour, vec![body])),
        }
    }
    let joined = |(colour, bodies): (_, Vec<T>)| Piece { colour, body: one(bodies, combine) };
    groups.into_iter().map(joined).collect()
}

/// The union of one or more bodies.
fn one<T>(mut bodies: Vec<T>, combine: &mut impl FnMut(Operation, Vec<T>) -> T) -> T {
    match bodies.len() {
        1 => bodies.remove(0),
        _ => combine(Operation::Union, bodies),
    }
}

/// The union of all pieces.
pub(super) fn whole<T>(pieces: Vec<Piece<T>>, combine: &mut impl FnMut(Operation, Vec<T>) -> T) -> T {
    one(pieces.into_iter().map(|piece| piece.body).collect(), combine)
}

/// The first operand, with each piece combined with the other operands as wholes.
fn cut_first<T: Clone>(
    operation: Operation,
    operands: Vec<Vec<Piece<T>>>,
    combine: &mut impl FnMut(Operation, Vec<T>) -> T,
) -> Vec<Piece<T>> {
    let mut operands = operands.into_iter();
    let mut first = operands.next().unwrap_or_default();
    let others: Vec<T> = operands.map(|pieces| whole(pieces, combine)).collect();
    if others.is_empty() {
        return first;
    }
    if first.len() > MAX_CUT_PIECES {
        let colour = first[0].colour;
        first = vec![Piece { colour, body: whole(first, combine) }];
    }
    let mut cut = |Piece { colour, body }: Piece<T>| {
        let all = std::iter::once(body).chain(others.iter().cloned()).collect();
        Piece { colour, body: combine(operation, all) }
    };
    first.into_iter().map(&mut cut).collect()
}
