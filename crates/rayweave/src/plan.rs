//! Drawings in a plane: from its coordinates to places on paper, with axes and a scale.

use rayweave_render::axis::{number, round_step};
use rayweave_render::svg::{Anchor, Pixels, Svg};
use std::fmt::Write;

/// A window of a plane on a piece of paper.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// The corners of the window.
    pub lo: [f64; 2],
    pub hi: [f64; 2],
    /// Pixels per unit of length.
    pub scale: f64,
    /// Where the left and the lower end of the window are.
    left: f64,
    pub bottom: f64,
}

impl Plan {
    /// The window as large as fits into a frame (left, top, width, height): at its top, in the middle between its sides.
    pub fn new(lo: [f64; 2], hi: [f64; 2], [x, y, width, height]: [f64; 4]) -> Plan {
        let size = [0, 1].map(|k| hi[k] - lo[k]);
        let scale = (width / size[0]).min(height / size[1]);
        let left = x + 0.5 * (width - scale * size[0]);
        Plan { lo, hi, scale, left, bottom: y + scale * size[1] }
    }

    /// Where a point is drawn.
    pub fn place(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [self.left + self.scale * (u - self.lo[0]), self.bottom - self.scale * (v - self.lo[1])]
    }

    /// A path through points; those that would not be seen are left out.
    pub fn path(&self, points: &[[f64; 2]], is_closed: bool) -> String {
        let places: Vec<[f64; 2]> = points.iter().map(|&point| self.place(point)).collect();
        let mut path = String::new();
        for (k, [x, y]) in simplified(&places).into_iter().enumerate() {
            let letter = if k == 0 { 'M' } else { 'L' };
            // writing to a string cannot fail
            let _ = write!(path, "{letter}{} {}", Pixels(x), Pixels(y));
        }
        if is_closed { path + "Z" } else { path }
    }

    /// Arrows with the names of the axes, from a corner at the lower left.
    pub fn axes(svg: &mut Svg, [x, y]: [f64; 2], [across, up]: [&str; 2]) {
        let (tip, top) = (Pixels(x + 26.0), Pixels(y - 26.0));
        let (px, py) = (Pixels(x), Pixels(y));
        svg.path("axis", format_args!("M{tip} {py}H{px}V{top}"), "");
        let arrows = format!(
            "M{} {}l5 3l-5 3M{} {}l3 -5l3 5",
            Pixels(x + 22.0),
            Pixels(y - 3.0),
            Pixels(x - 3.0),
            Pixels(y - 22.0)
        );
        svg.path("axis", arrows, "");
        svg.text("tick", [x + 33.0, y + 4.0], Anchor::Start, across, across);
        svg.text("tick", [x, y - 31.0], Anchor::Middle, up, up);
    }

    /// A round length, about a sixth of the picture, as a bar that ends at a place.
    pub fn scale_bar(&self, svg: &mut Svg, [right, y]: [f64; 2], width: f64, unit: &str) {
        let wanted = (self.hi[0] - self.lo[0]).min(width / self.scale) / 6.0;
        let length = round_step(wanted);
        let left = right - self.scale * length;
        let (top, low) = (Pixels(y - 4.0), Pixels(y + 4.0));
        let (l, r, y0) = (Pixels(left), Pixels(right), Pixels(y));
        svg.path("axis", format_args!("M{l} {top}V{low}M{l} {y0}H{r}M{r} {top}V{low}"), "");
        let text = format!("{} {unit}", number(length, 1e-3 * length));
        // a bar that is shorter than its text has it on its left
        let is_short = right - left < 8.0 * text.len() as f64;
        let (x, anchor) =
            if is_short { (right, Anchor::End) } else { (0.5 * (left + right), Anchor::Middle) };
        svg.text("tick", [x, y - 7.0], anchor, &text, &text);
    }
}

/// The number of the axis and the place along it that a text says: `yz`, `xz`, `xy`, or `z=2.5`.
pub fn axis_and_place(text: &str) -> Option<(usize, f64)> {
    let text: String = text.to_ascii_lowercase().split_whitespace().collect();
    let (axis, place) = match text.as_str() {
        "yz" | "zy" => ("x", "0"),
        "xz" | "zx" => ("y", "0"),
        "xy" | "yx" => ("z", "0"),
        other => other.split_once('=')?,
    };
    let place = place.parse().ok().filter(|place: &f64| place.is_finite())?;
    ["x", "y", "z"].iter().position(|own| *own == axis).map(|axis| (axis, place))
}

/// The points without those that lie within a twentieth of a pixel of the line between their neighbours.
fn simplified(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut kept: Vec<[f64; 2]> = Vec::new();
    let mut from = 0;
    for (k, &point) in points.iter().enumerate() {
        let is_between = |j: usize| off_line(points[j], points[from], points[k + 1]) < 0.05;
        let may_go = k > from && k + 1 < points.len() && k - from < 64 && (from + 1..=k).all(is_between);
        if !may_go {
            kept.push(point);
            from = k;
        }
    }
    kept
}

/// The distance of a point from a line, or from its first point.
fn off_line(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (along, off) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length = libm::hypot(along[0], along[1]);
    let part = along[0] * off[0] + along[1] * off[1];
    match length > 0.0 && part >= 0.0 && part <= length * length {
        true => ((along[0] * off[1] - along[1] * off[0]) / length).abs(),
        false => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_a_line_are_left_out() {
        let straight: Vec<[f64; 2]> = (0..10).map(|k| [f64::from(k), 2.0 * f64::from(k)]).collect();
        assert_eq!(simplified(&straight), [[0.0, 0.0], [9.0, 18.0]]);
        let corner = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 3.0]];
        assert_eq!(simplified(&corner), [[0.0, 0.0], [2.0, 0.0], [2.0, 3.0]]);
        // there and back again
        let back = [[0.0, 0.0], [5.0, 0.0], [1.0, 0.0]];
        assert_eq!(simplified(&back), back);
    }
}
