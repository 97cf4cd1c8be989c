//! Law of reflection and Snell's law of refraction for direction vectors.

use rayweave_math::Vec3;

/// The direction after reflection in a plane with the unit normal `n`: `d - 2 (d.n) n`.
pub fn reflect(d: Vec3, n: Vec3) -> Vec3 {
    unit(d - 2.0 * d.dot(n) * n)
}

/// The direction after refraction, `None` for total internal reflection.
///
/// `d` and `n` are unit vectors, `n` against the light; `ratio` is the index before divided by the
/// index behind. Snell's law in vectors: `ratio d + (ratio c - sqrt(1 - ratio^2 (1 - c^2))) n` with
/// `c = -d.n` (Born & Wolf, *Principles of Optics*, 7th edition, section 3.2.2).
pub fn refract(d: Vec3, n: Vec3, ratio: f64) -> Option<Vec3> {
    let c = -d.dot(n);
    let squared = 1.0 - ratio * ratio * (1.0 - c * c);
    (squared > 0.0).then(|| unit(ratio * d + (ratio * c - squared.sqrt()) * n))
}

/// A direction normalised to unit length, so that rounding does not add up over many interfaces.
pub(super) fn unit(d: Vec3) -> Vec3 {
    d / d.length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn snell() {
        for degrees in [0.0_f64, 1e-6, 20.0, 60.0, 89.0] {
            let theta = degrees.to_radians();
            let d = Vec3::new(theta.sin(), 0.0, theta.cos());
            let found = refract(d, -Vec3::Z, 1.0 / 1.5).unwrap();
            assert!((found.x - theta.sin() / 1.5).abs() < 1e-15 && found.z > 0.0);
            assert!((found.length() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn total_internal_reflection_begins_at_the_critical_angle() {
        let critical = (1.0_f64 / 1.5).asin();
        let at = |theta: f64| refract(Vec3::new(theta.sin(), 0.0, theta.cos()), -Vec3::Z, 1.5);
        assert!(at(critical - 1e-9).is_some() && at(critical + 1e-9).is_none());
    }

    #[test]
    fn mirrors_keep_the_angle() {
        let d = Vec3::new(0.6, 0.0, 0.8);
        assert_eq!(reflect(d, -Vec3::Z), Vec3::new(0.6, 0.0, -0.8));
    }
}
