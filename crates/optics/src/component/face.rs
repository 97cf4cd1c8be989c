//! Optical surfaces of revolution (conics, aspheres): sag, and the half-space behind them.

use super::ComponentError;
use super::aperture::solid;
use rayweave_math::Vec3;
use rayweave_model::Solid;
use rayweave_shape::primitive::{self, Cylinder, HalfSpace, Quadric, Sphere};

/// The sag of a conic of revolution, its height above the vertex plane at a distance `height` from the axis:
///
/// `z = c h^2 / (1 + sqrt(1 - (1 + k) c^2 h^2))`, with the curvature c = 1 / `radius` and the conic
/// constant k.
///
/// k < -1 is a hyperboloid, -1 a paraboloid, between -1 and 0 an ellipsoid about its long axis, 0 a
/// sphere, above 0 an ellipsoid about its short axis (ISO 10110-12). An infinite radius is a plane.
/// `None` beyond the end of the surface.
pub fn sag(radius: f64, conic: f64, height: f64) -> Option<f64> {
    Profile::conic(radius, conic).sag(height)
}

/// An aspheric surface of revolution: a conic (see [`sag`]) and terms in powers of the distance
/// from the axis.
///
/// ```
/// use rayweave_optics::component::Asphere;
///
/// // half a unit of curvature by the radius, half by the term in r^2
/// let paraboloid = Asphere { even: [0.25, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], ..Asphere::conic(2.0, -1.0) };
/// assert_eq!(paraboloid.sag(1.0), Some(0.5));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asphere {
    /// The radius of curvature of the conic, infinite for none.
    pub radius: f64,
    /// The conic constant.
    pub conic: f64,
    /// The coefficients of r^2, r^4, ..., r^16 in the unit of lengths to the power -1, -3, ...,
    /// -15. That of r^2 adds to the curvature.
    pub even: [f64; 8],
    /// The coefficients of r, r^3, ..., r^15 in the unit of lengths to the power 0, -2, ..., -14.
    /// The coefficient of r makes a cone around the vertex, an axicon. None of them contributes to
    /// first-order data.
    pub odd: [f64; 8],
}

impl Asphere {
    /// A conic without terms.
    pub const fn conic(radius: f64, conic: f64) -> Asphere {
        Asphere { radius, conic, even: [0.0; 8], odd: [0.0; 8] }
    }

    /// True if it has terms beyond the conic.
    pub fn has_terms(&self) -> bool {
        self.even != [0.0; 8] || self.odd != [0.0; 8]
    }

    /// The sag at a distance `height` from the axis; `None` beyond the end of the conic.
    pub fn sag(&self, height: f64) -> Option<f64> {
        Profile::asphere(self).sag(height)
    }
}

/// The profile of a surface with its vertex at the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Profile {
    /// The radius of curvature at the vertex, positive if its centre lies on the side of +z.
    pub radius: f64,
    /// The conic constant.
    pub conic: f64,
    /// True if it is curved along x only.
    pub cylindrical: bool,
    /// The coefficients of r^2, r^4, ...
    pub even: [f64; 8],
    /// The coefficients of r, r^3, ...
    pub odd: [f64; 8],
    /// The distance from the axis up to which a surface with terms is exact; without meaning for others.
    pub domain: f64,
}

impl Profile {
    pub const PLANE: Profile = Profile {
        radius: f64::INFINITY,
        conic: 0.0,
        cylindrical: false,
        even: [0.0; 8],
        odd: [0.0; 8],
        domain: 0.0,
    };

    pub fn sphere(radius: f64) -> Profile {
        Profile::conic(radius, 0.0)
    }

    pub fn conic(radius: f64, conic: f64) -> Profile {
        Profile { radius, conic, ..Profile::PLANE }
    }

    pub fn asphere(of: &Asphere) -> Profile {
        Profile { even: of.even, odd: of.odd, ..Profile::conic(of.radius, of.conic) }
    }

    /// The profile, exact up to a distance from the axis and a little beyond, so that its end lies outside.
    pub fn over(self, reach: f64) -> Profile {
        Profile { domain: (1.001 * reach).min(self.limit()), ..self }
    }

    pub fn cylinder(radius: f64) -> Profile {
        Profile { radius, cylindrical: true, ..Profile::PLANE }
    }

