//! When a point is *on* a surface and a ray *in* one: `delta` and `hugs`, for the whole project.

use super::Surface;
use crate::Ray;
use rayweave_math::{UNIT_ROUNDOFF, Vec3};

/// The fixed direction into which a ray that lies in a surface is moved in thought: `w_k = g^(1-k)` with g
/// the real root > 1 of `g^3 = g + 1`, which no plane of a man-made model is likely to contain.
pub const LIE_DIRECTION: Vec3 = Vec3::new(1.0, 0.754_877_666_246_692_7, 0.569_840_290_998_053_2);

/// The distance within which a computed point at time `t` of a ray cannot be told from a surface.
///
/// `64 u (|o| + |t| |d| + reach)`: the rounding of a point of the ray is bounded by `3 u (|o| + |t| |d|)`,
/// that of the surface's own numbers by a few u times `reach`, which counts every translation composed on
/// its way; 64 leaves room for the dozen roundings of a kernel.
pub fn delta(reach: f64, ray: &Ray, t: f64) -> f64 {
    64.0 * UNIT_ROUNDOFF * (ray.origin.length() + t.abs() * ray.direction.length() + reach)
}

/// True if the piece of the ray between `a` and `b` lies within `delta` of the surface: `|f| <= delta |grad f|`
/// at both ends, the middle and, for degree 4, the quarter points. (The middle alone would weld the two
/// crossings of a ray through two tangent spheres.)
pub fn hugs(surface: &Surface, reach: f64, ray: &Ray, a: f64, b: f64) -> bool {
    let near = |t: f64| {
        let (value, gradient) = surface.value_and_gradient(ray.at(t));
        value.abs() <= delta(reach, ray, t) * gradient.length()
    };
    let middle = 0.5 * (a + b);
    near(middle)
        && near(a)
        && near(b)
        && (surface.degree() < 4 || (near(0.5 * (a + middle)) && near(0.5 * (middle + b))))
}

/// The side of a ray that lies in the surface all along `chord`: `Some(inside)`, or `None` if it does not lie in it.
///
/// Such a ray is answered as if moved infinitesimally along [`LIE_DIRECTION`]: by the sign of `w . grad f` in
/// the middle of the chord or, where that is 0, of the first component of grad f that is not.
pub fn lies_in(surface: &Surface, reach: f64, ray: &Ray, chord: (f64, f64)) -> Option<bool> {
    if !surface.is_ruled() || !hugs(surface, reach, ray, chord.0, chord.1) {
        return None;
    }
    let (_, gradient) = surface.value_and_gradient(ray.at(0.5 * (chord.0 + chord.1)));
    Some(side_along_gradient(gradient))
}

/// True (inside) if moving along [`LIE_DIRECTION`] makes f negative.
pub(crate) fn side_along_gradient(gradient: Vec3) -> bool {
    let slope = LIE_DIRECTION.dot(gradient);
    let sign = if slope != 0.0 {
        slope
    } else {
        gradient
            .to_array()
            .into_iter()
            .find(|&g| g != 0.0)
            .unwrap_or(0.0)
    };
    sign < 0.0
}
