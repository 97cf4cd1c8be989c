//! Free paths in a material.

use crate::draws::{LEAST_EXPONENTIAL, exponential};

/// The shortest of two free paths and its process, from their mean lengths and uniform numbers, if it ends before the boundary;
/// otherwise any path that does not.
#[inline]
pub(crate) fn shortest<P>(
    means: impl Iterator<Item = (f64, P)>,
    uniforms: [f64; 2],
    to_boundary: f64,
) -> (f64, Option<P>) {
    let mut found = (f64::INFINITY, None);
    for ((mean, process), uniform) in means.zip(uniforms) {
        // most paths are certainly longer, which needs no logarithm
        if mean * (1.0 - uniform) * LEAST_EXPONENTIAL > to_boundary {
            continue;
        }
        let length = mean * exponential(uniform);
        if length < found.0 {
            found = (length, Some(process));
        }
    }
    found
}
