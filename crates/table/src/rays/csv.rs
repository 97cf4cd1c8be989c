//! Rays from CSV.
//!
//! Lines are cut here and fields by `csv-core`: so a line has a number that an editor shows, whatever its ending, and
//! a bounded length, and a quote that is never closed cannot swallow the file.

use std::io::{self, BufRead, BufReader, Read};

use csv_core::ReadRecordResult;

use super::{
    COLUMNS, Findings, Has, Kind, Place, Progress, RAY_COLUMNS, RayChunk, RaySource, Row, check_row,
};
use crate::error::RayProblem;
use crate::npy_header;

/// Six numbers need 150 bytes; a longer line than this is no line of rays.
const MAX_LINE: usize = 1 << 16;

/// A line with more fields is refused by their number anyway.
const MAX_FIELDS: usize = 64;

/// A CSV source whose header has been read.
pub(super) struct CsvRays {
    lines: Lines,
    fields: Fields,
    /// Field of the line that holds each of [`COLUMNS`].
    field_of: FieldOf,
    has: Has,
    total: Option<u64>,
}

/// Which field holds a column, if there is one.
type FieldOf = [Option<usize>; COLUMNS.len()];

impl CsvRays {
    /// Reads the header; `None` if it has problems.
    pub(super) fn open(
        source: impl Read + Send + 'static,
        total: Option<u64>,
        kind: Kind,
        found: &mut Findings,
    ) -> io::Result<Option<Self>> {
        let mut lines = Lines::new(Box::new(source));
        let mut fields = Fields::new();
        let Some(line) = lines.next()? else {
            found.add(RayProblem::whole("the file is empty (the first line is ox,oy,oz,dx,dy,dz)"));
            return Ok(None);
        };
        let header = check_start(&line).and_then(|()| fields.split(&line));
        let field_of = match header {
            Ok(()) => read_header(&fields, line.number, kind, found),
            Err(message) => {
                found.add(header_problem(line.number, message));
                None
            }
        };
        Ok(field_of.map(|field_of| {
            let has = field_of.map(|field| field.is_some());
            Self { lines, fields, field_of, has, total }
        }))
    }
}

