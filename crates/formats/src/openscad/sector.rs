//! Sectors of revolutions, and the number of facets of circles.

use super::arguments::{Arguments, Refusal};
use super::drawing::chords;
use super::facets::Fineness;
use super::flat::Flat;
use super::region::{Contours, boundary, faceted_boundary};
use super::state::Reader;
use rayweave_math::{Vec3, sin_cos_degrees};
use rayweave_polygon::Point;

/// Number of facets of a circle of an item; exact circles get fine facets.
pub(super) fn round(reader: &Reader, arguments: &Arguments, radius: f64) -> Result<usize, Refusal> {
    let fragments = Fineness::of(arguments)?.fragments(radius);
    if reader.is_faceted(arguments) {
        return Ok(fragments);
    }
    reader.flats.has_chords.set(true);
    Ok(fragments.max(chords(360.0)))
}

/// The boundary of the profile of a `rotate_extrude`.
pub(super) fn profile(reader: &Reader, arguments: &Arguments, flat: Flat) -> Result<Contours, Refusal> {
    match reader.is_faceted(arguments) {
        true => faceted_boundary(arguments, &reader.flats, flat),
        false => boundary(arguments, &reader.flats, flat),
    }
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
        let full = round(reader, arguments, reach)?;
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
