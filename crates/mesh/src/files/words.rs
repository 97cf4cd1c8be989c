//! Text, line by line and word by word, with numbers of lines.

use super::{FileError, Place};
use rayweave_math::Vec3;
use std::io::{BufRead, Read};

/// The longest line, in bytes.
const LONGEST_LINE: u64 = 1 << 22;

/// Reads words. Comments, from a mark to the end of the line, are left out.
pub struct Words<R> {
    from: R,
    comment: Option<char>,
    /// What ends a line, once the first one is read.
    line_end: Option<u8>,
    text: String,
    read: Vec<u8>,
    /// Where in `text` the next word may begin.
    next: usize,
    line: u64,
    /// Bytes that came before this line.
    bytes: u64,
}

impl<R: BufRead> Words<R> {
    pub fn new(from: R, comment: Option<char>) -> Words<R> {
        Words {
            from,
            comment,
            line_end: None,
            text: String::new(),
            read: Vec::new(),
            next: 0,
            line: 0,
            bytes: 0,
        }
    }

    pub fn place(&self) -> Place {
        Place::Line(self.line.max(1))
    }

    /// Bytes up to the end of this line.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// What follows the lines that were read.
    pub fn into_inner(self) -> R {
        self.from
    }

    /// Goes to the next line; false at the end of the file.
    pub fn next_line(&mut self) -> Result<bool, FileError> {
        self.read.clear();
        let line_end = match self.line_end {
            Some(line_end) => line_end,
            None => line_end(self.from.fill_buf()?),
        };
        self.line_end = Some(line_end);
        let count = (&mut self.from).take(LONGEST_LINE).read_until(line_end, &mut self.read)?;
        self.line += u64::from(count > 0);
        self.bytes += count as u64;
        if count as u64 == LONGEST_LINE {
            return Err(FileError::syntax(
                self.place(),
                "a line of more than four million bytes (is it text?)",
            ));
        }
        // names may be in any encoding, and are not looked at
        self.text.clear();
        self.text.push_str(&String::from_utf8_lossy(&self.read));
        self.next = 0;
        if let Some(end) = self.comment.and_then(|mark| self.text.find(mark)) {
            self.text.truncate(end);
        }
        Ok(count > 0)
    }

    /// What is left of the line.
    pub fn rest(&self) -> &str {
        self.text.get(self.next..).unwrap_or("").trim()
    }

    /// Passes over what is left of the line.
    pub fn end_line(&mut self) {
        self.next = self.text.len();
    }

    /// The next word of this line.
    pub fn word_here(&mut self) -> Option<&str> {
        let rest = self.text.get(self.next..)?;
        let start = self.next + rest.find(|c: char| !c.is_whitespace())?;
        let end = self.text[start..].find(char::is_whitespace).map_or(self.text.len(), |k| start + k);
        self.next = end;
        Some(&self.text[start..end])
    }

    /// The next word of this or a later line; `None` at the end of the file.
    pub fn word(&mut self) -> Result<Option<&str>, FileError> {
        while self.rest().is_empty() {
            if !self.next_line()? {
                return Ok(None);
            }
        }
        Ok(self.word_here())
    }

    /// The next word, which has to be this, in letters of either case.
    pub fn expect(&mut self, wanted: &str) -> Result<(), FileError> {
        let found = self.wanted(wanted)?;
        if found.eq_ignore_ascii_case(wanted) {
            return Ok(());
        }
        let found = short(found);
        Err(FileError::syntax(self.place(), format!("`{found}` where `{wanted}` should be")))
    }

    fn wanted(&mut self, what: &str) -> Result<&str, FileError> {
        if self.word()?.is_none() {
            return Err(FileError::ends(self.place(), what));
        }
        // the word that was just passed, again: a borrow cannot be returned from a branch
        let end = self.next;
        let start = self.text[..end]
            .rfind(char::is_whitespace)
            .map_or(0, |k| k + self.text[k..].chars().next().map_or(1, char::len_utf8));
        Ok(&self.text[start..end])
    }

    /// The next word as a finite number.
    pub fn number(&mut self, what: &str) -> Result<f64, FileError> {
        let word = self.wanted(what)?;
        match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            Ok(_) => {
                let word = short(word);
                Err(FileError::syntax(self.place(), format!("{what} is `{word}` (it must be finite)")))
            }
            Err(_) => {
                let word = short(word);
                Err(FileError::syntax(self.place(), format!("{what} is `{word}` (it must be a number)")))
            }
        }
    }

    /// Three numbers.
    pub fn point(&mut self) -> Result<Vec3, FileError> {
        Ok(Vec3::new(
            self.number("a coordinate")?,
            self.number("a coordinate")?,
            self.number("a coordinate")?,
        ))
    }

    /// The next word as a whole number that is not negative.
    pub fn count(&mut self, what: &str) -> Result<u64, FileError> {
        let word = self.wanted(what)?;
        let found = word.parse::<u64>().map_err(|_| short(word));
        found.map_err(|word| {
            FileError::syntax(self.place(), format!("{what} is `{word}` (it must be a whole number, from 0)"))
        })
    }
}

/// A line feed, unless there are carriage returns alone, as old Macintoshes have them.
fn line_end(start: &[u8]) -> u8 {
    if !start.contains(&b'\n') && start.contains(&b'\r') { b'\r' } else { b'\n' }
}

/// The beginning of a word, for messages.
pub fn short(word: &str) -> String {
    let start: String = word.chars().take(24).collect();
    if start.len() < word.len() { start + "..." } else { start }
}