    pub fn is_plane(&self) -> bool {
        self.radius.is_infinite() && !self.has_terms()
    }

    pub fn has_terms(&self) -> bool {
        self.even != [0.0; 8] || self.odd != [0.0; 8]
    }

    /// The profile seen from the other side.
    pub fn reversed(self) -> Profile {
        let [even, odd] = [self.even, self.odd].map(|terms| terms.map(|c| -c));
        Profile { radius: -self.radius, even, odd, ..self }
    }

    /// The distance from the axis at which the surface ends: its slope is vertical there.
    pub fn limit(&self) -> f64 {
        let turn = 1.0 + self.conic;
        if self.radius.is_infinite() || turn <= 0.0 { f64::INFINITY } else { self.radius.abs() / turn.sqrt() }
    }

    pub fn sag(&self, height: f64) -> Option<f64> {
        let ratio = height / self.radius;
        let under_root = 1.0 - (1.0 + self.conic) * ratio * ratio;
        // at the limit rounding may leave a negative value
        let at_limit = height <= self.limit();
        let square = height * height;
        let even = self.even.iter().rev().fold(0.0, |sum, c| (sum + c) * square);
        let odd = self.odd.iter().rev().fold(0.0, |sum, c| sum * square + c);
        let terms = even + height.abs() * odd;
        (under_root >= 0.0 || at_limit).then(|| height * ratio / (1.0 + under_root.max(0.0).sqrt()) + terms)
    }

    /// The height of the plane that separates the sheet with the vertex from the other sheet of the
    /// quadric: through the centre of an ellipsoid, between the sheets of a hyperboloid, infinite
    /// for the others.
    fn divide(&self) -> f64 {
        if self.has_terms() { f64::INFINITY } else { self.radius / (1.0 + self.conic) }
    }

    /// The points with f < 0, where f is the quadric with the sign that makes them lie on the side
    /// of +z near the vertex: `f = c (x^2 + y^2) + c (1 + k) z^2 - 2 z`.
    fn inside(&self, vertex: f64, name: &str) -> Result<Solid, ComponentError> {
        if self.is_plane() {
            return Ok(solid(HalfSpace::new(-Vec3::Z, -vertex)?).named(name));
        }
        if self.has_terms() {
            let forms = [1.0 / self.radius, self.conic];
            let terms: [&[f64]; 2] = [&self.even, &self.odd];
            let above = solid(primitive::Asphere::new(self.domain, forms, terms, f64::INFINITY)?);
            return Ok(above.translate([0.0, 0.0, vertex]).named(name));
        }
        if self.conic != 0.0 {
            return Ok(self.quadric()?.translate([0.0, 0.0, vertex]).named(name));
        }
        let round = match self.cylindrical {
            true => solid(Cylinder::new(self.radius.abs(), f64::INFINITY)?).rotate_x(90.0),
            false => solid(Sphere::new(self.radius.abs())?),
        };
        let round = round.translate([0.0, 0.0, vertex + self.radius]).named(name);
        Ok(if self.radius > 0.0 { round } else { !round })
    }

    /// The quadric multiplied by |radius|, so that no coefficient is tiny.
    fn quadric(&self) -> Result<Solid, ComponentError> {
        let (sign, size) = (self.radius.signum(), self.radius.abs());
        let mut matrix = [[0.0; 4]; 4];
        (matrix[0][0], matrix[1][1], matrix[2][2]) = (sign, sign, sign * (1.0 + self.conic));
        (matrix[2][3], matrix[3][2]) = (-size, -size);
        Ok(solid(Quadric::new(matrix)?))
    }

    /// The profile, if its radius of curvature, conic constant and coefficients are valid.
    pub fn checked(
        self,
        part: &'static str,
        parameter: impl Into<String>,
    ) -> Result<Profile, ComponentError> {
        let parameter = parameter.into();
        if self.radius == 0.0 || self.radius.is_nan() {
            return Err(ComponentError::Radius { part, parameter, value: self.radius });
        }
        let parameter = format!("the conic constant of {parameter}");
        super::error::finite(part, parameter, self.conic)?;
        for (k, &c) in self.even.iter().enumerate() {
            super::error::finite(part, format!("the coefficient of r^{}", 2 * k + 2), c)?;
            super::error::finite(part, format!("the coefficient of r^{}", 2 * k + 1), self.odd[k])?;
        }
        Ok(self)
    }
}

