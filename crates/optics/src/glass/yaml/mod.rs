//! Reader of the YAML files of refractiveindex.info.
//!
//! A file has the keys
//!
//! | key | holds | read |
//! | --- | --- | --- |
//! | `REFERENCES` | where the numbers come from | as the source |
//! | `DATA` | a list of entries, each with a `type` | yes |
//! | `PROPERTIES` (before 2024 `SPECS`) | among others `nd` and `Vd` | these two |
//! | `NAME`, `ALIASES` | names; only in the catalogue of this crate, and separated by commas | yes |
//!
//! and the entries of `DATA` have one of the types
//!
//! | type | holds |
//! | --- | --- |
//! | `formula 1` to `formula 9` | `coefficients` and `wavelength_range` in µm (before 2018 `range`); see [`Dispersion`] |
//! | `tabulated n` | `data`: lines of wavelength in µm and index |
//! | `tabulated k` | `data`: lines of wavelength in µm and extinction coefficient |
//! | `tabulated nk` | `data`: lines of wavelength in µm, index and extinction coefficient |
//!
//! One file may hold several documents. The format: M. N. Polyanskiy, "Refractiveindex.info
//! database of optical constants", Scientific Data 11, 94 (2024).

mod tree;

use tree::Node;

use crate::glass::read::{FileProblem, GlassFileError, finish, nm_from_um, numbers};
use crate::glass::{Dispersion, Glass, Published, Table};

/// Reads the materials of a refractiveindex.info file; `name` is the name of a document without the
/// key `NAME`, which is the usual case.
///
/// If there are several formulas or tables for the index, the first one is used; likewise for the
/// extinction coefficient.
///
/// # Errors
/// All problems of the file at once, each with its line; only the first if the file is not YAML.
/// Documents without problems remain available: [`into_readable`](GlassFileError::into_readable).
///
/// ```
/// use rayweave_optics::glass::read_refractiveindex;
/// let file = "DATA:\n  - type: formula 5\n    wavelength_range: 0.4 0.7\n    coefficients: 1.5 0.004 -2\n";
/// let material = &read_refractiveindex(file, "mine").unwrap()[0];
/// assert_eq!(material.index(500.0).unwrap(), 1.516);
/// ```
pub fn read_refractiveindex(text: &str, name: &str) -> Result<Vec<Glass>, GlassFileError> {
    let documents = match tree::documents(text) {
        Ok(documents) => documents,
        Err(problem) => return finish(Vec::new(), vec![problem]),
    };
    if documents.is_empty() {
        let text = "the file is empty: it needs the key DATA.".to_owned();
        return finish(Vec::new(), vec![FileProblem { line: 1, text }]);
    }
    let mut materials = Vec::new();
    let mut problems = Vec::new();
    for document in &documents {
        let mut reader = Reader { problems: Vec::new() };
        match reader.material(document, name) {
            Some(material) if reader.problems.is_empty() => materials.push(material),
            _ => problems.append(&mut reader.problems),
        }
    }
    finish(materials, problems)
}

