//! Sine and cosine of angles in degrees, exact at the multiples of 90, and the vertices of circles.

use crate::Vec3;

/// `(sin, cos)` of an angle in degrees, any finite value.
///
/// Exact range reduction to [-45, 45] degrees: quarter turns give exactly 0 and +-1, and adding full turns changes no bit.
/// A NaN or infinite angle gives NaN.
pub fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let turn = degrees % 360.0;
    let quarter = (turn / 90.0).round();
    let (sin, cos) = libm::sincos((turn - 90.0 * quarter).to_radians());
    if !quarter.is_finite() {
        return (f64::NAN, f64::NAN);
    }
    match (quarter as i64).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// The unit vector in the x-y plane at an angle from +x towards +y, in degrees.
pub fn unit_vector_degrees(degrees: f64) -> Vec3 {
    let (sin, cos) = sin_cos_degrees(degrees);
    Vec3::new(cos, sin, 0.0)
}

/// The largest number of vertices of a circle.
pub const MAX_AROUND: usize = 20_000;

/// The number of vertices of a circle whose chords are at most `tolerance` from it, a multiple of 4; `None` above
/// [`MAX_AROUND`]. Facets of different solids have common vertices on a common circle, because all use this number.
pub fn circle_count(radius: f64, tolerance: f64) -> Option<usize> {
    if radius <= tolerance {
        return Some(4);
    }
    // r (1 - cos x) = 2 r sin^2(x / 2) for the half angle x of a chord, without cancellation
    let half_angle = 2.0 * libm::asin(libm::sqrt(0.5 * tolerance / radius));
    let count = 4.0 * libm::ceil(0.25 * std::f64::consts::PI / half_angle).max(2.0);
    (count <= MAX_AROUND as f64).then_some(count as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        for turns in -3i32..=3 {
            let base = 360.0 * f64::from(turns);
            assert_eq!(sin_cos_degrees(base), (0.0, 1.0));
            assert_eq!(sin_cos_degrees(base + 90.0), (1.0, 0.0));
            assert_eq!(sin_cos_degrees(base + 180.0), (0.0, -1.0));
            assert_eq!(sin_cos_degrees(base + 270.0), (-1.0, 0.0));
        }
    }

    /// The count is the smallest multiple of 4 whose chords are within the tolerance.
    #[test]
    fn circles_have_as_few_vertices_as_the_tolerance_allows() {
        let sagitta =
            |radius: f64, count: usize| radius * (1.0 - (std::f64::consts::PI / count as f64).cos());
        for (radius, tolerance) in [(1.0, 0.5), (3.0, 0.1), (50.0, 0.05), (50.0, 1e-4)] {
            let count = circle_count(radius, tolerance).unwrap();
            assert!(
                count.is_multiple_of(4) && sagitta(radius, count) <= tolerance,
                "{radius} {tolerance}: {count}"
            );
            assert!(count == 8 || sagitta(radius, count - 4) > tolerance, "{radius} {tolerance}: {count}");
        }
        assert_eq!((circle_count(1.0, 1.0), circle_count(1.0, 1e-9)), (Some(4), None));
    }

    #[test]
    fn closed_forms() {
        let close = |a: f64, b: f64| assert!((a - b).abs() < 2e-16, "{a} {b}");
        let (sin, cos) = sin_cos_degrees(30.0);
        close(sin, 0.5);
        close(cos, 0.75f64.sqrt());
        let (sin, cos) = sin_cos_degrees(-135.0);
        close(sin, -0.5f64.sqrt());
        close(cos, -0.5f64.sqrt());
        assert!(sin_cos_degrees(f64::INFINITY).0.is_nan());
    }
}
