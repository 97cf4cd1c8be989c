//! Sine and cosine of angles in degrees, exact at the multiples of 90.

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
