//! Attribute values: expressions times units. All problems of a file are collected.

use super::context::Context;
use super::expression::{Fault, Names};
use super::problem::Place;
use super::problem::Problem;
use super::units::{self, Quantity};
use super::xml::{Attribute, Element};
use rayweave_math::Vec3;
use rayweave_scene::Span;
use rayweave_shape::primitive::ShapeError;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Maximum number of elements that the loops of a file may generate.
const MAX_STEPS: usize = 500_000;

/// The reason why an element could not be read.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Failure {
    /// The problem has already been reported.
    Reported,
    /// Valid but unsupported; holds the reason.
    Refused(String),
}

impl From<ShapeError> for Failure {
    fn from(error: ShapeError) -> Failure {
        Failure::Refused(error.to_string())
    }
}

/// A refusal with a reason.
pub(super) fn refused<T>(reason: impl Into<String>) -> Result<T, Failure> {
    Err(Failure::Refused(reason.into()))
}

/// Named values of a file, and the problems found so far.
pub(super) struct Numbers<'c> {
    pub context: &'c mut Context,
    pub names: Names,
    pub positions: BTreeMap<String, Vec3>,
    /// Rotations: angles about x, y and z, in degrees.
    pub rotations: BTreeMap<String, Vec3>,
    pub scales: BTreeMap<String, Vec3>,
    steps: usize,
}

