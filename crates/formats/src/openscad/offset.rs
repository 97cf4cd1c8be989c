//! Polygon offset (`offset`): plane regions grown or shrunk.

use super::arguments::{Arguments, Refusal};
use super::drawing::shift;
use super::facets::Fineness;
use super::flat::{Flat, Flats, Leaf};
use super::gather::hull_of_discs;
use super::operation::Operation;
use super::part::Part;
use super::region::{Contours, Corner, boundary, offset as moved};
use super::revolve::plane_similarity;
use super::sum::flat_sum;

/// `offset(r)` and `offset(delta, chamfer)`. Without facets, round corners are exact discs.
pub(super) fn offset(arguments: &Arguments, flats: &mut Flats, flat: Flat) -> Result<Part, Refusal> {
    let radius = arguments.number("r", 0.0)?;
    let delta = arguments.number("delta", 0.0)?;
    let by = if radius != 0.0 { radius } else { delta };
    if by == 0.0 {
        return Ok(flat.into());
    }
    if !flats.facets
        && let Some(part) = disc(arguments, flats, flat, by)?
    {
        return Ok(part);
    }
    let fragments = Fineness::of(arguments)?.fragments(by.abs());
    if radius > 0.0 && !flats.facets {
        // the sum of two discs is a disc
        let (flat, radius) = match flats.grown(flat) {
            Some((original, by)) => (original, by + radius),
            None => (plain(arguments, flats, flat)?, radius),
        };
        let flat = few(arguments, flats, flat)?;
        let part = flat_sum(arguments, flats, flat, &[([0.0; 2], radius, fragments)])?;
        if let Part::Flat(pieces) = &part
            && let [piece] = &pieces[..]
        {
            flats.set_grown(piece.body, flat, radius);
        }
        return Ok(part);
    }
    let contours = boundary(arguments, flats, flat)?;
    if radius < 0.0 && !flats.facets {
        return shrunk(arguments, flats, contours, -radius, fragments);
    }
    let corner = match radius == 0.0 {
        true if arguments.boolean("chamfer", false)? => Corner::Cut,
        true => Corner::Sharp,
        false => Corner::Round(fragments),
    };
    let contours = moved(arguments, &contours, by, corner)?;
    arguments.hold(contours.iter().map(Vec::len).sum())?;
    match contours.is_empty() {
        true => Ok(Part::Empty),
        false => Ok(flats.leaf(Leaf::Outline(contours)).into()),
    }
}

/// The region itself if it is a union, else a region made of its boundary.
pub(super) fn plain(arguments: &Arguments, flats: &mut Flats, flat: Flat) -> Result<Flat, Refusal> {
    if flats.is_union(arguments, flat)? {
        return Ok(flat);
    }
    let contours = boundary(arguments, flats, flat)?;
    Ok(flats.leaf(Leaf::Outline(contours)))
}

/// Maximum number of parts of a union that are grown one by one; each one becomes several.
const MAX_PARTS: usize = 1000;

/// The region itself if it is a union of few leaves, else a region made of its boundary.
pub(super) fn few(arguments: &Arguments, flats: &mut Flats, flat: Flat) -> Result<Flat, Refusal> {
    let count = flats.fold(arguments, flat, |_, _| Ok(1), |_, parts: Vec<usize>| Ok(parts.iter().sum()))?;
    if count <= MAX_PARTS {
        return Ok(flat);
    }
    let contours = boundary(arguments, flats, flat)?;
    arguments.hold(contours.iter().map(Vec::len).sum())?;
    Ok(flats.leaf(Leaf::Outline(contours)))
}

/// The offset of a region that is a single disc, else `None`.
fn disc(arguments: &Arguments, flats: &mut Flats, flat: Flat, by: f64) -> Result<Option<Part>, Refusal> {
    let of_leaf = |leaf: &Leaf, map: &_| {
        Ok(match (leaf, plane_similarity(map)) {
            (Leaf::Disc { radius, fragments }, Some(factor)) => {
                vec![Some(([map.translation.x, map.translation.y], factor * radius + by, *fragments))]
            }
            _ => vec![None],
        })
    };
    let all = flats.fold(arguments, flat, of_leaf, |_, parts: Vec<Vec<_>>| Ok(parts.concat()))?;
    let [Some((centre, radius, fragments))] = all[..] else { return Ok(None) };
    if radius <= 0.0 {
        return Ok(Some(Part::Empty));
    }
    let disc = flats.leaf(Leaf::Disc { radius, fragments });
    Ok(Some(flats.transformed(shift(centre), disc).into()))
}

/// The points of the region that are farther than a distance from its boundary.
fn shrunk(
    arguments: &Arguments,
    flats: &mut Flats,
    contours: Contours,
    by: f64,
    fragments: usize,
) -> Result<Part, Refusal> {
    let mut rims = Vec::new();
    for contour in &contours {
        for (k, p) in contour.iter().enumerate() {
            let q = contour[(k + 1) % contour.len()];
            let ends = [(*p, by, fragments), (q, by, fragments)];
            if let Part::Flat(pieces) = hull_of_discs(arguments, flats, &ends)? {
                rims.extend(pieces.into_iter().map(|piece| piece.body));
            }
        }
    }
    if contours.is_empty() {
        return Ok(Part::Empty);
    }
    let mut operands = vec![flats.leaf(Leaf::Outline(contours))];
    operands.extend(rims);
    Ok(flats.join(Operation::Difference, operands).into())
}
