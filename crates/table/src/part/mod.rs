//! Parts of results: the description of a part, and the join of all parts to the whole.
//!
//! A long run can be divided into ranges of its rays (or photons, or rows of pixels) that run anywhere, in any order. Each writes
//! its part of the result to a file `FILE` and then the description `FILE.part.json`. The description is written last: a part
//! whose description exists is complete.

mod counts;
mod merge;
mod npy;
#[cfg(feature = "parquet")]
mod parquet;
mod set;

use crate::{AtomicFile, Column, ContentHash, DType, Schema, TableError};
use rayweave_error::Message;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

pub use counts::Counts;
pub use set::{PartSet, missing_ranges};

/// The version of the format of descriptions.
const VERSION: u64 = 1;

/// Everything that a part of a result depends on: the query, its settings and the range.
///
/// Two parts belong to the same whole if `query`, `settings` and `total` are equal. The settings include hashes of the inputs: of
/// the model as `model`, of a file of rays as `rays`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// The query and its result, such as `trace` or `photons hits`.
    pub query: String,
    /// All settings that the result depends on, by name.
    pub settings: BTreeMap<String, String>,
    /// The numbers of the rays of this part.
    pub range: Range<u64>,
    /// The number of rays of the whole.
    pub total: u64,
    /// Counts of this part that add up to those of the whole, if the query reports any.
    counts: Option<Counts>,
    /// The columns of a table, without the names of their values; empty for other results.
    columns: Vec<PartColumn>,
}

/// A column of a table: name, type and unit.
#[derive(Clone, Debug, PartialEq, Eq)]
struct PartColumn {
    name: String,
    dtype: String,
    unit: Option<String>,
}

impl Part {
    /// A part of a result that is not a table. Adds the version of this library to the settings.
    pub fn new(
        query: impl Into<String>,
        settings: impl IntoIterator<Item = (String, String)>,
        range: Range<u64>,
        total: u64,
    ) -> Part {
        let version = ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned());
        let settings = settings.into_iter().chain([version]).collect();
        Part { query: query.into(), settings, range, total, counts: None, columns: Vec::new() }
    }

    /// The part of a table with this schema.
    #[must_use]
    pub fn with_schema(mut self, schema: &Schema) -> Part {
        let column = |column: &Column| PartColumn {
            name: column.name.clone(),
            dtype: column.dtype.to_string(),
            unit: column.unit.clone(),
        };
        self.columns = schema.columns().iter().map(column).collect();
        self
    }

    /// The part with these counts.
    #[must_use]
    pub fn with_counts(self, counts: Counts) -> Part {
        Part { counts: Some(counts), ..self }
    }

    /// The path of the description of a file: `FILE.part.json`.
    pub fn path(file: &Path) -> PathBuf {
        let mut name = OsString::from(file);
        name.push(".part.json");
        name.into()
    }

    /// Writes the description of a complete file, with its length and hash.
    ///
    /// # Errors
    ///
    /// [`TableError`] if the file cannot be read or the description cannot be written.
    pub fn describe(&self, file: &Path) -> Result<(), TableError> {
        let (bytes, content) = content(file, &self.columns)?;
        let columns = self.columns.iter().map(|column| json!([column.name, column.dtype, column.unit]));
        let mut description = json!({
            "part": VERSION,
            "query": self.query,
            "settings": self.settings,
            "range": [self.range.start, self.range.end],
            "total": self.total,
            "columns": columns.collect::<Vec<_>>(),
            "bytes": bytes,
            "content": content,
        });
        if let Some(counts) = &self.counts {
            description["counts"] = counts.to_json();
        }
        let path = Part::path(file);
        let mut out = AtomicFile::create(&path)?;
        let written = writeln!(out, "{description:#}");
        written.map_err(|error| TableError::io("write", &path, error))?;
        out.finish()
    }

    /// Writes a file that is a part, complete or not at all, and its description.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`] if a file cannot be written.
    pub fn write(&self, file: &Path, bytes: &[u8]) -> Result<(), TableError> {
        let mut out = AtomicFile::create(file)?;
        out.write_all(bytes).map_err(|error| TableError::io("write", file, error))?;
        Part::forget(file)?;
        out.finish()?;
        self.describe(file)
    }

    /// Removes the description of a file, before the file is replaced.
    pub(crate) fn forget(file: &Path) -> Result<(), TableError> {
        let path = Part::path(file);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                Err(TableError::io("remove", &path, error))
            }
            _ => Ok(()),
        }
    }

    /// Reads the description of a file and verifies the length and the hash of the file.
    ///
    /// # Errors
    ///
    /// [`TableError::Table`] for a file without description, a damaged description, and a file that does not match it.
    pub fn read(file: &Path) -> Result<Part, TableError> {
        let path = Part::path(file);
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Err(not_a_part(file)),
            Err(error) => return Err(TableError::io("read", &path, error)),
        };
        let value: Value = serde_json::from_str(&text).unwrap_or_default();
        let (part, bytes, hash) = parse(&value).ok_or_else(|| {
            let message =
                Message::new("the description of the part is damaged", "it is not as this version writes it");
            TableError::table(&path, message.suggest("Compute the part again"))
        })?;
        let found = content(file, &part.columns)?;
        if found != (bytes, hash) {
            let reason = match found.0 == bytes {
                true => "its contents differ from the hash in its description".to_owned(),
                false => format!("it has {} bytes instead of {bytes}", found.0),
            };
            let message = Message::new("the part is damaged", reason).suggest("Compute the part again");
            return Err(TableError::table(file, message));
        }
        Ok(part)
    }

    /// True if the file is complete and is this part; columns, counts and total, which follow from the rest, are not compared.
    pub fn is_in(&self, file: &Path) -> bool {
        let same = |found: Part| {
            let (columns, counts) = (self.columns.clone(), self.counts.clone());
            Part { columns, counts, total: self.total, ..found } == *self
        };
        Part::read(file).is_ok_and(same)
    }
}

