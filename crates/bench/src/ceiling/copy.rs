//! Memory bandwidth.

use super::{ceiling, measure_rates};
use crate::interleaved::Effort;
use crate::statistics::Statistics;

/// The length of each of the two arrays: 128 MiB, several times larger than current caches.
const LENGTH: usize = 1 << 24;

/// Bytes read plus bytes written per nanosecond, by one thread and by `threads` threads.
pub fn measure(threads: usize, effort: &Effort) -> Result<[Statistics; 2], String> {
    let length = effort.size(LENGTH);
    let source = vec![1.0_f64; length];
    let (mut out, mut out2) = (vec![0.0; length], vec![0.0; length]);
    let bytes = 2 * size_of_val(&source[..]);
    let one = ceiling("one", bytes, || out.copy_from_slice(&source));
    let all = ceiling("all", bytes, || copy(&source, &mut out2, threads)).threads(threads);
    measure_rates(vec![one, all], effort)
}

/// Copies an array in one piece per thread.
fn copy(source: &[f64], out: &mut [f64], threads: usize) {
    let piece = source.len().div_ceil(threads);
    std::thread::scope(|scope| {
        for (source, out) in source.chunks(piece).zip(out.chunks_mut(piece)) {
            scope.spawn(|| out.copy_from_slice(source));
        }
    });
}
