//! Cells that are boxes: where particles move from face to face and meet few other boxes, such as crystals in their wrapping.
//!
//! A caller that moves many particles through such cells can compute their crossings itself, without a query for each step. The
//! time at which a ray with the origin o and the direction d crosses a face of a box is `(offset - n (o + shift)) / (n d) + 0`,
//! by these operations in this order, where n is the outward normal, plus or minus a unit vector of an axis. It has the bits
//! of all evaluators. A crossing is the first one, with the regions before and after it, if no other face of the boxes of the cell
//! is crossed within [`BoxCells::margin`] of it, and the ray is not nearly parallel to any of them ([`BoxCells::SLOW`]).

use crate::{PlacementId, RegionId, Start, SurfaceId};
use rayweave_math::Vec3;

/// The cells of a model that are boxes.
#[derive(Clone, Debug, Default)]
pub struct BoxCells {
    /// The boxes.
    pub boxes: Vec<AxisBox>,
    /// The cells.
    pub cells: Vec<BoxCell>,
    /// The least distance, in the 1-norm, between two crossings along a ray that are certainly separate.
    pub margin: f64,
    /// The zeros of the unit normals of low faces and of those of high faces, with their signs.
    pub zeros: [f64; 2],
    /// For each placement, the first of its surfaces in `faces`, the number of this surface, and their count.
    of_placement: Vec<[u32; 3]>,
    /// For the surfaces of each placement, six times the number of the box plus the number of its face; [`NONE`] for others.
    faces: Vec<u32>,
}

/// A box with faces across the axes, in a frame that is not turned.
#[derive(Clone, Debug)]
pub struct AxisBox {
    /// The region of its inside.
    pub region: RegionId,
    /// The placement of its surfaces.
    pub placement: PlacementId,
    /// The translation into its frame.
    pub shift: Vec3,
    /// The offsets of the faces whose outward normals point against the axes.
    pub low: [f64; 3],
    /// The offsets of the faces whose outward normals point along the axes.
    pub high: [f64; 3],
    /// The surfaces of these faces, low ones first.
    pub surfaces: [SurfaceId; 6],
    /// The cell of its inside.
    pub cell: Option<u32>,
    /// The cell around it, and its place in the list of that cell.
    pub around: Option<(u32, usize)>,
}

/// The inside of a box, with all other boxes that rays can meet there or at its faces.
#[derive(Clone, Debug)]
pub struct BoxCell {
    /// The box of the cell, then the others.
    pub list: Vec<u32>,
    /// The region behind the faces of the box, where no other box of the list is.
    pub behind: RegionId,
}

/// The place of a ray that starts on a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoxStart {
    /// The cell that the ray moves in.
    pub cell: u32,
    /// The place, in the list of the cell, of the box that it starts on.
    pub place: usize,
    /// The face: the number of the axis, plus 3 for high faces.
    pub face: usize,
}

/// No face.
const NONE: u32 = u32::MAX;

impl BoxCells {
    /// The largest number of boxes in the list of a cell.
    pub const MOST: usize = 4;

    /// Ratio of a component of a direction to its 1-norm below which a ray is nearly parallel to a face.
    pub const SLOW: f64 = 4e-5;

    /// Boxes and cells; `zeros` are those of the unit normals.
    pub fn new(boxes: Vec<AxisBox>, cells: Vec<BoxCell>, margin: f64, zeros: [f64; 2]) -> BoxCells {
        let placements = boxes.iter().map(|own| own.placement.index() + 1).max().unwrap_or(0);
        let mut spans = vec![[NONE, 0]; placements];
        for own in &boxes {
            let [low, end] = &mut spans[own.placement.index()];
            for SurfaceId(surface) in own.surfaces {
                (*low, *end) = ((*low).min(surface), (*end).max(surface + 1));
            }
        }
        let mut found = BoxCells { margin, zeros, ..BoxCells::default() };
        for [low, end] in spans {
            let count = end.saturating_sub(low);
            found.of_placement.push([found.faces.len() as u32, low, count]);
            found.faces.resize(found.faces.len() + count as usize, NONE);
        }
        let mut shared = Vec::new();
        for (own, number) in boxes.iter().zip(0..) {
            for (SurfaceId(surface), face) in own.surfaces.into_iter().zip(0..) {
                let [first, low, _] = found.of_placement[own.placement.index()];
                let at = (first + surface - low) as usize;
                if found.faces[at] != NONE {
                    shared.push(at);
                }
                found.faces[at] = 6 * number + face;
            }
        }
        // a surface does not tell on which of its boxes a ray starts
        shared.into_iter().for_each(|at| found.faces[at] = NONE);
        (found.boxes, found.cells) = (boxes, cells);
        found
    }

    /// The place of a ray that starts on one surface; `None` elsewhere. Here `inside` is true for the side of the inside of the box,
    /// whatever the sign of the surface's function there.
    #[inline]
    pub fn start(&self, start: &Start) -> Option<BoxStart> {
        let &[first, low, count] = self.of_placement.get(start.placement.index())?;
        let at = start.surface.0.wrapping_sub(low);
        let face = if at < count { self.faces[(first + at) as usize] } else { NONE };
        let own = self.boxes.get((face / 6) as usize)?;
        let (cell, place) = if start.inside { (own.cell?, 0) } else { own.around? };
        Some(BoxStart { cell, place, face: (face % 6) as usize })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box in a box: rays on the faces of the inner one are within it or around it, and those on a surface of both are nowhere.
    #[test]
    fn starts_are_those_of_the_boxes_with_the_surface() {
        let cube = |region, first: u32, cell, around| AxisBox {
            region: RegionId(region),
            placement: PlacementId(1),
            shift: Vec3::ZERO,
            low: [1.0; 3],
            high: [1.0; 3],
            surfaces: std::array::from_fn(|k| SurfaceId(first + k as u32)),
            cell: Some(cell),
            around,
        };
        let boxes = vec![cube(1, 7, 0, None), cube(2, 12, 1, Some((0, 1)))];
        let cells = [vec![0, 1], vec![1]].map(|list| BoxCell { list, behind: RegionId(0) });
        let cells = BoxCells::new(boxes, cells.to_vec(), 0.0, [0.0; 2]);
        let start = |surface, placement, inside| {
            let (surface, placement) = (SurfaceId(surface), PlacementId(placement));
            cells.start(&Start { surface, placement, inside })
        };
        assert_eq!(start(8, 1, true), Some(BoxStart { cell: 0, place: 0, face: 1 }));
        assert_eq!(start(17, 1, false), Some(BoxStart { cell: 0, place: 1, face: 5 }));
        assert_eq!(start(17, 1, true), Some(BoxStart { cell: 1, place: 0, face: 5 }));
        for (surface, placement, inside) in
            [(8, 1, false), (12, 1, true), (6, 1, true), (18, 1, true), (8, 0, true), (8, 2, true)]
        {
            assert_eq!(start(surface, placement, inside), None);
        }
    }
}
