//! Reader of properties: matrices by name, constants, and a record of what was used.

use crate::error::{PhotonError, PropertyError};
use crate::property::{PropertyTable, Spectrum};
use rayweave_error::Message;
use rayweave_scene::{Datum, Diagnostic, Diagnostics, Source, Span, Spanned};
use std::collections::HashMap;
use std::sync::Arc;

/// Reads properties and collects problems and notes.
pub(crate) struct PropertyReader {
    matrices: HashMap<String, Matrix>,
    /// The native model file that the properties come from.
    source: Option<Arc<Source>>,
    problems: Vec<(Message, Span)>,
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
    rest: Vec<(String, Spanned<Datum>)>,
    /// The places of all properties.
    spans: HashMap<String, Span>,
}

impl PropertyReader {
    /// A reader of the matrices of a `[gdml]` table, or of the properties in a native model file.
    pub fn new(table: &Datum, source: Option<&Arc<Source>>) -> PropertyReader {
        let matrix = |row: &Datum| {
            let name = row.get("name")?.as_text()?.to_owned();
            let columns = row.get("columns")?.as_number()? as usize;
            let values = row.list("values").filter_map(Datum::as_number);
            Some((name, Matrix { columns, values: values.collect() }))
        };
        let matrices = table.list("matrix").filter_map(matrix).collect();
        PropertyReader { matrices, source: source.cloned(), problems: Vec::new(), notes: Vec::new() }
    }

    /// The properties in a row of the table.
    pub fn of<'r>(&'r mut self, owner: String, row: &Datum) -> Properties<'r> {
        let entries = match row.get("properties") {
            Some(Datum::Table(table)) => table.as_slice(),
            _ => &[],
        };
        let rest = entries.iter().map(|(name, datum)| (name.value.clone(), datum.clone())).collect();
        let spans = entries.iter().map(|(name, datum)| (name.value.clone(), datum.span)).collect();
        Properties { reader: self, owner, rest, spans }
    }

    /// Adds a problem.
    pub fn problem(&mut self, problem: Message) {
        self.problem_at(problem, Span::default());
    }

    /// Adds a problem at a place of a native model file.
    pub fn problem_at(&mut self, problem: Message, span: Span) {
        self.problems.push((problem, span));
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
        let PropertyReader { source, problems, notes, .. } = self;
        if problems.is_empty() {
            return Ok(notes);
        }
        Err(match source {
            None => PhotonError::Detector(problems.into_iter().map(|(message, _)| message).collect()),
            Some(source) => {
                let diagnostic = |(message, span): (Message, Span)| {
                    let suggestion = message.suggestion().map(str::to_owned);
                    let problem = Diagnostic::error(message.problem()).why(message.reason());
                    problem.suggest(suggestion).at(&source, span)
                };
                PhotonError::File(Diagnostics::new(problems.into_iter().map(diagnostic).collect()))
            }
        })
    }
}

impl Properties<'_> {
    fn take(&mut self, name: &str) -> Option<Matrix> {
        let at = self.rest.iter().position(|(own, _)| own == name)?;
        let (_, datum) = self.rest.remove(at);
        match datum.value {
            Datum::List(_) => {
                let values = datum.value.items().filter_map(Datum::as_number).collect();
                Some(Matrix { columns: 2, values })
            }
            Datum::Number(value) => Some(Matrix { columns: 1, values: vec![value] }),
            // an unknown matrix was reported by the reader of the file
            Datum::Text(matrix) => self.reader.matrices.get(&matrix).cloned(),
            _ => None,
        }
    }

    /// A property that depends on the energy.
    pub fn table(&mut self, name: &str) -> Option<PropertyTable> {
        let matrix = self.take(name)?;
        if let (Some(_), [value]) = (&self.reader.source, matrix.values.as_slice()) {
            // a number in a native model file holds at all energies
            return self.accept(name, PropertyTable::new(vec![(1e-6, *value)]));
        }
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

    /// A constant property that is at least 0 and finite.
    pub fn at_least_zero(&mut self, name: &str) -> Option<f64> {
        let value = self.constant(name)?;
        if value >= 0.0 && value.is_finite() {
            return Some(value);
        }
        self.problem(name, &format!("it is {value}: it must be finite and at least 0"));
        None
    }

    /// Reads a property by its former name as well, with a note.
    pub fn former(&mut self, former: &str, name: &str) {
        let Some(at) = self.rest.iter().position(|(own, _)| own == former) else { return };
        if self.has(name) {
            // noted as unused
            return;
        }
        name.clone_into(&mut self.rest[at].0);
        self.spans.insert(name.to_owned(), self.rest[at].1.span);
        let owner = &self.owner;
        self.reader
            .note(format!("{owner}: the property `{former}` is read as `{name}`, its name since Geant4 11."));
    }

    /// The share of the first of two components, from 0 to 1: a property of Geant4 before version 11, which is noted.
    pub fn ratio(&mut self, name: &str) -> Option<f64> {
        let value = self.at_least_zero(name)?;
        if value > 1.0 {
            self.problem(name, &format!("it is {value}: it must be from 0 to 1"));
            return None;
        }
        let owner = &self.owner;
        self.reader.note(format!(
            "{owner}: the property `{name}` is read as `SCINTILLATIONYIELD1` = {value} and `SCINTILLATIONYIELD2` = {}.",
            1.0 - value
        ));
        Some(value)
    }

    fn accept<T>(&mut self, name: &str, made: Result<T, PropertyError>) -> Option<T> {
        made.map_err(|error| self.problem(name, error.to_string().trim_end_matches('.'))).ok()
    }

    /// Reports a problem of a property.
    pub fn problem(&mut self, name: &str, reason: &str) {
        let problem = format!("the property `{name}` of {} is invalid", self.owner);
        let span = self.spans.get(name).copied().unwrap_or_default();
        self.reader.problem_at(Message::new(problem, reason), span);
    }

    /// True if a property has not been read yet.
    pub fn has(&self, name: &str) -> bool {
        self.rest.iter().any(|(own, _)| own == name)
    }

    /// Notes the properties that nothing has read.
    pub fn finish(self) {
        let Properties { reader, owner, rest, .. } = self;
        for (name, _) in rest {
            reader.note(format!(
                "{owner}: the property `{name}` is ignored: no process of this version uses it."
            ));
        }
    }
}
