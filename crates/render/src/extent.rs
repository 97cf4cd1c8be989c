//! Screen-space extent of a model: the pixels in which it can be visible.

use crate::sample::PicturePoints;
use crate::{Camera, Size};
use rayweave_math::Bounds;
use std::num::NonZeroUsize;
use std::ops::Range;

/// For each row of pixels, the columns in which the model can be visible.
///
/// The projection of a box is the convex hull of the projections of its corners (projections keep lines
/// straight, and all corners are in front of the camera). Its columns in a row are those of the segments
/// between corners, clipped to the row. Rows and columns are extended by a pixel.
pub(crate) struct Extent {
    rows: Vec<Range<usize>>,
}

/// A tile of the picture, whose rays are traced as one batch: they are coherent, and their hits fit into the
/// L1 cache unless the evaluator prefers larger batches.
pub(crate) struct Tile {
    /// The parts of its rows inside the extent, block by block.
    pub parts: Vec<Part>,
}

/// A part of a row, within one block.
pub(crate) struct Part {
    pub row: usize,
    pub columns: Range<usize>,
    /// The number of columns of the extent before this part.
    pub offset: usize,
}

/// The size of tiles: columns and rows, whole numbers of blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TileSize {
    width: usize,
    pub height: usize,
}

impl TileSize {
    /// Tiles of a picture for an evaluator that prefers batches of this many rays.
    pub fn new(batch: Option<NonZeroUsize>, picture: Size) -> TileSize {
        let smallest = TileSize { width: 32, height: 8 };
        let [columns, rows] = Tile::BLOCK;
        match batch {
            None => smallest,
            Some(batch) => {
                let width = picture.width().next_multiple_of(columns).max(smallest.width);
                let height = (batch.get() / width).min(picture.height()).next_multiple_of(rows);
                TileSize { width, height: height.max(smallest.height) }
            }
        }
    }
}

impl Tile {
    /// Block of pixels, columns and rows, whose rays are consecutive: evaluators process about eight rays at
    /// a time, and a compact block touches fewer leaves than a row of as many pixels.
    const BLOCK: [usize; 2] = [4, 2];

    /// The centres of its pixels, in a picture of a width.
    pub fn centres(&self, width: usize, points: &mut PicturePoints) {
        points.places.clear();
        points.pixels.clear();
        points.per_side = 1;
        for part in &self.parts {
            points.places.extend(part.columns.clone().map(|x| centre(x, part.row)));
            points.pixels.extend(part.columns.clone().map(|x| (part.row * width + x) as u32));
        }
    }
}

/// The centre of a pixel.
pub(crate) fn centre(x: usize, y: usize) -> [f64; 2] {
    [x as f64 + 0.5, y as f64 + 0.5]
}

/// The least side of a pixel relative to all coordinates: below it, rounding could move the corners by a part
/// of a pixel.
const FINE: f64 = 1e-9;

impl Extent {
    pub fn new(camera: &Camera, size: Size, bounds: &Bounds) -> Extent {
        let whole = 0..size.width();
        let rows = match corners(camera, size, bounds) {
            None => vec![whole; size.height()],
            Some(corners) => (0..size.height()).map(|y| columns(&corners, y, size)).collect(),
        };
        Extent { rows }
    }

    /// The non-empty tiles of a band of rows, from left to right.
    pub fn tiles(&self, size: TileSize, rows: Range<usize>) -> impl Iterator<Item = Tile> + '_ {
        let busy = rows.clone().map(|row| self.columns(row)).filter(|columns| !columns.is_empty());
        let all = busy.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)).unwrap_or(0..0);
        all.clone().step_by(size.width).map(move |left| {
            let [width, height] = Tile::BLOCK;
            let mut parts = Vec::with_capacity(size.width / width * size.height);
            for top in rows.clone().step_by(height) {
                for left in (left..left + size.width).step_by(width) {
                    let part = |row| self.part(row, left..left + width);
                    parts.extend((top..rows.end.min(top + height)).filter_map(part));
                }
            }
            Tile { parts }
        })
    }

    /// The columns of a row that are inside the extent.
    fn part(&self, row: usize, columns: Range<usize>) -> Option<Part> {
        let own = &self.rows[row];
        let columns = columns.start.max(own.start)..columns.end.min(own.end);
        (!columns.is_empty()).then(|| Part { row, offset: columns.start - own.start, columns })
    }

    /// The columns of the extent in a row.
    pub fn columns(&self, row: usize) -> Range<usize> {
        self.rows[row].clone()
    }
}

