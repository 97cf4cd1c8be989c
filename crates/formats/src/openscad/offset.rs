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
        && let Some(part) = disc(flats, flat, by)?
    {
        return Ok(part);
    }
    let fragments = Fineness::of(arguments)?.fragments(by.abs());
    if radius > 0.0 && !flats.facets {
        let flat = plain(arguments, flats, flat)?;
        return flat_sum(arguments, flats, flat, &[([0.0; 2], radius, fragments)]);
    }
    let contours = boundary(arguments, flats, flat)?;
    if radius < 0.0 && !flats.facets {
        return Ok(shrunk(flats, contours, -radius, fragments));
    }
    let corner = match radius == 0.0 {
        true if arguments.boolean("chamfer", false)? => Corner::Cut,
        true => Corner::Sharp,
        false => Corner::Round(fragments),
    };
    let contours = moved(arguments, &contours, by, corner)?;
    match contours.is_empty() {
        true => Ok(Part::Empty),
        false => Ok(flats.leaf(Leaf::Outline(contours)).into()),
    }
}

/// The region itself if it is a union, else a region made of its boundary.
pub(super) fn plain(arguments: &Arguments, flats: &mut Flats, flat: Flat) -> Result<Flat, Refusal> {
    if flats.is_union(flat) {
        return Ok(flat);
    }
    let contours = boundary(arguments, flats, flat)?;
    Ok(flats.leaf(Leaf::Outline(contours)))
}

/// The offset of a region that is a single disc, else `None`.
fn disc(flats: &mut Flats, flat: Flat, by: f64) -> Result<Option<Part>, Refusal> {
    let of_leaf = |leaf: &Leaf, map: &_| {
        Ok(match (leaf, plane_similarity(map)) {
            (Leaf::Disc { radius, fragments }, Some(factor)) => {
                vec![Some(([map.translation.x, map.translation.y], factor * radius + by, *fragments))]
            }
            _ => vec![None],
        })
    };
    let all = flats.fold(flat, of_leaf, |_, parts: Vec<Vec<_>>| parts.concat())?;
    let [Some((centre, radius, fragments))] = all[..] else { return Ok(None) };
    if radius <= 0.0 {
        return Ok(Some(Part::Empty));
    }
    let disc = flats.leaf(Leaf::Disc { radius, fragments });
    Ok(Some(flats.moved(shift(centre), disc).into()))
}

/// The points of the region that are farther than a distance from its boundary.
fn shrunk(flats: &mut Flats, contours: Contours, by: f64, fragments: usize) -> Part {
    let mut rims = Vec::new();
    for contour in &contours {
        for (k, p) in contour.iter().enumerate() {
            let q = contour[(k + 1) % contour.len()];
            if let Part::Flat(pieces) = hull_of_discs(flats, &[(*p, by, fragments), (q, by, fragments)]) {
                rims.extend(pieces.into_iter().map(|piece| piece.body));
            }
        }
    }
    if contours.is_empty() {
        return Part::Empty;
    }
    let mut operands = vec![flats.leaf(Leaf::Outline(contours))];
    operands.extend(rims);
    flats.join(Operation::Difference, operands).into()
}
