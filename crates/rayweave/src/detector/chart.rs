//! A square with axes.

use rayweave_render::axis::Axis;
use rayweave_render::svg::{Anchor, Pixels, Svg};
use std::fmt::Write;

/// The side of the longer axis.
const SIDE: f64 = 460.0;
/// Left of the axes, and above them.
pub const LEFT: f64 = 86.0;
pub const TOP: f64 = 82.0;
/// Below the axes.
pub const BELOW: f64 = 56.0;
pub const MARGIN: f64 = 24.0;

/// A window of the plane of a detector on paper, equally large in both directions.
#[derive(Debug)]
pub struct Chart {
    pub x: Axis,
    pub y: Axis,
}

impl Chart {
    /// A window that is not empty.
    pub fn new(lo: [f64; 2], hi: [f64; 2]) -> Chart {
        let size = [0, 1].map(|k| hi[k] - lo[k]);
        let scale = SIDE / size[0].max(size[1]);
        let [width, height] = size.map(|side| scale * side);
        Chart {
            x: Axis { t_min: lo[0], t_max: hi[0], left: LEFT, right: LEFT + width },
            y: Axis { t_min: lo[1], t_max: hi[1], left: TOP + height, right: TOP },
        }
    }

    pub fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.x.place(x), self.y.place(y)]
    }

    /// Left, top, width, height.
    pub fn frame(&self) -> [f64; 4] {
        [self.x.left, self.y.right, self.x.right - self.x.left, self.y.left - self.y.right]
    }

    /// A title, what it is about, and the axes with their ticks; lengths are in a unit.
    pub fn draw(&self, svg: &mut Svg, [title, subject]: [&str; 2], unit: &str) {
        svg.text("title", [MARGIN, 30.0], Anchor::Start, title, title);
        svg.text("tick", [MARGIN, 48.0], Anchor::Start, subject, subject);
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
            let x = self.x.place(value);
            let _ = write!(path, "M{} {}v5", Pixels(x), Pixels(bottom));
            svg.text("tick", [x, bottom + 18.0], Anchor::Middle, &text, &text);
        }
        for (value, text) in self.y.ticks((height / 50.0).max(1.0)) {
            let y = self.y.place(value);
            let _ = write!(path, "M{} {}h-5", Pixels(left), Pixels(y));
            svg.text("tick", [left - 8.0, y + 4.0], Anchor::End, &text, &text);
        }
        svg.path("axis", path, "");
        let (across, up) = (format!("x / {unit}"), format!("y / {unit}"));
        svg.text("tick", [0.5 * (left + right), bottom + 38.0], Anchor::Middle, &across, &across);
        svg.text("tick", [left - 8.0, top - 8.0], Anchor::End, &up, &up);
    }
}
