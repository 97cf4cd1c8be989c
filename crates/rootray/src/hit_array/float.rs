//! Element types of hit arrays: `f32` and `f64`.

use std::ops::{Add, Sub};

mod sealed {
    use fearless_simd::{Level, Simd, SimdFloat, SimdFloatElement};

    use super::super::part::Part;
    use super::super::wide::{self, Plan};

    pub trait Sealed: SimdFloatElement {
        /// A SIMD vector of the widest size.
        type Lanes<S: Simd>: SimdFloat<S, Element = Self>;

        /// [`wide::combine`] for this type, so that it is compiled once and not at every call.
        fn combine(level: Level, plan: &Plan, part: Part<'_, Self, Self>) -> bool;

        /// [`wide::pays`] for this type.
        fn pays(level: Level, rows: usize, columns: usize) -> bool;
    }

    impl Sealed for f32 {
        type Lanes<S: Simd> = S::f32s;

        fn combine(level: Level, plan: &Plan, part: Part<'_, f32, f32>) -> bool {
            wide::combine(level, plan, part)
        }

        fn pays(level: Level, rows: usize, columns: usize) -> bool {
            wide::pays::<f32>(level, rows, columns)
        }
    }

    impl Sealed for f64 {
        type Lanes<S: Simd> = S::f64s;

        fn combine(level: Level, plan: &Plan, part: Part<'_, f64, f64>) -> bool {
            wide::combine(level, plan, part)
        }

        fn pays(level: Level, rows: usize, columns: usize) -> bool {
            wide::pays::<f64>(level, rows, columns)
        }
    }
}

pub(super) use sealed::Sealed as Wide;

/// A floating-point number: `f32` or `f64`.
pub trait Float:
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

impl Float for f32 {
    const INFINITY: Self = f32::INFINITY;
    const ZERO: Self = 0.0;

    fn to_f64(self) -> f64 {
        f64::from(self)
    }
}

impl Float for f64 {
    const INFINITY: Self = f64::INFINITY;
    const ZERO: Self = 0.0;

    fn to_f64(self) -> f64 {
        self
    }
}
