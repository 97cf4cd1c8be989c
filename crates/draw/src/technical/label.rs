//! Diameters of the circles of a view as texts, with leader lines.

use super::circle::{Circle, Group};
use super::panel::Panel;
use crate::dimension::arrow;
use crate::svg::{Anchor, Svg};

type Point = [f64; 2];

/// The distance of lines of text, the approximate width of a character, and the distance of texts from their leader lines.
const ROW: f64 = 17.0;
const LETTER: f64 = 6.9;
const BESIDE: f64 = 4.0;

/// The approximate width of a text.
pub fn width(text: &str) -> f64 {
    LETTER * text.chars().count() as f64
}

/// Draws the texts to the right of a view, beginning at `x`, with leader lines to the circles.
pub fn draw(svg: &mut Svg, panel: &Panel, groups: &[Group], x: f64) {
    let [_, top, _, bottom] = panel.sides();
    // the circle nearest to the upper right corner
    let nearest = |group: &Group| {
        let far = |circle: &Circle| circle.centre[0] + circle.centre[1];
        group.circles.iter().copied().max_by(|a, b| far(a).total_cmp(&far(b)))
    };
    let mut entries: Vec<(Circle, Point, &str)> = groups
        .iter()
        .filter_map(|group| nearest(group).map(|own| (own, panel.position(own.centre), group.text.as_str())))
        .collect();
    let rows = (((bottom - top) / ROW) as usize).max(5);
    let more = (entries.len() > rows).then(|| format!("and {} more sizes", entries.len() + 1 - rows));
    if more.is_some() {
        entries.truncate(rows - 1);
    }
    entries.sort_by(|a, b| a.1[1].total_cmp(&b.1[1]));
    let count = entries.len();
    let mut y = top - ROW + 6.0;
    for (k, (circle, centre, text)) in entries.into_iter().enumerate() {
        let latest = bottom.max(top + ROW * count as f64) - ROW * (count - 1 - k) as f64;
        y = (centre[1] - 0.5 * ROW).min(latest).max(y + ROW);
        let end = [x - 12.0, y - 4.0];
        let way = [end[0] - centre[0], end[1] - centre[1]];
        let length = libm::hypot(way[0], way[1]).max(1e-9);
        // the vertical axis of the drawing points down
        let towards = circle.tip([way[0] / length, -way[1] / length]);
        let reach = panel.scale() * circle.reach(towards);
        let tip = [centre[0] + reach * towards[0], centre[1] - reach * towards[1]];
        let way = [tip[0] - end[0], tip[1] - end[1]];
        let length = libm::hypot(way[0], way[1]).max(1e-9);
        let path = format!("M{:.2} {:.2}L{:.2} {:.2}H{:.2}", tip[0], tip[1], end[0], end[1], x - BESIDE);
        svg.path("leader", path, "");
        svg.path("arrow", arrow(tip, way.map(|part| part / length)), "");
        svg.text("value", [x, y], Anchor::Start, text, text);
    }
    if let Some(more) = more {
        svg.text("value", [x, y + ROW], Anchor::Start, &more, &more);
    }
}
