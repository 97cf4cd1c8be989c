//! Plans: windows of a plane drawn to scale, with axes and a scale bar.

use crate::axis::{format_number, round_step};
use crate::svg::{Anchor, Pixels, Svg};
use std::fmt::Write;

/// The map from a window of a plane to the drawing.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// The lower left corner of the window.
    pub lo: [f64; 2],
    /// The upper right corner of the window.
    pub hi: [f64; 2],
    /// Pixels per unit of length.
    pub scale: f64,
    /// The position of the left end of the window.
    left: f64,
    /// The position of the lower end of the window.
    pub bottom: f64,
}

impl Plan {
    /// Fits a window into a frame (left, top, width, height): at the top, centred between the sides.
    pub fn new(lo: [f64; 2], hi: [f64; 2], [x, y, width, height]: [f64; 4]) -> Plan {
        let size = [0, 1].map(|k| hi[k] - lo[k]);
        let scale = (width / size[0]).min(height / size[1]);
        let left = x + 0.5 * (width - scale * size[0]);
        Plan { lo, hi, scale, left, bottom: y + scale * size[1] }
    }

    /// The position of a point.
    pub fn position(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [self.left + self.scale * (u - self.lo[0]), self.bottom - self.scale * (v - self.lo[1])]
    }

    /// A path through points, simplified below the resolution of the drawing.
    pub fn path(&self, points: &[[f64; 2]], is_closed: bool) -> String {
        let positions: Vec<[f64; 2]> = points.iter().map(|&point| self.position(point)).collect();
        let mut path = String::new();
        for (k, [x, y]) in simplified(&positions).into_iter().enumerate() {
            let letter = if k == 0 { 'M' } else { 'L' };
            // writing to a string cannot fail
            let _ = write!(path, "{letter}{} {}", Pixels(x), Pixels(y));
        }
        if is_closed { path + "Z" } else { path }
    }

    /// Draws arrows with the names of the axes, starting at the lower left corner.
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

    /// Draws a scale bar of a round length, about a sixth of the width, that ends at a position.
    pub fn scale_bar(&self, svg: &mut Svg, [right, y]: [f64; 2], width: f64, unit: &str) {
        let wanted = (self.hi[0] - self.lo[0]).min(width / self.scale) / 6.0;
        let length = round_step(wanted);
        let left = right - self.scale * length;
        let (top, low) = (Pixels(y - 4.0), Pixels(y + 4.0));
        let (l, r, y0) = (Pixels(left), Pixels(right), Pixels(y));
        svg.path("axis", format_args!("M{l} {top}V{low}M{l} {y0}H{r}M{r} {top}V{low}"), "");
        let text = format!("{} {unit}", format_number(length, 1e-3 * length));
        // the text extends beyond the left end of a shorter bar
        let is_short = right - left < 8.0 * text.len() as f64;
        let (x, anchor) =
            if is_short { (right, Anchor::End) } else { (0.5 * (left + right), Anchor::Middle) };
        svg.text("tick", [x, y - 7.0], anchor, &text, &text);
    }
}

/// Removes points within a twentieth of a pixel of the line between their neighbours.
fn simplified(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut kept: Vec<[f64; 2]> = Vec::new();
    let mut from = 0;
    for (k, &point) in points.iter().enumerate() {
        let is_between = |j: usize| distance_from_segment(points[j], points[from], points[k + 1]) < 0.05;
        let may_go = k > from && k + 1 < points.len() && k - from < 64 && (from + 1..=k).all(is_between);
        if !may_go {
            kept.push(point);
            from = k;
        }
    }
    kept
}

/// The distance of a point from a line segment, infinite beyond its ends.
fn distance_from_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
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
        // a path that turns back on itself
        let back = [[0.0, 0.0], [5.0, 0.0], [1.0, 0.0]];
        assert_eq!(simplified(&back), back);
    }
}
