//! Reader of properties: matrices by name, constants, and a record of what was used.

use crate::error::{PhotonError, PropertyError};
use crate::property::{PropertyTable, Spectrum};
use rayweave_error::{Message, did_you_mean};
use rayweave_scene::{Datum, Diagnostic, Diagnostics, Source, Span, Spanned};
use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

/// The largest number of values of all properties of a detector: some 500 MB with the tables that are computed from them.
const MAX_VALUES: usize = 20_000_000;

/// Reads properties and collects problems and notes.
pub(crate) struct PropertyReader {
    matrices: HashMap<String, Matrix>,
    /// The native model file that the properties come from.
    source: Option<Arc<Source>>,
    /// The number of values that all properties have so far: a matrix counts for each use.
    values: usize,
    /// Invalid input.
    pub problems: Vec<Remark>,
    /// Ignored input.
    pub notes: Vec<Remark>,
}

/// A message about an element or one of its properties.
#[derive(Clone, Debug)]
pub(crate) struct Remark {
    pub owner: Owner,
    /// The property; empty if the message is about the element.
    pub property: String,
    pub message: Message,
    /// The place in a native model file.
    span: Span,
}

/// An element of a GDML file that messages are about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Owner {
    /// `material`, `surface`, `skin` or `border`.
    pub element: &'static str,
    pub name: String,
}

impl Remark {
    /// True if the message reports a probable mistake, such as a border surface that names no placement, rather than input that
    /// no process uses.
    pub fn is_mistake(&self) -> bool {
        self.owner.element == "border"
    }
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
        let (problems, notes) = (Vec::new(), Vec::new());
        PropertyReader { matrices, source: source.cloned(), values: 0, problems, notes }
    }

    /// The properties in a row of the table.
    pub fn of<'r>(&'r mut self, owner: Owner, row: &Datum) -> Properties<'r> {
        let entries = match row.get("properties") {
            Some(Datum::Table(table)) => table.as_slice(),
            _ => &[],
        };
        let rest = entries.iter().map(|(name, datum)| (name.value.clone(), datum.clone())).collect();
        let spans = entries.iter().map(|(name, datum)| (name.value.clone(), datum.span)).collect();
        Properties { reader: self, owner, rest, spans }
    }

    /// Adds a problem of an element, at a place of a native model file.
    pub fn problem(&mut self, owner: Owner, message: Message, span: Span) {
        self.problems.push(Remark { owner, property: String::new(), message, span });
    }

    /// Adds a note about an element.
    pub fn note(&mut self, owner: Owner, note: Message) {
        self.notes.push(Remark { owner, property: String::new(), message: note, span: Span::default() });
    }

    /// The warnings about probable mistakes, and the notes.
    ///
    /// # Errors
    ///
    /// All problems, if there are any.
    pub fn finish(self) -> Result<[Vec<String>; 2], PhotonError> {
        let PropertyReader { source, problems, notes, .. } = self;
        if problems.is_empty() {
            // one sentence for the yields of all materials; a check lists them
            let (yields, notes): (Vec<Remark>, Vec<Remark>) =
                notes.into_iter().partition(|note| YIELDS.contains(&note.property.as_str()));
            let (mistakes, notes): (Vec<Remark>, Vec<Remark>) =
                notes.into_iter().partition(Remark::is_mistake);
            let [warnings, mut notes] = [mistakes, notes]
                .map(|list| list.into_iter().map(|note| note.message.to_string()).collect::<Vec<_>>());
            notes.extend((!yields.is_empty()).then(|| OF_YIELDS.to_owned()));
            return Ok([warnings, notes]);
        }
        Err(match source {
            None => PhotonError::Detector(problems.into_iter().map(|problem| problem.message).collect()),
            Some(source) => {
                let diagnostic = |Remark { message, span, .. }: Remark| {
                    let suggestion = message.suggestion().map(str::to_owned);
                    let problem = Diagnostic::error(message.problem()).why(message.reason());
                    problem.suggest(suggestion).at(&source, span)
                };
                PhotonError::File(Diagnostics::new(problems.into_iter().map(diagnostic).collect()))
            }
        })
    }
}

/// The properties that state how many photons a particle emits; photons do not depend on them.
const YIELDS: [&str; 2] = ["SCINTILLATIONYIELD", "RESOLUTIONSCALE"];

/// The beginning of the names of the spectra of scintillation.
const SPECTRUM: &str = "SCINTILLATIONCOMPONENT";

const OF_YIELDS: &str = "SCINTILLATIONYIELD and RESOLUTIONSCALE have no effect: numbers of scintillation photons come from the source, \
                         -n or gensteps. The mean is SCINTILLATIONYIELD times the deposited energy.";

/// The reason for the lack of an effect of a property, and the advice.
fn without_effect(name: &str) -> (&'static str, Option<&'static str>) {
    match name {
        "SCINTILLATIONYIELD" | "RESOLUTIONSCALE" => (
            "the source gives the number of scintillation photons",
            Some(
                "Their mean is SCINTILLATIONYIELD times the deposited energy: state it with -n or in gensteps.",
            ),
        ),
        // of two independent processes with the lengths l and m, the first one comes first with the probability m / (l + m)
        "REEMISSIONPROB" => (
            "it is a property of Opticks, which Geant4 does not have either",
            Some(
                "For the probability p and the length L of ABSLENGTH, set ABSLENGTH to L/(1-p), WLSABSLENGTH to L/p, WLSCOMPONENT to \
                 the emission spectrum and WLSTIMECONSTANT to its decay time, with --wls-time-profile exponential.",
            ),
        ),
        _ => ("no process of this version uses it", None),
    }
}

