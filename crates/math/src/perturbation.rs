//! Symbolic perturbation of in-surface rays and curves (those that lie in a surface): the fixed direction along which they are moved
//! infinitesimally.
//!
//! *Source*: H. Edelsbrunner and E. P. Mücke, "Simulation of simplicity: a technique to cope with degenerate cases in
//! geometric algorithms", ACM Transactions on Graphics 9 (1990).

use crate::Vec3;

/// The direction of symbolic perturbation in space, [`perturbation_direction`] for three dimensions.
pub const PERTURBATION_DIRECTION: Vec3 = Vec3::new(1.0, 0.754_877_666_246_692_7, 0.569_840_290_998_053_2);

/// The direction of symbolic perturbation in R^d: `w_k = g^-k` for k = 0 .. d - 1, with g > 1 the root of `g^d = g + 1`.
///
/// For d = 2 g is the golden ratio, for d = 3 the plastic number. Surfaces of man-made models are unlikely to contain this
/// direction, whatever the dimension. In one dimension there is no such g, and w = 1.
pub fn perturbation_direction<const D: usize>() -> [f64; D] {
    if D == 3 {
        let w = PERTURBATION_DIRECTION.to_array();
        return std::array::from_fn(|k| w[k]);
    }
    // Newton's method from above: g^d - g - 1 is convex there, so the iterates decrease until rounding stops them
    let mut g = 2.0f64;
    for _ in 0..60 {
        let power = (1..D).fold(1.0, |p, _| p * g);
        let next = g - (power * g - g - 1.0) / (D as f64 * power - 1.0);
        if next.is_nan() || next >= g || D < 2 {
            break;
        }
        g = next;
    }
    let mut next = g;
    std::array::from_fn(|_| {
        next /= g;
        next
    })
}

/// True (inside) if moving along [`perturbation_direction`] makes a function with this gradient negative. Where that direction
/// is tangent to the surface, the first coordinate axis that is not tangent decides.
pub fn perturbs_inside<const D: usize>(gradient: &[f64; D]) -> bool {
    let slope = dot(&perturbation_direction::<D>(), gradient);
    let slopes = [slope].into_iter().chain(gradient.iter().copied());
    slopes.into_iter().find(|&slope| slope != 0.0).unwrap_or(0.0) < 0.0
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_the_root() {
        let check = |w: &[f64]| {
            let (d, g) = (w.len() as i32, 1.0 / w[1]);
            assert!((libm::pow(g, f64::from(d)) - g - 1.0).abs() < 1e-14, "{w:?}");
            assert!(w.windows(2).all(|p| (p[0] / p[1] - g).abs() < 1e-14) && w[0] == 1.0);
        };
        check(&perturbation_direction::<2>());
        check(&perturbation_direction::<3>());
        check(&perturbation_direction::<4>());
        check(&perturbation_direction::<7>());
        assert_eq!(perturbation_direction::<1>(), [1.0]);
    }

    #[test]
    fn the_first_nonzero_slope_decides() {
        assert!(perturbs_inside(&[-1.0, 0.0]) && !perturbs_inside(&[1.0, 0.0]));
        let w = perturbation_direction::<2>();
        let tangent = [w[1], -w[0]];
        assert_eq!(dot(&w, &tangent), 0.0);
        assert!(!perturbs_inside(&tangent));
        assert!(!perturbs_inside(&[0.0; 3]));
    }
}
