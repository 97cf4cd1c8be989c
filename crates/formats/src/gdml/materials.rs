//! `<materials>`: materials, elements and isotopes.

use super::attributes::{Failure, Numbers};
use super::define;
use super::problem::Place;
use super::problem::Problem;
use super::units::{GRAM_PER_CM3, PA, Quantity};
use super::xml::Element;
use crate::LossKind;
use rayweave_scene::{Medium, bare_name};
use std::collections::BTreeMap;

/// All materials of a model.
#[derive(Debug, Default)]
pub(super) struct Materials {
    pub list: Vec<Material>,
    by_name: BTreeMap<String, usize>,
    /// Elements and isotopes, for the table `[gdml]`.
    pub elements: Vec<Material>,
}

/// A material, an element or an isotope.
#[derive(Clone, Debug, Default)]
pub(super) struct Material {
    pub name: String,
    /// `material`, `element` or `isotope`.
    pub tag: String,
    pub state: String,
    pub formula: String,
    /// Numbers by name: density in g/cm3, temperature in K, pressure in Pa, Z, A in g/mol.
    pub numbers: Vec<(String, f64)>,
    /// Composition: components with mass fractions or numbers of atoms.
    pub parts: Vec<Part>,
    /// Properties by name, most of which depend on the photon energy.
    pub properties: Vec<(String, Property)>,
    /// Positions of the properties, by name; the empty name has the position of the element.
    pub places: Vec<(String, Place)>,
    /// Refractive index, from the property `RINDEX`.
    pub index: Option<f64>,
}

/// The value of a property.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Property {
    /// Name of a matrix.
    Matrix(String),
    /// An inline number.
    Number(f64),
}

/// A component of a material.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub name: String,
    pub amount: f64,
    /// True for a number of atoms, false for a mass fraction.
    pub is_count: bool,
}

/// Wavelength of the refractive indices of media, in nanometres: the sodium D line.
const SODIUM_NM: f64 = 589.3;
/// Relative rounding error of photon energies, which usually have four digits.
const ROUNDED: f64 = 5e-5;

/// Prefix of the predefined (NIST) materials of Geant4.
const BUILT_IN: &str = "G4_";

impl Materials {
    /// Index of a material; predefined materials of Geant4, and undefined ones, are added.
    pub fn find(&mut self, numbers: &mut Numbers, name: &str, place: Place) -> Option<usize> {
        if let Some(known) = self.by_name.get(name) {
            return Some(*known);
        }
        if name.starts_with(BUILT_IN) {
            return Some(self.add(Material {
                name: name.to_owned(),
                tag: "material".to_owned(),
                ..Material::default()
            }));
        }
        let problem = Problem::new(
            format!("unknown material `{name}`: no material defined before has this name."),
            place,
        );
        let problem = problem.did_you_mean(name, self.by_name.keys().map(String::as_str));
        numbers.context.lose(LossKind::Undefined, "materialref", problem);
        Some(self.add(Material { name: name.to_owned(), tag: "material".to_owned(), ..Material::default() }))
    }

    fn add(&mut self, material: Material) -> usize {
        let index = self.list.len();
        self.by_name.entry(material.name.clone()).or_insert(index);
        self.list.push(material);
        index
    }
}

/// Reads a `<materials>` section.
pub(super) fn read(numbers: &mut Numbers, materials: &mut Materials, section: &Element) {
    numbers.each(section, &mut |numbers, element| match element.name.as_str() {
        "material" | "element" | "isotope" => {
            if let Ok(material) = material(numbers, element) {
                if element.name == "material" {
                    materials.add(material);
                } else {
                    materials.elements.push(material);
                }
            }
        }
        "define" => numbers.define(element),
        other => {
            let message = format!("`{other}` is not an element of `materials`.");
            let known = ["material", "element", "isotope", "define", "loop"];
            let problem = Problem::new(message, element.place).did_you_mean(other, known);
            numbers.context.lose(LossKind::Dropped, other, problem);
        }
    });
}

