//! Spot diagrams.

use super::chart::{BELOW, Chart, MARGIN};
use crate::legend::{self, Lights};
use rayweave_render::axis::number;
use rayweave_render::svg::{Pixels, Svg};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The points at which light meets a detector.
///
/// ```
/// use rayweave::detector::SpotDiagram;
///
/// let mut spot = SpotDiagram::default();
/// for k in 0..100 {
///     spot.add([(k % 10) as f64, (k / 10) as f64], 550.0, 1.0);
/// }
/// assert_eq!(spot.count(), 100);
/// assert!(spot.centroid().iter().all(|x| (x - 4.5).abs() < 1e-12));
/// // two uniform distributions of ten steps: 2 (10^2 - 1) / 12
/// assert!((spot.rms_radius().powi(2) - 16.5).abs() < 1e-12);
/// assert!(spot.to_svg("screen", "mm").contains("<svg "));
/// ```
#[derive(Clone, Debug)]
pub struct SpotDiagram {
    /// Some of the points, evenly chosen.
    points: Vec<Point>,
    /// One of so many points is kept.
    every: u64,
    count: u64,
    power: f64,
    centroid: [f64; 2],
    squares: f64,
}

/// A point at which a ray arrives.
#[derive(Clone, Copy, Debug)]
struct Point {
    place: [f64; 2],
    wavelength_nm: f64,
    power: f64,
}

/// Where points are drawn, and the part of the power that falls beside.
struct Window {
    lo: [f64; 2],
    hi: [f64; 2],
    beside: f64,
}

/// Faint light that falls this many times farther from the centroid than the most of it is left out of the picture.
const FAR: f64 = 3.0;
/// So much of the power is the most of it.
const MOST_POWER: f64 = 0.99;

impl Default for SpotDiagram {
    fn default() -> SpotDiagram {
        SpotDiagram { points: Vec::new(), every: 1, count: 0, power: 0.0, centroid: [0.0; 2], squares: 0.0 }
    }
}

