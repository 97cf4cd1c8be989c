//! Parameters of primitives: kinds, units, ranges, defaults, and their checks.

use super::error::ShapeError;
use super::value::Value;
use std::fmt;

/// A parameter of a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name in all interfaces.
    pub name: &'static str,
    /// Kind of the value.
    pub kind: ParameterKind,
    /// Unit of its numbers.
    pub unit: ParameterUnit,
    /// Range of each of its numbers.
    pub range: Range,
    /// Default value; `None` if the parameter is required or is an optional list, whose default is empty.
    pub default: Option<f64>,
    /// Meaning, in a few words.
    pub summary: &'static str,
}

/// Kind of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterKind {
    /// A real number.
    Number,
    /// A whole number.
    Count,
    /// A list of three numbers.
    Vector3,
    /// A list of three numbers, or one number that is repeated three times.
    NumberOrVector3,
    /// One row or more of four numbers (a, b, c, d): a plane a x + b y + c z = d.
    Planes,
    /// Rows of three numbers: points, or triangles.
    Triples,
    /// Four rows of four numbers.
    Matrix4,
    /// A list of numbers, empty by default.
    Numbers,
}

impl ParameterKind {
    /// Number of columns, for kinds with rows.
    fn columns(self) -> usize {
        if self == ParameterKind::Triples { 3 } else { 4 }
    }

    /// The type of an argument in Python, for the stub and the documentation of the Python functions.
    pub fn python_type(self) -> &'static str {
        match self {
            ParameterKind::Number => "float",
            ParameterKind::Count => "int",
            ParameterKind::NumberOrVector3 => "float | ArrayLike",
            ParameterKind::Vector3
            | ParameterKind::Planes
            | ParameterKind::Triples
            | ParameterKind::Matrix4
            | ParameterKind::Numbers => "ArrayLike",
        }
    }
}

impl fmt::Display for ParameterKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ParameterKind::Number => "a number",
            ParameterKind::Count => "a whole number",
            ParameterKind::Vector3 => "a list of 3 numbers",
            ParameterKind::NumberOrVector3 => "a number or a list of 3 numbers",
            ParameterKind::Planes => "1 row or more of 4 numbers",
            ParameterKind::Triples => "rows of 3 numbers",
            ParameterKind::Matrix4 => "4 rows of 4 numbers",
            ParameterKind::Numbers => "a list of numbers",
        })
    }
}

/// Unit of a parameter's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterUnit {
    /// The length unit of the document.
    Length,
    /// Degrees.
    Angle,
    /// One over the length unit of the document.
    Curvature,
    /// A count.
    Count,
    /// No unit, or one that differs from entry to entry.
    None,
}

impl fmt::Display for ParameterUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ParameterUnit::Length => "length",
            ParameterUnit::Angle => "degrees",
            ParameterUnit::Curvature => "1/length",
            ParameterUnit::Count => "count",
            ParameterUnit::None => "none",
        })
    }
}

/// Range of a number. NaN is in no range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Any finite number.
    Finite,
    /// Finite and > 0.
    Positive,
    /// > 0 or infinite.
    PositiveOrInfinite,
    /// Finite and >= 0.
    NotNegative,
    /// Greater than the first and less than the second.
    Between(f64, f64),
    /// A whole number from the first to the second.
    Whole(u32, u32),
    /// Any finite number, but not zero for all components of the vector.
    Direction,
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Range::Finite => f.write_str("finite"),
            Range::Positive => f.write_str("finite and greater than 0"),
            Range::PositiveOrInfinite => f.write_str("greater than 0, or inf"),
            Range::NotNegative => f.write_str("finite and at least 0"),
            Range::Between(lo, hi) => write!(f, "greater than {lo} and less than {hi}"),
            Range::Whole(lo, hi) => write!(f, "a whole number from {lo} to {hi}"),
            Range::Direction => f.write_str("finite and not all 0"),
        }
    }
}

impl Range {
    /// True if a number is in the range; for [`Range::Direction`], if it may be a component.
    pub fn contains(&self, value: f64) -> bool {
        match *self {
            Range::Finite | Range::Direction => value.is_finite(),
            Range::Positive => value.is_finite() && value > 0.0,
            Range::PositiveOrInfinite => value > 0.0,
            Range::NotNegative => value.is_finite() && value >= 0.0,
            Range::Between(lo, hi) => lo < value && value < hi,
            Range::Whole(lo, hi) => value.fract() == 0.0 && f64::from(lo) <= value && value <= f64::from(hi),
        }
    }

    /// A value in the range that was possibly meant.
    fn suggestion(&self, value: f64) -> Option<f64> {
        let nearest = match *self {
            Range::Whole(lo, hi) => value.round().clamp(f64::from(lo), f64::from(hi)),
            Range::Between(0.0, hi) => value.rem_euclid(hi),
            _ => -value,
        };
        self.contains(nearest).then_some(nearest)
    }
}

/// Smallest and largest accepted length: their fourth powers, which occur in tori, are far from the ends of the range of
/// `f64`.
const LENGTHS: (f64, f64) = (1e-60, 1e60);

