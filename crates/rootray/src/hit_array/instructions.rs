//! Selection of the SIMD instruction set.

use fearless_simd::Level;

/// The instruction set used to combine hit arrays. Results do not depend on it, bit for bit; the choice is
/// for tests and measurements. If the machine lacks the requested set, rays are combined one at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Instructions {
    /// The widest set of this machine, detected at run time.
    #[default]
    Widest,
    /// The scalar algorithm: one ray at a time.
    Scalar,
    /// x86: two f64 or four f32 at a time.
    Sse2,
    /// x86: as many numbers at a time as with `Sse2`.
    Sse42,
    /// x86: four f64 or eight f32 at a time.
    Avx2,
    /// x86: eight f64 or sixteen f32 at a time.
    Avx512,
}

impl Instructions {
    /// The sets that this machine has, from the narrowest to the widest, without `Widest`.
    pub fn available() -> Vec<Self> {
        let named = [Self::Sse2, Self::Sse42, Self::Avx2, Self::Avx512];
        let found = named.into_iter().filter(|instructions| instructions.level().is_some());
        std::iter::once(Self::Scalar).chain(found).collect()
    }

    /// The level to pass to the kernels; `None` for the scalar algorithm.
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    pub(super) fn level(self) -> Option<Level> {
        let widest = Level::new();
        match self {
            Self::Widest => Some(widest).filter(|level| !level.is_fallback()),
            Self::Scalar => None,
            Self::Sse2 => widest.as_sse2().map(Level::Sse2),
            Self::Sse42 => widest.as_sse4_2().map(Level::Sse4_2),
            Self::Avx2 => widest.as_avx2().map(Level::Avx2),
            Self::Avx512 => widest.as_avx512().map(Level::Avx512),
        }
    }

    /// The level to pass to the kernels; `None` for the scalar algorithm.
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
    pub(super) fn level(self) -> Option<Level> {
        Some(Level::new()).filter(|level| self == Self::Widest && !level.is_fallback())
    }
}
