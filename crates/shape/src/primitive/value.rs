//! Parameter values, in all interfaces.

use rayweave_math::Vec3;
use std::fmt;

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// One number.
    Number(f64),
    /// A list of numbers.
    Vector(Vec<f64>),
    /// A list of rows.
    Rows(Vec<Vec<f64>>),
}

impl Value {
    /// Description for messages: `a number`, `a list of 3 numbers`, `4 rows of 2 numbers`.
    pub(super) fn description(&self) -> String {
        match self {
            Value::Number(_) => "a number".to_owned(),
            Value::Vector(list) => format!("a list of {}", numbers(list.len())),
            Value::Rows(rows) => describe_rows(rows),
        }
    }
}

fn describe_rows(rows: &[Vec<f64>]) -> String {
    match rows {
        [] => "an empty list".to_owned(),
        [first, rest @ ..] if rest.iter().all(|row| row.len() == first.len()) => {
            format!("{} row(s) of {}", rows.len(), numbers(first.len()))
        }
        _ => "rows of different lengths".to_owned(),
    }
}

fn numbers(count: usize) -> String {
    format!("{count} number{}", if count == 1 { "" } else { "s" })
}

impl From<f64> for Value {
    fn from(number: f64) -> Value {
        Value::Number(number)
    }
}

impl From<u32> for Value {
    fn from(count: u32) -> Value {
        Value::Number(f64::from(count))
    }
}

impl From<Vec3> for Value {
    fn from(vector: Vec3) -> Value {
        Value::Vector(vector.to_array().to_vec())
    }
}

impl From<&[f64]> for Value {
    fn from(list: &[f64]) -> Value {
        Value::Vector(list.to_vec())
    }
}

impl<const N: usize> From<&[[f64; N]]> for Value {
    fn from(rows: &[[f64; N]]) -> Value {
        Value::Rows(rows.iter().map(|row| row.to_vec()).collect())
    }
}

/// The syntax of the model file: `1.5`, `[1, 2, 3]`, `inf`.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Number(number) => write!(f, "{}", short(*number)),
            Value::Vector(list) => write!(f, "{}", bracketed(list)),
            Value::Rows(rows) => {
                let rows: Vec<String> = rows.iter().map(|row| bracketed(row)).collect();
                write!(f, "[{}]", rows.join(", "))
            }
        }
    }
}

fn bracketed(list: &[f64]) -> String {
    let list: Vec<String> = list.iter().map(|&number| short(number)).collect();
    format!("[{}]", list.join(", "))
}

/// The shortest text that reads back to the same bits, with an exponent for very large or small numbers.
pub(super) fn short(number: f64) -> String {
    let plain = number == 0.0 || (1e-5..1e15).contains(&number.abs()) || !number.is_finite();
    match number {
        _ if number.is_nan() => "nan".to_owned(),
        _ if plain => format!("{number}"),
        _ => format!("{number:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_reads_back() {
        for number in [0.0, -1.0, 0.1, 1e-7, 2.5e300, 123456789.0, f64::INFINITY] {
            assert_eq!(Value::from(number).to_string().parse(), Ok(number));
        }
        assert_eq!(Value::from(Vec3::new(1.0, -0.5, 1e20)).to_string(), "[1, -0.5, 1e20]");
        let rows: &[[f64; 2]] = &[[1.0, 2.0], [3.0, f64::NAN]];
        assert_eq!(Value::from(rows).to_string(), "[[1, 2], [3, nan]]");
    }

    #[test]
    fn descriptions() {
        assert_eq!(Value::Vector(vec![1.0]).description(), "a list of 1 number");
        assert_eq!(Value::Rows(vec![]).description(), "an empty list");
        assert_eq!(Value::Rows(vec![vec![1.0], vec![]]).description(), "rows of different lengths");
        assert_eq!(Value::Rows(vec![vec![1.0, 2.0]; 3]).description(), "3 row(s) of 2 numbers");
    }
}
