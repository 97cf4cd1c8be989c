//! `minkowski`: sums of convex things, as hulls of the sums of what they are the hulls of.

use super::arguments::{Arguments, Refusal};
use super::boolean::Operation;
use super::extrude::is_convex as is_one_cell;
use super::flat::{Flat, Flats, Leaf, image, simple};
use super::gather::{Round, hull_of_discs, round};
use super::hull::{Generator, cost as cost_of_hull, hull};
use super::part::{Part, union};
use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;

/// More parts than these come of unions of many parts only.
pub(super) const MOST_SUMS: usize = 2000;

/// A sum of solids, and whether it is exact.
pub(super) struct Sum {
    pub solid: Option<Solid>,
    pub is_exact: bool,
    /// The convex parts of which it is the union.
    pub parts: Vec<Vec<Generator>>,
}

/// How many sums of two convex parts it takes.
pub(super) fn pairs(operands: &[Vec<Vec<Generator>>]) -> usize {
    operands.iter().map(Vec::len).fold(1, usize::saturating_mul)
}

/// About how many steps a sum takes.
pub(super) fn cost(operands: &[Vec<Vec<Generator>>]) -> usize {
    let of_all = |parts: &Vec<Vec<Generator>>| {
        parts.iter().map(|part| cost_of_hull(part)).fold(0, usize::saturating_add)
    };
    operands.iter().map(of_all).fold(1, usize::saturating_mul)
}

/// The sum of solids, each of which is a union of convex parts.
pub(super) fn sum(arguments: &Arguments, operands: Vec<Vec<Vec<Generator>>>) -> Result<Sum, Refusal> {
    let mut operands = operands.into_iter();
    let mut sums: Vec<Vec<Generator>> = operands.next().unwrap_or_default();
    let mut is_exact = true;
    for operand in operands {
        let pairs = sums.iter().flat_map(|a| operand.iter().map(move |b| (a, b)));
        sums = pairs.map(|(a, b)| all_sums(a, b, &mut is_exact)).collect();
    }
    let mut parts = Vec::new();
    for generators in &sums {
        let found = hull(arguments, generators)?;
        is_exact &= found.is_exact;
        parts.extend(found.solid);
    }
    Ok(Sum { solid: (!parts.is_empty()).then(|| union(parts)), is_exact, parts: sums })
}

fn all_sums(a: &[Generator], b: &[Generator], is_exact: &mut bool) -> Vec<Generator> {
    let mut sums = Vec::with_capacity(a.len() * b.len());
    for x in a {
        for y in b {
            match sum_of(x, y) {
                Some(sum) => sums.push(sum),
                None => {
                    *is_exact = false;
                    let (v, w) = (x.vertices(), y.vertices());
                    let pairs = v.iter().flat_map(|v| w.iter().map(move |w| *v + *w));
                    sums.extend(pairs.map(Generator::point));
                }
            }
        }
    }
    sums
}

/// The sum of two, if it is one of the same kinds.
fn sum_of(a: &Generator, b: &Generator) -> Option<Generator> {
    let centre = a.centre() + b.centre();
    let radius = a.radius() + b.radius();
    match (*a, *b) {
        (Generator::Ball { fragments: m, .. }, Generator::Ball { fragments: n, .. }) => {
            Some(Generator::Ball { centre, radius, fragments: m.max(n) })
        }
        (Generator::Disc { axis, fragments, .. }, Generator::Ball { radius: 0.0, .. })
        | (Generator::Ball { radius: 0.0, .. }, Generator::Disc { axis, fragments, .. }) => {
            Some(Generator::Disc { centre, axis, radius, fragments })
        }
        (Generator::Disc { axis, fragments: m, .. }, Generator::Disc { axis: other, fragments: n, .. })
            if axis.cross(other).length() < 1e-7 =>
        {
            Some(Generator::Disc { centre, axis, radius, fragments: m.max(n) })
        }
        _ => None,
    }
}

/// The sum of a union of leaves and the hull of discs.
pub(super) fn flat_sum(
    arguments: &Arguments,
    flats: &mut Flats,
    flat: Flat,
    other: &[Round],
) -> Result<Part, Refusal> {
    let leaves = leaves(arguments, flats, flat)?;
    let mut parts = Vec::new();
    for (leaf, map) in leaves {
        for discs in convex_pieces(arguments, &leaf, &map)? {
            parts.push(hull_of_discs(flats, &round_sums(&discs, other)));
        }
        if let (Leaf::Outline(_), Some(first)) = (&leaf, other.first()) {
            // what is far from its boundary
            let shift = Affine::translate(Vec3::new(first.0[0], first.0[1], 0.0));
            let own = flats.leaf(leaf);
            parts.push(flats.moved(map.then(&shift), own).into());
        }
    }
    let flats_of = |part: Part| match part {
        Part::Flat(pieces) => pieces.into_iter().map(|piece| piece.body).collect(),
        _ => Vec::new(),
    };
    let parts: Vec<Flat> = parts.into_iter().flat_map(flats_of).collect();
    match parts.is_empty() {
        true => Ok(Part::Empty),
        false => Ok(flats.join(Operation::Union, parts).into()),
    }
}

fn round_sums(a: &[Round], b: &[Round]) -> Vec<Round> {
    let sum = |(p, r, m): &Round, (q, s, n): &Round| ([p[0] + q[0], p[1] + q[1]], r + s, *m.max(n));
    a.iter().flat_map(|x| b.iter().map(move |y| sum(x, y))).collect()
}

/// The leaves of a union, with their maps.
pub(super) fn leaves(
    arguments: &Arguments,
    flats: &Flats,
    flat: Flat,
) -> Result<Vec<(Leaf, Affine)>, Refusal> {
    if !flats.is_union(flat) {
        return Err(arguments.refusal("the boundary of what is cut out of something is not known"));
    }
    flats.fold(flat, |leaf, map| Ok(vec![(leaf.clone(), *map)]), |_, parts| parts.concat())
}

/// A convex leaf as one set of discs and points; any other as its edges.
fn convex_pieces(arguments: &Arguments, leaf: &Leaf, map: &Affine) -> Result<Vec<Vec<Round>>, Refusal> {
    let mut flats = Flats::default();
    let own = flats.leaf(leaf.clone());
    let own = flats.moved(*map, own);
    if is_convex_leaf(arguments, leaf)? {
        return Ok(vec![round(arguments, &flats, own)?]);
    }
    let mut edges = Vec::new();
    for contour in leaf.contours() {
        let next = contour.iter().skip(1).chain(contour.first());
        let ends = contour.iter().zip(next);
        edges.extend(ends.map(|(a, b)| [*a, *b].map(|p| (image(map, p), 0.0, 1)).to_vec()));
    }
    Ok(edges)
}

/// True if the region is one convex leaf.
pub(super) fn is_convex(arguments: &Arguments, flats: &Flats, flat: Flat) -> Result<bool, Refusal> {
    match flats.is_union(flat) {
        true => match &leaves(arguments, flats, flat)?[..] {
            [(leaf, _)] => is_convex_leaf(arguments, leaf),
            _ => Ok(false),
        },
        false => Ok(false),
    }
}

fn is_convex_leaf(arguments: &Arguments, leaf: &Leaf) -> Result<bool, Refusal> {
    match leaf {
        Leaf::Disc { .. } => Ok(true),
        Leaf::Outline(contours) => match &contours[..] {
            [contour] => {
                Ok(simple(arguments, contour.clone())?.is_some_and(|polygons| is_one_cell(&polygons)))
            }
            _ => Ok(false),
        },
    }
}
