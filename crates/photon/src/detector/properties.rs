//! Reader of properties: matrices by name, constants, and a record of what was used.

use crate::error::{PhotonError, PropertyError};
use crate::property::{PropertyTable, Spectrum};
use rayweave_error::Message;
use rayweave_scene::Datum;
use std::collections::HashMap;

/// Reads properties and collects problems and notes.
pub(crate) struct PropertyReader {
    matrices: HashMap<String, Matrix>,
    problems: Vec<Message>,
    notes: Vec<String>,
}

/// A `<matrix>` of a GDML file.
#[derive(Clone, Debug)]
struct Matrix {
    columns: usize,
    values: Vec<f64>,
}

/// The properties of one material or surface.
pub(crate) struct Properties<'r> {
    reader: &'r mut PropertyReader,
    /// The owner of the properties, as in "material `Water`".
    owner: String,
    /// Those that no process has read yet.
    rest: Vec<(String, Datum)>,
}

impl PropertyReader {
    /// A reader of the matrices of a `[gdml]` table.
    pub fn new(table: &Datum) -> PropertyReader {
        let matrix = |row: &Datum| {
            let name = row.get("name")?.as_text()?.to_owned();
            let columns = row.get("columns")?.as_number()? as usize;
            let values = row.list("values").filter_map(Datum::as_number);
            Some((name, Matrix { columns, values: values.collect() }))
        };
        let matrices = table.list("matrix").filter_map(matrix).collect();
        PropertyReader { matrices, problems: Vec::new(), notes: Vec::new() }
    }

    /// The properties in a row of the table.
    pub fn of<'r>(&'r mut self, owner: String, row: &Datum) -> Properties<'r> {
        let entries = row.get("properties").into_iter().flat_map(Datum::entries);
        let rest = entries.map(|(name, datum)| (name.to_owned(), datum.clone())).collect();
        Properties { reader: self, owner, rest }
    }

    /// Adds a problem.
    pub fn problem(&mut self, problem: Message) {
        self.problems.push(problem);
    }

    /// Adds a note: a sentence.
    pub fn note(&mut self, note: String) {
        self.notes.push(note);
    }

    /// The notes.
    ///
    /// # Errors
    ///
    /// All problems, if there are any.
    pub fn finish(self) -> Result<Vec<String>, PhotonError> {
        if self.problems.is_empty() { Ok(self.notes) } else { Err(PhotonError::Detector(self.problems)) }
    }
}

impl Properties<'_> {
    fn take(&mut self, name: &str) -> Option<Matrix> {
        let at = self.rest.iter().position(|(own, _)| own == name)?;
        let (_, datum) = self.rest.remove(at);
        match datum {
            Datum::Number(value) => Some(Matrix { columns: 1, values: vec![value] }),
            // an unknown matrix was reported by the reader of the file
            Datum::Text(matrix) => self.reader.matrices.get(&matrix).cloned(),
            _ => None,
        }
    }

    /// A property that depends on the energy.
    pub fn table(&mut self, name: &str) -> Option<PropertyTable> {
        let matrix = self.take(name)?;
        if matrix.columns != 2 {
            self.problem(name, "it has one column: pairs of an energy and a value are needed (coldim=\"2\")");
            return None;
        }
        let points = matrix.values.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect();
        self.accept(name, PropertyTable::new(points))
    }

    /// A property that depends on the energy and whose values lie in a range.
    pub fn table_in(&mut self, name: &str, range: std::ops::RangeInclusive<f64>) -> Option<PropertyTable> {
        let table = self.table(name)?;
        match table.values().iter().find(|value| !range.contains(*value)) {
            Some(value) => {
                let (least, most) = (range.start(), range.end());
                let range = if most.is_finite() {
                    format!("from {least} to {most}")
                } else {
                    format!("at least {least}")
                };
                self.problem(name, &format!("it has the value {value}: it must be {range}"));
                None
            }
            None => Some(table),
        }
    }

    /// A mean free path: at least 0.
    pub fn length(&mut self, name: &str) -> Option<PropertyTable> {
        self.table_in(name, 0.0..=f64::INFINITY)
    }

    /// A property whose values are positive: an index or a velocity.
    pub fn positive(&mut self, name: &str) -> Option<PropertyTable> {
        let table = self.table(name)?;
        match table.values().iter().find(|value| **value <= 0.0) {
            Some(value) => {
                self.problem(name, &format!("it has the value {value}: it must be positive"));
                None
            }
            None => Some(table),
        }
    }

    /// An emission spectrum.
    pub fn spectrum(&mut self, name: &str) -> Option<Spectrum> {
        let table = self.table(name)?;
        self.accept(name, Spectrum::new(&table))
    }

    /// A constant property.
    pub fn constant(&mut self, name: &str) -> Option<f64> {
        let matrix = self.take(name)?;
        match matrix.values.as_slice() {
            [value] if matrix.columns == 1 => Some(*value),
            _ => {
                self.problem(name, "it is a constant: it needs one value in one column (coldim=\"1\")");
                None
            }
        }
    }

    fn accept<T>(&mut self, name: &str, made: Result<T, PropertyError>) -> Option<T> {
        made.map_err(|error| self.problem(name, error.to_string().trim_end_matches('.'))).ok()
    }

    /// Reports a problem of a property.
    pub fn problem(&mut self, name: &str, reason: &str) {
        let problem = format!("the property `{name}` of {} is invalid", self.owner);
        self.reader.problem(Message::new(problem, reason));
    }

    /// True if a property has not been read yet.
    pub fn has(&self, name: &str) -> bool {
        self.rest.iter().any(|(own, _)| own == name)
    }

    /// Notes the properties that nothing has read.
    pub fn finish(self) {
        let Properties { reader, owner, rest } = self;
        for (name, _) in rest {
            reader.note(format!(
                "{owner}: the property `{name}` is ignored: no process of this version uses it."
            ));
        }
    }
}