/// A surface at its position on the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Face {
    pub name: &'static str,
    pub vertex: f64,
    pub profile: Profile,
}

impl Face {
    /// Its z at a distance `height` from the axis.
    pub fn z(&self, height: f64) -> Option<f64> {
        self.profile.sag(height).map(|sag| self.vertex + sag)
    }

    /// The surface, exact up to a distance from the axis.
    pub fn over(self, reach: f64) -> Face {
        Face { profile: self.profile.over(reach), ..self }
    }

    /// The range of z up to `reach` from the axis: the sag of a conic is monotonic, any other is
    /// sampled in steps.
    pub fn range(&self, reach: f64) -> [f64; 2] {
        if self.profile.has_terms() {
            let heights = steps(reach).filter_map(|height| self.z(height));
            return heights.fold([self.vertex; 2], |[low, high], z| [low.min(z), high.max(z)]);
        }
        let rim = self.z(reach).unwrap_or(self.vertex);
        [self.vertex.min(rim), self.vertex.max(rim)]
    }

    fn divide(&self) -> f64 {
        self.vertex + self.profile.divide()
    }

    /// The points on the side of +z, exact where z < `until`; for a concave surface only above
    /// [`Face::floor`].
    pub fn beyond(&self, until: f64) -> Result<Solid, ComponentError> {
        let inside = self.profile.inside(self.vertex, self.name)?;
        if self.profile.is_plane() || self.profile.divide() < 0.0 || until <= self.divide() {
            return Ok(inside);
        }
        // the far half of the quadric is not part of the surface: all points behind its centre are
        // behind the surface
        Ok(inside | solid(HalfSpace::new(-Vec3::Z, -self.divide())?).named(self.name))
    }

    /// The points on the side of -z, exact where z > `from`; for a convex surface only below
    /// [`Face::ceiling`].
    pub fn before(&self, from: f64) -> Result<Solid, ComponentError> {
        if self.profile.is_plane() {
            return Ok(solid(HalfSpace::new(Vec3::Z, self.vertex)?).named(self.name));
        }
        let outside = !self.profile.inside(self.vertex, self.name)?;
        if self.profile.divide() > 0.0 || from >= self.divide() {
            return Ok(outside);
        }
        Ok(outside | solid(HalfSpace::new(Vec3::Z, self.divide())?).named(self.name))
    }

    /// A height below `low`, where a component begins, and above the other half of the quadric,
    /// which is not part of the surface.
    pub fn floor(&self, low: f64, margin: f64) -> f64 {
        let divide = self.divide();
        if divide <= low && !self.profile.is_plane() {
            return (low - margin).max(0.5 * (low + divide));
        }
        low - margin
    }

    /// A height above `high`, where a component ends, and below the other half of the quadric.
    pub fn ceiling(&self, high: f64, margin: f64) -> f64 {
        let divide = self.divide();
        if divide >= high && !self.profile.is_plane() {
            return (high + margin).min(0.5 * (high + divide));
        }
        high + margin
    }
}

/// Distances from the axis from 0 to `reach`, in 64 steps.
pub(super) fn steps(reach: f64) -> impl Iterator<Item = f64> {
    (0..=64).map(move |k| reach * f64::from(k) / 64.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sags_of_known_curves() {
        let close =
            |found: Option<f64>, exact: f64| assert!((found.unwrap() - exact).abs() < 1e-15, "{found:?}");
        close(sag(5.0, 0.0, 3.0), 1.0);
        close(sag(-5.0, 0.0, 4.0), -2.0);
        close(sag(2.0, -1.0, 2.0), 1.0);
        close(sag(f64::INFINITY, 0.0, 7.0), 0.0);
        close(sag(1.0, 0.0, 1.0), 1.0);
        // hyperbola z^2 + 2 z = h^2: k = -2, R = 1
        close(sag(1.0, -2.0, 3f64.sqrt()), 1.0);
        assert_eq!(sag(1.0, 0.0, 1.1), None);
        // an ellipsoid with half axes 3 along z and 2 across: R = 4/3, k = -5/9
        close(sag(4.0 / 3.0, -5.0 / 9.0, 2.0), 3.0);
    }
}
