//! Argument checking: (name, value) pairs from a file or a call become the parameters of a primitive.

use super::error::ShapeError;
use super::parameter::Parameter;
use super::value::Value;
use rayweave_math::Vec3;

/// Checked arguments of a primitive: every parameter has a value of its kind and range.
pub struct Arguments {
    values: Vec<(&'static str, Value)>,
}

impl Arguments {
    /// Checks the pairs against the parameters of a primitive and adds the defaults.
    pub fn read(
        shape: &'static str,
        parameters: &'static [Parameter],
        given: &[(&str, Value)],
    ) -> Result<Arguments, ShapeError> {
        reject_unknown(shape, parameters, given)?;
        let values = parameters
            .iter()
            .map(|parameter| Ok((parameter.name, read_one(shape, parameter, given)?)))
            .collect::<Result<_, _>>()?;
        Ok(Arguments { values })
    }

    fn value(&self, name: &str) -> Option<&Value> {
        let mut all = self.values.iter();
        all.find(|(known, _)| *known == name).map(|(_, value)| value)
    }

    /// The number with this name; NaN, which no primitive accepts, if there is none.
    pub fn number(&self, name: &str) -> f64 {
        match self.value(name) {
            Some(Value::Number(number)) => *number,
            _ => f64::NAN,
        }
    }

    /// A whole number.
    pub fn count(&self, name: &str) -> u32 {
        self.number(name) as u32
    }

    /// A vector; a single number is repeated three times.
    pub fn vector(&self, name: &str) -> Vec3 {
        match self.value(name) {
            Some(Value::Number(number)) => Vec3::splat(*number),
            Some(Value::Vector(list)) if list.len() == 3 => Vec3::from_slice(list),
            _ => Vec3::NAN,
        }
    }

    /// A list of numbers.
    pub fn list(&self, name: &str) -> Vec<f64> {
        match self.value(name) {
            Some(Value::Vector(list)) => list.clone(),
            _ => Vec::new(),
        }
    }

    /// Rows of four numbers.
    pub fn rows(&self, name: &str) -> Vec<[f64; 4]> {
        let four = |row: &Vec<f64>| row.as_slice().try_into().unwrap_or([f64::NAN; 4]);
        match self.value(name) {
            Some(Value::Rows(rows)) => rows.iter().map(four).collect(),
            _ => Vec::new(),
        }
    }

    /// Rows of three numbers.
    pub fn triples(&self, name: &str) -> Vec<[f64; 3]> {
        let three = |row: &Vec<f64>| row.as_slice().try_into().unwrap_or([f64::NAN; 3]);
        match self.value(name) {
            Some(Value::Rows(rows)) => rows.iter().map(three).collect(),
            _ => Vec::new(),
        }
    }

    /// A 4 x 4 matrix.
    pub fn matrix(&self, name: &str) -> [[f64; 4]; 4] {
        self.rows(name).try_into().unwrap_or([[f64::NAN; 4]; 4])
    }
}

fn reject_unknown(
    shape: &'static str,
    parameters: &'static [Parameter],
    given: &[(&str, Value)],
) -> Result<(), ShapeError> {
    let names = || parameters.iter().map(|parameter| parameter.name);
    match given.iter().find(|(name, _)| !names().any(|known| known == *name)) {
        None => Ok(()),
        Some((name, _)) => Err(ShapeError::UnknownParameter {
            shape,
            name: (*name).to_owned(),
            suggestion: rayweave_error::did_you_mean(name, names()),
        }),
    }
}

fn read_one(
    shape: &'static str,
    parameter: &'static Parameter,
    given: &[(&str, Value)],
) -> Result<Value, ShapeError> {
    let mut values = given.iter().filter(|(name, _)| *name == parameter.name);
    let value = values.next().map(|(_, value)| value.clone());
    if values.next().is_some() {
        return Err(ShapeError::RepeatedParameter { shape, parameter: parameter.name });
    }
    let value = value.or(parameter.default_value());
    let value = value.ok_or(ShapeError::MissingParameter {
        shape,
        parameter: parameter.name,
        kind: parameter.kind,
    })?;
    parameter.check(shape, &value)?;
    Ok(value)
}
