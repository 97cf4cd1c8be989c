//! Reader of tables row by row: CSV with a header, and structured NPY arrays with the file of names beside them, as
//! [`TableWriter`](crate::TableWriter) writes them.

use crate::npy_header::{self, NpyHeader};
use crate::reason::reason;
use crate::{NO_NAME, TableError};
use rayweave_error::Message;
use std::collections::HashMap;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

/// A table that is open for reading.
pub struct TableReader {
    path: PathBuf,
    columns: Vec<String>,
    rows: Rows,
}

enum Rows {
    Csv(Box<::csv::Reader<File>>),
    Npy { file: BufReader<File>, fields: Vec<NpyField>, names: HashMap<String, Vec<String>>, rows: u64 },
}

/// Decodes the bytes of a value.
type Decode = fn(&[u8]) -> Field<'static>;

/// A field of a structured array.
struct NpyField {
    name: String,
    decode: Decode,
    offset: usize,
    size: usize,
}

/// A value of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Field<'a> {
    Integer(i64),
    Float(f64),
    Text(&'a str),
}

/// The wanted values of a row of a table.
pub struct TableRow<'a> {
    path: &'a Path,
    names: &'a [String],
    wanted: &'a [usize],
    fields: Vec<Field<'a>>,
    /// `line 3` of a CSV file, or `row 1` of an array.
    place: (&'static str, u64),
}

