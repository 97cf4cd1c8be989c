//! Spot diagrams as SVG.

use super::chart::{BELOW, Chart, MARGIN};
use crate::axis::format_number;
use crate::legend::{self, Wavelengths};
use crate::svg::{Pixels, Svg};
use rayweave_optics::detector::{SpotDiagram, SpotPoint};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The window of a chart, and the part of the power outside of it.
struct Window {
    lo: [f64; 2],
    hi: [f64; 2],
    outside: f64,
}

/// Light farther from the centroid than this many times the radius of the bright part is not drawn.
const FAR: f64 = 3.0;
/// The part of the power that the bright part holds.
const BRIGHT: f64 = 0.99;
/// The part of the power outside of the window from which on the subtitle reports it.
const REPORTED: f64 = 5e-5;

const STYLE: &str = "\
.point { fill: none; stroke-linecap: round; stroke-width: 2.4; stroke-opacity: 0.7 }
.circle { fill: none; stroke: #1d2733; stroke-width: 1; stroke-dasharray: 5 4 }
@media (prefers-color-scheme: dark) { .circle { stroke: #e4e9ee } }
";

/// Draws a spot diagram: the points in the coordinates of the detector, coloured by wavelength, and a circle of the RMS radius
/// about the centroid. Faint and distant ghosts are outside of the chart. `unit` is that of lengths.
///
/// ```
/// use rayweave_draw::detector::spot_svg;
/// use rayweave_optics::detector::SpotDiagram;
///
/// let mut spot = SpotDiagram::default();
/// (0..100).for_each(|k| spot.add([(k % 10) as f64, (k / 10) as f64], 550.0, 1.0));
/// assert!(spot_svg(&spot, "screen", "mm").contains("100 rays"));
/// ```
pub fn spot_svg(spot: &SpotDiagram, name: &str, unit: &str) -> String {
    let window = Window::new(spot);
    let chart = Chart::new(window.lo, window.hi);
    let mut svg = Svg::default();
    draw_points(spot.points(), &chart, &mut svg);
    let [x0, x1] = [0.0, spot.rms_radius()].map(|x| chart.x.position(x));
    if x1 - x0 > 1.0 {
        svg.circle("circle", chart.position(spot.centroid()), x1 - x0, "");
    }
    let (title, subtitle) = (format!("Spot diagram: {name}"), subtitle(spot, unit, &window));
    chart.draw(&mut svg, [&title, &subtitle], unit);
    let [left, top, width, height] = chart.frame();
    let wavelengths = Wavelengths::new(spot.points().iter().map(|point| point.wavelength_nm));
    let right = (left + width + MARGIN).max(2.0 * MARGIN + 6.0 * subtitle.chars().count() as f64);
    let bottom = legend::draw(&mut svg, &wavelengths.entries(), top + height + BELOW + 4.0, right);
    svg.finish([right, bottom], &title, &subtitle, STYLE)
}

fn subtitle(spot: &SpotDiagram, unit: &str, window: &Window) -> String {
    if spot.count() == 0 {
        return "no light arrives".to_owned();
    }
    let resolution = 1e-3 * (window.hi[0] - window.lo[0]);
    let [x, y] = spot.centroid().map(|coordinate| format_number(coordinate, resolution));
    let radius = format_number(spot.rms_radius(), 1e-4 * spot.rms_radius().max(f64::MIN_POSITIVE));
    let text = format!("{} rays, centroid ({x}, {y}) {unit}, RMS radius {radius} {unit}", spot.count());
    match window.outside > REPORTED {
        true => format!("{text}; {} % of the power beside", format_number(100.0 * window.outside, 1e-2)),
        false => text,
    }
}

impl Window {
    /// A square around all points but faint and distant ones.
    fn new(spot: &SpotDiagram) -> Window {
        let centroid = spot.centroid();
        let distance = |[x, y]: [f64; 2]| (x - centroid[0]).abs().max((y - centroid[1]).abs());
        let mut points: Vec<(f64, f64)> =
            spot.points().iter().map(|point| (distance(point.point), point.power)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = points.iter().map(|point| point.1).sum();
        let mut sum = 0.0;
        let bright = points.iter().find(|point| {
            sum += point.1;
            sum >= BRIGHT * total
        });
        let (bright, last) =
            (bright.map_or(0.0, |point| point.0), points.last().map_or(0.0, |point| point.0));
        let is_far = last > FAR * bright && total > 0.0;
        let radius = if is_far { 0.5 * FAR * bright } else { last };
        // a spot of the size of rounding errors is one point
        let around = centroid.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let half = 1.08 * radius.max(1e-9 * around);
        // no point, or one at the origin
        let half = if half > 0.0 { half } else { 1.0 };
        let outside = points.iter().filter(|point| point.0 > half).map(|point| point.1).sum::<f64>();
        let outside = if is_far { outside / total } else { 0.0 };
        Window { lo: centroid.map(|x| x - half), hi: centroid.map(|x| x + half), outside }
    }
}

fn draw_points(points: &[SpotPoint], chart: &Chart, svg: &mut Svg) {
    let mut paths: BTreeMap<String, String> = BTreeMap::new();
    let [left, top, width, height] = chart.frame();
    for &SpotPoint { point, wavelength_nm, .. } in points {
        let [x, y] = chart.position(point);
        let is_outside = x < left || x > left + width || y < top || y > top + height;
        if !is_outside {
            let path = paths.entry(legend::wavelength_paint(wavelength_nm)).or_default();
            // writing to a string cannot fail
            let _ = write!(path, "M{} {}h0", Pixels(x), Pixels(y));
        }
    }
    for (colour, path) in paths {
        svg.path("point", path, &format!(r#" stroke="{colour}""#));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn little_light() {
        let dark = SpotDiagram::default();
        assert!(spot_svg(&dark, "a", "mm").contains("no light arrives"));
        let mut focus = SpotDiagram::default();
        focus.add([0.0; 2], 500.0, 1.0);
        // axes of a legible range
        for diagram in [dark, focus] {
            let window = Window::new(&diagram);
            assert_eq!((window.lo, window.hi), ([-1.0; 2], [1.0; 2]));
        }
    }
}
