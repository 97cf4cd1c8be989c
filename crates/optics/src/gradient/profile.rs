//! Profiles of gradients: the index as a function of position, each in its own frame.

use crate::gradient::IndexGrid;
use rayweave_math::Vec3;
use std::fmt;
use std::sync::Arc;

/// A user-defined gradient.
pub trait IndexField: Send + Sync + fmt::Debug {
    /// The factor of the medium's index at a point, and its gradient per unit of length, at a
    /// vacuum wavelength in nanometres.
    ///
    /// It is also evaluated outside of the solid, one step of the light beyond it: the function
    /// should continue there. A factor that is not finite, or a gradient that is not the derivative
    /// of the factor, ends the ray.
    fn at(&self, point: Vec3, wavelength_nm: f64) -> (f64, Vec3);
}

/// The square of the index and half of the gradient of the square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Local {
    pub squared: f64,
    pub force: Vec3,
}

#[derive(Clone, Debug)]
pub(super) enum Profile {
    /// n^2 as a polynomial in r^2 about z.
    Squared(Vec<f64>),
    /// n as a polynomial in r^2 about z plus a polynomial in z without a constant term.
    Polynomial {
        radial: Vec<f64>,
        axial: Vec<f64>,
    },
    FishEye {
        radius: f64,
    },
    Luneburg {
        radius: f64,
    },
    Sampled(Arc<IndexGrid>),
    Own(Arc<dyn IndexField>),
}

/// Equal for equal definitions; a user-defined function equals only itself.
impl PartialEq for Profile {
    fn eq(&self, other: &Profile) -> bool {
        match (self, other) {
            (Profile::Squared(a), Profile::Squared(b)) => a == b,
            (Profile::Polynomial { radial, axial }, Profile::Polynomial { radial: r, axial: z }) => {
                radial == r && axial == z
            }
            (Profile::FishEye { radius: a }, Profile::FishEye { radius: b })
            | (Profile::Luneburg { radius: a }, Profile::Luneburg { radius: b }) => a == b,
            (Profile::Sampled(a), Profile::Sampled(b)) => a == b,
            (Profile::Own(a), Profile::Own(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

impl Profile {
    pub fn at(&self, p: Vec3, wavelength_nm: f64) -> Local {
        match self {
            Profile::Squared(coefficients) => {
                let (squared, slope) = polynomial(coefficients, p.x * p.x + p.y * p.y);
                // half of d/dx of f(x^2 + y^2) is x f'
                Local { squared, force: slope * across(p) }
            }
            Profile::Polynomial { radial, axial } => {
                let (of_radius, slope) = polynomial(radial, p.x * p.x + p.y * p.y);
                let (of_height, rise) = polynomial(axial, p.z);
                let gradient = 2.0 * slope * across(p) + (of_height + p.z * rise) * Vec3::Z;
                from_index(of_radius + p.z * of_height, gradient)
            }
            Profile::FishEye { radius } => {
                let square = radius * radius;
                let n = 2.0 / (1.0 + p.length_squared() / square);
                Local { squared: n * n, force: -(n * n * n / square) * p }
            }
            Profile::Luneburg { radius } => {
                let square = radius * radius;
                Local { squared: 2.0 - p.length_squared() / square, force: -p / square }
            }
            Profile::Sampled(grid) => {
                let (n, gradient) = grid.at(p);
                from_index(n, gradient)
            }
            Profile::Own(field) => {
                let (n, gradient) = field.at(p, wavelength_nm);
                from_index(n, gradient)
            }
        }
    }
}

fn across(p: Vec3) -> Vec3 {
    Vec3::new(p.x, p.y, 0.0)
}

/// A negative index is invalid.
fn from_index(n: f64, gradient: Vec3) -> Local {
    Local { squared: n * n.abs(), force: n * gradient }
}

/// A polynomial and its derivative (Horner's scheme).
fn polynomial(coefficients: &[f64], x: f64) -> (f64, f64) {
    coefficients.iter().rev().fold((0.0, 0.0), |(value, slope), c| (value * x + c, slope * x + value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradient::Gradient;
    use rayweave_math::Affine;

    fn gradients() -> Vec<Gradient> {
        let turned = Affine::rotation(Vec3::new(1.0, 2.0, -0.5), 40.0);
        let map = turned.then(&Affine::translate(Vec3::new(0.3, -0.2, 0.5)));
        vec![
            Gradient::selfoc(0.4).unwrap(),
            Gradient::squared(&[1.0, -0.2, 0.03, -0.004]).unwrap(),
            Gradient::polynomial(&[1.5, -0.1, 0.02], &[0.05, -0.01, 0.003]).unwrap(),
            Gradient::axial(&[1.6, 0.1, -0.02]).unwrap(),
            Gradient::fish_eye(2.0).unwrap(),
            Gradient::luneburg(3.0).unwrap(),
        ]
        .into_iter()
        .flat_map(|gradient| [gradient.placed(&map).unwrap(), gradient])
        .collect()
    }

    #[test]
    fn forces_are_half_the_slopes_of_squares() {
        let step = 1e-5;
        for gradient in gradients() {
            for p in [Vec3::new(0.2, 0.5, -0.3), Vec3::new(-0.7, 0.1, 0.9), Vec3::ZERO] {
                let found = gradient.at(p, 500.0).force;
                let square = |p: Vec3| gradient.at(p, 500.0).squared;
                for (k, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
                    let slope = (square(p + step * axis) - square(p - step * axis)) / (4.0 * step);
                    assert!((found[k] - slope).abs() < 1e-9, "{gradient:?} at {p}: {} {slope}", found[k]);
                }
            }
        }
    }

    #[test]
    fn placements_move_the_centre() {
        let map = Affine::translate(Vec3::new(1.0, 2.0, 3.0));
        let moved = Gradient::luneburg(2.0).unwrap().placed(&map).unwrap();
        assert_eq!(moved.at(Vec3::new(1.0, 2.0, 3.0), 500.0), Local { squared: 2.0, force: Vec3::ZERO });
        let twice = moved.placed(&map).unwrap();
        assert_eq!(twice.at(Vec3::new(2.0, 4.0, 6.0), 500.0).squared, 2.0);
    }

    #[test]
    fn refusals() {
        assert!(Gradient::selfoc(f64::NAN).is_err());
        assert!(Gradient::squared(&[]).is_err());
        assert!(Gradient::axial(&[]).is_err());
        assert!(Gradient::polynomial(&[1.5], &[f64::INFINITY]).is_err());
        assert!(Gradient::fish_eye(0.0).is_err());
        assert!(Gradient::luneburg(-1.0).is_err());
        assert!(Gradient::luneburg(1.0).unwrap().placed(&Affine::scale(Vec3::ZERO)).is_err());
    }
}
