//! Materials, elements and properties: from the table `[gdml]`, else hydrogen as a placeholder.

use super::names::Names;
use crate::gdml::UNSPECIFIED;
use crate::gdml::stated::{list, number, rows, text};
use crate::write::RemarkKind;
use crate::write::model::Model;
use crate::write::remark::Remarks;
use rayweave_scene::{Datum, Medium, Table, lookup};
use std::collections::HashMap;
use std::fmt::Write as _;

/// Density in g/cm3 of media without one: intergalactic space, as in `G4_Galactic`.
const NO_DENSITY: f64 = 1e-25;

/// Numbers of media, with the elements and units of materials in GDML.
const NUMBERS: [(&str, &str, &str); 3] =
    [("temperature", "T", "K"), ("pressure", "P", "pascal"), ("mean_excitation_energy", "MEE", "eV")];

/// Text of the materials of a file.
pub(super) struct Materials {
    pub defines: String,
    pub text: String,
    /// Name of the material of each medium.
    pub names: Vec<String>,
}

/// Definitions of matrices and materials. The added world has the first medium; volumes of a hierarchy may have no medium.
pub(super) fn materials(
    model: &Model,
    names: &Names,
    table: Option<&Table>,
    needs: Needs,
    remarks: &mut Remarks,
) -> Materials {
    let mut all = Materials { defines: String::new(), text: String::new(), names: names.media.clone() };
    let media = &model.scene.media;
    let mut stated = vec![false; media.len()];
    if let Some(table) = table {
        rows(table, "matrix").iter().for_each(|row| all.matrix(row));
        rows(table, "element").iter().for_each(|row| all.element(row));
        let numbers: HashMap<&str, usize> =
            media.iter().zip(0..).map(|(medium, k)| (medium.name.as_str(), k)).collect();
        for row in rows(table, "material") {
            let Some(&k) = numbers.get(text(row, "medium")) else { continue };
            all.names[k] = escaped(text(row, "name"));
            stated[k] = true;
            all.stated(row, &media[k]);
        }
    }
    let mut is_used = vec![false; media.len()];
    model.scene.regions.iter().for_each(|region| is_used[region.medium as usize] = true);
    is_used[0] |= needs.room;
    media
        .iter()
        .zip(&mut is_used)
        .for_each(|(medium, used)| *used &= needs.all || medium.name != UNSPECIFIED);
    for k in (0..media.len()).filter(|k| is_used[*k] && !stated[*k]) {
        all.hydrogen(&media[k], k, remarks);
    }
    all
}

/// Media that need a material.
pub(super) struct Needs {
    /// The first medium, for an added world.
    pub room: bool,
    /// Also the media of volumes without material.
    pub all: bool,
}

impl Materials {
    fn matrix(&mut self, row: &Table) {
        let value = |value: &rayweave_scene::Spanned<Datum>| match value.value {
            Datum::Number(number) => format!("{number:?}"),
            _ => String::new(),
        };
        let values: Vec<String> = list(row, "values").iter().map(value).collect();
        let (name, columns) = (escaped(text(row, "name")), number(row, "columns").unwrap_or(1.0));
        let _ = writeln!(
            self.defines,
            "    <matrix name=\"{name}\" coldim=\"{columns}\" values=\"{}\"/>",
            values.join(" ")
        );
    }

    /// Writes an element or an isotope.
    fn element(&mut self, row: &Table) {
        let tag = if text(row, "kind") == "isotope" { "isotope" } else { "element" };
        let number =
            |key: &str| number(row, key).map(|number| format!(" {key}=\"{number}\"")).unwrap_or_default();
        let _ = write!(
            self.text,
            "    <{tag} name=\"{}\"{}",
            escaped(text(row, "name")),
            attribute(row, "formula")
        );
        let _ = writeln!(
            self.text,
            "{}{}>\n{}{}    </{tag}>",
            number("Z"),
            number("N"),
            atom(self::number(row, "A")),
            parts(row)
        );
    }

    /// Writes a material from the table. Predefined materials of Geant4 need no definition.
    fn stated(&mut self, row: &Table, medium: &Medium) {
        let (name, parts) = (text(row, "name"), parts(row));
        let is_built_in = name.starts_with("G4_") && medium.numbers.is_empty() && parts.is_empty();
        if is_built_in {
            return;
        }
        let mut properties = String::new();
        for (property, value) in properties_of(row) {
            properties += &property_of(&mut self.defines, &escaped(name), property, value);
        }
        let composition = match (parts.is_empty(), medium.number("A")) {
            (true, Some(molar)) => atom(Some(molar)),
            (true, None) => atom(Some(1.008)),
            (false, _) => parts.clone(),
        };
        let z = medium.number("Z").or(parts.is_empty().then_some(1.0));
        let z = z.map(|z| format!(" Z=\"{z}\"")).unwrap_or_default();
        let _ = writeln!(
            self.text,
            "    <material name=\"{}\"{}{}{z}>\n{properties}{}{composition}    </material>",
            escaped(name),
            attribute(row, "formula"),
            attribute(row, "state"),
            numbers_of(medium)
        );
    }

