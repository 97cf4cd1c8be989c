//! Reader of properties: matrices by name, constants, and a record of what was used.

use crate::error::{PhotonError, PropertyError};
use crate::property::{PropertyTable, Spectrum};
use rayweave_error::Message;
use rayweave_scene::Datum;
use std::collections::HashMap;
use std::fmt;

/// Reads properties and collects problems and notes.
pub(crate) struct PropertyReader {
    matrices: HashMap<String, Matrix>,
    /// Invalid input, with its owner and the property, or an empty name.
    pub problems: Vec<(Owner, String, Message)>,
    /// Ignored input.
    pub notes: Vec<(Owner, String, Message)>,
}

/// An element of a GDML file that messages are about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Owner {
    /// `material`, `surface`, `skin` or `border`.
    pub element: &'static str,
    pub name: String,
}

impl Owner {
    pub fn new(element: &'static str, name: impl Into<String>) -> Owner {
        Owner { element, name: name.into() }
    }
}

impl fmt::Display for Owner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let word = match self.element {
            "surface" => "optical surface",
            "skin" => "skin surface",
            "border" => "border surface",
            other => other,
        };
        write!(f, "{word} `{}`", self.name)
    }
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
    owner: Owner,
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
    pub fn of<'r>(&'r mut self, owner: Owner, row: &Datum) -> Properties<'r> {
        let entries = row.get("properties").into_iter().flat_map(Datum::entries);
        let rest = entries.map(|(name, datum)| (name.to_owned(), datum.clone())).collect();
        Properties { reader: self, owner, rest }
    }

    /// Adds a problem of an element.
    pub fn problem(&mut self, owner: Owner, problem: Message) {
        self.problems.push((owner, String::new(), problem));
    }

    /// Adds a note about an element.
    pub fn note(&mut self, owner: Owner, note: Message) {
        self.notes.push((owner, String::new(), note));
    }

    /// The notes.
    ///
    /// # Errors
    ///
    /// All problems, if there are any.
    pub fn finish(self) -> Result<Vec<String>, PhotonError> {
        if self.problems.is_empty() {
            return Ok(self.notes.into_iter().map(|(.., note)| note.to_string()).collect());
        }
        Err(PhotonError::Detector(self.problems.into_iter().map(|(.., problem)| problem).collect()))
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
        self.reader.problems.push((self.owner.clone(), name.to_owned(), Message::new(problem, reason)));
    }

    /// Removes a property, which nothing uses, without a note.
    pub fn drop(&mut self, name: &str) {
        self.rest.retain(|(own, _)| own != name);
    }

    /// True if a property comes before another one in the file; both have not been read yet.
    pub fn is_before(&self, first: &str, second: &str) -> bool {
        let at = |name: &str| self.rest.iter().position(|(own, _)| own == name);
        at(first).zip(at(second)).is_some_and(|(first, second)| first < second)
    }

    /// True if a property has not been read yet.
    pub fn has(&self, name: &str) -> bool {
        self.rest.iter().any(|(own, _)| own == name)
    }

    /// Notes the properties that nothing has read.
    pub fn finish(self) {
        let Properties { reader, owner, rest } = self;
        for (name, _) in rest {
            let problem = format!("{owner}: the property `{name}` is ignored");
            let note = Message::new(problem, "no process of this version uses it");
            reader.notes.push((owner.clone(), name, note));
        }
    }
}
