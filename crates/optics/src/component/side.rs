//! The two sides of a lens or mirror, of any form, and the solid between them.

use super::{Aperture, ComponentError};
use rayweave_model::Solid;

/// A surface at its position, as one side of a lens or mirror.
pub(super) trait Side {
    /// The name of its faces.
    fn name(&self) -> &'static str;
    /// Its z over a point of the aperture.
    fn z(&self, point: [f64; 2]) -> f64;
    /// The range of z over the whole aperture.
    fn range(&self) -> [f64; 2];
    /// The points on the side of +z, exact where z < `until` and above [`Side::floor`].
    fn beyond(&self, until: f64) -> Result<Solid, ComponentError>;
    /// The points on the side of -z, exact where z > `from` and below [`Side::ceiling`].
    fn before(&self, from: f64) -> Result<Solid, ComponentError>;
    /// The lower end of a column in which [`Side::beyond`] is exact, close to `wanted`.
    fn floor(&self, wanted: f64) -> f64;
    /// The upper end of a column in which [`Side::before`] is exact.
    fn ceiling(&self, wanted: f64) -> f64;
}

/// The solid between two sides inside an aperture about a centre; its leaves have the names of the sides, and `edge`.
pub(super) fn between_sides(
    part: &'static str,
    [front, back]: [&dyn Side; 2],
    aperture: &Aperture,
    centre: [f64; 2],
) -> Result<Solid, ComponentError> {
    check_gap(part, [front, back], aperture, centre)?;
    let [width, height] = aperture.size();
    let (low, high) = (front.range()[0], back.range()[1]);
    let margin = 0.25 * (high - low).max(width.min(height));
    let ends = [front.floor(low - margin), back.ceiling(high + margin)];
    let edge = aperture.column(centre, ends)?.named("edge");
    Ok(Solid::intersection([front.beyond(ends[1])?, back.before(ends[0])?, edge]))
}

/// Points of a rectangle, 33 x 33, from -1 to 1.
pub(super) fn points() -> impl Iterator<Item = [f64; 2]> {
    let step = |k: i32| f64::from(k) / 16.0;
    (-16..=16).flat_map(move |i| (-16..=16).map(move |j| [step(i), step(j)]))
}

/// Checks that the surfaces do not cross at any sample point inside the aperture.
fn check_gap(
    part: &'static str,
    [front, back]: [&dyn Side; 2],
    aperture: &Aperture,
    centre: [f64; 2],
) -> Result<(), ComponentError> {
    let [width, height] = aperture.size();
    let inside = points().map(|[u, v]| [0.5 * width * u, 0.5 * height * v]).filter(|&[x, y]| {
        // include the rim
        aperture.contains([x * (1.0 - 1e-9), y * (1.0 - 1e-9)])
    });
    let places = inside.map(|[x, y]| [centre[0] + x, centre[1] + y]);
    let crossing = places.filter(|&point| back.z(point) < front.z(point));
    match crossing.map(|[x, y]| libm::hypot(x, y)).min_by(f64::total_cmp) {
        None => Ok(()),
        Some(height) => Err(ComponentError::SurfacesCross {
            part,
            first: front.name().to_owned(),
            second: back.name().to_owned(),
            height,
            reach: aperture.reach(centre),
        }),
    }
}
