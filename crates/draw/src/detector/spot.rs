//! Spot diagrams as SVG.

use super::chart::{BELOW, Chart, LEFT, MARGIN, TOP};
use crate::axis::format_number;
use crate::legend::{self, Entry, Swatch, Wavelengths};
use crate::svg::{Anchor, Pixels, Svg};
use rayweave_optics::detector::{SpotDiagram, SpotPoint};
use rayweave_scene::Unit;
use std::collections::BTreeMap;
use std::fmt::Write;

/// The window of a chart, and the fraction of the power outside it.
struct Window {
    lo: [f64; 2],
    hi: [f64; 2],
    outside: f64,
}

/// Light farther from the centroid than this many times the radius of the bright part is not drawn.
const FAR: f64 = 3.0;
/// The fraction of the power in the bright part.
const BRIGHT: f64 = 0.99;
/// The minimum fraction of the power outside the window that the subtitle reports.
const REPORTED: f64 = 5e-5;

/// The length of an axis where several diagrams are drawn side by side, their columns, and the height of the title above.
const PANEL: f64 = 300.0;
const MAX_COLUMNS: usize = 3;
const HEADING: f64 = 30.0;

const STYLE: &str = "\
.point { fill: none; stroke-linecap: round; stroke-width: 2.4; stroke-opacity: 0.7 }
.circle { fill: none; stroke: #1d2733; stroke-width: 1; stroke-dasharray: 5 4 }
.airy { fill: none; stroke: #1d2733; stroke-width: 0.8 }
@media (prefers-color-scheme: dark) { .circle, .airy { stroke: #e4e9ee } }
";

/// Draws a spot diagram: the points in the coordinates of the detector, coloured by wavelength, and a circle with the RMS radius
/// about the centroid. Faint and distant ghosts lie outside the chart. `unit` is the unit of length.
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
    let window = Window::around(spot, half_width(spot));
    let chart = Chart::new(window.lo, window.hi);
    let mut svg = Svg::default();
    let (title, subtitle) = (format!("Spot diagram: {name}"), subtitle(spot, unit, (1.0, unit), &window));
    draw_spot(spot, &chart, [&title, &subtitle], &Scale::of(unit), &mut svg);
    let [left, top, width, height] = chart.frame();
    let wavelengths = Wavelengths::new(spot.points().iter().map(|point| point.wavelength_nm));
    let right = (left + width + MARGIN).max(extent(&subtitle));
    let entries = entries(&wavelengths, false);
    let bottom = legend::draw(&mut svg, &entries, top + height + BELOW + 4.0, right);
    svg.finish([right, bottom], &title, &subtitle, STYLE)
}

/// Draws spot diagrams of one detector side by side, for example one for each field of a lens. All have the same scale; each is
/// centred at its own centroid, from which the axes count, with its own RMS radius as a dashed circle. `spots` are names and
/// diagrams; `unit` is the unit of length, in place of which spots are in micrometres if it is one of [`Unit`]. `airy_radius` is the
/// radius of the first dark ring of a lens without aberrations, drawn in each of them.
///
/// ```
/// use rayweave_draw::detector::spots_svg;
/// use rayweave_optics::detector::SpotDiagram;
///
/// let mut spots = [SpotDiagram::default(), SpotDiagram::default()];
/// (0..100).for_each(|k| spots[k % 2].add([(k % 10) as f64, 0.1 * (k / 10) as f64], 550.0, 1.0));
/// let drawing = spots_svg(&[("axis", &spots[0]), ("rim", &spots[1])], "image", "mm", None);
/// assert_eq!(drawing.matches("50 rays, ").count(), 2);
/// ```
pub fn spots_svg(spots: &[(&str, &SpotDiagram)], name: &str, unit: &str, airy_radius: Option<f64>) -> String {
    let half = spots.iter().map(|(_, spot)| half_width(spot)).fold(0.0, f64::max);
    let half = half.max(1.08 * airy_radius.unwrap_or(0.0));
    let (scale, given) = Scale::small(unit);
    let panel = |&(title, spot)| Panel::new(title, spot, half, (&scale, unit, given));
    let panels: Vec<Panel<'_>> = spots.iter().map(panel).collect();
    let texts = panels.iter().map(|panel| extent(&panel.subtitle));
    let [width, height] = [texts.fold(LEFT + PANEL + MARGIN, f64::max), TOP + PANEL + BELOW];
    let columns = panels.len().clamp(1, MAX_COLUMNS);
    let mut svg = Svg::default();
    let (title, text) =
        (format!("Spot diagrams: {name}"), format!("{} spots at the same scale", panels.len()));
    svg.text("title", [MARGIN, 30.0], Anchor::Start, &title, &title);
    for (k, Panel { title, subtitle, spot, window }) in panels.iter().enumerate() {
        let corner = [width * (k % columns) as f64, HEADING + height * (k / columns) as f64];
        let own = Scale { centre: spot.centroid(), ..scale.clone() };
        let chart = Chart::at(corner, PANEL, own.place(window.lo), own.place(window.hi));
        draw_spot(spot, &chart, [title, subtitle], &own, &mut svg);
        if let Some(radius) = airy_radius {
            svg.circle(
                "airy",
                chart.position([0.0; 2]),
                chart.x.position(own.factor * radius) - chart.x.position(0.0),
                "",
            );
        }
    }
    let points = spots.iter().flat_map(|(_, spot)| spot.points());
    let wavelengths = Wavelengths::new(points.map(|point| point.wavelength_nm));
    let (right, bottom) = (width * columns as f64, HEADING + height * panels.len().div_ceil(columns) as f64);
    let bottom = legend::draw(&mut svg, &entries(&wavelengths, airy_radius.is_some()), bottom + 4.0, right);
    svg.finish([right, bottom], &title, &text, STYLE)
}

/// The entries of the legend: wavelengths and circles.
fn entries(wavelengths: &Wavelengths, has_airy: bool) -> Vec<Entry> {
    let circle = |name: &str, class| Entry {
        name: name.to_owned(),
        colour: String::new(),
        swatch: Swatch::Circle(class),
    };
    let mut entries = wavelengths.entries();
    entries.push(circle("RMS radius", "circle"));
    entries.extend(has_airy.then(|| circle("Airy disk on the axis", "airy")));
    entries
}

/// The coordinates of a chart: distances from a point, in a unit of their own.
#[derive(Clone)]
struct Scale {
    centre: [f64; 2],
    factor: f64,
    unit: String,
}

impl Scale {
    /// The coordinates of the detector.
    fn of(unit: &str) -> Scale {
        Scale { centre: [0.0; 2], factor: 1.0, unit: unit.to_owned() }
    }

    /// Micrometres, and their factor, in place of a unit of [`Unit`]; any other unit stays.
    fn small(unit: &str) -> (Scale, f64) {
        Unit::parse(unit).map_or((Scale::of(unit), 1.0), |known| {
            let factor = known.metres() * 1e6;
            (Scale { centre: [0.0; 2], factor, unit: "\u{b5}m".to_owned() }, factor)
        })
    }

    fn place(&self, point: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| self.factor * (point[k] - self.centre[k]))
    }
}

/// One of several spot diagrams.
struct Panel<'a> {
    title: &'a str,
    subtitle: String,
    spot: &'a SpotDiagram,
    window: Window,
}

impl<'a> Panel<'a> {
    fn new(
        title: &'a str,
        spot: &'a SpotDiagram,
        half: f64,
        (scale, unit, factor): (&Scale, &str, f64),
    ) -> Panel<'a> {
        let window = Window::around(spot, half);
        let radius = (factor, scale.unit.as_str());
        Panel { title, subtitle: subtitle(spot, unit, radius, &window), spot, window }
    }
}

