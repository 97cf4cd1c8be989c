//! A writer of SVG 1.1: a few elements, a paper background, and a style sheet for light and dark mode.
//!
//! ```
//! use rayweave_draw::svg::{Anchor, Svg};
//!
//! let mut svg = Svg::default();
//! svg.circle("axis", [20.0, 20.0], 10.0, "");
//! svg.text("name", [40.0, 24.0], Anchor::Start, "a & b", "a & b");
//! let document = svg.finish([120.0, 40.0], "a circle", "One circle with a name.", "");
//! assert!(document.starts_with("<svg ") && document.contains("a &amp; b"));
//! ```

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use rayweave_render::Rgba;
use std::fmt::{Display, Write};

/// The body of a drawing. Lengths are in pixels, x to the right and y down. Classes of the style sheet set the appearance of
/// elements; `extra` parameters are additional attributes, written verbatim, with a leading space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Svg(String);

/// The anchor of a text relative to its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The text starts at the position.
    Start,
    /// The text is centred on the position.
    Middle,
    /// The text ends at the position.
    End,
}

/// The paint of lines and texts without their own colour: dark in light mode, light in dark mode.
pub const INK: &str = "currentColor";

/// The style sheet of all drawings. The paper is always drawn, so that a drawing is legible on a page of any colour.
const STYLE: &str = "\
svg { color: #1d2733 }
text { font-family: 'Helvetica Neue', Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif; fill: currentColor }
.paper { fill: #ffffff }
.title { font-size: 15px; font-weight: 600 }
.name { font-size: 13px }
.result { font-size: 13px; font-weight: 700 }
.number { font-size: 10.5px; fill: #46525f; stroke: #ffffff; stroke-width: 3; paint-order: stroke }
.tick { font-size: 11px; fill: #6b7683 }
.axis { stroke: #8d97a3; stroke-width: 1; fill: none }
.guide { stroke: #e3e7ec; stroke-width: 1; fill: none }
.base { stroke: #cbd2da; stroke-width: 1; fill: none }
";

/// The style sheet of dark mode.
const DARK: &str = "\
svg { color: #e4e9ee }
.paper { fill: #14191f }
.number { fill: #b8c2cc; stroke: #14191f }
.tick { fill: #98a3ae }
.axis { stroke: #76818c }
.guide { stroke: #2a323a }
.base { stroke: #3b444e }
";

impl Svg {
    /// Adds a path with a class of the style sheet.
    pub fn path(&mut self, class: &str, path: impl Display, extra: &str) {
        self.line(format_args!(r#"<path class="{class}" d="{path}"{extra}/>"#));
    }

    /// Adds a rectangle: left, top, width, height.
    pub fn rectangle(&mut self, class: &str, [x, y, w, h]: [f64; 4], extra: &str) {
        let (x, y, w, h) = (Pixels(x), Pixels(y), Pixels(w), Pixels(h));
        self.line(format_args!(r#"<rect class="{class}" x="{x}" y="{y}" width="{w}" height="{h}"{extra}/>"#));
    }

    /// Adds a circle.
    pub fn circle(&mut self, class: &str, centre: [f64; 2], radius: f64, extra: &str) {
        let (x, y, r) = (Pixels(centre[0]), Pixels(centre[1]), Pixels(radius));
        self.line(format_args!(r#"<circle class="{class}" cx="{x}" cy="{y}" r="{r}"{extra}/>"#));
    }

    /// Adds a PNG image in a rectangle: left, top, width, height. The file is embedded as a data URL (RFC 2397).
    pub fn image(&mut self, [x, y, w, h]: [f64; 4], png: &[u8]) {
        let (x, y, w, h, data) = (Pixels(x), Pixels(y), Pixels(w), Pixels(h), STANDARD.encode(png));
        self.line(format_args!(
            r#"<image x="{x}" y="{y}" width="{w}" height="{h}" href="data:image/png;base64,{data}"/>"#
        ));
    }

    /// Adds a filled rectangle with a tooltip.
    pub fn named_rectangle(&mut self, class: &str, [x, y, w, h]: [f64; 4], fill: &str, name: &str) {
        let (x, y, w, h, name) = (Pixels(x), Pixels(y), Pixels(w), Pixels(h), escape(name));
        self.line(format_args!(
            r#"<rect class="{class}" x="{x}" y="{y}" width="{w}" height="{h}" fill="{fill}"><title>{name}</title></rect>"#
        ));
    }

    /// Adds a text, with a tooltip if it differs from the text.
    pub fn text(&mut self, class: &str, at: [f64; 2], anchor: Anchor, text: &str, tooltip: &str) {
        let (x, y) = (Pixels(at[0]), Pixels(at[1]));
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let title =
            if tooltip == text { String::new() } else { format!("<title>{}</title>", escape(tooltip)) };
        let text = escape(text);
        self.line(format_args!(
            r#"<text class="{class}" x="{x}" y="{y}" text-anchor="{anchor}">{title}{text}</text>"#
        ));
    }

    /// Adds a text whose middle is at a position, turned about it by an angle in degrees, clockwise as y points down.
    pub fn middle_text(&mut self, class: &str, at: [f64; 2], degrees: f64, text: &str) {
        let (x, y, text) = (Pixels(at[0]), Pixels(at[1]), escape(text));
        let turn = match degrees == 0.0 {
            true => String::new(),
            false => format!(r#" transform="rotate({} {x} {y})""#, Pixels(degrees)),
        };
        self.line(format_args!(
            r#"<text class="{class}" x="{x}" y="{y}" text-anchor="middle"{turn}>{text}</text>"#
        ));
    }

    fn line(&mut self, line: impl Display) {
        // writing to a string cannot fail
        let _ = writeln!(self.0, "{line}");
    }

    /// Returns the complete document, given its width and height, a title and a description for screen readers (an empty
    /// description is left out), and the style of additional classes.
    pub fn finish(self, [width, height]: [f64; 2], title: &str, description: &str, style: &str) -> String {
        let (w, h, title, body) = (Pixels(width), Pixels(height), escape(title), self.0);
        let size = format!(r#"width="{w}" height="{h}" viewBox="0 0 {w} {h}""#);
        let description = match description {
            "" => String::new(),
            text => format!("<desc>{}</desc>\n", escape(text)),
        };
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" {size} role=\"img\">\n<title>{title}</title>\n{description}\
             <style>\n{STYLE}{style}@media (prefers-color-scheme: dark) {{\n{DARK}}}\n</style>\n\
             <rect class=\"paper\" width=\"{w}\" height=\"{h}\"/>\n{body}</svg>\n"
        )
    }
}

/// A length in the drawing, written to a hundredth of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixels(pub f64);

impl Display for Pixels {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // adding 0 turns -0 into 0
        let hundredths = (100.0 * self.0).round() + 0.0;
        write!(f, "{}", hundredths / 100.0)
    }
}

/// The paint of a colour, as `#rrggbb`, without its opacity.
pub fn paint(colour: Rgba) -> String {
    format!("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue)
}

/// Escapes a text for the content of an element or attribute. Characters that XML 1.0 excludes become U+FFFD.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' | '\r' => out.push(' '),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_escaped() {
        assert_eq!(escape("a<b & \"c\" > 'd'"), "a&lt;b &amp; &quot;c&quot; &gt; &#39;d&#39;");
        assert_eq!(escape("\u{0}\u{1b}[31m\n\u{ffff}ä"), "\u{fffd}\u{fffd}[31m \u{fffd}ä");
    }

    #[test]
    fn lengths_are_short() {
        let texts = [1.0, 0.1 + 0.2, -0.001, 12.345].map(|x| Pixels(x).to_string());
        assert_eq!(texts, ["1", "0.3", "0", "12.35"]);
    }
}
