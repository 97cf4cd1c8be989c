//! Maps of irradiance as SVG.

use super::chart::{BELOW, Chart, MARGIN};
use super::scale::ColourScale;
use crate::axis::format_number;
use crate::svg::{Anchor, Pixels, Svg, paint};
use rayweave_optics::detector::IrradianceMap;
use rayweave_render::Rgba;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Steps of the colour scale.
const LEVELS: usize = 128;

pub(super) const STYLE: &str = ".cell { stroke: none; shape-rendering: crispEdges }\n";

/// Draws a map of irradiance: a colour for each cell, from dark blue for no light to yellow for the maximum, with a colour bar.
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
    let scale = ColourScale::linear(map.peak());
    draw_cells((map.columns, &map.values), &scale, &chart, &mut svg);
    let (title, subtitle) = (format!("Irradiance: {name}"), subtitle(map));
    chart.draw(&mut svg, [&title, &subtitle], unit);
    let label = format!("power / {unit}\u{b2}");
    let right = draw_colour_bar(&scale, chart.frame(), &label, &mut svg);
    let [_, top, _, height] = chart.frame();
    svg.finish([right.max(400.0), top + height.max(120.0) + BELOW], &title, &subtitle, STYLE)
}

fn subtitle(map: &IrradianceMap) -> String {
    let power = format_number(map.power(), 1e-4 * map.power().max(f64::MIN_POSITIVE));
    format!("power {power} on {} \u{d7} {} cells", map.columns, map.rows())
}

/// Draws all cells of the same colour as one path: the number of columns, and the values row by row from the bottom.
pub(super) fn draw_cells(
    (columns, values): (usize, &[f64]),
    scale: &ColourScale,
    chart: &Chart,
    svg: &mut Svg,
) {
    let mut paths: BTreeMap<Option<usize>, String> = BTreeMap::new();
    let [_, top, width, height] = chart.frame();
    let rows = values.len() / columns;
    let (w, h) = (width / columns as f64, height / rows as f64);
    for (k, &value) in values.iter().enumerate() {
        let (column, row) = (k % columns, rows - 1 - k / columns);
        let [x, end] = [column, column + 1].map(|c| Pixels(chart.x.start + c as f64 * w));
        let [y, low] = [row, row + 1].map(|r| Pixels(top + r as f64 * h));
        let path = paths.entry(scale.part(value).map(level)).or_default();
        // writing to a string cannot fail
        let _ = write!(path, "M{x} {y}H{end}V{low}H{x}Z");
    }
    for (level, path) in paths {
        svg.path("cell", path, &format!(r#" fill="{}""#, level_paint(level)));
    }
}

/// The colour of a value.
pub(super) fn value_paint(value: f64, scale: &ColourScale) -> String {
    level_paint(scale.part(value).map(level))
}

/// Draws the colours with their values to the right of a frame. Returns the right end of the drawing.
pub(super) fn draw_colour_bar(
    scale: &ColourScale,
    [left, top, width, height]: [f64; 4],
    label: &str,
    svg: &mut Svg,
) -> f64 {
    let (x, height) = (left + width + 30.0, height.max(120.0));
    let step = height / LEVELS as f64;
    for level in 0..LEVELS {
        let y = top + height - (level + 1) as f64 * step;
        svg.rectangle("cell", [x, y, 16.0, step + 0.5], &format!(r#" fill="{}""#, level_paint(Some(level))));
    }
    svg.rectangle("axis", [x, top, 16.0, height], "");
    let mut characters = 8;
    for (part, text) in scale.ticks(height) {
        characters = characters.max(text.chars().count());
        let y = top + (1.0 - part) * height;
        svg.text("tick", [x + 24.0, y + 4.0], Anchor::Start, &text, &text);
    }
    svg.text("tick", [x, top - 8.0], Anchor::Start, label, label);
    x + 30.0 + 6.4 * characters as f64 + MARGIN
}

/// The step of the colour scale at a place from 0 to 1.
fn level(part: f64) -> usize {
    (part * (LEVELS - 1) as f64).round() as usize
}

/// The colour of a step; grey for a value that the scale does not have.
fn level_paint(level: Option<usize>) -> String {
    level.map_or("#b4b4b4".to_owned(), |level| paint(viridis(level as f64 / (LEVELS - 1) as f64)))
}

/// Equidistant colours of the scale viridis (S. van der Walt and N. Smith, Matplotlib 1.5, 2015; public domain).
const VIRIDIS: [[u8; 3]; 10] = [
    [0x44, 0x01, 0x54],
    [0x48, 0x28, 0x78],
    [0x3e, 0x4a, 0x89],
    [0x31, 0x68, 0x8e],
    [0x26, 0x82, 0x8e],
    [0x1f, 0x9e, 0x89],
    [0x35, 0xb7, 0x79],
    [0x6d, 0xcd, 0x59],
    [0xb4, 0xde, 0x2c],
    [0xfd, 0xe7, 0x25],
];

/// Colours of evenly increasing perceived lightness, from dark blue to yellow, so that noise does not change the hue much: viridis,
/// linear between ten of its colours.
fn viridis(part: f64) -> Rgba {
    let last = VIRIDIS.len() - 1;
    let at = part.clamp(0.0, 1.0) * last as f64;
    let k = (at as usize).min(last - 1);
    let between = |from: u8, to: u8| f64::from(from) + (at - k as f64) * (f64::from(to) - f64::from(from));
    Rgba::from([0, 1, 2].map(|c| between(VIRIDIS[k][c], VIRIDIS[k + 1][c]).round() as u8))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_optics::detector::IrradianceBins;

    #[test]
    fn a_map_without_light_is_drawn() {
        assert!(irradiance_svg(&IrradianceBins::default().finish(8), "a", "mm").contains("<svg "));
    }

    /// The lightness L* of CIE 1976 rises evenly along the scale, within 3 of 100.
    #[test]
    fn the_colours_of_the_scale() {
        assert_eq!(viridis(0.0), Rgba::opaque(68, 1, 84));
        assert_eq!(viridis(1.0), Rgba::opaque(253, 231, 37));
        let linear = |level: u8| {
            let part = f64::from(level) / 255.0;
            if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
        };
        let lightness = |part: f64| {
            let c = viridis(part);
            let y = 0.2126 * linear(c.red) + 0.7152 * linear(c.green) + 0.0722 * linear(c.blue);
            if y > 0.008_856 { 116.0 * y.cbrt() - 16.0 } else { 903.3 * y }
        };
        let [low, high] = [0.0, 1.0].map(lightness);
        for k in 0..=40 {
            let part = f64::from(k) / 40.0;
            let even = low + part * (high - low);
            assert!((lightness(part) - even).abs() < 3.0, "{part} {} {even}", lightness(part));
        }
    }
}