/// Draws points, the circle of the RMS radius, and axes.
fn draw_spot(spot: &SpotDiagram, chart: &Chart, titles: [&str; 2], scale: &Scale, svg: &mut Svg) {
    draw_points(spot.points(), chart, scale, svg);
    let [x0, x1] = [0.0, scale.factor * spot.rms_radius()].map(|x| chart.x.position(x));
    if x1 - x0 > 1.0 {
        svg.circle("circle", chart.position(scale.place(spot.centroid())), x1 - x0, "");
    }
    chart.draw(svg, titles, &scale.unit);
}

/// The width of a subtitle with its margins.
fn extent(subtitle: &str) -> f64 {
    2.0 * MARGIN + 6.0 * subtitle.chars().count() as f64
}

/// The number of rays, the centroid, and the RMS radius, by a factor in a unit of its own.
fn subtitle(spot: &SpotDiagram, unit: &str, (factor, small): (f64, &str), window: &Window) -> String {
    if spot.count() == 0 {
        return "no light arrives".to_owned();
    }
    let resolution = 1e-3 * (window.hi[0] - window.lo[0]);
    let [x, y] = spot.centroid().map(|coordinate| format_number(coordinate, resolution));
    let radius = factor * spot.rms_radius();
    let radius = format_number(radius, 1e-4 * radius.max(f64::MIN_POSITIVE));
    let text = format!("{} rays, centroid ({x}, {y}) {unit}, RMS radius {radius} {small}", spot.count());
    match window.outside > REPORTED {
        true => format!("{text}; {} % of the power outside", format_number(100.0 * window.outside, 1e-2)),
        false => text,
    }
}

/// Half the width of a square around the centroid that contains all points except faint and distant ones.
fn half_width(spot: &SpotDiagram) -> f64 {
    let centroid = spot.centroid();
    let mut points: Vec<(f64, f64)> =
        spot.points().iter().map(|point| (distance(point.point, centroid), point.power)).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = points.iter().map(|point| point.1).sum();
    let mut sum = 0.0;
    let bright = points.iter().find(|point| {
        sum += point.1;
        sum >= BRIGHT * total
    });
    let (bright, last) = (bright.map_or(0.0, |point| point.0), points.last().map_or(0.0, |point| point.0));
    let is_far = last > FAR * bright && total > 0.0;
    let radius = if is_far { 0.5 * FAR * bright } else { last };
    // a spot of the size of rounding errors counts as one point
    let around = centroid.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let half = 1.08 * radius.max(1e-9 * around);
    // no points, or a single one at the origin
    if half > 0.0 { half } else { 1.0 }
}

