//! Defocus: spots in front of and behind the image, best focus.

use super::{Arrival, Spot};

/// The arrivals at a plane shifted along its normal, with their optical paths to it.
pub fn defocused(arrivals: &[Arrival], shift: f64) -> Vec<Arrival> {
    let at = |arrival: &Arrival| {
        let length = shift / arrival.direction.z;
        Arrival {
            position: arrival.position + length * arrival.direction,
            path: arrival.path + arrival.index * length,
            ..*arrival
        }
    };
    arrivals.iter().map(at).collect()
}

/// The spots on planes shifted along the normal; empty if there is no light.
pub fn through_focus(arrivals: &[Arrival], shifts: &[f64]) -> Vec<Spot> {
    shifts.iter().filter_map(|&shift| Spot::of(&defocused(arrivals, shift))).collect()
}

/// The shift of the plane that minimises the RMS radius, in closed form: positions are x + s m with the
/// slopes m, so the mean square radius is a parabola in s with its vertex at - cov(x, m) / var(m), summed
/// over both axes. `None` for parallel rays.
pub fn best_focus(arrivals: &[Arrival]) -> Option<f64> {
    let [covariance, variance] = focal_moments(arrivals);
    let shift = -covariance / variance;
    (variance > 0.0 && shift.is_finite()).then_some(shift)
}

/// cov(x, m) and var(m), summed over both axes.
pub(crate) fn focal_moments(arrivals: &[Arrival]) -> [f64; 2] {
    let power: f64 = arrivals.iter().map(|arrival| arrival.power).sum();
    let mean = |f: &dyn Fn(&Arrival) -> f64| {
        arrivals.iter().map(|arrival| arrival.power * f(arrival)).sum::<f64>() / power
    };
    let slope = |arrival: &Arrival, axis: usize| arrival.direction[axis] / arrival.direction.z;
    let (mut covariance, mut variance) = (0.0, 0.0);
    for axis in 0..2 {
        let middle = [mean(&|arrival| arrival.position[axis]), mean(&|arrival| slope(arrival, axis))];
        let off = |arrival: &Arrival| slope(arrival, axis) - middle[1];
        covariance += mean(&|arrival| (arrival.position[axis] - middle[0]) * off(arrival));
        variance += mean(&|arrival| off(arrival) * off(arrival));
    }
    [covariance, variance]
}
