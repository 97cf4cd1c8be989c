//! Cross-sections as SVG.

use super::{bores, hatch};
use crate::dimension;
use crate::legend::{self, Entry, Swatch};
use crate::plan::Plan;
use crate::svg::{Anchor, Svg};
use rayweave_analysis::features::CylindricalFace;
use rayweave_analysis::section::{CrossSection, SectionPart, SectionPlane};
use rayweave_math::Vec3;
use rayweave_scene::Colour;

/// The width of the drawing, and the maximum height of a single section.
const WIDTH: f64 = 960.0;
const MAX_HEIGHT: f64 = 640.0;
const MARGIN: f64 = 24.0;
const TITLE: f64 = 46.0;
/// The heights of the scale bar and of a row of the legend.
const BAR: f64 = 34.0;
const ROW: f64 = 20.0;
/// The approximate widths of a character of titles and of notes.
const LETTER: f64 = 8.0;
const NOTE: f64 = 6.2;
/// The height of the name of a plane below its panel.
const LABEL: f64 = 24.0;

/// The maximum number of planes of a stack that are drawn.
const MAX_PANELS: usize = 100;

const STYLE: &str = "\
.cut { stroke: none; fill-rule: evenodd }
.hatch { fill: none; stroke: currentColor; stroke-width: 0.6 }
.outline { fill: none; stroke: #1d2733; stroke-width: 1; stroke-linejoin: round }
.centre { fill: none; stroke: #3d6ea8; stroke-width: 0.7; stroke-dasharray: 12 3 2 3 }
.beyond { fill: none; stroke: currentColor; stroke-width: 0.8; stroke-linejoin: round }
@media (prefers-color-scheme: dark) {
.cut { fill-opacity: 0.75 }
.outline { stroke: #e4e9ee }
}
";

/// Additional contents of a drawing of sections.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SectionStyle<'a> {
    /// Hatched cut faces (ISO 128-50), each part in another direction or at another distance; the colours are pale.
    pub hatch: bool,
    /// The names of parts that stay without hatching, as shafts, bolts and other parts that are not cut lengthwise in drawings.
    pub unhatched: &'a [String],
    /// The overall width and height of a single section (ISO 129-1). Stacks have no dimensions.
    pub dimensions: bool,
    /// The cylindrical faces of the model, for the centre lines and diameters of holes that a section with dimensions cuts along their
    /// axes.
    pub cylinders: &'a [CylindricalFace],
}

/// Draws one section, or a stack side by side: parts filled with their colours, a legend and a scale bar. Lengths are in `unit`.
/// Of more than 100 sections, 100 evenly chosen ones are drawn.
pub fn section_svg(sections: &[CrossSection], title: &str, unit: &str) -> String {
    section_drawing(sections, title, unit, SectionStyle::default())
}

/// Draws sections like [`section_svg`], with hatching or dimensions.
pub fn section_drawing(
    sections: &[CrossSection],
    title: &str,
    unit: &str,
    style: SectionStyle<'_>,
) -> String {
    drawing(sections, title, unit, style, Extra::default())
}

/// Draws one section like [`section_drawing`], with lines behind the plane: the visible edges of
/// [`visible_edges`](crate::visible_edges), in the coordinates of the plane.
pub fn section_view(
    section: &CrossSection,
    edges: &[Vec<[f64; 2]>],
    title: &str,
    unit: &str,
    style: SectionStyle<'_>,
) -> String {
    drawing(std::slice::from_ref(section), title, unit, style, Extra { edges, thickness: None })
}

/// Draws one section like [`section_svg`], with the dimension `text` of a thickness between two points of its plane.
pub fn section_with_thickness(
    section: &CrossSection,
    title: &str,
    unit: &str,
    ends: [Vec3; 2],
    text: &str,
) -> String {
    let thickness = section.plane.cut().ok().map(|cut| (ends.map(|end| cut.place(end)), text));
    let extra = Extra { thickness, edges: &[] };
    drawing(std::slice::from_ref(section), title, unit, SectionStyle::default(), extra)
}

/// Contents of a drawing of one section beside its parts.
#[derive(Clone, Copy, Default)]
struct Extra<'a> {
    /// The ends of a chord, with its length.
    thickness: Option<([[f64; 2]; 2], &'a str)>,
    /// The visible edges behind the plane.
    edges: &'a [Vec<[f64; 2]>],
}

fn drawing(
    sections: &[CrossSection],
    title: &str,
    unit: &str,
    style: SectionStyle<'_>,
    Extra { thickness, edges }: Extra<'_>,
) -> String {
    let shown = chosen(sections);
    let mut svg = Svg::default();
    let note = match (sections, shown.len()) {
        ([only], _) => only.plane.short((only.hi[0] - only.lo[0]).max(only.hi[1] - only.lo[1])),
        (all, n) if n < all.len() => format!("{n} of {} planes", all.len()),
        (_, n) => format!("{n} planes"),
    };
    svg.text("tick", [WIDTH - MARGIN, MARGIN + 8.0], Anchor::End, &note, &note);
    // the lines of a long title end before the note, and the drawing begins below them
    let room = WIDTH - 2.0 * MARGIN - NOTE * note.chars().count() as f64 - 12.0;
    let lines = wrapped(title, (room / LETTER).max(20.0) as usize);
    for (k, line) in lines.iter().enumerate() {
        svg.text("title", [MARGIN, MARGIN + 8.0 + ROW * k as f64], Anchor::Start, line, line);
    }
    let top = TITLE + ROW * lines.len().saturating_sub(1) as f64;
    let visible = Visible::new(sections);
    let (lo, hi) = window(sections, visible, edges);
    let has_dimensions = style.dimensions && shown.len() == 1;
    let space = if has_dimensions { dimension::SPACE } else { 0.0 };
    let grid = Grid::new(shown.len(), [hi[0] - lo[0], hi[1] - lo[1]], space, top);
    let plans = shown.iter().enumerate().map(|(k, section)| {
        let plan = Plan::new(lo, hi, grid.frame(k));
        for edge in edges {
            svg.path("beyond", plan.path(edge, false), "");
        }
        draw(&mut svg, &plan, section, visible, style);
        if has_dimensions {
            let [left, top] = plan.position([lo[0], hi[1]]);
            let [right, bottom] = plan.position([hi[0], lo[1]]);
            let [width, height] = [0, 1].map(|k| dimension::value(hi[k] - lo[k], 2.0 * section.tolerance));
            dimension::draw(&mut svg, [left, top, right, bottom], &width, &height);
            if let Ok(cut) = section.plane.cut() {
                bores::draw(&mut svg, &plan, &cut, style.cylinders, section.tolerance);
            }
        }
        if let Some((ends, text)) = thickness {
            dimension::between(&mut svg, ends.map(|end| plan.position(end)), text);
        }
        if shown.len() > 1 {
            let (label, name) = (section.plane.label(), section.plane.to_string());
            svg.text("tick", grid.label(k), Anchor::Middle, &label, &name);
        }
        plan
    });
    let bottom = grid.bottom(plans.last().map_or(top, |plan| plan.bottom)) + space;
    let plan = Plan::new(lo, hi, grid.frame(0));
    if let Some(first) = sections.first() {
        let corner = [MARGIN + 4.0, bottom + BAR - 4.0];
        Plan::axes(&mut svg, corner, first.plane.axis_names());
        for (k, text) in directions(&first.plane).iter().enumerate() {
            svg.text(
                "tick",
                [corner[0] + 56.0, corner[1] - 10.0 + 14.0 * k as f64],
                Anchor::Start,
                text,
                text,
            );
        }
    }
    plan.scale_bar(&mut svg, [WIDTH - MARGIN, bottom + BAR - 4.0], grid.width, unit);
    let height = legend::draw(&mut svg, &entries(sections, visible), bottom + BAR + ROW, WIDTH);
    let description = format!("Cross-sections, each medium in its own colour: {note}.");
    svg.finish([WIDTH, height], title, &description, &[STYLE, dimension::STYLE].concat())
}

/// The directions of the axes of an oblique plane: `u = (0.8, 0, 0.6)`. Those of other planes have the names of the axes of space.
fn directions(plane: &SectionPlane) -> Vec<String> {
    let Ok(cut) = plane.cut() else { return Vec::new() };
    let is_named = |name: &str| ["x", "y", "z"].contains(&name);
    let axes = plane.axis_names().into_iter().zip(cut.axes());
    let text = |(name, axis): (&str, Vec3)| {
        let [x, y, z] = axis.to_array().map(|x| rayweave_math::format_to_resolution(x, 1e-4));
        format!("{name} = ({x}, {y}, {z})")
    };
    axes.filter(|(name, _)| !is_named(name)).map(text).collect()
}

fn chosen(sections: &[CrossSection]) -> Vec<&CrossSection> {
    let count = sections.len().min(MAX_PANELS);
    (0..count).map(|k| &sections[k * sections.len() / count]).collect()
}

/// The corners of all visible parts of all sections, and of lines behind them.
fn window(sections: &[CrossSection], visible: Visible, edges: &[Vec<[f64; 2]>]) -> ([f64; 2], [f64; 2]) {
    let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let parts = sections.iter().flat_map(|section| visible.parts(section));
    let points = parts.flat_map(|part| part.contours.iter().flatten());
    for point in points.chain(edges.iter().flatten()) {
        for k in 0..2 {
            (lo[k], hi[k]) = (lo[k].min(point[k]), hi[k].max(point[k]));
        }
    }
    match (lo[0] < hi[0] && lo[1] < hi[1], sections) {
        (true, _) => (lo, hi),
        (false, [first, ..]) => (first.lo, first.hi),
        (false, []) => ([0.0; 2], [1.0; 2]),
    }
}

/// The choice of the parts that are drawn.
#[derive(Clone, Copy)]
struct Visible {
    /// Whether transparent parts are drawn, which they are only if there are no other parts.
    transparent: bool,
}

impl Visible {
    fn new(sections: &[CrossSection]) -> Visible {
        let opaque = Visible { transparent: false };
        Visible { transparent: !sections.iter().any(|section| opaque.parts(section).next().is_some()) }
    }

    /// The parts that are drawn.
    fn parts(self, section: &CrossSection) -> impl Iterator<Item = &SectionPart> {
        let is_drawn = move |part: &&SectionPart| part.colour.alpha > 0 || self.transparent;
        section.parts.iter().filter(|part| !part.contours.is_empty()).filter(is_drawn)
    }
}

fn draw(svg: &mut Svg, plan: &Plan, section: &CrossSection, visible: Visible, style: SectionStyle<'_>) {
    let path = |part: &SectionPart| -> String {
        part.contours.iter().map(|contour| plan.path(contour, true)).collect()
    };
    let opacity = if style.hatch { r#" fill-opacity="0.3""# } else { "" };
    for part in visible.parts(section) {
        svg.path("cut", path(part), &format!(r#" fill="{}"{opacity}"#, paint(part.colour)));
    }
    let is_hatched = |part: &SectionPart| style.hatch && !style.unhatched.contains(&part.name);
    for (number, part) in visible.parts(section).enumerate().filter(|(_, part)| is_hatched(part)) {
        let place = |contour: &Vec<[f64; 2]>| contour.iter().map(|p| plan.position(*p)).collect();
        svg.path("hatch", hatch::path(&part.contours.iter().map(place).collect::<Vec<_>>(), number), "");
    }
    for part in visible.parts(section) {
        svg.path("outline", path(part), "");
    }
}

/// The legend: the names of the parts in the order of their appearance.
fn entries(sections: &[CrossSection], visible: Visible) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for part in sections.iter().flat_map(|section| visible.parts(section)) {
        if entries.iter().all(|entry| entry.name != part.name) {
            entries.push(Entry { name: part.name.clone(), colour: paint(part.colour), swatch: Swatch::Area });
        }
    }
    entries
}

/// The colour without its opacity: the parts of a section do not overlap.
fn paint(colour: Colour) -> String {
    Colour { alpha: 255, ..colour }.to_string()
}

/// A text in lines of at most this number of characters, divided between words; longer words have a line of their own.
fn wrapped(text: &str, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= most => {
                *line += &format!(" {word}")
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// The arrangement of the panels.
struct Grid {
    columns: usize,
    width: f64,
    height: f64,
    is_one: bool,
    /// The space to the left of a single section.
    space: f64,
    /// The upper end of the first panels.
    top: f64,
}

impl Grid {
    fn new(count: usize, [wide, high]: [f64; 2], space: f64, top: f64) -> Grid {
        let all = count.max(1);
        // all panels together are about as wide as high
        let columns = ((all as f64 * 1.2 * high / wide).sqrt().ceil() as usize).clamp(1, all.min(12));
        let width = (WIDTH - 2.0 * MARGIN) / columns as f64;
        let most = if all == 1 { MAX_HEIGHT } else { width * 1.5 };
        let available = if all == 1 { width - space } else { 0.9 * width };
        Grid { columns, width, height: (available * high / wide).min(most), is_one: all == 1, space, top }
    }

    fn corner(&self, k: usize) -> [f64; 2] {
        let (column, row) = (k % self.columns, k / self.columns);
        [MARGIN + column as f64 * self.width, self.top + row as f64 * (self.height + LABEL)]
    }

    fn frame(&self, k: usize) -> [f64; 4] {
        let [x, y] = self.corner(k);
        let margin = if self.is_one { 0.0 } else { 0.05 * self.width };
        [x + margin + self.space, y, self.width - self.space - 2.0 * margin, self.height]
    }

    fn label(&self, k: usize) -> [f64; 2] {
        let [x, y] = self.corner(k);
        [x + 0.5 * self.width, y + self.height + 0.6 * LABEL]
    }

    /// The lower end of all panels, given that of the last one.
    fn bottom(&self, last: f64) -> f64 {
        if self.is_one { last } else { last + LABEL }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_of_oblique_planes_have_directions() {
        let plane = SectionPlane::new(Vec3::new(5.0, 0.0, 1e4), Vec3::new(3.0, 0.0, -4.0)).unwrap();
        // z x (0.6, 0, -0.8) = (0, 0.6, 0)
        assert_eq!(directions(&plane), ["u = (0, 1, 0)", "v = (0.8, 0, 0.6)"]);
        assert_eq!(directions(&"x=3".parse().unwrap()), [""; 0]);
    }

    #[test]
    fn long_titles_are_divided() {
        let lines = wrapped("the head of the bolt and the plate overlap", 20);
        assert_eq!(lines, ["the head of the bolt", "and the plate", "overlap"]);
        assert_eq!(wrapped("", 20), [""; 0]);
        assert_eq!(
            wrapped("a_very_long_name_of_a_volume and b", 20),
            ["a_very_long_name_of_a_volume", "and b"]
        );
    }
}
