//! Bottom-up traversal of a solid for all writers, with complements eliminated.

use super::WriteError;
use rayweave_math::{Affine, Bounds};
use rayweave_model::{Boundary, Node, Solid};
use rayweave_shape::primitive::Primitive;

/// Maximum number of shapes and operators of a region; every copy of a solid counts.
const MAX_NODES: usize = 1_000_000;

/// An operation on two or more parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operation {
    Union,
    Intersection,
    /// The first part minus all others.
    Difference,
}

/// Builder of the parts of a file.
pub(super) trait Builder {
    type Part: Clone;

    /// A box that contains the whole model.
    fn clip(&self) -> Bounds;

    /// The clip box as a part.
    fn everything(&mut self) -> Self::Part;

    /// A transformed shape, exact within the clip box; `None` if it is empty. Outside the box `within`, the shape does not
    /// matter: triangles of an unbounded shape need not reach beyond it.
    fn leaf(
        &mut self,
        shape: &Primitive,
        place: &Affine,
        within: &Bounds,
    ) -> Result<Option<Self::Part>, WriteError>;

    /// A named solid as a whole, exact everywhere; `None` if the format has no element for it.
    fn named(&mut self, _name: &str, _solid: &Solid, _place: &Affine) -> Option<Self::Part> {
        None
    }

    /// A solid from the description of its boundary; `None` if it is to be built from its tree.
    fn bounded(
        &mut self,
        _boundary: &dyn Boundary,
        _place: &Affine,
    ) -> Result<Option<Self::Part>, WriteError> {
        Ok(None)
    }

    /// The boolean of two or more parts; `None` if it is empty.
    fn join(&mut self, by: Operation, parts: Vec<Self::Part>) -> Result<Option<Self::Part>, WriteError>;

    /// Name of the region that is being written, for messages.
    fn region(&self) -> String;
}

/// State of a part outside the clip box, where infinite shapes may have been cut off.
#[derive(Clone, Copy)]
struct Outside {
    /// True if the part equals the solid there.
    is_exact: bool,
    /// True if the part is empty there.
    is_empty: bool,
}

const NOTHING: Outside = Outside { is_exact: true, is_empty: true };

/// A part or nothing, and its state outside the clip box.
type Known<P> = (Option<P>, Outside);

enum Task<'s> {
    /// A solid, its map, and a box outside which it does not matter.
    Enter(&'s Solid, Affine, Bounds),
    /// Combines the given number of most recent parts.
    Join(Join, usize),
}

#[derive(Clone, Copy)]
enum Join {
    Plain(Operation),
    Symmetric,
    Complement,
}

/// A solid as a part; `None` if it is empty.
pub(super) fn fold<B: Builder>(solid: &Solid, builder: &mut B) -> Result<Option<B::Part>, WriteError> {
    let mut tasks = vec![Task::Enter(solid, Affine::IDENTITY, builder.clip())];
    let mut parts: Vec<Known<B::Part>> = Vec::new();
    let mut count = 0;
    while let Some(task) = tasks.pop() {
        match task {
            Task::Enter(solid, place, within) => {
                count += 1;
                if count + tasks.len() > MAX_NODES {
                    return Err(WriteError::Copies { region: builder.region(), most: MAX_NODES });
                }
                parts.extend(enter(solid, place, within, builder, &mut tasks)?);
            }
            Task::Join(join, n) => {
                let operands = parts.split_off(parts.len() - n);
                let outside = outside(join, operands.iter().map(|(_, outside)| *outside));
                let operands = operands.into_iter().map(|(part, _)| part).collect();
                parts.push((joined(join, operands, builder)?, outside));
            }
        }
    }
    match parts.pop() {
        Some((Some(part), outside)) if !outside.is_exact && !outside.is_empty => {
            let everything = builder.everything();
            builder.join(Operation::Intersection, vec![part, everything])
        }
        last => Ok(last.and_then(|(part, _)| part)),
    }
}

/// Refuses a solid with more shapes and operators than [`fold`] accepts, before any of them is built.
pub(super) fn check_count(solid: &Solid, region: &str) -> Result<(), WriteError> {
    let (mut waiting, mut count) = (vec![solid], 0);
    while let Some(solid) = waiting.pop() {
        count += 1;
        let (copied, copies) = match solid.node() {
            Node::Placed(inner, maps) if solid.boundary().is_none() => (Some(inner), maps.len()),
            _ => (None, 0),
        };
        if count + waiting.len() + copies > MAX_NODES {
            return Err(WriteError::Copies { region: region.to_owned(), most: MAX_NODES });
        }
        match copied {
            Some(inner) => waiting.extend(std::iter::repeat_n(inner, copies)),
            None if solid.boundary().is_none() => waiting.extend(solid.node().operand_refs()),
            None => {}
        }
    }
    Ok(())
}

fn outside(join: Join, mut operands: impl ExactSizeIterator<Item = Outside>) -> Outside {
    let Some(first) = operands.next() else {
        return NOTHING;
    };
    let all = operands.fold((first, first), |(all, any), one| {
        let both = Outside { is_exact: all.is_exact && one.is_exact, is_empty: all.is_empty && one.is_empty };
        (both, Outside { is_empty: any.is_empty || one.is_empty, ..any })
    });
    let (all, any) = all;
    match join {
        Join::Plain(Operation::Union) | Join::Symmetric => all,
        Join::Plain(Operation::Intersection) => Outside { is_empty: any.is_empty, ..all },
        Join::Plain(Operation::Difference) => Outside { is_empty: first.is_empty, ..all },
        // a complement is the clip box minus the operand
        Join::Complement => Outside { is_exact: false, is_empty: true },
    }
}

