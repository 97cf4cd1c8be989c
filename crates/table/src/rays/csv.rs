//! CSV reader of rays.
//!
//! Splits lines itself and fields with `csv-core`. Line numbers therefore agree with editors for all line endings, the length of
//! lines is bounded, and an unclosed quote cannot extend over the rest of the file.

use std::io::{self, BufRead, BufReader, Read};

use csv_core::ReadRecordResult;
use rayweave_error::did_you_mean;

use super::RayChunk;
use super::check::check_row;
use super::columns::{COLUMNS, Content, Present, RAY_COLUMNS, Row};
use super::problems::{ProblemList, RayLocation};
use super::source::{Progress, RaySource};
use crate::error::RayProblem;
use crate::npy_header;

/// The maximal length of a line, in bytes. Six numbers take at most 150.
const MAX_LINE: usize = 1 << 16;

/// The maximal number of fields that are split.
const MAX_FIELDS: usize = 64;

/// A CSV source whose header has been read.
pub(super) struct CsvRays {
    lines: Lines,
    fields: Fields,
    /// The field with each of [`COLUMNS`].
    field_of: FieldOf,
    present: Present,
    total: Option<u64>,
}

/// The field with each column, if there is one.
type FieldOf = [Option<usize>; COLUMNS.len()];

impl CsvRays {
    /// Reads the header; `None` if it is invalid.
    pub(super) fn open(
        source: impl Read + Send + 'static,
        total: Option<u64>,
        content: Content,
        problems: &mut ProblemList,
    ) -> io::Result<Option<Self>> {
        let mut lines = Lines::new(Box::new(source));
        let mut fields = Fields::new();
        let Some(line) = lines.next()? else {
            let message = "the file is empty: the first line must be ox,oy,oz,dx,dy,dz.";
            problems.add(RayProblem::whole(message));
            return Ok(None);
        };
        let header = check_start(&line).and_then(|()| fields.split(&line));
        let field_of = match header {
            Ok(()) => read_header(&fields, line.number, content, problems),
            Err(message) => {
                problems.add(header_problem(line.number, message));
                None
            }
        };
        Ok(field_of.map(|field_of| {
            let present = field_of.map(|field| field.is_some());
            Self { lines, fields, field_of, present, total }
        }))
    }
}

impl RaySource for CsvRays {
    fn fill(
        &mut self,
        chunk: &mut RayChunk,
        first: u64,
        max_rays: usize,
        problems: &mut ProblemList,
    ) -> io::Result<u64> {
        let mut rows = 0;
        while rows < max_rays as u64 && !problems.is_full() {
            let Some(line) = self.lines.next()? else {
                break;
            };
            let location = RayLocation { line: Some(line.number), row: first + rows };
            match self.fields.split(&line) {
                Err(message) => problems.add(location.problem(None, message)),
                Ok(()) => {
                    if let Some(row) = read_row(&self.fields, &self.field_of, location, problems)
                        && check_row(&row, &self.present, location, problems)
                    {
                        chunk.push(&row, &self.present);
                    }
                }
            }
            rows += 1;
        }
        Ok(rows)
    }

    fn progress(&self) -> Progress {
        Progress { done: self.lines.bytes, total: self.total }
    }

    fn rays(&self) -> Option<u64> {
        None
    }
}

/// The numbers of a line; columns that the file lacks are 0.
fn read_row(
    fields: &Fields,
    field_of: &FieldOf,
    location: RayLocation,
    problems: &mut ProblemList,
) -> Option<Row> {
    let expected = field_of.iter().flatten().count();
    if fields.count != expected {
        problems.add(location.problem(None, wrong_count(fields.count, expected)));
        return None;
    }
    let mut row = Row::default();
    let mut all_numbers = true;
    for (column, field) in field_of.iter().enumerate().filter_map(|(column, field)| Some((column, (*field)?)))
    {
        let field = fields.get(field);
        match parse(field) {
            Some(x) => row[column] = x,
            None => {
                let message = format!("{} is {}: it must be a number.", COLUMNS[column], excerpt(field));
                problems.add(location.problem(Some(column), message));
                all_numbers = false;
            }
        }
    }
    all_numbers.then_some(row)
}

