//! Sectors of revolutions, and the number of facets of circles.

use super::arguments::{Arguments, Refusal};
use super::drawing::chords;
use super::facets::Fineness;
use super::region::Contours;
use super::state::Reader;
use rayweave_math::{Vec3, sin_cos_degrees};
use rayweave_polygon::Point;

/// Number of facets of a circle with the given number of fragments in the dump; exact circles get fine facets.
pub(super) fn round(reader: &Reader, fragments: usize) -> usize {
    if reader.options.facets {
        return fragments;
    }
    reader.flats.has_chords.set(true);
    fragments.max(chords(360.0))
}

/// Equal sectors of a revolution about the z axis, which start at the same angle as in OpenSCAD.
pub(super) struct Sectors {
    pub count: usize,
    pub is_whole: bool,
    start: f64,
    angle: f64,
}

impl Sectors {
    /// The sectors of a `rotate_extrude` of contours.
    pub fn of(reader: &Reader, arguments: &Arguments, contours: &Contours) -> Result<Sectors, Refusal> {
        let reach = contours.iter().flatten().fold(0f64, |reach, p| reach.max(p[0].abs()));
        let full = round(reader, Fineness::of(arguments)?.fragments(reach));
        let angle = arguments.number("angle", 360.0)?.clamp(-360.0, 360.0);
        let is_whole = angle.abs() >= 360.0;
        let start = arguments.number("start", if is_whole { 180.0 } else { 0.0 })?;
        let count = ((full as f64 * angle.abs() / 360.0).floor() as usize).max(1);
        Ok(Sectors { count, is_whole, start, angle })
    }

    /// A point of the region at the start of sector `k`.
    pub fn point(&self, k: usize, p: Point) -> Vec3 {
        let (sin, cos) = sin_cos_degrees(self.start + self.angle * k as f64 / self.count as f64);
        Vec3::new(cos * p[0], sin * p[0], p[1])
    }
}
