//! Which contour lies in which, and whether it goes around the right way there.

use super::error::PolygonError;
use super::exact::turn;
use super::sweep::{Footing, Ring, previous};
use rayweave_rootray::Side;

/// What is known of a contour, in the order in which contours were given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The contour directly around it.
    pub around: Option<u32>,
    /// True for an island (counter-clockwise), false for a hole.
    pub is_island: bool,
}

/// The place of each contour, `names` being what contours are called in errors.
///
/// A contour has the region on its left. So the way in which the edge below its first corner leads says whether
/// it stands inside or outside, and that says which way it has to go around.
pub fn nest(
    ring: &Ring<'_>,
    footings: &[Footing],
    outside: Side,
    names: &[usize],
) -> Result<Vec<Place>, PolygonError> {
    let previous = previous(ring.next);
    let mut places = vec![Place { around: None, is_island: false }; footings.len()];
    // a contour's footing is an edge of one that the sweep met before
    for footing in footings {
        let v = footing.first as usize;
        let corner = [previous[v] as usize, v, ring.next[v] as usize].map(|k| ring.vertices[k]);
        let is_island = turn(corner[0], corner[1], corner[2]) > 0;
        let (side, around) = match footing.below {
            None => (outside, None),
            Some((edge, leads_right)) => {
                let contour = ring.contour[edge as usize];
                let below = places[contour as usize];
                let is_within = leads_right == below.is_island;
                let around = if is_within { Some(contour) } else { below.around };
                (Side::from_inside(leads_right), around)
            }
        };
        if is_island == side.is_inside() {
            return Err(PolygonError::Orientation {
                contour: names[footing.contour as usize],
                clockwise: !is_island,
                around: around.map(|contour| names[contour as usize]),
            });
        }
        places[footing.contour as usize] = Place { around, is_island };
    }
    Ok(places)
}
