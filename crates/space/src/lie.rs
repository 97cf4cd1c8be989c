//! The direction into which a trajectory that lies in a surface is moved in thought.

use crate::Point;
use crate::point::dot;

/// `w_k = g^-k` for k = 0 .. d - 1, with g > 1 the root of `g^d = g + 1`: a direction that no surface of a man-made
/// model is likely to contain, whatever the dimension. (In one dimension there is no such g, and w = 1.)
///
/// For d = 2 g is the golden ratio, for d = 3 the plastic number, and w is that of
/// [`rayweave_shape::surface::LIE_DIRECTION`].
pub fn lie_direction<const D: usize>() -> Point<D> {
    if D == 3 {
        let w = rayweave_shape::surface::LIE_DIRECTION.to_array();
        return std::array::from_fn(|k| w[k]);
    }
    // Newton from above: g^d - g - 1 is convex there, so the steps decrease until they are lost in rounding
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

/// True (inside) if moving along [`lie_direction`] makes a function with this gradient negative; where that
/// direction is tangent, along the first axis that is not.
pub fn leads_inside<const D: usize>(gradient: &Point<D>) -> bool {
    let slope = dot(&lie_direction::<D>(), gradient);
    let slopes = [slope].into_iter().chain(gradient.iter().copied());
    slopes.into_iter().find(|&slope| slope != 0.0).unwrap_or(0.0) < 0.0
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
        check(&lie_direction::<2>());
        check(&lie_direction::<3>());
        check(&lie_direction::<4>());
        check(&lie_direction::<7>());
        assert_eq!(lie_direction::<1>(), [1.0]);
    }

    #[test]
    fn the_side_is_that_of_the_first_slope() {
        assert!(leads_inside(&[-1.0, 0.0]) && !leads_inside(&[1.0, 0.0]));
        let w = lie_direction::<2>();
        let tangent = [w[1], -w[0]];
        assert_eq!(dot(&w, &tangent), 0.0);
        assert!(!leads_inside(&tangent));
        assert!(!leads_inside(&[0.0; 3]));
    }
}
