//! The frame of a chart, with axes of equal scale.

use crate::axis::Axis;
use crate::svg::{Anchor, Pixels, Svg};
use std::fmt::Write;

/// The length of the longer axis.
const SIDE: f64 = 460.0;
/// The margins left of the axes and above them.
pub const LEFT: f64 = 86.0;
pub const TOP: f64 = 82.0;
/// The margin below the axes.
pub const BELOW: f64 = 56.0;
pub const MARGIN: f64 = 24.0;

/// A window of the plane of a detector, drawn to one scale in both directions.
#[derive(Debug)]
pub struct Chart {
    pub x: Axis,
    pub y: Axis,
    /// The upper left corner of the chart with its margins.
    corner: [f64; 2],
}

impl Chart {
    /// The chart of a window, which must not be empty.
    pub fn new(lo: [f64; 2], hi: [f64; 2]) -> Chart {
        Chart::at([0.0; 2], SIDE, lo, hi)
    }

    /// The chart of a window in a larger drawing, with the length of its longer axis.
    pub fn at(corner: [f64; 2], side: f64, lo: [f64; 2], hi: [f64; 2]) -> Chart {
        let size = [0, 1].map(|k| hi[k] - lo[k]);
        let scale = side / size[0].max(size[1]);
        Chart::with_axes(corner, size.map(|side| scale * side), lo, hi)
    }

    /// A chart of axes whose scales differ, with the lengths of the axes.
    pub fn with_axes(corner: [f64; 2], [width, height]: [f64; 2], lo: [f64; 2], hi: [f64; 2]) -> Chart {
        let (left, top) = (corner[0] + LEFT, corner[1] + TOP);
        Chart {
            x: Axis { min: lo[0], max: hi[0], start: left, end: left + width },
            y: Axis { min: lo[1], max: hi[1], start: top + height, end: top },
            corner,
        }
    }

    /// The part of a chart between two corners of its window.
    pub fn part(&self, lo: [f64; 2], hi: [f64; 2]) -> Chart {
        let axis =
            |axis: &Axis, min, max| Axis { min, max, start: axis.position(min), end: axis.position(max) };
        Chart { x: axis(&self.x, lo[0], hi[0]), y: axis(&self.y, lo[1], hi[1]), corner: self.corner }
    }

    /// The position of a point.
    pub fn position(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.x.position(x), self.y.position(y)]
    }

    /// The area between the axes: left, top, width, height.
    pub fn frame(&self) -> [f64; 4] {
        [self.x.start, self.y.end, self.x.end - self.x.start, self.y.start - self.y.end]
    }

    /// Draws title, subtitle, and axes with ticks. `unit` is the unit of length.
    pub fn draw(&self, svg: &mut Svg, titles: [&str; 2], unit: &str) {
        self.draw_axes(svg, titles, ["x", "y"].map(|name| format!("{name} / {unit}")));
    }

    /// Like [`Chart::draw`], with the labels of the axes.
    pub fn draw_axes(&self, svg: &mut Svg, [title, subtitle]: [&str; 2], [across, up]: [String; 2]) {
        let [x, y] = self.corner;
        svg.text("title", [x + MARGIN, y + 30.0], Anchor::Start, title, title);
        svg.text("tick", [x + MARGIN, y + 48.0], Anchor::Start, subtitle, subtitle);
        let [left, top, width, height] = self.frame();
        let (right, bottom) = (left + width, top + height);
        let mut path = format!(
            "M{} {}H{}V{}H{}Z",
            Pixels(left),
            Pixels(top),
            Pixels(right),
            Pixels(bottom),
            Pixels(left)
        );
        // writing to a string cannot fail
        for (value, text) in self.x.ticks((width / 80.0).max(1.0)) {
            let x = self.x.position(value);
            let _ = write!(path, "M{} {}v5", Pixels(x), Pixels(bottom));
            svg.text("tick", [x, bottom + 18.0], Anchor::Middle, &text, &text);
        }
        for (value, text) in self.y.ticks((height / 50.0).max(1.0)) {
            let y = self.y.position(value);
            let _ = write!(path, "M{} {}h-5", Pixels(left), Pixels(y));
            svg.text("tick", [left - 8.0, y + 4.0], Anchor::End, &text, &text);
        }
        svg.path("axis", path, "");
        svg.text("tick", [0.5 * (left + right), bottom + 38.0], Anchor::Middle, &across, &across);
        svg.text("tick", [left - 8.0, top - 8.0], Anchor::End, &up, &up);
    }
}

/// Draws the axes of a panel with ticks: the label of the horizontal axis below it, and that of the vertical axis above.
pub fn panel_axes(svg: &mut Svg, [across, up]: [&Axis; 2], labels: [&str; 2]) {
    let ticks = up.ticks((up.start - up.end) / 50.0);
    panel_axes_with(svg, [across, up], ticks, labels);
}

/// Like [`panel_axes`], with the ticks of the vertical axis: places in its values, and texts.
pub fn panel_axes_with(
    svg: &mut Svg,
    [across, up]: [&Axis; 2],
    ticks: Vec<(f64, String)>,
    [below, above]: [&str; 2],
) {
    let (left, right) = (across.start, across.end);
    let (bottom, top) = (up.start, up.end);
    let mut path = format!("M{} {}V{}H{}", Pixels(left), Pixels(top), Pixels(bottom), Pixels(right));
    // writing to a string cannot fail
    for (value, text) in across.ticks((right - left) / 80.0) {
        let x = across.position(value);
        let _ = write!(path, "M{} {}v5", Pixels(x), Pixels(bottom));
        svg.text("tick", [x, bottom + 18.0], Anchor::Middle, &text, &text);
    }
    for (value, text) in ticks {
        let y = up.position(value);
        let _ = write!(path, "M{} {}h-5", Pixels(left), Pixels(y));
        svg.text("tick", [left - 8.0, y + 4.0], Anchor::End, &text, &text);
    }
    svg.path("axis", path, "");
    svg.text("tick", [0.5 * (left + right), bottom + 38.0], Anchor::Middle, below, below);
    svg.text("tick", [left - 8.0, top - 8.0], Anchor::Start, above, above);
}
