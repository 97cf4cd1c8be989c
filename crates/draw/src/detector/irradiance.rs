//! Maps of irradiance as SVG.

use super::chart::{BELOW, Chart, MARGIN};
use crate::axis::{Axis, format_number};
use crate::svg::{Anchor, Pixels, Svg, paint};
use rayweave_optics::detector::IrradianceMap;
use rayweave_render::Rgba;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Steps of the colour scale.
const LEVELS: usize = 128;

pub(super) const STYLE: &str = ".cell { stroke: none; shape-rendering: crispEdges }\n";

/// Draws a map of irradiance: a colour for each cell, from black for no light to white for the maximum, with a colour bar.
/// Irradiance is in the unit of power of the sources per square of `unit`, the unit of lengths.
///
/// ```
/// use rayweave_draw::detector::irradiance_svg;
/// use rayweave_optics::detector::IrradianceBins;
///
/// let mut bins = IrradianceBins::default();
/// (0..100).for_each(|k| bins.add([(k % 10) as f64, (k / 10) as f64], 1.0));
/// assert!(irradiance_svg(&bins.finish(10), "screen", "mm").contains("Irradiance: screen"));
/// ```
pub fn irradiance_svg(map: &IrradianceMap, name: &str, unit: &str) -> String {
    let chart = Chart::new(map.lo, map.hi);
    let mut svg = Svg::default();
    draw_cells(map, map.peak(), &chart, &mut svg);
    let (title, subtitle) = (format!("Irradiance: {name}"), subtitle(map));
    chart.draw(&mut svg, [&title, &subtitle], unit);
    let label = format!("power / {unit}\u{b2}");
    let right = draw_colour_bar(map.peak(), chart.frame(), &label, &mut svg);
    let [_, top, _, height] = chart.frame();
    svg.finish([right.max(400.0), top + height.max(120.0) + BELOW], &title, &subtitle, STYLE)
}

fn subtitle(map: &IrradianceMap) -> String {
    let power = format_number(map.power(), 1e-4 * map.power().max(f64::MIN_POSITIVE));
    format!("power {power} on {} \u{d7} {} cells", map.columns, map.rows())
}

/// Draws all cells of the same colour as one path; `peak` has the brightest colour.
pub(super) fn draw_cells(map: &IrradianceMap, peak: f64, chart: &Chart, svg: &mut Svg) {
    let mut paths: BTreeMap<usize, String> = BTreeMap::new();
    let [_, top, width, height] = chart.frame();
    let (w, h) = (width / map.columns as f64, height / map.rows() as f64);
    for (k, &value) in map.values.iter().enumerate() {
        let level = (value / peak * (LEVELS - 1) as f64).round() as usize;
        let (column, row) = (k % map.columns, map.rows() - 1 - k / map.columns);
        let [x, end] = [column, column + 1].map(|c| Pixels(chart.x.start + c as f64 * w));
        let [y, low] = [row, row + 1].map(|r| Pixels(top + r as f64 * h));
        // writing to a string cannot fail
        let _ = write!(paths.entry(level).or_default(), "M{x} {y}H{end}V{low}H{x}Z");
    }
    for (level, path) in paths {
        svg.path("cell", path, &format!(r#" fill="{}""#, level_paint(level)));
    }
}

/// Draws the colours with their values to the right of a frame. Returns the right end of the drawing.
pub(super) fn draw_colour_bar(
    peak: f64,
    [left, top, width, height]: [f64; 4],
    label: &str,
    svg: &mut Svg,
) -> f64 {
    let (x, height) = (left + width + 30.0, height.max(120.0));
    let step = height / LEVELS as f64;
    for level in 0..LEVELS {
        let y = top + height - (level + 1) as f64 * step;
        svg.rectangle("cell", [x, y, 16.0, step + 0.5], &format!(r#" fill="{}""#, level_paint(level)));
    }
    svg.rectangle("axis", [x, top, 16.0, height], "");
    let axis = Axis { min: 0.0, max: peak.max(f64::MIN_POSITIVE), start: top + height, end: top };
    let mut characters = 8;
    for (value, text) in axis.ticks((height / 45.0).max(1.0)) {
        characters = characters.max(text.chars().count());
        svg.text("tick", [x + 24.0, axis.position(value) + 4.0], Anchor::Start, &text, &text);
    }
    svg.text("tick", [x, top - 8.0], Anchor::Start, label, label);
    x + 30.0 + 6.4 * characters as f64 + MARGIN
}

fn level_paint(level: usize) -> String {
    paint(cubehelix(level as f64 / (LEVELS - 1) as f64))
}

/// Colours from black to white with evenly increasing perceived lightness: D. A. Green, *A colour scheme for the display of
/// astronomical intensity images*, Bull. Astron. Soc. India 39, 289 (2011), with start 0.5, -1.5 rotations, hue 1, gamma 1.
fn cubehelix(part: f64) -> Rgba {
    let angle = std::f64::consts::TAU * (0.5 / 3.0 + 1.0 - 1.5 * part);
    let amplitude = 0.5 * part * (1.0 - part);
    let (cos, sin) = (libm::cos(angle), libm::sin(angle));
    let channel = |c: f64, s: f64| {
        let level = part + amplitude * (c * cos + s * sin);
        (255.0 * level.clamp(0.0, 1.0)).round() as u8
    };
    Rgba::opaque(channel(-0.148_61, 1.782_77), channel(-0.292_27, -0.906_49), channel(1.972_94, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_optics::detector::IrradianceBins;

    #[test]
    fn a_map_without_light_is_drawn() {
        assert!(irradiance_svg(&IrradianceBins::default().finish(8), "a", "mm").contains("<svg "));
    }

    /// The values of the paper's scheme at its ends and in the middle, where the hue is start + rotations / 2.
    #[test]
    fn the_colours_of_the_scheme() {
        assert_eq!(cubehelix(0.0), Rgba::opaque(0, 0, 0));
        assert_eq!(cubehelix(1.0), Rgba::opaque(255, 255, 255));
        let lightness = |part: f64| {
            let c = cubehelix(part);
            0.30 * f64::from(c.red) + 0.59 * f64::from(c.green) + 0.11 * f64::from(c.blue)
        };
        for k in 0..=20 {
            let part = f64::from(k) / 20.0;
            assert!((lightness(part) / 255.0 - part).abs() < 0.01, "{part} {}", lightness(part));
        }
    }
}
