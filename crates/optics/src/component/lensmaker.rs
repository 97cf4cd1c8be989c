//! The lensmaker's equation: focal length of a thick lens.

use super::ComponentError;
use super::error::positive;
use super::face::Profile;

/// The focal length of a thick lens in a uniform medium, in the unit of its radii; infinite for a window or
/// an afocal lens, negative for a diverging lens.
///
/// `1/f = (n - 1) (1/r1 - 1/r2 + (n - 1) d / (n r1 r2))`, with n the index of the lens divided by
/// that of the medium, the thickness d on the axis and radii that are positive if the centre of
/// curvature is on the side where light leaves (E. Hecht, *Optics*, section 6.1, thick lenses).
/// With d = 0, which is allowed here, it reduces to the equation of thin lenses.
///
/// # Errors
/// A radius that is 0 or NaN, an index that is not positive, a thickness that is negative or not finite.
///
/// ```
/// use rayweave_optics::component::lensmaker;
///
/// assert_eq!(lensmaker(50.0, -50.0, 1.5, 0.0)?, 50.0);
/// # Ok::<(), rayweave_optics::component::ComponentError>(())
/// ```
pub fn lensmaker(r1: f64, r2: f64, n: f64, thickness: f64) -> Result<f64, ComponentError> {
    let part = "lensmaker's equation";
    Profile::sphere(r1).checked(part, "r1")?;
    Profile::sphere(r2).checked(part, "r2")?;
    positive(part, "n", n)?;
    if !(0.0..f64::INFINITY).contains(&thickness) {
        let parameter = "thickness".to_owned();
        return Err(ComponentError::Negative { part, parameter, value: thickness });
    }
    let (c1, c2, step) = (1.0 / r1, 1.0 / r2, n - 1.0);
    let power = step * (c1 - c2 + step * thickness * c1 * c2 / n);
    // the sign of a zero has no meaning
    Ok(if power == 0.0 { f64::INFINITY } else { 1.0 / power })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In the limit of zero thickness the powers of both surfaces add: 1/f = (n - 1) (1/r1 - 1/r2) (Newton).
    #[test]
    fn thin_lenses() {
        for (r1, r2, n) in [(50.0, -80.0, 1.5168), (-20.0, 35.0, 1.7), (30.0, f64::INFINITY, 1.33)] {
            let thin = 1.0 / ((n - 1.0) * (1.0 / r1 - 1.0 / r2));
            for thickness in [0.0, 1e-3, 1e-6] {
                let found = lensmaker(r1, r2, n, thickness).unwrap();
                assert!((found / thin - 1.0).abs() <= thickness * 0.02 + 1e-15, "{found} {thin}");
            }
        }
    }

    /// A ball: f = n D / (4 (n - 1)) from its centre (Hecht, exercise on spherical lenses).
    #[test]
    fn a_ball() {
        let (n, radius) = (1.5168, 4.0);
        let found = lensmaker(radius, -radius, n, 2.0 * radius).unwrap();
        assert!((found - n * 2.0 * radius / (4.0 * (n - 1.0))).abs() < 1e-14);
    }

    /// Plane surfaces have no power, and in a telescope made of one piece of glass the foci of both
    /// surfaces coincide: d = n (r1 - r2) / (n - 1).
    #[test]
    fn no_power() {
        assert_eq!(lensmaker(f64::INFINITY, f64::NEG_INFINITY, 1.5, 3.0).unwrap(), f64::INFINITY);
        assert_eq!(lensmaker(4.0, -2.0, 1.5, 18.0).unwrap(), f64::INFINITY);
        assert_eq!(lensmaker(10.0, -5.0, 1.0, 2.0).unwrap(), f64::INFINITY);
    }

    #[test]
    fn refusals() {
        let message = |r1, n, d| lensmaker(r1, 1.0, n, d).unwrap_err().to_string();
        assert_eq!(
            message(0.0, 1.5, 1.0),
            "r1 of the lensmaker's equation is 0: a radius of curvature is a number other than 0. Use inf for a plane."
        );
        assert!(message(f64::NAN, 1.5, 1.0).starts_with("r1 of the lensmaker's equation is NaN"));
        assert!(message(1.0, -1.5, 1.0).contains("equation is -1.5"));
        assert_eq!(
            message(1.0, 1.5, -1.0),
            "thickness of the lensmaker's equation is -1: it must be finite and at least 0. Did you mean 1?"
        );
        assert!(message(1.0, 1.5, f64::NAN).ends_with("is NaN: it must be finite and at least 0."));
    }
}