impl RaySource for CsvRays {
    fn fill(
        &mut self,
        chunk: &mut RayChunk,
        first: u64,
        max_rays: usize,
        found: &mut Findings,
    ) -> io::Result<u64> {
        let mut rows = 0;
        while rows < max_rays as u64 && !found.is_full() {
            let Some(line) = self.lines.next()? else {
                break;
            };
            let place = Place { line: Some(line.number), row: first + rows };
            match self.fields.split(&line) {
                Err(message) => found.add(place.problem(None, message)),
                Ok(()) => {
                    if let Some(row) = read_row(&self.fields, &self.field_of, place, found)
                        && check_row(&row, &self.has, place, found)
                    {
                        chunk.push(&row, &self.has);
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

/// The numbers of a line; those of columns that the file does not have stay 0.
fn read_row(fields: &Fields, field_of: &FieldOf, place: Place, found: &mut Findings) -> Option<Row> {
    let wanted = field_of.iter().flatten().count();
    if fields.count != wanted {
        found.add(place.problem(None, wrong_count(fields.count, wanted)));
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
                let message = format!("{} is {} (not a number)", COLUMNS[column], shown(field));
                found.add(place.problem(Some(column), message));
                all_numbers = false;
            }
        }
    }
    all_numbers.then_some(row)
}

fn wrong_count(count: usize, wanted: usize) -> String {
    let suggestion = match count {
        _ if count < wanted => "; is the file cut off?",
        _ if count == 2 * wanted => "; write decimals with a point, not a comma",
        _ => "",
    };
    let plural = if count == 1 { "" } else { "s" };
    let wanted = ["six", "seven", "eight"].get(wanted.wrapping_sub(6)).copied().unwrap_or("more");
    format!("{count} field{plural} (a ray has {wanted}){suggestion}")
}

fn parse(field: &[u8]) -> Option<f64> {
    str::from_utf8(field).ok()?.parse().ok()
}

/// A field in a message: quoted, without control characters, not too long.
fn shown(field: &[u8]) -> String {
    let text = String::from_utf8_lossy(field);
    match text.char_indices().nth(30) {
        _ if text.is_empty() => "empty".into(),
        Some((end, _)) => format!("{:?}...", &text[..end]),
        None => format!("{text:?}"),
    }
}

/// Looks for files that are not CSV at all.
fn check_start(line: &Line) -> Result<(), String> {
    if npy_header::is_npy(line.bytes) {
        return Err("this is an NPY file, not CSV; name it .npy".into());
    }
    if line.bytes.starts_with(b"\xff\xfe") || line.bytes.starts_with(b"\xfe\xff") {
        return Err("the text is UTF-16 (CSV is read as UTF-8); save it as UTF-8".into());
    }
    Ok(())
}

fn header_problem(line: u64, message: String) -> RayProblem {
    RayProblem { line: Some(line), ..RayProblem::whole(message) }
}

/// The field of each column, if the header names the six columns, and no others but those that the file may have.
fn read_header(fields: &Fields, line: u64, kind: Kind, found: &mut Findings) -> Option<FieldOf> {
    if let Some(message) = not_a_header(fields) {
        found.add(header_problem(line, message));
        return None;
    }
    let names: Vec<_> = (0..fields.count).map(|i| fields.get(i)).collect();
    let known = kind.columns();
    let is_known = |column: &str| known.contains(&column);
    let place = |column: &str| names.iter().position(|name| is_known(column) && *name == column.as_bytes());
    let places = COLUMNS.map(place);
    let needed = RAY_COLUMNS.iter().zip(&places);
    let missing: Vec<_> = needed.filter(|(_, place)| place.is_none()).map(|(column, _)| *column).collect();
    let open: Vec<_> =
        known.iter().zip(&places).filter(|(_, place)| place.is_none()).map(|(c, _)| *c).collect();

    let mut messages = Vec::new();
    for (i, name) in names.iter().enumerate() {
        let column = known.iter().position(|column| column.as_bytes() == *name);
        match column {
            None => messages.push(unknown_column(name, &open)),
            Some(column) if places[column] != Some(i) => {
                messages.push(format!("column {} occurs twice", COLUMNS[column]));
            }
            Some(_) => {}
        }
    }
    if !missing.is_empty() {
        messages.push(format!("missing: {} (rays have ox,oy,oz,dx,dy,dz, in any order)", missing.join(", ")));
    }
    let is_good = messages.is_empty();
    messages.into_iter().for_each(|message| found.add(header_problem(line, message)));
    is_good.then_some(places)
}

/// A first line of another kind, and what to do.
fn not_a_header(fields: &Fields) -> Option<String> {
    let first = fields.get(0);
    if (0..fields.count).all(|i| parse(fields.get(i)).is_some()) {
        return Some(
            "the first line holds numbers (it is the header); put ox,oy,oz,dx,dy,dz before it".into(),
        );
    }
    if first.starts_with(b"#") {
        return Some(
            "the header begins with # (there are no comments in CSV); \
             remove it, or pass comments=\"\" to numpy.savetxt"
                .into(),
        );
    }
    let separator = first.iter().find(|c| b";\t ".contains(c)).filter(|_| fields.count == 1)?;
    let name = match separator {
        b';' => "semicolons",
        b'\t' => "tabs",
        _ => "spaces",
    };
    Some(format!("fields are separated by {name} (CSV is read with commas); write it with commas"))
}

/// Suggests the one missing column that the name may stand for.
fn unknown_column(name: &[u8], missing: &[&str]) -> String {
    let lower = String::from_utf8_lossy(name).to_ascii_lowercase();
    let exact = missing.iter().find(|column| **column == lower);
    let mut alike = missing.iter().filter(|column| one_change_apart(&lower, column));
    let only = alike.next().filter(|_| alike.next().is_none());
    let suggestion = match exact.or(only) {
        Some(column) => format!("; did you mean {column}?"),
        None if missing.is_empty() => "; remove it".into(),
        None => String::new(),
    };
    format!("unknown column {}{suggestion}", shown(name))
}

/// Whether one character replaced, inserted or removed (or none) makes one of the other.
fn one_change_apart(a: &str, b: &str) -> bool {
    let (a, b): (Vec<_>, Vec<_>) = (a.chars().collect(), b.chars().collect());
    let (short, long) = if a.len() <= b.len() { (a, b) } else { (b, a) };
    let same_start = short.iter().zip(&long).take_while(|(x, y)| x == y).count();
    let (short, long) = (&short[same_start..], &long[same_start..]);
    match long.len() - short.len() {
        0 => short.get(1..).is_none_or(|rest| rest == &long[1..]),
        1 => short == &long[1..],
        _ => false,
    }
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
            // unquoting never lengthens, and one byte is the line's end
            text: vec![0; MAX_LINE + 1],
            ends: [0; MAX_FIELDS],
            count: 0,
        }
    }

    /// Splits a line; `Err` says why it has no fields.
    fn split(&mut self, line: &Line) -> Result<(), String> {
        if line.too_long {
            return Err(format!("the line is longer than {MAX_LINE} bytes (a ray needs 150 at most)"));
        }
        self.splitter.reset();
        let (result, read, _, count) = self.splitter.read_record(line.bytes, &mut self.text, &mut self.ends);
        match result {
            ReadRecordResult::Record if read < line.bytes.len() => {
                Err("a carriage return within the line (lines end with \\n or \\r\\n)".into())
            }
            ReadRecordResult::Record => {
                self.count = count;
                Ok(())
            }
            ReadRecordResult::OutputEndsFull => Err(format!("more than {MAX_FIELDS} fields (a ray has six)")),
            _ => Err("a quote is opened and not closed on its line".into()),
        }
    }

    /// One field without the spaces around it; empty if there is none.
    fn get(&self, i: usize) -> &[u8] {
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        let is_there = i < self.count;
        if is_there { self.text[start..self.ends[i]].trim_ascii() } else { b"" }
    }
}

/// A line that is not blank. `bytes` ends with one `\n` and has no other white space at its end.
struct Line<'a> {
    number: u64,
    bytes: &'a [u8],
    too_long: bool,
}

/// Cuts a source into lines of bounded length.
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
            self.tidy();
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

    /// Brings the line's end to one form and removes a byte order mark.
    fn tidy(&mut self) {
        let end = self.line.trim_ascii_end().len();
        self.line.truncate(end);
        self.line.push(b'\n');
        if self.number == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
            self.line.drain(..3);
        }
    }
}
