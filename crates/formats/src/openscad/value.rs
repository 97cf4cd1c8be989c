//! Values of arguments.

use rayweave_scene::Span;

/// A value; lists nest to the depth that the parser allows.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Undefined,
    Boolean(bool),
    Number(f64),
    Text(String),
    List(Vec<Value>),
}

impl Value {
    pub fn number(&self) -> Option<f64> {
        match self {
            Value::Number(number) => Some(*number),
            _ => None,
        }
    }

    pub fn list(&self) -> Option<&[Value]> {
        match self {
            Value::List(list) => Some(list),
            _ => None,
        }
    }

    /// The numbers of a list of numbers, else `None`.
    pub fn numbers(&self) -> Option<Vec<f64>> {
        self.list()?.iter().map(Value::number).collect()
    }
}

/// An argument `name = value`; OpenSCAD writes all names.
#[derive(Clone, Debug)]
pub(super) struct Argument {
    pub name: String,
    pub value: Value,
    pub span: Span,
}
