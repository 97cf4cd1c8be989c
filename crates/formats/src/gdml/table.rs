//! The table `[gdml]` of a document: the non-geometric data of a GDML file.
//!
//! Keys: `world`, `volume` (a list: `name`, `region`, `material`, `daughters`, `auxiliary`), `solid`, `material`,
//! `element`, `matrix`, `surface`, `skin`, `border`, `auxiliary`. Energies are in MeV and lengths in millimetres, as in Geant4.

use super::graph::{Auxiliary, Daughter, Graph};
use super::materials::{Material, Property};
use super::optical::{Link, Optical};
use rayweave_math::Affine;
use rayweave_scene::{Datum, Spanned, Table};
use std::collections::HashMap;

/// The table of a model.
pub(super) fn table(
    graph: &Graph,
    world: usize,
    order: &[usize],
    regions: &HashMap<usize, String>,
    media: &[String],
) -> Table {
    let mut table = Rows::default();
    table.text("world", &graph.volumes[world].name);
    table.list("volume", order.iter().map(|volume| volume_row(graph, *volume, regions, media)));
    table.list("solid", graph.origins.iter().cloned().map(Datum::Table));
    let materials = graph.materials.list.iter().zip(media);
    table.list("material", materials.map(|(material, medium)| material_row(material, Some(medium))));
    table.list("element", graph.materials.elements.iter().map(|element| material_row(element, None)));
    table.list(
        "matrix",
        graph.surfaces.matrices.iter().map(|(name, matrix)| {
            let mut row = Rows::default();
            row.text("name", name);
            row.number("columns", matrix.columns as f64);
            row.put("values", numbers(&matrix.values));
            row.datum()
        }),
    );
    table.list("surface", graph.surfaces.optical.iter().map(optical_row));
    table.list("skin", graph.surfaces.links.iter().filter(|link| link.is_skin).map(link_row));
    table.list("border", graph.surfaces.links.iter().filter(|link| !link.is_skin).map(link_row));
    table.list("auxiliary", graph.auxiliary.iter().map(auxiliary_row));
    table.0
}

/// Builder of a table; empty values are omitted.
#[derive(Default)]
struct Rows(Table);

impl Rows {
    fn put(&mut self, key: &str, value: Datum) {
        self.0.push((key.into(), unplaced(value)));
    }

    fn text(&mut self, key: &str, value: &str) {
        if !value.is_empty() {
            self.put(key, Datum::Text(value.to_owned()));
        }
    }

    fn number(&mut self, key: &str, value: f64) {
        self.put(key, Datum::Number(value));
    }

    fn list(&mut self, key: &str, items: impl Iterator<Item = Datum>) {
        let items: Vec<Spanned<Datum>> = items.map(unplaced).collect();
        if !items.is_empty() {
            self.put(key, Datum::List(items));
        }
    }

    fn datum(self) -> Datum {
        Datum::Table(self.0)
    }
}

fn numbers(values: &[f64]) -> Datum {
    Datum::List(values.iter().map(|value| unplaced(Datum::Number(*value))).collect())
}

fn volume_row(graph: &Graph, volume: usize, regions: &HashMap<usize, String>, media: &[String]) -> Datum {
    let volume_of = &graph.volumes[volume];
    let mut row = Rows::default();
    row.text("name", &volume_of.name);
    row.text("region", regions.get(&volume).map_or("", String::as_str));
    row.text(
        "material",
        volume_of.material.and_then(|material| media.get(material)).map_or("", String::as_str),
    );
    row.list("daughters", graph.daughters(volume).iter().map(|daughter| daughter_row(graph, daughter)));
    row.list("auxiliary", volume_of.auxiliary.iter().map(auxiliary_row));
    row.datum()
}

fn daughter_row(graph: &Graph, daughter: &Daughter) -> Datum {
    let mut row = Rows::default();
    row.text("name", &daughter.name);
    row.text("volume", &graph.volumes[daughter.volume].name);
    if let Some(copy) = daughter.copy {
        row.number("copy", copy as f64);
    }
    row.list("maps", daughter.maps.iter().map(map));
    row.datum()
}

/// A translation as a vector, any other map as the first three rows of its matrix.
fn map(map: &Affine) -> Datum {
    match *map == Affine::translate(map.translation) {
        true => numbers(&map.translation.to_array()),
        false => numbers(map.to_rows()[..3].as_flattened()),
    }
}

fn material_row(material: &Material, medium: Option<&String>) -> Datum {
    let mut row = Rows::default();
    row.text("name", &material.name);
    row.text("medium", medium.map_or("", String::as_str));
    row.text("kind", if medium.is_some() { "" } else { &material.tag });
    row.text("state", &material.state);
    row.text("formula", &material.formula);
    if medium.is_none() {
        material.numbers.iter().for_each(|(name, value)| row.number(name, *value));
    }
    row.list(
        "parts",
        material.parts.iter().map(|part| {
            let mut row = Rows::default();
            row.text("of", &part.name);
            row.number(if part.is_count { "atoms" } else { "fraction" }, part.amount);
            row.datum()
        }),
    );
    row.put_properties(&material.properties);
    row.datum()
}

impl Rows {
    /// Properties by name, each with its value or the name of its matrix.
    fn put_properties(&mut self, properties: &[(String, Property)]) {
        if !properties.is_empty() {
            let datum = |property: &Property| match property {
                Property::Matrix(name) => Datum::Text(name.clone()),
                Property::Number(value) => Datum::Number(*value),
            };
            let entry =
                |(name, property): &(String, Property)| (name.as_str().into(), unplaced(datum(property)));
            // if a property is repeated, the last one counts
            let last: HashMap<&str, usize> =
                properties.iter().zip(0..).map(|((name, _), k)| (name.as_str(), k)).collect();
            let kept = properties.iter().zip(0..).filter(|((name, _), k)| last.get(name.as_str()) == Some(k));
            let table: Table = kept.map(|(property, _)| entry(property)).collect();
            self.put("properties", Datum::Table(table));
        }
    }
}

fn optical_row(optical: &Optical) -> Datum {
    let mut row = Rows::default();
    row.text("name", &optical.name);
    optical.words.iter().for_each(|(word, value)| row.text(word, value));
    if let Some(value) = optical.value {
        row.number("value", value);
    }
    row.put_properties(&optical.properties);
    row.datum()
}

fn link_row(link: &Link) -> Datum {
    let mut row = Rows::default();
    row.text("name", &link.name);
    row.text("surface", &link.surface);
    row.list(
        if link.is_skin { "volume" } else { "placements" },
        link.of.iter().map(|(name, _)| Datum::Text(name.clone())),
    );
    row.datum()
}

fn auxiliary_row(tag: &Auxiliary) -> Datum {
    let mut row = Rows::default();
    row.text("type", &tag.kind);
    row.text("value", &tag.value);
    row.text("unit", &tag.unit);
    row.list("auxiliary", tag.children.iter().map(auxiliary_row));
    row.datum()
}

/// A value without a position in the text of a document.
fn unplaced<T>(value: T) -> Spanned<T> {
    value.into()
}
