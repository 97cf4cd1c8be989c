//! Cross-sections as a picture.

use super::{CrossSection, SectionPart};
use crate::legend::{self, Entry};
use crate::plan::Plan;
use rayweave_render::svg::{Anchor, Svg};
use rayweave_scene::Colour;

/// The width of the drawing, and the most that one section is high.
const WIDTH: f64 = 960.0;
const MOST_HEIGHT: f64 = 640.0;
const MARGIN: f64 = 24.0;
const TITLE: f64 = 46.0;
/// The scale bar, and below it a row of the legend.
const BAR: f64 = 34.0;
const ROW: f64 = 20.0;
/// The name of a plane below its panel.
const LABEL: f64 = 24.0;

/// The most planes of a stack that are drawn.
const MOST_PANELS: usize = 100;

const STYLE: &str = "\
.cut { stroke: none; fill-rule: evenodd }
.outline { fill: none; stroke: #1d2733; stroke-width: 1; stroke-linejoin: round }
@media (prefers-color-scheme: dark) {
.cut { fill-opacity: 0.75 }
.outline { stroke: #e4e9ee }
}
";

/// One section, or those of a stack side by side; of more than [`MOST_PANELS`] as many are drawn, evenly chosen.
pub fn drawing(sections: &[CrossSection], title: &str, unit: &str) -> String {
    let shown = chosen(sections);
    let mut svg = Svg::default();
    svg.text("title", [MARGIN, MARGIN + 8.0], Anchor::Start, title, title);
    let note = match (sections, shown.len()) {
        ([only], _) => only.plane.to_string(),
        (all, n) if n < all.len() => format!("{n} of {} planes", all.len()),
        (_, n) => format!("{n} planes"),
    };
    svg.text("tick", [WIDTH - MARGIN, MARGIN + 8.0], Anchor::End, &note, &note);
    let choice = Choice::new(sections);
    let (lo, hi) = window(sections, choice);
    let grid = Grid::new(shown.len(), hi[0] - lo[0], hi[1] - lo[1]);
    let plans = shown.iter().enumerate().map(|(k, section)| {
        let plan = Plan::new(lo, hi, grid.frame(k));
        draw(&mut svg, &plan, section, choice);
        if shown.len() > 1 {
            let (label, name) = (section.plane.label(), section.plane.to_string());
            svg.text("tick", grid.label(k), Anchor::Middle, &label, &name);
        }
        plan
    });
    let bottom = grid.bottom(plans.last().map_or(TITLE, |plan| plan.bottom));
    let plan = Plan::new(lo, hi, grid.frame(0));
    if let Some(first) = sections.first() {
        Plan::axes(&mut svg, [MARGIN + 4.0, bottom + BAR - 4.0], first.plane.axis_names());
    }
    plan.scale_bar(&mut svg, [WIDTH - MARGIN, bottom + BAR - 4.0], grid.width, unit);
    let height = legend::draw(&mut svg, &entries(sections, choice), bottom + BAR + ROW, WIDTH);
    let description = format!("Cross-sections, each medium in its own colour: {note}.");
    svg.finish([WIDTH, height], title, &description, STYLE)
}

fn chosen(sections: &[CrossSection]) -> Vec<&CrossSection> {
    let count = sections.len().min(MOST_PANELS);
    (0..count).map(|k| &sections[k * sections.len() / count]).collect()
}

/// The corners of what is cut in any of the sections.
fn window(sections: &[CrossSection], choice: Choice) -> ([f64; 2], [f64; 2]) {
    let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let parts = sections.iter().flat_map(|section| choice.of(section));
    for point in parts.flat_map(|part| part.contours.iter().flatten()) {
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

/// What of the sections is drawn.
#[derive(Clone, Copy)]
struct Choice {
    /// What is clear, too: so if there is nothing else.
    clear: bool,
}

impl Choice {
    fn new(sections: &[CrossSection]) -> Choice {
        let seen = Choice { clear: false };
        Choice { clear: !sections.iter().any(|section| seen.of(section).next().is_some()) }
    }

    /// The parts that are drawn: what is clear is not, so that what is in it shows.
    fn of(self, section: &CrossSection) -> impl Iterator<Item = &SectionPart> {
        let is_drawn = move |part: &&SectionPart| part.colour.alpha > 0 || self.clear;
        section.parts.iter().filter(|part| !part.contours.is_empty()).filter(is_drawn)
    }
}

fn draw(svg: &mut Svg, plan: &Plan, section: &CrossSection, choice: Choice) {
    let path = |part: &SectionPart| -> String {
        part.contours.iter().map(|contour| plan.path(contour, true)).collect()
    };
    for part in choice.of(section) {
        svg.path("cut", path(part), &format!(r#" fill="{}""#, paint(part.colour)));
    }
    for part in choice.of(section) {
        svg.path("outline", path(part), "");
    }
}

/// What each colour means, in the order in which they are met.
fn entries(sections: &[CrossSection], choice: Choice) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for part in sections.iter().flat_map(|section| choice.of(section)) {
        if entries.iter().all(|entry| entry.name != part.name) {
            entries.push(Entry { name: part.name.clone(), colour: paint(part.colour), is_line: false });
        }
    }
    entries
}

/// Opaque: regions do not lie over each other in a section.
fn paint(colour: Colour) -> String {
    Colour { alpha: 255, ..colour }.to_string()
}

/// Where the panels are.
struct Grid {
    columns: usize,
    width: f64,
    height: f64,
    is_one: bool,
}

impl Grid {
    fn new(count: usize, wide: f64, high: f64) -> Grid {
        let all = count.max(1);
        // about as wide as high, all together
        let columns = ((all as f64 * 1.2 * high / wide).sqrt().ceil() as usize).clamp(1, all.min(12));
        let width = (WIDTH - 2.0 * MARGIN) / columns as f64;
        let most = if all == 1 { MOST_HEIGHT } else { width * 1.5 };
        let room = if all == 1 { width } else { 0.9 * width };
        Grid { columns, width, height: (room * high / wide).min(most), is_one: all == 1 }
    }

    fn corner(&self, k: usize) -> [f64; 2] {
        let (column, row) = (k % self.columns, k / self.columns);
        [MARGIN + column as f64 * self.width, TITLE + row as f64 * (self.height + LABEL)]
    }

    fn frame(&self, k: usize) -> [f64; 4] {
        let [x, y] = self.corner(k);
        let room = if self.is_one { 0.0 } else { 0.05 * self.width };
        [x + room, y, self.width - 2.0 * room, self.height]
    }

    fn label(&self, k: usize) -> [f64; 2] {
        let [x, y] = self.corner(k);
        [x + 0.5 * self.width, y + self.height + 0.6 * LABEL]
    }

    /// The end of all panels, if the last one ends here.
    fn bottom(&self, last: f64) -> f64 {
        if self.is_one { last } else { last + LABEL }
    }
}
