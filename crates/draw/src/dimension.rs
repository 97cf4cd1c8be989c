//! Overall dimensions (ISO 129-1): a dimension line with filled arrows between extension lines, and the value above it, readable from
//! below or from the right.

use crate::axis::format_number;
use crate::svg::{Anchor, Svg};

/// The distance of a dimension line from the drawing, the gap before an extension line and the length beyond the arrows, in pixels.
const DISTANCE: f64 = 26.0;
const GAP: f64 = 3.0;
const BEYOND: f64 = 6.0;
/// The length and half the width of an arrow.
const ARROW: [f64; 2] = [9.0, 2.6];
/// The distance of the value from its line.
const ABOVE: f64 = 5.0;
/// The approximate width of a character.
const LETTER: f64 = 7.2;

/// The space that the dimensions need below the drawing and to the left of it.
pub const SPACE: f64 = DISTANCE + BEYOND + 14.0;

/// The distance of parallel dimension lines.
pub const ROW: f64 = 24.0;

/// The style of the lines.
pub const STYLE: &str = "\
.dimension { fill: none; stroke: currentColor; stroke-width: 0.7 }
.arrow { fill: currentColor }
.value { font-size: 12.5px }
.thickness { fill: none; stroke: currentColor; stroke-width: 1.2 }
.halo { fill: none; stroke: #ffffff; stroke-width: 3.5; stroke-opacity: 0.8 }
.size { font-size: 14px; font-weight: 600; stroke: #ffffff; stroke-width: 4; paint-order: stroke }
@media (prefers-color-scheme: dark) { .halo, .size { stroke: #14191f } }
";

/// The text of a length with this error: rounded to the power of ten that is at least the error.
pub fn value(length: f64, error: f64) -> String {
    let step = libm::pow(10.0, libm::ceil(libm::log10(error.max(f64::MIN_POSITIVE))));
    // dividing by a whole number keeps decimal fractions short
    let rounded = if step < 1.0 {
        (length / step).round() / (1.0 / step).round()
    } else {
        (length / step).round() * step
    };
    format_number(rounded, step)
}

/// Draws the width below a box and the height to its left. The box is given by its left, top, right and bottom in pixels.
pub fn draw(svg: &mut Svg, sides: [f64; 4], width: &str, height: &str) {
    draw_sides(svg, sides, (Some(width), Some(height)), [0.0; 2]);
}

/// Like [`draw`], with one of the sizes or none, farther from the box by these distances to the left and below.
pub fn draw_sides(
    svg: &mut Svg,
    [left, top, right, bottom]: [f64; 4],
    (width, height): (Option<&str>, Option<&str>),
    farther: [f64; 2],
) {
    let (y, x) = (bottom + DISTANCE + farther[1], left - DISTANCE - farther[0]);
    let (mut lines, mut arrows) = (String::new(), String::new());
    if width.is_some() {
        for at in [left, right] {
            lines += &line([at, bottom + GAP], [at, y + BEYOND]);
        }
        arrows += &(arrow([left, y], [-1.0, 0.0]) + &arrow([right, y], [1.0, 0.0]));
    }
    if height.is_some() {
        for at in [top, bottom] {
            lines += &line([left - GAP, at], [x - BEYOND, at]);
        }
    }
    lines += &width.map(|_| line([left, y], [right, y])).unwrap_or_default();
    if height.is_some() {
        lines += &line([x, top], [x, bottom]);
        arrows += &(arrow([x, top], [0.0, -1.0]) + &arrow([x, bottom], [0.0, 1.0]));
    }
    if lines.is_empty() {
        return;
    }
    svg.path("dimension", lines, "");
    svg.path("arrow", arrows, "");
    if let Some(width) = width {
        svg.middle_text("value", [0.5 * (left + right), y - ABOVE], 0.0, width);
    }
    if let Some(height) = height {
        svg.middle_text("value", [x - ABOVE, 0.5 * (top + bottom)], -90.0, height);
    }
}

/// Draws a chain of dimensions below a box, or to its left: the distances between positions in ascending order, as texts. The first
/// and the last text stand beside the chain if there is no room for them.
pub fn chain(
    svg: &mut Svg,
    [left, _, _, bottom]: [f64; 4],
    is_vertical: bool,
    positions: &[f64],
    texts: &[String],
) {
    let (y, x) = (bottom + DISTANCE, left - DISTANCE);
    let at = |along: f64, beside: f64| if is_vertical { [x - beside, along] } else { [along, y + beside] };
    let (mut lines, mut arrows) = (String::new(), String::new());
    for &position in positions {
        lines += &line(at(position, GAP - DISTANCE), at(position, BEYOND));
    }
    let count = texts.len();
    for (k, (pair, text)) in positions.windows(2).zip(texts).enumerate() {
        let (room, width) = (pair[1] - pair[0], LETTER * text.chars().count() as f64);
        let forward = if is_vertical { [0.0, 1.0] } else { [1.0, 0.0] };
        let back = forward.map(|part| -part);
        let (mut from, mut to) = (pair[0], pair[1]);
        let is_narrow = room < 2.0 * ARROW[0] + 2.0;
        if is_narrow {
            // arrows from outside
            arrows += &(arrow(at(pair[0], 0.0), forward) + &arrow(at(pair[1], 0.0), back));
            (from, to) = (from - 1.5 * ARROW[0], to + 1.5 * ARROW[0]);
        } else {
            arrows += &(arrow(at(pair[0], 0.0), back) + &arrow(at(pair[1], 0.0), forward));
        }
        let middle = match () {
            () if width <= room => 0.5 * (pair[0] + pair[1]),
            () if k == 0 => {
                from = pair[0] - width - 2.0 * ARROW[0];
                pair[0] - 0.5 * width - 1.5 * ARROW[0]
            }
            () if k + 1 == count => {
                to = pair[1] + width + 2.0 * ARROW[0];
                pair[1] + 0.5 * width + 1.5 * ARROW[0]
            }
            () => 0.5 * (pair[0] + pair[1]),
        };
        lines += &line(at(from, 0.0), at(to, 0.0));
        // a text wider than its place stands above the ends of the extension lines
        let above = if width > room && 0 < k && k + 1 < count { BEYOND + 2.0 } else { ABOVE };
        let (place, turn) =
            if is_vertical { ([x - above, middle], -90.0) } else { ([middle, y - above], 0.0) };
        svg.middle_text("value", place, turn, text);
    }
    svg.path("dimension", lines, "");
    svg.path("arrow", arrows, "");
}

fn line(a: [f64; 2], b: [f64; 2]) -> String {
    format!("M{:.2} {:.2}L{:.2} {:.2}", a[0], a[1], b[0], b[1])
}

/// Draws the thickness between two points in pixels: lines along it with arrows from outside, since walls are thin, short bars at
/// the ends, and the value beside the upper or right end.
pub fn between(svg: &mut Svg, [a, b]: [[f64; 2]; 2], value: &str) {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length = libm::hypot(dx, dy);
    let along = if length > 0.0 { [dx / length, dy / length] } else { [1.0, 0.0] };
    // from the lower or left end to the other one
    let is_forward = if along[1].abs() > 0.5 { along[1] < 0.0 } else { along[0] > 0.0 };
    let ([from, to], d) = if is_forward { ([a, b], along) } else { ([b, a], along.map(|x| -x)) };
    let beside = |p: [f64; 2], by: f64, across: f64| {
        [p[0] + by * d[0] - across * d[1], p[1] + by * d[1] + across * d[0]]
    };
    let tail = 3.0 * ARROW[0];
    let bars = [from, to].map(|end| line(beside(end, 0.0, -BEYOND), beside(end, 0.0, BEYOND)));
    let lines = line(beside(from, -tail, 0.0), beside(to, tail, 0.0)) + &bars.concat();
    let arrows = arrow(from, d) + &arrow(to, d.map(|x| -x));
    // a pale line below the dark one keeps both legible on any colour
    svg.path("halo", &lines, "");
    svg.path("halo", &arrows, "");
    svg.path("thickness", lines, "");
    svg.path("arrow", arrows, "");
    let [x, y] = beside(to, tail + ABOVE, 0.0);
    let (anchor, y) = match () {
        () if d[0] > 0.5 => (Anchor::Start, y + ABOVE),
        () if d[0] < -0.5 => (Anchor::End, y + ABOVE),
        () => (Anchor::Middle, y),
    };
    svg.text("size", [x, y], anchor, value, value);
}

/// Draws a diameter between two points in pixels: a line with arrows inside and the value above it; or, without room for the value,
/// like [`between`].
pub fn across(svg: &mut Svg, [a, b]: [[f64; 2]; 2], value: &str) {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length = libm::hypot(dx, dy);
    if length < LETTER * value.chars().count() as f64 + 2.0 * ARROW[0] {
        return between(svg, [a, b], value);
    }
    // readable from below or from the right
    let is_backward = dx < -1e-6 * length || dx.abs() <= 1e-6 * length && dy > 0.0;
    let ([from, to], d) = match is_backward {
        true => ([b, a], [-dx / length, -dy / length]),
        false => ([a, b], [dx / length, dy / length]),
    };
    svg.path("dimension", line(from, to), "");
    svg.path("arrow", arrow(from, d.map(|part| -part)) + &arrow(to, d), "");
    let middle = [0, 1].map(|k| 0.5 * (from[k] + to[k]));
    let place = [middle[0] + ABOVE * d[1], middle[1] - ABOVE * d[0]];
    svg.middle_text("value", place, libm::atan2(d[1], d[0]).to_degrees(), value);
}

/// An arrow with its tip at a point and this direction.
pub fn arrow(tip: [f64; 2], d: [f64; 2]) -> String {
    let [long, half] = ARROW;
    let end = [tip[0] - long * d[0], tip[1] - long * d[1]];
    let side = [-half * d[1], half * d[0]];
    let (a, b) = ([end[0] + side[0], end[1] + side[1]], [end[0] - side[0], end[1] - side[1]]);
    format!("M{:.2} {:.2}L{:.2} {:.2}L{:.2} {:.2}Z", tip[0], tip[1], a[0], a[1], b[0], b[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_no_digits_below_their_error() {
        assert_eq!(value(60.001, 0.012), "60");
        assert_eq!(value(60.06, 0.012), "60.1");
        assert_eq!(value(12.3456, 0.0001), "12.3456");
        assert_eq!(value(1234.5, 20.0), "1200");
    }
}