const STYLE: &str = "\
.point { fill: none; stroke-linecap: round; stroke-width: 2.4; stroke-opacity: 0.7 }
.circle { fill: none; stroke: #1d2733; stroke-width: 1; stroke-dasharray: 5 4 }
@media (prefers-color-scheme: dark) { .circle { stroke: #e4e9ee } }
";

impl SpotDiagram {
    /// So many points are drawn at most.
    pub const MOST: usize = 8192;

    /// Adds the point at which a ray arrives, its wavelength in nanometres and its power.
    ///
    /// Mean and sum of squares are updated point by point, without cancellation (D. H. D. West, Communications of the ACM
    /// 22, 532, 1979).
    pub fn add(&mut self, place: [f64; 2], wavelength_nm: f64, power: f64) {
        if self.count.is_multiple_of(self.every) {
            if self.points.len() == SpotDiagram::MOST {
                self.thin_out();
            }
            if self.count.is_multiple_of(self.every) {
                self.points.push(Point { place, wavelength_nm, power });
            }
        }
        self.count += 1;
        if power > 0.0 {
            self.weigh(place, power);
        }
    }

    fn thin_out(&mut self) {
        let mut is_odd = true;
        self.points.retain(|_| {
            is_odd = !is_odd;
            !is_odd
        });
        self.every *= 2;
    }

    fn weigh(&mut self, place: [f64; 2], power: f64) {
        let (before, sum) = (self.power, self.power + power);
        for (mean, coordinate) in self.centroid.iter_mut().zip(place) {
            let away = coordinate - *mean;
            *mean += away * (power / sum);
            self.squares += away * away * (power * (before / sum));
        }
        self.power = sum;
    }

    /// The number of rays.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The power of all of them.
    pub fn power(&self) -> f64 {
        self.power
    }

    /// The mean of the points, weighted by power.
    pub fn centroid(&self) -> [f64; 2] {
        self.centroid
    }

    /// The root of the mean square distance from the centroid, weighted by power; NaN without light.
    pub fn rms_radius(&self) -> f64 {
        (self.squares / self.power).sqrt()
    }

    /// The drawing: the points in the coordinates of the detector, coloured by wavelength, and a circle of the RMS radius
    /// about the centroid. Of more than [`SpotDiagram::MOST`] points evenly chosen ones are drawn; ghosts that are faint and
    /// far away are not.
    pub fn to_svg(&self, name: &str, unit: &str) -> String {
        let window = self.window();
        let chart = Chart::new(window.lo, window.hi);
        let mut svg = Svg::default();
        self.draw_points(&chart, &mut svg);
        let [x0, x1] = [0.0, self.rms_radius()].map(|x| chart.x.place(x));
        if x1 - x0 > 1.0 {
            svg.circle("circle", chart.place(self.centroid), x1 - x0, "");
        }
        let (title, subject) = (format!("Spot diagram: {name}"), self.subject(unit, &window));
        chart.draw(&mut svg, [&title, &subject], unit);
        let [left, top, width, height] = chart.frame();
        let lights = Lights::of(self.points.iter().map(|point| point.wavelength_nm));
        let right = (left + width + MARGIN).max(2.0 * MARGIN + 6.0 * subject.chars().count() as f64);
        let bottom = legend::draw(&mut svg, &lights.entries(), top + height + BELOW + 4.0, right);
        svg.finish([right, bottom], &title, &subject, STYLE)
    }

    fn subject(&self, unit: &str, window: &Window) -> String {
        if self.count == 0 {
            return "no light arrives".to_owned();
        }
        let resolution = 1e-3 * (window.hi[0] - window.lo[0]);
        let [x, y] = self.centroid.map(|place| number(place, resolution));
        let radius = number(self.rms_radius(), 1e-4 * self.rms_radius().max(f64::MIN_POSITIVE));
        let text = format!("{} rays, centroid ({x}, {y}) {unit}, RMS radius {radius} {unit}", self.count);
        match window.beside > 5e-5 {
            true => format!("{text}; {} % of the power beside", number(100.0 * window.beside, 1e-2)),
            false => text,
        }
    }

    /// A square around all points but the faint ones far away.
    fn window(&self) -> Window {
        let mut points: Vec<(f64, f64)> =
            self.points.iter().map(|point| (self.distance(point.place), point.power)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = points.iter().map(|point| point.1).sum();
        let mut sum = 0.0;
        let most = points.iter().find(|point| {
            sum += point.1;
            sum >= MOST_POWER * total
        });
        let (most, last) = (most.map_or(0.0, |point| point.0), points.last().map_or(0.0, |point| point.0));
        let is_far = last > FAR * most && total > 0.0;
        let radius = if is_far { 0.5 * FAR * most } else { last };
        // rounding alone is no spot
        let around = self.centroid.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let half = 1.08 * radius.max(1e-9 * around);
        // nothing, or one point in the middle
        let half = if half > 0.0 { half } else { 1.0 };
        let beside = points.iter().filter(|point| point.0 > half).map(|point| point.1).sum::<f64>();
        let beside = if is_far { beside / total } else { 0.0 };
        Window { lo: self.centroid.map(|x| x - half), hi: self.centroid.map(|x| x + half), beside }
    }

    /// From the centroid, along the axis along which it is greater.
    fn distance(&self, place: [f64; 2]) -> f64 {
        (place[0] - self.centroid[0]).abs().max((place[1] - self.centroid[1]).abs())
    }

    fn draw_points(&self, chart: &Chart, svg: &mut Svg) {
        let mut paths: BTreeMap<String, String> = BTreeMap::new();
        let [left, top, width, height] = chart.frame();
        for &Point { place, wavelength_nm, .. } in &self.points {
            let [x, y] = chart.place(place);
            let is_beside = x < left || x > left + width || y < top || y > top + height;
            if !is_beside {
                let path = paths.entry(legend::light(wavelength_nm)).or_default();
                // writing to a string cannot fail
                let _ = write!(path, "M{} {}h0", Pixels(x), Pixels(y));
            }
        }
        for (colour, path) in paths {
            svg.path("point", path, &format!(r#" stroke="{colour}""#));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn little_light() {
        let dark = SpotDiagram::default();
        assert!(dark.to_svg("a", "mm").contains("no light arrives"));
        let mut focus = SpotDiagram::default();
        focus.add([0.0; 2], 500.0, 1.0);
        // axes that a reader can make something of
        for diagram in [dark, focus] {
            let window = diagram.window();
            assert_eq!((window.lo, window.hi), ([-1.0; 2], [1.0; 2]));
        }
    }
}
