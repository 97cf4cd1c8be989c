//! Tokenizer for text formats: lines and whitespace-separated tokens, with line numbers for errors.

use crate::{FileError, Location};
use rayweave_math::Vec3;
use std::io::{BufRead, Read};

/// The maximal length of a line, in bytes.
const MAX_LINE_LENGTH: u64 = 1 << 22;

/// Tokenizer. Skips comments, which reach from a marker to the end of the line.
pub struct Tokens<R> {
    from: R,
    comment: Option<char>,
    /// The line terminator, detected when the first line is read.
    terminator: Option<u8>,
    text: String,
    raw: Vec<u8>,
    /// The position in `text` after the last token.
    next: usize,
    line: u64,
    /// Number of bytes read so far.
    bytes: u64,
}

impl<R: BufRead> Tokens<R> {
    pub fn new(from: R, comment: Option<char>) -> Tokens<R> {
        Tokens {
            from,
            comment,
            terminator: None,
            text: String::new(),
            raw: Vec::new(),
            next: 0,
            line: 0,
            bytes: 0,
        }
    }

    pub fn location(&self) -> Location {
        Location::Line(self.line.max(1))
    }

    /// The number of bytes up to the end of this line.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The reader, positioned after the lines read so far.
    pub fn into_inner(self) -> R {
        self.from
    }

    /// Reads the next line; false at the end of the file.
    pub fn next_line(&mut self) -> Result<bool, FileError> {
        self.raw.clear();
        let terminator = match self.terminator {
            Some(terminator) => terminator,
            None => line_terminator(self.from.fill_buf()?),
        };
        self.terminator = Some(terminator);
        let count = (&mut self.from).take(MAX_LINE_LENGTH).read_until(terminator, &mut self.raw)?;
        self.line += u64::from(count > 0);
        self.bytes += count as u64;
        if count as u64 == MAX_LINE_LENGTH {
            let problem = format!("the line is longer than {MAX_LINE_LENGTH} bytes");
            return Err(FileError::syntax(self.location(), problem, "the file is probably not text"));
        }
        // names may have any encoding and are never compared
        self.text.clear();
        self.text.push_str(&String::from_utf8_lossy(&self.raw));
        self.next = 0;
        if let Some(end) = self.comment.and_then(|marker| self.text.find(marker)) {
            self.text.truncate(end);
        }
        Ok(count > 0)
    }

    /// The rest of the line.
    pub fn rest(&self) -> &str {
        self.text.get(self.next..).unwrap_or("").trim()
    }

    /// Skips the rest of the line.
    pub fn skip_line(&mut self) {
        self.next = self.text.len();
    }

    /// The next token of this line.
    pub fn token_in_line(&mut self) -> Option<&str> {
        let rest = self.text.get(self.next..)?;
        let start = self.next + rest.find(|c: char| !c.is_whitespace())?;
        let end = self.text[start..].find(char::is_whitespace).map_or(self.text.len(), |k| start + k);
        self.next = end;
        Some(&self.text[start..end])
    }

    /// The next token of this or a later line; `None` at the end of the file.
    pub fn token(&mut self) -> Result<Option<&str>, FileError> {
        while self.rest().is_empty() {
            if !self.next_line()? {
                return Ok(None);
            }
        }
        Ok(self.token_in_line())
    }

    /// Reads a keyword, ignoring case.
    pub fn expect(&mut self, keyword: &str) -> Result<(), FileError> {
        let found = self.required(keyword)?;
        if found.eq_ignore_ascii_case(keyword) {
            return Ok(());
        }
        let problem = format!("`{}` is not expected here", excerpt(found));
        Err(FileError::syntax(self.location(), problem, format!("the format requires `{keyword}`")))
    }

    /// The next token; an error at the end of the file, which names what is missing.
    fn required(&mut self, what: &str) -> Result<&str, FileError> {
        if self.token()?.is_none() {
            return Err(FileError::truncated(self.location(), what));
        }
        // finds the last token again: the borrow checker rejects returning it from the condition above
        let end = self.next;
        let start = self.text[..end]
            .rfind(char::is_whitespace)
            .map_or(0, |k| k + self.text[k..].chars().next().map_or(1, char::len_utf8));
        Ok(&self.text[start..end])
    }

    /// Reads a finite number. `what` names it in errors.
    pub fn number(&mut self, what: &str) -> Result<f64, FileError> {
        let token = self.required(what)?;
        let reason = match token.parse::<f64>() {
            Ok(number) if number.is_finite() => return Ok(number),
            Ok(_) => "it must be finite",
            Err(_) => "it must be a number",
        };
        let problem = format!("{what} is `{}`", excerpt(token));
        Err(FileError::syntax(self.location(), problem, reason))
    }

    /// Reads three coordinates.
    pub fn point(&mut self) -> Result<Vec3, FileError> {
        Ok(Vec3::new(
            self.number("a coordinate")?,
            self.number("a coordinate")?,
            self.number("a coordinate")?,
        ))
    }

    /// Reads a nonnegative integer. `what` names it in errors.
    pub fn count(&mut self, what: &str) -> Result<u64, FileError> {
        let token = self.required(what)?;
        let found = token.parse::<u64>().map_err(|_| excerpt(token));
        found.map_err(|token| {
            let problem = format!("{what} is `{token}`");
            FileError::syntax(self.location(), problem, "it must be a nonnegative integer")
        })
    }
}

/// Line feed, or carriage return if the text has no line feeds (classic Mac OS).
fn line_terminator(start: &[u8]) -> u8 {
    if !start.contains(&b'\n') && start.contains(&b'\r') { b'\r' } else { b'\n' }
}

/// The beginning of a token, for messages.
pub fn excerpt(token: &str) -> String {
    let start: String = token.chars().take(24).collect();
    if start.len() < token.len() { start + "..." } else { start }
}
