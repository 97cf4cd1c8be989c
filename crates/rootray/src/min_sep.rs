//! The least separation of two root times that rounding errors cannot produce.

/// The least separation of two distinct finite root times: symmetric, and monotonic in `|t1|` and in `|t2|`.
///
/// `min_sep(t1, t2) = max(k u |t1| + k u |t2|, k eta)`, with u = 2^-53 the unit roundoff, eta = 2^-1074 the least positive
/// number, and k = 16.
///
/// Derivation: a root time results from a chain of about 13 rounded operations: origin and direction brought into the frame of
/// a surface (4 each, in three dimensions), a dot product, a subtraction and a division. By the standard model of rounding,
/// fl(x op y) = (x op y)(1 + e), |e| <= u, or an absolute error of at most eta / 2 where the result is subnormal, a chain of k
/// such operations without cancellation moves t by at most k u |t| to first order, or k eta / 2. Two times closer than the sum
/// of their two bounds may represent the same crossing. k = 13 is rounded up to a power of two, so that the products are
/// exact. (Higham, "Accuracy and Stability of Numerical Algorithms", 2nd edition, SIAM 2002, sections 2.2 and 3.1.)
///
/// The bound does not include the magnitudes of the ray's origin and of the solid. Times that result from cancellation, for
/// example of a ray that starts 1e8 away, have larger errors. Use it for root-rays without surfaces.
pub fn min_sep(t1: f64, t2: f64) -> f64 {
    const CHAIN: f64 = 16.0;
    const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;
    const LEAST_POSITIVE: f64 = f64::from_bits(1);
    // scaled before adding: the sum of two great times may overflow
    let relative = CHAIN * UNIT_ROUNDOFF * t1.abs() + CHAIN * UNIT_ROUNDOFF * t2.abs();
    relative.max(CHAIN * LEAST_POSITIVE)
}