impl TableReader {
    /// Opens a table: CSV if the file has the ending .csv, else NPY.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`], and [`TableError::Table`] for a file without a valid header.
    pub fn open(path: impl AsRef<Path>) -> Result<TableReader, TableError> {
        let path = path.as_ref();
        let file = File::open(path).map_err(|error| TableError::io("read", path, error))?;
        match path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv")) {
            true => TableReader::csv(path, file),
            false => TableReader::npy(path, file),
        }
    }

    /// The names of the columns.
    #[must_use]
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Passes each row to `visit`, with the values of the columns of these numbers. Returns the number of rows.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`]; [`TableError::Table`] for a damaged file; those of `visit`.
    pub fn read(
        self,
        wanted: &[usize],
        visit: &mut dyn FnMut(&TableRow<'_>) -> Result<(), TableError>,
    ) -> Result<u64, TableError> {
        let TableReader { path, columns, rows } = self;
        match rows {
            Rows::Csv(csv) => read_csv(*csv, &path, &columns, wanted, visit),
            Rows::Npy { file, fields, names, rows } => {
                read_npy(file, &fields, &names, rows, &path, (&columns, wanted), visit)
            }
        }
    }

    fn csv(path: &Path, file: File) -> Result<TableReader, TableError> {
        let mut csv = ::csv::ReaderBuilder::new().buffer_capacity(1 << 16).from_reader(file);
        let header = csv.headers().map_err(|error| csv_error(path, &error))?;
        let columns: Vec<String> = header.iter().map(|name| name.trim().to_owned()).collect();
        if columns.iter().all(String::is_empty) {
            return Err(invalid(path, "the file is empty", "a table begins with a line of column names"));
        }
        Ok(TableReader { path: path.to_owned(), columns, rows: Rows::Csv(Box::new(csv)) })
    }

    fn npy(path: &Path, file: File) -> Result<TableReader, TableError> {
        let mut file = BufReader::with_capacity(1 << 16, file);
        let header = npy_header::read(&mut file).map_err(|error| TableError::io("read", path, error))?;
        let header = header.map_err(|problem| invalid(path, "the file cannot be used", &problem))?;
        let fields =
            fields_of(&header).map_err(|reason| invalid(path, "the array is not a table", &reason))?;
        let columns = fields.iter().map(|field| field.name.clone()).collect();
        let names = names_beside(path)?;
        let rows = Rows::Npy { file, fields, names, rows: header.shape[0] };
        Ok(TableReader { path: path.to_owned(), columns, rows })
    }
}

impl TableRow<'_> {
    /// The value of a wanted column as an integer.
    ///
    /// # Errors
    ///
    /// [`TableError::Table`] if it is none.
    pub fn integer(&self, k: usize) -> Result<i64, TableError> {
        match self.fields[k] {
            Field::Integer(value) => Ok(value),
            Field::Float(value) if value.fract() == 0.0 && value.abs() < 2f64.powi(53) => Ok(value as i64),
            Field::Float(value) => Err(self.error(k, &format!("{value} is not a whole number"))),
            Field::Text(text) => {
                text.trim().parse().map_err(|_| self.error(k, &format!("{text:?} is not a whole number")))
            }
        }
    }

    /// The value of a wanted column as a finite number.
    ///
    /// # Errors
    ///
    /// [`TableError::Table`] if it is none.
    pub fn float(&self, k: usize) -> Result<f64, TableError> {
        let value = match self.fields[k] {
            Field::Integer(value) => value as f64,
            Field::Float(value) => value,
            Field::Text(text) => {
                text.trim().parse().map_err(|_| self.error(k, &format!("{text:?} is not a number")))?
            }
        };
        match value.is_finite() {
            true => Ok(value),
            false => Err(self.error(k, &format!("{value} is not finite"))),
        }
    }

    /// The value of a wanted column as text.
    ///
    /// # Errors
    ///
    /// [`TableError::Table`] for a number, such as that of a name without the file of names.
    pub fn text(&self, k: usize) -> Result<&str, TableError> {
        match self.fields[k] {
            Field::Text(text) => Ok(text),
            Field::Integer(_) | Field::Float(_) => {
                Err(self
                    .error(k, "it is a number without a name: the file .names.json belongs beside the array"))
            }
        }
    }

    /// An error about the value of a wanted column.
    #[must_use]
    pub fn error(&self, k: usize, reason: &str) -> TableError {
        let (unit, number) = self.place;
        let column = self.wanted.get(k).and_then(|&column| self.names.get(column)).map_or("", String::as_str);
        invalid(self.path, &format!("{unit} {number}, column `{column}` is invalid"), reason)
    }
}

fn invalid(path: &Path, problem: &str, reason: &str) -> TableError {
    let reason = reason.trim_end_matches('.');
    TableError::Table { path: path.display().to_string(), message: Message::new(problem, reason) }
}

fn csv_error(path: &Path, error: &::csv::Error) -> TableError {
    let line = error.position().map_or(1, ::csv::Position::line);
    let text = match error.kind() {
        ::csv::ErrorKind::Io(error) => reason(error),
        ::csv::ErrorKind::Utf8 { .. } => "it is not UTF-8 text".to_owned(),
        ::csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("it has {len} fields, and the header has {expected_len}")
        }
        _ => error.to_string(),
    };
    invalid(path, &format!("line {line} cannot be read"), &text)
}

fn read_csv(
    mut csv: ::csv::Reader<File>,
    path: &Path,
    names: &[String],
    wanted: &[usize],
    visit: &mut dyn FnMut(&TableRow<'_>) -> Result<(), TableError>,
) -> Result<u64, TableError> {
    let mut record = ::csv::StringRecord::new();
    let mut rows = 0;
    while csv.read_record(&mut record).map_err(|error| csv_error(path, &error))? {
        let line = record.position().map_or(0, ::csv::Position::line);
        let fields = wanted.iter().map(|&k| Field::Text(record.get(k).unwrap_or_default())).collect();
        visit(&TableRow { path, names, wanted, fields, place: ("line", line) })?;
        rows += 1;
    }
    Ok(rows)
}

fn read_npy(
    mut file: BufReader<File>,
    fields: &[NpyField],
    lists: &HashMap<String, Vec<String>>,
    rows: u64,
    path: &Path,
    (names, wanted): (&[String], &[usize]),
    visit: &mut dyn FnMut(&TableRow<'_>) -> Result<(), TableError>,
) -> Result<u64, TableError> {
    let size = fields.iter().map(|field| field.size).sum();
    let mut bytes = vec![0; size];
    let lists: Vec<Option<&Vec<String>>> = wanted.iter().map(|&k| lists.get(&names[k])).collect();
    for row in 0..rows {
        if let Err(error) = file.read_exact(&mut bytes) {
            return Err(match error.kind() {
                std::io::ErrorKind::UnexpectedEof => {
                    invalid(path, "the array is incomplete", &format!("it ends in row {row} of {rows}"))
                }
                _ => TableError::io("read", path, error),
            });
        }
        let mut values = Vec::with_capacity(wanted.len());
        for (&k, list) in wanted.iter().zip(&lists) {
            let field = &fields[k];
            let value = (field.decode)(&bytes[field.offset..field.offset + field.size]);
            values.push(named(value, *list).ok_or_else(|| {
                let problem = format!("row {row}, column `{}` is invalid", field.name);
                invalid(path, &problem, "its number has no name in the file .names.json")
            })?);
        }
        visit(&TableRow { path, names, wanted, fields: values, place: ("row", row) })?;
    }
    Ok(rows)
}

/// The name of a number if there is a list of names, else the value itself; `None` for a number without a name.
fn named<'a>(value: Field<'static>, list: Option<&'a Vec<String>>) -> Option<Field<'a>> {
    match (value, list) {
        (Field::Integer(id), Some(_)) if id == i64::from(NO_NAME) => Some(Field::Text("")),
        (Field::Integer(id), Some(list)) => {
            let name = usize::try_from(id).ok().and_then(|id| list.get(id))?;
            Some(Field::Text(name))
        }
        _ => Some(value),
    }
}

/// The fields of a structured array of one dimension.
fn fields_of(header: &NpyHeader) -> Result<Vec<NpyField>, String> {
    if !header.structured || header.shape.len() != 1 {
        return Err(format!("it has the type {}", npy_header::abridged(&header.descr)));
    }
    let mut offset = 0;
    let mut fields = Vec::new();
    let items = header.descr.trim_start_matches('[').trim_end_matches(']').split(')');
    for item in
        items.map(|item| item.trim_start_matches([',', ' ', '(']).trim()).filter(|item| !item.is_empty())
    {
        let quoted: Vec<&str> = item.split(['\'', '"']).collect();
        let [_, name, _, kind, rest] = quoted[..] else {
            return Err(format!("the field {item} is not a pair of name and type"));
        };
        if !rest.trim_matches([',', ' ']).is_empty() {
            return Err(format!("the field {name} is an array"));
        }
        let (decode, size) = decoder(kind)
            .ok_or_else(|| format!("the field {name} has the type {kind}, which is not supported"))?;
        fields.push(NpyField { name: name.to_owned(), decode, offset, size });
        offset += size;
    }
    match fields.is_empty() {
        true => Err("it has no fields".to_owned()),
        false => Ok(fields),
    }
}

/// The bytes of a number; zeros beyond the end.
fn start<const N: usize>(bytes: &[u8]) -> [u8; N] {
    std::array::from_fn(|k| bytes.get(k).copied().unwrap_or(0))
}

/// The decoder and the size of a little-endian type of NumPy.
fn decoder(kind: &str) -> Option<(Decode, usize)> {
    let known: (Decode, usize) = match kind {
        "<f8" => (|bytes| Field::Float(f64::from_le_bytes(start(bytes))), 8),
        "<f4" => (|bytes| Field::Float(f64::from(f32::from_le_bytes(start(bytes)))), 4),
        "<i8" => (|bytes| Field::Integer(i64::from_le_bytes(start(bytes))), 8),
        "<u8" => (|bytes| Field::Integer(u64::from_le_bytes(start(bytes)) as i64), 8),
        "<i4" => (|bytes| Field::Integer(i64::from(i32::from_le_bytes(start(bytes)))), 4),
        "<u4" => (|bytes| Field::Integer(i64::from(u32::from_le_bytes(start(bytes)))), 4),
        "|b1" | "|u1" => (|bytes| Field::Integer(i64::from(start::<1>(bytes)[0])), 1),
        _ => return None,
    };
    Some(known)
}

/// The lists of names in the file beside an array; none without the file.
fn names_beside(path: &Path) -> Result<HashMap<String, Vec<String>>, TableError> {
    let path = path.with_extension("names.json");
    let file = match File::open(&path) {
        Ok(file) => file,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(HashMap::new()),
        Err(error) => return Err(TableError::io("read", &path, error)),
    };
    serde_json::from_reader(BufReader::new(file))
        .map_err(|error| invalid(&path, "the file is not a table of names", &error.to_string()))
}
