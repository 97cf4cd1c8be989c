//! Source texts and spans in them.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::OnceLock;

/// A range of bytes in a text. Positions above 4 GiB, far beyond the largest file, are stored as 4 GiB.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    // a large model has tens of millions of spans
    start: u32,
    end: u32,
}

impl Span {
    /// Creates a span from the first byte and the byte after the last.
    pub fn new(start: usize, end: usize) -> Span {
        let stored = |at: usize| u32::try_from(at).unwrap_or(u32::MAX);
        Span { start: stored(start), end: stored(end) }
    }

    /// The first byte.
    pub fn start(self) -> usize {
        self.start as usize
    }

    /// The byte after the last.
    pub fn end(self) -> usize {
        self.end as usize
    }

    /// The range of bytes.
    pub fn range(self) -> Range<usize> {
        self.start()..self.end()
    }

    /// The smallest span that contains both.
    pub fn to(self, other: Span) -> Span {
        Span { start: self.start.min(other.start), end: self.end.max(other.end) }
    }

    /// The span, offset by a number of bytes.
    pub(crate) fn shifted(self, by: usize) -> Span {
        Span::new(self.start() + by, self.end() + by)
    }
}

impl From<Range<usize>> for Span {
    fn from(range: Range<usize>) -> Span {
        Span::new(range.start, range.end)
    }
}

/// A value with its source span. Equality ignores the span.
#[derive(Clone, Debug, Default)]
pub struct Spanned<T> {
    /// The value.
    pub value: T,
    /// Span in the file; empty for values that are not from a file.
    pub span: Span,
}

impl<T> Spanned<T> {
    /// Creates a value with a span.
    pub fn new(value: T, span: impl Into<Span>) -> Spanned<T> {
        let span = span.into();
        Spanned { value, span }
    }
}

impl<T: PartialEq> PartialEq for Spanned<T> {
    fn eq(&self, other: &Spanned<T>) -> bool {
        self.value == other.value
    }
}

impl<T> From<T> for Spanned<T> {
    fn from(value: T) -> Spanned<T> {
        let span = Span::default();
        Spanned { value, span }
    }
}

impl From<&str> for Spanned<String> {
    fn from(value: &str) -> Spanned<String> {
        value.to_owned().into()
    }
}

/// A text with the name of the file that it comes from.
#[derive(Clone, Debug)]
pub struct Source {
    path: Option<PathBuf>,
    text: String,
    /// The first byte of each line, computed when a position is first needed: most files have no problems.
    line_starts: OnceLock<Vec<usize>>,
}

impl Default for Source {
    fn default() -> Source {
        Source::new(None, String::new())
    }
}

impl Source {
    /// Creates a source from a text, and the file that it was read from or another name for it.
    pub fn new(path: Option<PathBuf>, text: String) -> Source {
        Source { path, text, line_starts: OnceLock::new() }
    }

    fn line_starts(&self) -> &[usize] {
        self.line_starts.get_or_init(|| {
            let ends = self.text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
            std::iter::once(0).chain(ends.map(|(at, _)| at + 1)).collect()
        })
    }

    /// The file, if the text has one.
    pub fn path(&self) -> Option<&PathBuf> {
        self.path.as_ref()
    }

    /// The file for messages; `<text>` if there is none.
    pub fn name(&self) -> String {
        let path = self.path.as_ref().map(|path| path.display().to_string());
        path.unwrap_or_else(|| "<text>".to_owned())
    }

    /// The whole text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The part of the text in a range; empty if the range is not in the text.
    pub fn slice(&self, span: Span) -> &str {
        self.text.get(span.range()).unwrap_or_default()
    }

    /// Line and column of a byte, both from 1; columns count characters.
    pub fn line_column(&self, at: usize) -> (usize, usize) {
        let line = self.line_index(at);
        let before = self.text.get(self.line_starts()[line]..at).unwrap_or_default();
        (line + 1, before.chars().count() + 1)
    }

    /// The whole lines that a range overlaps, without the last line end (LF or CRLF), and the range relative to
    /// their start.
    pub(crate) fn lines_of(&self, span: Span) -> (usize, &str, Span) {
        let first = self.line_index(span.start());
        let last = self.line_index(span.end().max(span.start()));
        let start = self.line_starts()[first];
        let end = self.line_starts().get(last + 1).map_or(self.text.len(), |next| next - 1);
        let text = self.text.get(start..end).unwrap_or_default();
        let text = text.strip_suffix('\r').unwrap_or(text);
        let within = |at: usize| at.saturating_sub(start).min(text.len());
        (first + 1, text, Span::new(within(span.start()), within(span.end())))
    }

    fn line_index(&self, at: usize) -> usize {
        self.line_starts().partition_point(|start| *start <= at).max(1) - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_columns_count_from_one() {
        let source = Source::new(None, "a\n\u{e4}b\r\n\nlast".to_owned());
        let places =
            [(0, (1, 1)), (1, (1, 2)), (2, (2, 1)), (4, (2, 2)), (7, (3, 1)), (9, (4, 2)), (12, (4, 5))];
        for (at, expected) in places {
            assert_eq!(source.line_column(at), expected, "byte {at}");
        }
        assert_eq!(source.line_column(99).0, 4);
        assert_eq!(Source::default().line_column(0), (1, 1));
    }

    #[test]
    fn lines_of_a_range() {
        let source = Source::new(None, "one\ntwo\nthree".to_owned());
        assert_eq!(source.lines_of(Span::new(5, 6)), (2, "two", Span::new(1, 2)));
        assert_eq!(source.lines_of(Span::new(5, 10)), (2, "two\nthree", Span::new(1, 6)));
        assert_eq!(source.lines_of(Span::new(13, 13)), (3, "three", Span::new(5, 5)));
        assert_eq!(source.lines_of(Span::new(50, 60)), (3, "three", Span::new(5, 5)));
    }
}
