//! Polarised light as Stokes parameters about a direction that goes with the ray.
//!
//! `i` is the power; `q > 0` is light that swings along the axis, `q < 0` across it; `u > 0` at +45 degrees, from the axis
//! towards `direction x axis`; `v` is circular. |(q, u, v)| <= i (Born & Wolf, *Principles of Optics*, 7th edition, section
//! 1.4.2; Chipman, Lam, Young, *Polarized Light and Optical Systems*, chapters 3 and 6).

use num_complex::Complex64;
use rayweave_math::Vec3;

/// The state of polarisation of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stokes {
    /// The power and its polarised parts: i, q, u, v.
    pub parameters: [f64; 4],
    /// The axis of q > 0: a unit vector across the ray.
    pub axis: Vec3,
}

impl Stokes {
    /// Unpolarised light along a direction.
    pub fn unpolarised(power: f64, direction: Vec3) -> Stokes {
        Stokes { parameters: [power, 0.0, 0.0, 0.0], axis: direction.any_orthonormal_vector() }
    }

    /// Light that swings in the plane of the direction and an axis, which are not parallel.
    pub fn linear(power: f64, direction: Vec3, axis: Vec3) -> Option<Stokes> {
        let across = axis - axis.dot(direction) * direction;
        Some(Stokes { parameters: [power, power, 0.0, 0.0], axis: across.try_normalize()? })
    }

    /// The power.
    pub fn power(&self) -> f64 {
        self.parameters[0]
    }

    /// The part of the power that is polarised, from 0 to 1.
    pub fn degree(&self) -> f64 {
        let [i, q, u, v] = self.parameters;
        if i > 0.0 { (q * q + u * u + v * v).sqrt() / i } else { 0.0 }
    }

    /// The same state about another axis across the ray: the parameters turn by twice the angle.
    pub fn about(&self, axis: Vec3, direction: Vec3) -> Stokes {
        let (cosine, sine) = (self.axis.dot(axis), self.axis.cross(axis).dot(direction));
        let (c, s) = (cosine * cosine - sine * sine, 2.0 * cosine * sine);
        let [i, q, u, v] = self.parameters;
        Stokes { parameters: [i, c * q + s * u, c * u - s * q, v], axis }
    }

    /// After an element with the given amplitudes along the axis and across it.
    pub fn after(&self, [along, across]: [Complex64; 2]) -> Stokes {
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

    /// The same state with another power.
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
        near(along.about(Vec3::Y, Vec3::Z).parameters, [2.0, -2.0, 0.0, 0.0]);
        let diagonal = Vec3::new(1.0, 1.0, 0.0).normalize();
        // seen from the diagonal, light along x swings at -45 degrees
        near(along.about(diagonal, Vec3::Z).parameters, [2.0, 0.0, -2.0, 0.0]);
        near(along.about(diagonal, Vec3::Z).about(Vec3::X, Vec3::Z).parameters, along.parameters);
    }

    #[test]
    fn malus() {
        for degrees in [0.0_f64, 30.0, 60.0, 90.0] {
            let theta = degrees.to_radians();
            let axis = Vec3::new(theta.cos(), theta.sin(), 0.0);
            let light = Stokes::linear(1.0, Vec3::Z, Vec3::X).unwrap().about(axis, Vec3::Z);
            let passed = light.after([Complex64::ONE, Complex64::ZERO]).power();
            assert!((passed - theta.cos().powi(2)).abs() < 1e-15);
        }
    }

    #[test]
    fn a_quarter_wave_makes_circular_light_and_two_a_half_wave() {
        let diagonal = Vec3::new(1.0, 1.0, 0.0);
        let light = Stokes::linear(1.0, Vec3::Z, diagonal).unwrap().about(Vec3::X, Vec3::Z);
        let quarter = [Complex64::ONE, Complex64::I];
        let circular = light.after(quarter);
        assert!((circular.parameters[3].abs() - 1.0).abs() < 1e-15 && circular.degree() > 1.0 - 1e-15);
        near(circular.after(quarter).parameters, [1.0, 0.0, -1.0, 0.0]);
    }

    #[test]
    fn unpolarised_light_stays_so_through_equal_amplitudes() {
        let light = Stokes::unpolarised(3.0, Vec3::new(0.6, 0.0, 0.8));
        assert!(light.axis.dot(Vec3::new(0.6, 0.0, 0.8)).abs() < 1e-15);
        near(light.after([Complex64::from(0.5); 2]).parameters, [0.75, 0.0, 0.0, 0.0]);
    }
}
