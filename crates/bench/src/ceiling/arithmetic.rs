//! Peak rates of arithmetic.

use super::{Rates, ceiling, measure_rates};
use crate::interleaved::Effort;
use fearless_simd::{Level, Simd, SimdBase, SimdFloat, dispatch};
use std::hint::black_box;

/// The number of independent chains of operations. Twelve hide a latency of four cycles at three
/// results per cycle; with two constants they fit into sixteen registers.
const CHAINS: usize = 12;

/// The number of operations of each chain in one call.
const STEPS: usize = 1000;

/// The number of operands of divisions and square roots in one call: 4 KiB, well within the L1
/// cache.
const LENGTH: usize = 512;

/// The rates of one level on one thread.
pub fn measure(level: Level, effort: &Effort) -> Result<Rates, String> {
    let lanes = dispatch!(level, simd => lanes(simd));
    let chained = CHAINS * STEPS * lanes;
    let mut values: Vec<f64> = (0..LENGTH).map(|i| 1.0 + i as f64 / LENGTH as f64).collect();
    let roots = values.clone();
    let candidates = vec![
        ceiling("fused", 2 * chained, || dispatch!(level, simd => fused(simd))),
        ceiling("simple", chained, || dispatch!(level, simd => simple(simd))),
        ceiling("extremes", chained, || dispatch!(level, simd => extremes(simd))),
        ceiling("divisions", LENGTH, || dispatch!(level, simd => divide(simd, &mut values))),
        ceiling("roots", LENGTH, || dispatch!(level, simd => root(simd, &roots))),
    ];
    let [fused, simple, extremes, divisions, roots] = measure_rates(candidates, effort)?;
    Ok(Rates { level, fused, simple, extremes, divisions, roots })
}

#[inline(always)]
fn lanes<S: Simd>(_: S) -> usize {
    <S::f64s as SimdBase<S>>::LEN
}

/// Executes all chains. The values do not affect the speed, as long as they stay normal numbers.
#[inline(always)]
fn chains<S: Simd>(simd: S, step: impl Fn(usize, S::f64s) -> S::f64s) {
    let mut chains = [S::f64s::splat(simd, black_box(1.0)); CHAINS];
    for _ in 0..STEPS {
        for i in 0..CHAINS {
            chains[i] = step(i, chains[i]);
        }
    }
    black_box(chains);
}

#[inline(always)]
fn fused<S: Simd>(simd: S) {
    let (factor, term) = (S::f64s::splat(simd, black_box(0.5)), S::f64s::splat(simd, black_box(0.5)));
    chains(
        simd,
        #[inline(always)]
        |_, x| x.mul_add(factor, term),
    );
}

#[inline(always)]
fn simple<S: Simd>(simd: S) {
    let (factor, term) = (S::f64s::splat(simd, black_box(1.0)), S::f64s::splat(simd, black_box(1.0)));
    chains(
        simd,
        #[inline(always)]
        |i, x| if i % 2 == 0 { x * factor } else { x + term },
    );
}

#[inline(always)]
fn extremes<S: Simd>(simd: S) {
    let (low, high) = (S::f64s::splat(simd, black_box(0.5)), S::f64s::splat(simd, black_box(2.0)));
    chains(
        simd,
        #[inline(always)]
        |i, x| if i % 2 == 0 { x.min(high) } else { x.max(low) },
    );
}

#[inline(always)]
fn divide<S: Simd>(simd: S, values: &mut [f64]) {
    let numerator = S::f64s::splat(simd, black_box(2.0));
    for values in values.chunks_exact_mut(lanes(simd)) {
        (numerator / S::f64s::from_slice(simd, values)).store_slice(values);
    }
}

/// Square roots of numbers between 1 and 2. The results are not fed back, because they would
/// converge to 1.
#[inline(always)]
fn root<S: Simd>(simd: S, values: &[f64]) {
    let mut out = [0.0; LENGTH];
    for (values, out) in values.chunks_exact(lanes(simd)).zip(out.chunks_exact_mut(lanes(simd))) {
        S::f64s::from_slice(simd, values).sqrt().store_slice(out);
    }
    black_box(out);
}