fn wrong_count(count: usize, expected: usize) -> String {
    let suggestion = match count {
        _ if count < expected => " Check that the file is complete.",
        _ if count == 2 * expected => " Write decimals with a point, not a comma.",
        _ => "",
    };
    let plural = if count == 1 { "" } else { "s" };
    let expected = ["six", "seven", "eight"].get(expected.wrapping_sub(6)).copied().unwrap_or("more");
    format!("the line has {count} field{plural}: a ray has {expected}.{suggestion}")
}

fn parse(field: &[u8]) -> Option<f64> {
    str::from_utf8(field).ok()?.parse().ok()
}

/// A field in a message: quoted, with control characters escaped, shortened.
fn excerpt(field: &[u8]) -> String {
    let text = String::from_utf8_lossy(field);
    match text.char_indices().nth(30) {
        _ if text.is_empty() => "empty".into(),
        Some((end, _)) => format!("{:?}...", &text[..end]),
        None => format!("{text:?}"),
    }
}

/// Rejects files that are not CSV.
fn check_start(line: &Line) -> Result<(), String> {
    if npy_header::is_npy(line.bytes) {
        return Err("this is an NPY file: the extension .csv is for text. Name it .npy.".into());
    }
    if line.bytes.starts_with(b"\xff\xfe") || line.bytes.starts_with(b"\xfe\xff") {
        return Err("the text is UTF-16: CSV is read as UTF-8. Save it as UTF-8.".into());
    }
    Ok(())
}

fn header_problem(line: u64, message: String) -> RayProblem {
    RayProblem { line: Some(line), ..RayProblem::whole(message) }
}

/// The field of each column, if the header has the six required columns and no unsupported ones.
fn read_header(fields: &Fields, line: u64, content: Content, problems: &mut ProblemList) -> Option<FieldOf> {
    if let Some(message) = not_a_header(fields) {
        problems.add(header_problem(line, message));
        return None;
    }
    let names: Vec<_> = (0..fields.count).map(|i| fields.get(i)).collect();
    let known = content.columns();
    let is_known = |column: &str| known.contains(&column);
    let position =
        |column: &str| names.iter().position(|name| is_known(column) && *name == column.as_bytes());
    let positions = COLUMNS.map(position);
    let absent = |columns: &[&'static str]| -> Vec<&'static str> {
        let columns = columns.iter().zip(&positions).filter(|(_, position)| position.is_none());
        columns.map(|(column, _)| *column).collect()
    };
    let (missing, absent) = (absent(&RAY_COLUMNS), absent(known));

    if positions.iter().all(Option::is_none) && names.iter().all(|name| meant(name, &absent).is_none()) {
        // a file of a different format may be confidential, so nothing of it is quoted
        let message =
            "the file is not a table of rays: the first line has none of the names ox,oy,oz,dx,dy,dz.";
        problems.add(header_problem(line, message.to_owned()));
        return None;
    }
    let mut messages = Vec::new();
    for (i, name) in names.iter().enumerate() {
        let column = known.iter().position(|column| column.as_bytes() == *name);
        match column {
            None => messages.push(unknown_column(name, &absent)),
            Some(column) if positions[column] != Some(i) => {
                messages
                    .push(format!("the column {} occurs twice: column names are unique.", COLUMNS[column]));
            }
            Some(_) => {}
        }
    }
    if !missing.is_empty() {
        let (columns, missing) = (if missing.len() == 1 { "column" } else { "columns" }, missing.join(", "));
        let needed = "a ray file needs ox, oy, oz, dx, dy and dz, in any order";
        messages.push(format!("missing {columns} {missing}: {needed}."));
    }
    let is_valid = messages.is_empty();
    messages.into_iter().for_each(|message| problems.add(header_problem(line, message)));
    is_valid.then_some(positions)
}

/// The message about a first line that is not a header.
fn not_a_header(fields: &Fields) -> Option<String> {
    let first = fields.get(0);
    if (0..fields.count).all(|i| parse(fields.get(i)).is_some()) {
        return Some(
            "the first line has numbers: it must be the header. Insert the line ox,oy,oz,dx,dy,dz.".into(),
        );
    }
    if first.starts_with(b"#") {
        return Some(
            "the header begins with #: CSV has no comments. \
             Remove it, or pass comments=\"\" to numpy.savetxt."
                .into(),
        );
    }
    let separator = first.iter().find(|c| b";\t ".contains(c)).filter(|_| fields.count == 1)?;
    let name = match separator {
        b';' => "semicolons",
        b'\t' => "tabs",
        _ => "spaces",
    };
    Some(format!("fields are separated by {name}: CSV is read with commas. Write it with commas."))
}

/// The absent column that was probably meant.
fn meant<'a>(name: &[u8], absent: &[&'a str]) -> Option<&'a str> {
    did_you_mean(&String::from_utf8_lossy(name), absent.iter().copied())
}

