//! Where light goes at an interface.

use rayweave_math::Vec3;

/// The direction after reflection in a plane with the unit normal `n`: `d - 2 (d.n) n`.
pub fn reflect(d: Vec3, n: Vec3) -> Vec3 {
    unit(d - 2.0 * d.dot(n) * n)
}

/// The direction after refraction, `None` for total reflection.
///
/// `d` and `n` are unit vectors, `n` against the light; `ratio` is the index before over that behind. Snell's law in
/// vectors: `ratio d + (ratio c - sqrt(1 - ratio^2 (1 - c^2))) n` with `c = -d.n` (Born & Wolf, *Principles of Optics*,
/// 7th edition, section 3.2.2).
pub fn refract(d: Vec3, n: Vec3, ratio: f64) -> Option<Vec3> {
    let c = -d.dot(n);
    let squared = 1.0 - ratio * ratio * (1.0 - c * c);
    (squared > 0.0).then(|| unit(ratio * d + (ratio * c - squared.sqrt()) * n))
}

/// Keeps rounding from adding up over many interfaces.
fn unit(d: Vec3) -> Vec3 {
    d / d.length()
}

/// The direction after a plane grating, `None` if the order is evanescent.
///
/// The part of the wave vector along the plane grows by `order` times `lines` (a vector across the grooves, in the plane, as
/// long as their number per unit of length), the rest follows from its length: for the angles in the plane across the
/// grooves that is `n2 sin(b) = n1 sin(a) + m wavelength / d` (Born & Wolf, section 8.6.1; Spencer & Murty, J. Opt. Soc. Am.
/// 52, 672, 1962). `wavelength` is that of vacuum in the unit of length; the light goes on to the side of `side`, a normal of
/// the plane.
pub fn diffract(
    d: Vec3,
    side: Vec3,
    [before, behind]: [f64; 2],
    lines: Vec3,
    order: i32,
    wavelength: f64,
) -> Option<Vec3> {
    let along = before * (d - d.dot(side) * side) + f64::from(order) * wavelength * lines;
    let squared = behind * behind - along.length_squared();
    (squared > 0.0).then(|| unit(along + squared.sqrt() * side))
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
    fn total_reflection_begins_at_the_critical_angle() {
        let critical = (1.0_f64 / 1.5).asin();
        let at = |theta: f64| refract(Vec3::new(theta.sin(), 0.0, theta.cos()), -Vec3::Z, 1.5);
        assert!(at(critical - 1e-9).is_some() && at(critical + 1e-9).is_none());
    }

    #[test]
    fn mirrors_keep_the_angle() {
        let d = Vec3::new(0.6, 0.0, 0.8);
        assert_eq!(reflect(d, -Vec3::Z), Vec3::new(0.6, 0.0, -0.8));
    }

    #[test]
    fn gratings() {
        // 600 lines a millimetre, 500 nm, normal incidence: sin = 0.3 m
        let lines = 600.0 * Vec3::X;
        for m in -3..=3 {
            let found = diffract(Vec3::Z, Vec3::Z, [1.0, 1.0], lines, m, 500e-6).unwrap();
            assert!((found.x - 0.3 * f64::from(m)).abs() < 1e-15 && found.z > 0.0);
        }
        assert_eq!(diffract(Vec3::Z, Vec3::Z, [1.0, 1.0], lines, 4, 500e-6), None);
        // Littrow: sin = m wavelength / 2 d, and the light comes back
        let back = Vec3::new(-0.15, 0.0, (1.0_f64 - 0.0225).sqrt());
        let found = diffract(back, -Vec3::Z, [1.0, 1.0], lines, 1, 500e-6).unwrap();
        assert!((found + back).length() < 1e-15);
    }
}
