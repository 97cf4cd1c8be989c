//! Apertures: the outline of a component perpendicular to the optical axis.

use super::ComponentError;
use super::error::{finite, positive};
use rayweave_math::Vec3;
use rayweave_model::Solid;
use rayweave_shape::primitive::{BoxFromCorners, Cylinder, Primitive};

/// The outline of a component perpendicular to the optical axis, by its full sizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aperture {
    /// A circle about the axis.
    Circle {
        /// Its diameter.
        diameter: f64,
    },
    /// A rectangle about the axis.
    Rectangle {
        /// Its extent along x.
        width: f64,
        /// Its extent along y.
        height: f64,
    },
    /// An ellipse about the axis.
    Ellipse {
        /// Its extent along x.
        width: f64,
        /// Its extent along y.
        height: f64,
    },
}

impl Aperture {
    /// A circle with the given diameter.
    pub fn circle(diameter: f64) -> Aperture {
        Aperture::Circle { diameter }
    }

    /// A rectangle with the given extents along x and y.
    pub fn rectangle(width: f64, height: f64) -> Aperture {
        Aperture::Rectangle { width, height }
    }

    /// An ellipse with the given extents along x and y.
    pub fn ellipse(width: f64, height: f64) -> Aperture {
        Aperture::Ellipse { width, height }
    }

    /// The extents along x and y.
    pub fn size(&self) -> [f64; 2] {
        match *self {
            Aperture::Circle { diameter } => [diameter, diameter],
            Aperture::Rectangle { width, height } | Aperture::Ellipse { width, height } => [width, height],
        }
    }

    /// The area.
    pub fn area(&self) -> f64 {
        let [width, height] = self.size();
        match self {
            Aperture::Rectangle { .. } => width * height,
            _ => std::f64::consts::FRAC_PI_4 * width * height,
        }
    }

    /// The distance from the axis to the farthest point of the aperture centred at (x, y); for an
    /// off-axis ellipse, an upper bound.
    pub fn reach(&self, [x, y]: [f64; 2]) -> f64 {
        let [width, height] = self.size();
        match self {
            Aperture::Rectangle { .. } => libm::hypot(x.abs() + 0.5 * width, y.abs() + 0.5 * height),
            _ => libm::hypot(x, y) + 0.5 * width.max(height),
        }
    }

    /// True if a point of the plane lies inside.
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        let [u, v] = [2.0 * x / self.size()[0], 2.0 * y / self.size()[1]];
        match self {
            Aperture::Rectangle { .. } => u.abs() < 1.0 && v.abs() < 1.0,
            _ => u * u + v * v < 1.0,
        }
    }

    /// The aperture, if its sizes are finite and greater than 0.
    ///
    /// # Errors
    /// [`ComponentError::NotPositive`] for the size at fault.
    pub fn checked(self) -> Result<Aperture, ComponentError> {
        match self {
            Aperture::Circle { diameter } => {
                positive("aperture", "diameter", diameter)?;
            }
            Aperture::Rectangle { width, height } | Aperture::Ellipse { width, height } => {
                positive("aperture", "width", width)?;
                positive("aperture", "height", height)?;
            }
        }
        Ok(self)
    }

    /// The column of points inside the aperture and between two heights along z.
    ///
    /// # Errors
    /// Sizes that are not positive, an offset or heights that are not finite or not increasing.
    pub fn column(&self, [x, y]: [f64; 2], [low, high]: [f64; 2]) -> Result<Solid, ComponentError> {
        let [width, height] = self.checked()?.size();
        finite("aperture", "offset x", x)?;
        finite("aperture", "offset y", y)?;
        if let Aperture::Rectangle { .. } = self {
            let lo = Vec3::new(x - 0.5 * width, y - 0.5 * height, low);
            let hi = Vec3::new(x + 0.5 * width, y + 0.5 * height, high);
            return Ok(solid(BoxFromCorners::new(lo, hi)?));
        }
        let pillar = solid(Cylinder::new(0.5 * width, high - low)?);
        let round = if width == height { pillar } else { pillar.scale([1.0, height / width, 1.0]) };
        Ok(round.translate([x, y, 0.5 * (low + high)]))
    }
}

/// A primitive as a solid.
pub(super) fn solid(primitive: impl Into<Primitive>) -> Solid {
    Solid::from(primitive.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_and_reaches() {
        let plate = Aperture::rectangle(6.0, 8.0);
        assert_eq!((plate.area(), plate.reach([0.0, 0.0]), plate.reach([-2.0, 8.0])), (48.0, 5.0, 13.0));
        let disc = Aperture::circle(2.0);
        assert_eq!((disc.area(), disc.reach([3.0, -4.0])), (std::f64::consts::PI, 6.0));
        assert_eq!(Aperture::ellipse(2.0, 4.0).reach([0.0, 0.0]), 2.0);
    }

    #[test]
    fn points_inside() {
        assert!(Aperture::rectangle(2.0, 4.0).contains([0.9, -1.9]));
        assert!(!Aperture::ellipse(2.0, 4.0).contains([0.9, -1.9]));
        assert!(
            Aperture::ellipse(2.0, 4.0).contains([0.0, 1.9]) && !Aperture::circle(2.0).contains([0.0, 1.9])
        );
    }

    #[test]
    fn refusals_name_the_size() {
        let message = |aperture: Aperture| aperture.checked().unwrap_err().to_string();
        assert_eq!(
            message(Aperture::circle(-2.0)),
            "diameter of the aperture is -2: it must be finite and greater than 0. Did you mean 2?"
        );
        assert_eq!(
            message(Aperture::rectangle(1.0, f64::NAN)),
            "height of the aperture is NaN: it must be finite and greater than 0."
        );
        assert!(Aperture::ellipse(f64::INFINITY, 1.0).column([0.0; 2], [0.0, 1.0]).is_err());
        assert!(Aperture::circle(1.0).column([f64::NAN, 0.0], [0.0, 1.0]).is_err());
    }
}
