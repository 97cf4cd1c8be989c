//! The few elements of SVG that drawings need.

use std::fmt::{Display, Write};

/// The body of a drawing.
#[derive(Default)]
pub struct Svg(String);

/// Where a text stands relative to its place.
#[derive(Clone, Copy)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

impl Svg {
    /// A path with a class of the style sheet.
    pub fn path(&mut self, class: &str, path: impl Display, extra: &str) {
        self.line(format_args!(r#"<path class="{class}" d="{path}"{extra}/>"#));
    }

    pub fn rectangle(&mut self, class: &str, [x, y, w, h]: [f64; 4], extra: &str) {
        let (x, y, w, h) = (Pixels(x), Pixels(y), Pixels(w), Pixels(h));
        self.line(format_args!(r#"<rect class="{class}" x="{x}" y="{y}" width="{w}" height="{h}"{extra}/>"#));
    }

    /// A rectangle of a colour whose name shows under the pointer.
    pub fn named_rectangle(&mut self, class: &str, [x, y, w, h]: [f64; 4], fill: &str, name: &str) {
        let (x, y, w, h, name) = (Pixels(x), Pixels(y), Pixels(w), Pixels(h), escaped(name));
        self.line(format_args!(
            r#"<rect class="{class}" x="{x}" y="{y}" width="{w}" height="{h}" fill="{fill}"><title>{name}</title></rect>"#
        ));
    }

    /// A text, with what the pointer shows there, if that is something else.
    pub fn text(&mut self, class: &str, at: [f64; 2], anchor: Anchor, text: &str, whole: &str) {
        let (x, y) = (Pixels(at[0]), Pixels(at[1]));
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let title = if whole == text { String::new() } else { format!("<title>{}</title>", escaped(whole)) };
        let text = escaped(text);
        self.line(format_args!(
            r#"<text class="{class}" x="{x}" y="{y}" text-anchor="{anchor}">{title}{text}</text>"#
        ));
    }

    fn line(&mut self, line: impl Display) {
        // writing to a string cannot fail
        let _ = writeln!(self.0, "{line}");
    }

    /// The whole document.
    pub fn finish(self, width: f64, height: f64, title: &str, style: &str) -> String {
        let (w, h, title, body) = (Pixels(width), Pixels(height), escaped(title), self.0);
        let size = format!(r#"width="{w}" height="{h}" viewBox="0 0 {w} {h}""#);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" {size} role=\"img\">\n<title>{title}</title>\n\
             <style>\n{style}</style>\n<rect class=\"paper\" width=\"{w}\" height=\"{h}\"/>\n{body}</svg>\n"
        )
    }
}

/// A length in the drawing, to a hundredth of a pixel.
pub struct Pixels(pub f64);

impl Display for Pixels {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // adding 0 makes -0 a 0
        let hundredths = (100.0 * self.0).round() + 0.0;
        write!(f, "{}", hundredths / 100.0)
    }
}

/// A text as content of an element or an attribute. Characters that XML 1.0 does not know become U+FFFD.
pub fn escaped(text: &str) -> String {
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
        assert_eq!(escaped("a<b & \"c\" > 'd'"), "a&lt;b &amp; &quot;c&quot; &gt; &#39;d&#39;");
        assert_eq!(escaped("\u{0}\u{1b}[31m\n\u{ffff}ä"), "\u{fffd}\u{fffd}[31m \u{fffd}ä");
    }

    #[test]
    fn lengths_are_short() {
        let texts = [1.0, 0.1 + 0.2, -0.001, 12.345].map(|x| Pixels(x).to_string());
        assert_eq!(texts, ["1", "0.3", "0", "12.35"]);
    }
}
