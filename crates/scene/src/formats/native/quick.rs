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
        list.shrink_to_fit();
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
