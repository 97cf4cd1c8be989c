//! Optical media: complex refractive index as a function of wavelength (dispersion), gradient index
//! and absorption (Beer-Lambert law).

use crate::error::OpticsError;
use crate::glass::{Glass, GlassError, glass};
use crate::gradient::{Gradient, LocalField};
use num_complex::Complex64;
use rayweave_math::Vec3;
use std::fmt;
use std::sync::Arc;

/// A dispersion law: the complex refractive index as a function of wavelength.
pub trait Index: Send + Sync + fmt::Debug {
    /// The index n + i k at a vacuum wavelength in nanometres, for all wavelengths of
    /// [`Index::range_nm`]; `k >= 0` is the extinction coefficient.
    fn at(&self, wavelength_nm: f64) -> Complex64;

    /// The shortest and the longest wavelength for which the law holds, in nanometres.
    fn range_nm(&self) -> [f64; 2] {
        [0.0, f64::INFINITY]
    }
}

/// A medium: a name, a dispersion law, and a gradient if the index varies in space.
#[derive(Clone, Debug)]
pub struct Medium {
    name: Arc<str>,
    index: Law,
    gradient: Option<Arc<Gradient>>,
}

#[derive(Clone, Debug)]
enum Law {
    Constant(Complex64),
    Glass(Glass),
    Dispersive(Arc<dyn Index>),
}

/// Equal for equal names and definitions; a shared dispersion law equals only itself.
impl PartialEq for Medium {
    fn eq(&self, other: &Medium) -> bool {
        let same_law = match (&self.index, &other.index) {
            (Law::Constant(a), Law::Constant(b)) => a == b,
            (Law::Glass(a), Law::Glass(b)) => a == b,
            (Law::Dispersive(a), Law::Dispersive(b)) => Arc::ptr_eq(a, b),
            _ => false,
        };
        same_law && self.name == other.name && self.gradient == other.gradient
    }
}

impl Medium {
    /// Vacuum: an index of 1.
    pub fn vacuum() -> Medium {
        Medium::of("vacuum", Law::Constant(Complex64::ONE))
    }

    /// A medium with the same index at all wavelengths.
    ///
    /// # Errors
    /// [`OpticsError::BadIndex`] unless `n > 0` and `k >= 0` are finite.
    pub fn constant(name: &str, n: f64, k: f64) -> Result<Medium, OpticsError> {
        let index = Complex64::new(n, k);
        let is_physical = n > 0.0 && k >= 0.0 && index.is_finite();
        is_physical
            .then(|| Medium::of(name, Law::Constant(index)))
            .ok_or_else(|| OpticsError::BadIndex { medium: name.to_owned(), index })
    }

    /// A medium with a dispersion law.
    pub fn dispersive(name: &str, index: Arc<dyn Index>) -> Medium {
        Medium::of(name, Law::Dispersive(index))
    }

    fn of(name: &str, index: Law) -> Medium {
        Medium { name: name.into(), index, gradient: None }
    }

    /// The medium with a gradient index: its index is multiplied by a factor that varies in space.
    /// The absorption remains uniform.
    pub fn graded(self, gradient: Gradient) -> Medium {
        Medium { gradient: Some(Arc::new(gradient)), ..self }
    }

    /// The medium with an index that is larger by the same amount at all wavelengths, where a gradient is 1; see [`Glass::shifted`].
    pub fn shifted(&self, by: f64) -> Medium {
        let Medium { name, index, gradient } = self.clone();
        let (name, index) = match index {
            Law::Glass(glass) => {
                let glass = glass.shifted(by);
                (glass.name().into(), Law::Glass(glass))
            }
            Law::Constant(index) => (name, Law::Constant(index + by)),
            Law::Dispersive(_) if by == 0.0 => (name, index),
            Law::Dispersive(law) => (name, Law::Dispersive(Arc::new(Shifted { law, by }))),
        };
        Medium { name, index, gradient }
    }

    /// The gradient of the index, if it varies in space.
    pub fn gradient(&self) -> Option<&Gradient> {
        self.gradient.as_deref()
    }

    /// A material of the built-in catalogue ([`crate::glass::glass()`]), with the absorption in its data.
    ///
    /// # Errors
    /// [`GlassError`] for an unknown name, with a suggestion.
    pub fn glass(name: &str) -> Result<Medium, GlassError> {
        Ok(Medium::from(glass(name)?))
    }

    /// The name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The catalogue material, if the medium is one.
    pub fn as_glass(&self) -> Option<&Glass> {
        match &self.index {
            Law::Glass(glass) => Some(glass),
            Law::Constant(_) | Law::Dispersive(_) => None,
        }
    }

    /// The complex index, if it is the same at all wavelengths.
    pub fn as_constant(&self) -> Option<Complex64> {
        match &self.index {
            Law::Constant(index) => Some(*index),
            Law::Glass(_) | Law::Dispersive(_) => None,
        }
    }

