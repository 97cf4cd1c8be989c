//! The results as a bar chart with a logarithmic scale.

use super::{Figure, Report, Section};
use crate::interleaved::Role;
use crate::report::text::rate;
use rayweave::draw::svg::{self, Anchor};

/// A drawing without tooltips.
#[derive(Default)]
struct Drawing(svg::Svg);

impl Drawing {
    fn text(&mut self, class: &str, at: [f64; 2], anchor: Anchor, text: &str) {
        self.0.text(class, at, anchor, text, text);
    }

    fn bar(&mut self, role: Role, area: [f64; 4]) {
        self.0.rectangle(role.name(), area, "");
    }
}

/// Lengths, in pixels.
const WIDTH: f64 = 860.0;
const LEFT: f64 = 250.0;
const RIGHT: f64 = 110.0;
const BAR: f64 = 15.0;
const GAP: f64 = 34.0;
const TOP: f64 = 56.0;

const STYLE: &str = "\
.ours { fill: #2f7ed8 }
.peer { fill: #b4bcc6 }
.ceiling { fill: none; stroke: #d9822b; stroke-width: 1.5 }
";

/// The rates of all candidates of the plotted sections, as an SVG document.
pub fn plot(report: &Report) -> String {
    let sections: Vec<&Section> = report.sections.iter().filter(|section| is_plotted(section)).collect();
    let rates = sections.iter().flat_map(|section| &section.figures).map(Figure::rate);
    let scale = Scale::of(rates);
    let mut svg = Drawing::default();
    let height = TOP + sections.iter().map(|section| height(section)).sum::<f64>() + 30.0;
    svg.text("title", [20.0, 28.0], Anchor::Start, "Work done per second");
    legend(&mut svg);
    for power in scale.powers() {
        guide(&mut svg, &scale, power, height);
    }
    let mut y = TOP;
    for section in sections {
        bars(&mut svg, &scale, section, y);
        y += self::height(section);
    }
    let description = format!("Rates measured on {}, as in the tables of the page.", report.date);
    svg.0.finish([WIDTH, height], "Work done per second", &description, STYLE)
}

/// False for families of models of different sizes, which have a table of their own.
fn is_plotted(section: &Section) -> bool {
    !section.figures.is_empty() && !section.name.starts_with("scale/")
}

/// Positions of rates on the plot: logarithmic, equal lengths for equal ratios.
struct Scale {
    /// The exponents of ten at its ends.
    ends: [f64; 2],
}

impl Scale {
    fn of(rates: impl Iterator<Item = f64>) -> Scale {
        let (low, high) =
            rates.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), rate| (low.min(rate), high.max(rate)));
        // the nearest powers of ten, from the exponential notation of the rates
        let exponent = |value: f64| {
            let text = format!("{value:e}");
            text.split_once('e').and_then(|(_, power)| power.parse::<f64>().ok()).unwrap_or(0.0)
        };
        match low <= high {
            true => Scale { ends: [exponent(low), exponent(high) + 1.0] },
            false => Scale { ends: [0.0, 1.0] },
        }
    }

    fn powers(&self) -> impl Iterator<Item = i32> + use<> {
        self.ends[0] as i32..=self.ends[1] as i32
    }

    /// The position of a rate. Within a decade the logarithm is found by repeated squaring.
    fn x(&self, rate: f64) -> f64 {
        let [low, high] = self.ends;
        let part = (logarithm(rate) - low) / (high - low);
        LEFT + (WIDTH - LEFT - RIGHT) * part.clamp(0.0, 1.0)
    }
}

/// The decimal logarithm of a positive number, accurate to 2^-13, which is sufficient for a pixel.
fn logarithm(mut value: f64) -> f64 {
    let mut whole = 0.0;
    while value >= 10.0 {
        value /= 10.0;
        whole += 1.0;
    }
    while value < 1.0 && value > 0.0 {
        value *= 10.0;
        whole -= 1.0;
    }
    let (mut part, mut bit) = (0.0, 0.5);
    for _ in 0..13 {
        value *= value;
        if value >= 10.0 {
            value /= 10.0;
            part += bit;
        }
        bit *= 0.5;
    }
    whole + part
}

fn height(section: &Section) -> f64 {
    GAP + BAR * section.figures.len() as f64
}

fn legend(svg: &mut Drawing) {
    let kinds = [Role::Ours, Role::Peer, Role::Ceiling];
    for (i, role) in kinds.into_iter().enumerate() {
        let x = WIDTH - 330.0 + 105.0 * i as f64;
        svg.bar(role, [x, 18.0, 18.0, 11.0]);
        svg.text("tick", [x + 25.0, 28.0], Anchor::Start, role.name());
    }
}

fn guide(svg: &mut Drawing, scale: &Scale, power: i32, height: f64) {
    let value = format!("1e{power}").parse().unwrap_or(1.0);
    let x = scale.x(value);
    svg.0.path("guide", format_args!("M{x:.1} {TOP} V{:.1}", height - 24.0), "");
    svg.text("tick", [x, height - 8.0], Anchor::Middle, &format!("{}/s", label(value)));
}

/// A power of ten without decimals.
fn label(value: f64) -> String {
    rate(value).replace(".00", "").replace(".0", "")
}

fn bars(svg: &mut Drawing, scale: &Scale, section: &Section, y: f64) {
    svg.text("name", [20.0, y + 20.0], Anchor::Start, &format!("{} ({}s)", section.name, section.item));
    for (i, figure) in section.figures.iter().enumerate() {
        let top = y + 26.0 + BAR * i as f64;
        let x = scale.x(figure.rate());
        let name = match figure.threads {
            1 => figure.name.clone(),
            n => format!("{}, {n} threads", figure.name),
        };
        svg.bar(figure.role, [LEFT, top + 2.0, x - LEFT, BAR - 4.0]);
        svg.text("tick", [LEFT - 8.0, top + 11.0], Anchor::End, &name);
        svg.text("tick", [x + 6.0, top + 11.0], Anchor::Start, &rate(figure.rate()));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::example;
    use super::*;

    #[test]
    fn logarithms_are_good_to_a_pixel() {
        assert!((logarithm(2.0) - std::f64::consts::LOG10_2).abs() < 2e-4);
        assert!((logarithm(3e7) - 7.477_12).abs() < 2e-4);
        assert!((logarithm(0.02) + 1.698_97).abs() < 2e-4);
        assert_eq!(logarithm(1000.0), 3.0);
    }

    #[test]
    fn every_figure_has_its_bar() {
        let text = plot(&example());
        // three in the legend, and one for each figure
        assert_eq!(text.matches("<rect class=\"ours\"").count(), 2);
        assert_eq!(text.matches("<rect class=\"peer\"").count(), 2);
        assert_eq!(text.matches("<rect class=\"ceiling\"").count(), 2);
        assert!(text.contains("VecGeom") && text.contains(">100 M<"));
        assert!(text.starts_with("<svg ") && text.trim_end().ends_with("</svg>"));
    }

    #[test]
    fn a_report_without_figures_is_a_picture_too() {
        let mut report = example();
        report.sections.clear();
        assert!(plot(&report).contains("</svg>"));
    }
}
