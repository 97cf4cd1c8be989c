//! A parser of the simplest TOML, which is nearly all of the text of large models: tables `[solid.name]` and `[[region]]` with
//! bare keys, decimal numbers, strings without escapes, booleans, lists and inline tables.
//!
//! It rejects any other text, valid or not, which is then left to the TOML parser. A text that it accepts has the same entries and
//! spans as with that parser, which takes several times as long because it makes lists of tokens and events and a syntax tree.

use crate::datum::{Datum, Table};
use crate::source::{Span, Spanned};
use std::ops::Range;

/// The deepest nesting of lists and inline tables, and the most keys of a table, whose repetitions are found by comparison.
const MAX_DEPTH: u32 = 8;
const MAX_KEYS: usize = 16;

/// The entries of a piece of a text; `None` if it is not in the simple form.
pub(super) fn parse(text: &str, range: Range<usize>) -> Option<Table> {
    let mut reader = Quick { text: text.get(..range.end)?, at: range.start };
    let mut top: Table = Vec::new();
    while reader.skip_blank_lines()? {
        reader.section(&mut top)?;
    }
    Some(top)
}

struct Quick<'t> {
    text: &'t str,
    at: usize,
}

impl Quick<'_> {
    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    /// Passes a byte.
    fn pass(&mut self, byte: u8) -> Option<()> {
        (self.peek()? == byte).then(|| self.at += 1)
    }

    fn skip_while(&mut self, is_skipped: impl Fn(u8) -> bool) {
        let rest = &self.text.as_bytes()[self.at..];
        self.at += rest.iter().position(|&byte| !is_skipped(byte)).unwrap_or(rest.len());
    }

    fn skip_spaces(&mut self) {
        self.skip_while(|byte| matches!(byte, b' ' | b'\t'));
    }

    /// Skips spaces, a comment and the line end after it. True if there was a line end.
    fn skip_line_end(&mut self) -> Option<bool> {
        self.skip_spaces();
        if self.peek() == Some(b'#') {
            // control characters are errors
            self.skip_while(|byte| is_printable(byte) || byte == b'\t');
        }
        match self.peek() {
            None => Some(false),
            Some(b'\r') => {
                self.at += 1;
                self.pass(b'\n').map(|()| true)
            }
            Some(_) => self.pass(b'\n').map(|()| true),
        }
    }

    /// Skips spaces, comments and empty lines. False at the end of the text.
    fn skip_blank_lines(&mut self) -> Option<bool> {
        loop {
            self.skip_spaces();
            match self.peek() {
                None => return Some(false),
                Some(b'#' | b'\r' | b'\n') => self.skip_line_end()?,
                Some(_) => return Some(true),
            };
        }
    }

    /// Reads a header and the entries below it.
    fn section(&mut self, top: &mut Table) -> Option<()> {
        let start = self.at;
        self.pass(b'[')?;
        let is_item = self.pass(b'[').is_some();
        let (key, name) = match is_item {
            true => (self.word("region")?, None),
            false => {
                let key = self.word("solid")?;
                self.pass(b'.')?;
                (key, Some(self.key()?))
            }
        };
        self.pass(b']')?;
        if is_item {
            self.pass(b']')?;
        }
        let header = Span::new(start, self.at);
        self.skip_line_end()?;
        let table = Spanned::new(Datum::Table(self.entries()?), header);
        let known = top.iter().position(|(own, _)| own.value == key.value);
        let at = known.unwrap_or_else(|| {
            // the span is that of the first header
            let (datum, span) = match is_item {
                true => (Datum::List(Vec::new()), header),
                false => (Datum::Table(Vec::new()), key.span),
            };
            top.push((key, Spanned::new(datum, span)));
            top.len() - 1
        });
        match (&mut top[at].1.value, name) {
            (Datum::List(items), None) => items.push(table),
            (Datum::Table(entries), Some(name)) => entries.push((name, table)),
            _ => return None,
        }
        Some(())
    }

    fn word(&mut self, word: &str) -> Option<Spanned<String>> {
        self.key().filter(|key| key.value == word)
    }

    /// A bare key.
    fn key(&mut self) -> Option<Spanned<String>> {
        let start = self.at;
        self.skip_while(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-'));
        let key = &self.text[start..self.at];
        (!key.is_empty()).then(|| Spanned::new(key.to_owned(), Span::new(start, self.at)))
    }

    /// The lines up to the next header.
    fn entries(&mut self) -> Option<Table> {
        // most tables of a large file have few entries
        let mut table: Table = Vec::with_capacity(2);
        while self.skip_blank_lines()? && self.peek() != Some(b'[') {
            self.entry(&mut table, 0)?;
            self.skip_line_end()?;
        }
        Some(table)
    }

    /// A key with its value, and the spaces after it.
    fn entry(&mut self, table: &mut Table, depth: u32) -> Option<()> {
        let key = self.key()?;
        let is_repeated = table.iter().any(|(own, _)| own.value == key.value);
        if is_repeated || table.len() == MAX_KEYS {
            return None;
        }
        self.skip_spaces();
        self.pass(b'=')?;
        self.skip_spaces();
        let value = self.value(depth)?;
        self.skip_spaces();
        table.push((key, value));
        Some(())
    }

    fn value(&mut self, depth: u32) -> Option<Spanned<Datum>> {
        let start = self.at;
        let datum = match self.peek()? {
            quote @ (b'"' | b'\'') => Datum::Text(self.string(quote)?),
            b'[' if depth < MAX_DEPTH => Datum::List(self.list(depth + 1)?),
            b'{' if depth < MAX_DEPTH => Datum::Table(self.table(depth + 1)?),
            b'-' | b'0'..=b'9' => Datum::Number(self.number()?),
            _ => Datum::Boolean(self.boolean()?),
        };
        Some(Spanned::new(datum, Span::new(start, self.at)))
    }

    /// A string on one line, without escapes.
    fn string(&mut self, quote: u8) -> Option<String> {
        self.at += 1;
        let start = self.at;
        self.skip_while(|byte| byte != quote && byte != b'\\' && is_printable(byte));
        let text = &self.text[start..self.at];
        self.pass(quote)?;
        // three quotation marks begin a string of several lines
        let is_long = text.is_empty() && self.peek() == Some(quote);
        (!is_long).then(|| text.to_owned())
    }

    fn list(&mut self, depth: u32) -> Option<Vec<Spanned<Datum>>> {
        self.at += 1;
        // most lists are vectors
        let mut list = Vec::with_capacity(3);
        loop {
            self.skip_space_of_list();
            if self.pass(b']').is_some() {
                break;
            }
            list.push(self.value(depth)?);
            self.skip_space_of_list();
            if self.pass(b',').is_none() {
                self.pass(b']')?;
                break;
            }
        }
        Some(list)
    }

    fn skip_space_of_list(&mut self) {
        self.skip_while(|byte| matches!(byte, b' ' | b'\t' | b'\n'));
    }

    /// An inline table on one line.
    fn table(&mut self, depth: u32) -> Option<Table> {
        self.at += 1;
        let mut table = Vec::with_capacity(1);
        self.skip_spaces();
        while self.pass(b'}').is_none() {
            self.entry(&mut table, depth)?;
            if self.pass(b',').is_some() {
                self.skip_spaces();
                // a comma after the last entry is left to the TOML parser
                if self.peek() == Some(b'}') {
                    return None;
                }
            } else if self.peek() != Some(b'}') {
                return None;
            }
        }
        table.shrink_to_fit();
        Some(table)
    }

    fn boolean(&mut self) -> Option<bool> {
        match self.key()?.value.as_str() {
            "true" => Some(true),
            "false" => Some(false),
            _ => None,
        }
    }

    /// A decimal number. Whole numbers of more than 18 digits and numbers that are too large for f64 are left to the TOML parser.
    fn number(&mut self) -> Option<f64> {
        let start = self.at;
        let _ = self.pass(b'-');
        let whole = self.digits()?;
        if whole.len() > 18 || (whole.len() > 1 && whole.starts_with('0')) {
            return None;
        }
        if self.pass(b'.').is_some() {
            self.digits()?;
        }
        if matches!(self.peek(), Some(b'e' | b'E')) {
            self.at += 1;
            if matches!(self.peek(), Some(b'+' | b'-')) {
                self.at += 1;
            }
            self.digits()?;
        }
        let is_ended =
            !self.peek().is_some_and(|byte| byte.is_ascii_alphanumeric() || b"_.:+-".contains(&byte));
        let value: f64 = self.text[start..self.at].parse().ok()?;
        (is_ended && value.is_finite()).then_some(value)
    }

    fn digits(&mut self) -> Option<&str> {
        let start = self.at;
        self.skip_while(|byte| byte.is_ascii_digit());
        (self.at > start).then(|| &self.text[start..self.at])
    }
}

