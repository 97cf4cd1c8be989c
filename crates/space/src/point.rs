//! Points and vectors of R^d as arrays.

use rayweave_math::UNIT_ROUNDOFF;

/// A point or a vector of R^d.
pub type Point<const D: usize> = [f64; D];

/// `a + s b`.
pub fn add_scaled<const D: usize>(a: &Point<D>, s: f64, b: &Point<D>) -> Point<D> {
    std::array::from_fn(|k| a[k] + s * b[k])
}

/// `a - b`.
pub fn minus<const D: usize>(a: &Point<D>, b: &Point<D>) -> Point<D> {
    std::array::from_fn(|k| a[k] - b[k])
}

/// The dot product.
pub fn dot<const D: usize>(a: &Point<D>, b: &Point<D>) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}

/// The sum of the absolute values of the terms of a dot product.
pub fn dot_of_sizes<const D: usize>(a: &Point<D>, b: &Point<D>) -> f64 {
    (0..D).map(|k| (a[k] * b[k]).abs()).sum()
}

/// The error of the dot product with a rounded unit vector, relative to [`dot_of_sizes`]: 2 u per component and D u for the terms and
/// their sum, with room. A smaller product counts as 0, because even its sign is unknown. In space this is the bound of the kernels of
/// `rayweave-shape`, 8 u.
pub const fn dot_noise<const D: usize>() -> f64 {
    (D + 5) as f64 * UNIT_ROUNDOFF
}

/// The Euclidean length; scaled first if squares would over- or underflow.
pub fn length<const D: usize>(v: &Point<D>) -> f64 {
    let square = dot(v, v);
    if (1e-280..1e280).contains(&square) {
        return square.sqrt();
    }
    let largest = v.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    if largest == 0.0 || !largest.is_finite() || square.is_nan() {
        return if square.is_nan() { f64::NAN } else { largest };
    }
    let scaled: Point<D> = v.map(|x| x / largest);
    largest * dot(&scaled, &scaled).sqrt()
}

/// True if no component is NaN or infinite.
pub fn is_finite<const D: usize>(v: &Point<D>) -> bool {
    v.iter().all(|x| x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_of_any_size() {
        for scale in [1e-300, 1e-160, 1.0, 1e160, 1e300] {
            assert!((length(&[3.0 * scale, -4.0 * scale]) / (5.0 * scale) - 1.0).abs() < 1e-15);
        }
        assert_eq!(length(&[0.0; 4]), 0.0);
        assert_eq!(length(&[f64::NEG_INFINITY, 0.0]), f64::INFINITY);
        assert!(length(&[f64::NAN, f64::INFINITY]).is_nan());
    }
}
