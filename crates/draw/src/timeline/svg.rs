//! A time line as SVG.

use super::{Bands, Row, Timeline, Wave};
use crate::axis::{Axis, format_number};
use crate::svg::{Anchor, INK, Pixels, Svg, paint};
use rayweave_render::{PALETTE, Rgba};
use rayweave_rootray::{Side, SurfaceCount};
use std::fmt::Write;

const WIDTH: f64 = 960.0;
const MARGIN: f64 = 20.0;
const TITLE: f64 = 34.0;
/// A wave: the height of its numbers, its own height, and the gap below it.
const NUMBERS: f64 = 15.0;
const WAVE: f64 = 24.0;
const GAP: f64 = 13.0;
const AXIS: f64 = 44.0;
/// The gap between operands and results.
const BREAK: f64 = 10.0;
/// The number of times above which plain guides are left out.
const MAX_GUIDES: usize = 100;
/// The maximum number of characters of a name.
const NAME: usize = 26;
/// The approximate width of a character of names and of numbers.
const LETTER: f64 = 7.4;
const DIGIT: f64 = 6.1;
/// The maximum height of one step of the count, and of all steps together.
const STEP: f64 = 13.0;
const STEPS: f64 = 78.0;

const STYLE: &str = "\
.band { font-size: 11.5px }
.tied { stroke: #d55e00; stroke-width: 1; stroke-dasharray: 3 3; fill: none }
.wave { fill: none; stroke-width: 2; stroke-linejoin: round }
.area { stroke: none; fill-opacity: 0.22 }
.solid { stroke: none; fill-opacity: 0.5 }
.arrow { stroke: none }
";

/// The colour of results.
const RESULT: Rgba = Rgba::opaque(213, 94, 0);

pub fn drawing(timeline: &Timeline) -> String {
    let count = timeline.count();
    let times = timeline.times();
    let mut pen = Drawing::new(timeline, &times);
    pen.guides(&times, heights(timeline, count.as_ref()));
    for (k, wave) in timeline.operands.iter().enumerate() {
        pen.wave("name", "area", wave, operand_colour(k));
    }
    if let Some(count) = &count {
        pen.y += BREAK;
        pen.count(count);
    }
    pen.y += if timeline.results.is_empty() || timeline.operands.is_empty() { 0.0 } else { BREAK };
    for row in &timeline.results {
        match row {
            Row::Wave(wave) => pen.wave("result", "solid", wave, RESULT),
            Row::Bands(bands) => pen.bands(bands),
        }
    }
    pen.axis();
    let title = if timeline.title.is_empty() { "time line" } else { &timeline.title };
    let height = pen.y + AXIS;
    pen.svg.finish([WIDTH, height], title, "", STYLE)
}

/// The height of all rows.
fn heights(timeline: &Timeline, count: Option<&SurfaceCount>) -> f64 {
    let rows = timeline.operands.len() + timeline.results.len();
    let both = !timeline.results.is_empty() && !timeline.operands.is_empty();
    let breaks = f64::from(u8::from(both) + u8::from(count.is_some()));
    let of_count = count.map_or(0.0, |count| NUMBERS + steps(count).1 + GAP);
    rows as f64 * (NUMBERS + WAVE + GAP) + of_count + breaks * BREAK
}

/// The largest count, at least 1, and the height of its row.
fn steps(count: &SurfaceCount) -> (usize, f64) {
    let most = count.steps.iter().map(|step| step.1).fold(count.start, usize::max).max(1);
    (most, (most as f64 * STEP).clamp(WAVE, STEPS))
}

/// The colours of waves: the palette without yellow, which is too light for thin lines on white.
fn operand_colour(k: usize) -> Rgba {
    let colours = [PALETTE[5], PALETTE[2], PALETTE[3], PALETTE[1], PALETTE[0]];
    colours[k % colours.len()]
}

/// A name, shortened if it is too long.
fn shortened(name: &str) -> String {
    if name.chars().count() <= NAME {
        name.to_owned()
    } else {
        name.chars().take(NAME - 1).chain(['\u{2026}']).collect()
    }
}

struct Drawing {
    svg: Svg,
    axis: Axis,
    /// The top of the next row.
    y: f64,
    /// The names of bands in the order of their colours.
    bands: Vec<String>,
}

impl Drawing {
    fn new(timeline: &Timeline, times: &[(f64, usize)]) -> Drawing {
        let of_bands = timeline.results.iter().filter_map(|row| match row {
            Row::Bands(bands) => Some(bands.name.as_str()),
            Row::Wave(_) => None,
        });
        let names = timeline.waves().map(|wave| wave.name.as_str()).chain(of_bands).chain(["count"]);
        let letters = names.map(|name| name.chars().count().min(NAME)).max().unwrap_or(0);
        let left = MARGIN + LETTER * letters as f64 + 26.0;
        let right = WIDTH - MARGIN - 14.0;
        let ends: Vec<f64> = times.iter().map(|time| time.0).collect();
        let axis = match timeline.window {
            Some((min, max)) => Axis { min, max, start: left, end: right },
            None => Axis::around(&ends, left, right),
        };
        let mut svg = Svg::default();
        let mut y = MARGIN;
        if !timeline.title.is_empty() {
            svg.text("title", [MARGIN, MARGIN + 12.0], Anchor::Start, &timeline.title, &timeline.title);
            y = MARGIN + TITLE - 8.0;
        }
        Drawing { svg, axis, y, bands: Vec::new() }
    }

    /// Draws vertical lines at all times of change, dashed where several operands change.
    fn guides(&mut self, times: &[(f64, usize)], height: f64) {
        let shown: Vec<_> = times.iter().filter(|time| self.axis.contains(time.0)).collect();
        let is_crowded = shown.len() > MAX_GUIDES;
        let (mut plain, mut tied) = (String::new(), String::new());
        for &(t, operands) in shown.into_iter().filter(|time| !is_crowded || time.1 > 1) {
            let out = if operands > 1 { &mut tied } else { &mut plain };
            let (x, top, bottom) = (Pixels(self.axis.position(t)), Pixels(self.y), Pixels(self.y + height));
            let _ = write!(out, "M{x} {top}V{bottom}");
        }
        for (class, path) in [("guide", plain), ("tied", tied)] {
            if !path.is_empty() {
                self.svg.path(class, path, "");
            }
        }
    }

    /// Draws the name of a row that lies between two heights.
    fn name(&mut self, class: &str, name: &str, top: f64, bottom: f64) {
        let at = [self.axis.start - 18.0, 0.5 * (top + bottom) + 4.5];
        self.svg.text(class, at, Anchor::End, &shortened(name), name);
    }

    fn wave(&mut self, class: &str, area: &str, wave: &Wave, colour: Rgba) {
        let (top, bottom) = (self.y + NUMBERS, self.y + NUMBERS + WAVE);
        self.name(class, &wave.name, top, bottom);
        self.base(bottom);
        let fill = format!(r#" fill="{}""#, paint(colour));
        for (start, end) in wave.spans(Side::Inside) {
            let (left, right) = (self.position(start, self.axis.start), self.position(end, self.axis.end));
            if left < right {
                self.svg.rectangle(area, [left, top, right - left, WAVE], &fill);
            }
        }
        let levels = [bottom, top];
        let first = usize::from(wave.ray.start().is_inside());
        let steps: Vec<(f64, f64)> = (wave.ray.crossings())
            .map(|(root, side)| (root.t, levels[usize::from(side.is_inside())]))
            .collect();
        self.staircase(levels[first], &steps, &paint(colour));
        self.arrows(wave, top, &fill);
        let times: Vec<f64> = wave.ray.times().collect();
        self.numbers(&times, top - 4.0);
        self.y = bottom + GAP;
    }

    /// Draws the thin base line of a row.
    fn base(&mut self, y: f64) {
        let (left, right, y) = (Pixels(self.axis.start), Pixels(self.axis.end), Pixels(y));
        self.svg.path("base", format_args!("M{left} {y}H{right}"), "");
    }

    /// The position of an end, clamped to the drawing; `missing` for an unbounded one.
    fn position(&self, end: Option<f64>, missing: f64) -> f64 {
        let position = end.map_or(missing, |t| self.axis.position(t));
        position.clamp(self.axis.start, self.axis.end)
    }

    /// Draws a line that changes its level at given times.
    fn staircase(&mut self, first: f64, steps: &[(f64, f64)], stroke: &str) {
        let before = steps.iter().take_while(|step| step.0 <= self.axis.min).last();
        let mut path =
            format!("M{} {}", Pixels(self.axis.start), Pixels(before.map_or(first, |step| step.1)));
        for &(t, level) in steps.iter().filter(|step| self.axis.contains(step.0)) {
            let _ = write!(path, "H{}V{}", Pixels(self.axis.position(t)), Pixels(level));
        }
        let _ = write!(path, "H{}", Pixels(self.axis.end));
        self.svg.path("wave", path, &format!(r#" stroke="{stroke}""#));
    }

    /// Draws arrows at the ends of a wave that is inside as t -> -inf or +inf.
    fn arrows(&mut self, wave: &Wave, y: f64, fill: &str) {
        let ends = [(wave.ray.start(), self.axis.start, -1.0), (wave.ray.end(), self.axis.end, 1.0)];
        for (_, x, sign) in ends.into_iter().filter(|(side, ..)| side.is_inside()) {
            let (tip, back) = (Pixels(x + 10.0 * sign), Pixels(x - 1.0 * sign));
            let (above, y, below) = (Pixels(y - 5.0), Pixels(y), Pixels(y + 5.0));
            self.svg.path("arrow", format_args!("M{tip} {y}L{back} {above}V{below}Z"), fill);
        }
    }

    /// Writes times above a wave, except those that would overlap the previous one.
    fn numbers(&mut self, times: &[f64], y: f64) {
        let mut free = f64::NEG_INFINITY;
        for &t in times.iter().filter(|&&t| self.axis.contains(t)) {
            let text = format_number(t, self.axis.resolution());
            let half = 0.5 * DIGIT * text.chars().count() as f64;
            let x = self.axis.position(t);
            if x - half >= free {
                self.svg.text("number", [x, y], Anchor::Middle, &text, &format!("{t}"));
                free = x + half + 5.0;
            }
        }
    }

    fn count(&mut self, count: &SurfaceCount) {
        let (most, height) = steps(count);
        let (top, bottom) = (self.y + NUMBERS, self.y + NUMBERS + height);
        let level = |n: usize| bottom - height * n as f64 / most as f64;
        self.name("name", "count", top, bottom);
        let every = most.div_ceil((height / STEP) as usize).max(1);
        for n in (0..=most).step_by(every) {
            self.base(level(n));
            let at = [self.axis.start - 5.0, level(n) + 3.5];
            self.svg.text("tick", at, Anchor::End, &n.to_string(), &n.to_string());
        }
        let steps: Vec<(f64, f64)> = count.steps.iter().map(|&(t, n)| (t, level(n))).collect();
        self.staircase(level(count.start), &steps, INK);
        self.y = bottom + GAP;
    }

    fn bands(&mut self, bands: &Bands) {
        let (top, bottom) = (self.y + NUMBERS, self.y + NUMBERS + WAVE);
        self.name("result", &bands.name, top, bottom);
        self.base(bottom);
        let starts = std::iter::once((None, &bands.first))
            .chain(bands.changes.iter().map(|(t, name)| (Some(*t), name)));
        let ends = bands.changes.iter().map(|change| Some(change.0)).chain([None]);
        for ((start, name), end) in starts.zip(ends).filter(|((_, name), _)| !name.is_empty()) {
            let colour = self.band_colour(name);
            let (left, right) = (self.position(start, self.axis.start), self.position(end, self.axis.end));
            self.band(name, [left, top, right - left, WAVE], colour);
        }
        let times: Vec<f64> = bands.changes.iter().map(|change| change.0).collect();
        self.numbers(&times, top - 4.0);
        self.y = bottom + GAP;
    }

    /// The colour of a band name, the same in all rows.
    fn band_colour(&mut self, name: &str) -> Rgba {
        let known = self.bands.iter().position(|known| known == name);
        let number = known.unwrap_or_else(|| {
            self.bands.push(name.to_owned());
            self.bands.len() - 1
        });
        PALETTE[number % PALETTE.len()]
    }

    fn band(&mut self, name: &str, area: [f64; 4], colour: Rgba) {
        let [left, top, width, height] = area;
        if width <= 0.0 {
            return;
        }
        self.svg.named_rectangle("solid", area, &paint(colour), name);
        let fits = (width - 6.0) / LETTER;
        let text = shortened(name);
        if text.chars().count() as f64 <= fits {
            let at = [left + 0.5 * width, top + 0.5 * height + 4.0];
            self.svg.text("band", at, Anchor::Middle, &text, name);
        }
    }

    fn axis(&mut self) {
        let (left, right, y) = (self.axis.start, self.axis.end, self.y + 6.0);
        let mut path = format!("M{} {}H{}", Pixels(left), Pixels(y), Pixels(right));
        let max_ticks = (right - left) / 90.0;
        for (t, text) in self.axis.ticks(max_ticks) {
            let x = self.axis.position(t);
            let _ = write!(path, "M{} {}V{}", Pixels(x), Pixels(y), Pixels(y + 5.0));
            self.svg.text("tick", [x, y + 17.0], Anchor::Middle, &text, &text);
        }
        self.svg.path("axis", path, "");
        self.svg.text("tick", [left - 18.0, y + 4.0], Anchor::End, "t", "t");
    }
}
