//! A layout as SVG.

use super::{FAINTEST, OpticalLayout, Part, RayColour};
use crate::axis::Axis;
use crate::legend::{self, Entry, Swatch, Wavelengths};
use crate::plan::Plan;
use crate::svg::{Anchor, Pixels, Svg, paint};
use rayweave_math::Vec3;
use rayweave_optics::{Event, Segment, Segments};
use rayweave_render::{PALETTE, Rgba};
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write;

/// The width of the drawing, and the maximum height of the section.
const WIDTH: f64 = 960.0;
const MAX_HEIGHT: f64 = 620.0;
const MARGIN: f64 = 24.0;
const TITLE: f64 = 46.0;
/// The width of the numbers of an axis.
const NUMBERS: f64 = 76.0;
/// The heights of the scale bar and of a row of the legend.
const BAR: f64 = 34.0;
const ROW: f64 = 20.0;

const STYLE: &str = "\
.glass { stroke: none; fill-rule: evenodd }
.outline { fill: none; stroke: #3a556e; stroke-width: 1; stroke-linejoin: round }
.sheet { fill: none; stroke: #1d2733; stroke-width: 2.2; stroke-linecap: round }
.ray { fill: none; stroke-linecap: round; stroke-linejoin: round }
.mark { fill: none; stroke: #c0392b; stroke-width: 1.2 }
.centre { fill: none; stroke: #8d97a3; stroke-width: 0.8; stroke-dasharray: 14 4 2 4 }
@media (prefers-color-scheme: dark) {
.glass { fill-opacity: 0.35 }
.outline { stroke: #9db4c8 }
.sheet { stroke: #e4e9ee }
}
";

/// Fills of media in the order of their appearance, light enough for rays of any colour to be visible.
const MEDIA: [&str; 7] = ["#cfe4f4", "#f6e4c8", "#d3ecd6", "#e6d9ee", "#f7d9d4", "#d2eeea", "#ecebc4"];
/// The fill of opaque regions.
const OPAQUE: &str = "#b9c0c8";
/// The fill of sensors.
const SENSOR: &str = "#f0b84a";

/// The number of segments above which lines of dense light are thinner.
const DENSE: f64 = 150.0;

/// The colour of marks.
const MARK: &str = "#c0392b";

/// The sine of the angle between chord and direction below which a segment is straight.
const STRAIGHT: f64 = 1e-6;

/// Minimum fraction of the initial power, width and opacity of rays.
const WEIGHTS: [(f64, f64, f64); 4] =
    [(0.3, 1.1, 0.9), (0.03, 0.8, 0.75), (3e-3, 0.6, 0.55), (0.0, 0.45, 0.4)];

pub fn drawing(layout: &OpticalLayout, title: &str, unit: &str) -> String {
    let mut pen = Drawing::new(layout);
    pen.svg.text("title", [MARGIN, MARGIN + 8.0], Anchor::Start, title, title);
    let plane = format!("section {}", layout.plane);
    pen.svg.text("tick", [WIDTH - MARGIN, MARGIN + 8.0], Anchor::End, &plane, &plane);
    pen.centre_line();
    let media = media(&layout.parts);
    layout.parts.iter().for_each(|part| pen.fill(part, &media));
    layout.parts.iter().for_each(|part| pen.outline(part));
    pen.rays();
    pen.marks();
    layout.sheets.iter().for_each(|line| pen.line("sheet", line, false));
    pen.stop();
    pen.axes(unit);
    let height = pen.legend(&media);
    pen.svg.finish([WIDTH, height], title, &description(layout), STYLE)
}

fn description(layout: &OpticalLayout) -> String {
    let names: Vec<&str> = layout.parts.iter().map(|part| part.name.as_str()).collect();
    format!("The section {} of {}, with rays of light.", layout.plane, names.join(", "))
}

/// The media in the section with their fills, in the order of the parts.
fn media(parts: &[Part]) -> Vec<(&str, &'static str)> {
    let mut found: Vec<(&str, &'static str)> = Vec::new();
    for name in parts
        .iter()
        .filter(|part| !part.contours.is_empty() && !part.is_sensor)
        .filter_map(|part| part.medium.as_deref())
    {
        if found.iter().all(|(known, _)| *known != name) {
            found.push((name, MEDIA[found.len() % MEDIA.len()]));
        }
    }
    found
}

struct Drawing<'a> {
    layout: &'a OpticalLayout,
    svg: Svg,
    plan: Plan,
}

impl<'a> Drawing<'a> {
    fn new(layout: &'a OpticalLayout) -> Drawing<'a> {
        // dense light has axes with numbers
        let left = if layout.is_dense { NUMBERS } else { MARGIN };
        let frame = [left, TITLE, WIDTH - left - MARGIN, MAX_HEIGHT];
        Drawing { layout, svg: Svg::default(), plan: Plan::new(layout.lo, layout.hi, frame) }
    }

    /// Draws the line v = 0, if it is in the window.
    fn centre_line(&mut self) {
        let OpticalLayout { lo, hi, .. } = self.layout;
        if lo[1] < 0.0 && 0.0 < hi[1] {
            let [x, y] = self.plan.position([lo[0], 0.0]).map(Pixels);
            let end = Pixels(self.plan.position([hi[0], 0.0])[0]);
            self.svg.path("centre", format_args!("M{x} {y}H{end}"), "");
        }
    }

    fn fill(&mut self, part: &Part, media: &[(&str, &'static str)]) {
        let own = media.iter().find(|(name, _)| part.medium.as_deref() == Some(name));
        let fill = if part.is_sensor { SENSOR } else { own.map_or(OPAQUE, |(_, fill)| fill) };
        let path: String = part.contours.iter().map(|contour| self.plan.path(contour, true)).collect();
        if !path.is_empty() {
            self.svg.path("glass", path, &format!(r#" fill="{fill}""#));
        }
    }

    fn outline(&mut self, part: &Part) {
        part.contours.iter().for_each(|contour| self.line("outline", contour, true));
    }

    fn line(&mut self, class: &str, points: &[[f64; 2]], is_closed: bool) {
        let path = self.plan.path(points, is_closed);
        self.svg.path(class, path, "");
    }

    fn rays(&mut self) {
        let segments = &self.layout.segments;
        let emitted = emitted(segments);
        let tangents = tangents(segments);
        let thinning = self.thinning();
        let is_behind = behind(segments, self.layout.last);
        let mut paths: BTreeMap<(usize, String, i64), String> = BTreeMap::new();
        for ((segment, tangent), _) in segments.iter().zip(tangents).zip(is_behind).filter(|(_, is)| !is) {
            let part = segment.intensity / emitted.get(&segment.id).copied().unwrap_or(1.0);
            if part < FAINTEST {
                continue;
            }
            let weight = WEIGHTS.iter().position(|(least, ..)| part >= *least).unwrap_or(WEIGHTS.len() - 1);
            let Some([from, to]) = self.visible(&segment) else { continue };
            // one path for each track of dense light, so that the colour is stronger where tracks overlap
            let track = if self.layout.is_dense { segment.id } else { 0 };
            let path = paths.entry((WEIGHTS.len() - weight, self.colour(&segment), track)).or_default();
            let ([x0, y0], [x1, y1]) =
                (self.plan.position(from).map(Pixels), self.plan.position(to).map(Pixels));
            let _ = match tangent.and_then(|tangent| self.control_points(&segment, tangent)) {
                Some([[x2, y2], [x3, y3]]) => write!(path, "M{x0} {y0}C{x2} {y2} {x3} {y3} {x1} {y1}"),
                None => write!(path, "M{x0} {y0}L{x1} {y1}"),
            };
        }
        // faint rays first
        for ((weight, colour, _), path) in paths {
            let (_, width, opacity) = WEIGHTS[WEIGHTS.len() - weight];
            let (width, opacity) = (Pixels(width * thinning), Pixels(opacity * thinning));
            let stroke = format!(r#" stroke="{colour}" stroke-width="{width}" stroke-opacity="{opacity}""#);
            self.svg.path("ray", path, &stroke);
        }
    }

    /// The inner control points of the Bezier curve with the ends and tangents of a curved segment, at a third of the chord
    /// length from the ends; `None` if the segment leaves the window.
    fn control_points(&self, segment: &Segment, tangent: Vec3) -> Option<[[Pixels; 2]; 2]> {
        let OpticalLayout { cut, lo, hi, .. } = self.layout;
        let third = (segment.end - segment.start).length() / 3.0;
        let is_inside = |point: Vec3| {
            cut.place(point).iter().zip(lo.iter().zip(hi)).all(|(x, (lo, hi))| lo <= x && x <= hi)
        };
        let is_whole = is_inside(segment.start) && is_inside(segment.end);
        let inner = [segment.start + third * tangent, segment.end - third * segment.direction];
        is_whole.then(|| inner.map(|point| self.plan.position(cut.place(point)).map(Pixels)))
    }

    fn colour(&self, segment: &Segment) -> String {
        match self.layout.colour {
            RayColour::Wavelength => legend::wavelength_paint(segment.wavelength_nm),
            RayColour::Source => paint(source_colour(segment.source)),
        }
    }

    /// The part of a segment in the window.
    fn visible(&self, segment: &Segment) -> Option<[[f64; 2]; 2]> {
        let OpticalLayout { cut, lo, hi, .. } = self.layout;
        let from = cut.place(segment.start);
        let to = match segment.end.is_finite() {
            true => cut.place(segment.end),
            false => {
                let far = 4.0 * (hi[0] - lo[0] + hi[1] - lo[1]) + cut.place(Vec3::ZERO)[0].abs();
                let way = cut.place(segment.start + segment.direction);
                [0, 1].map(|k| from[k] + far * (way[k] - from[k]))
            }
        };
        clipped(from, to, *lo, *hi)
    }

    /// The factor of the width and the opacity of rays: lines of dense light get thinner as their number grows.
    fn thinning(&self) -> f64 {
        match self.layout.is_dense {
            true => (DENSE / self.layout.segments.len().max(1) as f64).sqrt().clamp(0.35, 1.0),
            false => 1.0,
        }
    }

    fn marks(&mut self) {
        let OpticalLayout { lo, hi, marks, .. } = self.layout;
        for &point in marks.iter().flat_map(|(_, points)| points) {
            if (0..2).all(|k| lo[k] <= point[k] && point[k] <= hi[k]) {
                self.svg.circle("mark", self.plan.position(point), 3.0, "");
            }
        }
    }

    fn stop(&mut self) {
        for edge in &self.layout.stop {
            self.line("sheet", edge, false);
        }
        let highest = self.layout.stop.iter().flatten().max_by(|a, b| a[1].total_cmp(&b[1]));
        if let Some(&end) = highest {
            let [x, y] = self.plan.position(end);
            self.svg.text("tick", [x, y - 6.0], Anchor::Middle, "stop", "stop");
        }
    }

    /// The height of the scale bar and the axes. The section of dense light fills the window down to its lower edge.
    fn bar(&self) -> f64 {
        if self.layout.is_dense { BAR + 14.0 } else { BAR }
    }

    /// Draws the axes and the scale bar in the lower right corner: around dense light with numbers, or else in the lower left corner.
    fn axes(&mut self, unit: &str) {
        let y = self.plan.bottom + self.bar() - 4.0;
        match self.layout.is_dense {
            true => self.numbered_axes(unit),
            false => Plan::axes(&mut self.svg, [MARGIN + 4.0, y], self.layout.plane.axis_names()),
        }
        self.plan.scale_bar(&mut self.svg, [WIDTH - MARGIN, y], WIDTH, unit);
    }

    /// Draws a frame with ticks and numbers.
    fn numbered_axes(&mut self, unit: &str) {
        let OpticalLayout { lo, hi, .. } = *self.layout;
        let ([left, bottom], [right, top]) = (self.plan.position(lo), self.plan.position(hi));
        let [l, b, r, t] = [left, bottom, right, top].map(Pixels);
        let mut path = format!("M{l} {t}H{r}V{b}H{l}Z");
        let across = Axis { min: lo[0], max: hi[0], start: left, end: right };
        // writing to a string cannot fail
        for (value, text) in across.ticks(((right - left) / 90.0).max(1.0)) {
            let x = across.position(value);
            let _ = write!(path, "M{} {b}v5", Pixels(x));
            self.svg.text("tick", [x, bottom + 18.0], Anchor::Middle, &text, &text);
        }
        let up = Axis { min: lo[1], max: hi[1], start: bottom, end: top };
        for (value, text) in up.ticks(((bottom - top) / 60.0).max(1.0)) {
            let y = up.position(value);
            let _ = write!(path, "M{l} {}h-5", Pixels(y));
            self.svg.text("tick", [left - 8.0, y + 4.0], Anchor::End, &text, &text);
        }
        self.svg.path("axis", path, "");
        let [name, other] = self.layout.plane.axis_names().map(|name| format!("{name} / {unit}"));
        self.svg.text("tick", [0.5 * (left + right), bottom + 36.0], Anchor::Middle, &name, &name);
        self.svg.middle_text("tick", [left - NUMBERS + 18.0, 0.5 * (top + bottom)], -90.0, &other);
    }

    /// Draws media and light with their colours. Returns the height of the whole drawing.
    fn legend(&mut self, media: &[(&str, &'static str)]) -> f64 {
        let patch = |name: &str, colour: &str| Entry {
            name: name.to_owned(),
            colour: colour.to_owned(),
            swatch: Swatch::Area,
        };
        let mut entries: Vec<Entry> = media.iter().map(|(name, fill)| patch(name, fill)).collect();
        let has = |wanted: &dyn Fn(&Part) -> bool| {
            self.layout.parts.iter().any(|part| !part.contours.is_empty() && wanted(part))
        };
        let is_opaque = |part: &Part| part.medium.is_none() && !part.is_sensor;
        entries.extend(has(&is_opaque).then(|| patch("opaque", OPAQUE)));
        entries.extend(has(&|part| part.is_sensor).then(|| patch("sensor", SENSOR)));
        entries.extend(match self.layout.colour {
            RayColour::Wavelength => {
                Wavelengths::new(self.layout.segments.wavelength_nm.iter().copied()).entries()
            }
            RayColour::Source => sources(self.layout),
        });
        entries.extend(self.layout.marks.iter().map(|(name, points)| Entry {
            name: format!("{name}: {}", points.len()),
            colour: MARK.to_owned(),
            swatch: Swatch::Mark,
        }));
        let top = self.plan.bottom + self.bar() + ROW;
        legend::draw(&mut self.svg, &entries, top, WIDTH)
    }
}

/// The initial power of each ray.
fn emitted(segments: &Segments) -> HashMap<i64, f64> {
    let first = segments.iter().filter(|segment| segment.parent < 0);
    first.map(|segment| (segment.id, segment.intensity)).collect()
}

/// The direction at the start of every curved segment: that at the end of the previous segment or, where the curve begins,
/// that of the parabola given by the ends of the segment and the direction at its end. `None` for straight segments.
fn tangents(segments: &Segments) -> Vec<Option<Vec3>> {
    let rows: Vec<Segment> = segments.iter().collect();
    let before = |row: &Segment| usize::try_from(row.parent).ok().and_then(|parent| rows.get(parent));
    let tangent = |row: &Segment| {
        let chord = (row.end - row.start).try_normalize()?;
        if chord.cross(row.direction).length() <= STRAIGHT {
            return None;
        }
        match before(row).filter(|before| before.event == Event::Curved) {
            Some(before) => Some(before.direction),
            None => (2.0 * chord.dot(row.direction) * chord - row.direction).try_normalize(),
        }
    };
    rows.iter().map(tangent).collect()
}

/// Whether each segment is one of light that has met an element before.
fn behind(segments: &Segments, element: Option<usize>) -> Vec<bool> {
    let Some(element) = element.and_then(|element| i32::try_from(element).ok()) else {
        return vec![false; segments.len()];
    };
    let mut found = Vec::with_capacity(segments.len());
    for segment in segments.iter() {
        let parent = usize::try_from(segment.parent).ok().filter(|&parent| parent < found.len());
        found.push(parent.is_some_and(|parent| found[parent] || segments.element[parent] == element));
    }
    found
}

/// Sources with their colours: all of them if they have names, otherwise the first ones, whose colours are distinct.
fn sources(layout: &OpticalLayout) -> Vec<Entry> {
    let entry =
        |(k, name): (u32, String)| Entry { name, colour: paint(source_colour(k)), swatch: Swatch::Line };
    if layout.source_names.is_empty() {
        let names = (0..layout.sources.min(5) as u32).map(|k| (k, format!("source {k}")));
        return names.map(entry).collect();
    }
    (0..).zip(layout.source_names.iter().cloned()).map(entry).collect()
}

fn source_colour(source: u32) -> Rgba {
    // the palette without yellow, the darkest first
    let colours = [PALETTE[5], PALETTE[2], PALETTE[3], PALETTE[1], PALETTE[0]];
    colours[source as usize % colours.len()]
}

/// Clips a line to a rectangle (Y.-D. Liang and B. A. Barsky, ACM Transactions on Graphics 3, 1, 1984).
fn clipped(from: [f64; 2], to: [f64; 2], lo: [f64; 2], hi: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let (mut begin, mut end) = (0.0_f64, 1.0_f64);
    for k in 0..2 {
        let step = to[k] - from[k];
        if step == 0.0 {
            if from[k] < lo[k] || from[k] > hi[k] {
                return None;
            }
            continue;
        }
        let ends = [(lo[k] - from[k]) / step, (hi[k] - from[k]) / step];
        begin = begin.max(ends[0].min(ends[1]));
        end = end.min(ends[0].max(ends[1]));
    }
    let at = |t: f64| [0, 1].map(|k| from[k] + t * (to[k] - from[k]));
    (begin < end).then(|| [at(begin), at(end)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_at_the_window() {
        let clip = |from, to| clipped(from, to, [0.0, 0.0], [10.0, 5.0]);
        assert_eq!(clip([-5.0, 1.0], [15.0, 1.0]), Some([[0.0, 1.0], [10.0, 1.0]]));
        assert_eq!(clip([2.0, 2.0], [2.0, 9.0]), Some([[2.0, 2.0], [2.0, 5.0]]));
        assert_eq!(clip([1.0, 1.0], [3.0, 4.0]), Some([[1.0, 1.0], [3.0, 4.0]]));
        assert_eq!(clip([-5.0, 1.0], [-1.0, 1.0]), None);
        assert_eq!(clip([0.0, 9.0], [9.0, 9.0]), None);
        assert_eq!(clip([-4.0, 4.0], [1.0, 14.0]), None);
    }

    /// Rays in a gradient-index rod are sines (Born & Wolf, 7th edition, section 3.2). The cubic curves of the drawing follow them
    /// ten times more closely than chords.
    #[test]
    fn rays_in_a_gradient_are_drawn_as_curves() {
        let g = 0.3;
        let place = |z: f64| Vec3::new((g * z).cos(), 0.0, z);
        let slope = |z: f64| Vec3::new(-g * (g * z).sin(), 0.0, 1.0).normalize();
        let mut segments = Segments::default();
        for k in 0..3 {
            let (from, to) = (2.0 * f64::from(k), 2.0 * f64::from(k) + 2.0);
            segments.push(Segment {
                id: 0,
                parent: i64::from(k) - 1,
                generation: 0,
                source: 0,
                wavelength_nm: 500.0,
                intensity: 1.0,
                index: 1.5,
                start: place(from),
                end: place(to),
                direction: slope(to),
                path: 0.0,
                element: -1,
                surface: -1,
                event: Event::Curved,
            });
        }
        for (segment, tangent) in segments.iter().zip(tangents(&segments)) {
            let tangent = tangent.unwrap();
            let third = (segment.end - segment.start).length() / 3.0;
            let (b, c) = (segment.start + third * tangent, segment.end - third * segment.direction);
            let middle = (segment.start + 3.0 * b + 3.0 * c + segment.end) / 8.0;
            let off = (middle.x - place(middle.z).x).abs();
            let chord = 0.5 * (segment.start + segment.end);
            assert!(off < 0.1 * (chord.x - place(chord.z).x).abs(), "{off}");
        }
        let straight = Segment {
            end: Vec3::Z,
            start: Vec3::ZERO,
            direction: Vec3::Z,
            ..segments.iter().next().unwrap()
        };
        let mut alone = Segments::default();
        alone.push(straight);
        assert_eq!(tangents(&alone), [None]);
    }
}
