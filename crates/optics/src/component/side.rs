//! The trait of the two side surfaces of a lens or mirror, and the solid between two sides.

use super::{Aperture, ComponentError};
use rayweave_model::Solid;

/// One side of a lens or mirror: a surface at its position on the axis z, over an aperture.
pub(super) trait Side {
    /// The name of its faces.
    fn name(&self) -> &'static str;
    /// The z of the surface at a point (x, y) of the aperture.
    fn z(&self, point: [f64; 2]) -> f64;
    /// The range of z over the whole aperture.
    fn range(&self) -> [f64; 2];
    /// The solid on the +z side of the surface. It is valid for z from [`Side::floor`] to `until`.
    fn beyond(&self, until: f64) -> Result<Solid, ComponentError>;
    /// The solid on the -z side of the surface. It is valid for z from `from` to [`Side::ceiling`].
    fn before(&self, from: f64) -> Result<Solid, ComponentError>;
    /// The lowest z at which [`Side::beyond`] is used: `wanted`, or a greater z below the surface where the solid is valid.
    fn floor(&self, wanted: f64) -> f64;
    /// The highest z at which [`Side::before`] is used: `wanted`, or a smaller z above the surface where the solid is valid.
    fn ceiling(&self, wanted: f64) -> f64;
}

/// The solid from the front side (lower z) to the back side, inside an aperture centred at `centre`. The leaves are named
/// after the sides; the leaf of the aperture is `edge`.
///
/// # Errors
/// [`ComponentError::SurfacesCross`] if the sides cross; errors of the aperture and of the sides.
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

/// A grid of 33 x 33 points over the square [-1, 1]^2.
pub(super) fn points() -> impl Iterator<Item = [f64; 2]> {
    let step = |k: i32| f64::from(k) / 16.0;
    (-16..=16).flat_map(move |i| (-16..=16).map(move |j| [step(i), step(j)]))
}

/// Rejects surfaces that cross inside the aperture, at any point of the grid [`points`] over it.
fn check_gap(
    part: &'static str,
    [front, back]: [&dyn Side; 2],
    aperture: &Aperture,
    centre: [f64; 2],
) -> Result<(), ComponentError> {
    let [width, height] = aperture.size();
    let inside = points().map(|[u, v]| [0.5 * width * u, 0.5 * height * v]).filter(|&[x, y]| {
        // scaled down slightly, so that points on the rim count as inside
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
