//! Diffraction gratings: the grating equation for direction vectors.

use super::snell::unit;
use rayweave_math::Vec3;

/// The direction of an order of a plane diffraction grating, `None` if the order is evanescent.
///
/// The component of the wave vector along the plane grows by `order` times `lines` (a vector across
/// the grooves, in the plane, as long as their number per unit of length); the component
/// perpendicular to the plane follows from its length. For angles in the plane across the grooves
/// this is the grating equation `n2 sin(b) = n1 sin(a) + m wavelength / d` (Born & Wolf,
/// *Principles of Optics*, 7th edition, section 8.6.1; Spencer & Murty, J. Opt. Soc. Am. 52, 672,
/// 1962). `wavelength` is the vacuum wavelength in the unit of length; the light leaves to the side
/// of `side`, a normal of the plane.
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
    fn gratings() {
        // 600 lines per millimetre, 500 nm, normal incidence: sin = 0.3 m
        let lines = 600.0 * Vec3::X;
        for m in -3..=3 {
            let found = diffract(Vec3::Z, Vec3::Z, [1.0, 1.0], lines, m, 500e-6).unwrap();
            assert!((found.x - 0.3 * f64::from(m)).abs() < 1e-15 && found.z > 0.0);
        }
        assert_eq!(diffract(Vec3::Z, Vec3::Z, [1.0, 1.0], lines, 4, 500e-6), None);
        // Littrow configuration: sin = m wavelength / 2 d, and the light is retroreflected
        let back = Vec3::new(-0.15, 0.0, (1.0_f64 - 0.0225).sqrt());
        let found = diffract(back, -Vec3::Z, [1.0, 1.0], lines, 1, 500e-6).unwrap();
        assert!((found + back).length() < 1e-15);
    }
}
