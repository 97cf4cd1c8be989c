//! Polarisation: Stokes parameters, and Mueller matrices of diagonal Jones matrices.
//!
//! The Stokes parameters refer to an axis perpendicular to the ray. `i` is the power; `q > 0` is
//! light polarised along the axis, `q < 0` perpendicular to it; `u > 0` at +45 degrees, from the
//! axis towards `direction x axis`; `v` is circular. |(q, u, v)| <= i (Born & Wolf, *Principles of
//! Optics*, 7th edition, section 1.4.2; Chipman, Lam, Young, *Polarized Light and Optical Systems*,
//! chapters 3 and 6).

use num_complex::Complex64;
use rayweave_math::Vec3;

/// The polarisation of a ray as Stokes parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stokes {
    /// The Stokes parameters: the power and its polarised parts i, q, u, v.
    pub parameters: [f64; 4],
    /// The axis of q > 0: a unit vector perpendicular to the ray.
    pub axis: Vec3,
}

impl Stokes {
    /// Unpolarised light along a direction.
    pub fn unpolarised(power: f64, direction: Vec3) -> Stokes {
        Stokes { parameters: [power, 0.0, 0.0, 0.0], axis: direction.any_orthonormal_vector() }
    }

    /// Linearly polarised light in the plane of the direction and an axis; `None` if they are parallel.
    pub fn linear(power: f64, direction: Vec3, axis: Vec3) -> Option<Stokes> {
        let across = axis - axis.dot(direction) * direction;
        Some(Stokes { parameters: [power, power, 0.0, 0.0], axis: across.try_normalize()? })
    }

    /// The power.
    pub fn power(&self) -> f64 {
        self.parameters[0]
    }

    /// The degree of polarisation, from 0 to 1.
    pub fn degree(&self) -> f64 {
        let [i, q, u, v] = self.parameters;
        if i > 0.0 { (q * q + u * u + v * v).sqrt() / i } else { 0.0 }
    }

    /// The same state relative to a different axis perpendicular to the ray: a rotation of the
    /// parameters by twice the angle.
    pub fn rotated_to(&self, axis: Vec3, direction: Vec3) -> Stokes {
        let (cosine, sine) = (self.axis.dot(axis), self.axis.cross(axis).dot(direction));
        let (c, s) = (cosine * cosine - sine * sine, 2.0 * cosine * sine);
        let [i, q, u, v] = self.parameters;
        Stokes { parameters: [i, c * q + s * u, c * u - s * q, v], axis }
    }

    /// The state behind an element with a diagonal Jones matrix: amplitudes along the axis and
    /// perpendicular to it. This is the Mueller matrix of a diattenuating retarder.
    pub fn through_jones(&self, [along, across]: [Complex64; 2]) -> Stokes {
        let [i, q, u, v] = self.parameters;
        let (a, b) = (along.norm_sqr(), across.norm_sqr());
        let (mean, half) = (0.5 * (a + b), 0.5 * (a - b));
        let cross = along * across.conj();
        let parameters = [
            mean * i + half * q,
            half * i + mean * q,
            cross.re * u + cross.im * v,
            cross.re * v - cross.im * u,
        ];
        Stokes { parameters, axis: self.axis }
    }

    /// The same state with a different power.
    pub fn with_power(&self, power: f64) -> Stokes {
        let factor = if self.power() > 0.0 { power / self.power() } else { 0.0 };
        Stokes { parameters: self.parameters.map(|x| x * factor), axis: self.axis }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: [f64; 4], b: [f64; 4]) {
        a.iter().zip(b).for_each(|(x, y)| assert!((x - y).abs() < 1e-14, "{a:?} is not {b:?}"));
    }

    #[test]
    fn turning_the_axis_keeps_the_light() {
        let along = Stokes::linear(2.0, Vec3::Z, Vec3::X).unwrap();
        near(along.rotated_to(Vec3::Y, Vec3::Z).parameters, [2.0, -2.0, 0.0, 0.0]);
        let diagonal = Vec3::new(1.0, 1.0, 0.0).normalize();
        // relative to the diagonal, light along x is polarised at -45 degrees
        near(along.rotated_to(diagonal, Vec3::Z).parameters, [2.0, 0.0, -2.0, 0.0]);
        near(along.rotated_to(diagonal, Vec3::Z).rotated_to(Vec3::X, Vec3::Z).parameters, along.parameters);
    }

    #[test]
    fn malus() {
        for degrees in [0.0_f64, 30.0, 60.0, 90.0] {
            let theta = degrees.to_radians();
            let axis = Vec3::new(theta.cos(), theta.sin(), 0.0);
            let light = Stokes::linear(1.0, Vec3::Z, Vec3::X).unwrap().rotated_to(axis, Vec3::Z);
            let passed = light.through_jones([Complex64::ONE, Complex64::ZERO]).power();
            assert!((passed - theta.cos().powi(2)).abs() < 1e-15);
        }
    }

    #[test]
    fn a_quarter_wave_makes_circular_light_and_two_a_half_wave() {
        let diagonal = Vec3::new(1.0, 1.0, 0.0);
        let light = Stokes::linear(1.0, Vec3::Z, diagonal).unwrap().rotated_to(Vec3::X, Vec3::Z);
        let quarter = [Complex64::ONE, Complex64::I];
        let circular = light.through_jones(quarter);
        assert!((circular.parameters[3].abs() - 1.0).abs() < 1e-15 && circular.degree() > 1.0 - 1e-15);
        near(circular.through_jones(quarter).parameters, [1.0, 0.0, -1.0, 0.0]);
    }

    #[test]
    fn equal_amplitudes_keep_light_unpolarised() {
        let light = Stokes::unpolarised(3.0, Vec3::new(0.6, 0.0, 0.8));
        assert!(light.axis.dot(Vec3::new(0.6, 0.0, 0.8)).abs() < 1e-15);
        near(light.through_jones([Complex64::from(0.5); 2]).parameters, [0.75, 0.0, 0.0, 0.0]);
    }
}
