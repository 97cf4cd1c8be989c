//! Reader and writer of the NPY file header.
//!
//! *Source*: NumPy Enhancement Proposal 1 and the documentation of `numpy.lib.format`: magic number, version, length, then a
//! Python dictionary with `descr`, `fortran_order` and `shape`, padded with spaces and a newline to a multiple of 64.
//!
//! The crate `npyz` is not used here: its reader trusts any header length and reports damaged headers without a
//! location, and it adds a parser generator and a C build to every build of the command. It is the oracle of the tests.

use std::io::{self, Read};

use crate::Schema;

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// The maximal length of a header. Headers of arrays of numbers take some hundred bytes; a longer one is damaged.
const MAX_LENGTH: usize = 1 << 16;

/// True if a file with these first bytes is an NPY file.
pub(crate) fn is_npy(start: &[u8]) -> bool {
    start.starts_with(MAGIC)
}

/// Magic number, version and header of a table with this number of rows. The length depends on the schema only.
pub(crate) fn table(schema: &Schema, rows: u64) -> Vec<u8> {
    padded(&dictionary(schema, u64::MAX), &dictionary(schema, rows))
}

/// The same for an array of float32 numbers of shape (rows, ...), with the lengths of the other dimensions. The length depends on
/// these only.
pub(crate) fn single(rows: u64, inner: &[u64]) -> Vec<u8> {
    let inner: String = inner.iter().map(|length| format!(" {length},")).collect();
    let dictionary =
        |rows: u64| format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({rows},{inner}), }}");
    padded(&dictionary(u64::MAX), &dictionary(rows))
}

/// A header with a dictionary, as long as with the longest one.
fn padded(longest: &str, dictionary: &str) -> Vec<u8> {
    let (version, length_size): (u8, usize) = match longest.len() {
        _ if !longest.is_ascii() => (3, 4),
        // magic number and padding take at most 128 bytes
        length if length + 128 > usize::from(u16::MAX) => (2, 4),
        _ => (1, 2),
    };
    let prefix = MAGIC.len() + 2 + length_size;
    let total = (prefix + longest.len() + 1).next_multiple_of(64);
    let length = (total - prefix).to_le_bytes();

    let mut bytes = MAGIC.to_vec();
    bytes.extend([version, 0]);
    bytes.extend(&length[..length_size]);
    bytes.extend(dictionary.as_bytes());
    bytes.resize(total - 1, b' ');
    bytes.push(b'\n');
    bytes
}

fn dictionary(schema: &Schema, rows: u64) -> String {
    let field = |c: &crate::Column| format!("({}, '{}')", python_string(&c.name), c.dtype.npy());
    let fields: Vec<_> = schema.columns().iter().map(field).collect();
    let fields = fields.join(", ");
    format!("{{'descr': [{fields}], 'fortran_order': False, 'shape': ({rows},), }}")
}

/// A Python string literal.
fn python_string(text: &str) -> String {
    let mut literal = String::from("'");
    for c in text.chars() {
        match c {
            '\'' | '\\' => literal.extend(['\\', c]),
            c if c.is_control() => literal += &format!("\\u{:04x}", u32::from(c)),
            c => literal.push(c),
        }
    }
    literal + "'"
}

/// The contents of an NPY header.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct NpyHeader {
    /// The type string of a plain array (`<f8`), or the text of the field list of a structured array.
    pub(crate) descr: String,
    /// True if `descr` is a list of fields.
    pub(crate) structured: bool,
    pub(crate) fortran_order: bool,
    pub(crate) shape: Vec<u64>,
    /// The offset of the first value, in bytes.
    pub(crate) data_offset: u64,
}

/// Reads the header. An `Err` of the inner result is the message about an invalid header.
pub(crate) fn read(source: &mut impl Read) -> io::Result<Result<NpyHeader, String>> {
    let mut start = Vec::new();
    source.take(8).read_to_end(&mut start)?;
    if start.is_empty() {
        return Ok(Err("the file is empty: an NPY header is required.".into()));
    }
    if !is_npy(&start) {
        return Ok(Err("this is not an NPY file: it does not begin with \\x93NUMPY. \
             Write it with numpy.save, or name it .csv if it is text."
            .into()));
    }
    let length_size = match start.get(6) {
        None => return Ok(Err("the file ends within the NPY header: it is incomplete.".into())),
        Some(1) => 2,
        Some(2 | 3) => 4,
        Some(version) => {
            return Ok(Err(format!(
                "the NPY version {version} is unknown: versions 1, 2 and 3 are supported."
            )));
        }
    };
    read_dictionary(source, length_size)
}

