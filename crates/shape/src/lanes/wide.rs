//! Dispatch to the instruction sets with wide vector registers.

use fearless_simd::Level;

/// An instruction set for which large kernels in lanes are compiled: on x86, AVX2 and AVX-512.
///
/// Large kernels for eight lanes do not fit the sixteen registers of SSE2, each of which holds two numbers: most of their code moves
/// numbers between registers and memory, and it took a seventh of the time of a release build. On x86 processors without AVX2
/// (from before 2013), callers use their scalar code, which computes the same bits.
///
/// Builds without optimisation have no such level: there every lane is a call with its own variables, so that the kernels are slower
/// than scalar code and need 2.4 MB of stack, more than a thread of the standard library has.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum WideLevel {
    /// AVX2 with FMA.
    #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), not(unoptimised)))]
    Avx2(fearless_simd::x86::Avx2),
    /// AVX-512.
    #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), not(unoptimised)))]
    Avx512(fearless_simd::x86::Avx512),
    /// NEON of 64-bit ARM processors.
    #[cfg(all(target_arch = "aarch64", not(unoptimised)))]
    Neon(fearless_simd::aarch64::Neon),
    /// The vectors of WebAssembly.
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128", not(unoptimised)))]
    Wasm(fearless_simd::wasm32::WasmSimd128),
}

impl WideLevel {
    /// The wide instruction set of a level, if it has one.
    #[must_use]
    pub fn of_level(level: Level) -> Option<WideLevel> {
        match level {
            #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), not(unoptimised)))]
            Level::Avx2(token) => Some(WideLevel::Avx2(token)),
            #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), not(unoptimised)))]
            Level::Avx512(token) => Some(WideLevel::Avx512(token)),
            #[cfg(all(target_arch = "aarch64", not(unoptimised)))]
            Level::Neon(token) => Some(WideLevel::Neon(token)),
            #[cfg(all(target_arch = "wasm32", target_feature = "simd128", not(unoptimised)))]
            Level::WasmSimd128(token) => Some(WideLevel::Wasm(token)),
            _ => None,
        }
    }

    /// A token for code that is compiled but never called.
    #[cfg(all(unoptimised, any(target_arch = "x86", target_arch = "x86_64")))]
    pub fn never(self) -> fearless_simd::x86::Avx2 {
        match self {}
    }

    /// A token for code that is compiled but never called.
    #[cfg(all(unoptimised, target_arch = "aarch64"))]
    pub fn never(self) -> fearless_simd::aarch64::Neon {
        match self {}
    }

    /// The widest instruction set of this processor.
    #[must_use]
    pub fn widest() -> Option<WideLevel> {
        WideLevel::of_level(Level::new())
    }
}

/// Evaluates an expression compiled for a [`WideLevel`], like [`fearless_simd::dispatch`] for all levels:
/// `dispatch_wide!(level, simd => kernel(simd))`.
#[cfg(not(unoptimised))]
#[macro_export]
macro_rules! dispatch_wide {
    ($level:expr, $simd:ident => $value:expr) => {
        match $level {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            $crate::lanes::WideLevel::Avx2($simd) => $crate::dispatch_wide!(@vectorize $simd => $value),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            $crate::lanes::WideLevel::Avx512($simd) => $crate::dispatch_wide!(@vectorize $simd => $value),
            #[cfg(target_arch = "aarch64")]
            $crate::lanes::WideLevel::Neon($simd) => $crate::dispatch_wide!(@vectorize $simd => $value),
            #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
            $crate::lanes::WideLevel::Wasm($simd) => $crate::dispatch_wide!(@vectorize $simd => $value),
            _ => unreachable!("no other level exists on this processor"),
        }
    };
    (@vectorize $simd:ident => $value:expr) => {
        fearless_simd::Simd::vectorize($simd, #[inline(always)] || $value)
    };
}

/// Compiles a kernel that is never called: there is no [`WideLevel`] without optimisation.
#[cfg(all(unoptimised, any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64")))]
#[macro_export]
macro_rules! dispatch_wide {
    ($level:expr, $simd:ident => $value:expr) => {{
        let $simd = $crate::lanes::WideLevel::never($level);
        $value
    }};
}

/// Compiles no kernel: there is no [`WideLevel`] without optimisation.
#[cfg(all(unoptimised, not(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64"))))]
#[macro_export]
macro_rules! dispatch_wide {
    ($level:expr, $simd:ident => $value:expr) => {{
        let _: $crate::lanes::WideLevel = $level;
        unreachable!("no wide level exists in builds without optimisation")
    }};
}
