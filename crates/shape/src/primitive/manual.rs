//! Manual pages of primitives, for help texts, documentation and editors.

use super::parameter::Parameter;

/// The manual page of a primitive. Its text is the header of the source file of the primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manual {
    /// Name in all interfaces: the keyword of the model file, the function in Python.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// The parameters, in order.
    pub parameters: &'static [Parameter],
    /// The names of the faces; `side0..sideN-1` stands for a numbered sequence.
    pub faces: &'static [&'static str],
    /// Condition for a point (x, y, z) to be inside.
    pub equation: &'static str,
    /// The whole page, in Markdown.
    pub text: &'static str,
}

/// The parameters as a Markdown table, as in every manual page.
pub fn parameter_table(parameters: &[Parameter]) -> String {
    let head =
        "| parameter | is | unit | range | default | meaning |\n| --- | --- | --- | --- | --- | --- |\n";
    parameters.iter().fold(head.to_owned(), |table, parameter| {
        let default = parameter.default_value().map(|value| value.to_string()).unwrap_or_default();
        table
            + &format!(
                "| `{}` | {} | {} | {} | {default} | {} |\n",
                parameter.name, parameter.kind, parameter.unit, parameter.range, parameter.summary
            )
    })
}

/// The length of [`page`].
pub(super) const fn page_length(source: &str) -> usize {
    copy_page(source.as_bytes(), &mut [])
}

/// The `//!` lines at the head of a source file, without their prefixes.
pub(super) const fn page<const N: usize>(source: &str) -> [u8; N] {
    let mut text = [0; N];
    copy_page(source.as_bytes(), &mut text);
    text
}

/// Copies as much of the page as fits and returns its full length.
const fn copy_page(source: &[u8], text: &mut [u8]) -> usize {
    let (mut from, mut to) = (0, 0);
    while is_page_line(source, from) {
        from += if from + 3 < source.len() && source[from + 3] == b' ' { 4 } else { 3 };
        loop {
            if from == source.len() {
                return to;
            }
            if to < text.len() {
                text[to] = source[from];
            }
            (from, to) = (from + 1, to + 1);
            if source[from - 1] == b'\n' {
                break;
            }
        }
    }
    to
}

const fn is_page_line(source: &[u8], at: usize) -> bool {
    at + 3 <= source.len() && source[at] == b'/' && source[at + 1] == b'/' && source[at + 2] == b'!'
}

/// The text of [`page`], a part of a `str` that is cut at ASCII characters.
pub(super) const fn as_text(page: &[u8]) -> &str {
    match std::str::from_utf8(page) {
        Ok(text) => text,
        Err(_) => "",
    }
}

/// The first line of a page.
pub(super) const fn first_line(page: &str) -> &str {
    let bytes = page.as_bytes();
    let mut end = 0;
    while end < bytes.len() && bytes[end] != b'\n' {
        end += 1;
    }
    page.split_at(end).0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_cut_from_its_file() {
        const SOURCE: &str = "//! One.\n//!\n//!  Two \u{b0}.\n\nuse x;\n//! not this";
        const PAGE: [u8; page_length(SOURCE)] = page(SOURCE);
        assert_eq!(as_text(&PAGE), "One.\n\n Two \u{b0}.\n");
        assert_eq!(first_line(as_text(&PAGE)), "One.");
        assert_eq!(page_length("use x;"), 0);
        assert_eq!(page_length("//!"), 0);
        assert_eq!(as_text(&page::<4>("//! only")), "only");
    }
}
