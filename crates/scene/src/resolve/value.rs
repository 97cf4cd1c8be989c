//! Values of shapes: numbers, lists of numbers, lists of rows.

use super::context::Context;
use super::numbers::Numbers;
use crate::datum::Datum;
use crate::diagnostic::Diagnostic;
use crate::source::{Span, Spanned};
use rayweave_shape::primitive::Value;

/// The value of a shape's parameter.
pub(super) fn value(
    context: &mut Context,
    numbers: &Numbers,
    name: &str,
    datum: &Spanned<Datum>,
) -> Option<Value> {
    match &datum.value {
        Datum::List(list) if list.iter().any(|item| matches!(item.value, Datum::List(_))) => {
            let rows: Vec<_> = list.iter().map(|row| row_values(context, numbers, name, row)).collect();
            rows.into_iter().collect::<Option<_>>().map(Value::Rows)
        }
        Datum::List(_) => row_values(context, numbers, name, datum).map(Value::Vector),
        _ => scalar(context, numbers, name, datum).map(Value::Number),
    }
}

fn row_values(
    context: &mut Context,
    numbers: &Numbers,
    name: &str,
    datum: &Spanned<Datum>,
) -> Option<Vec<f64>> {
    match &datum.value {
        Datum::List(list) => {
            let values: Vec<_> = list.iter().map(|item| scalar(context, numbers, name, item)).collect();
            values.into_iter().collect()
        }
        other => wrong_type(context, name, other, "a list of numbers", datum.span),
    }
}

/// A number, given as a number or as an arithmetic expression.
pub(super) fn scalar(
    context: &mut Context,
    numbers: &Numbers,
    name: &str,
    datum: &Spanned<Datum>,
) -> Option<f64> {
    match &datum.value {
        Datum::Number(value) => Some(*value),
        Datum::Text(text) => numbers.text(context, text, datum.span),
        other => wrong_type(context, name, other, "a number or an arithmetic expression", datum.span),
    }
}

/// Reports a value of a wrong type.
pub(super) fn wrong_type<T>(
    context: &mut Context,
    name: &str,
    found: &Datum,
    wanted: &str,
    span: Span,
) -> Option<T> {
    let problem = Diagnostic::error(format!("`{name}` is {}", found.description()));
    context.push(problem.why(format!("it must be {wanted}")), span);
    None
}