/// True for bytes that are not control characters.
fn is_printable(byte: u8) -> bool {
    byte >= b' ' && byte != 0x7f
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};
    use std::sync::Arc;
    use toml::de::DeTable;

    /// True if a text is accepted; asserts that the TOML parser then finds the same.
    fn accepts(text: &str) -> bool {
        let Some(table) = parse(text, 0..text.len()) else { return false };
        let tree = DeTable::parse(text).unwrap_or_else(|error| panic!("{text:?}: {error}"));
        let (source, mut problems) = (Arc::new(Source::new(None, text.to_owned())), Vec::new());
        let expected = crate::datum::from_toml(tree.get_ref(), 0, &source, &mut problems);
        // with all spans; the order of problems is that of the text
        assert_eq!(format!("{table:?}"), format!("{expected:?}"), "{text:?}");
        assert!(problems.is_empty(), "{text:?}");
        true
    }

    const SOLID: &str = "# a ball\n[solid.b-1_2] # here\r\n\tsphere = { radius = 1.5e-3 , at=[-0, 20,\n 3.0 ] }\ntransform=[{translate=[1,2.5,-3]},{rotate_x=\"90 * k\"}]\nname = 'a \u{e4}'\n\n[[region]]\nsolid = 'b-1_2'\nopen = true\n[solid.c]\nexpr = ''\n[[region]]\nlist = []\nempty = {}";

    #[test]
    fn simple_text_is_read_as_by_the_toml_parser() {
        let cases =
            ["", "\n", "# only a comment", "[solid.a]", "[[region]]\n", "[solid.a]\nx = 0.5E+2", SOLID];
        assert!(cases.iter().all(|text| accepts(text)));
    }

    #[test]
    fn other_text_is_left_to_the_toml_parser() {
        let values = [
            "+1",
            "01",
            "-",
            "1_000",
            "0x10",
            "1.",
            ".5",
            "1e",
            "inf",
            "nan",
            "1e999",
            "1979-05-27",
            "07:32:00",
            "12345678901234567890",
            "\"a\\n\"",
            "\"\"\"a\"\"\"",
            "'''a'''",
            "'a",
            "\"a\nb\"",
            "'\u{7f}'",
            "[1,,2]",
            "[,]",
            "[1 2]",
            "{a=1,}",
            "{,}",
            "{a=1 b=2}",
            "{a=1,a=2}",
            "{a.b=1}",
            "{'a'=1}",
            "truely",
            "",
            "1 2",
            "[[[[[[[[[[1]]]]]]]]]]",
            "[1, # c\n2]",
            "{a=1,\nb=2}",
        ];
        for value in values {
            assert!(!accepts(&format!("[solid.a]\nx = {value}\n")), "{value}");
        }
        let texts = [
            "a = 1",
            "[solid]",
            "[solid.'a']",
            "[solid.a.b]",
            "[region]",
            "[[solid.a]]",
            "[medium.a]",
            "[solid.a] x = 1",
            "[solid.a]\nx",
            "[solid.a]\nx =",
            "[solid.a]\nx.y = 1",
            "[solid.a]\nx = 1\nx = 2",
            "[solid.a]\rx = 1",
            "\u{feff}[solid.a]",
            "[solid. a ]",
            "[solid.a",
            "[[region] ]",
            "# \u{1}\n",
        ];
        for text in texts {
            assert!(!accepts(text), "{text:?}");
        }
    }

    #[test]
    fn changed_text_is_read_as_by_the_toml_parser() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let characters: Vec<char> = SOLID.chars().collect();
        let mut accepted = 0;
        for _ in 0..4000 {
            let mut text = characters.clone();
            for _ in 0..rng.random_range(1..3) {
                let at = rng.random_range(0..text.len());
                let other = characters[rng.random_range(0..characters.len())];
                match rng.random_range(0..3) {
                    0 => drop(text.remove(at)),
                    1 => text.insert(at, other),
                    _ => text[at] = other,
                }
            }
            accepted += u32::from(accepts(&text.into_iter().collect::<String>()));
        }
        assert!(accepted > 400, "{accepted}");
    }
}