/// The part of a node without operands; other nodes push tasks for theirs.
fn enter<'s, B: Builder>(
    solid: &'s Solid,
    place: Affine,
    within: Bounds,
    builder: &mut B,
    tasks: &mut Vec<Task<'s>>,
) -> Result<Option<Known<B::Part>>, WriteError> {
    if let Some(boundary) = solid.boundary()
        && let Some(part) = builder.bounded(boundary, &place)?
    {
        return Ok(Some((Some(part), Outside { is_exact: true, is_empty: false })));
    }
    let join = match solid.node() {
        Node::Empty => return Ok(Some((None, NOTHING))),
        Node::Universe => return Ok(Some(everything(builder))),
        Node::Intersection(all) if all.is_empty() => return Ok(Some(everything(builder))),
        Node::Primitive(shape) => {
            let bounds = shape.lower().bounds;
            let there = bounds.transformed(&place);
            let is_empty = bounds.is_finite() && builder.clip().intersection(&there) == there;
            let outside = Outside { is_exact: bounds.is_finite(), is_empty };
            return Ok(Some((builder.leaf(shape, &place, &within)?, outside)));
        }
        Node::Named(name, inner) => {
            if let Some(part) = builder.named(name, inner, &place) {
                return Ok(Some((Some(part), Outside { is_exact: true, is_empty: false })));
            }
            tasks.push(Task::Enter(inner, place, within));
            return Ok(None);
        }
        Node::Transformed(map, inner) => {
            tasks.push(Task::Enter(inner, map.get().then(&place), within));
            return Ok(None);
        }
        Node::Placed(inner, maps) if maps.len() == 1 => {
            tasks.push(Task::Enter(inner, maps[0].then(&place), within));
            return Ok(None);
        }
        Node::Placed(inner, maps) => {
            tasks.push(Task::Join(Join::Plain(Operation::Union), maps.len()));
            tasks.extend(maps.iter().rev().map(|map| Task::Enter(inner, map.then(&place), within)));
            return Ok(None);
        }
        Node::Complement(_) => Join::Complement,
        Node::Union(_) => Join::Plain(Operation::Union),
        Node::Intersection(_) => Join::Plain(Operation::Intersection),
        Node::Difference(..) => Join::Plain(Operation::Difference),
        Node::SymmetricDifference(_) => Join::Symmetric,
    };
    tasks.push(Task::Join(join, solid.node().operand_refs().count()));
    let within = match solid.node() {
        Node::Intersection(all) => within.intersection(&common_bounds(all, &place)),
        _ => within,
    };
    tasks.extend(solid.node().operand_refs().rev().map(|operand| Task::Enter(operand, place, within)));
    Ok(None)
}

/// Margin of the bounds of an intersection relative to their size, so that none of their faces coincides with one of an operand.
const MARGIN: f64 = 0.125;

/// The box, with a margin, to which the operands of an intersection confine it.
fn common_bounds(all: &[Solid], place: &Affine) -> Bounds {
    let shape = |solid: &Solid| match solid.node() {
        Node::Primitive(shape) => shape.lower().bounds,
        _ => Bounds::ALL,
    };
    let own = all.iter().map(shape).fold(Bounds::ALL, |all, one| all.intersection(&one));
    match own.is_finite() && !own.is_empty() {
        true => own.grown(MARGIN * own.size().length()).transformed(place),
        false => Bounds::ALL,
    }
}

fn everything<B: Builder>(builder: &mut B) -> Known<B::Part> {
    (Some(builder.everything()), Outside { is_exact: false, is_empty: true })
}

fn joined<B: Builder>(
    join: Join,
    mut operands: Vec<Option<B::Part>>,
    builder: &mut B,
) -> Result<Option<B::Part>, WriteError> {
    match join {
        Join::Plain(Operation::Union) => {
            plain(Operation::Union, operands.into_iter().flatten().collect(), builder)
        }
        Join::Plain(Operation::Intersection) => match operands.iter().all(Option::is_some) {
            true => plain(Operation::Intersection, operands.into_iter().flatten().collect(), builder),
            false => Ok(None),
        },
        Join::Plain(Operation::Difference) => match operands.first() {
            Some(Some(_)) => plain(Operation::Difference, operands.into_iter().flatten().collect(), builder),
            _ => Ok(None),
        },
        Join::Complement => {
            let everything = builder.everything();
            match operands.pop().flatten() {
                Some(part) => builder.join(Operation::Difference, vec![everything, part]),
                None => Ok(Some(everything)),
            }
        }
        Join::Symmetric => symmetric(operands.into_iter().flatten(), builder),
    }
}

fn plain<B: Builder>(
    by: Operation,
    mut parts: Vec<B::Part>,
    builder: &mut B,
) -> Result<Option<B::Part>, WriteError> {
    if parts.len() < 2 { Ok(parts.pop()) } else { builder.join(by, parts) }
}

/// Symmetric difference of several operands, pairwise: (a - b) | (b - a).
fn symmetric<B: Builder>(
    parts: impl Iterator<Item = B::Part>,
    builder: &mut B,
) -> Result<Option<B::Part>, WriteError> {
    let mut sum: Option<B::Part> = None;
    for part in parts {
        sum = match sum {
            None => Some(part),
            Some(sum) => {
                let one = builder.join(Operation::Difference, vec![sum.clone(), part.clone()])?;
                let other = builder.join(Operation::Difference, vec![part, sum])?;
                plain(Operation::Union, [one, other].into_iter().flatten().collect(), builder)?
            }
        };
    }
    Ok(sum)
}