impl<'c> Numbers<'c> {
    pub fn new(context: &'c mut Context) -> Numbers<'c> {
        Numbers {
            context,
            names: Names::default(),
            positions: BTreeMap::new(),
            rotations: BTreeMap::new(),
            scales: BTreeMap::new(),
            steps: 0,
        }
    }

    /// Reports a problem as an error.
    pub fn error(&mut self, problem: Problem) -> Failure {
        self.context.error(problem);
        Failure::Reported
    }

    /// Counts the faces of a solid that has more of them than numbers in its text, before they are made.
    pub fn count_faces(&mut self, faces: usize) -> Result<(), Failure> {
        let (all, most) = (self.context.faces.saturating_add(faces), self.context.size_limit());
        if all > most {
            return refused(format!(
                "with the solids before it, it has too many faces: files of this length may have {most}"
            ));
        }
        self.context.faces = all;
        Ok(())
    }

    /// A required attribute.
    pub fn need<'e>(&mut self, element: &'e Element, name: &str) -> Result<&'e Attribute, Failure> {
        element.attribute(name).ok_or_else(|| {
            let known = element.attributes.iter().map(|attribute| attribute.name.as_str());
            let unlike = |known: &&str| !["name", "lunit", "aunit"].contains(known);
            let message = format!("`{}` has no attribute `{name}`: it is required.", element.name);
            let near = rayweave_error::did_you_mean(name, known.filter(unlike));
            let slip = near.map(|near| format!(" Did you mean `{near}`?")).unwrap_or_default();
            self.error(Problem::new(message + &slip, element.place))
        })
    }

    /// Name of an element, with bracketed expressions expanded.
    pub fn name(&mut self, element: &Element) -> Result<String, Failure> {
        let attribute = self.need(element, "name")?;
        self.expanded(attribute)
    }

    /// The name in a reference attribute.
    pub fn reference(&mut self, element: &Element, attribute: &str) -> Result<(String, Place), Failure> {
        let attribute = self.need(element, attribute)?;
        Ok((self.expanded(attribute)?, attribute.place))
    }

    fn expanded(&mut self, attribute: &Attribute) -> Result<String, Failure> {
        if self.steps == 0 {
            return Ok(attribute.value.clone());
        }
        self.names.expand(&attribute.value).map_err(|fault| self.fault(fault, attribute))
    }

    /// Value of an attribute.
    pub fn value(&mut self, attribute: &Attribute) -> Result<f64, Failure> {
        match attribute.value.trim().parse::<f64>() {
            // fast path: most values are plain numbers; `inf` and `nan` would be names
            Ok(value) if value.is_finite() => Ok(value),
            _ => self.names.evaluate(&attribute.value).map_err(|fault| self.fault(fault, attribute)),
        }
    }

    fn fault(&mut self, fault: Fault, attribute: &Attribute) -> Failure {
        // the definition of the name has been reported
        if fault.unknown.as_ref().is_some_and(|name| self.names.has_failed(name)) {
            return Failure::Reported;
        }
        let start = attribute.place.span.start();
        let span = match attribute.verbatim {
            true => Span::new(start + fault.span.start(), start + fault.span.end()),
            false => attribute.place.span,
        };
        let problem = Problem::new(fault.problem, Place { span, ..attribute.place });
        let problem = match &fault.unknown {
            Some(name) => problem.did_you_mean(name, self.names.all()),
            None => problem,
        };
        self.error(problem)
    }

    /// A required number.
    pub fn number(&mut self, element: &Element, name: &str) -> Result<f64, Failure> {
        let attribute = self.need(element, name)?;
        self.value(attribute)
    }

    /// An optional number with a default.
    pub fn number_or(&mut self, element: &Element, name: &str, default: f64) -> Result<f64, Failure> {
        element.attribute(name).map_or(Ok(default), |attribute| self.value(attribute))
    }

    /// An integer within a range.
    pub fn whole(&mut self, element: &Element, name: &str, least: i64, most: i64) -> Result<i64, Failure> {
        let attribute = self.need(element, name)?;
        self.whole_value(name, attribute, least, most)
    }

    /// The value of an attribute, which must be a whole number within a range.
    pub fn whole_value(
        &mut self,
        name: &str,
        attribute: &Attribute,
        least: i64,
        most: i64,
    ) -> Result<i64, Failure> {
        let value = self.value(attribute)?;
        match value.fract() == 0.0 && (least as f64..=most as f64).contains(&value) {
            true => Ok(value as i64),
            false => {
                let message =
                    format!("`{name}` is {value}: it must be a whole number from {least} to {most}.");
                Err(self.error(Problem::new(message, attribute.place)))
            }
        }
    }

    /// Factor of a unit, which may be an expression of units.
    pub fn unit(
        &mut self,
        element: &Element,
        name: &str,
        quantity: Quantity,
        default: f64,
    ) -> Result<f64, Failure> {
        let Some(attribute) = element.attribute(name) else {
            return Ok(default);
        };
        let symbol = attribute.value.trim();
        let value = match quantity {
            Quantity::Other => self.names.evaluate(symbol).ok(),
            _ => units::of(quantity, symbol),
        };
        value.ok_or_else(|| {
            let what = match quantity {
                Quantity::Length => "length",
                Quantity::Angle => "angle",
                Quantity::Other => "this quantity",
            };
            let problem = Problem::new(format!("`{symbol}` is not a unit of {what}"), attribute.place);
            match quantity {
                Quantity::Other => self.error(problem),
                _ => self.error(problem.did_you_mean(symbol, units::names_of(quantity))),
            }
        })
    }

    /// Factor of `lunit`.
    pub fn length_unit(&mut self, element: &Element) -> Result<f64, Failure> {
        self.unit(element, "lunit", Quantity::Length, 1.0)
    }

    /// Required lengths, in millimetres.
    pub fn lengths<const N: usize>(
        &mut self,
        element: &Element,
        names: [&str; N],
    ) -> Result<[f64; N], Failure> {
        let unit = self.length_unit(element);
        let values = names.map(|name| self.number(element, name));
        scaled(values, unit?)
    }

    /// Optional lengths, 0 by default, in millimetres.
    pub fn lengths_or_zero<const N: usize>(
        &mut self,
        element: &Element,
        names: [&str; N],
    ) -> Result<[f64; N], Failure> {
        let unit = self.length_unit(element);
        let values = names.map(|name| self.number_or(element, name, 0.0));
        scaled(values, unit?)
    }

    /// An angle in degrees.
    pub fn angle(&mut self, element: &Element, name: &str, default: f64) -> Result<f64, Failure> {
        let unit = self.unit(element, "aunit", Quantity::Angle, 1.0);
        let Some(attribute) = element.attribute(name) else {
            return unit.map(|_| default);
        };
        let value = self.value(attribute)?;
        let unit = unit?;
        if unit == 1.0 && value.abs() > 4.0 * PI {
            let message =
                format!("`{name}` is {value} radians: more than two turns. Is `aunit=\"deg\"` missing?");
            self.context.warn(Problem::new(message, attribute.place));
        }
        Ok(degrees(value, unit))
    }

    /// Optional angles, 0 by default, in degrees.
    pub fn angles<const N: usize>(
        &mut self,
        element: &Element,
        names: [&str; N],
    ) -> Result<[f64; N], Failure> {
        let values = names.map(|name| self.angle(element, name, 0.0));
        scaled(values, 1.0)
    }

    /// Visits each child; those of a `<loop>` once per iteration.
    pub fn each(&mut self, parent: &Element, visit: &mut dyn FnMut(&mut Self, &Element)) {
        for child in &parent.children {
            match child.name.as_str() {
                "loop" => {
                    // problems are reported inside
                    let _ = self.repeat(child, visit);
                }
                _ => visit(self, child),
            }
        }
    }

    fn repeat(
        &mut self,
        element: &Element,
        visit: &mut dyn FnMut(&mut Self, &Element),
    ) -> Result<(), Failure> {
        let (variable, place) = {
            let attribute = self.need(element, "for")?;
            (attribute.value.clone(), attribute.place)
        };
        let from = match element.attribute("from") {
            Some(attribute) => self.value(attribute)?,
            None => self.names.value(&variable).unwrap_or(0.0),
        };
        let to = self.number(element, "to")?;
        let step = self.number_or(element, "step", 1.0)?;
        if step <= 0.0 && from <= to {
            return Err(self.error(Problem::new(
                "the step of the loop is not greater than 0: the loop would not end.",
                element.place,
            )));
        }
        let mut value = from;
        while value <= to {
            self.steps += 1 + element.children.len();
            if self.steps > MAX_STEPS {
                return Err(self.error(Problem::new(
                    format!("the loops generate more than {MAX_STEPS} elements"),
                    place,
                )));
            }
            self.names.set(&variable, value);
            self.each(element, visit);
            value += step;
        }
        Ok(())
    }
}

fn scaled<const N: usize>(values: [Result<f64, Failure>; N], unit: f64) -> Result<[f64; N], Failure> {
    let mut all = [0.0; N];
    for (slot, value) in all.iter_mut().zip(values) {
        *slot = value? * unit;
    }
    Ok(all)
}

/// An angle in degrees. Angles that were short decimals in degrees before a conversion to radians are restored, so that
/// right angles are exact.
pub(super) fn degrees(value: f64, unit: f64) -> f64 {
    let is_degrees = units::value("deg") == Some(unit);
    let degrees = if is_degrees { value } else { value * unit * (180.0 / PI) };
    let short = (degrees * 1e10).round() / 1e10;
    if (degrees - short).abs() <= 8.0 * f64::EPSILON * degrees.abs() { short } else { degrees }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_that_were_decimals_are_again() {
        for tenths in -3600..3600 {
            let decimal = f64::from(tenths) / 10.0;
            assert_eq!(degrees(decimal * (PI / 180.0), 1.0), decimal);
            assert_eq!(degrees(decimal, PI / 180.0), decimal);
        }
        assert_eq!(degrees(1.25, 1.0), 1.25 * (180.0 / PI));
    }
}
