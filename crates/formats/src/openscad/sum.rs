//! Minkowski sum (`minkowski`) of convex parts: the convex hull of the sums of their generators.

use super::arguments::{Arguments, Refusal};
use super::flat::{Flat, Flats, Leaf, image};
use super::gather::{Round, hull_of_discs, is_convex_leaf, leaves, round};
use super::hull::{Generator, check_count, cost as cost_of_hull, hull};
use super::operation::Operation;
use super::part::{Part, union};
use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;

/// A Minkowski sum, inexact if round generators were tessellated.
pub(super) struct Sum {
    pub solid: Option<Solid>,
    pub is_exact: bool,
    /// Decomposition of the sum into convex parts, given by their generators.
    pub parts: Vec<Vec<Generator>>,
}

/// Number of sums of two convex parts.
pub(super) fn pairs(operands: &[Vec<Vec<Generator>>]) -> usize {
    operands.iter().map(Vec::len).fold(1, usize::saturating_mul)
}

/// Minkowski sum of solids, each given as a union of convex parts.
pub(super) fn sum(arguments: &Arguments, operands: Vec<Vec<Vec<Generator>>>) -> Result<Sum, Refusal> {
    let mut operands = operands.into_iter();
    let mut sums: Vec<Vec<Generator>> = operands.next().unwrap_or_default();
    let mut is_exact = true;
    for operand in operands {
        let pairs = sums.iter().flat_map(|a| operand.iter().map(move |b| (a, b)));
        sums = pairs.map(|(a, b)| all_sums(arguments, a, b, &mut is_exact)).collect::<Result<_, _>>()?;
    }
    let mut parts = Vec::new();
    for generators in &sums {
        arguments.spend(cost_of_hull(generators))?;
        let found = hull(arguments, generators)?;
        is_exact &= found.is_exact;
        parts.extend(found.solid);
    }
    Ok(Sum { solid: (!parts.is_empty()).then(|| union(parts)), is_exact, parts: sums })
}

fn all_sums(
    arguments: &Arguments,
    a: &[Generator],
    b: &[Generator],
    is_exact: &mut bool,
) -> Result<Vec<Generator>, Refusal> {
    check_count(arguments, a.len().saturating_mul(b.len()))?;
    let mut sums = Vec::new();
    for x in a {
        for y in b {
            match sum_of(x, y) {
                Some(sum) => sums.push(sum),
                None => {
                    *is_exact = false;
                    let count = x.vertex_count().saturating_mul(y.vertex_count());
                    check_count(arguments, count.saturating_add(sums.len()))?;
                    let (v, w) = (x.vertices(), y.vertices());
                    let pairs = v.iter().flat_map(|v| w.iter().map(move |w| *v + *w));
                    sums.extend(pairs.map(Generator::point));
                }
            }
        }
    }
    Ok(sums)
}

/// The sum of two generators if it is a generator, else `None`.
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

/// Minkowski sum of a union of leaves with the convex hull of discs.
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
            check_count(arguments, discs.len().saturating_mul(other.len()))?;
            parts.push(hull_of_discs(arguments, flats, &round_sums(&discs, other))?);
        }
        if let (Leaf::Outline(_), Some(first)) = (&leaf, other.first()) {
            // the interior of the leaf, farther from the boundary
            let shift = Affine::translate(Vec3::new(first.0[0], first.0[1], 0.0));
            let own = flats.leaf(leaf);
            parts.push(flats.transformed(map.then(&shift), own).into());
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

/// A convex leaf as one set of discs and points; any other leaf as its edges.
fn convex_pieces(arguments: &Arguments, leaf: &Leaf, map: &Affine) -> Result<Vec<Vec<Round>>, Refusal> {
    let mut flats = Flats::default();
    let own = flats.leaf(leaf.clone());
    let own = flats.transformed(*map, own);
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
