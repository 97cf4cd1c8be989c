//! The numbers that hit arrays are made of.

use std::ops::{Add, Sub};

mod sealed {
    use fearless_simd::{Simd, SimdFloat, SimdFloatElement};

    pub trait Sealed: SimdFloatElement {
        /// As many numbers as one instruction handles.
        type Lanes<S: Simd>: SimdFloat<S, Element = Self>;
    }

    impl Sealed for f32 {
        type Lanes<S: Simd> = S::f32s;
    }

    impl Sealed for f64 {
        type Lanes<S: Simd> = S::f64s;
    }
}

pub(super) use sealed::Sealed as Wide;

/// A floating-point number: `f32` or `f64`.
pub trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Default
    + Send
    + Sync
    + std::fmt::Debug
    + sealed::Sealed
    + 'static
{
    /// The padding, +inf.
    const INFINITY: Self;
    /// Zero, with a positive sign.
    const ZERO: Self;

    /// The same number as `f64`: exact.
    fn to_f64(self) -> f64;
}

impl Real for f32 {
    const INFINITY: Self = f32::INFINITY;
    const ZERO: Self = 0.0;

    fn to_f64(self) -> f64 {
        f64::from(self)
    }
}

impl Real for f64 {
    const INFINITY: Self = f64::INFINITY;
    const ZERO: Self = 0.0;

    fn to_f64(self) -> f64 {
        self
    }
}
