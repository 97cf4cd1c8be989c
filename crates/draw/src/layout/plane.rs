//! Planes of layouts.

use crate::DrawError;
use rayweave_analysis::section::{Cut, SectionError, axis_and_place};
use rayweave_error::Message;
use rayweave_math::Vec3;
use rayweave_optics::Segments;
use std::fmt;
use std::str::FromStr;

/// A plane perpendicular to a coordinate axis, with its coordinate along that axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LayoutPlane {
    /// At this x, with z to the right and y up.
    X(f64),
    /// At this y, with z to the right and x up.
    Y(f64),
    /// At this z, with x to the right and y up.
    Z(f64),
}

impl LayoutPlane {
    /// The plane with its axes.
    ///
    /// # Errors
    /// A coordinate that is not finite.
    pub(super) fn cut(self) -> Result<Cut, SectionError> {
        let (origin, across, up) = match self {
            LayoutPlane::X(x) => (Vec3::X * x, Vec3::Z, Vec3::Y),
            LayoutPlane::Y(y) => (Vec3::Y * y, Vec3::Z, Vec3::X),
            LayoutPlane::Z(z) => (Vec3::Z * z, Vec3::X, Vec3::Y),
        };
        Cut::new(origin, across, up)
    }

    /// The names of the axes to the right and up.
    pub(super) fn axis_names(self) -> [&'static str; 2] {
        match self {
            LayoutPlane::X(_) => ["z", "y"],
            LayoutPlane::Y(_) => ["z", "x"],
            LayoutPlane::Z(_) => ["x", "y"],
        }
    }

    fn axis_and_coordinate(self) -> (&'static str, f64) {
        match self {
            LayoutPlane::X(x) => ("x", x),
            LayoutPlane::Y(y) => ("y", y),
            LayoutPlane::Z(z) => ("z", z),
        }
    }
}

impl fmt::Display for LayoutPlane {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (axis, coordinate) = self.axis_and_coordinate();
        write!(f, "{axis} = {coordinate}")
    }
}

/// Parses `yz`, `xz`, `xy`, the axis perpendicular to the plane, or a coordinate along an axis: `x=2.5`.
impl FromStr for LayoutPlane {
    type Err = DrawError;

    fn from_str(text: &str) -> Result<LayoutPlane, DrawError> {
        let problem = || {
            let reason = "a plane is yz, xz, xy, the axis perpendicular to it, or a coordinate along an axis, such as x=2.5";
            DrawError::Option(Message::new(format!("`{text}` is not a plane"), reason))
        };
        let (axis, coordinate) = axis_and_place(text).ok_or_else(problem)?;
        Ok([LayoutPlane::X, LayoutPlane::Y, LayoutPlane::Z][axis](coordinate))
    }
}

/// Of the planes that set x, y or z to the median of the segment ends, the one with the smallest mean distance from
/// them; the distances along y and z count 1.25 and 1.5 times.
pub(super) fn nearest_to_light(segments: &Segments) -> LayoutPlane {
    let axes = [0, 1, 2].map(|k| Along::new(segments, k));
    let size = axes.iter().map(|along| along.extent).fold(0.0, f64::max);
    let preference = [1.0, 1.25, 1.5];
    let cost = |k: usize| (axes[k].deviation + 1e-9 * size) * preference[k];
    let best = (0..3).min_by(|&a, &b| cost(a).total_cmp(&cost(b))).unwrap_or(0);
    // for light around the origin, the plane through the origin: one that is off by less than the light spreads
    let most = (0.05 * size).min(0.5 * axes[best].deviation).max(1e-9 * size);
    let near = axes[best].median.abs() <= most;
    let place = if near { 0.0 } else { axes[best].median };
    [LayoutPlane::X, LayoutPlane::Y, LayoutPlane::Z][best](place)
}

/// The distribution of a coordinate of the ends of segments.
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
pub(super) mod tests {
    use super::*;
    use rayweave_optics::{Event, Segment};

    #[test]
    fn planes_by_name() {
        assert_eq!("yz".parse(), Ok(LayoutPlane::X(0.0)));
        assert_eq!("ZX".parse(), Ok(LayoutPlane::Y(0.0)));
        assert_eq!(" x = -2.5 ".parse(), Ok(LayoutPlane::X(-2.5)));
        assert_eq!("z=1e3".parse(), Ok(LayoutPlane::Z(1000.0)));
        assert_eq!("y".parse(), Ok(LayoutPlane::Y(0.0)));
        for text in ["", "xx", "w=1", "x=", "x=inf", "x=nan", "w"] {
            assert!(text.parse::<LayoutPlane>().unwrap_err().to_string().contains("x=2.5"), "{text}");
        }
        assert_eq!(LayoutPlane::X(2.5).to_string(), "x = 2.5");
    }

    pub(in crate::layout) fn ray(start: [f64; 3], end: [f64; 3]) -> Segment {
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
            nearest_to_light(&segments)
        };
        let in_xz = [ray([3.0, 7.0, 0.0], [-3.0, 7.0, 9.0]), ray([1.0, 7.0, 0.0], [2.0, 7.0, 9.0])];
        assert_eq!(best_of(&in_xz), LayoutPlane::Y(7.0));
        let on_a_bench = [ray([-9.0, 0.0, 2.0], [9.0, 1.0, 2.0]), ray([9.0, 1.0, 2.0], [5.0, 9.0, 2.0])];
        assert_eq!(best_of(&on_a_bench), LayoutPlane::Z(2.0));
        let round = [ray([3.0, 0.0, 0.0], [0.0, 0.0, 9.0]), ray([0.0, 3.0, 0.0], [0.0, 0.0, 9.0])];
        assert_eq!(best_of(&round), LayoutPlane::X(0.0));
        assert_eq!(best_of(&[]), LayoutPlane::X(0.0));
        // a bar of 300 mm from y = -10 to y = -0.2, and the same light around y = 0
        let bar = |middle: f64| {
            let heights = [-4.8, 4.0, -3.0, 4.8, -4.8, 0.2, 4.8];
            let at = |k: usize| [20.0 * (k % 2) as f64, middle + heights[k], 50.0 * k as f64];
            (0..6).map(|k| ray(at(k), at(k + 1))).collect::<Vec<_>>()
        };
        assert_eq!(best_of(&bar(0.0)), LayoutPlane::Y(0.0));
        match best_of(&bar(-5.0)) {
            LayoutPlane::Y(y) => assert!((-10.0..-0.2).contains(&y), "{y}"),
            plane => panic!("{plane}"),
        }
    }
}
