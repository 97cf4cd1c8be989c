//! Overall dimensions (ISO 129-1): a dimension line with filled arrows between extension lines, and the value above it, readable from
//! below or from the right.

use crate::axis::format_number;
use crate::svg::Svg;

/// The distance of a dimension line from the drawing, the gap before an extension line and the length beyond the arrows, in pixels.
const DISTANCE: f64 = 26.0;
const GAP: f64 = 3.0;
const BEYOND: f64 = 6.0;
/// The length and half the width of an arrow.
const ARROW: [f64; 2] = [9.0, 2.6];
/// The distance of the value from its line.
const ABOVE: f64 = 5.0;

/// The space that the dimensions need below the drawing and to the left of it.
pub(super) const SPACE: f64 = DISTANCE + BEYOND + 14.0;

/// The style of the lines.
pub(super) const STYLE: &str = "\
.dimension { fill: none; stroke: currentColor; stroke-width: 0.7 }
.arrow { fill: currentColor }
.value { font-size: 12.5px }
";

/// The text of a length with this error: rounded to the power of ten that is at least the error.
pub(super) fn value(length: f64, error: f64) -> String {
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
pub(super) fn draw(svg: &mut Svg, [left, top, right, bottom]: [f64; 4], width: &str, height: &str) {
    let line = |a: [f64; 2], b: [f64; 2]| format!("M{:.2} {:.2}L{:.2} {:.2}", a[0], a[1], b[0], b[1]);
    let (y, x) = (bottom + DISTANCE, left - DISTANCE);
    let mut lines = String::new();
    for at in [left, right] {
        lines += &line([at, bottom + GAP], [at, y + BEYOND]);
    }
    for at in [top, bottom] {
        lines += &line([left - GAP, at], [x - BEYOND, at]);
    }
    lines += &line([left, y], [right, y]);
    lines += &line([x, top], [x, bottom]);
    svg.path("dimension", lines, "");
    let [long, half] = ARROW;
    let arrow = |tip: [f64; 2], d: [f64; 2]| {
        let end = [tip[0] - long * d[0], tip[1] - long * d[1]];
        let side = [half * d[1], half * d[0]];
        let (a, b) = ([end[0] + side[0], end[1] + side[1]], [end[0] - side[0], end[1] - side[1]]);
        format!("M{:.2} {:.2}L{:.2} {:.2}L{:.2} {:.2}Z", tip[0], tip[1], a[0], a[1], b[0], b[1])
    };
    let arrows = [
        arrow([left, y], [-1.0, 0.0]),
        arrow([right, y], [1.0, 0.0]),
        arrow([x, top], [0.0, -1.0]),
        arrow([x, bottom], [0.0, 1.0]),
    ];
    svg.path("arrow", arrows.concat(), "");
    svg.middle_text("value", [0.5 * (left + right), y - ABOVE], 0.0, width);
    svg.middle_text("value", [x - ABOVE, 0.5 * (top + bottom)], -90.0, height);
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