fn material(numbers: &mut Numbers, element: &Element) -> Result<Material, Failure> {
    let mut material = Material {
        name: numbers.name(element)?,
        tag: element.name.to_string(),
        state: element.text("state").to_owned(),
        formula: element.text("formula").to_owned(),
        places: vec![(String::new(), element.place)],
        ..Material::default()
    };
    for (attribute, name) in [("Z", "Z"), ("N", "N")] {
        if let Some(value) = element.attribute(attribute) {
            material.numbers.push((name.to_owned(), numbers.value(value)?));
        }
    }
    for child in &element.children {
        detail(numbers, &mut material, child)?;
    }
    Ok(material)
}

/// Quantities: name, default unit, and our unit in units of GDML.
const QUANTITIES: [(&str, &str, &str, f64); 5] = [
    ("D", "density", "g/cm3", GRAM_PER_CM3),
    ("T", "temperature", "K", 1.0),
    ("P", "pressure", "pascal", PA),
    ("MEE", "mean_excitation_energy", "eV", 1e-6),
    ("atom", "A", "", 1.0),
];

fn detail(numbers: &mut Numbers, material: &mut Material, child: &Element) -> Result<(), Failure> {
    let tag = child.name.as_str();
    if let Some((_, name, unit, one)) = QUANTITIES.iter().find(|row| row.0 == tag) {
        let value = numbers.number(child, "value")?;
        let unit = match (tag, unit.is_empty()) {
            // the unit of molar masses is always g/mole
            ("atom", _) | (_, true) => *one,
            _ if child.attribute("unit").is_some() => numbers.unit(child, "unit", Quantity::Other, *one)?,
            _ => numbers.names.evaluate(unit).unwrap_or(*one),
        };
        material.numbers.push(((*name).to_owned(), value * unit / one));
        return Ok(());
    }
    if let Some((_, name, _, one)) = QUANTITIES.iter().find(|row| tag.strip_suffix("ref") == Some(row.0)) {
        // defined quantities include their unit
        let (quantity, place) = numbers.reference(child, "ref")?;
        let Some(value) = numbers.names.value(&quantity) else {
            let problem = Problem::new(format!("unknown quantity `{quantity}`: it is not defined."), place);
            return Err(numbers.error(problem.did_you_mean(&quantity, numbers.names.all())));
        };
        material.numbers.push(((*name).to_owned(), value / one));
        return Ok(());
    }
    match tag {
        "fraction" | "composite" => {
            let (name, _) = numbers.reference(child, "ref")?;
            let amount = numbers.number(child, "n")?;
            material.parts.push(Part { name, amount, is_count: tag == "composite" });
        }
        "property" => {
            let (name, property) = property(numbers, child)?;
            if name == "RINDEX" {
                material.index = index(numbers, &property).unwrap_or_else(|reason| {
                    let message =
                        format!("the material `{}` has no refractive index: {reason}.", material.name);
                    numbers.context.warn(Problem::new(message, child.place));
                    None
                });
            }
            material.places.push((name.clone(), child.place));
            material.properties.push((name, property));
        }
        _ => {}
    }
    Ok(())
}

/// The properties of Geant4 11.4 that depend on the energy; the others are constants.
const BY_ENERGY: [&str; 20] = [
    "RINDEX",
    "GROUPVEL",
    "ABSLENGTH",
    "RAYLEIGH",
    "MIEHG",
    "WLSABSLENGTH",
    "WLSABSLENGTH2",
    "WLSCOMPONENT",
    "WLSCOMPONENT2",
    "SCINTILLATIONCOMPONENT1",
    "SCINTILLATIONCOMPONENT2",
    "SCINTILLATIONCOMPONENT3",
    "REFLECTIVITY",
    "TRANSMITTANCE",
    "EFFICIENCY",
    "REALRINDEX",
    "IMAGINARYRINDEX",
    "SPECULARLOBECONSTANT",
    "SPECULARSPIKECONSTANT",
    "BACKSCATTERCONSTANT",
];

