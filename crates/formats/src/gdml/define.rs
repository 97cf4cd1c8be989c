//! `<define>`: named numbers, vectors and matrices.

use super::attributes::{Failure, Numbers, degrees};
use super::expression::Matrix;
use super::problem::Problem;
use super::units;
use super::units::Quantity;
use super::xml::Element;
use rayweave_math::{Affine, Vec3};
use std::f64::consts::PI;

/// Maximum number of entries of a matrix.
const MAX_VALUES: usize = 10_000_000;

/// The role of a vector: position, rotation or scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Position,
    Rotation,
    Scale,
}

impl Role {
    fn word(self) -> &'static str {
        match self {
            Role::Position => "position",
            Role::Rotation => "rotation",
            Role::Scale => "scale",
        }
    }
}

impl Numbers<'_> {
    /// Reads a `<define>`; problems are reported inside.
    pub fn define(&mut self, element: &Element) {
        self.each(element, &mut |numbers, child| {
            if numbers.definition(child).is_err()
                && let Some(name) = child.attribute("name")
            {
                numbers.names.set_failed(&name.value);
            }
        });
    }

    fn definition(&mut self, element: &Element) -> Result<(), Failure> {
        match element.name.as_str() {
            "constant" | "variable" => {
                let value = self.defined_number(element);
                let name = self.name(element)?;
                self.set(element, &name, value?);
            }
            "quantity" => {
                let unit = self.unit(element, "unit", Quantity::Other, 1.0);
                let value = self.defined_number(element);
                let name = self.name(element)?;
                self.set(element, &name, value? * unit?);
            }
            "expression" => self.expression(element)?,
            "matrix" => self.matrix(element)?,
            "position" | "rotation" | "scale" => self.vector_definition(element)?,
            other => {
                let problem = Problem::new(format!("`{other}` is not a definition"), element.place);
                let known = [
                    "constant",
                    "variable",
                    "quantity",
                    "expression",
                    "matrix",
                    "position",
                    "rotation",
                    "scale",
                    "loop",
                ];
                self.error(problem.did_you_mean(other, known));
            }
        }
        Ok(())
    }

    fn set(&mut self, element: &Element, name: &str, value: f64) {
        let kind = &element.name;
        if self.names.is_set(name) {
            self.warn_of_redefinition(element, name);
        } else if let Some(unit) = units::value(name) {
            let message = format!(
                "the {kind} `{name}` has the name of a unit or constant: expressions such as `2*{name}` use its value {value} instead \
                 of {unit}, and Geant4 rejects the redefinition. Rename it."
            );
            self.context.warn(Problem::new(message, element.place));
        }
        self.names.set(name, value);
    }

    /// Warns about a name that the file defines already, where Geant4 stops with "Redefinition of constant or variable".
    fn warn_of_redefinition(&mut self, element: &Element, name: &str) {
        let message = format!(
            "the {} `{name}` is defined again: the later value is used, and Geant4 rejects the redefinition. Rename one of them.",
            element.name
        );
        self.context.warn(Problem::new(message, element.place));
    }

    /// `<expression name="x">text</expression>`.
    fn expression(&mut self, element: &Element) -> Result<(), Failure> {
        let value = self.defined_number(element)?;
        let name = self.name(element)?;
        self.set(element, &name, value);
        Ok(())
    }

    /// The number of a definition: the caller's, that of the text of an `<expression>`, or the attribute `value`.
    fn defined_number(&mut self, element: &Element) -> Result<f64, Failure> {
        let Numbers { context, names, .. } = self;
        match context.overrides.value(element.text("name"), names) {
            Some(Ok(value)) => return Ok(value),
            Some(Err(error)) => {
                context.error_in_override(error);
                return Err(Failure::Reported);
            }
            None => {}
        }
        match element.content.as_deref().filter(|_| element.name == "expression") {
            Some(content) => self.value(content),
            None => self.number(element, "value"),
        }
    }

    fn matrix(&mut self, element: &Element) -> Result<(), Failure> {
        let name = self.name(element)?;
        let columns = self.whole(element, "coldim", 1, MAX_VALUES as i64)? as usize;
        // some files with a single value use `value`
        let attribute = match (element.attribute("values"), element.attribute("value")) {
            (None, Some(value)) => value,
            _ => self.need(element, "values")?,
        };
        let mut values = Vec::new();
        for (text, at) in words(&attribute.value) {
            let part = attribute.part(text, at);
            values.push(self.value(&part)?);
        }
        if values.is_empty() || values.len() % columns != 0 {
            let message =
                format!("the matrix `{name}` has {} values: they must fill rows of {columns}.", values.len());
            return Err(self.error(Problem::new(message, attribute.place)));
        }
        if self.names.matrix(&name).is_some() {
            self.warn_of_redefinition(element, &name);
        }
        self.names.set_matrix(&name, Matrix { columns, values });
        Ok(())
    }

    fn vector_definition(&mut self, element: &Element) -> Result<(), Failure> {
        let (role, default) = role(&element.name);
        let value = self.vector(element, role, default);
        let name = self.name(element)?;
        let value = value?;
        self.map_of(role).insert(name, value);
        Ok(())
    }

    fn map_of(&mut self, role: Role) -> &mut std::collections::BTreeMap<String, Vec3> {
        match role {
            Role::Position => &mut self.positions,
            Role::Rotation => &mut self.rotations,
            Role::Scale => &mut self.scales,
        }
    }

    /// An inline vector: millimetres, degrees or factors.
    pub fn vector(&mut self, element: &Element, role: Role, default: Vec3) -> Result<Vec3, Failure> {
        let unit = match role {
            Role::Position => self.unit(element, "unit", Quantity::Length, 1.0),
            Role::Rotation => self.unit(element, "unit", Quantity::Angle, 1.0),
            Role::Scale => Ok(1.0),
        };
        let values =
            ["x", "y", "z"].map(|axis| element.attribute(axis).map(|attribute| self.value(attribute)));
        let (unit, mut vector) = (unit?, default);
        for (axis, value) in values.into_iter().enumerate().filter_map(|(axis, value)| Some((axis, value?))) {
            vector[axis] = match role {
                Role::Rotation => degrees(value?, unit),
                _ => value? * unit,
            };
        }
        self.warn_of_degrees(element, role, unit);
        Ok(vector)
    }

    /// Warns about a rotation of more than two turns in radians, which is probably in degrees.
    fn warn_of_degrees(&mut self, element: &Element, role: Role, unit: f64) {
        let large = ["x", "y", "z"].iter().filter_map(|axis| element.attribute(axis));
        let large = large.filter_map(|attribute| attribute.value.trim().parse::<f64>().ok());
        if role == Role::Rotation && unit == 1.0 && large.fold(0.0, |a: f64, b| a.max(b.abs())) > 4.0 * PI {
            let aunit =
                if element.attribute("aunit").is_some() { " `aunit` has no effect here." } else { "" };
            let message = format!(
                "the rotation is more than two turns (in radians). Is `unit=\"deg\"` missing?{aunit}"
            );
            self.context.warn(Problem::new(message, element.place));
        }
    }

    /// A vector by name, from `<positionref ref="name"/>` etc.
    pub fn vector_reference(&mut self, element: &Element, role: Role) -> Result<Vec3, Failure> {
        let (name, place) = self.reference(element, "ref")?;
        match self.map_of(role).get(&name) {
            Some(vector) => Ok(*vector),
            None => {
                let word = role.word();
                let problem = Problem::new(
                    format!("unknown {word} `{name}`: no <{word} name=\"{name}\"> before it."),
                    place,
                );
                let known: Vec<String> = self.map_of(role).keys().cloned().collect();
                Err(self.error(problem.did_you_mean(&name, known.iter().map(String::as_str))))
            }
        }
    }

    /// The optional vector of a child element, inline (`position`) or by name (`positionref`).
    pub fn child_vector(
        &mut self,
        element: &Element,
        name: &str,
        role: Role,
    ) -> Result<Option<Vec3>, Failure> {
        let default = role_default(role);
        let mut found = None;
        for child in &element.children {
            if child.name == name {
                found = Some(self.vector(child, role, default)?);
            } else if child.name.strip_suffix("ref") == Some(name) {
                found = Some(self.vector_reference(child, role)?);
            }
        }
        Ok(found)
    }

    /// Position and rotation among the children. `prefix` is empty, or `first` in boolean solids.
    pub fn placement(&mut self, element: &Element, prefix: &str) -> Result<(Vec3, Vec3), Failure> {
        let position = self.child_vector(element, &format!("{prefix}position"), Role::Position);
        let rotation = self.child_vector(element, &format!("{prefix}rotation"), Role::Rotation);
        Ok((position?.unwrap_or(Vec3::ZERO), rotation?.unwrap_or(Vec3::ZERO)))
    }
}