/// The message about an unsupported column, with the absent column that was probably meant.
fn unknown_column(name: &[u8], absent: &[&str]) -> String {
    let suggestion = match meant(name, absent) {
        Some(column) => format!(" Did you mean {column}?"),
        None if absent.is_empty() => " Remove it.".into(),
        None => String::new(),
    };
    let column = if name.is_empty() { "without a name".into() } else { excerpt(name) };
    format!("unknown column {column}.{suggestion}")
}

/// The fields of one line.
struct Fields {
    splitter: csv_core::Reader,
    text: Vec<u8>,
    ends: [usize; MAX_FIELDS],
    count: usize,
}

impl Fields {
    fn new() -> Self {
        Self {
            splitter: csv_core::Reader::new(),
            // unquoting never lengthens a line; one byte is the line ending
            text: vec![0; MAX_LINE + 1],
            ends: [0; MAX_FIELDS],
            count: 0,
        }
    }

    /// Splits a line into fields; `Err` is the message about an invalid line.
    fn split(&mut self, line: &Line) -> Result<(), String> {
        if line.too_long {
            return Err(format!("the line is longer than {MAX_LINE} bytes: a ray takes 150 at most."));
        }
        self.splitter.reset();
        let (result, read, _, count) = self.splitter.read_record(line.bytes, &mut self.text, &mut self.ends);
        match result {
            ReadRecordResult::Record if read < line.bytes.len() => {
                Err("the line has a carriage return inside: lines end with \\n or \\r\\n.".into())
            }
            ReadRecordResult::Record => {
                self.count = count;
                Ok(())
            }
            ReadRecordResult::OutputEndsFull => {
                Err(format!("the line has more than {MAX_FIELDS} fields: a ray has six."))
            }
            _ => Err("a quote is not closed on its line: a field cannot extend over several lines.".into()),
        }
    }

    /// A field without surrounding spaces; empty if it does not exist.
    fn get(&self, i: usize) -> &[u8] {
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        let exists = i < self.count;
        if exists { self.text[start..self.ends[i]].trim_ascii() } else { b"" }
    }
}

/// A line that is not blank. `bytes` ends with one `\n` and has no other trailing whitespace.
struct Line<'a> {
    number: u64,
    bytes: &'a [u8],
    too_long: bool,
}

/// Splits a source into lines of bounded length.
struct Lines {
    source: BufReader<Box<dyn Read + Send>>,
    line: Vec<u8>,
    number: u64,
    bytes: u64,
}

impl Lines {
    fn new(source: Box<dyn Read + Send>) -> Self {
        Self { source: BufReader::with_capacity(MAX_LINE, source), line: Vec::new(), number: 0, bytes: 0 }
    }

    /// The next line that is not blank; `None` at the end.
    fn next(&mut self) -> io::Result<Option<Line<'_>>> {
        loop {
            self.line.clear();
            let mut bounded = (&mut self.source).take(MAX_LINE as u64);
            let read = bounded.read_until(b'\n', &mut self.line)?;
            if read == 0 {
                return Ok(None);
            }
            let too_long = read == MAX_LINE && self.line.last() != Some(&b'\n');
            self.bytes += read as u64;
            self.number += 1;
            if too_long {
                self.skip_rest_of_line()?;
            }
            self.normalise();
            if too_long || self.line != b"\n" {
                return Ok(Some(Line { number: self.number, bytes: &self.line, too_long }));
            }
        }
    }

    fn skip_rest_of_line(&mut self) -> io::Result<()> {
        loop {
            let buffer = self.source.fill_buf()?;
            let end = buffer.iter().position(|&b| b == b'\n');
            let count = end.map_or(buffer.len(), |end| end + 1);
            self.source.consume(count);
            self.bytes += count as u64;
            if count == 0 || end.is_some() {
                return Ok(());
            }
        }
    }

    /// Normalises the line ending and removes a byte order mark.
    fn normalise(&mut self) {
        let end = self.line.trim_ascii_end().len();
        self.line.truncate(end);
        self.line.push(b'\n');
        if self.number == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
            self.line.drain(..3);
        }
    }
}