/// The projected corners of a box; `None` if they do not bound its projection.
fn corners(camera: &Camera, size: Size, bounds: &Bounds) -> Option<Vec<(f64, f64)>> {
    if bounds.is_empty() {
        return Some(Vec::new());
    }
    if !bounds.is_finite() {
        return None;
    }
    let corners = bounds.corners();
    let depth = |corner| camera.forward().dot(corner - camera.position());
    let nearest = corners.into_iter().map(depth).fold(f64::INFINITY, f64::min);
    let largest =
        (corners.into_iter().chain([camera.position()])).map(|point| point.length()).fold(0.0, f64::max);
    let is_fine = camera.footprint(size, nearest) > FINE * largest;
    let places = corners.into_iter().map(|corner| camera.place_of(size, corner));
    if nearest > 0.0 && is_fine { places.collect() } else { None }
}

fn columns(corners: &[(f64, f64)], row: usize, size: Size) -> Range<usize> {
    let (top, bottom) = (row as f64 - 1.0, row as f64 + 2.0);
    let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
    for (k, &a) in corners.iter().enumerate() {
        for &b in &corners[k..] {
            let (a, b) = if a.1 <= b.1 { (a, b) } else { (b, a) };
            if b.1 < top || a.1 > bottom {
                continue;
            }
            for y in [a.1.max(top), b.1.min(bottom)] {
                let part = if b.1 > a.1 { (y - a.1) / (b.1 - a.1) } else { 0.0 };
                let x = a.0 + part * (b.0 - a.0);
                left = left.min(x);
                right = right.max(x);
            }
            if a.1 == b.1 {
                left = left.min(b.0);
                right = right.max(b.0);
            }
        }
    }
    // casts saturate at 0; the width limits the rest
    let start = ((left - 1.0) as usize).min(size.width());
    let end = ((right + 2.0).max(0.0) as usize).min(size.width());
    start..end.max(start)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Projection, View};
    use rayweave_math::Vec3;

    fn size() -> Size {
        Size::new(60, 40).unwrap()
    }

    #[test]
    fn all_points_of_a_box_are_within() {
        let bounds = Bounds::new(Vec3::new(-1.0, -2.0, 0.5), Vec3::new(3.0, 1.0, 1.0));
        let perspective = Projection::Perspective { field_of_view: 50.0 };
        let (eye, target) = (Vec3::new(5.0, -6.0, 4.0), Vec3::new(2.0, 1.0, 0.0));
        let cameras = [
            View::Iso.of_bounds(&bounds, size()),
            View::Front.of_bounds(&bounds, size()),
            Camera::new(eye, target, Vec3::Z, perspective).unwrap(),
        ];
        for camera in cameras {
            let extent = Extent::new(&camera, size(), &bounds);
            let mut seen = 0;
            for k in 0..9261 {
                let part = Vec3::new((k % 21) as f64, (k / 21 % 21) as f64, (k / 441) as f64) / 20.0;
                let (x, y) = camera.place_of(size(), bounds.lo + part * bounds.size()).unwrap();
                if (0.0..60.0).contains(&x) && (0.0..40.0).contains(&y) {
                    assert!(extent.columns(y as usize).contains(&(x as usize)), "{x} {y}");
                    seen += 1;
                }
            }
            assert!(seen > 4000, "{seen}");
            let pixels: usize = (0..40).map(|row| extent.columns(row).len()).sum();
            assert!(pixels < 60 * 40, "nothing is left out");
        }
    }

    #[test]
    fn a_box_around_the_camera_covers_all_pixels() {
        let around = Bounds::centred(Vec3::ZERO, Vec3::splat(10.0));
        let camera = Camera::perspective(Vec3::ZERO, Vec3::Y, Vec3::Z, 40.0).unwrap();
        assert_eq!(Extent::new(&camera, size(), &around).columns(7), 0..60);
        assert_eq!(Extent::new(&camera, size(), &Bounds::ALL).columns(7), 0..60);
        assert!(Extent::new(&camera, size(), &Bounds::EMPTY).columns(7).is_empty());
    }
}
