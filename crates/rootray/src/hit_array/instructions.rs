//! Which of the machine's instructions are used.

use fearless_simd::Level;

/// The instructions that hit arrays are combined with. The results are the same to the bit; this is for tests and measurements.
/// Where the machine lacks the ones asked for, one ray is handled at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Instructions {
    /// The widest that this machine has, found out once while the program runs.
    #[default]
    Widest,
    /// One ray at a time: the plain form of the algorithm.
    Scalar,
    /// x86: two f64 or four f32 at a time.
    Sse2,
    /// x86: as many.
    Sse42,
    /// x86: four f64 or eight f32 at a time.
    Avx2,
    /// x86: eight f64 or sixteen f32 at a time.
    Avx512,
}

impl Instructions {
    /// Those that this machine has, from the narrowest to the widest; `Widest` is not among them.
    pub fn available() -> Vec<Self> {
        let named = [Self::Sse2, Self::Sse42, Self::Avx2, Self::Avx512];
        let found = named.into_iter().filter(|instructions| instructions.level().is_some());
        std::iter::once(Self::Scalar).chain(found).collect()
    }

    /// What to hand to the kernels, `None` for the plain form.
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

    /// What to hand to the kernels, `None` for the plain form.
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
    pub(super) fn level(self) -> Option<Level> {
        Some(Level::new()).filter(|level| self == Self::Widest && !level.is_fallback())
    }
}