fn read_dictionary(source: &mut impl Read, length_size: usize) -> io::Result<Result<NpyHeader, String>> {
    let mut length = [0; 4];
    let mut text = Vec::new();
    let count = read_some(source, &mut length[..length_size])?;
    let length = u32::from_le_bytes(length) as usize;
    if length > MAX_LENGTH {
        let problem = format!("the NPY header is damaged: its stated length is {length} bytes.");
        return Ok(Err(problem));
    }
    source.take(length as u64).read_to_end(&mut text)?;
    if count < length_size || text.len() < length {
        return Ok(Err("the file ends within the NPY header: it is incomplete.".into()));
    }
    let data_offset = (8 + length_size + length) as u64;
    let text = String::from_utf8_lossy(&text);
    let header = Parser { rest: text.trim() }.header(data_offset);
    Ok(header.ok_or_else(|| format!("the NPY header is damaged: it reads {:?}.", abridged(&text))))
}

/// Fills the buffer as far as possible; returns the number of bytes.
fn read_some(source: &mut impl Read, buffer: &mut [u8]) -> io::Result<usize> {
    let mut read = Vec::new();
    source.take(buffer.len() as u64).read_to_end(&mut read)?;
    buffer[..read.len()].copy_from_slice(&read);
    Ok(read.len())
}

pub(crate) fn abridged(text: &str) -> String {
    let text = text.trim();
    match text.char_indices().nth(80) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.into(),
    }
}

/// Parser for the Python literals that occur in headers. Methods return `None` for a damaged header.
struct Parser<'a> {
    rest: &'a str,
}

impl<'a> Parser<'a> {
    fn header(mut self, data_offset: u64) -> Option<NpyHeader> {
        let (mut descr, mut fortran_order, mut shape) = (None, None, None);
        self.token("{")?;
        while self.token("}").is_none() {
            let key = self.string()?;
            self.token(":")?;
            match key {
                "descr" => descr = Some(self.descr()?),
                "fortran_order" => fortran_order = Some(self.boolean()?),
                "shape" => shape = Some(self.tuple()?),
                _ => return None,
            }
            if self.token(",").is_none() && !self.rest.starts_with('}') {
                return None;
            }
        }
        let (descr, structured) = descr?;
        self.rest.is_empty().then_some(NpyHeader {
            descr,
            structured,
            fortran_order: fortran_order?,
            shape: shape?,
            data_offset,
        })
    }

    /// Consumes a token and the spaces after it.
    fn token(&mut self, token: &str) -> Option<()> {
        self.rest = self.rest.strip_prefix(token)?.trim_start();
        Some(())
    }

    /// A quoted string. Keys and type strings contain no escapes.
    fn string(&mut self) -> Option<&'a str> {
        let quote = self.rest.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
        let (text, rest) = self.rest[1..].split_once(quote)?;
        self.rest = rest.trim_start();
        Some(text)
    }

    /// A type string, or the text of a list of fields.
    fn descr(&mut self) -> Option<(String, bool)> {
        if !self.rest.starts_with('[') {
            return Some((self.string()?.into(), false));
        }
        let end = end_of_list(self.rest)?;
        let (list, rest) = self.rest.split_at(end);
        self.rest = rest.trim_start();
        Some((list.into(), true))
    }

    fn boolean(&mut self) -> Option<bool> {
        let is_true = self.token("True").map(|()| true);
        is_true.or_else(|| self.token("False").map(|()| false))
    }

    /// A tuple of lengths, which Python 2 wrote with a suffix L.
    fn tuple(&mut self) -> Option<Vec<u64>> {
        let (inner, rest) = self.rest.strip_prefix('(')?.split_once(')')?;
        self.rest = rest.trim_start();
        let inner = inner.trim();
        let inner = inner.strip_suffix(',').unwrap_or(inner);
        if inner.is_empty() {
            return Some(Vec::new());
        }
        let length = |text: &str| text.trim().trim_end_matches('L').parse().ok();
        inner.split(',').map(length).collect()
    }
}

/// The length of the bracketed list at the start of the text; brackets within strings do not count.
fn end_of_list(text: &str) -> Option<usize> {
    let mut depth = 0_usize;
    let mut quote = None;
    let mut escaped = false;
    for (i, c) in text.char_indices() {
        match (quote, c) {
            _ if escaped => escaped = false,
            (Some(_), '\\') => escaped = true,
            (Some(open), _) if c == open => quote = None,
            (Some(_), _) => {}
            (None, '\'' | '"') => quote = Some(c),
            (None, '[') => depth += 1,
            (None, ']') if depth <= 1 => return Some(i + 1),
            (None, ']') => depth -= 1,
            _ => {}
        }
    }
    None
}