    /// Writes a medium of unknown composition, as hydrogen.
    fn hydrogen(&mut self, medium: &Medium, k: usize, remarks: &mut Remarks) {
        let name = &self.names[k];
        let mut property = String::new();
        if let Some(index) = medium.index {
            let _ = writeln!(
                self.defines,
                "    <matrix name=\"{name}_index\" coldim=\"2\" values=\"1*eV {index:?} 10*eV {index:?}\"/>"
            );
            property = format!("      <property name=\"RINDEX\" ref=\"{name}_index\"/>\n");
        }
        let _ = writeln!(
            self.text,
            "    <material name=\"{name}\" Z=\"1\">\n{property}{}{}    </material>",
            numbers_of(medium),
            atom(Some(1.008))
        );
        let is_known = |name: &String| name == "density" || NUMBERS.iter().any(|(known, ..)| known == name);
        if medium.numbers.iter().any(|(name, _)| !is_known(name)) {
            remarks.add(
                RemarkKind::Dropped,
                "properties of media other than density, temperature, pressure, excitation energy and index",
            );
        }
        // no remark for the surroundings of the model
        if k > 0 {
            let what = format!(
                "materials: hydrogen with the density of the medium, or {NO_DENSITY:?} g/cm3 if it has none"
            );
            remarks.add(RemarkKind::Changed, what);
        }
    }
}

/// Temperature, pressure, mean excitation energy and density.
fn numbers_of(medium: &Medium) -> String {
    let line =
        |tag: &str, number: f64, unit: &str| format!("      <{tag} value=\"{number:?}\" unit=\"{unit}\"/>\n");
    let other =
        |(name, tag, unit): (&str, &str, &str)| medium.number(name).map(|number| line(tag, number, unit));
    let others: String = NUMBERS.into_iter().filter_map(other).collect();
    others + &line("D", medium.number("density").unwrap_or(NO_DENSITY), "g/cm3")
}

fn atom(molar: Option<f64>) -> String {
    molar.map(|molar| format!("      <atom value=\"{molar:?}\"/>\n")).unwrap_or_default()
}

/// Composition of a material or an element.
fn parts(row: &Table) -> String {
    let part = |part: &&Table| {
        let of = escaped(text(part, "of"));
        match (number(part, "atoms"), number(part, "fraction")) {
            (Some(atoms), _) => format!("      <composite n=\"{atoms}\" ref=\"{of}\"/>\n"),
            (None, fraction) => {
                format!("      <fraction n=\"{:?}\" ref=\"{of}\"/>\n", fraction.unwrap_or(0.0))
            }
        }
    };
    rows(row, "parts").iter().map(part).collect()
}

/// A property; a single number becomes a separate matrix.
fn property_of(defines: &mut String, owner: &str, name: &str, value: &Datum) -> String {
    let reference = match value {
        Datum::Text(matrix) => escaped(matrix),
        Datum::Number(number) => {
            let matrix = format!("{owner}_{}", escaped(name));
            let _ = writeln!(defines, "    <matrix name=\"{matrix}\" coldim=\"1\" values=\"{number:?}\"/>");
            matrix
        }
        _ => return String::new(),
    };
    format!("      <property name=\"{}\" ref=\"{reference}\"/>\n", escaped(name))
}

fn properties_of(row: &Table) -> impl Iterator<Item = (&str, &Datum)> {
    let table = match lookup(row, "properties") {
        Some(Datum::Table(table)) => table.as_slice(),
        _ => &[],
    };
    table.iter().map(|(name, value)| (name.value.as_str(), &value.value))
}

/// An attribute, if the table has one.
fn attribute(row: &Table, key: &str) -> String {
    match text(row, key) {
        "" => String::new(),
        value => format!(" {key}=\"{}\"", escaped(value)),
    }
}

/// A text with XML escapes for attributes.
pub(super) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            _ => out.push(c),
        }
    }
    out
}

/// Text of further definitions, of optical surfaces (after the solids), and of user data (after the structure).
#[derive(Default)]
pub(super) struct After {
    pub defines: String,
    pub surfaces: String,
    pub user: String,
}

/// Optical surfaces and auxiliary tags.
pub(super) fn after(table: &Table) -> After {
    let mut after = After::default();
    for row in rows(table, "surface") {
        let words = ["model", "finish", "type"].map(|word| attribute(row, word)).concat();
        let value = number(row, "value").map(|value| format!(" value=\"{value:?}\"")).unwrap_or_default();
        let name = escaped(text(row, "name"));
        let mut properties = String::new();
        for (property, value) in properties_of(row) {
            properties += &property_of(&mut after.defines, &name, property, value);
        }
        let _ = writeln!(
            after.surfaces,
            "    <opticalsurface name=\"{name}\"{words}{value}>\n{properties}    </opticalsurface>"
        );
    }
    let tags = auxiliaries(table, "    ");
    if !tags.is_empty() {
        after.user = format!("  <userinfo>\n{tags}  </userinfo>\n");
    }
    after
}

/// The auxiliary tags of a row.
pub(super) fn auxiliaries(row: &Table, indent: &str) -> String {
    let tag = |row: &&Table| {
        let [kind, value, unit] = ["type", "value", "unit"].map(|key| escaped(text(row, key)));
        let unit = if unit.is_empty() { unit } else { format!(" auxunit=\"{unit}\"") };
        let inner = auxiliaries(row, &format!("{indent}  "));
        let head = format!("{indent}<auxiliary auxtype=\"{kind}\" auxvalue=\"{value}\"{unit}");
        if inner.is_empty() {
            format!("{head}/>\n")
        } else {
            format!("{head}>\n{inner}{indent}</auxiliary>\n")
        }
    };
    rows(row, "auxiliary").iter().map(tag).collect()
}
