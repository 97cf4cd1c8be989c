//! Nesting of contours and validation of their orientation.

use crate::error::PolygonError;
use crate::exact::orientation;
use crate::sweep::{ContourStart, Contours, previous};
use rayweave_rootray::Side;

/// The place of a contour in the nesting tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nesting {
    /// The innermost contour around it.
    pub parent: Option<u32>,
    /// True for an island (counter-clockwise), false for a hole.
    pub is_island: bool,
}

/// The nesting of each contour; `numbers` are the contours' indices for errors.
///
/// The region is on the left of each edge. The direction of the edge below a contour's first corner therefore determines
/// whether the contour lies inside or outside, and this determines its orientation.
pub fn nest(
    contours: &Contours<'_>,
    starts: &[ContourStart],
    outside: Side,
    numbers: &[usize],
) -> Result<Vec<Nesting>, PolygonError> {
    let previous = previous(contours.next);
    let mut nesting = vec![Nesting { parent: None, is_island: false }; starts.len()];
    // the edge below a contour belongs to a contour that the sweep found earlier
    for start in starts {
        let v = start.first as usize;
        let corner = [previous[v] as usize, v, contours.next[v] as usize].map(|k| contours.vertices[k]);
        let is_island = orientation(corner[0], corner[1], corner[2]) > 0;
        let (side, parent) = match start.below {
            None => (outside, None),
            Some((edge, points_right)) => {
                let contour = contours.contour[edge as usize];
                let below = nesting[contour as usize];
                let is_within = points_right == below.is_island;
                let parent = if is_within { Some(contour) } else { below.parent };
                (Side::from_inside(points_right), parent)
            }
        };
        if is_island == side.is_inside() {
            return Err(PolygonError::Orientation {
                contour: numbers[start.contour as usize],
                clockwise: !is_island,
                parent: parent.map(|contour| numbers[contour as usize]),
            });
        }
        nesting[start.contour as usize] = Nesting { parent, is_island };
    }
    Ok(nesting)
}
