//! Gradient-index (GRIN) media, and the curved ray paths in them.
//!
//! A [`Gradient`] is the spatial variation of the index: a factor that multiplies the index of a
//! [`Medium`](crate::Medium), which defines the dispersion. For example,
//! `Medium::glass("N-BK7")?.graded(Gradient::selfoc(0.3)?)` is the medium of a gradient-index rod.
//!
//! Light follows `d/ds (n dr/ds) = grad n` (Born & Wolf, *Principles of Optics*, 7th edition,
//! section 3.2.1, equation 2). With the parameter `tau`, `ds = n dtau`, this becomes
//! `d^2 r/dtau^2 = n grad n`, which has no square roots and is regular at turning points (Sharma,
//! Kumar & Ghatak, Appl. Opt. 21, 984, 1982). It is integrated by Gauss collocation, which is
//! symplectic, so that etendue is conserved, and time-reversible, like the path of light (Hairer,
//! Lubich & Wanner, *Geometric Numerical Integration*, 2nd edition, sections II.1.3 and V.2.1,
//! theorem VI.4.2). The polynomial of a step is a [curve](rayweave_space::Curve) with a bound on
//! its acceleration, so that no crossing is missed within a step, however thin the solid.

mod check;
mod collocation;
mod field;
mod follow;
mod grid;
mod profile;

pub(crate) use field::LocalField;
pub use grid::IndexGrid;
pub use profile::IndexField;

use crate::error::OpticsError;
use check::{bad, finite, positive};
use profile::{Local, Profile};
use rayweave_math::{Affine, Vec3};
use std::sync::Arc;

/// The spatial variation of a refractive index: a factor that multiplies the index of a medium, as a function
/// of position.
///
/// Lengths are in the unit of the system. The formulas hold in the frame of the gradient, which is
/// the world frame unless the gradient is [`placed`](Gradient::placed). Where a formula gives no
/// valid index (an index or a square of 0 or less), a face absorbs the light that would enter.
///
/// ```
/// use rayweave_math::Vec3;
/// use rayweave_optics::Medium;
/// use rayweave_optics::gradient::Gradient;
///
/// // a rod with the index 1.6 on the axis; its quarter pitch is pi / 2 / 0.25
/// let rod = Medium::constant("rod", 1.6, 0.0)?.graded(Gradient::selfoc(0.25)?);
/// assert_eq!(rod.index_at(587.6, Vec3::ZERO).re, 1.6);
/// assert!((rod.index_at(587.6, Vec3::X).re - 1.6 * (1.0_f64 - 0.0625).sqrt()).abs() < 1e-15);
/// # Ok::<(), rayweave_optics::OpticsError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Gradient {
    profile: Profile,
    local_from_world: Affine,
}

impl Gradient {
    /// A gradient-index rod with sinusoidal ray paths (Selfoc): `n^2 = n0^2 (1 - g^2 r^2)`, r the
    /// distance from the z axis. Rays near the axis have the period (pitch) `2 pi / g`.
    ///
    /// # Errors
    /// [`OpticsError::BadGradient`] if g^2 is not finite.
    pub fn selfoc(g: f64) -> Result<Gradient, OpticsError> {
        Gradient::squared(&[1.0, -g * g])
    }

    /// A radial gradient about the z axis, given by the square of the index:
    /// `n^2 = n0^2 (a0 + a1 r^2 + a2 r^4 + ..)`, as in the data sheets of gradient-index rods.
    ///
    /// # Errors
    /// [`OpticsError::BadGradient`] if there are no coefficients, or if one is not finite.
    pub fn squared(coefficients: &[f64]) -> Result<Gradient, OpticsError> {
        let coefficients = finite("coefficients of r^2", coefficients)?;
        Ok(Gradient::of(Profile::Squared(coefficients)))
    }

    /// A radial and axial gradient: `n = n0 (r0 + r1 r^2 + r2 r^4 + .. + z1 z + z2 z^2 + ..)`.
    ///
    /// # Errors
    /// [`OpticsError::BadGradient`] if there are no radial coefficients, or if a coefficient is not finite.
    pub fn polynomial(radial: &[f64], axial: &[f64]) -> Result<Gradient, OpticsError> {
        let radial = finite("radial coefficients", radial)?;
        let axial = if axial.is_empty() { Vec::new() } else { finite("axial coefficients", axial)? };
        Ok(Gradient::of(Profile::Polynomial { radial, axial }))
    }

    /// An axial gradient along z: `n = n0 (c0 + c1 z + c2 z^2 + ..)`.
    ///
    /// # Errors
    /// [`OpticsError::BadGradient`] if there are no coefficients, or if one is not finite.
    pub fn axial(coefficients: &[f64]) -> Result<Gradient, OpticsError> {
        let coefficients = finite("axial coefficients", coefficients)?;
        Gradient::polynomial(&coefficients[..1], &coefficients[1..])
    }

    /// Maxwell's fish-eye: `n = 2 n0 / (1 + (r / a)^2)`, r the distance from the origin, a the
    /// radius. All light from a point at the distance r converges at its image point: on the
    /// opposite side of the origin, at the distance `a^2 / r` (Born & Wolf, section 4.2.2).
    ///
    /// # Errors
    /// [`OpticsError::BadGradient`] unless the radius is positive and finite.
    pub fn fish_eye(radius: f64) -> Result<Gradient, OpticsError> {
        positive("radius", radius)?;
        Ok(Gradient::of(Profile::FishEye { radius }))
    }

    /// Luneburg's lens: `n = n0 sqrt(2 - (r / a)^2)`, r the distance from the origin, a the radius.
    /// In a medium of index n0, a ball of radius a with this gradient focuses parallel light on its far side
    /// (R. K. Luneburg, *Mathematical Theory of Optics*, 1964, section 29).
    ///
    /// # Errors
    /// [`OpticsError::BadGradient`] unless the radius is positive and finite.
    pub fn luneburg(radius: f64) -> Result<Gradient, OpticsError> {
        positive("radius", radius)?;
        Ok(Gradient::of(Profile::Luneburg { radius }))
    }

    /// A gradient interpolated between values on a grid: see [`IndexGrid`].
    pub fn sampled(grid: IndexGrid) -> Gradient {
        Gradient::of(Profile::Sampled(Arc::new(grid)))
    }

    /// A gradient from a user-defined function.
    pub fn own(field: Arc<dyn IndexField>) -> Gradient {
        Gradient::of(Profile::Own(field))
    }

    fn of(profile: Profile) -> Gradient {
        Gradient { profile, local_from_world: Affine::IDENTITY }
    }

    /// The gradient transformed by an affine map, which is applied after all earlier placements.
    ///
    /// # Errors
    /// [`OpticsError::BadGradient`] if the map is singular or not finite.
    pub fn placed(&self, map: &Affine) -> Result<Gradient, OpticsError> {
        let back = map
            .inverse()
            .map_err(|error| bad("placement of the gradient is invalid".to_owned(), error.to_string()))?;
        Ok(Gradient { profile: self.profile.clone(), local_from_world: back.then(&self.local_from_world) })
    }

    /// The square of the factor, negative for a negative factor, and half of the gradient of the
    /// square, which is the factor times its gradient.
    pub(crate) fn at(&self, point: Vec3, wavelength_nm: f64) -> Local {
        let map = &self.local_from_world;
        if *map == Affine::IDENTITY {
            return self.profile.at(point, wavelength_nm);
        }
        let Local { squared, force } = self.profile.at(map.point(point), wavelength_nm);
        // a gradient is a covector: it transforms with the transposed inverse
        Local { squared, force: map.linear.transpose() * force }
    }
}
