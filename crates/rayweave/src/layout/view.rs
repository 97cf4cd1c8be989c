//! Planes through systems.

use crate::Error;
use crate::plan::axis_and_place;
use rayweave_analysis::section::Cut;
use rayweave_math::Vec3;
use rayweave_optics::Segments;
use std::fmt;
use std::str::FromStr;

/// A plane at right angles to an axis, and where it cuts that axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ViewPlane {
    /// z to the right and y up, at this x.
    X(f64),
    /// z to the right and x up, at this y.
    Y(f64),
    /// x to the right and y up, at this z.
    Z(f64),
}

impl ViewPlane {
    /// The plane with its axes.
    ///
    /// # Errors
    /// A place that is not finite.
    pub(super) fn cut(self) -> Result<Cut, Error> {
        let (origin, across, up) = match self {
            ViewPlane::X(x) => (Vec3::X * x, Vec3::Z, Vec3::Y),
            ViewPlane::Y(y) => (Vec3::Y * y, Vec3::Z, Vec3::X),
            ViewPlane::Z(z) => (Vec3::Z * z, Vec3::X, Vec3::Y),
        };
        Cut::new(origin, across, up).map_err(Error::from)
    }

    /// The names of the axes to the right and up.
    pub(super) fn axes(self) -> [&'static str; 2] {
        match self {
            ViewPlane::X(_) => ["z", "y"],
            ViewPlane::Y(_) => ["z", "x"],
            ViewPlane::Z(_) => ["x", "y"],
        }
    }

    fn name(self) -> (&'static str, f64) {
        match self {
            ViewPlane::X(x) => ("x", x),
            ViewPlane::Y(y) => ("y", y),
            ViewPlane::Z(z) => ("z", z),
        }
    }
}

impl fmt::Display for ViewPlane {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (axis, place) = self.name();
        write!(f, "{axis} = {place}")
    }
}

/// `yz`, `xz`, `xy`, or a place along an axis: `x=2.5`.
impl FromStr for ViewPlane {
    type Err = String;

    fn from_str(text: &str) -> Result<ViewPlane, String> {
        let problem =
            || format!("`{text}` is no plane (it can be yz, xz, xy, or a place along an axis, as x=2.5)");
        let (axis, place) = axis_and_place(text).ok_or_else(problem)?;
        Ok([ViewPlane::X, ViewPlane::Y, ViewPlane::Z][axis](place))
    }
}

/// The plane of which light keeps nearest; that of y and z where others are hardly better.
pub(super) fn best(segments: &Segments) -> ViewPlane {
    let axes = [0, 1, 2].map(|k| Along::new(segments, k));
    let size = axes.iter().map(|along| along.extent).fold(0.0, f64::max);
    let preference = [1.0, 1.25, 1.5];
    let cost = |k: usize| (axes[k].deviation + 1e-9 * size) * preference[k];
    let best = (0..3).min_by(|&a, &b| cost(a).total_cmp(&cost(b))).unwrap_or(0);
    // an axis of light near the origin is meant to go through it
    let near = axes[best].median.abs() < 0.05 * size;
    let place = if near { 0.0 } else { axes[best].median };
    [ViewPlane::X, ViewPlane::Y, ViewPlane::Z][best](place)
}

/// A coordinate of the points where light begins and ends.
struct Along {
    median: f64,
    /// The mean distance from the median.
    deviation: f64,
    extent: f64,
}

impl Along {
    fn new(segments: &Segments, axis: usize) -> Along {
        let columns = segments.start[axis].iter().chain(&segments.end[axis]);
        let mut places: Vec<f64> = columns.copied().filter(|x| x.is_finite()).collect();
        if places.is_empty() {
            return Along { median: 0.0, deviation: 0.0, extent: 0.0 };
        }
        places.sort_by(f64::total_cmp);
        let median = places[places.len() / 2];
        let deviation = places.iter().map(|x| (x - median).abs() / places.len() as f64).sum();
        Along { median, deviation, extent: places[places.len() - 1] - places[0] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_optics::{Event, Segment};

    #[test]
    fn planes_by_name() {
        assert_eq!("yz".parse(), Ok(ViewPlane::X(0.0)));
        assert_eq!("ZX".parse(), Ok(ViewPlane::Y(0.0)));
        assert_eq!(" x = -2.5 ".parse(), Ok(ViewPlane::X(-2.5)));
        assert_eq!("z=1e3".parse(), Ok(ViewPlane::Z(1000.0)));
        for text in ["", "xx", "w=1", "x=", "x=inf", "x=nan", "y"] {
            assert!(text.parse::<ViewPlane>().unwrap_err().contains("x=2.5"), "{text}");
        }
        assert_eq!(ViewPlane::X(2.5).to_string(), "x = 2.5");
    }

    fn ray(start: [f64; 3], end: [f64; 3]) -> Segment {
        let (start, end) = (Vec3::from(start), Vec3::from(end));
        let direction = (end - start).normalize_or_zero();
        Segment {
            id: 0,
            parent: -1,
            generation: 0,
            source: 0,
            wavelength_nm: 500.0,
            intensity: 1.0,
            index: 1.0,
            start,
            end,
            direction,
            path: 0.0,
            element: -1,
            surface: -1,
            event: Event::Absorbed,
        }
    }

    #[test]
    fn the_plane_that_holds_the_light() {
        let best_of = |rays: &[Segment]| {
            let mut segments = Segments::default();
            rays.iter().for_each(|&ray| segments.push(ray));
            best(&segments)
        };
        let in_xz = [ray([3.0, 7.0, 0.0], [-3.0, 7.0, 9.0]), ray([1.0, 7.0, 0.0], [2.0, 7.0, 9.0])];
        assert_eq!(best_of(&in_xz), ViewPlane::Y(7.0));
        let on_a_bench = [ray([-9.0, 0.0, 2.0], [9.0, 1.0, 2.0]), ray([9.0, 1.0, 2.0], [5.0, 9.0, 2.0])];
        assert_eq!(best_of(&on_a_bench), ViewPlane::Z(2.0));
        let round = [ray([3.0, 0.0, 0.0], [0.0, 0.0, 9.0]), ray([0.0, 3.0, 0.0], [0.0, 0.0, 9.0])];
        assert_eq!(best_of(&round), ViewPlane::X(0.0));
        assert_eq!(best_of(&[]), ViewPlane::X(0.0));
    }
}
