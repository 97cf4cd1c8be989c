//! Spot diagrams.

use super::Arrival;

/// Statistics of a spot diagram; rays are weighted by their power.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// The number of rays.
    pub rays: usize,
    /// The total power.
    pub power: f64,
    /// The mean position.
    pub centroid: [f64; 2],
    /// The root mean square distance from the centroid.
    pub rms: f64,
    /// The RMS distances along x and along y; `rms` is their hypotenuse.
    pub rms_xy: [f64; 2],
    /// The greatest distance from the centroid.
    pub geometric: f64,
}

impl Spot {
    /// The spot of a set of rays; `None` if there is no light.
    pub fn of(arrivals: &[Arrival]) -> Option<Spot> {
        let power: f64 = arrivals.iter().map(|arrival| arrival.power).sum();
        if power <= 0.0 {
            return None;
        }
        let mean = |f: &dyn Fn(&Arrival) -> f64| {
            arrivals.iter().map(|arrival| arrival.power * f(arrival)).sum::<f64>() / power
        };
        let [x, y] = [mean(&|arrival| arrival.position.x), mean(&|arrival| arrival.position.y)];
        let square = |off: f64| off * off;
        let rms_xy = [
            mean(&|arrival| square(arrival.position.x - x)).sqrt(),
            mean(&|arrival| square(arrival.position.y - y)).sqrt(),
        ];
        let off = |arrival: &Arrival| libm::hypot(arrival.position.x - x, arrival.position.y - y);
        Some(Spot {
            rays: arrivals.len(),
            power,
            centroid: [x, y],
            rms: libm::hypot(rms_xy[0], rms_xy[1]),
            rms_xy,
            geometric: arrivals.iter().map(off).fold(0.0, f64::max),
        })
    }
}