impl Parameter {
    /// A required number.
    pub(super) const fn number(
        name: &'static str,
        unit: ParameterUnit,
        range: Range,
        summary: &'static str,
    ) -> Parameter {
        Parameter::new(name, ParameterKind::Number, unit, range, summary)
    }

    /// A required parameter.
    pub(super) const fn new(
        name: &'static str,
        kind: ParameterKind,
        unit: ParameterUnit,
        range: Range,
        summary: &'static str,
    ) -> Parameter {
        Parameter { name, kind, unit, range, default: None, summary }
    }

    /// The parameter with a default.
    pub(super) const fn or(mut self, default: f64) -> Parameter {
        self.default = Some(default);
        self
    }

    /// An optional list of numbers without a unit.
    pub(super) const fn list(name: &'static str, summary: &'static str) -> Parameter {
        Parameter::new(name, ParameterKind::Numbers, ParameterUnit::None, Range::Finite, summary)
    }

    /// Default value; `None` if the parameter is required.
    pub fn default_value(&self) -> Option<Value> {
        match self.kind {
            ParameterKind::Numbers => Some(Value::Vector(Vec::new())),
            _ => self.default.map(Value::Number),
        }
    }

    /// Checks a value for this parameter of `shape`.
    pub fn check(&self, shape: &'static str, value: &Value) -> Result<(), ShapeError> {
        self.check_kind(shape, value)?;
        match value {
            Value::Number(number) => self.check_number(shape, *number, Vec::new()),
            Value::Vector(list) => self.check_list(shape, list, &[]),
            Value::Rows(rows) => (0..).zip(rows).try_for_each(|(i, row)| self.check_list(shape, row, &[i])),
        }
    }

    fn check_kind(&self, shape: &'static str, value: &Value) -> Result<(), ShapeError> {
        let wrong = |index, found: String| {
            Err(ShapeError::WrongKind { shape, parameter: self.name, index, expected: self.kind, found })
        };
        let good = match (self.kind, value) {
            (
                ParameterKind::Number | ParameterKind::Count | ParameterKind::NumberOrVector3,
                Value::Number(_),
            ) => true,
            (ParameterKind::Vector3 | ParameterKind::NumberOrVector3, Value::Vector(list)) => list.len() == 3,
            (ParameterKind::Numbers, Value::Vector(_)) => true,
            (ParameterKind::Planes | ParameterKind::Triples, Value::Rows(rows)) => !rows.is_empty(),
            (ParameterKind::Matrix4, Value::Rows(rows)) => rows.len() == 4,
            _ => false,
        };
        match value {
            _ if !good => wrong(Vec::new(), value.description()),
            Value::Rows(rows) => match rows.iter().position(|row| row.len() != self.kind.columns()) {
                Some(i) => wrong(vec![i], Value::Vector(rows[i].clone()).description()),
                None => Ok(()),
            },
            _ => Ok(()),
        }
    }

    fn check_list(&self, shape: &'static str, list: &[f64], row: &[usize]) -> Result<(), ShapeError> {
        for (i, &number) in list.iter().enumerate() {
            self.check_number(shape, number, [row, &[i]].concat())?;
        }
        // the first three numbers of a plane's row are its normal
        if self.range == Range::Direction && list[..3].iter().all(|&number| number == 0.0) {
            return Err(ShapeError::ZeroNormal { shape, parameter: self.name, index: row.to_vec() });
        }
        Ok(())
    }

    fn check_number(&self, shape: &'static str, value: f64, index: Vec<usize>) -> Result<(), ShapeError> {
        if !self.range.contains(value) {
            return Err(ShapeError::OutOfRange {
                shape,
                parameter: self.name,
                index,
                value,
                range: self.range,
                suggestion: self.range.suggestion(value),
            });
        }
        match self.unit {
            ParameterUnit::Length if value.is_finite() => check_length(shape, self.name, index, value),
            ParameterUnit::Length
            | ParameterUnit::Angle
            | ParameterUnit::Curvature
            | ParameterUnit::Count
            | ParameterUnit::None => Ok(()),
        }
    }
}

/// An error if a length is out of range or infinite; 0 is accepted.
pub(super) fn check_length(
    shape: &'static str,
    parameter: &'static str,
    index: Vec<usize>,
    value: f64,
) -> Result<(), ShapeError> {
    let size = value.abs();
    if size == 0.0 || (LENGTHS.0..=LENGTHS.1).contains(&size) {
        return Ok(());
    }
    Err(ShapeError::Extreme { shape, parameter, index, value })
}

/// An error if the first of two parameters is not less than the second.
pub(super) fn check_increasing(
    shape: &'static str,
    (lower, lo): (&'static str, f64),
    (upper, hi): (&'static str, f64),
    index: Vec<usize>,
) -> Result<(), ShapeError> {
    if lo < hi {
        return Ok(());
    }
    Err(ShapeError::NotIncreasing { shape, lower, upper, index, lo, hi })
}