/// The text without mark-up, on one line.
fn plain(text: &str) -> String {
    let mut inside = false;
    let kept = text.chars().filter(|&character| {
        let tag = inside || character == '<';
        inside = tag && character != '>';
        !tag
    });
    kept.collect::<String>().split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The contributions of the entries of `DATA`.
#[derive(Default)]
struct Parts {
    index: Option<(Dispersion, Option<[f64; 2]>)>,
    extinction: Option<(usize, Table)>,
}

struct Reader {
    problems: Vec<FileProblem>,
}

impl Reader {
    /// The value, or `None` with its problem noted.
    fn note<T>(&mut self, line: usize, outcome: Result<T, String>) -> Option<T> {
        outcome.map_err(|text| self.problems.push(FileProblem { line, text })).ok()
    }

    fn material(&mut self, document: &Node, name: &str) -> Option<Glass> {
        let line = document.line;
        let entries = document.get("DATA").and_then(Node::items);
        let no_data = || "the document has no list DATA: that list holds the formulas and tables.".to_owned();
        let entries = self.note(line, entries.ok_or_else(no_data))?;
        let mut parts = Parts::default();
        for entry in entries {
            self.read_entry(entry, &mut parts);
        }
        let no_index = || "DATA has no index: it needs a formula or a table of n or nk.".to_owned();
        let (dispersion, range_nm) = self.note(line, parts.index.ok_or_else(no_index))?;
        let mut glass = Glass::new(field(document, "NAME").unwrap_or(name), dispersion)
            .with_source(plain(field(document, "REFERENCES").unwrap_or_default()))
            .with_aliases(aliases(document));
        if let Some(range_nm) = range_nm {
            glass = self.note(line, glass.with_range_nm(range_nm).map_err(|error| error.to_string()))?;
        }
        if let Some((line, extinction)) = parts.extinction {
            glass = self.note(line, glass.with_extinction(extinction).map_err(|error| error.to_string()))?;
        }
        Some(match published(document) {
            Some(published) => glass.with_published(published),
            None => glass,
        })
    }

    fn read_entry(&mut self, entry: &Node, parts: &mut Parts) {
        let line = entry.line;
        let no_type =
            || "an entry of DATA has no type: types are formula 1 to 9 and tabulated n, k, nk.".to_owned();
        let Some(kind) = self.note(line, field(entry, "type").ok_or_else(no_type)) else { return };
        match kind.split_whitespace().collect::<Vec<_>>()[..] {
            ["formula", number] => {
                let read = self.formula(entry, number);
                parts.index = parts.index.take().or(read);
            }
            ["tabulated", columns @ ("n" | "k" | "nk")] => self.read_table(entry, columns, parts),
            _ => {
                let text =
                    format!("type {kind:?} is unknown: types are formula 1 to 9 and tabulated n, k, nk.");
                self.problems.push(FileProblem { line, text });
            }
        }
    }

    fn formula(&mut self, entry: &Node, number: &str) -> Option<(Dispersion, Option<[f64; 2]>)> {
        let line = entry.line;
        let number = number.parse::<u32>().map_err(|_| format!("{number:?} is not the number of a formula."));
        let number = self.note(line, number)?;
        let (at, coefficients) = self.numbers_of(entry, &["coefficients"])?;
        let formula = Dispersion::refractiveindex(number, &coefficients).map_err(|error| error.to_string());
        let dispersion = self.note(at, formula)?;
        let (at, range) = self.numbers_of(entry, &["wavelength_range", "range"])?;
        let two = || {
            "the range is incomplete: it has two numbers, the shortest and the longest wavelength in µm."
                .to_owned()
        };
        let range = self.note(at, range.first_chunk::<2>().copied().ok_or_else(two))?;
        Some((dispersion, Some(range.map(nm_from_um))))
    }

    /// The numbers of the first of these keys that exists, with their line.
    fn numbers_of(&mut self, entry: &Node, keys: &[&str]) -> Option<(usize, Vec<f64>)> {
        let node = keys.iter().find_map(|&key| entry.get(key));
        let missing = || format!("an entry of DATA has no {}.", keys[0]);
        let node = self.note(entry.line, node.ok_or_else(missing))?;
        let text = node.text().unwrap_or_default();
        Some((node.line, self.note(node.line, numbers(text))?))
    }

    fn read_table(&mut self, entry: &Node, columns: &str, parts: &mut Parts) {
        let line = entry.line;
        let missing = || "a table has no data.".to_owned();
        let data = entry.get("data");
        let Some(data) = self.note(line, data.ok_or_else(missing)) else { return };
        let Some(rows) = self.rows(data, columns.len()) else { return };
        let column = |place: usize| {
            Table::new(rows.iter().map(|row| (nm_from_um(row[0]), row[place])).collect())
                .map_err(|error| error.to_string())
        };
        if columns.starts_with('n') && parts.index.is_none() {
            let index = self.note(data.line, column(1));
            parts.index = index.map(|table| (Dispersion::Tabulated(table), None));
        }
        if columns.ends_with('k') && parts.extinction.is_none() {
            let extinction = self.note(data.line, column(columns.len()));
            parts.extinction = extinction.map(|table| (data.line, table));
        }
    }

    /// The rows of a table: a wavelength and a number of values each.
    fn rows(&mut self, data: &Node, values: usize) -> Option<Vec<Vec<f64>>> {
        let text = data.text().unwrap_or_default();
        let before = self.problems.len();
        let mut rows = Vec::new();
        for (index, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
            let row = numbers(line).and_then(|row| match row.len() == values + 1 {
                true => Ok(row),
                false => Err(format!(
                    "a row has {} numbers: it needs a wavelength in µm and {values} more.",
                    row.len()
                )),
            });
            rows.extend(self.note(data.line + index, row));
        }
        (self.problems.len() == before).then_some(rows)
    }
}

fn field<'a>(node: &'a Node, key: &str) -> Option<&'a str> {
    node.get(key).and_then(Node::text)
}

fn aliases(document: &Node) -> Vec<String> {
    let text = field(document, "ALIASES").unwrap_or_default();
    text.split(',').map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect()
}

fn published(document: &Node) -> Option<Published> {
    let table = ["PROPERTIES", "SPECS"].iter().find_map(|&key| document.get(key))?;
    let value = |key: &str| field(table, key).and_then(|text| text.parse::<f64>().ok());
    Some(Published { n_d: value("nd")?, v_d: value("Vd")? })
}
