//! The numbers that hit arrays are made of.

use std::ops::{Add, Sub};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

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