/// The warning about a property with a `value` in place of a `ref`. Geant4 reads `ref` alone, and looks up the matrix of an empty
/// name, which has no rows: the property is dropped without a message. A process that needs it then ends the run (mat202).
fn without_reference(name: &str, value: &str) -> String {
    // in a matrix, space separates values
    let value: String = value.split_whitespace().collect();
    let matrix = match BY_ENERGY.contains(&name) {
        true => format!("coldim=\"2\" values=\"1*eV {value} 10*eV {value}\""),
        false => format!("coldim=\"1\" values=\"{value}\""),
    };
    format!(
        "the property `{name}` has a `value` and no `ref`: Rayweave uses the value, but Geant4 drops the property, and stops where a \
         process needs it. Define `<matrix name=\"{name}_M\" {matrix}/>` and refer to it: `ref=\"{name}_M\"`."
    )
}

/// `<property name=".." ref="matrix"/>`; some files use `value` in place of `ref`, with a warning.
pub(super) fn property(numbers: &mut Numbers, child: &Element) -> Result<(String, Property), Failure> {
    let name = numbers.name(child)?;
    if let (None, Some(value)) = (child.attribute("ref"), child.attribute("value")) {
        let number = numbers.value(value)?;
        numbers.context.warn(Problem::new(without_reference(&name, child.text("value")), child.place));
        return Ok((name, Property::Number(number)));
    }
    let (matrix, place) = numbers.reference(child, "ref")?;
    let is_known = numbers.names.matrix(&matrix).is_some() || numbers.names.is_set(&matrix);
    // an invalid definition has been reported
    if !is_known && !numbers.names.has_failed(&matrix) {
        let known: Vec<String> = numbers.names.matrices().map(|(name, _)| name.clone()).collect();
        let problem =
            Problem::new(format!("unknown matrix `{matrix}`: the property `{name}` has no value."), place);
        let problem = problem.did_you_mean(&matrix, known.iter().map(String::as_str));
        numbers.context.lose(LossKind::Undefined, "property", problem);
    }
    Ok((name, Property::Matrix(matrix)))
}

/// Refractive index of a property; `None` if its matrix is unknown, which is reported elsewhere.
///
/// # Errors
///
/// The reason why there is no index.
fn index(numbers: &Numbers, property: &Property) -> Result<Option<f64>, String> {
    let index = match property {
        Property::Number(value) => *value,
        Property::Matrix(name) => match numbers.names.matrix(name) {
            Some(matrix) => index_of(&matrix.values, matrix.columns)?,
            None => return Ok(None),
        },
    };
    match index.is_finite() && index > 0.0 {
        true => Ok(Some(index)),
        false => Err(format!("its value at {SODIUM_NM} nm is {index}")),
    }
}

/// Refractive index at the sodium D line, by linear interpolation over the energy. Without data on both sides of it there is
/// none, because values at other wavelengths say little about it.
fn index_of(values: &[f64], columns: usize) -> Result<f64, String> {
    if columns != 2 {
        return Err(format!("its `RINDEX` has {columns} columns, not 2 (photon energy and index)"));
    }
    let mut rows: Vec<(f64, f64)> = values.chunks_exact(2).map(|row| (row[0], row[1])).collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let energy = define::sodium_energy();
    // a range that ends at 589.3 nm may have rounded limits
    let (least, most) = (rows[0].0, rows[rows.len() - 1].0);
    if !(least * (1.0 - ROUNDED) <= energy && energy <= most * (1.0 + ROUNDED)) {
        let nm = |energy: f64| define::sodium_energy() * SODIUM_NM / energy;
        return Err(format!(
            "its `RINDEX` covers {:.4} to {:.4} nm, which does not include {SODIUM_NM} nm",
            nm(most),
            nm(least)
        ));
    }
    let after = rows.partition_point(|row| row.0 < energy);
    Ok(match (after.checked_sub(1).and_then(|before| rows.get(before)), rows.get(after)) {
        (Some(&(e0, n0)), Some(&(e1, n1))) => n0 + (n1 - n0) * (energy - e0) / (e1 - e0),
        (Some(&(_, n)), None) | (None, Some(&(_, n))) => n,
        (None, None) => f64::NAN,
    })
}

impl Material {
    /// The medium of the scene for this material, under the given unused name.
    pub fn medium(&self, name: String) -> Medium {
        Medium { name, index: self.index, colour: None, numbers: self.numbers.clone() }
    }

    /// The name without a pointer suffix.
    pub fn bare_name(&self) -> &str {
        bare_name(&self.name)
    }
}