/// The larger of the distances along x and y.
fn distance([x, y]: [f64; 2], centroid: [f64; 2]) -> f64 {
    (x - centroid[0]).abs().max((y - centroid[1]).abs())
}

impl Window {
    /// A square about the centroid.
    fn around(spot: &SpotDiagram, half: f64) -> Window {
        let centroid = spot.centroid();
        let total: f64 = spot.points().iter().map(|point| point.power).sum();
        let beside = spot.points().iter().filter(|point| distance(point.point, centroid) > half);
        let outside = beside.map(|point| point.power).sum::<f64>();
        let outside = if total > 0.0 { outside / total } else { 0.0 };
        Window { lo: centroid.map(|x| x - half), hi: centroid.map(|x| x + half), outside }
    }
}

/// Layers of points: each has all colours, so that no colour hides the others.
const LAYERS: usize = 8;

fn draw_points(points: &[SpotPoint], chart: &Chart, scale: &Scale, svg: &mut Svg) {
    let mut colours: BTreeMap<String, (usize, [String; LAYERS])> = BTreeMap::new();
    let [left, top, width, height] = chart.frame();
    for &SpotPoint { point, wavelength_nm, .. } in points {
        let [x, y] = chart.position(scale.place(point));
        let is_outside = x < left || x > left + width || y < top || y > top + height;
        if !is_outside {
            let (count, layers) = colours.entry(legend::wavelength_paint(wavelength_nm)).or_default();
            // writing to a string cannot fail
            let _ = write!(layers[*count % LAYERS], "M{} {}h0", Pixels(x), Pixels(y));
            *count += 1;
        }
    }
    for layer in 0..LAYERS {
        for (colour, (_, layers)) in &mut colours {
            let path = std::mem::take(&mut layers[layer]);
            if !path.is_empty() {
                svg.path("point", path, &format!(r#" stroke="{colour}""#));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diagrams_side_by_side_have_one_scale() {
        let mut spots = [SpotDiagram::default(), SpotDiagram::default(), SpotDiagram::default()];
        for k in 0..4 {
            let angle = f64::from(k) * std::f64::consts::FRAC_PI_2;
            let point = |size: f64, x: f64| [x + size * angle.cos(), size * angle.sin()];
            spots[0].add(point(1.0, 0.0), 550.0, 1.0);
            spots[1].add(point(4.0, 100.0), 550.0, 1.0);
        }
        let named: Vec<(&str, &SpotDiagram)> = ["a", "b", "c"].into_iter().zip(&spots).collect();
        let drawing = spots_svg(&named, "image", "mm", None);
        assert!(drawing.contains("centroid (0, 0) mm, RMS radius 1000 \u{b5}m"), "{drawing}");
        assert!(drawing.contains("centroid (100, 0) mm, RMS radius 4000 \u{b5}m"), "{drawing}");
        // the axes count from the centroid
        assert!(drawing.contains(">x / \u{b5}m<") && !drawing.contains(">100<"), "{drawing}");
        assert!(drawing.contains("no light arrives"), "{drawing}");
        // the radii of the circles in pixels
        let radii: Vec<f64> = drawing
            .split(" r=\"")
            .skip(1)
            .map(|text| text[..text.find('"').unwrap()].parse().unwrap())
            .collect();
        // the last one is in the legend
        assert_eq!(radii.len(), 3, "{drawing}");
        assert!((radii[1] / radii[0] - 4.0).abs() < 0.05, "{radii:?}");
        // the Airy disk in every diagram, and in the legend
        let drawing = spots_svg(&named, "image", "mm", Some(2.0));
        assert_eq!(drawing.matches("class=\"airy\"").count(), 4, "{drawing}");
        assert!(drawing.contains(">Airy disk on the axis<"), "{drawing}");
    }

    #[test]
    fn no_colour_hides_another() {
        let mut spot = SpotDiagram::default();
        for line in [486.1, 587.6, 656.3] {
            (0..80).for_each(|k| spot.add([0.01 * f64::from(k), 0.0], line, 1.0));
        }
        let drawing = spot_svg(&spot, "image", "mm");
        let colours: Vec<&str> = drawing
            .split("class=\"point\"")
            .skip(1)
            .map(|path| path.split_once("stroke=\"").unwrap().1.split('"').next().unwrap())
            .collect();
        // in every layer, ten points of each colour
        assert_eq!(colours.len(), 3 * LAYERS, "{drawing}");
        assert!(colours.chunks(3).all(|layer| layer == &colours[..3] && layer[0] != layer[2]));
    }

    #[test]
    fn little_light() {
        let dark = SpotDiagram::default();
        assert!(spot_svg(&dark, "a", "mm").contains("no light arrives"));
        let mut focus = SpotDiagram::default();
        focus.add([0.0; 2], 500.0, 1.0);
        // axes with a legible range
        for diagram in [dark, focus] {
            let window = Window::around(&diagram, half_width(&diagram));
            assert_eq!((window.lo, window.hi), ([-1.0; 2], [1.0; 2]));
        }
    }
}