fn role(name: &str) -> (Role, Vec3) {
    let role = match name {
        "position" => Role::Position,
        "rotation" => Role::Rotation,
        _ => Role::Scale,
    };
    (role, role_default(role))
}

fn role_default(role: Role) -> Vec3 {
    if role == Role::Scale { Vec3::ONE } else { Vec3::ZERO }
}

/// The words of a text, with their byte offsets.
pub(super) fn words(text: &str) -> impl Iterator<Item = (&str, usize)> {
    text.split_whitespace()
        .map(move |word| (word, (word.as_ptr() as usize).wrapping_sub(text.as_ptr() as usize)))
}

/// The rotation of a GDML file: about x, then y, then z, by angles in degrees.
pub(super) fn rotation(angles: Vec3) -> Affine {
    Affine::rotation(Vec3::X, angles.x)
        .then(&Affine::rotation(Vec3::Y, angles.y))
        .then(&Affine::rotation(Vec3::Z, angles.z))
}

/// The inverse of [`rotation`].
pub(super) fn inverse_rotation(angles: Vec3) -> Affine {
    Affine::rotation(Vec3::Z, -angles.z)
        .then(&Affine::rotation(Vec3::Y, -angles.y))
        .then(&Affine::rotation(Vec3::X, -angles.x))
}

/// Photon energy of the sodium D line, at which refractive indices are evaluated.
pub(super) fn sodium_energy() -> f64 {
    // h c = 1.239841984 eV um (CODATA 2018) at 0.5893 um
    1.239_841_984 / 0.589_3 * units::value("eV").unwrap_or(1e-6)
}
