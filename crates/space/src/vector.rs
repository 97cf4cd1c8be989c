//! Vector operations in R^d: multiples, norms and unit vectors.

use crate::Point;
use crate::point::length;
use std::array::from_fn;

/// `factor v`.
pub fn times<const D: usize>(factor: f64, v: &Point<D>) -> Point<D> {
    v.map(|x| factor * x)
}

/// The largest magnitude of a component (maximum norm); NaN is ignored.
pub fn largest<const D: usize>(v: &Point<D>) -> f64 {
    v.iter().fold(0.0, |most, x| x.abs().max(most))
}

/// The unit vector along `v`, and the length of `v` as two factors, neither of which over- or underflows. Exact if `v` lies on a
/// coordinate axis; NaN for a zero vector.
pub fn unit<const D: usize>(v: &Point<D>) -> (Point<D>, [f64; 2]) {
    let size = largest(v);
    let scaled = v.map(|x| x / size);
    let length = length(&scaled);
    (scaled.map(|x| x / length), [size, length])
}

/// The unit vector along a coordinate axis.
pub fn axis_vector<const D: usize>(axis: usize) -> Point<D> {
    from_fn(|k| if k == axis { 1.0 } else { 0.0 })
}

/// The vector padded with zeros.
pub fn padded<const D: usize, const N: usize>(v: &Point<D>) -> Point<N> {
    from_fn(|k| v.get(k).copied().unwrap_or(0.0))
}