/// The properties of Geant4 that a misspelt name may mean.
const KNOWN: [&str; 44] = [
    "RINDEX",
    "GROUPVEL",
    "ABSLENGTH",
    "RAYLEIGH",
    "EFFICIENCY",
    "REFLECTIVITY",
    "TRANSMITTANCE",
    "REALRINDEX",
    "IMAGINARYRINDEX",
    "SURFACEROUGHNESS",
    "SPECULARLOBECONSTANT",
    "SPECULARSPIKECONSTANT",
    "BACKSCATTERCONSTANT",
    "COATEDRINDEX",
    "COATEDTHICKNESS",
    "COATEDFRUSTRATEDTRANSMISSION",
    "ISOTHERMAL_COMPRESSIBILITY",
    "RS_SCALE_FACTOR",
    "MIEHG",
    "MIEHG_FORWARD",
    "MIEHG_BACKWARD",
    "MIEHG_FORWARD_RATIO",
    "SCINTILLATIONYIELD",
    "SCINTILLATIONYIELD1",
    "SCINTILLATIONYIELD2",
    "SCINTILLATIONYIELD3",
    "RESOLUTIONSCALE",
    "SCINTILLATIONCOMPONENT1",
    "SCINTILLATIONCOMPONENT2",
    "SCINTILLATIONCOMPONENT3",
    "SCINTILLATIONTIMECONSTANT1",
    "SCINTILLATIONTIMECONSTANT2",
    "SCINTILLATIONTIMECONSTANT3",
    "SCINTILLATIONRISETIME1",
    "SCINTILLATIONRISETIME2",
    "SCINTILLATIONRISETIME3",
    "WLSCOMPONENT",
    "WLSCOMPONENT2",
    "WLSABSLENGTH",
    "WLSABSLENGTH2",
    "WLSTIMECONSTANT",
    "WLSTIMECONSTANT2",
    "WLSMEANNUMBERPHOTONS",
    "WLSMEANNUMBERPHOTONS2",
];

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
            Datum::Text(matrix) => {
                let matrix = self.reader.matrices.get(&matrix)?;
                let before = self.reader.values;
                self.reader.values = before.saturating_add(matrix.values.len());
                if self.reader.values <= MAX_VALUES {
                    return Some(matrix.clone());
                }
                // once, not for each further property
                if before <= MAX_VALUES {
                    let reason = format!(
                        "the properties up to here have more than {MAX_VALUES} values: a matrix counts for each use"
                    );
                    self.problem(name, &reason);
                }
                None
            }
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
        let problem = format!("{}: the property `{former}` is read as `{name}`", self.owner);
        self.note(former, Message::new(problem, "that is its name since Geant4 11"));
    }

    /// The share of the first of two components, from 0 to 1: a property of Geant4 before version 11, which is noted.
    pub fn ratio(&mut self, name: &str) -> Option<f64> {
        let value = self.at_least_zero(name)?;
        if value > 1.0 {
            self.problem(name, &format!("it is {value}: it must be from 0 to 1"));
            return None;
        }
        let problem = format!("{}: the property `{name}` is read as two yields", self.owner);
        let reason = format!("`SCINTILLATIONYIELD1` is {value} and `SCINTILLATIONYIELD2` is {}", 1.0 - value);
        self.note(name, Message::new(problem, reason));
        Some(value)
    }

    fn note(&mut self, property: &str, message: Message) {
        let (owner, property, span) = (self.owner.clone(), property.to_owned(), Span::default());
        self.reader.notes.push(Remark { owner, property, message, span });
    }

    fn accept<T>(&mut self, name: &str, made: Result<T, PropertyError>) -> Option<T> {
        made.map_err(|error| self.problem(name, error.to_string().trim_end_matches('.'))).ok()
    }

    /// Reports a problem of a property.
    pub fn problem(&mut self, name: &str, reason: &str) {
        let problem = format!("the property `{name}` of {} is invalid", self.owner);
        let span = self.spans.get(name).copied().unwrap_or_default();
        let message = Message::new(problem, reason);
        let remark = Remark { owner: self.owner.clone(), property: name.to_owned(), message, span };
        self.reader.problems.push(remark);
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
        let Properties { reader, owner, rest, spans } = self;
        let scintillates = spans.keys().any(|name| name.starts_with(SPECTRUM));
        // they belong to a scintillator in Geant4, which stops without them: nothing is wrong with the file
        let is_noted = |name: &str| !(scintillates && YIELDS.contains(&name));
        for (name, _) in rest.into_iter().filter(|(name, _)| is_noted(name)) {
            let problem = format!("{owner}: the property `{name}` is ignored");
            let (reason, advice) = without_effect(&name);
            let note = Message::new(problem, reason);
            let near = did_you_mean(&name, KNOWN).filter(|_| !KNOWN.contains(&name.as_str()));
            let note = match (advice, near) {
                (Some(advice), _) => note.suggest(advice),
                (None, Some(near)) => note.suggest(format!("Did you mean `{near}`?")),
                (None, None) => note,
            };
            let span = Span::default();
            reader.notes.push(Remark { owner: owner.clone(), property: name, message: note, span });
        }
    }
}