    /// The complex refractive index at a vacuum wavelength in nanometres, with an extinction of 0
    /// where that is unknown; meaningless outside [`Medium::range_nm`].
    ///
    /// For a gradient this is the index that its factor multiplies.
    pub fn index(&self, wavelength_nm: f64) -> Complex64 {
        match &self.index {
            Law::Constant(index) => *index,
            Law::Glass(glass) => index_of(glass, wavelength_nm),
            Law::Dispersive(law) => law.at(wavelength_nm),
        }
    }

    /// The complex refractive index at a point; its real part is NaN where a gradient has none.
    pub fn index_at(&self, wavelength_nm: f64, point: Vec3) -> Complex64 {
        let index = self.index(wavelength_nm);
        match &self.gradient {
            Some(gradient) => {
                let field = LocalField { gradient, index: index.re, wavelength_nm };
                Complex64::new(field.index_at(point), index.im)
            }
            None => index,
        }
    }

    /// The wavelengths for which the index is defined, shortest and longest, in nanometres.
    pub fn range_nm(&self) -> [f64; 2] {
        match &self.index {
            Law::Constant(_) => [0.0, f64::INFINITY],
            Law::Glass(glass) => glass.range_nm(),
            Law::Dispersive(law) => law.range_nm(),
        }
    }

    /// The absorption coefficient per nanometre, `4 pi k / wavelength` (Born & Wolf, *Principles of
    /// Optics*, 7th edition, section 14.1, equation 18): power falls as
    /// `exp(-coefficient * length)` (Beer-Lambert).
    pub fn absorption_per_nm(&self, wavelength_nm: f64) -> f64 {
        absorption_per_nm(self.index(wavelength_nm), wavelength_nm)
    }
}

/// A law plus the same amount at all wavelengths.
#[derive(Debug)]
struct Shifted {
    law: Arc<dyn Index>,
    by: f64,
}

impl Index for Shifted {
    fn at(&self, wavelength_nm: f64) -> Complex64 {
        self.law.at(wavelength_nm) + self.by
    }

    fn range_nm(&self) -> [f64; 2] {
        self.law.range_nm()
    }
}

/// [`Medium::absorption_per_nm`] from the index.
pub(crate) fn absorption_per_nm(index: Complex64, wavelength_nm: f64) -> f64 {
    4.0 * std::f64::consts::PI * index.im / wavelength_nm
}

impl From<Glass> for Medium {
    fn from(glass: Glass) -> Medium {
        Medium { name: glass.name().into(), index: Law::Glass(glass), gradient: None }
    }
}

/// The index of a glass; transparent where its extinction is unknown.
fn index_of(glass: &Glass, wavelength_nm: f64) -> Complex64 {
    let n = glass.index(wavelength_nm).unwrap_or(f64::NAN);
    Complex64::new(n, glass.extinction(wavelength_nm).unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refusals_and_equality() {
        for (n, k) in [(0.0, 0.0), (-1.5, 0.0), (1.5, -1.0), (f64::NAN, 0.0), (f64::INFINITY, 0.0)] {
            assert!(Medium::constant("x", n, k).is_err(), "{n} {k}");
        }
        let glass = Medium::constant("glass", 1.5, 0.0).unwrap();
        assert_eq!(glass, glass.clone());
        assert_ne!(glass, Medium::constant("glass", 1.6, 0.0).unwrap());
        assert_eq!(Medium::glass("N-BK7").unwrap(), Medium::glass("n bk7").unwrap());
        assert_ne!(Medium::glass("N-BK7").unwrap(), Medium::glass("N-SF5").unwrap());
    }

    #[test]
    fn shifted_media_are_what_they_say() {
        let glass = Medium::glass("N-BK7").unwrap();
        let shifted = glass.shifted(0.125).shifted(-0.25);
        assert_eq!(shifted.name(), "N-BK7 -0.12500");
        assert_eq!(shifted.index(550.0).re, glass.index(550.0).re - 0.125);
        assert_eq!((shifted.range_nm(), shifted.index(550.0).im), (glass.range_nm(), glass.index(550.0).im));
        assert_ne!(shifted, glass);
        assert_eq!((shifted.clone(), glass.clone()), (glass.shifted(-0.125), glass.shifted(0.0)));
        let rod = Medium::constant("rod", 1.5, 0.0).unwrap().graded(Gradient::selfoc(0.1).unwrap());
        let off_axis = rod.index_at(550.0, Vec3::X) / 1.5;
        assert_eq!(rod.shifted(0.5).index_at(550.0, Vec3::X), 2.0 * off_axis);
    }

    #[test]
    fn absorption_follows_from_extinction() {
        // one wavelength of k = 1 / 4 pi absorbs 1 - 1/e
        let ink = Medium::constant("ink", 1.3, 0.25 / std::f64::consts::PI).unwrap();
        assert!((ink.absorption_per_nm(500.0) * 500.0 - 1.0).abs() < 1e-15);
    }
}