fn not_a_part(file: &Path) -> TableError {
    let path = Part::path(file);
    let message = Message::new("the file is not a part", format!("there is no {}", path.display()));
    TableError::table(
        file,
        message.suggest("Parts are written with --range; one without description is incomplete"),
    )
}

/// The files of a table: the table itself, and the names of an NPY file.
fn files(file: &Path, columns: &[PartColumn]) -> Vec<PathBuf> {
    let has_names = columns.iter().any(|column| column.dtype == "name" || column.dtype == "text");
    let is_npy = crate::format::extension(file) == "npy";
    let names = (has_names && is_npy).then(|| file.with_extension("names.json"));
    [file.to_owned()].into_iter().chain(names).collect()
}

/// The number of bytes of the files of a part, and their hash.
fn content(file: &Path, columns: &[PartColumn]) -> Result<(u64, String), TableError> {
    let (mut hash, mut bytes) = (ContentHash::new(), 0);
    for path in files(file, columns) {
        bytes += hash.file(&path).map_err(|error| TableError::io("read", &path, error))?;
    }
    Ok((bytes, hash.finish()))
}

/// The part, the length and the hash of its file.
fn parse(value: &Value) -> Option<(Part, u64, String)> {
    if value["part"].as_u64() != Some(VERSION) {
        return None;
    }
    let text = |value: &Value| value.as_str().map(str::to_owned);
    let settings =
        value["settings"].as_object()?.iter().map(|(name, value)| Some((name.clone(), text(value)?)));
    let column = |value: &Value| {
        let [name, dtype, unit] = value.as_array()?.as_slice() else { return None };
        Some(PartColumn { name: text(name)?, dtype: text(dtype)?, unit: text(unit) })
    };
    let range = value["range"][0].as_u64()?..value["range"][1].as_u64()?;
    let total = value["total"].as_u64()?;
    let part = Part {
        query: text(&value["query"])?,
        settings: settings.collect::<Option<_>>()?,
        range: (range.start <= range.end && range.end <= total).then_some(range)?,
        total,
        counts: match value.get("counts") {
            Some(counts) => Some(Counts::from_json(counts)?),
            None => None,
        },
        columns: value["columns"].as_array()?.iter().map(column).collect::<Option<_>>()?,
    };
    Some((part, value["bytes"].as_u64()?, text(&value["content"])?))
}

/// The type with this name; names of values are not known here.
fn dtype(name: &str) -> Option<DType> {
    Some(match name {
        "f64" => DType::F64,
        "i64" => DType::I64,
        "row" => DType::Row,
        "i32" => DType::I32,
        "bool" => DType::Bool,
        "name" => DType::Name([].into()),
        "text" => DType::Text,
        _ => return None,
    })
}
